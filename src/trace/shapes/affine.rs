//! Affine images: ellipsoids, turned and sheared boxes.
//!
//! The ray is taken back into the shape's own space, where `t` is the same.

use glam::{DAffine3, DMat3, DVec3};

use super::{AlignedBox, Sphere};
use crate::trace::Bounds;

/// A sphere under an affine map: an ellipsoid.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct SphereImage {
    map: Map,
    sphere: Sphere,
}

/// A box under an affine map: turned, sheared or both.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct BoxImage {
    map: Map,
    aligned: AlignedBox,
}

/// An invertible affine map with its inverse.
#[derive(Clone, Copy, Debug, PartialEq)]
struct Map {
    forward: DAffine3,
    /// The inverse of the linear part; the translation is subtracted first, which keeps more digits.
    inverse: DMat3,
}

impl Map {
    fn new(forward: DAffine3) -> Self {
        // By a power of two into the middle of the range first: a determinant is a product of three lengths.
        let largest = forward
            .matrix3
            .to_cols_array()
            .into_iter()
            .fold(0.0, |largest: f64, part| largest.max(part.abs()));
        let scale = libm::ldexp(1.0, -libm::ilogb(largest).clamp(-1000, 1000));
        Self { forward, inverse: (forward.matrix3 * scale).inverse() * scale }
    }

    fn point_back(&self, point: DVec3) -> DVec3 {
        self.inverse * (point - self.forward.translation)
    }

    fn direction_back(&self, direction: DVec3) -> DVec3 {
        self.inverse * direction
    }

    /// Normals go by the inverse transpose; a mirroring map does not turn them inside out.
    fn normal(&self, normal: DVec3) -> DVec3 {
        (self.inverse.transpose() * normal).normalize_or(DVec3::Y)
    }

    /// The box around the image of an origin-centred box, padded for the rounding of the matrix products. `None` for a map
    /// that stretches one direction so much more than another that the way back loses the digits which boxes in `f32`
    /// have to spare.
    fn bounds(&self, half: DVec3) -> Option<Bounds> {
        const PAD: f64 = 1e-14;
        const WORST_CONDITION: f64 = 1e7;
        let norm = |matrix: DMat3| matrix.x_axis.length() + matrix.y_axis.length() + matrix.z_axis.length();
        let linear = self.forward.matrix3;
        if norm(linear) * norm(self.inverse) > WORST_CONDITION {
            return None;
        }
        let reach =
            linear.x_axis.abs() * half.x + linear.y_axis.abs() * half.y + linear.z_axis.abs() * half.z;
        Some(Bounds::around(
            self.forward.translation,
            reach * (1.0 + PAD) + self.forward.translation.abs() * PAD,
        ))
    }
}

impl SphereImage {
    /// The image of an origin-centred sphere. The map must be invertible.
    #[must_use]
    pub fn new(forward: DAffine3, radius: f64) -> Self {
        Self { map: Map::new(forward), sphere: Sphere { center: DVec3::ZERO, radius } }
    }

    /// The smallest `t >= 0` on the ellipsoid.
    #[must_use]
    pub fn first_hit(&self, origin: DVec3, direction: DVec3) -> Option<f64> {
        self.sphere.first_hit(self.map.point_back(origin), self.map.direction_back(direction))
    }

    /// Where a ray that starts on the ellipsoid and goes inwards comes out.
    #[must_use]
    pub fn far_hit(&self, origin: DVec3, direction: DVec3) -> Option<f64> {
        self.sphere.far_hit(self.map.point_back(origin), self.map.direction_back(direction))
    }

    /// The point at `t`, put back onto the surface, and its outward unit normal.
    #[must_use]
    pub fn surface_at(&self, origin: DVec3, direction: DVec3, t: f64, far: bool) -> (DVec3, DVec3) {
        let own =
            self.sphere.surface_at(self.map.point_back(origin), self.map.direction_back(direction), t, far);
        (self.map.forward.transform_point3(own.0), self.map.normal(own.1))
    }

    /// A box around it, unless its own numbers are too rough to say where it ends.
    #[must_use]
    pub fn bounds(&self) -> Option<Bounds> {
        self.map.bounds(DVec3::splat(self.sphere.radius))
    }
}

impl BoxImage {
    /// The image of an origin-centred box with these half edge lengths. The map must be invertible.
    #[must_use]
    pub fn new(forward: DAffine3, half: DVec3) -> Self {
        Self { map: Map::new(forward), aligned: AlignedBox { min: -half, max: half } }
    }

    /// The smallest `t >= 0` on the box.
    #[must_use]
    pub fn first_hit(&self, origin: DVec3, direction: DVec3) -> Option<f64> {
        self.aligned.first_hit(self.map.point_back(origin), self.map.direction_back(direction))
    }

    /// Where a ray that starts on the box and goes inwards comes out.
    #[must_use]
    pub fn far_hit(&self, origin: DVec3, direction: DVec3) -> Option<f64> {
        self.aligned.far_hit(self.map.point_back(origin), self.map.direction_back(direction))
    }

    /// The point at `t`, put back onto its face, and that face's outward unit normal.
    #[must_use]
    pub fn surface_at(&self, origin: DVec3, direction: DVec3, t: f64, far: bool) -> (DVec3, DVec3) {
        let own =
            self.aligned.surface_at(self.map.point_back(origin), self.map.direction_back(direction), t, far);
        (self.map.forward.transform_point3(own.0), self.map.normal(own.1))
    }

    /// A box around it, unless its own numbers are too rough to say where it ends.
    #[must_use]
    pub fn bounds(&self) -> Option<Bounds> {
        self.map.bounds(self.aligned.max)
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use glam::DQuat;

    #[test]
    fn an_ellipsoid_is_hit_where_its_equation_says() {
        let map = DAffine3::from_scale_rotation_translation(
            DVec3::new(3.0, 1.0, 0.5),
            DQuat::IDENTITY,
            DVec3::new(0.0, 0.0, 5.0),
        );
        let ellipsoid = SphereImage::new(map, 1.0);
        assert_eq!(ellipsoid.first_hit(DVec3::ZERO, DVec3::Z), Some(4.5));
        let (origin, direction) = (DVec3::new(2.0, 0.0, 0.0), DVec3::Z);
        let t = ellipsoid.first_hit(origin, direction).unwrap();
        let (point, normal) = ellipsoid.surface_at(origin, direction, t, false);
        // x^2/9 + z^2/0.25 = 1, gradient (2x/9, 0, 2z/0.25).
        assert!((4.0 / 9.0 + (point.z - 5.0) * (point.z - 5.0) / 0.25 - 1.0).abs() < 1e-14);
        let gradient = DVec3::new(2.0 * point.x / 9.0, 0.0, 2.0 * (point.z - 5.0) / 0.25).normalize();
        assert!((normal - gradient).length() < 1e-14);
    }

    #[test]
    fn a_mirrored_box_keeps_its_normals_outward() {
        let map = DAffine3::from_scale(DVec3::new(-1.0, 1.0, 1.0));
        let mirrored = BoxImage::new(map, DVec3::ONE);
        let t = mirrored.first_hit(DVec3::new(-4.0, 0.2, 0.1), DVec3::X).unwrap();
        let (point, normal) = mirrored.surface_at(DVec3::new(-4.0, 0.2, 0.1), DVec3::X, t, false);
        assert_eq!((t, point, normal), (3.0, DVec3::new(-1.0, 0.2, 0.1), DVec3::NEG_X));
    }
}
