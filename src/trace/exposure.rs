//! The fast path: tiles over all threads.

use std::ops::AddAssign;
use std::sync::atomic::{AtomicBool, Ordering};

use rayon::prelude::*;

use super::effects::{Effects, FullKernel, with_kernel};
use super::film::PixelSum;
use super::geometry::{Leaves, Textbook};
use super::moment::Moment;
use super::tile::{TILE, Tile, TileBuffers, render_sample};
use super::{Camera, Film, Guards, KernelChoice, Precision, PreparedScene, Sampling};
use crate::color::Rgb;

/// What a picture took.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct Effort {
    /// Rays.
    pub rays: RayCounts,
    /// What ended trees of rays before they ended by themselves.
    pub ends: TreeEnds,
    /// How often arithmetic had to be helped.
    pub guards: Guards,
}

/// How many rays were traced, by what for.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct RayCounts {
    /// From the camera.
    pub camera: u64,
    /// From surfaces to lights.
    pub shadow: u64,
    /// From mirrors.
    pub reflection: u64,
    /// Through the surfaces of clear media.
    pub refraction: u64,
}

/// How many rays were not traced, though a surface sent them on.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct TreeEnds {
    /// They were beyond the last generation, or beyond the most rays that a sample may have.
    pub depth: u64,
    /// They could not have brought enough light to show.
    pub cutoff: u64,
}

impl RayCounts {
    /// All of them.
    #[must_use]
    pub fn total(&self) -> u64 {
        self.camera + self.shadow + self.reflection + self.refraction
    }
}

impl AddAssign for RayCounts {
    fn add_assign(&mut self, other: Self) {
        self.camera += other.camera;
        self.shadow += other.shadow;
        self.reflection += other.reflection;
        self.refraction += other.refraction;
    }
}

impl AddAssign for TreeEnds {
    fn add_assign(&mut self, other: Self) {
        self.depth += other.depth;
        self.cutoff += other.cutoff;
    }
}

impl AddAssign for Effort {
    fn add_assign(&mut self, other: Self) {
        self.rays += other.rays;
        self.ends += other.ends;
        self.guards += other.guards;
    }
}

/// A picture in the making: samples are added to it, moment after moment, and in the end it is developed.
#[derive(Clone, Debug)]
pub struct Exposure {
    width: u32,
    height: u32,
    /// In a pixel.
    samples: u32,
    tiles: Vec<(Tile, TileLight)>,
    effort: Effort,
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

    /// Into the film; says how many pixels had overflowed.
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
    #[must_use]
    pub fn new((columns, rows): (u32, u32), samples: u32) -> Self {
        let tiles = (0..rows)
            .step_by(TILE as usize)
            .flat_map(|j| (0..columns).step_by(TILE as usize).map(move |i| (i, j)))
            .map(|(i, j)| Tile { i, j, width: TILE.min(columns - i), height: TILE.min(rows - j) })
            .map(|tile| (tile, TileLight::new(tile, samples)))
            .collect();
        Self { width: columns, height: rows, samples, tiles, effort: Effort::default() }
    }

    /// Adds samples `from..to` of every pixel on the current rayon pool's threads. The bits do not depend on how many there
    /// are, nor on what the kernel has compiled in beyond what the scene calls for. The camera's film must be as large as this.
    ///
    /// `None` if `cancelled` became true before all were added.
    #[must_use]
    pub fn add(
        &mut self,
        scene: &PreparedScene,
        camera: &Camera,
        sampling: Sampling,
        samples: (u32, u32),
        kernel: KernelChoice,
        cancelled: &AtomicBool,
    ) -> Option<()> {
        let moment = Moment::new(scene, camera, sampling);
        match scene.precision {
            Precision::Guaranteed => {
                let leaves = scene.geometry();
                with_kernel!(kernel, Chosen => self.add_with::<Chosen>(&moment, leaves, samples, cancelled))
            }
            // For comparisons: as it is.
            Precision::TextbookF64 => {
                let leaves = Textbook::<f64>::new(scene.geometry());
                self.add_with::<FullKernel>(&moment, &leaves, samples, cancelled)
            }
            Precision::TextbookF32 => {
                let leaves = Textbook::<f32>::new(scene.geometry());
                self.add_with::<FullKernel>(&moment, &leaves, samples, cancelled)
            }
        }
    }

    fn add_with<E: Effects>(
        &mut self,
        moment: &Moment<'_>,
        leaves: &impl Leaves,
        (from, to): (u32, u32),
        cancelled: &AtomicBool,
    ) -> Option<()> {
        let efforts: Option<Vec<Effort>> = self
            .tiles
            .par_iter_mut()
            .map_init(TileBuffers::default, |buffers, (tile, light)| {
                for sample in from..to {
                    if cancelled.load(Ordering::Relaxed) {
                        return None;
                    }
                    render_sample::<E>(moment, leaves, (*tile, sample), buffers);
                    light.add(buffers.pixels());
                }
                Some(buffers.take_effort())
            })
            .collect();
        for effort in efforts? {
            self.effort += effort;
        }
        Some(())
    }

    /// The picture, and what it took.
    #[must_use]
    pub fn develop(self) -> (Film, Effort) {
        let mut film = Film::new(self.width, self.height);
        let mut effort = self.effort;
        for (tile, light) in &self.tiles {
            effort.guards.overflowed += light.develop(*tile, self.samples, &mut film);
        }
        (film, effort)
    }
}
