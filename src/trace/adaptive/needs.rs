//! The gain that another sample of a pixel promises, and the least gain for which samples are taken.

use std::ops::AddAssign;

/// The gain of a sample: the square error of a pixel per sample that it has, by powers of two and eighths of them. The bin of a histogram.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord)]
pub(super) struct Gain(u32);

/// Bins of a power of two.
const OCTAVE: u32 = 8;
/// By exponent and the first three bits of the mantissa.
const SHIFT: u32 = f32::MANTISSA_DIGITS - 1 - OCTAVE.ilog2();
/// One for each number.
const BINS: usize = (f32::INFINITY.to_bits() >> SHIFT) as usize + 1;

impl Gain {
    /// No pixel has more.
    pub(super) const BEYOND: Self = Self(u32::MAX);

    /// Returns the gain of a pixel with a square error, 0 or more, and a number of samples.
    #[inline(always)]
    pub(super) fn of(square: f32, samples: u32) -> Self {
        #[expect(clippy::cast_precision_loss, reason = "an estimate")]
        Self((square / samples.max(1) as f32).to_bits() >> SHIFT)
    }
}

/// The sums of pixels' square errors.
#[derive(Clone, Debug)]
pub(super) struct SquaresByGain {
    /// Of pixels that have all the samples that they may have.
    left: f64,
    /// Of the others, by their gain.
    of: Vec<f64>,
}

impl Default for SquaresByGain {
    fn default() -> Self {
        Self { left: 0.0, of: vec![0.0; BINS] }
    }
}

impl SquaresByGain {
    /// Adds a pixel.
    #[inline(always)]
    pub(super) fn add(&mut self, square: f32, samples: u32, may_get_more: bool) {
        let bin = (Gain::of(square, samples).0 as usize).min(BINS - 1);
        *(if may_get_more { &mut self.of[bin] } else { &mut self.left }) += f64::from(square);
    }

    /// Returns the least gain for which samples must be taken for the sum of all squares to become `most`, where doubling the samples of a
    /// pixel multiplies its square error by `falls`.
    ///
    /// For independent samples, taking them where their gain is largest is the best division: Neyman, "On the Two Different Aspects of the
    /// Representative Method" (1934).
    pub(super) fn least_for(&self, most: f64, falls: f64) -> Gain {
        let (mut enough, mut too_much) = (1, BINS);
        while enough + 1 < too_much {
            let middle = usize::midpoint(enough, too_much);
            if self.becomes(middle, falls) <= most { enough = middle } else { too_much = middle }
        }
        Gain(u32::try_from(enough).unwrap_or(u32::MAX))
    }

    /// Returns the sum if samples are doubled as often as it takes for all gains to be less.
    fn becomes(&self, least: usize, falls: f64) -> f64 {
        #[expect(clippy::cast_possible_truncation, clippy::cast_sign_loss, reason = "8 to 24")]
        let bins = libm::round(f64::from(OCTAVE) * libm::log2(2.0 / falls)) as usize;
        let mut sum = self.left;
        for (bin, square) in self.of.iter().enumerate().filter(|(_, square)| **square > 0.0) {
            let doublings = (bin + bins).saturating_sub(least) / bins;
            sum += square * (0..doublings).fold(1.0, |factor, _| factor * falls);
        }
        sum
    }
}

impl AddAssign<&Self> for SquaresByGain {
    fn add_assign(&mut self, other: &Self) {
        self.left += other.left;
        self.of.iter_mut().zip(&other.of).for_each(|(sum, other)| *sum += other);
    }
}
