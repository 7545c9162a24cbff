//! Planes.

use glam::DVec3;

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
    pub fn first_hit(&self, origin: DVec3, direction: DVec3) -> Option<f64> {
        let speed = direction.dot(self.normal);
        if speed == 0.0 {
            return None;
        }
        let t = (self.point - origin).dot(self.normal) / speed;
        // Adding zero makes a negative zero positive.
        (t >= 0.0).then_some(t + 0.0)
    }

    /// A straight ray never meets the plane that it leaves again.
    #[must_use]
    pub fn far_hit(&self, _origin: DVec3, _direction: DVec3) -> Option<f64> {
        None
    }

    /// The point at `t`, put back onto the plane, and the normal.
    #[must_use]
    pub fn surface_at(&self, origin: DVec3, direction: DVec3, t: f64, _far: bool) -> (DVec3, DVec3) {
        let point = origin + direction * t;
        let off = (point - self.point).dot(self.normal);
        (point - self.normal * off, self.normal)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn planes_are_two_sided_and_parallel_rays_miss() {
        let floor = Plane { point: DVec3::ZERO, normal: DVec3::Y };
        assert_eq!(floor.first_hit(DVec3::new(0.0, 2.0, 0.0), DVec3::new(1.0, -1.0, 0.0)), Some(2.0));
        assert_eq!(floor.first_hit(DVec3::new(0.0, -2.0, 0.0), DVec3::new(1.0, 1.0, 0.0)), Some(2.0));
        assert_eq!(floor.first_hit(DVec3::new(0.0, 2.0, 0.0), DVec3::Y), None);
        assert_eq!(floor.first_hit(DVec3::new(0.0, 2.0, 0.0), DVec3::X), None);
        assert_eq!(floor.first_hit(DVec3::ZERO, DVec3::X), None, "a ray that lies in the plane");
        assert_eq!(floor.first_hit(DVec3::ZERO, DVec3::Y), Some(0.0));
    }
}
