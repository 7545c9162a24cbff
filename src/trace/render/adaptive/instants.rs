//! Assignment of samples to instants of the shutter interval.

use std::ops::Range;

use super::evidence::FEWEST;
use crate::trace::math::stratum;
use crate::trace::stages::Portion;

/// Binary logarithm of the number of instants into which adaptive frames divide the shutter interval. Few instants are rendered: sample s
/// belongs to stratum number `stratum(s)`. The first 2^m samples thus belong to 2^m instants spread evenly over the exposure, and doubling
/// the sample count adds the instants in between.
const BITS: u32 = 8;

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

    /// Returns the instants of a range of samples, in chronological order.
    pub(crate) fn instants(self, samples: Range<u32>) -> Vec<u32> {
        let mut instants: Vec<u32> =
            samples.take(self.count() as usize).map(|sample| stratum(sample, self.bits)).collect();
        instants.sort_unstable();
        instants
    }

    /// Returns the instants of the first round.
    pub(crate) fn first(self) -> Vec<u32> {
        self.instants(0..FEWEST)
    }

    /// Returns the samples of a pixel, within the range `samples`, that belong to the same instant as `sample`.
    pub(super) fn portion(self, pixel: u32, samples: Range<u32>, sample: u32) -> Option<Portion> {
        let stride = self.count();
        let first = samples.start + (sample.wrapping_sub(samples.start) & (stride - 1));
        let count = samples.end.saturating_sub(first).div_ceil(stride);
        (count > 0).then_some(Portion { pixel, first, stride, count })
    }

    /// Returns the first sample of each instant.
    pub(super) fn first_samples(self) -> Vec<u32> {
        let mut samples = vec![0; self.count() as usize];
        (0..self.count()).for_each(|sample| samples[stratum(sample, self.bits) as usize] = sample);
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
    fn powers_of_two_are_spread_evenly() {
        let order = InstantOrder::new(true);
        for bits in 0..=BITS {
            let strata = order.instants(0..1 << bits).into_iter().map(|instant| instant >> (BITS - bits));
            assert!(strata.eq(0..1 << bits));
        }
    }
}
