//! The times of the frames of a data file.

use crate::time::{FrameRate, Time};

/// The times at which the frames of a file are shown.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct FrameTiming {
    /// The time between the start of the timeline and the first frame of the file.
    pub start: Time,
    /// True if the first frame of the file comes before the start of the timeline.
    pub is_early: bool,
    /// The number of frames of the file per second.
    pub rate: FrameRate,
    /// The choice of values between two frames.
    pub between: Between,
    /// The choice of frames before the first and after the last one.
    pub end: End,
}

/// The values between two frames of a file.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub enum Between {
    /// The earlier frame.
    #[default]
    Hold,
    /// Values in proportion between the two.
    Linear,
}

/// The frames before the first and after the last frame of a file.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub enum End {
    /// The first, and the last frame.
    #[default]
    Hold,
    /// All frames over again. The last frame takes as long as the others, and is held.
    Loop,
}

/// The frames at a moment: the earlier one, the later one, and its share. Without a share there is no later frame.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) struct FramesAt {
    pub(super) frame: usize,
    pub(super) next: Option<(usize, f64)>,
}

impl FrameTiming {
    /// Returns the frames at a moment, of a file with `count` frames, at least one.
    #[expect(clippy::cast_precision_loss, reason = "the share is rounded")]
    pub(super) fn frames_at(&self, time: Time, count: usize) -> FramesAt {
        let ((moment, unit), (start, start_unit)) = (time.lowest_terms(), self.start.lowest_terms());
        let (frames, seconds) = self.rate.parts();
        let start = if self.is_early { -i128::from(start) } else { i128::from(start) };
        // In integers, so that a frame is shown from its own moment on. No product exceeds 2^127: times are below 2^53 units, and units
        // written with nine decimals, and parts of rates, are below 2^30 and 2^20.
        let since = i128::from(moment) * i128::from(start_unit) - start * i128::from(unit);
        let position = since.saturating_mul(i128::from(frames));
        let one = i128::from(unit).saturating_mul(i128::from(start_unit)).saturating_mul(i128::from(seconds));
        let (whole, rest) = (position.div_euclid(one), position.rem_euclid(one));
        let count = count.max(1);
        let last = count as i128 - 1;
        let frame = match self.end {
            End::Hold if whole < 0 => return FramesAt { frame: 0, next: None },
            End::Hold => whole.min(last),
            End::Loop => whole.rem_euclid(count as i128),
        };
        let is_between = self.between == Between::Linear && rest > 0 && frame < last;
        let frame = usize::try_from(frame).unwrap_or(0);
        FramesAt { frame, next: is_between.then(|| (frame + 1, rest as f64 / one as f64)) }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn frames_follow_from_times_exactly() {
        let time = |seconds: &str| seconds.parse::<Time>().unwrap();
        let held = FrameTiming {
            start: time("0.5"),
            is_early: false,
            rate: FrameRate::new(10, 1).unwrap(),
            between: Between::Hold,
            end: End::Hold,
        };
        let at = |times: FrameTiming, seconds| {
            let FramesAt { frame, next } = times.frames_at(time(seconds), 3);
            (frame, next)
        };
        for (seconds, frame) in [("0", 0), ("0.5", 0), ("0.599999999", 0), ("0.6", 1), ("0.7", 2), ("9", 2)] {
            assert_eq!(at(held, seconds), (frame, None), "{seconds}");
        }
        let linear = FrameTiming { between: Between::Linear, ..held };
        assert_eq!(at(linear, "0.625"), (1, Some((2, 0.25))));
        assert_eq!(at(linear, "0.6"), (1, None));
        assert_eq!(at(linear, "0.75"), (2, None));
        let looped = FrameTiming { end: End::Loop, ..linear };
        for (seconds, frame) in [("0.4", 2), ("0.2", 0), ("0.5", 0), ("0.79", 2), ("0.8", 0), ("1.5", 1)] {
            assert_eq!(at(looped, seconds).0, frame, "{seconds}");
        }
        let early = FrameTiming { is_early: true, ..held };
        assert_eq!(at(early, "0"), (2, None));
    }
}
