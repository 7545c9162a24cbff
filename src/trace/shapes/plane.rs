//! Planes.

use glam::DVec3;

use super::sphere::U;
use crate::trace::Root;
use crate::trace::exact::{Double, Double3, dot};

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
    pub fn first_hit(&self, origin: DVec3, direction: DVec3) -> Option<Root> {
        let to_plane = self.point - origin;
        let (height, speed) = (to_plane.dot(self.normal), direction.dot(self.normal));
        let size = self.normal.abs();
        let (height_error, speed_error) =
            (6.0 * U * to_plane.abs().dot(size), 4.0 * U * direction.abs().dot(size));
        let t = height / speed;
        let error = (height_error + t.abs() * speed_error) / speed.abs() + 2.0 * U * t.abs();
        let certain = speed.abs() > 1024.0 * speed_error;
        if certain && t > error {
            Some(Root::within(t, error))
        } else if certain && t < -error {
            None
        } else {
            self.exact_hit(origin, direction).map(Root::rounded)
        }
    }

    /// As [`Plane::first_hit`], with a hundred bits throughout.
    #[must_use]
    pub fn exact_hit(&self, origin: DVec3, direction: DVec3) -> Option<Double> {
        let speed = dot(direction.into(), self.normal);
        if speed.sign().is_eq() {
            return None;
        }
        let t = dot(Double3::difference(self.point, origin), self.normal) / speed;
        t.sign().is_ge().then_some(t)
    }

    /// The `t` near an inexact one with which the ray is on the plane.
    #[must_use]
    pub fn polished(&self, origin: DVec3, direction: DVec3, t: f64) -> Double {
        // A Newton step: what is left of the height after t.
        let left = Double3::difference(self.point, origin) - Double3::product(direction, t);
        let step = left.dot_plain(self.normal).rounded() / direction.dot(self.normal);
        if step.is_finite() { Double::from(t) + Double::from(step) } else { t.into() }
    }

    /// A straight ray never meets the plane that it leaves again.
    #[must_use]
    pub fn far_hit(&self, _origin: DVec3, _direction: DVec3) -> Option<Root> {
        None
    }

    /// The point at `t`, and the normal.
    #[must_use]
    pub fn surface_at(&self, origin: DVec3, direction: DVec3, t: Double, _far: bool) -> (DVec3, DVec3) {
        (Double3::along(origin, direction, t).rounded(), self.normal)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn planes_are_two_sided_and_parallel_rays_miss() {
        let floor = Plane { point: DVec3::ZERO, normal: DVec3::Y };
        let first = |origin: DVec3, direction: DVec3| floor.first_hit(origin, direction).map(|root| root.t());
        assert_eq!(first(DVec3::new(0.0, 2.0, 0.0), DVec3::new(1.0, -1.0, 0.0)), Some(2.0));
        assert_eq!(first(DVec3::new(0.0, -2.0, 0.0), DVec3::new(1.0, 1.0, 0.0)), Some(2.0));
        assert_eq!(first(DVec3::new(0.0, 2.0, 0.0), DVec3::Y), None);
        assert_eq!(first(DVec3::new(0.0, 2.0, 0.0), DVec3::X), None);
        assert_eq!(first(DVec3::ZERO, DVec3::X), None, "a ray that lies in the plane");
        assert_eq!(first(DVec3::ZERO, DVec3::Y), Some(0.0));
    }
}
