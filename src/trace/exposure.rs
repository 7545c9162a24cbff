//! The fast path: tiles over all threads.

use std::fmt;
use std::sync::atomic::{AtomicBool, Ordering};
use std::sync::{Mutex, PoisonError};

use fearless_simd::dispatch;
use rayon::prelude::*;

use crate::color::{Encoding, Linear, Rgb};
use crate::trace::effects::Effects;
use crate::trace::effort::Effort;
use crate::trace::film::Film;
use crate::trace::light::RenderContext;
use crate::trace::math::{Colors, Sampling, SimdLevel, Vectors};
use crate::trace::query::{Intersector, Textbook};
use crate::trace::scene::{Camera, Precision, PreparedScene};
use crate::trace::stages::{PACKETS, TILE, Tile, TileBuffers, render_sample};
use crate::trace::tile_light::{NO_SUMS, TileLight, TileSums, means};
use crate::trace::work_queue::WorkQueue;

/// What may end tracing before all is traced.
#[derive(Clone, Copy)]
pub struct Signals<'a> {
    /// Once it is true tracing ends at once: samples of tiles that are in hand are lost. It must stay true until then.
    pub cancelled: &'a AtomicBool,
    /// Asked from time to time: is it time to see what there is? Samples in hand are finished.
    pub pause: &'a (dyn Fn() -> bool + Sync),
}

impl<'a> Signals<'a> {
    /// Nothing else but `cancelled`.
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

/// A picture in the making: samples are added to it, moment after moment, and in the end it is developed. What ends before all
/// are added can go on later, to the same bits.
#[derive(Clone, Debug)]
pub struct Exposure<E: Encoding = Linear> {
    width: u32,
    height: u32,
    /// In a pixel.
    samples: u32,
    tiles: Vec<ExposedTile>,
    /// How the film keeps pixels in the end.
    encoding: E,
    pixels: Pixels<E::Pixel>,
    effort: Effort,
}

/// A tile, and how many samples of each of its pixels have come.
#[derive(Clone, Copy, Debug)]
struct ExposedTile {
    tile: Tile,
    samples: u32,
}

/// What has come to the pixels so far.
#[derive(Clone, Debug)]
enum Pixels<Pixel> {
    /// Their only sample; `None` before the first comes.
    Picture(Option<Film<Pixel>>),
    /// What all samples add up to.
    Sums(Sums),
}

/// What the samples of pixels add up to, tile by tile, and in a tile packet by packet of its camera rays; every tile has room for a
/// whole one.
#[derive(Clone, Debug, Default)]
pub(crate) struct Sums(Vec<Vectors>);

impl Exposure {
    /// Of no light so far, to have this many samples in a pixel, and linear light in the end.
    #[doc(hidden)]
    #[must_use]
    pub fn new(resolution: (u32, u32), samples: u32) -> Self {
        Self::encoded(Linear, resolution, samples, Sums::default())
    }

    /// What there is so far: pixels are means of the samples that they have. Where they have none, another picture of the same
    /// is seen, of any size.
    #[must_use]
    pub fn develop_over(&self, beneath: &Film) -> Film {
        let mut film = match &self.pixels {
            Pixels::Picture(film) => film.clone().unwrap_or_else(|| Film::new(self.width, self.height)),
            Pixels::Sums(sums) => self.develop_sums(sums).0,
        };
        let nearest = |place: u32, count: u32, of: u32| {
            let nearest = u64::from(place) * u64::from(of) / u64::from(count);
            u32::try_from(nearest).unwrap_or(0)
        };
        for ExposedTile { tile, .. } in self.tiles.iter().filter(|exposed| exposed.samples == 0) {
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

impl<E: Encoding> Exposure<E> {
    /// Of no light so far, to have this many samples in a pixel, which are encoded in the end. It uses the memory of another's
    /// sums.
    pub(crate) fn encoded(
        encoding: E,
        (columns, rows): (u32, u32),
        samples: u32,
        Sums(mut sums): Sums,
    ) -> Self {
        let tiles: Vec<ExposedTile> = (0..rows)
            .step_by(TILE as usize)
            .flat_map(|j| (0..columns).step_by(TILE as usize).map(move |i| (i, j)))
            .map(|(i, j)| Tile { i, j, width: TILE.min(columns - i), height: TILE.min(rows - j) })
            .map(|tile| ExposedTile { tile, samples: 0 })
            .collect();
        let pixels = if samples == 1 {
            Pixels::Picture(None)
        } else {
            sums.clear();
            sums.resize(tiles.len() * PACKETS, NO_SUMS);
            Pixels::Sums(Sums(sums))
        };
        Self { width: columns, height: rows, samples, tiles, encoding, pixels, effort: Effort::default() }
    }

    /// Adds samples `from..to` of every pixel, those that are not there yet, on the current rayon pool's threads. The bits do not
    /// depend on how many there are, nor on effects beyond those that the scene calls for. The camera's film must
    /// be as large as this, and samples before `from` must be there.
    ///
    /// Says whether all were added; if not, the same call goes on.
    #[doc(hidden)]
    #[must_use]
    pub fn add(
        &mut self,
        scene: &PreparedScene,
        camera: &Camera,
        sampling: Sampling,
        samples: (u32, u32),
        effects: Effects,
        signals: Signals<'_>,
    ) -> bool {
        let context = RenderContext::new(scene, camera, sampling, effects);
        match scene.precision {
            Precision::Guaranteed => self.add_with(&context, scene.geometry(), samples, signals),
            // For comparisons: as it is.
            Precision::TextbookF64 => {
                let shapes = Textbook::<f64>::new(scene.geometry());
                self.add_with(&context, &shapes, samples, signals)
            }
            Precision::TextbookF32 => {
                let shapes = Textbook::<f32>::new(scene.geometry());
                self.add_with(&context, &shapes, samples, signals)
            }
        }
    }

    fn add_with(
        &mut self,
        context: &RenderContext<'_>,
        shapes: &impl Intersector,
        samples: (u32, u32),
        signals: Signals<'_>,
    ) -> bool {
        let (count, tiles) = (self.tiles.len(), self.tiles.iter_mut());
        let (width, height) = (self.width, self.height);
        self.effort += match &mut self.pixels {
            Pixels::Picture(film) => {
                let film = film.get_or_insert_with(|| Film::black(self.encoding, width, height));
                let tiles = tiles.zip(film.tiles_mut(self.encoding));
                add_samples(context, shapes, (tiles, count), samples, signals)
            }
            Pixels::Sums(Sums(sums)) => {
                let tiles = tiles.zip(sums.chunks_mut(PACKETS).map(TileSums));
                add_samples(context, shapes, (tiles, count), samples, signals)
            }
        };
        self.tiles.iter().all(|exposed| exposed.samples >= samples.1)
    }

    /// Which part of its samples is there, 0 to 1.
    #[must_use]
    pub fn share(&self) -> f64 {
        let area = |tile: Tile| f64::from(tile.width * tile.height);
        let there: f64 =
            self.tiles.iter().map(|exposed| area(exposed.tile) * f64::from(exposed.samples)).sum();
        there / (f64::from(self.width) * f64::from(self.height) * f64::from(self.samples))
    }

    /// Returns the picture, and what it took.
    #[doc(hidden)]
    #[must_use]
    pub fn develop(self) -> (Film<E::Pixel>, Effort) {
        let (film, effort, _) = self.finish();
        (film, effort)
    }

    /// Returns the picture, what it took, and the sums, for their memory.
    pub(crate) fn finish(mut self) -> (Film<E::Pixel>, Effort, Sums) {
        let mut effort = self.effort;
        match std::mem::replace(&mut self.pixels, Pixels::Picture(None)) {
            Pixels::Picture(film) => {
                let film = film.unwrap_or_else(|| Film::black(self.encoding, self.width, self.height));
                (film, effort, Sums::default())
            }
            Pixels::Sums(sums) => {
                let (film, overflowed) = self.develop_sums(&sums);
                effort.escalations.overflowed += overflowed;
                (film, effort, sums)
            }
        }
    }

    /// Returns the means of what samples add up to, and how many had overflowed.
    fn develop_sums(&self, Sums(sums): &Sums) -> (Film<E::Pixel>, u64) {
        let mut film = Film::black(self.encoding, self.width, self.height);
        let stored: Vec<_> = film.tiles_mut(self.encoding).collect();
        let tiles = stored.into_par_iter().zip(sums.par_chunks(PACKETS)).zip(&self.tiles);
        let overflowed = tiles.map(|((mut stored, sums), ExposedTile { tile, samples })| {
            dispatch!(SimdLevel::best().level(), simd => {
                let mut pixels = [Colors::splat(Rgb::ZERO); PACKETS];
                for (pixels, sums) in pixels.iter_mut().zip(sums) {
                    *pixels = means(simd, sums, (*samples).max(1));
                }
                stored.add(simd, tile, &pixels)
            })
        });
        let overflowed = overflowed.sum();
        (film, overflowed)
    }
}

/// Adds samples of all tiles, so many, over all threads. Returns what they took.
fn add_samples<'t, L: TileLight>(
    context: &RenderContext<'_>,
    shapes: &impl Intersector,
    (tiles, count): (impl Iterator<Item = (&'t mut ExposedTile, L)> + Send, usize),
    samples: (u32, u32),
    signals: Signals<'_>,
) -> Effort {
    let threads = rayon::current_num_threads();
    let queue = WorkQueue::new(tiles, count, threads);
    let total = Mutex::new(Effort::default());
    let work = || {
        let (mut share, mut buffers, mut effort) = (Vec::new(), None, Effort::default());
        while queue.take_share(&mut share) {
            let buffers = buffers.get_or_insert_with(|| TileBuffers::new(signals.cancelled));
            for (exposed, mut light) in share.drain(..) {
                effort += add_to_tile(context, shapes, (exposed, &mut light), samples, signals, buffers);
            }
        }
        *total.lock().unwrap_or_else(PoisonError::into_inner) += effort;
    };
    rayon::scope(|scope| (0..threads).for_each(|_| scope.spawn(|_| work())));
    total.into_inner().unwrap_or_else(PoisonError::into_inner)
}

/// Adds samples of a tile. Returns what they took.
fn add_to_tile(
    context: &RenderContext<'_>,
    shapes: &impl Intersector,
    (exposed, light): (&mut ExposedTile, &mut impl TileLight),
    (from, to): (u32, u32),
    signals: Signals<'_>,
    buffers: &mut TileBuffers<'_>,
) -> Effort {
    let mut effort = Effort::default();
    for sample in from.max(exposed.samples)..to {
        if signals.cancelled.load(Ordering::Relaxed) || (signals.pause)() {
            break;
        }
        let whole = render_sample(context, shapes, (exposed.tile, sample), buffers);
        let traced = buffers.take_effort();
        if !whole {
            break;
        }
        effort.escalations.overflowed += dispatch!(context.scene.simd.level(), simd => {
            light.add(simd, &exposed.tile, buffers.pixels())
        });
        exposed.samples = sample + 1;
        effort += traced;
    }
    effort
}
