//! Where a tile's samples are added to those that came before.

use fearless_simd::prelude::*;
use glam::DVec3;

use crate::color::{Encoding, Rgb};
use crate::trace::film::FilmTile;
use crate::trace::math::{Colors, Numbers, Vectors};
use crate::trace::scene::Square;
use crate::trace::stages::{PACKETS, Tile};

/// The light of a tile's pixels so far.
pub(crate) trait TileLight: Send {
    /// Adds a sample of each pixel, given packet by packet of the camera rays. Says how many pixels have overflowed.
    fn add<S: Simd>(&mut self, simd: S, tile: &Tile, samples: &[Colors; PACKETS]) -> u64;

    /// Adds it to the first half of the first round's samples, where somebody wants to know those.
    #[inline(always)]
    fn add_to_first_half<S: Simd>(&mut self, _: S, _: &[Colors; PACKETS]) {}
}

/// The only sample of each pixel is what is seen.
impl<E: Encoding> TileLight for FilmTile<'_, E> {
    #[inline(always)]
    fn add<S: Simd>(&mut self, simd: S, tile: &Tile, samples: &[Colors; PACKETS]) -> u64 {
        let mut overflowed = 0;
        for (packet, samples) in samples.iter().enumerate() {
            if let Some(Square { first: (i, j), size }) = tile.square(packet) {
                overflowed += self.store(simd, (i - tile.i, j - tile.j), size, samples);
            }
        }
        overflowed
    }
}

/// What the samples of each pixel add up to, packet by packet. In `f64`, so that the mean of equal samples is exactly their value, and
/// that of 2^16 samples is as good as that of two.
#[derive(Debug)]
pub(crate) struct TileSums<'a> {
    /// Of all samples.
    pub(crate) all: &'a mut [Vectors],
    /// Of the first half of those of the first round, in `f32`; empty where nobody wants to know.
    pub(crate) first_half: &'a mut [Colors],
}

/// The sums of a packet without samples.
pub(crate) const NO_SUMS: Vectors = Vectors::splat(DVec3::ZERO);

impl TileLight for TileSums<'_> {
    #[inline(always)]
    fn add<S: Simd>(&mut self, simd: S, _: &Tile, samples: &[Colors; PACKETS]) -> u64 {
        for (sums, samples) in self.all.iter_mut().zip(samples) {
            for (channel, samples) in samples.load(simd).into_iter().enumerate() {
                let (first, second) = samples.widen();
                let sums = sums.axis_mut(channel);
                sums.store(0, sums.load(simd, 0) + first);
                sums.store(1, sums.load(simd, 1) + second);
            }
        }
        0
    }

    #[inline(always)]
    fn add_to_first_half<S: Simd>(&mut self, simd: S, samples: &[Colors; PACKETS]) {
        for (sums, samples) in self.first_half.iter_mut().zip(samples) {
            let ([r0, g0, b0], [r1, g1, b1]) = (sums.load(simd), samples.load(simd));
            sums.store([r0 + r1, g0 + g1, b0 + b1]);
        }
    }
}

/// Returns the means of what samples of a packet's pixels add up to, so many of each.
#[inline(always)]
pub(crate) fn means<S: Simd>(simd: S, sums: &Vectors, samples: &Numbers) -> Colors {
    let mut means = Colors::splat(Rgb::ZERO);
    let mean = |channel: usize, half: usize| sums.axis(channel).load(simd, half) / samples.load(simd, half);
    means.store([
        mean(0, 0).narrow(mean(0, 1)),
        mean(1, 0).narrow(mean(1, 1)),
        mean(2, 0).narrow(mean(2, 1)),
    ]);
    means
}
