//! Planes.

use glam::DVec3;

use super::Verdict;
use super::sphere::{U, newton_step};
use crate::trace::exact::{Compensated3, Double, Double3, dot};
use crate::trace::{Ray, Refined, Root};

/// An infinite plane in world space, two-sided.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Plane {
    /// A point of the plane.
    pub point: DVec3,
    /// Its unit normal.
    pub normal: DVec3,
}

impl Plane {
    /// The `t >= 0` on the plane. A ray along the plane misses it, also when it lies in it.
    #[must_use]
    #[inline]
    pub fn first_hit(&self, ray: &Ray) -> Verdict {
        let (origin, direction) = (ray.origin(), ray.direction());
        let to_plane = self.point - origin;
        let (height, speed) = (to_plane.dot(self.normal), direction.dot(self.normal));
        // The normal's components are at most 1.
        let (height_error, speed_error) =
            (6.0 * U * to_plane.abs().element_sum(), 4.0 * U * direction.abs().element_sum());
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

    /// As [`Plane::first_hit`], with a hundred bits throughout.
    #[must_use]
    pub fn exact_hit(&self, origin: DVec3, direction: impl Into<Double3>) -> Option<Double> {
        let speed = dot(direction.into(), self.normal);
        if speed.sign().is_eq() {
            return None;
        }
        let t = dot(Double3::difference(self.point, origin), self.normal) / speed;
        t.sign().is_ge().then_some(t)
    }

    /// The meeting near an inexact `t`: one Newton step from the height that is left there, in twice the working precision.
    #[must_use]
    #[inline(always)]
    pub fn refined(&self, origin: DVec3, direction: DVec3, t: f64) -> Refined {
        let place = Compensated3::along(origin, direction, t);
        let height = place.minus(self.point).dot(self.normal).rounded();
        let step = newton_step(height, direction.dot(self.normal));
        Refined { t: Double::sum(t, step), point: place.moved(direction * step), normal: self.normal }
    }

    /// The same near a `t` of which few bits are certain.
    #[must_use]
    pub fn solved(&self, origin: DVec3, direction: DVec3, t: f64) -> Refined {
        let t = self.exact_hit(origin, direction).unwrap_or(t.into());
        self.surface_at(origin, direction, t, false)
    }

    /// Is the point in the half-space behind it, not on it?
    #[must_use]
    pub fn contains(&self, point: DVec3) -> bool {
        dot(Double3::difference(point, self.point), self.normal).sign().is_lt()
    }

    /// A straight ray never meets the plane that it leaves again.
    #[must_use]
    pub fn far_hit(&self, _origin: DVec3, _direction: DVec3) -> Option<Root> {
        None
    }

    /// Likewise.
    #[must_use]
    pub fn exact_far_hit(&self, _origin: DVec3, _direction: impl Into<Double3>) -> Option<Double> {
        None
    }

    /// The meeting at `t`.
    #[must_use]
    pub fn surface_at(&self, origin: DVec3, direction: DVec3, t: Double, _far: bool) -> Refined {
        let place = Compensated3::along(origin, direction, t.rounded());
        Refined { t, point: place.moved(direction * t.rest()), normal: self.normal }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn planes_are_two_sided_and_parallel_rays_miss() {
        let floor = Plane { point: DVec3::ZERO, normal: DVec3::Y };
        let first = |origin: DVec3, direction: DVec3| {
            let ray = Ray::new(origin, direction)?;
            floor.first_hit(&ray).decided(direction, || floor.exact_hit(origin, direction))
        };
        assert_eq!(first(DVec3::new(0.0, 2.0, 0.0), DVec3::new(1.0, -1.0, 0.0)), Some(2.0));
        assert_eq!(first(DVec3::new(0.0, -2.0, 0.0), DVec3::new(1.0, 1.0, 0.0)), Some(2.0));
        assert_eq!(first(DVec3::new(0.0, 2.0, 0.0), DVec3::Y), None);
        assert_eq!(first(DVec3::new(0.0, 2.0, 0.0), DVec3::X), None);
        assert_eq!(first(DVec3::ZERO, DVec3::X), None, "a ray that lies in the plane");
        assert_eq!(first(DVec3::ZERO, DVec3::Y), Some(0.0));
    }
}
