//! How far shadow rays are followed.

use glam::DVec3;

/// 2^560: from this `t` on, products with a direction, which is at most 2^401 long, can overflow where they are split into halves. Such
/// hits are refined separately, and rejected if their point or distance is not finite. Rays among shapes with coordinates up to 1e150
/// (2^498) hit them far below it, except planes that a ray is nearly parallel to.
pub(crate) const FAR: f64 = f64::from_bits((1023 + 560) << 52);

/// How far a shadow ray is followed: as far as the light is.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Limit {
    t: f64,
    /// The light's exact place; the ray's own direction is rounded. Not finite where the light is infinitely far away.
    place: DVec3,
}

impl Limit {
    /// Without end.
    pub(crate) const NONE: Self = Self { t: f64::INFINITY, place: DVec3::INFINITY };

    /// Where a ray is at `t`, as far as its direction's rounding allows.
    #[must_use]
    #[inline]
    pub(crate) fn new(t: f64, place: DVec3) -> Self {
        Self { t, place }
    }

    /// The ray's `t` there.
    #[must_use]
    #[inline]
    pub(crate) fn t(&self) -> f64 {
        self.t
    }

    /// The light's place.
    pub(crate) fn place(&self) -> DVec3 {
        self.place
    }
}
