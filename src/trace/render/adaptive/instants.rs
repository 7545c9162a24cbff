//! Assignment of samples to instants of the shutter interval.

use std::ops::Range;

use super::evidence::FEWEST;
use crate::trace::stages::Portion;

/// Binary logarithm of the number of instants into which adaptive frames divide the shutter interval. Few instants are rendered: the first
/// 2^m samples belong to 2^m instants spread evenly over the exposure, and doubling the sample count adds the instants in between.
const BITS: u32 = 8;

/// The direction numbers of the third dimension of Sobol's sequence (primitive polynomial x² + x + 1, initial numbers 1 and 3), with each
/// digit replaced by the parity of the digits up to it.
const DIRECTIONS: [u32; BITS as usize] = [0xff, 0x80, 0x40, 0xe0, 0xb0, 0x68, 0xf4, 0x86];

/// A third of the instants.
const THIRD: u32 = 0x55;

/// The order in which samples visit the instants of a frame.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) struct InstantOrder {
    bits: u32,
}

impl InstantOrder {
    /// Maximum number of instants.
    pub(crate) const MOST: u32 = 1 << BITS;

    /// Creates the order for a frame: all instants if the shutter is open, otherwise one.
    pub(crate) fn new(is_open: bool) -> Self {
        Self { bits: if is_open { BITS } else { 0 } }
    }

    /// Returns the number of instants.
    pub(crate) fn count(self) -> u32 {
        1 << self.bits
    }

    /// Returns the instant of a sample. Instants are the third dimension of Sobol's sequence, whose first two are the position in the pixel:
    /// together, they are spread evenly over the pixel and the interval, so that errors at moving edges fall faster than as n^-1/2. Any 2^m
    /// samples that start at a multiple of 2^m have one instant in each of 2^m equal parts of the interval.
    ///
    /// By the parities, every instant lies at a third of its part, alternately at the first and at the second one. This displaces no steady
    /// motion, and the fraction of n = 2^m instants before a moment is wrong by 1/(3 n), RMS. Random instants in the parts would be wrong by
    /// 1/(2.4 n); those in the middle of the parts by 1/(3.5 n), but they do not stay there when n is doubled.
    fn instant(self, sample: u32) -> u32 {
        let index = sample & (self.count() - 1);
        let set = (0..).zip(DIRECTIONS).filter(|(bit, _)| index >> bit & 1 == 1);
        set.fold(THIRD, |instant, (_, direction)| instant ^ direction) >> (BITS - self.bits)
    }

    /// Returns the instants of a range of samples, in chronological order.
    pub(crate) fn instants(self, samples: Range<u32>) -> Vec<u32> {
        let mut instants: Vec<u32> =
            samples.take(self.count() as usize).map(|sample| self.instant(sample)).collect();
        instants.sort_unstable();
        instants
    }

    /// Returns the instants of the first round.
    pub(crate) fn first(self) -> Vec<u32> {
        self.instants(0..FEWEST)
    }

    /// Returns the samples of a pixel, within the range `samples`, that belong to the same instant as `sample`.
    pub(super) fn portion(self, pixel: u32, samples: Range<u32>, sample: u32) -> Option<Portion> {
        let (first, stride) = (self.next_at(samples.start, sample), self.count());
        let count = samples.end.saturating_sub(first).div_ceil(stride);
        (count > 0).then_some(Portion { pixel, first, stride, count })
    }

    /// Returns the first sample from `start` on that belongs to the same instant as `sample`.
    #[inline(always)]
    pub(super) fn next_at(self, start: u32, sample: u32) -> u32 {
        start + (sample.wrapping_sub(start) & (self.count() - 1))
    }

    /// Returns the first sample of each instant.
    pub(super) fn first_samples(self) -> Vec<u32> {
        let mut samples = vec![0; self.count() as usize];
        (0..self.count()).for_each(|sample| samples[self.instant(sample) as usize] = sample);
        samples
    }
}

/// Returns the samples of an instant if all pixels have the same sample count: sample s of n belongs to instant floor(s count / n).
pub(crate) fn block(samples: u32, count: u32, instant: u32) -> Range<u32> {
    let start = |instant: u32| {
        let start = (u64::from(instant) * u64::from(samples)).div_ceil(u64::from(count.max(1)));
        u32::try_from(start).unwrap_or(samples).min(samples)
    };
    start(instant)..start(instant + 1)
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::trace::math::{Dimension, PixelSamples};

    #[test]
    fn every_sample_belongs_to_one_instant() {
        for is_open in [false, true] {
            let order = InstantOrder::new(is_open);
            for samples in [0..1, 0..4, 4..8, 3..700, 256..512] {
                let mut taken = Vec::new();
                for instant in order.instants(samples.clone()) {
                    if let Some(Portion { first, stride, count, .. }) =
                        order.portion(0, samples.clone(), order.first_samples()[instant as usize])
                    {
                        taken.extend((0..count).map(|number| first + number * stride));
                    }
                }
                taken.sort_unstable();
                assert!(taken.into_iter().eq(samples));
            }
        }
        for (samples, count) in [(1, 1), (64, 16), (100, 16), (7, 7)] {
            let all = (0..count).flat_map(|instant| block(samples, count, instant));
            assert!(all.eq(0..samples));
        }
    }

    #[test]
    fn directions_follow_from_their_polynomial() {
        let mut numbers = vec![1, 3];
        for bit in 0..BITS as usize {
            if bit > 1 {
                numbers.push((2 * numbers[bit - 1]) ^ (4 * numbers[bit - 2]) ^ numbers[bit - 2]);
            }
            let digits = numbers[bit] << (BITS as usize - 1 - bit);
            assert_eq!((0..BITS).fold(0, |parities, by| parities ^ digits >> by), DIRECTIONS[bit]);
        }
    }

    #[test]
    fn powers_of_two_are_spread_evenly() {
        let order = InstantOrder::new(true);
        for bits in 0..=BITS {
            let count = 1 << bits;
            for first in [0, InstantOrder::MOST - count] {
                let instants = order.instants(first..first + count);
                let parts = instants.iter().map(|instant| instant >> (BITS - bits));
                assert!(parts.eq(0..count));
            }
            let instants = order.instants(0..count);
            let twice_mean = 2 * instants.iter().sum::<u32>();
            assert!(bits == 0 || twice_mean == (InstantOrder::MOST - 1) * count, "{bits}: {instants:?}");
            // The squared difference between the fraction of instants before a moment, and the moment.
            let square = |moment: u32| {
                let before = instants.iter().filter(|instant| **instant < moment).count() as f64;
                let wrong = before - f64::from(count * moment) / f64::from(InstantOrder::MOST);
                wrong * wrong
            };
            let rms =
                ((0..InstantOrder::MOST).map(square).sum::<f64>() / f64::from(InstantOrder::MOST)).sqrt();
            assert!(bits > BITS - 3 || (rms - 1.0 / 3.0).abs() < 0.03, "{bits}: {rms}");
        }
    }

    /// Checks an edge that moves by two pixels while the shutter is open.
    #[test]
    fn errors_at_moving_edges_fall_faster_than_with_independent_samples() {
        const PIXELS: u32 = 1000;
        let order = InstantOrder::new(true);
        let edge = |pixel: u32, instant: u32| {
            let time = (f64::from(instant) + 0.5) / f64::from(InstantOrder::MOST);
            (f64::from(pixel) + 0.5) / f64::from(PIXELS) + 2.0 * time - 1.0
        };
        let error = |pixel, count: u32| {
            let samples = PixelSamples::new(7, pixel, 0);
            let covers = |sample: &u32| {
                samples.pair(Dimension::Pixel, *sample)[0] < edge(pixel, order.instant(*sample))
            };
            let mean =
                (0..InstantOrder::MOST).map(|instant| edge(pixel, instant).clamp(0.0, 1.0)).sum::<f64>()
                    / f64::from(InstantOrder::MOST);
            (0..count).filter(covers).count() as f64 / f64::from(count) - mean
        };
        let rms = |count| {
            let squares = (0..PIXELS).map(|pixel| error(pixel, count)).map(|error| error * error);
            (squares.sum::<f64>() / f64::from(PIXELS)).sqrt()
        };
        let [few, many] = [16, 256].map(rms);
        // Independent samples have an error of 0.12 with 16 of them, and a quarter of it with 256.
        assert!(few < 0.06 && many < few / 6.0, "{few}, {many}");
    }
}
