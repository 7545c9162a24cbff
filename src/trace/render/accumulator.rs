//! Accumulation of a tile's samples.

use fearless_simd::{f32x16, prelude::*};
use glam::DVec3;

use crate::color::{Encoding, Rgb};
use crate::trace::math::{Colors, LANES, Numbers, Vectors, mask16};
use crate::trace::render::film::FilmTile;
use crate::trace::scene::Square;
use crate::trace::stages::{PACKETS, Slots, Tile, TileLanes};

/// Samples of a tile's pixels.
pub(crate) struct TileSamples<'a> {
    /// The radiance of the samples, by packet of the camera rays.
    pub(crate) light: &'a [Colors; PACKETS],
    /// The slots of the samples. Other pixels receive nothing.
    pub(crate) slots: &'a Slots,
    /// The slots that the scene covers, if recording is enabled.
    pub(crate) covered: TileLanes,
}

/// The accumulated light of a tile's pixels.
pub(crate) trait TileAccumulator: Send {
    /// Returns whether samples must record the slots that the scene covers.
    #[inline(always)]
    fn asks_for_coverage(&self) -> bool {
        false
    }

    /// Adds samples. Returns the number of pixels that overflowed.
    fn add<S: Simd>(&mut self, simd: S, tile: &Tile, samples: &TileSamples<'_>) -> u64;
}

/// Stores the only sample of each pixel directly.
impl<E: Encoding> TileAccumulator for FilmTile<'_, E> {
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

/// The sums over the samples of each pixel, packet by packet. They are `f64`, so that the mean of equal samples is exactly their value, and
/// the mean of 2^16 samples is as accurate as the mean of two.
#[derive(Debug)]
pub(crate) struct TileSums<'a> {
    /// Sums of all samples.
    pub(crate) all: &'a mut [Vectors],
    /// Sums of squared samples, and the numbers of samples in `counts`, if pixels have different numbers of samples; otherwise both are empty.
    pub(crate) squares: &'a mut [Vectors],
    pub(crate) counts: &'a mut [Numbers],
    /// Sums of the samples in which the pixel is covered, and their numbers in `covered_counts`; both are empty if coverage is not recorded.
    pub(crate) covered: &'a mut [Vectors],
    /// Numbers of covered samples.
    pub(crate) covered_counts: &'a mut [Numbers],
}

/// The sums of a packet without samples.
pub(crate) const NO_SUMS: Vectors = Vectors::splat(DVec3::ZERO);

impl TileAccumulator for TileSums<'_> {
    #[inline(always)]
    fn asks_for_coverage(&self) -> bool {
        !self.covered.is_empty()
    }

    #[inline(always)]
    fn add<S: Simd>(&mut self, simd: S, _: &Tile, samples: &TileSamples<'_>) -> u64 {
        let TileSamples { light, slots, covered } = *samples;
        if !slots.in_place {
            self.add_scattered(samples);
            return 0;
        }
        for packet in (0..PACKETS).filter(|packet| slots.lanes[*packet] != 0) {
            let colors = light[packet].load(simd);
            add_colors(simd, &mut self.all[packet], colors);
            if let Some(squares) = self.squares.get_mut(packet) {
                add_squares(simd, squares, colors);
                let [none, one] = [0.0, 1.0].map(|number| f32x16::splat(simd, number));
                let lanes = mask16(simd, slots.lanes[packet]);
                add_numbers(simd, &mut self.counts[packet], lanes.select(one, none));
            }
        }
        let of_covered = self.covered.iter_mut().zip(&mut *self.covered_counts).zip(samples.light);
        for (packet, ((sums, counts), light)) in of_covered.enumerate() {
            let lanes = mask16(simd, covered.of_packet(packet));
            let [none, one] = [0.0, 1.0].map(|number| f32x16::splat(simd, number));
            add_colors(simd, sums, light.load(simd).map(|channel| lanes.select(channel, none)));
            add_numbers(simd, counts, lanes.select(one, none));
        }
        0
    }
}

impl TileSums<'_> {
    /// Adds samples whose slots are compacted, each to its pixel, in the order of slots.
    fn add_scattered(&mut self, TileSamples { light, slots, covered }: &TileSamples<'_>) {
        for (pixel, run) in slots.runs() {
            let colors = |slot: usize| light[slot / LANES % PACKETS].get(slot % LANES).as_dvec3();
            let is_covered = |slot: &usize| covered.of_packet(slot / LANES) >> (slot % LANES) & 1 == 1;
            add_to_pixel(self.all, pixel, run.clone().map(colors));
            add_to_pixel(self.squares, pixel, run.clone().map(colors).map(|color| color * color));
            add_to_count(self.counts, pixel, run.len());
            if !self.covered.is_empty() {
                add_to_pixel(self.covered, pixel, run.clone().filter(is_covered).map(colors));
                add_to_count(self.covered_counts, pixel, run.filter(is_covered).count());
            }
        }
    }
}

/// Adds colours to the sum of a pixel, one after the other, if there are sums.
#[inline(always)]
fn add_to_pixel(sums: &mut [Vectors], pixel: usize, colors: impl Iterator<Item = DVec3>) {
    if let Some(sums) = sums.get_mut(pixel / LANES) {
        let sum = colors.fold(sums.get(pixel % LANES), |sum, color| sum + color);
        sums.set(pixel % LANES, sum);
    }
}

/// Adds a number to the count of a pixel, if there are counts.
#[inline(always)]
fn add_to_count(counts: &mut [Numbers], pixel: usize, number: usize) {
    if let Some(counts) = counts.get_mut(pixel / LANES) {
        counts.set(pixel % LANES, counts.get(pixel % LANES) + number as f64);
    }
}

/// Adds a sample of each pixel of a packet.
#[inline(always)]
fn add_colors<S: Simd>(simd: S, sums: &mut Vectors, samples: [f32x16<S>; 3]) {
    for (channel, samples) in samples.into_iter().enumerate() {
        add_numbers(simd, sums.axis_mut(channel), samples);
    }
}

/// Adds the square of a sample of each pixel of a packet.
#[inline(always)]
fn add_squares<S: Simd>(simd: S, sums: &mut Vectors, samples: [f32x16<S>; 3]) {
    for (channel, samples) in samples.into_iter().enumerate() {
        let (sums, (first, second)) = (sums.axis_mut(channel), samples.widen());
        sums.store(0, sums.load(simd, 0) + first * first);
        sums.store(1, sums.load(simd, 1) + second * second);
    }
}

#[inline(always)]
fn add_numbers<S: Simd>(simd: S, sums: &mut Numbers, numbers: f32x16<S>) {
    let (first, second) = numbers.widen();
    sums.store(0, sums.load(simd, 0) + first);
    sums.store(1, sums.load(simd, 1) + second);
}

/// Returns the mean of each pixel of a packet, from the sum and the number of its samples.
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
