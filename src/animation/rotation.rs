//! Rotations: their notations, and the interpolation between them.

use std::f64::consts::TAU;

use glam::{DQuat, DVec3};

use super::Interpolate;
use super::angle::sine_cosine;

/// A rotation in one of its notations. Angles are in degrees; quarter and half turns are exact.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Rotation {
    /// Euler angles about x first, then y, then z: the matrix Rz Ry Rx.
    Euler(DVec3),
    /// An axis of any length but zero, and the angle about it.
    AxisAngle(DVec3, f64),
    /// A quaternion (x, y, z, w) of any length but zero.
    Quat(f64, f64, f64, f64),
}

impl Rotation {
    /// Returns the unit quaternion; the identity if the axis or the quaternion has no direction.
    #[must_use]
    pub fn quaternion(self) -> DQuat {
        let about = |axis: DVec3, angle: f64| {
            let (sine, cosine) = sine_cosine(0.5 * angle, 90.0);
            DQuat::from_vec4((axis * sine).extend(cosine))
        };
        match self {
            Self::Euler(angles) => {
                about(DVec3::Z, angles.z) * about(DVec3::Y, angles.y) * about(DVec3::X, angles.x)
            }
            Self::AxisAngle(axis, angle) => {
                // A scale by a power of two keeps the square of the length within the range of f64.
                let exponent = libm::ilogb(axis.abs().max_element()).clamp(-1000, 1000);
                let axis = axis * libm::ldexp(1.0, -exponent);
                // Division by the length is exact for coordinate axes.
                let unit = axis / axis.length();
                if unit.is_finite() { about(unit, angle) } else { DQuat::IDENTITY }
            }
            Self::Quat(x, y, z, w) => unit(DQuat::from_xyzw(x, y, z, w)),
        }
    }
}

/// Scales a quaternion to length 1, without overflow; the identity for a zero or non-finite quaternion.
fn unit(quaternion: DQuat) -> DQuat {
    let raw = quaternion.to_array();
    let largest = raw.iter().fold(0.0_f64, |largest, part| largest.max(part.abs()));
    if !(largest > 0.0 && largest.is_finite()) {
        return DQuat::IDENTITY;
    }
    let [x, y, z, w] = raw.map(|part| part / largest);
    DQuat::from_xyzw(x, y, z, w).normalize()
}

/// Interpolates between two unit quaternions by spherical linear interpolation along the shorter arc, at fraction `u`. Outside 0..=1, the
/// rotation continues beyond the ends.
///
/// Both ends are exact. Equal, opposite and sign-flipped rotations give finite results (Shoemake, Animating Rotation with Quaternion
/// Curves, 1985).
///
/// ```
/// use glam::DQuat;
/// use rayreel::animation::slerp;
/// let (from, to) = (DQuat::IDENTITY, DQuat::from_xyzw(0.0, 1.0, 0.0, 0.0)); // half a turn about y
/// let quarter = slerp(from, to, 0.5);
/// assert!((quarter.y - 0.5f64.sqrt()).abs() < 1e-15 && (quarter.w - 0.5f64.sqrt()).abs() < 1e-15);
/// ```
#[must_use]
pub fn slerp(from: DQuat, to: DQuat, u: f64) -> DQuat {
    if u == 0.0 {
        return from;
    }
    if u == 1.0 {
        return to;
    }
    let cosine = from.dot(to);
    let (to, cosine) = if cosine < 0.0 { (-to, -cosine) } else { (to, cosine) };
    // The angle from the lengths of the difference and the sum is accurate where acos is not.
    let half_angle = libm::atan2((to - from).length(), (to + from).length());
    let angle = 2.0 * half_angle;
    let sine = libm::sin(angle);
    if cosine > 1.0 - 1e-12 || sine <= 0.0 {
        return unit(from * (1.0 - u) + to * u);
    }
    unit(from * (libm::sin((1.0 - u) * angle) / sine) + to * (libm::sin(u * angle) / sine))
}

/// Returns the rotation of a rotation vector, whose direction is the axis and whose length is the angle in radians.
fn turn(vector: DVec3) -> DQuat {
    let angle = vector.length();
    let (sine, cosine) = libm::sincos(0.5 * angle);
    // For short vectors the sine is half the length.
    let ratio = if angle > 1e-9 { sine / angle } else { 0.5 };
    DQuat::from_vec4((vector * ratio).extend(cosine))
}

/// Returns the rotation vector of a unit quaternion, at most half a turn long. For an exact half turn, the sign decides the
/// direction.
fn rotation_vector(rotation: DQuat) -> DVec3 {
    let rotation = if rotation.w < 0.0 { -rotation } else { rotation };
    let sine = rotation.xyz().length();
    let ratio = if sine > 1e-9 { 2.0 * libm::atan2(sine, rotation.w) / sine } else { 2.0 };
    rotation.xyz() * ratio
}

/// Returns the vector of [`rotation_vector`] with whole turns added or removed to be as near to `expected` as possible.
fn rotation_vector_near(rotation: DQuat, expected: DVec3) -> DVec3 {
    let vector = rotation_vector(rotation);
    let reference = if vector.length() > 1e-9 { vector } else { expected };
    let Some(axis) = reference.try_normalize() else {
        return vector;
    };
    vector + axis * (((expected - vector).dot(axis) / TAU).round() * TAU)
}

impl Interpolate for DQuat {
    fn between(from: &Self, to: &Self, u: f64) -> Self {
        slerp(*from, *to, u)
    }

    /// Returns the shorter arc as a rotation vector in the rotation's own axes, which are the same at both ends of the arc.
    fn difference(from: &Self, to: &Self) -> DVec3 {
        rotation_vector(from.conjugate() * *to)
    }

    /// Composes three rotations about fixed axes: one by the first slope, one by the remaining difference, and one by the last slope (Kim,
    /// Kim, Shin, A General Construction Scheme for Unit Quaternion Curves with Simple High Order Derivatives, 1995). About a single axis,
    /// this is cubic Hermite interpolation of the angle.
    fn curve(from: &Self, to: &Self, [start, end]: [DVec3; 2], u: f64) -> Self {
        let (off, into) = (start / 3.0, end / 3.0);
        let over = rotation_vector_near(
            turn(-off) * from.conjugate() * *to * turn(-into),
            Self::difference(from, to) - off - into,
        );
        let rest = 1.0 - u;
        let (first, second, third) = (1.0 - rest * rest * rest, u * u * (3.0 - 2.0 * u), u * u * u);
        unit(*from * turn(off * first) * turn(over * second) * turn(into * third))
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn close(found: DQuat, expected: [f64; 4], tolerance: f64) {
        let expected = DQuat::from_array(expected);
        let distance = (found - expected).length().min((found + expected).length());
        assert!(distance < tolerance, "{found} is not {expected}");
    }

    #[test]
    fn euler_angles_apply_x_then_y_then_z() {
        let turned = Rotation::Euler(DVec3::new(90.0, 90.0, 0.0)).quaternion() * DVec3::Y;
        // +90 about x takes y to z; +90 about y takes z to x.
        assert!((turned - DVec3::X).length() < 1e-15);
        let turned = Rotation::AxisAngle(DVec3::new(0.0, 3.0, 0.0), 90.0).quaternion() * DVec3::Z;
        assert!((turned - DVec3::X).length() < 1e-15);
    }

    #[test]
    fn slerp_takes_the_short_way_and_is_never_nan() {
        let quarter = Rotation::AxisAngle(DVec3::Y, 60.0).quaternion();
        close(slerp(quarter, -quarter, 0.3), quarter.to_array(), 1e-15);
        close(slerp(quarter, quarter, 0.3), quarter.to_array(), 1e-15);
        let nearly = Rotation::AxisAngle(DVec3::Y, 60.0 + 1e-7).quaternion();
        for step in 0..=10 {
            let u = f64::from(step) / 10.0;
            for other in
                [quarter, -quarter, nearly, -nearly, DQuat::IDENTITY, DQuat::from_xyzw(1.0, 0.0, 0.0, 0.0)]
            {
                assert!((slerp(quarter, other, u).length() - 1.0).abs() < 1e-15);
            }
        }
        // Along the longer arc the middle would be on the other side.
        let (from, to) = (Rotation::Euler(DVec3::ZERO), Rotation::AxisAngle(DVec3::Z, 290.0));
        let middle = slerp(from.quaternion(), to.quaternion(), 0.5);
        let short = 290.0 - 360.0;
        close(middle, Rotation::AxisAngle(DVec3::Z, 0.5 * short).quaternion().to_array(), 1e-14);
    }

    #[test]
    fn rotations_without_a_direction_are_the_identity() {
        assert_eq!(Rotation::Quat(0.0, 0.0, 0.0, 0.0).quaternion(), DQuat::IDENTITY);
        assert_eq!(Rotation::AxisAngle(DVec3::ZERO, 1.0).quaternion(), DQuat::IDENTITY);
        close(
            Rotation::Quat(1e-200, 0.0, 0.0, 1e-200).quaternion(),
            [0.5f64.sqrt(), 0.0, 0.0, 0.5f64.sqrt()],
            1e-15,
        );
        close(Rotation::Quat(0.0, 1e300, 0.0, 0.0).quaternion(), [0.0, 1.0, 0.0, 0.0], 1e-15);
    }
}
