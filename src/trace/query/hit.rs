//! What a ray meets.

use glam::DVec3;

use crate::trace::math::{Double, Double3, Root, scaled};
use crate::trace::rays::{Departure, FAR, Ray, ShapeId, Ties};

/// Where a ray meets a shape.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Hit {
    /// The ray's parameter, with a bound of its error.
    pub root: Root,
    /// The shape.
    pub id: ShapeId,
    /// Whether this is the far side of a shape that the ray left inwards.
    pub far: bool,
}

/// What a ray meets first: the first in document order of all that it meets exactly there.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) struct ClosestHit {
    /// What is seen.
    pub(crate) hit: Hit,
    /// What else is met there.
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

/// A point of a surface, found by a ray.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct SurfacePoint {
    /// What found it.
    pub hit: Hit,
    /// The first in document order of all shapes that equal the one it is on.
    pub(crate) first_equal: ShapeId,
    /// What else is there, besides those.
    pub(crate) ties: Ties,
    /// The parameter of the ray that found it, right to some bits beyond an `f64`'s.
    pub t: Double,
    /// On the surface.
    pub point: DVec3,
    /// The outward unit normal; of a plane, its own.
    pub normal: DVec3,
    /// Whether the ray came from the side that the normal points to.
    pub from_outside: bool,
}

impl SurfacePoint {
    /// The normal on the side that the ray came from.
    #[must_use]
    pub fn facing_normal(&self) -> DVec3 {
        if self.from_outside { self.normal } else { -self.normal }
    }

    /// Returns how far it is from the origin of the ray that found it: t |d| in double-double, rounded once.
    #[must_use]
    pub fn distance(&self, ray: &Ray) -> f64 {
        let direction = Double3::from(ray.direction());
        self.times(direction.dot(direction).sqrt())
    }

    /// Returns the distance from the origin of the ray that found it, along a unit vector.
    #[must_use]
    pub fn depth(&self, ray: &Ray, axis: DVec3) -> f64 {
        self.times(Double3::from(ray.direction()).dot(Double3::from(axis)))
    }

    /// Returns the product of `t` and a number of at most 2^402, rounded once.
    fn times(&self, number: Double) -> f64 {
        /// 2^600
        const LARGER: f64 = f64::from_bits((1023 + 600) << 52);
        if self.t.rounded() < FAR {
            (self.t * number).rounded()
        } else {
            // No product overflows while it is split into halves.
            (self.t.scaled(LARGER.recip()) * number).rounded() * LARGER
        }
    }

    /// What a ray leaves that starts here, on the side that `outward` says.
    #[inline(always)]
    pub(crate) fn departure(&self, outward: bool) -> Departure {
        Departure { id: self.first_equal, outward, ties: self.ties }
    }

    /// A ray that leaves the surface on the side that `outward` says.
    #[must_use]
    #[inline]
    pub(crate) fn leave(&self, outward: bool, direction: DVec3) -> Option<Ray> {
        self.point.is_finite().then_some(())?;
        let (direction, _) = scaled(direction)?;
        Some(Ray::departing(self.point, direction, self.departure(outward)))
    }
}
