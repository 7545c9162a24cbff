//! Interpolation between two values of each kind.

use glam::{DVec3, Vec3};

use super::hermite::hermite;

/// A value that can be interpolated.
pub trait Interpolate: Clone {
    /// Returns the value at fraction `u` of the straight line from `from` to `to`, extrapolated for `u` outside 0..=1. It is exactly `from`
    /// at 0 and exactly `to` at 1.
    #[must_use]
    fn between(from: &Self, to: &Self, u: f64) -> Self;

    /// Returns the straight-line difference from one value to the other. The difference of numbers is along x.
    #[must_use]
    fn difference(from: &Self, to: &Self) -> DVec3;

    /// Returns the value at fraction `u` in 0..=1 of a smooth curve from `from` to `to` with these end slopes. A slope is the difference
    /// that it makes over the whole segment.
    #[must_use]
    fn curve(from: &Self, to: &Self, slopes: [DVec3; 2], u: f64) -> Self;
}

impl Interpolate for f64 {
    fn between(from: &Self, to: &Self, u: f64) -> Self {
        from * (1.0 - u) + to * u
    }

    fn difference(from: &Self, to: &Self) -> DVec3 {
        DVec3::new(to - from, 0.0, 0.0)
    }

    fn curve(from: &Self, to: &Self, slopes: [DVec3; 2], u: f64) -> Self {
        from + hermite(Self::difference(from, to), slopes, u).x
    }
}

impl Interpolate for DVec3 {
    fn between(from: &Self, to: &Self, u: f64) -> Self {
        *from * (1.0 - u) + *to * u
    }

    fn difference(from: &Self, to: &Self) -> DVec3 {
        *to - *from
    }

    fn curve(from: &Self, to: &Self, slopes: [DVec3; 2], u: f64) -> Self {
        *from + hermite(*to - *from, slopes, u)
    }
}

/// Interpolates linear light; overshoot below zero is clamped to zero.
impl Interpolate for Vec3 {
    fn between(from: &Self, to: &Self, u: f64) -> Self {
        light(DVec3::between(&from.as_dvec3(), &to.as_dvec3(), u))
    }

    fn difference(from: &Self, to: &Self) -> DVec3 {
        to.as_dvec3() - from.as_dvec3()
    }

    fn curve(from: &Self, to: &Self, slopes: [DVec3; 2], u: f64) -> Self {
        light(DVec3::curve(&from.as_dvec3(), &to.as_dvec3(), slopes, u))
    }
}

/// Keeps the first value until the second one is reached.
impl Interpolate for bool {
    fn between(from: &Self, to: &Self, u: f64) -> Self {
        if u < 1.0 { *from } else { *to }
    }

    fn difference(_: &Self, _: &Self) -> DVec3 {
        DVec3::ZERO
    }

    fn curve(from: &Self, to: &Self, _: [DVec3; 2], u: f64) -> Self {
        Self::between(from, to, u)
    }
}

/// Clamps to 0 and above, and rounds to the nearest finite single-precision value.
fn light(value: DVec3) -> Vec3 {
    value.clamp(DVec3::ZERO, DVec3::splat(f64::from(f32::MAX))).as_vec3()
}
