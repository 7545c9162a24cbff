//! How urgently pixels need samples, and whose needs are met.

use std::ops::AddAssign;

use super::Convergence;

/// How urgently a pixel needs more samples, by powers of two and eighths of them: the bin of a histogram.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord)]
pub(super) struct Need(u32);

/// Bins of a power of two.
const OCTAVE: u32 = 8;
/// By exponent and the first three bits of the mantissa.
const SHIFT: u32 = f32::MANTISSA_DIGITS - 1 - OCTAVE.ilog2();
/// One for each number.
const BINS: usize = (f32::INFINITY.to_bits() >> SHIFT) as usize + 1;

impl Need {
    /// Returns that of a square error, which is not negative.
    #[inline(always)]
    pub(super) fn of(square: f32) -> Self {
        Self(square.to_bits() >> SHIFT)
    }
}

impl Convergence {
    /// By how many bins the square of an error per sample goes down when the number of samples is doubled.
    fn bins_of_doubling(self) -> usize {
        OCTAVE as usize * 2
            + match self {
                Self::Edges => OCTAVE as usize / 2,
                Self::Effects => 0,
            }
    }
}

/// The sums of pixels' square errors.
#[derive(Clone, Debug)]
pub(super) struct SquaresByNeed {
    /// Of those that get no more samples.
    left: f64,
    /// Of the others, by their need.
    of: Vec<f64>,
}

impl Default for SquaresByNeed {
    fn default() -> Self {
        Self { left: 0.0, of: vec![0.0; BINS] }
    }
}

impl SquaresByNeed {
    /// Adds pixels.
    #[inline(always)]
    pub(super) fn add(&mut self, [spread, missed]: [&[f32]; 2], needs: &[f32], samples: &[u32]) {
        for (((spread, missed), need), samples) in spread.iter().zip(missed).zip(needs).zip(samples) {
            let square = spread + missed;
            if square == 0.0 {
                // Many have none, and would wait for each other.
                continue;
            }
            let bin = (Need::of(*need).0 as usize).min(BINS - 1);
            let sum = if *samples == 0 { &mut self.of[bin] } else { &mut self.left };
            *sum += f64::from(square);
        }
    }

    /// Returns the least need that must be met for the sum of all to become `most` at last, and as little of it as can be told.
    pub(super) fn least_for(&self, most: f64, convergence: Convergence) -> Need {
        // It falls as less is left.
        let (mut enough, mut too_much) = (1, BINS);
        while enough + 1 < too_much {
            let middle = usize::midpoint(enough, too_much);
            if self.becomes(middle, convergence) <= most { enough = middle } else { too_much = middle }
        }
        Need(u32::try_from(enough).unwrap_or(u32::MAX))
    }

    /// Returns what the sum becomes if needs from one on are met, by doubling samples as often as it takes.
    fn becomes(&self, least: usize, convergence: Convergence) -> f64 {
        let (per_doubling, bins) = (convergence.of_doubling(), convergence.bins_of_doubling());
        let mut sum = self.left;
        for (bin, square) in self.of.iter().enumerate().filter(|(_, square)| **square > 0.0) {
            let doublings = (bin + bins).saturating_sub(least) / bins;
            sum += square * (0..doublings).fold(1.0, |factor, _| factor * per_doubling);
        }
        sum
    }
}

impl AddAssign<&Self> for SquaresByNeed {
    fn add_assign(&mut self, other: &Self) {
        self.left += other.left;
        self.of.iter_mut().zip(&other.of).for_each(|(sum, other)| *sum += other);
    }
}
