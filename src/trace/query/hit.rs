//! Hits of rays with shapes.

use glam::DVec3;

use crate::trace::math::{BoundedT, Double, Double3, scaled};
use crate::trace::rays::{CoincidentHits, FAR, PreparedRay, ShapeId, SurfaceExclusion};

/// An intersection of a ray with a shape.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct ShapeHit {
    /// The ray parameter, with its error bound.
    pub root: BoundedT,
    /// The shape.
    pub id: ShapeId,
    /// True if this is the far side of a shape that the ray left inwards.
    pub far: bool,
}

/// The closest hit of a ray: the first in document order of all hits at exactly the same `t`.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) struct ClosestHit {
    /// The hit.
    pub(crate) hit: ShapeHit,
    /// The other hits at the same `t`.
    pub(crate) tied: TiedHits,
}

/// A list in [`TiedHitLists`](super::nearest::TiedHitLists).
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) struct TiedHits {
    pub(super) start: u32,
    pub(super) count: u32,
}

impl TiedHits {
    pub(super) const NONE: Self = Self { start: 0, count: 0 };

    #[inline]
    pub(crate) fn is_empty(self) -> bool {
        self.count == 0
    }
}

/// A surface point found by a ray.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct SurfacePoint {
    /// The hit that was refined to this point.
    pub hit: ShapeHit,
    /// The first in document order of the shape and all shapes equal to it.
    pub(crate) first_equal: ShapeId,
    /// The other coincident shapes at the point, none of them equal to it.
    pub(crate) ties: CoincidentHits,
    /// The parameter of the ray that found it, accurate to some bits beyond an `f64`.
    pub t: Double,
    /// The position on the surface.
    pub point: DVec3,
    /// The outward unit normal; for a plane, its own normal.
    pub normal: DVec3,
    /// True if the ray came from the side to which the normal points.
    pub from_outside: bool,
}

impl SurfacePoint {
    /// Returns the normal on the side from which the ray came.
    #[must_use]
    pub fn facing_normal(&self) -> DVec3 {
        if self.from_outside { self.normal } else { -self.normal }
    }

    /// Returns the distance from the origin of the ray that found the point: t |d| in double-double, rounded once.
    #[must_use]
    pub fn distance(&self, ray: &PreparedRay) -> f64 {
        let direction = Double3::from(ray.direction());
        self.times(direction.dot(direction).sqrt())
    }

    /// Returns the distance from the origin of the ray that found the point, along a unit vector.
    #[must_use]
    pub fn depth(&self, ray: &PreparedRay, axis: DVec3) -> f64 {
        self.times(Double3::from(ray.direction()).dot(Double3::from(axis)))
    }

    /// Returns the product of `t` and a number of at most 2^402, rounded once.
    fn times(&self, number: Double) -> f64 {
        /// 2^600
        const LARGER: f64 = f64::from_bits((1023 + 600) << 52);
        if self.t.rounded() < FAR {
            (self.t * number).rounded()
        } else {
            // Scaled so that no product overflows while it is split into halves.
            (self.t.scaled(LARGER.recip()) * number).rounded() * LARGER
        }
    }

    /// Returns the surface exclusion of a ray that starts here, on the side given by `outward`.
    #[inline(always)]
    pub(crate) fn exclusion(&self, outward: bool) -> SurfaceExclusion {
        SurfaceExclusion { id: self.first_equal, outward, ties: self.ties }
    }

    /// Returns a ray that leaves the surface on the side given by `outward`.
    #[must_use]
    #[inline]
    pub(crate) fn leave(&self, outward: bool, direction: DVec3) -> Option<PreparedRay> {
        self.point.is_finite().then_some(())?;
        let (direction, _) = scaled(direction)?;
        Some(PreparedRay::departing(self.point, direction, self.exclusion(outward)))
    }
}
