//! A tile's working memory. One per thread, reused from tile to tile, so that no ray allocates.

use crate::color::Rgb;
use crate::trace::film::PixelSum;
use crate::trace::prepared::Scratch;
use crate::trace::render::RayCounts;
use crate::trace::{Closest, Ray, Surface};

/// Pixels along a tile's side.
pub(in crate::trace) const TILE: u32 = 16;

/// A rectangle of pixels.
#[derive(Clone, Copy, Debug)]
pub(in crate::trace) struct Tile {
    /// Leftmost column.
    pub(in crate::trace) i: u32,
    /// Uppermost row.
    pub(in crate::trace) j: u32,
    /// Columns, 1..=TILE.
    pub(in crate::trace) width: u32,
    /// Rows, 1..=TILE.
    pub(in crate::trace) height: u32,
}

/// A ray on its way for a pixel.
#[derive(Clone, Debug)]
pub(super) struct QueuedRay {
    pub(super) ray: Ray,
    /// Index of the pixel in the tile.
    pub(super) pixel: usize,
    /// What share of the light along this ray reaches the pixel.
    pub(super) throughput: Rgb,
}

/// A surface point that a ray of the wave has found and that more than ambient light is asked of.
#[derive(Clone, Debug)]
pub(super) struct Found {
    /// Index of the ray in the wave.
    pub(super) ray: usize,
    pub(super) surface: Surface,
    /// Ambient and direct light sent back along the ray, summed light by light.
    pub(super) local: Rgb,
}

/// Queues between the stages, and the tile's pixels. Between [`begin`](Self::begin) and [`finish`](Self::finish) a tile's
/// samples go through, one of every pixel at a time.
#[derive(Debug, Default)]
pub(in crate::trace) struct TileBuffers {
    /// This wave's rays.
    pub(super) rays: Vec<QueuedRay>,
    /// What each of them meets.
    pub(super) hits: Vec<Option<Closest>>,
    /// The surface points of those that meet something.
    pub(super) found: Vec<Found>,
    /// The next wave's rays.
    pub(super) next: Vec<QueuedRay>,
    pub(in crate::trace) scratch: Scratch,
    /// Row by row: what the sample brings, and in the end the mean of all.
    pub(in crate::trace) pixels: Vec<Rgb>,
    /// The samples so far, row by row.
    sums: Vec<PixelSum>,
    /// Rays since the buffers were made.
    pub(in crate::trace) counts: RayCounts,
}

impl TileBuffers {
    pub(in crate::trace) fn begin(&mut self, tile: Tile) {
        let count = (tile.width * tile.height) as usize;
        self.pixels.resize(count, Rgb::ZERO);
        self.sums.clear();
        self.sums.resize(count, PixelSum::default());
    }

    pub(super) fn begin_sample(&mut self) {
        self.pixels.fill(Rgb::ZERO);
        self.rays.clear();
        self.next.clear();
    }

    pub(super) fn end_sample(&mut self) {
        for (sum, sample) in self.sums.iter_mut().zip(&self.pixels) {
            sum.add(*sample);
        }
    }

    pub(in crate::trace) fn finish(&mut self, samples: u32) {
        for (pixel, sum) in self.pixels.iter_mut().zip(&self.sums) {
            *pixel = sum.mean(samples);
        }
    }
}
