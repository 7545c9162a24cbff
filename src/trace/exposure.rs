//! The fast path: tiles over all threads.

use std::fmt;
use std::sync::atomic::AtomicBool;

use fearless_simd::dispatch;
use rayon::prelude::*;

use crate::trace::effects::Effects;
use crate::trace::effort::Effort;
use crate::trace::exposed::ExposedLight;
use crate::trace::film::{Band, Film};
use crate::trace::light::RenderContext;
use crate::trace::math::{Colors, Sampling, SimdLevel, Vectors};
use crate::trace::query::{Intersector, Textbook};
use crate::trace::scene::{Camera, Precision, PreparedScene};
use crate::trace::stages::{PACKETS, Square, TILE, Tile, TileBuffers, render_sample};

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
    light: Light,
    effort: Effort,
}

/// A tile, and how many samples of each of its pixels have come.
#[derive(Clone, Copy, Debug)]
struct ExposedTile {
    tile: Tile,
    samples: u32,
}

/// What has come to the pixels so far, tile by tile, and in a tile packet by packet of its camera rays; every tile has room for a
/// whole one.
#[derive(Clone, Debug)]
enum Light {
    /// Their only sample.
    Sample(Vec<Colors>),
    /// All samples so far.
    Sums(Vec<Vectors>),
}

impl Exposure {
    /// Of no light so far, to have this many samples in a pixel.
    #[doc(hidden)]
    #[must_use]
    pub fn new((columns, rows): (u32, u32), samples: u32) -> Self {
        let tiles: Vec<ExposedTile> = (0..rows)
            .step_by(TILE as usize)
            .flat_map(|j| (0..columns).step_by(TILE as usize).map(move |i| (i, j)))
            .map(|(i, j)| Tile { i, j, width: TILE.min(columns - i), height: TILE.min(rows - j) })
            .map(|tile| ExposedTile { tile, samples: 0 })
            .collect();
        let count = tiles.len() * PACKETS;
        let light = if samples == 1 {
            Light::Sample(vec![Colors::NONE; count])
        } else {
            Light::Sums(vec![Vectors::NONE; count])
        };
        Self { width: columns, height: rows, samples, tiles, light, effort: Effort::default() }
    }

    /// Returns the same without any light, to be exposed again, where it has as many pixels and is to have as many samples; else
    /// a new one.
    #[must_use]
    pub(crate) fn again(self, resolution: (u32, u32), samples: u32) -> Self {
        if (self.width, self.height, self.samples) != (resolution.0, resolution.1, samples) {
            return Self::new(resolution, samples);
        }
        let mut again = Self { effort: Effort::default(), ..self };
        again.tiles.iter_mut().for_each(|exposed| exposed.samples = 0);
        if let Light::Sums(sums) = &mut again.light {
            sums.fill(Vectors::NONE);
        }
        again
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
        let tiles = &mut self.tiles;
        self.effort += match &mut self.light {
            Light::Sample(pixels) => add_samples(context, shapes, (tiles, pixels), samples, signals),
            Light::Sums(pixels) => add_samples(context, shapes, (tiles, pixels), samples, signals),
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

    /// What there is so far: pixels are means of the samples that they have. Where they have none, another picture of the same
    /// is seen, of any size.
    #[must_use]
    pub fn develop_over(&self, beneath: &Film) -> Film {
        let mut film = Film::new(self.width, self.height);
        for (index, ExposedTile { tile, samples }) in self.tiles.iter().enumerate() {
            if *samples > 0 {
                let (mut whole, light) = (film.whole_mut(), index * PACKETS);
                match &self.light {
                    Light::Sample(pixels) => {
                        develop_tile(*tile, &pixels[light..], *samples, (&mut whole, tile.j))
                    }
                    Light::Sums(pixels) => {
                        develop_tile(*tile, &pixels[light..], *samples, (&mut whole, tile.j))
                    }
                };
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
    pub fn develop(&self) -> (Film, Effort) {
        let (film, overflowed) = match &self.light {
            Light::Sample(pixels) => self.develop_pixels(pixels),
            Light::Sums(pixels) => self.develop_pixels(pixels),
        };
        let mut effort = self.effort;
        effort.escalations.overflowed += overflowed;
        (film, effort)
    }

    /// The picture, and how many pixels had overflowed.
    fn develop_pixels<L: ExposedLight>(&self, light: &[L]) -> (Film, u64) {
        let across = self.width.div_ceil(TILE) as usize;
        let mut film = Film::new(self.width, self.height);
        let bands = film.bands_mut(TILE).zip(light.par_chunks((across * PACKETS).max(1)));
        let overflowed = bands.zip(self.tiles.par_chunks(across.max(1))).map(|((mut band, light), tiles)| {
            let tiles = tiles.iter().zip(light.chunks(PACKETS));
            tiles
                .map(|(exposed, light)| develop_tile(exposed.tile, light, self.samples, (&mut band, 0)))
                .sum::<u64>()
        });
        let overflowed = overflowed.sum();
        (film, overflowed)
    }
}

/// Stores a tile's pixels, the means of so many samples, in a band whose row `j` is the tile's first. Says how many had overflowed.
fn develop_tile<L: ExposedLight>(
    tile: Tile,
    light: &[L],
    samples: u32,
    (band, j): (&mut Band<'_>, u32),
) -> u64 {
    dispatch!(SimdLevel::best().level(), simd => {
        let mut overflowed = 0;
        for (packet, light) in light[..PACKETS].iter().enumerate() {
            if let Some(Square { first, size }) = tile.square(packet) {
                let first = (first.0, first.1 - tile.j + j);
                overflowed += band.store_square(simd, first, size, &light.mean(simd, samples));
            }
        }
        overflowed
    })
}

/// Adds samples of all tiles, over all threads. Returns what they took.
fn add_samples<L: ExposedLight>(
    context: &RenderContext<'_>,
    shapes: &impl Intersector,
    (tiles, light): (&mut [ExposedTile], &mut [L]),
    (from, to): (u32, u32),
    signals: Signals<'_>,
) -> Effort {
    let efforts: Vec<Effort> = tiles
        .par_iter_mut()
        .zip(light.par_chunks_mut(PACKETS))
        .map_init(
            || TileBuffers::new(signals.cancelled),
            |buffers, (exposed, light)| {
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
                    add_sample(context, light, buffers);
                    exposed.samples = sample + 1;
                    effort += traced;
                }
                effort
            },
        )
        .collect();
    efforts.into_iter().fold(Effort::default(), |mut all, effort| {
        all += effort;
        all
    })
}

/// Adds the sample that buffers hold.
fn add_sample<L: ExposedLight>(context: &RenderContext<'_>, light: &mut [L], buffers: &TileBuffers<'_>) {
    dispatch!(context.scene.simd.level(), simd => {
        for (light, sample) in light.iter_mut().zip(buffers.pixels()) {
            light.add(simd, sample);
        }
    });
}
