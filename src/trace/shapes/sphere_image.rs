//! Ellipsoids: affine images of spheres.
//!
//! Rays are transformed into the sphere's own space, which leaves `t` unchanged.

use glam::{DAffine3, DMat3, DVec3};

use super::bounds::Bounds;
use super::intersection::{
    ExactCrossing, ExactHit, Face, Facet, Intersection, Intersections, Refined, RefinedHit,
};
use super::sphere::{Sphere, U, far_root, first_root, last_root, roots, sphere_step, unit};
use crate::trace::math::{
    Compensated, Double, Double3, Exact, Exact3, Real, add, dot, moderate, moderate3, negative, spread,
    square_difference, subtract, times,
};
use crate::trace::rays::{PreparedRay, Rays};

/// A sphere under an affine map: an ellipsoid.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct SphereImage {
    map: AffineMap,
    sphere: Sphere,
}

/// An invertible affine map with its inverse.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) struct AffineMap {
    forward: DAffine3,
    /// Inverse of the linear part. The translation is subtracted first, which keeps more digits.
    inverse: DMat3,
    /// Rows of the inverse in double-double. The entries of `forward` define the geometry exactly.
    exact_inverse: [Double3; 3],
    /// Bound of the growth of rounding errors under the inverse map.
    condition: f64,
}

impl AffineMap {
    pub(super) fn new(forward: DAffine3) -> Self {
        let DMat3 { x_axis, y_axis, z_axis } = forward.matrix3;
        Self {
            forward,
            inverse: inverse(forward.matrix3),
            exact_inverse: exact_inverse([x_axis, y_axis, z_axis].map(Double3::from)),
            condition: condition(forward.matrix3),
        }
    }

    pub(super) fn forward(&self) -> &DAffine3 {
        &self.forward
    }

    /// Returns the translation, which is subtracted first, and the inverse of the linear part.
    pub(super) fn inverse(&self) -> (DVec3, &DMat3) {
        (self.forward.translation, &self.inverse)
    }

    pub(super) fn condition(&self) -> f64 {
        self.condition
    }

    /// Returns the image of a normal, of any length, in double-double.
    pub(super) fn row(&self, normal: Double3) -> Double3 {
        let [x, y, z] = self.exact_inverse;
        x.scaled(normal.x) + y.scaled(normal.y) + z.scaled(normal.z)
    }

    /// Transforms a vector to the space before the map.
    pub(super) fn vector_back(&self, vector: DVec3) -> DVec3 {
        self.inverse * vector
    }

    /// Returns the vector from the origin to the translation and the direction in the space before the map, both multiplied by the
    /// determinant of the map, which avoids divisions; and the determinant.
    pub(super) fn exactly_back(&self, origin: DVec3, direction: &Exact3) -> (Exact3, Exact3, Exact) {
        let DAffine3 { matrix3, translation } = self.forward;
        let [a, b, c] = [matrix3.x_axis, matrix3.y_axis, matrix3.z_axis].map(Exact3::from);
        let rows = [b.cross(&c), c.cross(&a), a.cross(&b)];
        let to_center = &Exact3::from(translation) - &origin.into();
        let back = |vector: &Exact3| Exact3(rows.each_ref().map(|row| row.dot(vector)));
        (back(&to_center), back(direction), a.dot(&rows[0]))
    }

    /// Transforms rays to the space before the map.
    #[inline(always)]
    pub(super) fn back<R: Real>(&self, rays: &Rays<R>) -> Rays<R> {
        let from_translation = subtract(rays.origin, spread(rays.origin[0], self.forward.translation));
        Rays {
            origin: image_of(&self.inverse, from_translation),
            direction: image_of(&self.inverse, rays.direction),
        }
    }

    fn exact_point_back(&self, point: DVec3) -> Double3 {
        let from_translation = Double3::difference(point, self.forward.translation);
        self.exact_inverse.map(|row| row.dot(from_translation)).into()
    }

    /// Transforms points to the space before the map. Returns a mask of the points whose products are error-free.
    #[inline(always)]
    pub(super) fn compensated_back<R: Real>(&self, point: Compensated<R>) -> (Compensated<R>, R::Mask) {
        let like = point.rounded()[0];
        let from_translation = point.minus(spread(like, self.forward.translation));
        let mut found = moderate3(from_translation.rounded());
        let zero = like.of(0.0);
        let mut own = [Double { high: zero, low: zero }; 3];
        for (own, row) in own.iter_mut().zip(&self.exact_inverse) {
            let (high, low) = (spread(like, row.rounded()), spread(like, row.rest()));
            found = found & moderate3(high);
            *own = from_translation.dot_exact(high, low);
        }
        (own.into(), found)
    }

    /// Returns the relative error of points and directions mapped back, in units of the unit roundoff.
    pub(super) fn roughness(&self) -> f64 {
        8.0 * self.condition
    }

    /// Transforms a normal by the inverse transpose. Mirroring maps keep normals outward.
    #[inline(always)]
    pub(super) fn normal<R: Real>(&self, normal: [R; 3]) -> [R; 3] {
        unit(image_of(&self.inverse.transpose(), normal))
    }
}

/// Multiplies a matrix by vectors, in the order of `DMat3 * DVec3`.
#[inline(always)]
fn image_of<R: Real>(matrix: &DMat3, [x, y, z]: [R; 3]) -> [R; 3] {
    let sum = add(times(spread(x, matrix.x_axis), x), times(spread(x, matrix.y_axis), y));
    add(sum, times(spread(x, matrix.z_axis), z))
}

/// Returns the bounding box of the image of an origin-centred box, padded for rounding. Returns `None` for an ill-conditioned map, whose
/// inverse loses more digits than bounding boxes in `f32` have to spare.
pub(crate) fn bounds_of_image(forward: &DAffine3, half: DVec3, condition: f64) -> Option<Bounds> {
    const WORST_CONDITION: f64 = 1e7;
    if condition > WORST_CONDITION {
        return None;
    }
    let DAffine3 { matrix3: DMat3 { x_axis, y_axis, z_axis }, translation } = *forward;
    let reach = x_axis.abs() * half.x + y_axis.abs() * half.y + z_axis.abs() * half.z;
    // Errors of a few units in the last place of the planes grow by the condition number at the corners.
    let pad = 64.0 * f64::EPSILON * condition * (reach.max_element() + translation.abs().max_element());
    Some(Bounds::around(translation, reach + DVec3::splat(pad)))
}

/// Returns a bound of the growth of rounding errors under the inverse of a map.
pub(crate) fn condition(matrix: DMat3) -> f64 {
    let norm = |matrix: DMat3| matrix.x_axis.length() + matrix.y_axis.length() + matrix.z_axis.length();
    let inverse = inverse(matrix);
    let condition = norm(matrix) * norm(inverse);
    // If all digits are lost, the computed inverse is wrong and gives no condition number.
    let lost = norm(matrix * inverse - DMat3::IDENTITY) > 1e-3;
    if lost { condition.max(f64::EPSILON.recip()) } else { condition }
}

/// Returns the rounded inverse. The matrix is scaled by a power of two first, because its determinant is a product of three lengths and
/// might overflow or underflow.
pub(crate) fn inverse(matrix: DMat3) -> DMat3 {
    let largest = matrix.to_cols_array().into_iter().fold(0.0, |largest: f64, part| largest.max(part.abs()));
    let scale = libm::ldexp(1.0, -libm::ilogb(largest).clamp(-1000, 1000));
    (matrix * scale).inverse() * scale
}

/// Returns the rows of the inverse in double-double: cross products of the columns over the determinant.
pub(crate) fn exact_inverse(columns: [Double3; 3]) -> [Double3; 3] {
    let largest =
        columns.iter().fold(0.0, |largest: f64, column| largest.max(column.rounded().abs().max_element()));
    let scale = libm::ldexp(1.0, -libm::ilogb(largest).clamp(-1000, 1000));
    let [a, b, c] = columns.map(|column| column.times_power(scale));
    let rows = [b.cross(c), c.cross(a), a.cross(b)];
    let determinant = a.dot(rows[0]);
    rows.map(|row| row.over(determinant).times_power(scale))
}

impl SphereImage {
    /// Creates the image of an origin-centred sphere. The map must be invertible.
    #[must_use]
    pub fn new(forward: DAffine3, radius: f64) -> Self {
        Self { map: AffineMap::new(forward), sphere: Sphere { center: DVec3::ZERO, radius } }
    }

    /// Returns the map.
    #[must_use]
    pub fn forward(&self) -> &DAffine3 {
        &self.map.forward
    }

    /// Returns the inverse map as the translation, which is subtracted first, and the inverse of the linear part.
    pub(crate) fn back(&self) -> (DVec3, &DMat3) {
        self.map.inverse()
    }

    /// Returns the relative error of rays in the sphere's own space, in units of the unit roundoff.
    fn roughness(&self) -> f64 {
        self.map.roughness()
    }

    /// Returns the radius of the sphere before the map.
    #[must_use]
    pub fn radius(&self) -> f64 {
        self.sphere.radius
    }

    /// Returns the smallest `t >= 0` on the ellipsoid.
    #[must_use]
    #[inline]
    pub(crate) fn intersect(&self, ray: &PreparedRay) -> Intersection {
        self.intersections(&ray.into()).into()
    }

    /// Intersects rays with the ellipsoid. `None` if all rays certainly miss.
    #[inline(always)]
    pub(crate) fn intersections<R: Real>(&self, rays: &Rays<R>) -> Option<Intersections<R>> {
        let Rays { origin, direction } = self.map.back(rays);
        let inverse_square = origin[0].of(1.0) / dot(direction, direction);
        first_root(negative(origin), direction, inverse_square, self.sphere.radius, U * self.roughness())
    }

    /// Finds the exits of rays that start on the ellipsoid and go inwards.
    #[inline(always)]
    pub(crate) fn exits<R: Real>(&self, rays: &Rays<R>) -> Intersections<R> {
        let Rays { origin, direction } = self.map.back(rays);
        far_root(negative(origin), direction, self.sphere.radius, U * self.roughness())
    }

    /// Returns the exact entry and exit of the ray's line.
    pub(crate) fn cross_exactly(&self, origin: DVec3, direction: &Exact3) -> Option<ExactCrossing> {
        let (own, way, determinant) = self.exactly_back(origin, direction);
        roots(&own, &way, &(&determinant * &self.sphere.radius.into()))
    }

    /// Returns the exact exit of a ray that starts on the ellipsoid and goes inwards.
    pub(crate) fn exit_exactly(&self, origin: DVec3, direction: &Exact3) -> Option<ExactHit> {
        let (own, way, determinant) = self.exactly_back(origin, direction);
        Some(last_root(&own, &way, &(&determinant * &self.sphere.radius.into())))
    }

    /// Returns the vector from the origin to the centre and the direction in the sphere's own space, both multiplied by the determinant of
    /// the map; and the determinant.
    pub(super) fn exactly_back(&self, origin: DVec3, direction: &Exact3) -> (Exact3, Exact3, Exact) {
        self.map.exactly_back(origin, direction)
    }

    /// Returns the hit near an approximate `t`: [`SphereImage::refined`].
    #[must_use]
    pub(crate) fn refine(&self, origin: DVec3, direction: DVec3, t: f64, _far: bool) -> Option<RefinedHit> {
        Some(self.stepped(origin, direction, t))
    }

    fn stepped(&self, origin: DVec3, direction: DVec3, t: f64) -> RefinedHit {
        self.refined(&Rays::new(origin, direction), t).into()
    }

    /// Refines a `t` near the ellipsoid by one Newton step in the sphere's own space.
    #[inline(always)]
    pub(crate) fn refined<R: Real>(&self, rays: &Rays<R>, t: R) -> Refined<R> {
        let place = Compensated::along(rays.origin, rays.direction, t);
        let (own, found) = self.map.compensated_back(place);
        let (way, radius) = (image_of(&self.map.inverse, rays.direction), t.of(self.sphere.radius));
        let step = sphere_step(own, way, radius);
        Refined {
            t: Double::sum(t, step),
            point: place.moved(times(rays.direction, step)),
            normal: self.map.normal(own.moved(times(way, step))),
            found: found & moderate3(own.rounded()) & moderate(radius),
        }
    }

    /// Returns the hit near a `t` with few certain bits, as [`Sphere::solve`].
    #[must_use]
    pub(crate) fn solve(&self, origin: DVec3, direction: DVec3, t: f64) -> Option<RefinedHit> {
        let better = self.stepped(origin, direction, t).t.rounded();
        let good = self.stepped(origin, direction, better).t.rounded();
        Some(self.stepped(origin, direction, good))
    }

    /// Returns the exit of a ray that starts on the ellipsoid and goes inwards.
    #[must_use]
    pub(crate) fn exit(&self, origin: DVec3, direction: DVec3) -> Intersection {
        self.exits(&Rays::new(origin, direction)).into()
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
        let own = self.map.compensated_back(place).0.moved(self.map.inverse * direction * t.rest());
        let normal = self.map.normal(own).into();
        RefinedHit { t, point: place.moved(direction * t.rest()).into(), normal }
    }

    /// Always returns `None`: an ellipsoid has no flat face.
    pub(crate) fn facet(&self, _origin: DVec3, _direction: DVec3, _t: f64, _far: bool) -> Option<Facet> {
        None
    }

    /// Returns whether the point is strictly inside.
    #[must_use]
    pub fn contains(&self, point: DVec3) -> bool {
        square_difference(self.map.exact_point_back(point), self.sphere.radius).sign().is_lt()
    }

    /// Returns the bounding box, or `None` if the map is too ill-conditioned for a reliable one.
    #[must_use]
    pub fn bounds(&self) -> Option<Bounds> {
        bounds_of_image(&self.map.forward, DVec3::splat(self.sphere.radius), self.map.condition)
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
        let first = |origin, direction: DVec3| {
            let exact = || ellipsoid.cross_exactly(origin, &direction.into());
            ellipsoid.intersect(&PreparedRay::new(origin, direction)?).decided(direction, exact)
        };
        assert_eq!(first(DVec3::ZERO, DVec3::Z), Some(4.5));
        let (origin, direction) = (DVec3::new(2.0, 0.0, 0.0), DVec3::Z);
        let t = first(origin, direction).unwrap();
        let RefinedHit { point, normal, .. } = ellipsoid.stepped(origin, direction, t);
        // The ellipse is x^2/9 + z^2/0.25 = 1, its gradient (2x/9, 0, 2z/0.25).
        assert!((4.0 / 9.0 + (point.z - 5.0) * (point.z - 5.0) / 0.25 - 1.0).abs() < 1e-14);
        let gradient = DVec3::new(2.0 * point.x / 9.0, 0.0, 2.0 * (point.z - 5.0) / 0.25).normalize();
        assert!((normal - gradient).length() < 1e-14);
    }
}
