//! The fast path: tiles over all threads.

use std::fmt;
use std::sync::atomic::AtomicBool;

use rayon::prelude::*;

use crate::color::Rgb;
use crate::trace::effects::Effects;
use crate::trace::effort::Effort;
use crate::trace::film::{Film, PixelSum};
use crate::trace::light::RenderContext;
use crate::trace::math::Sampling;
use crate::trace::query::{Intersector, Textbook};
use crate::trace::scene::{Camera, Precision, PreparedScene};
use crate::trace::stages::{TILE, Tile, TileBuffers, render_sample};

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
pub struct Exposure {
    width: u32,
    height: u32,
    /// In a pixel.
    samples: u32,
    tiles: Vec<ExposedTile>,
    effort: Effort,
}

/// A tile, and what has come to it.
#[derive(Clone, Debug)]
struct ExposedTile {
    tile: Tile,
    light: TileLight,
    /// How many samples of each of its pixels that is.
    samples: u32,
}

/// What has come to the pixels of a tile so far, row by row.
#[derive(Clone, Debug)]
enum TileLight {
    /// Their only sample.
    Sample(Vec<Rgb>),
    /// All samples so far.
    Sums(Vec<PixelSum>),
}

impl TileLight {
    fn new(tile: Tile, samples: u32) -> Self {
        let count = (tile.width * tile.height) as usize;
        if samples == 1 { Self::Sample(Vec::new()) } else { Self::Sums(vec![PixelSum::default(); count]) }
    }

    fn add(&mut self, sample: &[Rgb]) {
        match self {
            Self::Sample(only) => sample.clone_into(only),
            Self::Sums(sums) => sums.iter_mut().zip(sample).for_each(|(sum, pixel)| sum.add(*pixel)),
        }
    }

    /// Into the film, as the mean of so many samples; says how many pixels had overflowed.
    fn develop(&self, tile: Tile, samples: u32, film: &mut Film) -> u64 {
        let width = tile.width as usize;
        let rows = tile.j..;
        match self {
            Self::Sample(only) => {
                rows.zip(only.chunks(width)).map(|(j, row)| film.store(tile.i, j, row.iter().copied())).sum()
            }
            Self::Sums(sums) => rows
                .zip(sums.chunks(width))
                .map(|(j, row)| film.store(tile.i, j, row.iter().map(|sum| sum.mean(samples))))
                .sum(),
        }
    }
}

impl Exposure {
    /// Of no light so far, to have this many samples in a pixel.
    #[doc(hidden)]
    #[must_use]
    pub fn new((columns, rows): (u32, u32), samples: u32) -> Self {
        let tiles = (0..rows)
            .step_by(TILE as usize)
            .flat_map(|j| (0..columns).step_by(TILE as usize).map(move |i| (i, j)))
            .map(|(i, j)| Tile { i, j, width: TILE.min(columns - i), height: TILE.min(rows - j) })
            .map(|tile| ExposedTile { tile, light: TileLight::new(tile, samples), samples: 0 })
            .collect();
        Self { width: columns, height: rows, samples, tiles, effort: Effort::default() }
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
        (from, to): (u32, u32),
        signals: Signals<'_>,
    ) -> bool {
        let efforts: Vec<Effort> = self
            .tiles
            .par_iter_mut()
            .map_init(
                || TileBuffers::new(signals.cancelled),
                |buffers, exposed| {
                    let mut effort = Effort::default();
                    for sample in from.max(exposed.samples)..to {
                        if (signals.pause)() {
                            break;
                        }
                        let whole = render_sample(context, shapes, (exposed.tile, sample), buffers);
                        let traced = buffers.take_effort();
                        if !whole {
                            break;
                        }
                        exposed.light.add(buffers.pixels());
                        exposed.samples = sample + 1;
                        effort += traced;
                    }
                    effort
                },
            )
            .collect();
        for effort in efforts {
            self.effort += effort;
        }
        self.tiles.iter().all(|exposed| exposed.samples >= to)
    }

    /// Which part of its samples is there, 0 to 1.
    #[must_use]
    pub fn share(&self) -> f64 {
        let area = |tile: Tile| f64::from(tile.width * tile.height);
        let there: f64 =
            self.tiles.iter().map(|exposed| area(exposed.tile) * f64::from(exposed.samples)).sum();
        there / (f64::from(self.width) * f64::from(self.height) * f64::from(self.samples))
    }

    /// What there is so far: pixels are means of the samples that they have. Where they have none, another picture of the same
    /// is seen, of any size.
    #[must_use]
    pub fn develop_over(&self, beneath: &Film) -> Film {
        let mut film = Film::new(self.width, self.height);
        for ExposedTile { tile, light, samples } in &self.tiles {
            if *samples > 0 {
                light.develop(*tile, *samples, &mut film);
                continue;
            }
            let nearest = |place: u32, count: u32, of: u32| {
                let nearest = u64::from(place) * u64::from(of) / u64::from(count);
                u32::try_from(nearest).unwrap_or(0)
            };
            for j in tile.j..tile.j + tile.height {
                let row = nearest(j, self.height, beneath.height());
                let pixels = (tile.i..tile.i + tile.width)
                    .map(|i| beneath.pixel(nearest(i, self.width, beneath.width()), row));
                film.store(tile.i, j, pixels);
            }
        }
        film
    }

    /// The picture, and what it took.
    #[doc(hidden)]
    #[must_use]
    pub fn develop(self) -> (Film, Effort) {
        let mut film = Film::new(self.width, self.height);
        let mut effort = self.effort;
        for exposed in &self.tiles {
            effort.escalations.overflowed += exposed.light.develop(exposed.tile, self.samples, &mut film);
        }
        (film, effort)
    }
}
