//! What a ray meets.

use glam::DVec3;

use crate::trace::math::{Double, Double3, Root, scaled};
use crate::trace::rays::{Departure, Limit, Ray, ShapeId, Ties};

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
#[derive(Clone, Debug, PartialEq)]
pub struct ClosestHit {
    /// What is seen.
    pub hit: Hit,
    /// What else is met there, in any order; of equal shapes the first in document order stands for all.
    pub ties: Vec<Hit>,
}

/// A point of a surface, found by a ray.
#[derive(Clone, Debug, PartialEq)]
pub struct SurfacePoint {
    /// What found it.
    pub hit: Hit,
    /// The first in document order of all shapes that equal the one it is on.
    pub(crate) asked: ShapeId,
    /// What else is there, besides those; see [`PreparedScene::tied`](crate::trace::PreparedScene::tied).
    pub ties: Ties,
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
}

impl SurfacePoint {
    /// Returns how far it is from the origin of the ray that found it: t |d| in double-double, rounded once.
    #[must_use]
    pub fn distance(&self, ray: &Ray) -> f64 {
        let direction = Double3::from(ray.direction());
        (self.t * direction.dot(direction).sqrt()).rounded()
    }

    /// A ray that leaves this surface. It never meets the surface it starts on by rounding. `None` if the direction is zero
    /// or not finite.
    #[must_use]
    pub fn leave_towards(&self, direction: DVec3) -> Option<Ray> {
        self.leave(direction.dot(self.normal) >= 0.0, direction)
    }

    /// A ray that leaves this surface towards a point, on the side that the ray came from which found it, and where that
    /// is on it. `None` if the point is this one or not finite.
    #[must_use]
    #[inline]
    pub fn leave_to(&self, point: DVec3) -> Option<(Ray, Limit)> {
        self.leave_to_point(self.from_outside, point)
    }

    /// What a ray leaves that starts here, on the side that `outward` says.
    #[inline(always)]
    pub(crate) fn departure(&self, outward: bool) -> Departure {
        Departure { id: self.asked, outward, ties: self.ties.clone() }
    }

    /// A ray that leaves the surface on the side that `outward` says.
    #[must_use]
    #[inline]
    pub(crate) fn leave(&self, outward: bool, direction: DVec3) -> Option<Ray> {
        self.point.is_finite().then_some(())?;
        let (direction, _) = scaled(direction)?;
        Some(Ray::departing(self.point, direction, self.departure(outward)))
    }

    /// A ray that leaves the surface towards a point, and where that is on it.
    #[must_use]
    #[inline]
    pub(crate) fn leave_to_point(&self, outward: bool, point: DVec3) -> Option<(Ray, Limit)> {
        self.point.is_finite().then_some(())?;
        let (direction, scale) = scaled(point - self.point)?;
        let ray = Ray::departing(self.point, direction, self.departure(outward));
        Some((ray, Limit::new(scale.recip(), point)))
    }
}
