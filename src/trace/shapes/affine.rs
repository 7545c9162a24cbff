//! Affine images: ellipsoids, turned and sheared boxes.
//!
//! The ray is taken back into the shape's own space, where `t` is the same.

use glam::{DAffine3, DMat3, DVec3};

use super::aligned_box::{Face, exact_exit, exact_first_crossing, outward};
use super::sphere::{exact_first_root, exact_roots, first_root, newton_step};
use super::{AlignedBox, Sphere, Verdict};
use crate::trace::exact::{Compensated3, Double, Double3, square_difference};
use crate::trace::{Bounds, Ray, Refined, Root};

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
    /// Its rows with a hundred bits: the geometry is what the entries of `forward` say, exactly.
    exact_inverse: [Double3; 3],
    /// How many times a rounding error can grow on the way back.
    condition: f64,
}

impl Map {
    fn new(forward: DAffine3) -> Self {
        let inverse = inverse(forward.matrix3);
        let norm = |matrix: DMat3| matrix.x_axis.length() + matrix.y_axis.length() + matrix.z_axis.length();
        let mut condition = norm(forward.matrix3) * norm(inverse);
        // Where all digits are lost the inverse is none, and says nothing of the condition.
        if norm(forward.matrix3 * inverse - DMat3::IDENTITY) > 1e-3 {
            condition = condition.max(f64::EPSILON.recip());
        }
        Self { forward, inverse, exact_inverse: exact_inverse(forward.matrix3, inverse), condition }
    }

    #[inline]
    fn point_back(&self, point: DVec3) -> DVec3 {
        self.inverse * (point - self.forward.translation)
    }

    #[inline]
    fn direction_back(&self, direction: DVec3) -> DVec3 {
        self.inverse * direction
    }

    fn exact_point_back(&self, point: DVec3) -> Double3 {
        self.exactly_back(Double3::difference(point, self.forward.translation))
    }

    fn exact_direction_back(&self, direction: impl Into<Double3>) -> Double3 {
        self.exactly_back(direction.into())
    }

    #[inline]
    fn place_back(&self, place: Compensated3) -> Compensated3 {
        let from_translation = place.minus(self.forward.translation);
        let [x, y, z] = &self.exact_inverse;
        [from_translation.dot_exact(*x), from_translation.dot_exact(*y), from_translation.dot_exact(*z)]
            .into()
    }

    fn exactly_back(&self, vector: Double3) -> Double3 {
        let [x, y, z] = self.exact_inverse.map(|row| row.dot(vector));
        Double3 { x, y, z }
    }

    /// How many times worse than rounded once points and directions are that were taken back.
    fn roughness(&self) -> f64 {
        8.0 * self.condition
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
        let linear = self.forward.matrix3;
        if self.condition > WORST_CONDITION {
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

/// A rounded inverse. By a power of two into the middle of the range first: a determinant is a product of three lengths.
pub(in crate::trace) fn inverse(matrix: DMat3) -> DMat3 {
    let largest = matrix.to_cols_array().into_iter().fold(0.0, |largest: f64, part| largest.max(part.abs()));
    let scale = libm::ldexp(1.0, -libm::ilogb(largest).clamp(-1000, 1000));
    (matrix * scale).inverse() * scale
}

/// An inverse with a hundred bits, by two Newton steps X + X (1 - M X) from a rounded one.
fn exact_inverse(matrix: DMat3, inverse: DMat3) -> [Double3; 3] {
    let rows = |matrix: DMat3| {
        let transposed = matrix.transpose();
        [transposed.x_axis.into(), transposed.y_axis.into(), transposed.z_axis.into()]
    };
    let columns = |rows: [Double3; 3]| {
        let [a, b, c] = rows;
        [
            Double3 { x: a.x, y: b.x, z: c.x },
            Double3 { x: a.y, y: b.y, z: c.y },
            Double3 { x: a.z, y: b.z, z: c.z },
        ]
    };
    let product = |left: [Double3; 3], right: [Double3; 3]| {
        let columns = columns(right);
        left.map(|row| Double3 { x: row.dot(columns[0]), y: row.dot(columns[1]), z: row.dot(columns[2]) })
    };
    let (matrix, mut inverse): ([Double3; 3], [Double3; 3]) = (rows(matrix), rows(inverse));
    let identity: [Double3; 3] = [DVec3::X.into(), DVec3::Y.into(), DVec3::Z.into()];
    for _ in 0..2 {
        let done = product(matrix, inverse);
        let rest: [Double3; 3] = std::array::from_fn(|row| identity[row] - done[row]);
        let step = product(inverse, rest);
        inverse = std::array::from_fn(|row| inverse[row] + step[row]);
    }
    inverse
}

impl SphereImage {
    /// The image of an origin-centred sphere. The map must be invertible.
    #[must_use]
    pub fn new(forward: DAffine3, radius: f64) -> Self {
        Self { map: Map::new(forward), sphere: Sphere { center: DVec3::ZERO, radius } }
    }

    /// The map.
    #[must_use]
    pub fn forward(&self) -> &DAffine3 {
        &self.map.forward
    }

    /// The sphere's radius before it is mapped.
    #[must_use]
    pub fn radius(&self) -> f64 {
        self.sphere.radius
    }

    /// The smallest `t >= 0` on the ellipsoid.
    #[must_use]
    #[inline]
    pub fn first_hit(&self, ray: &Ray) -> Verdict {
        let (own, way) = (self.map.point_back(ray.origin()), self.map.direction_back(ray.direction()));
        first_root(-own, way, way.dot(way).recip(), self.sphere.radius, self.map.roughness())
    }

    /// As [`SphereImage::first_hit`], with a hundred bits throughout.
    #[must_use]
    pub fn exact_hit(&self, origin: DVec3, direction: impl Into<Double3>) -> Option<Double> {
        let (own, way) = (self.map.exact_point_back(origin), self.map.exact_direction_back(direction));
        exact_first_root(-own, way, self.sphere.radius)
    }

    /// The meeting near an inexact `t`, by a Newton step in the sphere's own space.
    #[must_use]
    pub fn refined(&self, origin: DVec3, direction: DVec3, t: f64) -> Refined {
        let place = Compensated3::along(origin, direction, t);
        let own = self.map.place_back(place);
        let way = self.map.direction_back(direction);
        let slope = 2.0 * own.rounded().dot(way);
        let step = newton_step(own.beyond(self.sphere.radius).rounded(), slope);
        let normal = self.map.normal(own.moved(way * step));
        Refined { t: Double::sum(t, step), point: place.moved(direction * step), normal }
    }

    /// The same near a `t` of which few bits are certain, as [`Sphere::solved`].
    #[must_use]
    pub fn solved(&self, origin: DVec3, direction: DVec3, t: f64) -> Refined {
        let better = self.refined(origin, direction, t).t.rounded();
        let good = self.refined(origin, direction, better).t.rounded();
        self.refined(origin, direction, good)
    }

    /// Where a ray that starts on the ellipsoid and goes inwards comes out.
    #[must_use]
    pub fn far_hit(&self, origin: DVec3, direction: DVec3) -> Option<Root> {
        let root = self.sphere.far_hit(self.map.point_back(origin), self.map.direction_back(direction))?;
        Some(root.rougher(self.map.roughness()))
    }

    /// As [`SphereImage::far_hit`], with a hundred bits, of the line through the origin.
    #[must_use]
    pub fn exact_far_hit(&self, origin: DVec3, direction: impl Into<Double3>) -> Option<Double> {
        let (own, way) = (self.map.exact_point_back(origin), self.map.exact_direction_back(direction));
        Some(exact_roots(-own, way, self.sphere.radius)?.1)
    }

    /// The meeting at `t`.
    #[must_use]
    pub fn surface_at(&self, origin: DVec3, direction: DVec3, t: Double, _far: bool) -> Refined {
        let place = Compensated3::along(origin, direction, t.rounded());
        let own = self.map.place_back(place).moved(self.map.direction_back(direction) * t.rest());
        Refined { t, point: place.moved(direction * t.rest()), normal: self.map.normal(own) }
    }

    /// Is the point within, not on the surface?
    #[must_use]
    pub fn contains(&self, point: DVec3) -> bool {
        square_difference(self.map.exact_point_back(point), self.sphere.radius).sign().is_lt()
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

    /// The map.
    #[must_use]
    pub fn forward(&self) -> &DAffine3 {
        &self.map.forward
    }

    /// Half the box's edge lengths before it is mapped.
    #[must_use]
    pub fn half(&self) -> DVec3 {
        self.aligned.max
    }

    /// The smallest `t >= 0` on the box.
    #[must_use]
    #[inline]
    pub fn first_hit(&self, ray: &Ray) -> Verdict {
        let (own, way) = (self.map.point_back(ray.origin()), self.map.direction_back(ray.direction()));
        self.aligned.first_crossing(own, way, self.map.roughness())
    }

    /// As [`BoxImage::first_hit`], with a hundred bits throughout.
    #[must_use]
    pub fn exact_hit(&self, origin: DVec3, direction: impl Into<Double3>) -> Option<Double> {
        Some(self.exact_meeting(origin, direction)?.0)
    }

    /// [`BoxImage::exact_hit`], with the face.
    fn exact_meeting(&self, origin: DVec3, direction: impl Into<Double3>) -> Option<(Double, Face)> {
        let (own, way) = (self.map.exact_point_back(origin), self.map.exact_direction_back(direction));
        let (low, high) = (Double3::from(self.aligned.min) - own, Double3::from(self.aligned.max) - own);
        exact_first_crossing(low, high, way)
    }

    /// The meeting near an inexact `t`, by a Newton step towards the face.
    #[must_use]
    pub fn refined(&self, origin: DVec3, direction: DVec3, t: f64) -> Refined {
        let (own, way) = (self.map.point_back(origin), self.map.direction_back(direction));
        let met = AlignedBox::roughly_met(own, way, self.map.roughness(), self.aligned.max);
        let Some(face) = self.aligned.clear_face(way, t, met) else {
            return self.surface_at(origin, direction, t.into(), false);
        };
        let place = Compensated3::along(origin, direction, t);
        let row = self.map.exact_inverse[face.axis];
        let height = place.minus(self.map.forward.translation).dot_exact(row);
        let beyond = height - self.aligned.plane(face).into();
        let step = newton_step(beyond.rounded(), row.rounded().dot(direction));
        self.met(Double::sum(t, step), place.moved(direction * step), face)
    }

    /// The same near a `t` of which few bits are certain.
    #[must_use]
    pub fn solved(&self, origin: DVec3, direction: DVec3, t: f64) -> Refined {
        self.surface_at(origin, direction, t.into(), false)
    }

    /// Where a ray that starts on the box and goes inwards comes out.
    #[must_use]
    pub fn far_hit(&self, origin: DVec3, direction: DVec3) -> Option<Root> {
        let root = self.aligned.far_hit(self.map.point_back(origin), self.map.direction_back(direction))?;
        Some(root.rougher(self.map.roughness()))
    }

    /// As [`BoxImage::far_hit`], with a hundred bits.
    #[must_use]
    pub fn exact_far_hit(&self, origin: DVec3, direction: impl Into<Double3>) -> Option<Double> {
        let (own, way) = (self.map.exact_point_back(origin), self.map.exact_direction_back(direction));
        let (low, high) = (Double3::from(self.aligned.min) - own, Double3::from(self.aligned.max) - own);
        exact_exit(low, high, way)
    }

    /// The meeting at `t`. `far` says that `t` is from [`BoxImage::far_hit`].
    #[must_use]
    pub fn surface_at(&self, origin: DVec3, direction: DVec3, t: Double, far: bool) -> Refined {
        let exact = if far { None } else { self.exact_meeting(origin, direction) };
        let (t, face) = exact.unwrap_or_else(|| {
            let (own, way) = (self.map.point_back(origin), self.map.direction_back(direction));
            (t, self.aligned.exit(own, way).1)
        });
        let place = Compensated3::along(origin, direction, t.rounded());
        self.met(t, place.moved(direction * t.rest()), face)
    }

    fn met(&self, t: Double, point: DVec3, face: Face) -> Refined {
        Refined { t, point, normal: self.map.normal(outward(face)) }
    }

    /// Is the point within, not on the surface?
    #[must_use]
    pub fn contains(&self, point: DVec3) -> bool {
        let own = self.map.exact_point_back(point);
        let within = |place: Double, half: f64| {
            (place - half.into()).sign().is_lt() && (place + half.into()).sign().is_gt()
        };
        let half = self.aligned.max;
        within(own.x, half.x) && within(own.y, half.y) && within(own.z, half.z)
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
        let first = |origin, direction| {
            let exact = || ellipsoid.exact_hit(origin, direction);
            ellipsoid.first_hit(&Ray::new(origin, direction)?).decided(direction, exact)
        };
        assert_eq!(first(DVec3::ZERO, DVec3::Z), Some(4.5));
        let (origin, direction) = (DVec3::new(2.0, 0.0, 0.0), DVec3::Z);
        let t = first(origin, direction).unwrap();
        let Refined { point, normal, .. } = ellipsoid.refined(origin, direction, t);
        // x^2/9 + z^2/0.25 = 1, gradient (2x/9, 0, 2z/0.25).
        assert!((4.0 / 9.0 + (point.z - 5.0) * (point.z - 5.0) / 0.25 - 1.0).abs() < 1e-14);
        let gradient = DVec3::new(2.0 * point.x / 9.0, 0.0, 2.0 * (point.z - 5.0) / 0.25).normalize();
        assert!((normal - gradient).length() < 1e-14);
    }

    #[test]
    fn a_mirrored_box_keeps_its_normals_outward() {
        let map = DAffine3::from_scale(DVec3::new(-1.0, 1.0, 1.0));
        let mirrored = BoxImage::new(map, DVec3::ONE);
        let origin = DVec3::new(-4.0, 0.2, 0.1);
        // Along an axis of its own, whether it meets the box is a close call.
        let ray = Ray::new(origin, DVec3::X).unwrap();
        let exact = || mirrored.exact_hit(origin, DVec3::X);
        let t = mirrored.first_hit(&ray).decided(DVec3::X, exact).unwrap();
        let Refined { point, normal, .. } = mirrored.refined(origin, DVec3::X, t);
        assert_eq!((t, point, normal), (3.0, DVec3::new(-1.0, 0.2, 0.1), DVec3::NEG_X));
    }
}
