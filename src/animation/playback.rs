//! The mapping from time to the time of a track's keys.

/// The behaviour of a track before its first and after its last key.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub enum Repeat {
    /// Holds the value of the nearest key.
    #[default]
    Clamp,
    /// Starts again at the first key. At the time of the last key, the track has the value of the first key.
    Loop,
    /// Alternates between forwards and backwards.
    PingPong,
}

/// The playback of keys: at `t` seconds, a track has the value of its keys at `speed (t - offset)`.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Playback {
    /// The behaviour beyond the keys.
    pub repeat: Repeat,
    /// The time on the timeline that is 0 for the keys; seconds, finite.
    pub offset: f64,
    /// Seconds of the keys per second of the timeline; finite and not 0. Negative speeds play backwards.
    pub speed: f64,
}

impl Default for Playback {
    fn default() -> Self {
        Self { repeat: Repeat::Clamp, offset: 0.0, speed: 1.0 }
    }
}

impl Playback {
    /// Returns the keys' time at `seconds`, for keys from `first` to `last`.
    pub(super) fn time(self, seconds: f64, first: f64, last: f64) -> f64 {
        self.time_and_sense(seconds, first, last).0
    }

    /// Returns the keys' time at `seconds`, for keys from `first` to `last`, and whether it increases (1) or decreases (-1) from there on,
    /// had it no end.
    pub(super) fn time_and_sense(self, seconds: f64, first: f64, last: f64) -> (f64, f64) {
        let (time, sense) = ((seconds - self.offset) * self.speed, self.speed.signum());
        let period = last - first;
        if self.repeat == Repeat::Clamp || period <= 0.0 {
            return (time, sense);
        }
        // A time before the seam by no more than the rounding error counts as the seam: the frame there must show the start.
        let rounding = self.rounding(seconds, first);
        let within = |period: f64| {
            let since = (time - first).rem_euclid(period);
            if period - since <= rounding { 0.0 } else { since }
        };
        match self.repeat {
            Repeat::PingPong => {
                let since = within(2.0 * period);
                let is_forward = if sense > 0.0 { since < period } else { since > 0.0 && since <= period };
                let time = if since <= period { first + since } else { last - (since - period) };
                (time, if is_forward { sense } else { -sense })
            }
            _ => (first + within(period), sense),
        }
    }

    /// Returns the largest rounding error of a time since `first`.
    pub(super) fn rounding(self, seconds: f64, first: f64) -> f64 {
        4.0 * f64::EPSILON * ((seconds.abs() + self.offset.abs()) * self.speed.abs() + first.abs())
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn times(playback: Playback, seconds: &[f64]) -> Vec<f64> {
        seconds.iter().map(|seconds| playback.time(*seconds, 1.0, 3.0)).collect()
    }

    #[test]
    fn times_repeat_turn_shift_and_scale() {
        let moments = [-1.0, -0.5, 0.0, 1.0, 2.5, 3.0, 3.5, 5.0, 6.0];
        let clamp = Playback::default();
        assert_eq!(times(clamp, &moments), moments);
        let again = Playback { repeat: Repeat::Loop, ..clamp };
        assert_eq!(times(again, &moments), [1.0, 1.5, 2.0, 1.0, 2.5, 1.0, 1.5, 1.0, 2.0]);
        let turn = Playback { repeat: Repeat::PingPong, ..clamp };
        assert_eq!(times(turn, &moments), [3.0, 2.5, 2.0, 1.0, 2.5, 3.0, 2.5, 1.0, 2.0]);
        let late = Playback { offset: 0.5, speed: 2.0, ..clamp };
        assert_eq!(times(late, &[0.5, 1.0, 2.0]), [0.0, 1.0, 3.0]);
        let backwards = Playback { offset: 4.0, speed: -1.0, ..again };
        assert_eq!(times(backwards, &[0.0, 1.0, 1.5, 2.0, 3.0]), [2.0, 1.0, 2.5, 2.0, 1.0]);
    }

    /// Checks decimal periods, which are not exact in binary: 0.7 is less than 7 times 0.1.
    #[test]
    fn the_frame_at_a_seam_shows_the_start() {
        for (fps, period) in [(10, 0.1), (10, 0.3), (10, 0.7), (24, 1.0 / 24.0), (30, 0.1), (60, 0.05)] {
            let again = Playback { repeat: Repeat::Loop, ..Playback::default() };
            let frames = (period * f64::from(fps)).round();
            for round in 0..20_000_u32 {
                let seconds = f64::from(round) * frames / f64::from(fps);
                let found = again.time(seconds, 0.0, period);
                assert!(found < 1e-9, "{fps} frames a second, round {round} of {period} s: {found}");
            }
        }
    }
}
