//! Rays.

use super::departure::Departure;
use crate::trace::math::scaled;
use glam::DVec3;

/// A half-line `origin + t direction`, t >= 0.
///
/// The direction is scaled by a power of two so that its largest component is in 1..2: no later product overflows or loses
/// digits, however long or short the direction was given. Where that would cost a subnormal component digits, it is left
/// as it is.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Ray {
    origin: DVec3,
    direction: DVec3,
    /// 1 / direction.direction
    inverse_square: f64,
    departure: Option<Departure>,
}

impl Ray {
    /// A ray that starts anywhere. `None` if a number is not finite or the direction is zero.
    #[must_use]
    #[inline]
    pub fn new(origin: DVec3, direction: DVec3) -> Option<Self> {
        let (direction, _) = scaled(direction)?;
        origin.is_finite().then(|| Self::scaled(origin, direction, None))
    }

    /// A ray that leaves a surface at a finite point, in a direction that is [`scaled`].
    #[must_use]
    #[inline(always)]
    pub(crate) fn departing(origin: DVec3, direction: DVec3, departure: Departure) -> Self {
        Self::scaled(origin, direction, Some(departure))
    }

    /// A ray whose direction is [`scaled`].
    #[inline]
    pub(super) fn scaled(origin: DVec3, direction: DVec3, departure: Option<Departure>) -> Self {
        Self { origin, direction, inverse_square: direction.dot(direction).recip(), departure }
    }

    /// Where the ray starts.
    #[must_use]
    #[inline]
    pub fn origin(&self) -> DVec3 {
        self.origin
    }

    /// Which way it goes; the largest component's magnitude is in 1..2, save beside a subnormal one.
    #[must_use]
    #[inline]
    pub fn direction(&self) -> DVec3 {
        self.direction
    }

    /// 1 / direction.direction, rounded twice.
    #[must_use]
    #[inline]
    pub(crate) fn inverse_square(&self) -> f64 {
        self.inverse_square
    }

    #[inline]
    pub(crate) fn departure(&self) -> Option<&Departure> {
        self.departure.as_ref()
    }

    /// The point at `t`.
    #[must_use]
    pub fn at(&self, t: f64) -> DVec3 {
        self.origin + self.direction * t
    }
}
