//! The frames of a scene: a rate and a duration.

use super::{FrameRate, Time};

/// The frame rate and the duration of a scene.
///
/// The frames are those whose time, rounded once to `f64`, is less than the duration, rounded once to `f64`.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Timeline {
    /// Frames per second.
    pub rate: FrameRate,
    /// The duration in seconds; 0 or more. A timeline always has at least its first frame.
    pub duration: f64,
}

impl Timeline {
    /// The largest number of frames.
    pub const LARGEST_COUNT: u32 = 100_000_000;

    /// Creates a timeline with a whole number of frames per second, clamped to 1..=[`FrameRate::LARGEST_PART`], and a duration in seconds.
    #[must_use]
    pub fn new(per_second: u32, duration: f64) -> Self {
        let rate = FrameRate::new(per_second.clamp(1, FrameRate::LARGEST_PART), 1).unwrap_or_default();
        Self { rate, duration }
    }

    /// Returns a timeline of a single frame at time 0.
    #[must_use]
    pub fn still() -> Self {
        Self { rate: FrameRate::default(), duration: 0.0 }
    }

    /// Returns the number of frames, at least 1 and at most [`Self::LARGEST_COUNT`].
    ///
    /// ```
    /// use rayreel::time::Timeline;
    /// assert_eq!(Timeline::new(24, 4.0).frame_count(), 96); // the last frame is at 95/24 s; a loop has no doubled frame
    /// assert_eq!(Timeline::still().frame_count(), 1);
    /// ```
    #[must_use]
    #[expect(
        clippy::cast_possible_truncation,
        clippy::cast_sign_loss,
        reason = "clamped to the range before"
    )]
    pub fn frame_count(&self) -> u32 {
        let estimate = (self.duration.max(0.0) * self.rate.per_second()).ceil();
        let mut count = estimate.clamp(1.0, f64::from(Self::LARGEST_COUNT)) as u32;
        // The estimate is rounded; the definition decides.
        let plays = |index: u32| self.time_of(index).seconds() < self.duration;
        while count > 1 && !plays(count - 1) {
            count -= 1;
        }
        while count < Self::LARGEST_COUNT && plays(count) {
            count += 1;
        }
        count
    }

    /// Returns the instants at which a frame is drawn. The shutter is open for the fraction `open` of the frame interval, rounded to
    /// millionths and centred on the frame's time. The instants are the midpoints of `count` equal parts of the open interval. Instants
    /// before the start are moved to the start.
    ///
    /// ```
    /// use rayreel::time::Timeline;
    /// let timeline = Timeline::new(10, 1.0);
    /// let instants = timeline.instants(timeline.time_of(1), 0.5, 2);
    /// assert_eq!(instants, ["0.0875", "0.1125"].map(|time| time.parse().unwrap()));
    /// ```
    #[must_use]
    #[expect(clippy::cast_possible_truncation, reason = "a share of a million")]
    pub fn instants(&self, time: Time, open: f64, count: u32) -> Vec<Time> {
        const PARTS: f64 = 1e6;
        let open = (open.clamp(0.0, 1.0) * PARTS).round() as i128;
        let (frames, seconds) = self.rate.parts();
        let parts = (2_000_000 * u64::from(count)).saturating_mul(frames.into());
        let offset = |index: u32| {
            let middle = 2 * i128::from(index) + 1 - i128::from(count);
            middle * open * i128::from(seconds)
        };
        (0..count).map(|index| time.moved(offset(index), parts).unwrap_or(time)).collect()
    }

    /// Returns the time of frame `index`.
    #[must_use]
    pub fn time_of(&self, index: u32) -> Time {
        self.rate.time_of(index)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn frame_counts_follow_the_definition() {
        for (numerator, denominator) in [(24, 1), (30_000, 1001), (1, 3), (60, 1), (7, 3)] {
            let rate = FrameRate::new(numerator, denominator).unwrap();
            for hundredths in 0..1000 {
                let timeline = Timeline { rate, duration: f64::from(hundredths) / 100.0 };
                let count = timeline.frame_count();
                let naive =
                    (0..).take_while(|index| timeline.time_of(*index).seconds() < timeline.duration).count();
                assert_eq!(count as usize, naive.max(1), "{timeline:?}");
            }
        }
    }
}
