//! The gain of sampling a pixel further, and the minimum gain for which samples are taken.

use std::ops::AddAssign;

use crate::color::ErrorNorm;

/// The gain of sampling a pixel further: its squared error, divided by its sample count for the RMS norm. It is stored as a histogram bin,
/// eight per power of two, and a random part within the bin, so that a threshold can select a fraction of a bin's pixels.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord)]
pub(super) struct Gain(u32);

/// Bins per power of two.
const OCTAVE: u32 = 8;
/// Discards the mantissa except for its first three bits. Exponent and kept bits form the bin index.
const SHIFT: u32 = f32::MANTISSA_DIGITS - 1 - OCTAVE.ilog2();
/// Number of bins, for all finite values and infinity.
const BINS: usize = (f32::INFINITY.to_bits() >> SHIFT) as usize + 1;
/// Parts per bin.
const PARTS: u32 = 256;

impl Gain {
    /// Returns the gain of a pixel with squared error `square` (at least 0), divided by the sample count if required. The low 8 bits of
    /// `chance` give the part.
    #[inline(always)]
    pub(super) fn of(square: f32, chance: u32) -> Self {
        Self((square.to_bits() >> SHIFT) * PARTS + chance % PARTS)
    }

    /// Returns the threshold in a bin below which the fraction `part` of its pixels lies.
    fn above(bin: usize, part: f64) -> Self {
        #[expect(clippy::cast_possible_truncation, clippy::cast_sign_loss, reason = "0 to 256")]
        let part = (part.clamp(0.0, 1.0) * f64::from(PARTS)) as u32;
        Self(u32::try_from(bin).unwrap_or(0) * PARTS + part)
    }
}

impl From<u32> for Gain {
    fn from(bits: u32) -> Self {
        Self(bits)
    }
}

impl From<Gain> for u32 {
    fn from(gain: Gain) -> Self {
        gain.0
    }
}

/// Histogram of the squared errors and sample counts of pixels, by gain.
#[derive(Clone, Debug)]
pub(super) struct SquaresByGain(Vec<Bin>);

#[derive(Clone, Copy, Debug, Default)]
struct Bin {
    /// Sum of the squared errors of pixels at their maximum sample count.
    left: f64,
    /// Sum of the squared errors of the other pixels, and the number of samples they would take in the next round.
    squares: f64,
    more: f64,
    /// Number of samples that they can take in all rounds.
    room: f64,
}

impl Default for SquaresByGain {
    fn default() -> Self {
        Self(vec![Bin::default(); BINS])
    }
}

impl SquaresByGain {
    /// Adds `count` pixels with equal gain and squared error. Each takes `more` samples in its next round, and at most `room` in all rounds.
    #[inline(always)]
    pub(super) fn add(&mut self, gain: Gain, count: u32, square: f32, more: u32, room: u32) {
        let bin = &mut self.0[((gain.0 / PARTS) as usize).min(BINS - 1)];
        let squares = f64::from(count) * f64::from(square);
        if more > 0 {
            bin.squares += squares;
            bin.more += f64::from(count) * f64::from(more);
            bin.room += f64::from(count) * f64::from(room);
        } else {
            bin.left += squares;
        }
    }

    /// Returns the minimum gain for reducing the sum of all squared errors to `most`, and the total number of samples this takes in all
    /// rounds. Doubling the sample count of a pixel multiplies its squared error by `falls`.
    ///
    /// For independent samples, sampling where the gain is largest is the optimal allocation: Neyman, "On the Two Different Aspects of the
    /// Representative Method" (1934).
    pub(super) fn least_for(&self, most: f64, falls: f64) -> (Gain, f64) {
        let (mut enough, mut too_much) = (1, BINS);
        while enough + 1 < too_much {
            let middle = usize::midpoint(enough, too_much);
            if self.after(middle, falls).0 <= most { enough = middle } else { too_much = middle }
        }
        let (low, high) = (self.after(enough, falls), self.after(enough + 1, falls));
        let part = if high.0 > low.0 { ((most - low.0) / (high.0 - low.0)).clamp(0.0, 1.0) } else { 0.0 };
        (Gain::above(enough, part), low.1 + part * (high.1 - low.1))
    }

    /// Returns the minimum gain with which doubling the sample counts of pixels takes at most `samples` samples.
    pub(super) fn least_within(&self, samples: f64) -> Gain {
        let mut left = samples;
        for (bin, Bin { more, .. }) in self.0.iter().enumerate().skip(1).rev() {
            if *more > left {
                return Gain::above(bin, 1.0 - left.max(0.0) / more);
            }
            left -= more;
        }
        Gain::above(1, 0.0)
    }

    /// Returns the sum of squared errors once sample counts are doubled until all gains are below bin `least`, and the number of samples
    /// this takes.
    fn after(&self, least: usize, falls: f64) -> (f64, f64) {
        // Each doubling reduces the gain by the factor falls / 2.
        #[expect(clippy::cast_possible_truncation, clippy::cast_sign_loss, reason = "8 to 24")]
        let bins = libm::round(f64::from(OCTAVE) * libm::log2(2.0 / falls)) as usize;
        let mut sums = (0.0, 0.0);
        for (bin, Bin { left, squares, more: samples, room }) in self.filled() {
            let doublings = (bin + bins).saturating_sub(least) / bins;
            let (factor, more) =
                (0..doublings).fold((1.0, 1.0), |(factor, more), _| (factor * falls, 2.0 * more));
            sums = (sums.0 + left + squares * factor, sums.1 + (samples * (more - 1.0)).min(*room));
        }
        sums
    }

    /// Returns the bins that hold pixels.
    fn filled(&self) -> impl Iterator<Item = (usize, &Bin)> {
        self.0.iter().enumerate().filter(|(_, bin)| bin.squares > 0.0 || bin.left > 0.0)
    }

    /// Returns the error magnitude that `pixels` pixels are expected to exceed. Gains must be squared errors.
    pub(super) fn exceeded_by(&self, pixels: f64) -> f64 {
        let largest = self.filled().last().map_or(0.0, |(bin, _)| square_of(bin).sqrt());
        let (mut low, mut high) = (0.0, FARTHEST * largest);
        for _ in 0..40 {
            let middle = f64::midpoint(low, high);
            if self.beyond(middle, BINS) > pixels { low = middle } else { high = middle }
        }
        high
    }

    /// Returns the minimum gain, a squared error, such that at most `pixels` pixels exceed `error` if no pixel has a larger gain.
    pub(super) fn least_to_exceed(&self, error: f64, pixels: f64) -> Gain {
        let (mut enough, mut too_much) = (1, BINS);
        while enough + 1 < too_much {
            let middle = usize::midpoint(enough, too_much);
            if self.beyond(error, middle) <= pixels { enough = middle } else { too_much = middle }
        }
        Gain::above(enough, 0.0)
    }

    /// Returns the expected number of pixels that exceed `error` if squared errors are limited to bin `most`, for normally distributed
    /// errors.
    fn beyond(&self, error: f64, most: usize) -> f64 {
        let tail = |(bin, Bin { left, squares, .. }): (usize, &Bin)| {
            let deviations = error / square_of(bin.min(most)).sqrt();
            (left + squares) / square_of(bin) * libm::erfc(deviations / std::f64::consts::SQRT_2)
        };
        self.filled().map(tail).sum()
    }
}

/// Search limit in standard deviations; normal variates never lie that far from their mean.
const FARTHEST: f64 = 40.0;

/// Returns the squared error at the middle of a bin.
fn square_of(bin: usize) -> f64 {
    let bits = ((u32::try_from(bin).unwrap_or(0) << SHIFT) + (1 << (SHIFT - 1))).min(f32::MAX.to_bits());
    f64::from(f32::from_bits(bits))
}

impl AddAssign<&Self> for SquaresByGain {
    fn add_assign(&mut self, other: &Self) {
        for (sum, other) in self.0.iter_mut().zip(&other.0) {
            sum.left += other.left;
            sum.squares += other.squares;
            sum.more += other.more;
            sum.room += other.room;
        }
    }
}

/// Returns the number of pixels whose error may exceed the target as a function of the pixel count; `None` for the RMS norm.
pub(super) fn beyond(norm: ErrorNorm) -> Option<fn(f64) -> f64> {
    match norm {
        ErrorNorm::Rms => None,
        // 0.2 pixels on average: no pixel exceeds the target in four of five pictures.
        ErrorNorm::Max => Some(|_| 0.2),
        ErrorNorm::P99 => Some(|pixels| 0.01 * pixels),
    }
}
