//! Frame rates as exact ratios of integers.

use super::Time;

/// Frames per second as a ratio of integers: 24/1, or 30000/1001 for NTSC.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct FrameRate {
    numerator: u32,
    denominator: u32,
}

impl FrameRate {
    /// The largest numerator or denominator, so that every frame's time is a ratio of integers exact in `f64`.
    pub const LARGEST_PART: u32 = 1_000_000;

    /// Creates a rate of `numerator / denominator` frames per second. Returns `None` unless both are in 1..=[`Self::LARGEST_PART`].
    #[must_use]
    pub fn new(numerator: u32, denominator: u32) -> Option<Self> {
        let allowed = 1..=Self::LARGEST_PART;
        (allowed.contains(&numerator) && allowed.contains(&denominator))
            .then_some(Self { numerator, denominator })
    }

    /// Returns the time of frame `index`: exactly `index * denominator / numerator` seconds.
    ///
    /// ```
    /// use rayreel::time::FrameRate;
    /// assert_eq!(FrameRate::new(24, 1).unwrap().time_of(14_400).seconds(), 600.0);
    /// assert_eq!(FrameRate::new(30_000, 1001).unwrap().time_of(1_000_000).seconds(), 33366.666666666667);
    /// ```
    #[must_use]
    pub fn time_of(self, index: u32) -> Time {
        Time {
            numerator: u64::from(index) * u64::from(self.denominator),
            denominator: u64::from(self.numerator),
        }
    }

    /// Returns a time in frames: an integer at the time of a frame, and a fraction between frames.
    #[expect(clippy::cast_precision_loss, reason = "frames beyond 2^53 are none")]
    pub(crate) fn frames_at(self, time: Time) -> f64 {
        let numerator = u128::from(time.numerator) * u128::from(self.numerator);
        let denominator = u128::from(time.denominator) * u128::from(self.denominator);
        let (whole, rest) = (numerator / denominator, numerator % denominator);
        whole as f64 + rest as f64 / denominator as f64
    }

    /// Returns the moment at `seconds`, which may be negative: its seconds, and its time in frames. A moment within a nanosecond of a
    /// frame's moment is that moment, bit for bit: differences such as `17 / 24 - 0.5` are rounded, and frame 5 is meant.
    pub(crate) fn moment_at(self, seconds: f64) -> (f64, f64) {
        const TOLERANCE: f64 = 1e-9;
        let (numerator, denominator) = (f64::from(self.numerator), f64::from(self.denominator));
        let frames = seconds * numerator / denominator;
        // Rounded once, like `Time::seconds`. The sum with 0 removes the sign of -0.
        let (nearest, of_frame) = (frames.round() + 0.0, frames.round() * denominator / numerator + 0.0);
        match (of_frame - seconds).abs() <= TOLERANCE {
            true => (of_frame, nearest),
            false => (seconds, frames),
        }
    }

    /// Returns the ratio's numerator and denominator.
    #[must_use]
    pub fn parts(self) -> (u32, u32) {
        (self.numerator, self.denominator)
    }

    /// Returns the frames per second, rounded to `f64`.
    #[must_use]
    pub fn per_second(self) -> f64 {
        f64::from(self.numerator) / f64::from(self.denominator)
    }
}

impl Default for FrameRate {
    /// Returns 24 frames per second.
    fn default() -> Self {
        Self { numerator: 24, denominator: 1 }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn moments_of_frames_are_whole_in_frames() {
        let rate = FrameRate::new(30_000, 1001).unwrap();
        assert_eq!(rate.frames_at(rate.time_of(1_000_000)), 1e6);
        assert_eq!(FrameRate::new(24, 1).unwrap().frames_at("0.1".parse().unwrap()), 2.4);
    }

    #[test]
    fn differences_of_frames_are_frames() {
        for (numerator, denominator) in [(24, 1), (30_000, 1001), (1, 3), (60, 1), (1_000_000, 1)] {
            let rate = FrameRate::new(numerator, denominator).unwrap();
            let seconds = |frame: u32| rate.time_of(frame).seconds();
            for frame in 0..1000_u32 {
                for delay in [0, 1, 12, 997] {
                    let (found, frames) = rate.moment_at(seconds(frame) - seconds(delay));
                    let expected = seconds(frame.abs_diff(delay));
                    let expected = if frame < delay { -expected } else { expected };
                    assert_eq!(found.to_bits(), expected.to_bits(), "{frame} {delay}");
                    assert_eq!(frames, f64::from(frame) - f64::from(delay));
                }
            }
        }
        let rate = FrameRate::new(24, 1).unwrap();
        assert_eq!(rate.moment_at(0.1), (0.1, 0.1 * 24.0));
        assert_eq!(rate.moment_at(0.5 + 2e-9), (0.5 + 2e-9, (0.5 + 2e-9) * 24.0));
        assert!(rate.moment_at(-1e-300).0.is_sign_positive());
        assert!(rate.moment_at(1e60).1.is_finite());
    }

    #[test]
    fn a_sum_of_steps_would_drift_where_this_does_not() {
        let rate = FrameRate::new(24, 1).unwrap();
        let summed = (0..14_400).fold(0.0, |time, _| time + 1.0 / 24.0);
        assert!(summed > 600.0);
        assert_eq!(rate.time_of(14_400).seconds(), 600.0);
    }
}
