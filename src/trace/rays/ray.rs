//! Rays.

use super::surface_exclusion::SurfaceExclusion;
use crate::trace::math::{Real, scaled};
use glam::DVec3;

/// A half-line `origin + t direction`, t >= 0.
///
/// The direction is scaled by a power of two so that its largest component is in 1..2. Later products then neither overflow nor lose
/// digits, however long or short the given direction was. If scaling would cost a subnormal component digits, the direction is left as it
/// is.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct PreparedRay {
    origin: DVec3,
    direction: DVec3,
    /// 1 / direction.direction
    inverse_square: f64,
    exclusion: Option<SurfaceExclusion>,
}

/// A ray, or the rays of half a packet: the operands of formulas that are generic over both.
#[derive(Clone, Copy)]
pub(crate) struct Rays<R> {
    pub(crate) origin: [R; 3],
    pub(crate) direction: [R; 3],
}

impl<R: Real> Rays<R> {
    #[inline(always)]
    pub(crate) fn new(origin: impl Into<[R; 3]>, direction: impl Into<[R; 3]>) -> Self {
        Self { origin: origin.into(), direction: direction.into() }
    }
}

impl From<&PreparedRay> for Rays<f64> {
    #[inline(always)]
    fn from(ray: &PreparedRay) -> Self {
        Self::new(ray.origin, ray.direction)
    }
}

impl PreparedRay {
    /// Creates a ray with any origin. `None` if a number is not finite or the direction is zero.
    #[must_use]
    #[inline]
    pub fn new(origin: DVec3, direction: DVec3) -> Option<Self> {
        let (direction, _) = scaled(direction)?;
        origin.is_finite().then(|| Self::scaled(origin, direction, None))
    }

    /// Creates a ray that leaves a surface at a finite point, in a direction that is [`scaled`].
    #[must_use]
    #[inline(always)]
    pub(crate) fn departing(origin: DVec3, direction: DVec3, exclusion: SurfaceExclusion) -> Self {
        Self::scaled(origin, direction, Some(exclusion))
    }

    /// Creates a ray whose direction is [`scaled`].
    #[inline]
    pub(super) fn scaled(origin: DVec3, direction: DVec3, exclusion: Option<SurfaceExclusion>) -> Self {
        Self { origin, direction, inverse_square: direction.dot(direction).recip(), exclusion }
    }

    /// Returns the origin.
    #[must_use]
    #[inline]
    pub fn origin(&self) -> DVec3 {
        self.origin
    }

    /// Returns the direction. The magnitude of its largest component is in 1..2, except if another component is subnormal.
    #[must_use]
    #[inline]
    pub fn direction(&self) -> DVec3 {
        self.direction
    }

    /// Returns 1 / direction.direction, rounded twice.
    #[must_use]
    #[inline]
    pub(crate) fn inverse_square(&self) -> f64 {
        self.inverse_square
    }

    #[inline]
    pub(crate) fn exclusion(&self) -> Option<&SurfaceExclusion> {
        self.exclusion.as_ref()
    }

    /// Returns the point at `t`.
    #[must_use]
    pub fn at(&self, t: f64) -> DVec3 {
        self.origin + self.direction * t
    }
}
