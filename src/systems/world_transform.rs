//! World transforms, in double-double arithmetic.
//!
//! Scene files contain decimal numbers: a table of height 0.6 at 0.4 and a glass of height 0.8 at 1.1 touch, though neither sum is exact in
//! binary. A number of a transform therefore stands for the short decimal number that it was rounded from, if there is one, and results are
//! rounded once, at the end. Faces that are flush as written stay flush.

use glam::{DAffine3, DMat3, DQuat, DVec3};

use crate::components::{Transform, WorldTransform};
use crate::trace::math::{Double, Double3};

/// An affine map with entries of type [`Double`], by columns.
#[derive(Clone, Copy, Debug)]
pub(super) struct ExactAffine {
    pub(super) columns: [Double3; 3],
    pub(super) translation: Double3,
}

impl ExactAffine {
    const IDENTITY: [Double3; 3] = [Double3::X, Double3::Y, Double3::Z];

    /// Returns the map of an entity's own transform.
    fn new(local: &Transform) -> Self {
        let Transform { translation, rotation, scale } = *local;
        let turned = if rotation == DQuat::IDENTITY { Self::IDENTITY } else { columns(rotation) };
        let columns = if scale == DVec3::ONE {
            turned
        } else {
            let factors = scale.to_array().map(Double::decimal);
            std::array::from_fn(|axis| turned[axis].scaled(factors[axis]))
        };
        Self { columns, translation: Double3::decimal(translation) }
    }

    /// Returns the map that an entity's world transform was rounded from.
    pub(super) fn of(world: &WorldTransform) -> Self {
        let WorldTransform { affine: high, rest: low, .. } = world;
        let sum = |high: DVec3, low: DVec3| Double3::sum(high, low);
        Self {
            columns: [
                sum(high.x_axis, low.x_axis),
                sum(high.y_axis, low.y_axis),
                sum(high.z_axis, low.z_axis),
            ],
            translation: sum(high.translation, low.translation),
        }
    }

    /// Returns the image of a vector under the linear part of the map.
    pub(super) fn linear(&self, vector: Double3) -> Double3 {
        let [a, b, c] = self.columns;
        a.scaled(vector.x) + b.scaled(vector.y) + c.scaled(vector.z)
    }

    /// Returns the image of a point.
    pub(super) fn point(&self, point: Double3) -> Double3 {
        self.linear(point) + self.translation
    }

    /// Returns the composition that applies `other` first, then this map.
    fn after(&self, other: &Self) -> Self {
        Self {
            columns: other.columns.map(|column| self.linear(column)),
            translation: self.linear(other.translation) + self.translation,
        }
    }

    fn rounded(&self, uniform_scale: Option<f64>) -> WorldTransform {
        let [a, b, c] = self.columns;
        let part = |part: fn(Double3) -> DVec3| DAffine3 {
            matrix3: DMat3::from_cols(part(a), part(b), part(c)),
            translation: part(self.translation),
        };
        WorldTransform { affine: part(Double3::rounded), rest: part(Double3::rest), uniform_scale }
    }
}

/// Returns the world transform of an entity without a parent.
pub(super) fn root(local: &Transform) -> WorldTransform {
    ExactAffine::new(local).rounded(uniform_scale(local))
}

/// Returns the world transform of an entity, given the world transform of its parent.
pub(super) fn child(parent: &WorldTransform, local: &Transform) -> WorldTransform {
    let uniform_scale = parent.uniform_scale.zip(uniform_scale(local)).map(|(outer, inner)| outer * inner);
    ExactAffine::of(parent).after(&ExactAffine::new(local)).rounded(uniform_scale)
}

fn uniform_scale(local: &Transform) -> Option<f64> {
    let size = local.scale.abs();
    (size.x == size.y && size.y == size.z).then_some(size.x)
}

/// Returns the columns of a quaternion's rotation matrix. The quaternion's length cancels: the matrix is orthogonal to a hundred bits. It
/// is exact for rotations by right angles, whose quaternions have equal components.
fn columns(rotation: DQuat) -> [Double3; 3] {
    let [x, y, z, w] = rotation.to_array();
    let square = |part: f64| Double::product(part, part);
    let twice = |a: f64, b: f64| Double::product(2.0 * a, b);
    let (xx, yy, zz, ww) = (square(x), square(y), square(z), square(w));
    let length = (xx + yy) + (zz + ww);
    if !(length.rounded() > 0.0 && length.rounded().is_finite()) {
        return ExactAffine::IDENTITY;
    }
    let column = |x: Double, y: Double, z: Double| Double3 { x: x / length, y: y / length, z: z / length };
    [
        column((ww - zz) + (xx - yy), twice(x, y) + twice(w, z), twice(x, z) - twice(w, y)),
        column(twice(x, y) - twice(w, z), (ww - xx) + (yy - zz), twice(y, z) + twice(w, x)),
        column(twice(x, z) + twice(w, y), twice(y, z) - twice(w, x), (ww - xx) + (zz - yy)),
    ]
}
