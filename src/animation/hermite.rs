//! Smooth curves through keys, from the gaps between neighbouring keys.

use glam::DVec3;

/// The gap between a key and the next: the difference of their values, and their distance in seconds or along a curve.
#[derive(Clone, Copy, Debug)]
pub(super) struct Gap {
    pub(super) difference: DVec3,
    pub(super) length: f64,
}

/// A segment with the gaps on both sides. There is no gap before the first key and after the last one.
#[derive(Clone, Copy, Debug)]
pub(super) struct Stretch {
    pub(super) before: Option<Gap>,
    pub(super) here: Gap,
    pub(super) after: Option<Gap>,
}

/// A rule for the slope at a key, from the average slopes of the gaps on its left and right, and the slope of the parabola through the key
/// and its neighbours.
type Rule = fn(left: DVec3, right: DVec3, parabola: DVec3) -> DVec3;

/// The smallest ratio of gap lengths that is used, so that slopes are finite however close two keys are.
const SHORTEST: f64 = 1e-150;

impl Stretch {
    /// Returns slopes at both ends that reproduce a parabola.
    pub(super) fn parabolic(self) -> [DVec3; 2] {
        self.slopes(|_, _, parabola| parabola)
    }

    /// Returns slopes at both ends that keep each component within the range of its two keys (Steffen, A Simple Method for Monotonic
    /// Interpolation in One Dimension, 1990).
    pub(super) fn monotone(self) -> [DVec3; 2] {
        self.slopes(|left, right, parabola| {
            let least = (2.0 * left.abs().min(right.abs())).min(parabola.abs());
            let agrees = (left * right).cmpgt(DVec3::ZERO);
            DVec3::select(agrees, least.copysign(left), DVec3::ZERO)
        })
    }

    /// Returns the slopes of the centripetal Catmull-Rom curve, and the position along it at elapsed fraction `u` of the time; `None` if
    /// the two keys have the same value.
    ///
    /// The distance between knots is the square root of the distance between values, which rules out cusps and loops (Yuksel, Schaefer,
    /// Keyser, Parameterization and Applications of Catmull-Rom Curves, 2011). Barry and Goldman's pyramid over them is a Hermite segment
    /// with parabolic slopes. The position between knots is a monotone curve of the time, so that velocity does not jump at the keys
    /// either.
    pub(super) fn centripetal(self, u: f64) -> Option<([DVec3; 2], f64)> {
        let knots = |gap: Gap| Gap { length: distance(gap.difference).sqrt(), ..gap };
        let apart = |gap: Option<Gap>| gap.map(knots).filter(|gap| gap.length > 0.0);
        let curve = Self { before: apart(self.before), here: knots(self.here), after: apart(self.after) };
        if curve.here.length <= 0.0 {
            return None;
        }
        let paced = |gap: Gap| Gap { difference: DVec3::X * knots(gap).length, ..gap };
        let pace =
            Self { before: self.before.map(paced), here: paced(self.here), after: self.after.map(paced) };
        let along = hermite(pace.here.difference, pace.monotone(), u).x / curve.here.length;
        Some((curve.parabolic(), along.clamp(0.0, 1.0)))
    }

    /// Returns the slopes at both ends, as differences over the segment's length. An end without a neighbour has the slope of the straight
    /// line.
    fn slopes(self, rule: Rule) -> [DVec3; 2] {
        let slope = |left: Gap, right: Gap| {
            let even = |gap: Gap| gap.difference * (self.here.length / gap.length).min(1.0 / SHORTEST);
            let (both, ends) = (left.length + right.length, [even(left), even(right)]);
            rule(ends[0], ends[1], ends[0] * (right.length / both) + ends[1] * (left.length / both))
        };
        [
            self.before.map_or(self.here.difference, |before| slope(before, self.here)),
            self.after.map_or(self.here.difference, |after| slope(self.here, after)),
        ]
    }
}

/// Computes the point at `u` of the cubic Hermite segment with this difference and these end slopes, relative to the segment's start.
pub(super) fn hermite(difference: DVec3, [start, end]: [DVec3; 2], u: f64) -> DVec3 {
    let rest = 1.0 - u;
    difference * (u * u * (3.0 - 2.0 * u)) + start * (u * rest * rest) - end * (u * u * rest)
}

/// Computes the derivative of the Hermite curve at `u`.
pub(super) fn hermite_velocity(difference: DVec3, [start, end]: [DVec3; 2], u: f64) -> DVec3 {
    let rest = 1.0 - u;
    difference * (6.0 * u * rest) + start * (rest * (1.0 - 3.0 * u)) - end * (u * (2.0 - 3.0 * u))
}

/// Returns the length of a vector, without underflow.
pub(super) fn distance(difference: DVec3) -> f64 {
    let largest = difference.abs().max_element();
    if largest > 0.0 { largest * (difference / largest).length() } else { 0.0 }
}
