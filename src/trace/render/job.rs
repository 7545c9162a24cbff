//! Render jobs of the fast path.

use std::sync::Arc;
use std::sync::atomic::{AtomicBool, Ordering};

use fearless_simd::dispatch;
use rayon::prelude::*;

use crate::color::{Encoding, Linear, Rgb};
use crate::trace::effects::Effects;
use crate::trace::intersect::{Naive, Scratch};
use crate::trace::math::{Colors, LANES, Numbers, PixelSampling, SimdLevel, Vectors};
use crate::trace::render::accumulator::{NO_SUMS, TileAccumulator, TileSamples, TileSums, means};
use crate::trace::render::adaptive::{
    Adaptive, ErrorTarget, EstimatedError, InstantOrder, PacketSums, PixelMemory, SampleSums,
    SharedRoundPolicy, block,
};
use crate::trace::render::film::{self, Film};
use crate::trace::render::film_overlay::FilmOverlay;
use crate::trace::render::image::RenderedImage;
use crate::trace::render::reuse::{ReusablePicture, TileReuse};
use crate::trace::render::tile_work::{Signals, TileProgress, TileWork};
use crate::trace::render::visibility::{self, FeatureScratch, FeatureSearch};
use crate::trace::render_stats::{RenderStats, TileStats};
use crate::trace::scene::{PreparedCamera, PreparedScene};
use crate::trace::shading::RenderContext;
use crate::trace::stages::{PACKETS, Slots, TILE, Tile, TileLanes};

/// A picture being rendered: samples are added instant by instant, then resolved to a film. An interrupted job can be continued later and
/// yields the same bits.
#[derive(Clone, Debug)]
pub struct RenderJob<E: Encoding = Linear> {
    width: u32,
    height: u32,
    plan: SamplePlan,
    /// State of adaptive sampling, if pixels have different sample counts.
    adaptive: Option<Adaptive>,
    /// Completed instants of this round, and the current instant.
    done: Vec<u32>,
    instant: u32,
    tiles: Vec<TileProgress>,
    /// Encoding of the film's pixels.
    encoding: E,
    overlay: Option<Arc<FilmOverlay>>,
    pixels: Pixels<E::Pixel>,
    stats: RenderStats,
    /// The reuse of tiles, if this picture is recorded for it.
    reuse: Option<TileReuse<E>>,
}

/// A finished picture with its by-products.
pub(crate) struct FinishedJob<E: Encoding> {
    pub(crate) image: RenderedImage<E::Pixel>,
    pub(crate) stats: RenderStats,
    /// The sample memory, for the next picture.
    pub(crate) memory: SampleMemory,
    /// The picture for reuse of its tiles, if it was recorded for that.
    pub(crate) reusable: Option<ReusablePicture<E>>,
}

/// The progress of a picture.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct RenderProgress {
    /// Mean sample count per pixel so far, without the samples of reused tiles.
    pub samples: f64,
    /// Fraction of all samples, from 0 to 1. With adaptive sampling, an estimate that may decrease, or `None`: in the first round, for other
    /// norms than RMS, and where a policy chooses the samples.
    pub share: Option<f64>,
}

/// The accumulated light of the pixels.
#[derive(Clone, Debug)]
enum Pixels<Pixel> {
    /// The only sample of each pixel; `None` before the first.
    Picture(Option<Film<Pixel>>),
    /// The sums of all samples.
    Sums(Sums),
}

/// The sums of the samples of pixels, tile by tile. Each tile has space for all its packets of camera rays, even if it is cut off by the
/// film's border.
#[derive(Clone, Debug, Default)]
struct Sums {
    all: Vec<Vectors>,
    /// Sums of squared samples, and sample counts, if pixels have different sample counts; otherwise empty.
    squares: Vec<Vectors>,
    counts: Vec<Numbers>,
    /// Sums of the samples in which the scene covers the pixel, if the picture has alpha; otherwise empty.
    covered: Vec<Vectors>,
    /// Counts of the samples in `covered`.
    covered_counts: Vec<Numbers>,
}

/// The samples of a picture, and the data to accumulate.
#[derive(Clone, Copy, Debug)]
pub(crate) struct SamplePlan {
    /// Sample count of every pixel; with a target, the maximum count.
    pub(crate) samples: u32,
    /// Number of instants.
    pub(crate) instants: u32,
    /// Error target that ends sampling, if any.
    pub(crate) target: Option<ErrorTarget>,
    /// True if every pixel starts with several samples. Applies only with a target.
    pub(crate) starts_wide: bool,
    /// True for a picture with alpha, which omits the background.
    pub(crate) alpha: bool,
}

impl SamplePlan {
    /// Creates the plan of a picture with the same sample count in every pixel.
    pub(crate) fn uniform(samples: u32, instants: u32) -> Self {
        Self { samples, instants, target: None, starts_wide: false, alpha: false }
    }

    /// Creates the state of adaptive sampling if there is a target.
    pub(crate) fn adaptive(&self, resolution: (u32, u32), memory: PixelMemory) -> Option<Adaptive> {
        let order = InstantOrder::new(self.instants > 1);
        self.target
            .map(|target| Adaptive::new(resolution, (self.samples, order, self.starts_wide), target, memory))
    }
}

/// Sample memory kept for the next picture: allocating it again costs more than using it.
#[derive(Debug, Default)]
pub(crate) struct SampleMemory {
    sums: Sums,
    pixels: PixelMemory,
}

impl SampleMemory {
    /// Returns the sample count of each pixel of the last picture. `None` if all counts were equal.
    pub(crate) fn counts(&self, resolution: (u32, u32)) -> Option<Film<u32>> {
        self.pixels.counts(resolution)
    }
}

impl Sums {
    /// Resizes the sums for `tiles` tiles and clears them.
    fn clear(&mut self, tiles: usize, plan: &SamplePlan) {
        let packets = |used| if used { tiles * PACKETS } else { 0 };
        let vectors = [
            (&mut self.all, true),
            (&mut self.squares, plan.target.is_some()),
            (&mut self.covered, plan.alpha),
        ];
        for (sums, used) in vectors {
            sums.clear();
            sums.resize(packets(used), NO_SUMS);
        }
        for (counts, used) in
            [(&mut self.counts, plan.target.is_some()), (&mut self.covered_counts, plan.alpha)]
        {
            counts.clear();
            counts.resize(packets(used), Numbers::splat(0.0));
        }
    }

    /// Iterates over the sums of all tiles.
    fn tiles_mut(&mut self) -> impl Iterator<Item = TileSums<'_>> {
        let mut squares = self.squares.chunks_mut(PACKETS);
        let mut counts = self.counts.chunks_mut(PACKETS);
        let mut covered = self.covered.chunks_mut(PACKETS);
        let mut covered_counts = self.covered_counts.chunks_mut(PACKETS);
        self.all.chunks_mut(PACKETS).map(move |all| TileSums {
            all,
            squares: squares.next().unwrap_or_default(),
            counts: counts.next().unwrap_or_default(),
            covered: covered.next().unwrap_or_default(),
            covered_counts: covered_counts.next().unwrap_or_default(),
        })
    }
}

impl RenderJob {
    /// Creates an empty picture with linear pixels and `samples` samples per pixel.
    #[doc(hidden)]
    #[must_use]
    pub fn new(resolution: (u32, u32), samples: u32) -> Self {
        Self::encoded(Linear, resolution, SamplePlan::uniform(samples, 1), SampleMemory::default())
    }

    /// Returns the picture so far, with its background. Each pixel is the mean of its samples. Tiles without samples show the same region
    /// of `beneath`, which may have any size.
    #[must_use]
    pub fn resolve_over(&self, beneath: &Film) -> Film {
        let mut film = match &self.pixels {
            Pixels::Picture(film) => film.clone().unwrap_or_else(|| Film::new(self.width, self.height)),
            Pixels::Sums(sums) => self.develop_sums(sums, &sums.all).0,
        };
        let nearest = |place: u32, count: u32, of: u32| {
            let nearest = u64::from(place) * u64::from(of) / u64::from(count);
            u32::try_from(nearest).unwrap_or(0)
        };
        self.copy_reused_tiles(&mut film, None);
        for TileProgress { tile, .. } in self.tiles.iter().filter(|progress| !progress.is_seen) {
            for j in tile.j..tile.j + tile.height {
                let row = nearest(j, self.height, beneath.height());
                let pixels = (tile.i..tile.i + tile.width)
                    .map(|i| beneath.pixel(nearest(i, self.width, beneath.width()), row));
                film.store(tile.i, j, pixels);
            }
        }
        film
    }
}

impl<E: Encoding> RenderJob<E> {
    /// Creates an empty picture, reusing the memory of another one. `encoding` applies to the final pixels.
    pub(crate) fn encoded(
        encoding: E,
        (columns, height): (u32, u32),
        plan: SamplePlan,
        SampleMemory { mut sums, pixels: memory }: SampleMemory,
    ) -> Self {
        let tiles: Vec<TileProgress> = Tile::all((columns, height)).map(TileProgress::new).collect();
        let pixels = if plan.samples == 1 && !plan.alpha {
            Pixels::Picture(None)
        } else {
            sums.clear(tiles.len(), &plan);
            Pixels::Sums(sums)
        };
        let adaptive = plan.adaptive((columns, height), memory);
        let (done, stats) = (Vec::new(), RenderStats::default());
        let (width, overlay) = (columns, None);
        Self {
            width,
            height,
            plan,
            adaptive,
            done,
            instant: 0,
            tiles,
            encoding,
            overlay,
            pixels,
            stats,
            reuse: None,
        }
    }

    /// Returns the picture with the tiles of a former one that no difference can reach, recorded so that its own tiles can be reused. The plan
    /// must have no target, and all of its instants must have been compared.
    pub(crate) fn reusing(mut self, reuse: TileReuse<E>) -> Self {
        let mut unchanged = reuse.unchanged_tiles();
        unchanged.resize(self.tiles.len(), None);
        for (progress, record) in self.tiles.iter_mut().zip(unchanged) {
            if let Some(record) = &record {
                self.stats += record.stats;
                progress.rays = record.stats.rays;
                (progress.is_seen, progress.is_reused) = (true, true);
            }
            progress.record = Some(record.unwrap_or_default());
        }
        self.reuse = Some(reuse);
        self
    }

    /// Returns the picture with an overlay of the same size, which is drawn over the final pixels.
    pub(crate) fn with_overlay(self, overlay: Option<Arc<FilmOverlay>>) -> Self {
        Self { overlay, ..self }
    }

    /// Returns the instants of this round's samples in chronological order.
    pub(crate) fn instants(&self) -> Vec<u32> {
        self.adaptive.as_ref().map_or_else(|| (0..self.plan.instants).collect(), Adaptive::instants)
    }

    /// Adds the missing samples of an instant of the current round, on the threads of the current rayon pool. The resulting bits depend
    /// neither on the thread count, nor on effects beyond those that the scene requires. The camera's resolution must equal the size of the
    /// picture, and earlier instants must be complete.
    ///
    /// Returns `true` once all samples are added; otherwise, calling it again with the same arguments continues.
    #[doc(hidden)]
    #[must_use]
    pub fn add(
        &mut self,
        scene: &PreparedScene,
        camera: &PreparedCamera,
        sampling: PixelSampling,
        instant: u32,
        effects: Effects,
        signals: Signals<'_>,
    ) -> bool {
        if self.done.contains(&instant) {
            return true;
        }
        if self.adaptive.is_some() && self.instant != instant {
            self.tiles.iter_mut().for_each(|progress| progress.batches = 0);
        }
        self.instant = instant;
        let context = RenderContext::new(scene, camera, sampling, effects);
        let whole = self.add_with(&context, signals);
        if whole {
            self.done.push(instant);
        }
        whole
    }

    fn add_with(&mut self, context: &RenderContext<'_>, signals: Signals<'_>) -> bool {
        let count = self.tiles.iter().filter(|progress| !progress.is_reused).count();
        let (width, height) = (self.width, self.height);
        let SamplePlan { samples, instants, .. } = self.plan;
        let naive = Naive::of(context.scene);
        let overlay = self.overlay.clone();
        if let Some(adaptive) = self.adaptive.as_mut().filter(|adaptive| adaptive.wants_images()) {
            adaptive.record_images(&visibility::images(context, adaptive.is_open()));
        }
        if self.adaptive.as_ref().is_some_and(Adaptive::is_unsearched) {
            self.search((context.scene, context.camera), self.instant, signals.cancelled);
        }
        let tiles = self.tiles.iter_mut();
        let work = TileWork {
            context,
            naive: naive.as_ref(),
            signals,
            everywhere: block(samples, instants, self.instant),
            adaptive: self.adaptive.as_ref(),
            instant: self.instant,
        };
        let (stats, whole) = match &mut self.pixels {
            Pixels::Picture(film) => {
                let film = film.get_or_insert_with(|| Film::black(self.encoding, width, height));
                let tiles = tiles.zip(film.tiles_mut(self.encoding, overlay.as_deref()));
                work.add(tiles.filter(|(progress, _)| !progress.is_reused), count)
            }
            Pixels::Sums(sums) => {
                let tiles = tiles.zip(sums.tiles_mut());
                work.add(tiles.filter(|(progress, _)| !progress.is_reused), count)
            }
        };
        self.stats += stats;
        whole
    }

    /// Searches for the features of pixels at an instant, without sampling: with an open shutter, moving shapes may lie where no sample is
    /// taken.
    pub(crate) fn search(
        &mut self,
        (scene, camera): (&PreparedScene, &PreparedCamera),
        instant: u32,
        cancelled: &AtomicBool,
    ) {
        let Some(adaptive) = &mut self.adaptive else { return };
        let search = FeatureSearch::new(scene, camera, adaptive.is_open());
        adaptive.tiles_to_search(instant).into_par_iter().for_each_init(
            || (FeatureScratch::default(), Scratch::new(cancelled, None)),
            |(features, scratch), mut tile| {
                let found = search.features((tile.tile(), &tile.known()), (features, scratch));
                if let Some(found) = found.filter(|_| !cancelled.load(Ordering::Relaxed)) {
                    tile.record(found);
                }
            },
        );
        if !cancelled.load(Ordering::Relaxed) {
            adaptive.end_search((scene, camera));
        }
    }

    /// Returns the instants to search in advance in addition to those that were searched. Empty from the second call on.
    pub(crate) fn instants_between(&mut self) -> Vec<u32> {
        self.adaptive.as_mut().map_or_else(Vec::new, Adaptive::instants_between)
    }

    /// Returns whether all samples of the current round are added.
    pub(crate) fn is_round_done(&self) -> bool {
        self.instants().iter().all(|instant| self.done.contains(instant))
    }

    /// Starts the next round unless the picture's error has reached its target. Returns whether there is a next round.
    pub(crate) fn next_round(&mut self, policy: Option<&SharedRoundPolicy>) -> bool {
        let (Some(adaptive), Pixels::Sums(sums)) = (&mut self.adaptive, &self.pixels) else {
            return false;
        };
        self.done.clear();
        self.tiles.iter_mut().for_each(|progress| progress.batches = 0);
        adaptive.judge(sums, policy)
    }

    /// Returns the estimate of the picture's error, if there is an error target.
    pub(crate) fn estimated_error(&self) -> Option<EstimatedError> {
        self.adaptive.as_ref()?.error()
    }

    /// Returns the minimum gains chosen by the policy, one per round.
    pub(crate) fn rounds(&self) -> &[u32] {
        self.adaptive.as_ref().map_or(&[], Adaptive::rounds)
    }

    /// Returns the progress.
    #[must_use]
    pub fn progress(&self) -> RenderProgress {
        let pixels = f64::from(self.width) * f64::from(self.height);
        if let Some(adaptive) = &self.adaptive {
            let samples = self.stats.rays.camera as f64;
            let share = adaptive.expected_samples().map(|all| (samples / all).min(1.0));
            return RenderProgress { samples: samples / pixels, share };
        }
        let area = |tile: Tile| f64::from(tile.width * tile.height);
        let traced = || self.tiles.iter().filter(|progress| !progress.is_reused);
        let there: f64 = traced().map(|progress| area(progress.tile) * f64::from(progress.batches)).sum();
        let all = traced().map(|progress| area(progress.tile)).sum::<f64>() * f64::from(self.plan.samples);
        RenderProgress { samples: there / pixels, share: Some(if all > 0.0 { there / all } else { 1.0 }) }
    }

    /// Returns the fraction of the pixels that are reused.
    pub(crate) fn reused_share(&self) -> f64 {
        let reused = self.tiles.iter().filter(|progress| progress.is_reused);
        let pixels: u32 = reused.map(|progress| progress.tile.width * progress.tile.height).sum();
        f64::from(pixels) / (f64::from(self.width) * f64::from(self.height))
    }

    /// Returns the statistics so far of each tile, in the order of [`Tile::all`].
    pub(crate) fn tile_stats(&self) -> Arc<[TileStats]> {
        let error = |index| self.adaptive.as_ref().and_then(|adaptive| adaptive.tile_error(index));
        let stats = |(index, progress): (usize, &TileProgress)| TileStats {
            rays: progress.rays,
            error: error(index),
        };
        self.tiles.iter().enumerate().map(stats).collect()
    }

    fn copy_reused_tiles(&self, film: &mut Film<E::Pixel>, mut alpha: Option<&mut Film<f32>>) {
        let Some(reuse) = &self.reuse else { return };
        let reused = self.tiles.iter().filter(|progress| progress.is_reused);
        reused.for_each(|progress| reuse.copy_tile(film, alpha.as_deref_mut(), &progress.tile));
    }

    /// Returns the picture and its render statistics.
    #[doc(hidden)]
    #[must_use]
    pub fn resolve(self) -> (Film<E::Pixel>, RenderStats) {
        let FinishedJob { image, stats, .. } = self.finish();
        (image.film, stats)
    }

    /// Finishes the picture.
    pub(crate) fn finish(mut self) -> FinishedJob<E> {
        let mut stats = self.stats;
        let (mut image, memory) = match std::mem::replace(&mut self.pixels, Pixels::Picture(None)) {
            Pixels::Picture(film) => {
                let film = film.unwrap_or_else(|| Film::black(self.encoding, self.width, self.height));
                let image = RenderedImage { film, alpha: None, passes: None, sample_counts: None };
                (image, SampleMemory::default())
            }
            Pixels::Sums(sums) => {
                let has_alpha = !sums.covered.is_empty();
                let (film, overflowed) =
                    self.develop_sums(&sums, if has_alpha { &sums.covered } else { &sums.all });
                stats.escalations.overflowed += overflowed;
                let mut alpha = has_alpha.then(|| self.develop_alpha(&sums));
                if let (Some(alpha), Some(overlay)) = (&mut alpha, &self.overlay) {
                    alpha.draw_over(overlay);
                }
                let pixels = self.adaptive.take().map(Adaptive::into_memory).unwrap_or_default();
                let image = RenderedImage { film, alpha, passes: None, sample_counts: None };
                (image, SampleMemory { sums, pixels })
            }
        };
        self.copy_reused_tiles(&mut image.film, image.alpha.as_mut());
        let reusable = self.reuse.take().map(|reuse| {
            let records = self.tiles.into_iter().filter_map(|progress| progress.record);
            reuse.finish(self.encoding, &image, records.collect())
        });
        FinishedJob { image, stats, memory, reusable }
    }

    /// Returns the film of means of sums, and the number of pixels that overflowed.
    fn develop_sums(&self, sums: &Sums, light: &[Vectors]) -> (Film<E::Pixel>, u64) {
        let mut film = Film::black(self.encoding, self.width, self.height);
        let stored: Vec<_> = film.tiles_mut(self.encoding, self.overlay.as_deref()).collect();
        let tiles = stored.into_par_iter().zip(light.par_chunks(PACKETS)).zip(&self.tiles).enumerate();
        let overflowed = tiles.map(|(index, ((mut stored, light), progress))| {
            if progress.is_reused {
                return 0;
            }
            let mut slots = Slots::default();
            slots.set_everywhere(&progress.tile, 0);
            dispatch!(SimdLevel::best().level(), simd => {
                let counts = sample_counts(sums, index, progress);
                let mut pixels = [Colors::splat(Rgb::ZERO); PACKETS];
                for ((pixels, light), counts) in pixels.iter_mut().zip(light).zip(&counts) {
                    *pixels = means(simd, light, counts);
                }
                let samples = TileSamples { light: &pixels, slots: &slots, covered: TileLanes::NONE };
                stored.add(simd, &progress.tile, &samples)
            })
        });
        let overflowed = overflowed.sum();
        (film, overflowed)
    }

    /// Returns the fraction of each pixel's samples that the scene covers.
    fn develop_alpha(&self, sums: &Sums) -> Film<f32> {
        let mut alpha = Film::zeros(self.width, self.height);
        let across = self.width.div_ceil(TILE).max(1) as usize;
        let tiles = self.tiles.par_chunks(across).enumerate();
        alpha.bands_mut().zip(tiles).for_each(|(band, (down, tiles))| {
            for (right, progress) in tiles.iter().enumerate() {
                let index = down * across + right;
                let Tile { i, width, height, .. } = progress.tile;
                let (covered, counts) =
                    (&sums.covered_counts[index * PACKETS..], sample_counts(sums, index, progress));
                let rows = band.chunks_mut(self.width as usize).take(height as usize);
                for (row, alpha) in rows.enumerate() {
                    for (column, alpha) in alpha[i as usize..(i + width) as usize].iter_mut().enumerate() {
                        let (packet, lane) = Tile::lane_of(column, row);
                        *alpha = film::alpha(covered[packet].get(lane), counts[packet].get(lane));
                    }
                }
            }
        });
        alpha
    }
}

/// Returns the sample count of each pixel of a tile, at least one.
#[inline(always)]
fn sample_counts(sums: &Sums, index: usize, progress: &TileProgress) -> [Numbers; PACKETS] {
    match sums.counts.get(index * PACKETS..(index + 1) * PACKETS) {
        Some(counts) => std::array::from_fn(|packet| {
            let mut counts = counts[packet];
            (0..LANES).for_each(|lane| counts.set(lane, counts.get(lane).max(1.0)));
            counts
        }),
        None => [Numbers::splat(f64::from(progress.batches.max(1))); PACKETS],
    }
}

impl SampleSums for Sums {
    fn have_alpha(&self) -> bool {
        !self.covered_counts.is_empty()
    }

    #[inline(always)]
    fn of(&self, packet: usize, _: (usize, usize)) -> PacketSums {
        let channels = |sums: &Vectors| [0, 1, 2].map(|channel| sums.axis(channel).to_array());
        PacketSums {
            all: channels(&self.all[packet]),
            squares: channels(&self.squares[packet]),
            covered: self.covered_counts.get(packet).map(|counts| counts.to_array()),
        }
    }
}
