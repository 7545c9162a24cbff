//! Circular motion about an axis.

use glam::DVec3;

use super::Pace;
use super::angle::sine_cosine;

/// A circle about an axis, traversed at a [`Pace`].
///
/// With n the unit vector along the axis, the point is at `center + height n + radius (cos a e + sin a (n x e))`. The direction e, where
/// the angle a is 0, is the component of +z perpendicular to the axis; for an axis along z it is +x. Angles have the sense of rotations
/// about the axis: +90 degrees about y leads from +z to +x.
///
/// Angles are in turns, and are reduced to an eighth of a turn without rounding before sines are computed. After whole turns the point is
/// the same to the last bit, and quarter turns are exact.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Orbit {
    /// The centre of the circle, `height` along the axis from the given centre.
    center: DVec3,
    /// The vectors from the centre to the point at angle 0, and to the point at a quarter turn.
    arms: [DVec3; 2],
    from: f64,
    turns: f64,
    pace: Pace,
}

impl Orbit {
    /// Creates a circle of `radius` around `axis`, which passes through `center` and has any length but zero. `height` is the distance
    /// along the axis from `center` to the circle. Lengths are in scene units. The circle starts at angle 0, and one revolution takes one
    /// second. Returns `None` if the axis has no direction or a number is not finite.
    #[must_use]
    pub fn new(center: DVec3, axis: DVec3, radius: f64, height: f64) -> Option<Self> {
        let finite = center.is_finite() && axis.is_finite() && radius.is_finite() && height.is_finite();
        let axis = (axis / axis.abs().max_element()).try_normalize().filter(|_| finite)?;
        let arms = directions(axis).map(|direction| radius * direction);
        Some(Self { center: center + height * axis, arms, from: 0.0, turns: 1.0, pace: Pace::lasting(1.0) })
    }

    /// Returns the same circle with another start angle and another total angle. Both are in turns, finite, and of any sign.
    #[must_use]
    pub fn turned(self, from: f64, turns: f64) -> Self {
        Self { from, turns, ..self }
    }

    /// Returns the same circle at another pace.
    #[must_use]
    pub fn paced(self, pace: Pace) -> Self {
        Self { pace, ..self }
    }

    /// Returns the point at `seconds`.
    ///
    /// ```
    /// use glam::DVec3;
    /// use rayreel::animation::{Orbit, Pace};
    /// let orbit = Orbit::new(DVec3::ZERO, DVec3::Y, 2.0, 1.0).unwrap().paced(Pace::lasting(8.0));
    /// assert_eq!(orbit.at(0.0), DVec3::new(0.0, 1.0, 2.0)); // +z
    /// assert_eq!(orbit.at(2.0), DVec3::new(2.0, 1.0, 0.0)); // +x
    /// assert_eq!(orbit.at(8.0), orbit.at(0.0));
    /// ```
    #[must_use]
    pub fn at(&self, seconds: f64) -> DVec3 {
        let (sine, cosine) = self.sine_cosine(seconds);
        self.center + (cosine * self.arms[0] + sine * self.arms[1])
    }

    /// Returns the direction of motion at `seconds`, as a unit vector, also at rest. An easing that moves back for a while does not change
    /// it. Zero for a radius of 0.
    #[must_use]
    pub fn direction(&self, seconds: f64) -> DVec3 {
        let (sine, cosine) = self.sine_cosine(seconds);
        let tangent = cosine * self.arms[1] - sine * self.arms[0];
        let tangent = (tangent / tangent.abs().max_element()).try_normalize().unwrap_or_default();
        self.turns.signum() * self.pace.sense(seconds) * tangent
    }

    /// Returns the sine and the cosine of the angle at `seconds`.
    fn sine_cosine(&self, seconds: f64) -> (f64, f64) {
        sine_cosine(self.from.fract() + (self.turns * self.pace.progress(seconds)).fract(), 0.25)
    }
}

/// Returns unit vectors perpendicular to an axis of unit length: in the direction of angle 0, and of a quarter turn.
fn directions(axis: DVec3) -> [DVec3; 2] {
    /// The tolerance within which an axis counts as being along z.
    const ALONG: f64 = 1e-12;
    // Both are exact if the axis is a coordinate axis.
    let quarter = DVec3::new(axis.y, -axis.x, 0.0);
    if quarter.length() <= ALONG {
        [DVec3::X, axis.z.signum() * DVec3::Y]
    } else {
        let quarter = quarter.normalize();
        [quarter.cross(axis), quarter]
    }
}

#[cfg(test)]
mod tests {
    use std::f64::consts::TAU;

    use super::*;
    use crate::animation::{Ease, Easing, Playback, Repeat};

    #[test]
    fn angles_grow_as_rotations_about_the_axis_do() {
        let expected = [
            (DVec3::Y, [DVec3::Z, DVec3::X]),
            (DVec3::NEG_Y, [DVec3::Z, DVec3::NEG_X]),
            (DVec3::X, [DVec3::Z, DVec3::NEG_Y]),
            (DVec3::Z, [DVec3::X, DVec3::Y]),
            (DVec3::NEG_Z, [DVec3::X, DVec3::NEG_Y]),
            (DVec3::new(0.0, 1e-20, 1.0), [DVec3::X, DVec3::Y]),
        ];
        for (axis, [start, quarter]) in expected {
            for length in [1.0, 1e-200, 1e200] {
                let orbit = Orbit::new(DVec3::ZERO, length * axis, 1.0, 0.0).unwrap();
                assert_eq!(
                    [orbit.at(0.0), orbit.at(0.25), orbit.at(0.5)],
                    [start, quarter, -start],
                    "{axis}"
                );
            }
        }
    }

    #[test]
    fn directions_are_tangents_in_the_sense_of_motion() {
        for (turns, repeat) in [(1.0, Repeat::Clamp), (-2.5, Repeat::PingPong), (-1.0, Repeat::Loop)] {
            let playback = Playback { repeat, ..Playback::default() };
            let pace = Pace { playback, ..Pace::lasting(3.0) };
            let orbit = Orbit::new(DVec3::ONE, DVec3::new(1.0, 2.0, 3.0), 2.0, 0.5).unwrap();
            let orbit = orbit.turned(0.1, turns).paced(pace);
            for step in 1..700 {
                let time = f64::from(step) / 100.0 + 0.003;
                let moved = orbit.at(time + 1e-6) - orbit.at(time - 1e-6);
                let direction = orbit.direction(time);
                assert!((direction.length() - 1.0).abs() < 1e-14);
                assert!(
                    moved == DVec3::ZERO || direction.distance(moved.normalize()) < 1e-5,
                    "{turns} {time}"
                );
            }
        }
        assert_eq!(Orbit::new(DVec3::ONE, DVec3::Y, 0.0, 0.0).unwrap().direction(0.3), DVec3::ZERO);
    }

    #[test]
    fn orbits_turn_about_any_axis() {
        for axis in [DVec3::new(1.0, 2.0, 3.0), DVec3::new(-1.0, 0.5, 1e-3), DVec3::new(1e-9, 0.0, -1.0)] {
            let unit = axis.normalize();
            let center = DVec3::new(1.0, -2.0, 5.0);
            let orbit = Orbit::new(center, axis, 3.0, 2.0).unwrap().turned(0.1, -1.3);
            for step in 0..=100 {
                let u = f64::from(step) / 100.0;
                let arm = orbit.at(u) - center;
                assert!((arm.dot(unit) - 2.0).abs() < 1e-14, "{axis}");
                assert!(((arm - 2.0 * unit).length() - 3.0).abs() < 1e-14, "{axis}");
                let angle = TAU * (0.1 - 1.3 * u);
                let start = 3.0 * directions(unit)[0];
                let turned = glam::DQuat::from_axis_angle(unit, angle) * start + 2.0 * unit;
                assert!(arm.distance(turned) < 1e-13, "{axis} at {u}");
            }
        }
    }

    #[test]
    fn whole_turns_end_where_they_start_to_the_last_bit() {
        for turns in [1.0, -1.0, 3.0, -7.0, 1e6, 0.0] {
            for from in [0.0, 0.1, -0.7, 12.3, 0.25] {
                for (start, duration) in [(0.0, 1.0), (0.1, 0.2), (0.7, 5.6), (3.0, 1e-3)] {
                    for repeat in [Repeat::Clamp, Repeat::Loop] {
                        let playback = Playback { repeat, ..Playback::default() };
                        let ease = Easing::InOut(Ease::Sine);
                        let pace = Pace { start, duration, ease, playback };
                        let orbit = Orbit::new(DVec3::ONE, DVec3::new(1.0, 2.0, 0.3), 3.7, 0.1).unwrap();
                        let orbit = orbit.turned(from, turns).paced(pace);
                        assert_eq!(orbit.at(start), orbit.at(start + duration), "{orbit:?}");
                    }
                }
            }
        }
    }

    #[test]
    fn zero_radius_is_constant_and_zero_axis_is_no_orbit() {
        let orbit = Orbit::new(DVec3::ONE, DVec3::Y, 0.0, 0.0).unwrap();
        assert_eq!([orbit.at(0.0), orbit.at(0.3)], [DVec3::ONE; 2]);
        assert_eq!(Orbit::new(DVec3::ONE, DVec3::ZERO, 1.0, 0.0), None);
        assert_eq!(Orbit::new(DVec3::ONE, DVec3::Y, f64::NAN, 0.0), None);
        assert_eq!(Orbit::new(DVec3::ONE, DVec3::new(0.0, f64::INFINITY, 0.0), 1.0, 0.0), None);
    }
}
