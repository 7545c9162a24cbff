//! The number of samples that a frame needs for an error.

use std::ops::{AddAssign, SubAssign};

use crate::trace::Outlook;

/// The number of further samples that one or more frames need for each of a series of errors. Each error is the previous one divided by the
/// square root of two.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Demand([f64; LEVELS]);

const LEVELS: usize = 41;
/// The largest error, in output values. All pictures have a smaller one.
const LARGEST: f64 = 256.0;

impl Default for Demand {
    fn default() -> Self {
        Self([0.0; LEVELS])
    }
}

impl Demand {
    /// Returns the demand of a frame that already has some samples.
    pub(super) fn of(outlook: &Outlook<'_>) -> Self {
        Self::from_fn(|error| outlook.samples_for(error))
    }

    /// Returns the demand of a frame that needs `samples_for(error)` further samples.
    pub(super) fn from_fn(samples_for: impl Fn(f64) -> f64) -> Self {
        Self(std::array::from_fn(|level| samples_for(Self::error(level as f64))))
    }

    /// Returns the error at a level.
    pub(super) fn error(level: f64) -> f64 {
        LARGEST * libm::exp2(-level / 2.0)
    }

    /// Returns the level of an error.
    pub(super) fn level(error: f64) -> f64 {
        (-2.0 * libm::log2((error / LARGEST).max(f64::MIN_POSITIVE))).clamp(0.0, (LEVELS - 1) as f64)
    }

    /// Returns the number of samples needed to reach a level, 0 to 40.
    pub(super) fn samples(&self, level: f64) -> f64 {
        #[expect(clippy::cast_possible_truncation, clippy::cast_sign_loss, reason = "0 to 39")]
        let below = (level as usize).min(LEVELS - 2);
        let (low, high) = (self.0[below], self.0[below + 1]);
        low + (high - low) * (level - below as f64)
    }

    /// Returns the highest possible level. All levels below a possible level must be possible.
    pub(super) fn highest_level(is_possible: impl Fn(f64) -> bool) -> f64 {
        let (mut low, mut high) = (0.0, (LEVELS - 1) as f64);
        if is_possible(high) {
            return high;
        }
        for _ in 0..32 {
            let middle = f64::midpoint(low, high);
            if is_possible(middle) { low = middle } else { high = middle }
        }
        low
    }
}

impl AddAssign for Demand {
    fn add_assign(&mut self, other: Self) {
        self.0.iter_mut().zip(other.0).for_each(|(sum, other)| *sum += other);
    }
}

impl SubAssign for Demand {
    fn sub_assign(&mut self, other: Self) {
        self.0.iter_mut().zip(other.0).for_each(|(sum, other)| *sum = (*sum - other).max(0.0));
    }
}
