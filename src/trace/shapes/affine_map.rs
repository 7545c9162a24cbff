//! Invertible affine maps, by which shapes are stretched, sheared and turned.

use glam::{DAffine3, DMat3, DVec3};

use super::bounds::Bounds;
use super::sphere::unit;
use crate::trace::math::{
    Compensated, Double, Double3, Exact, Exact3, Real, add, moderate3, spread, subtract, times,
};
use crate::trace::rays::Rays;

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

    /// Transforms vectors to the space before the map.
    #[inline(always)]
    pub(super) fn vectors_back<R: Real>(&self, vectors: [R; 3]) -> [R; 3] {
        image_of(&self.inverse, vectors)
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
        Rays { origin: self.vectors_back(from_translation), direction: self.vectors_back(rays.direction) }
    }

    pub(super) fn exact_point_back(&self, point: DVec3) -> Double3 {
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
