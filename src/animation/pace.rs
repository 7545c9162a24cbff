//! The timing of motion along a path.

use super::{Easing, Playback, Repeat};

/// The timing of motion along a path: the fraction covered at each time.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Pace {
    /// The start, in seconds; finite.
    pub start: f64,
    /// The duration, in seconds; finite. At 0 or less, motion jumps to the end of the path at `start`.
    pub duration: f64,
    /// The easing of the motion. [`Easing::Linear`] gives constant speed, as do the easings that bend curves between keys.
    pub ease: Easing,
    /// The playback before the start and after the end. The ends hold unless it repeats.
    pub playback: Playback,
}

impl Pace {
    /// Returns a pace of constant speed that starts at 0 s and takes `duration` seconds.
    #[must_use]
    pub fn lasting(duration: f64) -> Self {
        Self { start: 0.0, duration, ease: Easing::Linear, playback: Playback::default() }
    }

    /// Returns the time after which nothing moves, in seconds; `None` for a pace that repeats.
    ///
    /// ```
    /// use rayreel::animation::{Pace, Playback};
    /// let pace = Pace { start: 1.0, ..Pace::lasting(2.0) };
    /// let late = Playback { offset: 4.0, speed: 0.5, ..Playback::default() };
    /// let backwards = Playback { speed: -0.5, ..late };
    /// let ends = [pace.playback, late, backwards].map(|playback| Pace { playback, ..pace }.end());
    /// assert_eq!(ends, [Some(3.0), Some(10.0), Some(2.0)]);
    /// ```
    #[must_use]
    pub fn end(self) -> Option<f64> {
        let Playback { repeat, offset, speed } = self.playback;
        let last = if speed > 0.0 { self.start + self.duration.max(0.0) } else { self.start };
        (repeat == Repeat::Clamp).then(|| offset + last / speed)
    }

    /// Returns the fraction of the path that is covered at `seconds`: 0 at the start and exactly 1 at the end. In between, an easing that
    /// overshoots leaves this range.
    ///
    /// ```
    /// use rayreel::animation::{Easing, Pace};
    /// let pace = Pace { start: 1.0, ease: Easing::EaseIn, ..Pace::lasting(2.0) };
    /// assert_eq!([0.0, 1.0, 2.0, 3.0, 4.0].map(|seconds| pace.progress(seconds)), [0.0, 0.0, 0.25, 1.0, 1.0]);
    /// ```
    #[must_use]
    pub fn progress(self, seconds: f64) -> f64 {
        let end = self.start + self.duration;
        let time = self.playback.time(seconds, self.start, end);
        if time < self.start {
            return 0.0;
        }
        // As at a seam, a time before the end by no more than the rounding error counts as the end.
        if end - time <= self.playback.rounding(seconds, self.start) {
            return self.ease.progress(1.0);
        }
        self.ease.progress((time - self.start) / self.duration)
    }
}

impl Pace {
    /// Returns the sense in which the path is traversed at `seconds`, also at rest: 1 from its start to its end, or -1.
    pub(super) fn sense(self, seconds: f64) -> f64 {
        self.playback.time_and_sense(seconds, self.start, self.start + self.duration).1
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::animation::Ease;

    #[test]
    fn progress_follows_the_easing() {
        type Profile = fn(f64) -> f64;
        let profiles: [(Easing, Profile); 4] = [
            (Easing::Linear, |u| u),
            (Easing::InOut(Ease::Sine), |u| 0.5 - 0.5 * libm::cos(std::f64::consts::PI * u)),
            (Easing::In(Ease::Quad), |u| u * u),
            (Easing::Out(Ease::Cubic), |u| 1.0 - (1.0 - u) * (1.0 - u) * (1.0 - u)),
        ];
        for (ease, expected) in profiles {
            let pace = Pace { start: 0.5, ease, ..Pace::lasting(4.0) };
            for step in 0..=400 {
                let u = f64::from(step) / 400.0;
                let found = pace.progress(0.5 + 4.0 * u);
                assert!((found - expected(u)).abs() < 1e-14, "{ease:?} at {u}: {found}");
            }
        }
    }

    /// Decimal starts and durations are not exact in binary: 0.1 + 0.2 is not 0.3.
    #[test]
    fn the_end_is_reached_in_the_frame_where_it_is_written() {
        for start in 0..30_u32 {
            for length in 1..30_u32 {
                let tenths = |count: u32| f64::from(count) / 10.0;
                let pace = Pace { start: tenths(start), ..Pace::lasting(tenths(length)) };
                assert_eq!(pace.progress(tenths(start)), 0.0);
                assert_eq!(pace.progress(tenths(start + length)), 1.0, "{pace:?}");
                assert!(pace.progress(tenths(start + length) - 1e-9) < 1.0);
                let again = Playback { repeat: Repeat::Loop, ..Playback::default() };
                let again = Pace { playback: again, ..pace };
                assert!(again.progress(tenths(start + length)) < 1e-14);
            }
        }
    }

    #[test]
    fn zero_duration_ends_at_the_start() {
        let pace = Pace { start: 1.0, ..Pace::lasting(0.0) };
        assert_eq!([0.0, 1.0, 2.0].map(|seconds| pace.progress(seconds)), [0.0, 1.0, 1.0]);
    }
}
