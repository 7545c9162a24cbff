//! Rotation about an axis by any number of turns.

use glam::{DQuat, DVec3};

use super::{Pace, Rotation};

/// A rotation about an axis that progresses at a [`Pace`], by any number of turns.
///
/// Whole turns are subtracted before sines are computed: after whole turns the rotation is the same to the last bit, and quarter turns are
/// as exact as those of [`Rotation::AxisAngle`].
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Turns {
    axis: DVec3,
    /// The angle at the start, in degrees.
    from: f64,
    turns: f64,
    pace: Pace,
}

impl Turns {
    /// Creates a rotation by `turns` about an axis of any length but zero, from the angle `from` in degrees. Both numbers are finite and of
    /// any sign. Returns `None` if the axis has no direction.
    #[must_use]
    pub fn new(axis: DVec3, from: f64, turns: f64, pace: Pace) -> Option<Self> {
        let has_direction = axis.is_finite() && axis != DVec3::ZERO;
        has_direction.then_some(Self { axis, from, turns, pace })
    }

    /// Returns the rotation at `seconds`.
    ///
    /// ```
    /// use glam::{DQuat, DVec3};
    /// use rayreel::animation::{Pace, Rotation, Turns};
    /// let turns = Turns::new(DVec3::Y, 0.0, 3.0, Pace::lasting(6.0)).unwrap();
    /// assert_eq!(turns.at(0.5), Rotation::AxisAngle(DVec3::Y, 90.0).quaternion());
    /// assert_eq!(turns.at(6.0), DQuat::IDENTITY);
    /// ```
    #[must_use]
    pub fn at(&self, seconds: f64) -> DQuat {
        let turned = (self.turns * self.pace.progress(seconds)).fract();
        Rotation::AxisAngle(self.axis, self.from % 360.0 + 360.0 * turned).quaternion()
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::animation::{Ease, Easing, Playback, Repeat};

    const AXIS: DVec3 = DVec3::new(1.0, -2.0, 0.5);

    /// Returns the difference of two rotations, whose quaternions may have opposite signs.
    fn apart(one: DQuat, other: DQuat) -> f64 {
        (one - other).length().min((one + other).length())
    }

    #[test]
    fn the_angle_grows_evenly_over_all_turns() {
        for (from, count) in [(0.0, 2.0), (30.0, -3.5), (-700.0, 0.1), (0.0, 1e6)] {
            let turns = Turns::new(AXIS, from, count, Pace { start: 1.0, ..Pace::lasting(4.0) }).unwrap();
            for step in 0..=400 {
                let u = f64::from(step) / 400.0;
                let expected = Rotation::AxisAngle(AXIS, from + 360.0 * (count * u).fract()).quaternion();
                assert!(
                    apart(turns.at(1.0 + 4.0 * u), expected) < 1e-14 * (100.0 + count.abs()),
                    "{from} {count} {u}"
                );
            }
        }
    }

    #[test]
    fn quarter_and_whole_turns_are_exact() {
        for axis in [DVec3::Y, DVec3::NEG_Z, AXIS] {
            for (from, start, duration) in [(0.0, 0.0, 8.0), (30.0, 0.1, 0.2), (-45.0, 0.7, 5.6)] {
                let turns = Turns::new(axis, from, 2.0, Pace { start, ..Pace::lasting(duration) }).unwrap();
                assert_eq!(turns.at(start), Rotation::AxisAngle(axis, from).quaternion());
                assert_eq!(turns.at(start), turns.at(start + duration));
            }
            let turns = Turns::new(axis, 0.0, 2.0, Pace::lasting(8.0)).unwrap();
            for quarter in 0..8 {
                let angle = 90.0 * f64::from(quarter % 4);
                assert_eq!(turns.at(f64::from(quarter)), Rotation::AxisAngle(axis, angle).quaternion());
            }
        }
    }

    /// Checks that a loop of whole turns has the same step between all frames, also across the seam.
    #[test]
    fn loops_of_whole_turns_have_no_kink() {
        for count in [1.0, -2.0, 7.0] {
            let playback = Playback { repeat: Repeat::Loop, ..Playback::default() };
            let turns = Turns::new(AXIS, 12.0, count, Pace { playback, ..Pace::lasting(3.0) }).unwrap();
            let step = |frame: i32| {
                let [before, after] = [frame, frame + 1].map(|frame| turns.at(f64::from(frame) / 24.0));
                apart(before.conjugate() * after, DQuat::IDENTITY)
            };
            for frame in -100..200 {
                assert!((step(frame) - step(0)).abs() < 1e-12, "{count}: {frame}");
            }
        }
    }

    #[test]
    fn progress_follows_the_easing() {
        let pace = Pace { ease: Easing::In(Ease::Quad), ..Pace::lasting(2.0) };
        let turns = Turns::new(DVec3::Z, 0.0, 4.0, pace).unwrap();
        assert_eq!(turns.at(1.0), DQuat::IDENTITY);
        assert_eq!(turns.at(0.5), Rotation::AxisAngle(DVec3::Z, 90.0).quaternion());
        assert_eq!(Turns::new(DVec3::ZERO, 0.0, 1.0, pace), None);
    }
}
