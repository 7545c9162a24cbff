//! Planes.

use glam::DVec3;

use super::sphere::{U, newton_step};
use super::{Crossing, Face, Facet, Meeting, Side, Verdict};
use crate::trace::algebraic::{Exact3, ExactRoot};
use crate::trace::exact::{Compensated3, Double, Double3, dot};
use crate::trace::ray::scaled;
use crate::trace::{Ray, Refined, Root};

/// An infinite plane in world space, two-sided.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Plane {
    point: DVec3,
    /// Of a length that does not matter to any `t`: dividing by it would only round.
    normal: DVec3,
    unit_normal: DVec3,
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

    /// The unit normal.
    #[must_use]
    pub fn unit_normal(&self) -> DVec3 {
        self.unit_normal
    }

    /// The `t >= 0` on the plane. A ray along the plane misses it, also when it lies in it.
    #[must_use]
    #[inline]
    pub fn first_hit(&self, ray: &Ray) -> Verdict {
        let (origin, direction) = (ray.origin(), ray.direction());
        let to_plane = self.point - origin;
        let (height, speed) = (to_plane.dot(self.normal), direction.dot(self.normal));
        let size = self.normal.abs();
        let (height_error, speed_error) =
            (6.0 * U * to_plane.abs().dot(size), 4.0 * U * direction.abs().dot(size));
        let inverse = speed.recip();
        let t = height * inverse;
        let error = (height_error + t.abs() * speed_error) * inverse.abs() + 4.0 * U * t.abs();
        let certain = speed.abs() > 1024.0 * speed_error;
        if certain && t > error {
            Verdict::Hit(Root::within(t, error))
        } else if certain && t < -error {
            Verdict::Miss
        } else {
            Verdict::Open
        }
    }

    /// Where the ray's line meets the plane, decided exactly: it leaves as it enters.
    pub(in crate::trace) fn crossing(&self, origin: DVec3, direction: &Exact3) -> Option<Crossing> {
        let normal = Exact3::from(self.normal);
        let speed = normal.dot(direction);
        if speed.sign().is_eq() {
            return None;
        }
        let height = normal.dot(&(&Exact3::from(self.point) - &origin.into()));
        let meeting = Meeting::new(ExactRoot::quotient(&height, &speed), Side::Either);
        Some([meeting.clone(), meeting])
    }

    /// The meeting near an inexact `t`: one Newton step from the height that is left there, in twice the working precision.
    #[must_use]
    #[inline(always)]
    pub(in crate::trace) fn refined(
        &self,
        origin: DVec3,
        direction: DVec3,
        t: f64,
        _far: bool,
    ) -> Option<Refined> {
        let place = Compensated3::along(origin, direction, t);
        let height = place.minus(self.point).dot(self.normal).rounded();
        let step = newton_step(height, direction.dot(self.normal));
        let point = place.moved(direction * step);
        Some(Refined { t: Double::sum(t, step), point, normal: self.unit_normal })
    }

    /// Every `t` of which few bits are certain is solved exactly.
    pub(in crate::trace) fn solved(&self, _origin: DVec3, _direction: DVec3, _t: f64) -> Option<Refined> {
        None
    }

    /// The plane of a face that may be flush with one of a box: only across an axis they are the same numbers.
    pub(in crate::trace) fn facet(
        &self,
        _origin: DVec3,
        _direction: DVec3,
        _t: f64,
        _far: bool,
    ) -> Option<Facet> {
        let row = self.unit_normal.abs();
        let axis = (0..3).find(|axis| row[*axis] == 1.0)?;
        Some(Facet { row, offset: self.point[axis] })
    }

    /// Is the point in the half-space behind it, not on it?
    #[must_use]
    pub fn contains(&self, point: DVec3) -> bool {
        dot(Double3::difference(point, self.point), self.normal).sign().is_lt()
    }

    /// A straight ray never meets the plane that it leaves again.
    #[must_use]
    pub fn far_hit(&self, _origin: DVec3, _direction: DVec3) -> Verdict {
        Verdict::Miss
    }

    /// Likewise.
    pub(in crate::trace) fn exit(&self, _origin: DVec3, _direction: &Exact3) -> Option<Meeting> {
        None
    }

    /// The meeting at `t`.
    #[must_use]
    pub(in crate::trace) fn surface_on(
        &self,
        origin: DVec3,
        direction: DVec3,
        t: Double,
        _face: Face,
    ) -> Refined {
        let place = Compensated3::along(origin, direction, t.rounded());
        Refined { t, point: place.moved(direction * t.rest()), normal: self.unit_normal }
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
            floor.first_hit(&ray).decided(direction, || floor.crossing(origin, &direction.into()))
        };
        assert_eq!(first(DVec3::new(0.0, 2.0, 0.0), DVec3::new(1.0, -1.0, 0.0)), Some(2.0));
        assert_eq!(first(DVec3::new(0.0, -2.0, 0.0), DVec3::new(1.0, 1.0, 0.0)), Some(2.0));
        assert_eq!(first(DVec3::new(0.0, 2.0, 0.0), DVec3::Y), None);
        assert_eq!(first(DVec3::new(0.0, 2.0, 0.0), DVec3::X), None);
        assert_eq!(first(DVec3::ZERO, DVec3::X), None, "a ray that lies in the plane");
        assert_eq!(first(DVec3::ZERO, DVec3::Y), Some(0.0));
    }
}
