//! Rays, and what they know of the surface they leave.

use glam::DVec3;

use super::{Slot, Surface, Ties};

/// A half-line `origin + t direction`, t >= 0.
///
/// The direction is scaled by a power of two so that its largest component is in 1..2: no later product overflows or loses
/// digits, however long or short the direction was given. Where that would cost a subnormal component digits, it is left
/// as it is.
#[derive(Clone, Debug, PartialEq)]
pub struct Ray {
    origin: DVec3,
    direction: DVec3,
    /// 1 / direction.direction
    inverse_square: f64,
    departure: Option<Departure>,
}

/// The surface a ray leaves. Instead of moving the origin off the surface by some epsilon, the ray skips what it leaves.
#[derive(Clone, Debug, PartialEq)]
pub(super) struct Departure {
    /// The shape that is left, or the first in document order of those that equal it.
    pub(super) slot: Slot,
    /// Out of it, or into it?
    pub(super) outward: bool,
    /// What else is left there.
    pub(super) ties: Ties,
}

/// How far a shadow ray is followed: as far as the light is.
#[derive(Clone, Copy, Debug)]
pub struct Limit {
    t: f64,
    /// The light's exact place; the ray's own direction is rounded. Not finite where the light is infinitely far away.
    place: DVec3,
}

impl Limit {
    /// Without end.
    pub const NONE: Self = Self { t: f64::INFINITY, place: DVec3::INFINITY };

    /// Where a ray is at `t`, as far as its direction's rounding allows.
    #[must_use]
    #[inline]
    pub(super) fn new(t: f64, place: DVec3) -> Self {
        Self { t, place }
    }

    /// The ray's `t` there.
    #[must_use]
    #[inline]
    pub fn t(&self) -> f64 {
        self.t
    }

    /// The light's place.
    pub(super) fn place(&self) -> DVec3 {
        self.place
    }
}

impl Ray {
    /// A ray that starts anywhere. `None` if a number is not finite or the direction is zero.
    #[must_use]
    #[inline]
    pub fn new(origin: DVec3, direction: DVec3) -> Option<Self> {
        let (direction, _) = scaled(direction)?;
        origin.is_finite().then(|| Self::scaled(origin, direction, None))
    }

    /// A ray that leaves a surface on the side that `outward` says.
    #[must_use]
    #[inline]
    pub(super) fn leaving(surface: &Surface, outward: bool, direction: DVec3) -> Option<Self> {
        Some(Self::leaving_scaled(surface, outward, direction)?.0)
    }

    /// A ray that leaves a surface towards a point, and where that is on it.
    #[must_use]
    #[inline]
    pub(super) fn leaving_to(surface: &Surface, outward: bool, point: DVec3) -> Option<(Self, Limit)> {
        let (ray, scale) = Self::leaving_scaled(surface, outward, point - surface.point)?;
        Some((ray, Limit::new(scale.recip(), point)))
    }

    #[inline]
    fn leaving_scaled(surface: &Surface, outward: bool, direction: DVec3) -> Option<(Self, f64)> {
        surface.point.is_finite().then_some(())?;
        let (direction, scale) = scaled(direction)?;
        Some((Self::departing(surface, outward, direction), scale))
    }

    /// A ray that leaves a surface at a finite point, in a direction that is [`scaled`].
    #[must_use]
    #[inline(always)]
    pub(super) fn departing(surface: &Surface, outward: bool, direction: DVec3) -> Self {
        let departure = Departure { slot: surface.asked, outward, ties: surface.ties.clone() };
        Self::scaled(surface.point, direction, Some(departure))
    }

    #[inline]
    fn scaled(origin: DVec3, direction: DVec3, departure: Option<Departure>) -> Self {
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
    pub(super) fn inverse_square(&self) -> f64 {
        self.inverse_square
    }

    #[inline]
    pub(super) fn departure(&self) -> Option<&Departure> {
        self.departure.as_ref()
    }

    /// The point at `t`.
    #[must_use]
    pub fn at(&self, t: f64) -> DVec3 {
        self.origin + self.direction * t
    }
}

/// `direction` times a power of two that brings its largest component into 1..2, and that power of two. `None` where it
/// is zero or not finite.
#[inline]
pub(super) fn scaled(direction: DVec3) -> Option<(DVec3, f64)> {
    /// Lifts every subnormal into the normal range.
    const LIFT: f64 = f64::from_bits((1023 + 600) << 52);
    const EXPONENT: u64 = 0x7ff;

    let exponent = |vector: DVec3| (vector.abs().max_element().to_bits() >> 52) & EXPONENT;
    if !direction.is_finite() || direction == DVec3::ZERO {
        return None;
    }
    let (lifted, lift) = if exponent(direction) < 600 { (direction * LIFT, LIFT) } else { (direction, 1.0) };
    // 2^-e has the biased exponent 2046 - (1023 + e). The two largest exponents would give a subnormal.
    let scale = f64::from_bits((2046 - exponent(lifted).min(2045)) << 52);
    let scaled = lifted * scale;
    let beside_subnormal = || exponent(lifted) < 1023 + 400 && scaled / scale != lifted;
    if scale < 1.0 && lifted.abs().min_element() < 1e-200 && beside_subnormal() {
        return Some((lifted, lift));
    }
    Some((scaled, lift * scale))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn directions_of_any_length_are_scaled_exactly() {
        for exponent in [-1074, -1040, -1022, -500, -1, 0, 1, 52, 900, 1022] {
            let length = libm::ldexp(1.0, exponent);
            let (direction, scale) = scaled(DVec3::new(length, -length, 0.0)).unwrap();
            assert_eq!(direction, DVec3::new(1.0, -1.0, 0.0), "2^{exponent}");
            assert!(exponent < -1023 || scale * length == 1.0);
        }
        assert!(scaled(DVec3::new(f64::MAX, 0.0, 1.0)).unwrap().0.x < 4.0);
        assert!(scaled(DVec3::ZERO).is_none());
        assert!(scaled(DVec3::new(f64::NAN, 1.0, 0.0)).is_none());
        assert!(scaled(DVec3::new(f64::INFINITY, 1.0, 0.0)).is_none());
    }
}
