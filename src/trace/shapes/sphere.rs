//! Spheres.

use glam::DVec3;

use crate::trace::Bounds;

/// A sphere in world space.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Sphere {
    /// The centre.
    pub center: DVec3,
    /// Greater than 0.
    pub radius: f64,
}

impl Sphere {
    /// The smallest `t >= 0` on the sphere.
    ///
    /// Not the schoolbook formula, whose discriminant loses all digits for distant and for huge spheres: the discriminant
    /// comes from the ray's distance to the centre, and the root that would cancel from the other one
    /// (Haines, Günther, Akenine-Möller, "Precision Improvements for Ray/Sphere Intersection", Ray Tracing Gems, 2019,
    /// chapter 7).
    #[must_use]
    #[inline]
    pub fn first_hit(&self, origin: DVec3, direction: DVec3) -> Option<f64> {
        let to_center = self.center - origin;
        let a = direction.dot(direction);
        let b = to_center.dot(direction);
        let nearest = to_center - direction * (b / a);
        let q = self.radius * self.radius - nearest.dot(nearest);
        if q < 0.0 {
            return None;
        }
        let c = to_center.dot(to_center) - self.radius * self.radius;
        let s = b + (a * q).sqrt().copysign(b);
        if s == 0.0 {
            return Some(0.0);
        }
        let (one, other) = (c / s, s / a);
        let (near, far) = if one < other { (one, other) } else { (other, one) };
        if near >= 0.0 {
            Some(near)
        } else if far >= 0.0 {
            Some(far)
        } else {
            None
        }
    }

    /// Where a ray that starts on the sphere and goes inwards comes out. A ray that only grazes it comes out at once.
    #[must_use]
    pub fn far_hit(&self, origin: DVec3, direction: DVec3) -> Option<f64> {
        Some((-2.0 * direction.dot(origin - self.center) / direction.dot(direction)).max(0.0))
    }

    /// The point at `t`, on the surface, and its outward unit normal.
    #[must_use]
    pub fn surface_at(&self, origin: DVec3, direction: DVec3, t: f64, _far: bool) -> (DVec3, DVec3) {
        // From the centre, so that no digits are lost when the sphere is far from the world's origin.
        let normal = ((origin - self.center) + direction * t).normalize_or(DVec3::Y);
        (self.center + normal * self.radius, normal)
    }

    /// A box around it.
    #[must_use]
    pub fn bounds(&self) -> Bounds {
        Bounds::around(self.center, DVec3::splat(self.radius))
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_worked_example() {
        let sphere = Sphere { center: DVec3::new(3.0, 3.0, 1.0), radius: 2.0 };
        let (origin, direction) = (DVec3::new(0.0, -2.0, 0.0), DVec3::new(1.0, 2.0, 1.0) / 6.0_f64.sqrt());
        let t = sphere.first_hit(origin, direction).unwrap();
        assert!((t - 4.42).abs() < 0.005, "{t}");
        let (point, _) = sphere.surface_at(origin, direction, t, false);
        // The source truncates to 1.80 where rounding gives 1.81.
        assert!((point - DVec3::new(1.81, 1.61, 1.81)).abs().max_element() < 0.005, "{point}");
    }

    #[test]
    fn the_discriminant_is_not_its_root() {
        // B^2 - 4C with B = -28/sqrt 6, C = 31: 784/6 - 124 = 6.67, and t = (28/sqrt 6 -+ sqrt 6.67)/2.
        let discriminant: f64 = 784.0 / 6.0 - 124.0;
        assert!((discriminant - 6.67).abs() < 0.005);
        let near = (28.0 / 6.0_f64.sqrt() - discriminant.sqrt()) / 2.0;
        let sphere = Sphere { center: DVec3::new(3.0, 3.0, 1.0), radius: 2.0 };
        let found =
            sphere.first_hit(DVec3::new(0.0, -2.0, 0.0), DVec3::new(1.0, 2.0, 1.0) / 6.0_f64.sqrt()).unwrap();
        assert!((found - near).abs() < 1e-14);
    }

    #[test]
    fn the_nearer_root_counts_only_ahead_and_from_inside_the_farther_does() {
        let sphere = Sphere { center: DVec3::ZERO, radius: 2.0 };
        assert_eq!(sphere.first_hit(DVec3::new(0.0, 0.0, -5.0), DVec3::Z), Some(3.0));
        assert_eq!(sphere.first_hit(DVec3::new(0.0, 0.0, 1.0), DVec3::Z), Some(1.0));
        assert_eq!(sphere.first_hit(DVec3::ZERO, DVec3::Z), Some(2.0));
        assert_eq!(sphere.first_hit(DVec3::new(0.0, 0.0, 5.0), DVec3::Z), None);
        assert_eq!(sphere.first_hit(DVec3::new(0.0, 2.0, -5.0), DVec3::Z), Some(5.0), "grazing is touching");
        assert_eq!(
            sphere.first_hit(DVec3::new(0.0, 0.0, -2.0), DVec3::Z),
            Some(0.0),
            "an origin on the surface"
        );
    }

    #[test]
    fn a_ground_sphere_of_a_thousand_million_is_level() {
        let ground = Sphere { center: DVec3::new(0.0, -1e9, 0.0), radius: 1e9 };
        let t = ground.first_hit(DVec3::new(0.0, 2.0, 0.0), DVec3::new(4.0, -3.0, 0.0)).unwrap();
        assert!((t - 3.333_333_339_259_259 / 5.0).abs() < 1e-6, "{t}");
    }
}
