//! Planes.

use glam::DVec3;

use super::intersection::{ExactCrossing, ExactHit, Face, Facet, Intersection, RefinedHit, Side, Verdict};
use super::sphere::{RefinedStep, U, newton_step};
use crate::trace::math::{
    Compensated, Double, Double3, Exact3, ExactRoot, Real, absolute, dot, exact_dot, scaled, subtract, times,
};
use crate::trace::rays::Ray;

/// An infinite plane in world space, two-sided.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Plane {
    point: DVec3,
    /// Of a length that does not matter to any `t`: dividing by it would only round.
    normal: DVec3,
    unit_normal: DVec3,
}

/// Where rays meet a plane, given by a point and a normal of any length.
#[inline(always)]
pub(crate) fn only_root<R: Real>(
    (point, normal): ([R; 3], [R; 3]),
    (origin, direction): ([R; 3], [R; 3]),
) -> Verdict<R> {
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
    Verdict { t, error, hit, open: !hit & !miss }
}

/// One Newton step from the height that is left near a plane, in twice the working precision.
#[inline(always)]
pub(crate) fn stepped_to_plane<R: Real>(
    (point, normal): ([R; 3], [R; 3]),
    (origin, direction): ([R; 3], [R; 3]),
    t: R,
) -> RefinedStep<R> {
    let place = Compensated::along(origin, direction, t);
    let from_point = place.minus(point);
    let step = newton_step(from_point.dot(normal).rounded(), dot(direction, normal));
    RefinedStep {
        t: Double::sum(t, step),
        from_shape: from_point.rounded(),
        point: place.moved(times(direction, step)),
        outwards: normal,
    }
}

impl Plane {
    /// The plane through a point whose normal has this direction. `None` where it has none: zero, or not finite.
    #[must_use]
    pub fn new(point: DVec3, normal: DVec3) -> Option<Self> {
        // By a power of two: no digit is lost, and no product of it overflows.
        let (normal, _) = scaled(normal)?;
        Some(Self { point, normal, unit_normal: normal / normal.length() })
    }

    /// A point of the plane.
    #[must_use]
    pub fn point(&self) -> DVec3 {
        self.point
    }

    /// The normal, of any length.
    pub(crate) fn normal(&self) -> DVec3 {
        self.normal
    }

    /// The unit normal.
    #[must_use]
    pub fn unit_normal(&self) -> DVec3 {
        self.unit_normal
    }

    /// All points times a power of two.
    pub(crate) fn scaled(&self, power: f64) -> Self {
        Self { point: self.point * power, ..*self }
    }

    /// The `t >= 0` on the plane. A ray along the plane misses it, also when it lies in it.
    #[must_use]
    #[inline]
    pub fn intersect(&self, ray: &Ray) -> Intersection {
        let ray = (ray.origin().into(), ray.direction().into());
        only_root((self.point.into(), self.normal.into()), ray).into()
    }

    /// Where the ray's line meets the plane, decided exactly: it leaves as it enters.
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

    /// The meeting near an inexact `t`: one Newton step from the height that is left there, in twice the working precision.
    #[must_use]
    #[inline(always)]
    pub(crate) fn refine(&self, origin: DVec3, direction: DVec3, t: f64, _far: bool) -> Option<RefinedHit> {
        let plane = (self.point.into(), self.normal.into());
        let RefinedStep { t, point, .. } = stepped_to_plane(plane, (origin.into(), direction.into()), t);
        Some(RefinedHit { t, point: point.into(), normal: self.unit_normal })
    }

    /// Every `t` of which few bits are certain is solved exactly.
    pub(crate) fn solve(&self, _origin: DVec3, _direction: DVec3, _t: f64) -> Option<RefinedHit> {
        None
    }

    /// The plane of a face that may be flush with one of a box: only across an axis they are the same numbers.
    pub(crate) fn facet(&self, _origin: DVec3, _direction: DVec3, _t: f64, _far: bool) -> Option<Facet> {
        let row = self.unit_normal.abs();
        let axis = (0..3).find(|axis| row[*axis] == 1.0)?;
        Some(Facet { row, offset: self.point[axis] })
    }

    /// Returns whether the point is in the half-space behind it, not on it.
    #[must_use]
    pub fn contains(&self, point: DVec3) -> bool {
        exact_dot(Double3::difference(point, self.point), self.normal).sign().is_lt()
    }

    /// A straight ray never meets the plane that it leaves again.
    #[must_use]
    pub fn exit(&self, _origin: DVec3, _direction: DVec3) -> Intersection {
        Intersection::Miss
    }

    /// Likewise.
    pub(crate) fn exit_exactly(&self, _origin: DVec3, _direction: &Exact3) -> Option<ExactHit> {
        None
    }

    /// The meeting at `t`.
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
            let ray = Ray::new(origin, direction)?;
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
