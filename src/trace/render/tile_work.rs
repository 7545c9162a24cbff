//! Sampling of tiles on all threads.

use std::fmt;
use std::ops::Range;
use std::sync::atomic::{AtomicBool, Ordering};
use std::sync::{Arc, Mutex, PoisonError};

use fearless_simd::dispatch;

use super::accumulator::{TileAccumulator, TileSamples};
use super::adaptive::Adaptive;
use super::reuse::TileRecord;
use super::work_queue::WorkQueue;
use crate::trace::intersect::Naive;
use crate::trace::render_stats::{RayCounts, RenderStats};
use crate::trace::shading::RenderContext;
use crate::trace::stages::{Portion, Slots, Tile, TileBuffers, render_sample};

/// Signals that end tracing early.
#[derive(Clone, Copy)]
pub struct Signals<'a> {
    /// Set to end tracing at once; samples of tiles in progress are lost. Must stay true until tracing has ended.
    pub cancelled: &'a AtomicBool,
    /// Polled before each batch of a tile. Returns `true` to pause tracing, for example to show the picture so far. Batches in progress are
    /// finished.
    pub pause: &'a (dyn Fn() -> bool + Sync),
}

impl Signals<'_> {
    /// Returns signals that never end tracing.
    #[must_use]
    pub fn none() -> Self {
        static NEVER: AtomicBool = AtomicBool::new(false);
        Signals::unless(&NEVER)
    }
}

impl<'a> Signals<'a> {
    /// Creates signals with `cancelled` only, without pauses.
    #[must_use]
    pub fn unless(cancelled: &'a AtomicBool) -> Self {
        Self { cancelled, pause: &|| false }
    }
}

impl fmt::Debug for Signals<'_> {
    fn fmt(&self, formatter: &mut fmt::Formatter<'_>) -> fmt::Result {
        formatter.debug_struct("Signals").field("cancelled", self.cancelled).finish_non_exhaustive()
    }
}

/// The progress of a tile.
#[derive(Clone, Debug)]
pub(in crate::trace) struct TileProgress {
    pub(in crate::trace) tile: Tile,
    /// Samples per pixel so far or, with adaptive sampling, batches of the current instant.
    pub(in crate::trace) batches: u32,
    /// The rays so far, of all instants; those of the former picture if the tile is reused.
    pub(in crate::trace) rays: RayCounts,
    /// True if the tile has any sample.
    pub(in crate::trace) is_seen: bool,
    /// The dependencies and costs of the tile, if they are recorded.
    pub(in crate::trace) record: Option<Arc<TileRecord>>,
    /// True if the pixels are those of a former picture.
    pub(in crate::trace) is_reused: bool,
}

/// Samples to add to tiles.
pub(in crate::trace) struct TileWork<'a> {
    pub(in crate::trace) context: &'a RenderContext<'a>,
    pub(in crate::trace) naive: Option<&'a Naive>,
    pub(in crate::trace) signals: Signals<'a>,
    /// Samples of every pixel, without adaptive sampling.
    pub(in crate::trace) everywhere: Range<u32>,
    pub(in crate::trace) adaptive: Option<&'a Adaptive>,
    pub(in crate::trace) instant: u32,
}

impl TileProgress {
    /// Creates a tile without samples.
    pub(in crate::trace) fn new(tile: Tile) -> Self {
        Self { tile, batches: 0, rays: RayCounts::default(), is_seen: false, record: None, is_reused: false }
    }
}

impl TileWork<'_> {
    /// Adds samples to all tiles on all threads. Returns render statistics, and whether all samples were added.
    pub(in crate::trace) fn add<'t, L: TileAccumulator>(
        &self,
        tiles: impl Iterator<Item = (&'t mut TileProgress, L)> + Send,
        count: usize,
    ) -> (RenderStats, bool) {
        let threads = rayon::current_num_threads();
        let queue = WorkQueue::new(tiles, count, threads);
        let total = Mutex::new((RenderStats::default(), true));
        let work = || {
            let (mut share, mut memory) = (Vec::new(), None);
            let (mut stats, mut whole) = (RenderStats::default(), true);
            while queue.take_share(&mut share) {
                let memory =
                    memory.get_or_insert_with(|| WorkMemory::new(self.signals.cancelled, self.naive));
                for (progress, mut light) in share.drain(..) {
                    whole &= self.add_to_tile(progress, &mut light, memory, &mut stats);
                }
            }
            let mut total = total.lock().unwrap_or_else(PoisonError::into_inner);
            total.0 += stats;
            total.1 &= whole;
        };
        rayon::scope(|scope| (0..threads).for_each(|_| scope.spawn(|_| work())));
        total.into_inner().unwrap_or_else(PoisonError::into_inner)
    }

    /// Adds samples to a tile. Returns whether all were added.
    fn add_to_tile(
        &self,
        progress: &mut TileProgress,
        light: &mut impl TileAccumulator,
        WorkMemory { buffers, slots, portions }: &mut WorkMemory<'_>,
        stats: &mut RenderStats,
    ) -> bool {
        let adaptive = self.adaptive;
        let tile = progress.tile;
        buffers.record_coverage(light.asks_for_coverage());
        if let Some(adaptive) = adaptive {
            adaptive.portions(&tile, self.instant, portions);
        }
        buffers.record_dependencies(progress.record.is_some());
        let whole = self.add_batches(progress, light, (buffers, slots, portions), stats);
        // Rays of a cancelled sample, which is traced again, do no harm.
        if let Some(record) = &mut progress.record {
            buffers.move_dependencies(&mut Arc::make_mut(record).dependencies);
        }
        whole
    }

    /// Adds the missing batches of samples to a tile. Returns whether all were added.
    fn add_batches(
        &self,
        progress: &mut TileProgress,
        light: &mut impl TileAccumulator,
        (buffers, slots, portions): (&mut TileBuffers<'_>, &mut Slots, &[Portion]),
        stats: &mut RenderStats,
    ) -> bool {
        let Self { context, adaptive, .. } = *self;
        let tile = progress.tile;
        loop {
            let more = if adaptive.is_some() {
                slots.set_batch(portions, progress.batches)
            } else {
                let sample = self.everywhere.start.max(progress.batches);
                slots.set_everywhere(&tile, sample);
                sample < self.everywhere.end
            };
            if !more {
                return true;
            }
            if self.signals.cancelled.load(Ordering::Relaxed) || (self.signals.pause)() {
                return false;
            }
            let whole = render_sample(context, (tile, slots), buffers);
            let traced = buffers.take_stats();
            if !whole {
                return false;
            }
            stats.escalations.overflowed += dispatch!(context.scene.simd.level(), simd => {
                let samples = TileSamples { light: buffers.pixels(), slots, covered: buffers.covered() };
                light.add(simd, &tile, &samples)
            });
            progress.batches += 1;
            progress.rays += traced.rays;
            progress.is_seen = true;
            if let Some(record) = &mut progress.record {
                Arc::make_mut(record).stats += traced;
            }
            *stats += traced;
        }
    }
}

/// The working memory of a thread.
struct WorkMemory<'a> {
    buffers: TileBuffers<'a>,
    slots: Slots,
    portions: Vec<Portion>,
}

impl<'a> WorkMemory<'a> {
    fn new(cancelled: &'a AtomicBool, naive: Option<&'a Naive>) -> Self {
        Self { buffers: TileBuffers::new(cancelled, naive), slots: Slots::default(), portions: Vec::new() }
    }
}
