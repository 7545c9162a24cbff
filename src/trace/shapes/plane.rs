//! Planes.

use glam::DVec3;

use super::intersection::{
    ExactCrossing, ExactHit, Face, Facet, Intersection, Intersections, Refined, RefinedHit, Side,
};
use super::sphere::{U, newton_step};
use crate::trace::math::{
    BoundedT, Compensated, Double, Double3, Exact3, ExactRoot, Real, absolute, dot, exact_dot, moderate3,
    scaled, spread, subtract, times,
};
use crate::trace::rays::{PreparedRay, Rays};

/// An infinite plane in world space, two-sided.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Plane {
    point: DVec3,
    /// Normal of any length. Its length cancels in every `t`; normalizing would only add rounding.
    normal: DVec3,
    unit_normal: DVec3,
}

/// Refines a `t` near a plane by one Newton step. The residual, the remaining height, is computed in twice the working precision. `normal` has
/// any length; `unit` is the unit normal.
#[inline(always)]
pub(crate) fn refine_plane<R: Real>(
    point: [R; 3],
    normal: [R; 3],
    unit: [R; 3],
    rays: &Rays<R>,
    t: R,
) -> Refined<R> {
    let place = Compensated::along(rays.origin, rays.direction, t);
    let from_point = place.minus(point);
    let step = newton_step(from_point.dot(normal).rounded(), dot(rays.direction, normal));
    Refined {
        t: Double::sum(t, step),
        point: place.moved(times(rays.direction, step)),
        normal: unit,
        found: moderate3(from_point.rounded()),
    }
}

impl Plane {
    /// Creates the plane through a point with a normal of any length. Returns `None` if the normal is zero or not finite.
    #[must_use]
    pub fn new(point: DVec3, normal: DVec3) -> Option<Self> {
        // Scaling by a power of two is exact and avoids overflow in products.
        let (normal, _) = scaled(normal)?;
        Some(Self { point, normal, unit_normal: normal / normal.length() })
    }

    /// Returns a point of the plane.
    #[must_use]
    pub fn point(&self) -> DVec3 {
        self.point
    }

    /// Returns the normal, which may have any length.
    pub(crate) fn normal(&self) -> DVec3 {
        self.normal
    }

    /// Returns the unit normal.
    #[must_use]
    pub fn unit_normal(&self) -> DVec3 {
        self.unit_normal
    }

    /// Returns the plane with all points multiplied by a power of two.
    pub(crate) fn scaled(&self, power: f64) -> Self {
        Self { point: self.point * power, ..*self }
    }

    /// Returns the `t >= 0` on the plane. A ray parallel to the plane misses it, even if it lies in the plane.
    #[must_use]
    #[inline]
    pub(crate) fn intersect(&self, ray: &PreparedRay) -> Intersection {
        self.intersections(&ray.into()).into()
    }

    /// Intersects rays with the plane.
    #[inline(always)]
    pub(crate) fn intersections<R: Real>(&self, rays: &Rays<R>) -> Intersections<R> {
        let Rays { origin, direction } = *rays;
        let (point, normal) = (spread(origin[0], self.point), spread(origin[0], self.normal));
        let to_plane = subtract(point, origin);
        let size = absolute(normal);
        let (height, speed) = (dot(to_plane, normal), dot(direction, normal));
        let height_error = dot(absolute(to_plane), size) * (6.0 * U);
        let speed_error = dot(absolute(direction), size) * (4.0 * U);
        let inverse = speed.of(1.0) / speed;
        let t = height * inverse;
        let error = (height_error + t.abs() * speed_error) * inverse.abs() + t.abs() * (4.0 * U);
        let certain = speed.abs().greater(speed_error * 1024.0);
        let hit = certain & t.greater(error);
        let miss = certain & t.less(-error);
        Intersections { root: BoundedT::within(t, error), hit, undecided: !hit & !miss }
    }

    /// Returns the exact hit of the ray's line, as both entry and exit.
    pub(crate) fn cross_exactly(&self, origin: DVec3, direction: &Exact3) -> Option<ExactCrossing> {
        let normal = Exact3::from(self.normal);
        let speed = normal.dot(direction);
        if speed.sign().is_eq() {
            return None;
        }
        let height = normal.dot(&(&Exact3::from(self.point) - &origin.into()));
        let meeting = ExactHit::new(ExactRoot::quotient(&height, &speed), Side::Either);
        Some([meeting.clone(), meeting])
    }

    /// Returns the hit near an approximate `t`: [`refine_plane`].
    #[must_use]
    #[inline(always)]
    pub(crate) fn refine(&self, origin: DVec3, direction: DVec3, t: f64, _far: bool) -> Option<RefinedHit> {
        let Self { point, normal, unit_normal } = *self;
        let rays = Rays::new(origin, direction);
        Some(refine_plane(point.into(), normal.into(), unit_normal.into(), &rays, t).into())
    }

    /// Always returns `None`: a `t` with few certain bits is solved exactly.
    pub(crate) fn solve(&self, _origin: DVec3, _direction: DVec3, _t: f64) -> Option<RefinedHit> {
        None
    }

    /// Returns the plane as a facet that may be flush with a face of a box. Only axis-aligned planes have exactly a face's numbers.
    pub(crate) fn facet(&self, _origin: DVec3, _direction: DVec3, _t: f64, _far: bool) -> Option<Facet> {
        let row = self.unit_normal.abs();
        let axis = (0..3).find(|axis| row[*axis] == 1.0)?;
        Some(Facet { row, offset: self.point[axis] })
    }

    /// Returns whether the point is strictly behind the plane.
    #[must_use]
    pub fn contains(&self, point: DVec3) -> bool {
        exact_dot(Double3::difference(point, self.point), self.normal).sign().is_lt()
    }

    /// Always misses: a straight ray never hits the plane again that it starts on.
    #[must_use]
    pub(crate) fn exit(&self, _origin: DVec3, _direction: DVec3) -> Intersection {
        Intersection::Miss
    }

    /// Always returns `None`, as [`Plane::exit`].
    pub(crate) fn exit_exactly(&self, _origin: DVec3, _direction: &Exact3) -> Option<ExactHit> {
        None
    }

    /// Returns the hit at `t`.
    #[must_use]
    pub(crate) fn surface_point(
        &self,
        origin: DVec3,
        direction: DVec3,
        t: Double,
        _face: Face,
    ) -> RefinedHit {
        let place = Compensated::along(origin, direction, t.rounded());
        RefinedHit { t, point: place.moved(direction * t.rest()).into(), normal: self.unit_normal }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn planes_are_two_sided_and_parallel_rays_miss() {
        let floor = Plane::new(DVec3::ZERO, DVec3::Y).unwrap();
        let first = |origin: DVec3, direction: DVec3| {
            let ray = PreparedRay::new(origin, direction)?;
            floor.intersect(&ray).decided(direction, || floor.cross_exactly(origin, &direction.into()))
        };
        assert_eq!(first(DVec3::new(0.0, 2.0, 0.0), DVec3::new(1.0, -1.0, 0.0)), Some(2.0));
        assert_eq!(first(DVec3::new(0.0, -2.0, 0.0), DVec3::new(1.0, 1.0, 0.0)), Some(2.0));
        assert_eq!(first(DVec3::new(0.0, 2.0, 0.0), DVec3::Y), None);
        assert_eq!(first(DVec3::new(0.0, 2.0, 0.0), DVec3::X), None);
        assert_eq!(first(DVec3::ZERO, DVec3::X), None, "a ray that lies in the plane");
        assert_eq!(first(DVec3::ZERO, DVec3::Y), Some(0.0));
    }
}
