//! Limits of shadow rays.

use glam::DVec3;

/// 2^560: from this `t` on, products with a direction, which is at most 2^401 long, can overflow when they are split into halves. Such hits
/// are refined separately, and rejected if their point or distance is not finite. Rays among shapes with coordinates up to 1e150 (2^498)
/// hit them at a much smaller `t`, except planes that are nearly parallel to the ray.
pub(crate) const FAR: f64 = f64::from_bits((1023 + 560) << 52);

/// The end of a shadow ray, at the light.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) struct ShadowLimit {
    t: f64,
    /// The light's exact position; the ray's own direction is rounded. Not finite for directional lights.
    place: DVec3,
}

impl ShadowLimit {
    /// No limit.
    pub(crate) const NONE: Self = Self { t: f64::INFINITY, place: DVec3::INFINITY };

    /// Creates the limit of a ray that reaches `place` at `t`, except for the rounding of its direction.
    #[must_use]
    #[inline]
    pub(crate) fn new(t: f64, place: DVec3) -> Self {
        Self { t, place }
    }

    /// Returns the ray's `t` at the light.
    #[must_use]
    #[inline]
    pub(crate) fn t(&self) -> f64 {
        self.t
    }

    /// Returns the light's position.
    pub(crate) fn place(&self) -> DVec3 {
        self.place
    }
}
