//! Where a tile's samples are added to those that came before.

use fearless_simd::{f32x16, prelude::*};
use glam::DVec3;

use crate::color::{Encoding, Rgb};
use crate::trace::film::FilmTile;
use crate::trace::math::{Colors, Numbers, Vectors, mask16};
use crate::trace::scene::Square;
use crate::trace::stages::{PACKETS, Tile, TileLanes};

/// A sample of a tile's pixels.
pub(crate) struct TileSamples<'a> {
    /// Packet by packet of the camera rays: what it brings.
    pub(crate) light: &'a [Colors; PACKETS],
    /// The pixels that get it; to the others it brings nothing.
    pub(crate) active: TileLanes,
    /// The pixels that the scene covers in it, if that was asked for.
    pub(crate) covered: TileLanes,
}

/// The light of a tile's pixels so far.
pub(crate) trait TileLight: Send {
    /// Returns whether it asks which pixels the scene covers.
    #[inline(always)]
    fn asks_for_coverage(&self) -> bool {
        false
    }

    /// Adds a sample of pixels. Says how many have overflowed.
    fn add<S: Simd>(&mut self, simd: S, tile: &Tile, samples: &TileSamples<'_>) -> u64;

    /// Adds it to the first half of the first round's samples, where somebody wants to know those; the first of all
    /// takes the place of what is there.
    #[inline(always)]
    fn add_to_first_half<S: Simd>(&mut self, _: S, _: &[Colors; PACKETS], _is_first: bool) {}
}

/// The only sample of each pixel is what is seen.
impl<E: Encoding> TileLight for FilmTile<'_, E> {
    #[inline(always)]
    fn add<S: Simd>(&mut self, simd: S, tile: &Tile, samples: &TileSamples<'_>) -> u64 {
        let mut overflowed = 0;
        for (packet, samples) in samples.light.iter().enumerate() {
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
    /// Of all samples in which the pixel is covered; empty where nobody wants to know, as the next.
    pub(crate) covered: &'a mut [Vectors],
    /// How many those are.
    pub(crate) covered_counts: &'a mut [Numbers],
}

/// The sums of a packet without samples.
pub(crate) const NO_SUMS: Vectors = Vectors::splat(DVec3::ZERO);

impl TileLight for TileSums<'_> {
    #[inline(always)]
    fn asks_for_coverage(&self) -> bool {
        !self.covered.is_empty()
    }

    #[inline(always)]
    fn add<S: Simd>(&mut self, simd: S, _: &Tile, samples: &TileSamples<'_>) -> u64 {
        for (packet, (sums, light)) in self.all.iter_mut().zip(samples.light).enumerate() {
            if samples.active.of_packet(packet) != 0 {
                add_colors(simd, sums, light.load(simd));
            }
        }
        let of_covered = self.covered.iter_mut().zip(&mut *self.covered_counts).zip(samples.light);
        for (packet, ((sums, counts), light)) in of_covered.enumerate() {
            let lanes = mask16(simd, samples.covered.of_packet(packet));
            let [none, one] = [0.0, 1.0].map(|number| f32x16::splat(simd, number));
            add_colors(simd, sums, light.load(simd).map(|channel| lanes.select(channel, none)));
            add_numbers(simd, counts, lanes.select(one, none));
        }
        0
    }

    #[inline(always)]
    fn add_to_first_half<S: Simd>(&mut self, simd: S, samples: &[Colors; PACKETS], is_first: bool) {
        if is_first {
            self.first_half.iter_mut().zip(samples).for_each(|(sums, samples)| *sums = *samples);
            return;
        }
        for (sums, samples) in self.first_half.iter_mut().zip(samples) {
            let ([r0, g0, b0], [r1, g1, b1]) = (sums.load(simd), samples.load(simd));
            sums.store([r0 + r1, g0 + g1, b0 + b1]);
        }
    }
}

/// Adds a sample of each pixel of a packet.
#[inline(always)]
fn add_colors<S: Simd>(simd: S, sums: &mut Vectors, samples: [f32x16<S>; 3]) {
    for (channel, samples) in samples.into_iter().enumerate() {
        add_numbers(simd, sums.axis_mut(channel), samples);
    }
}

#[inline(always)]
fn add_numbers<S: Simd>(simd: S, sums: &mut Numbers, numbers: f32x16<S>) {
    let (first, second) = numbers.widen();
    sums.store(0, sums.load(simd, 0) + first);
    sums.store(1, sums.load(simd, 1) + second);
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
