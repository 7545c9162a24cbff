//! Shapes in world space.

use glam::{DMat3, DVec3};

use crate::components::{Shape, WorldTransform};
use crate::trace::PreparedShape;
use crate::trace::shapes::{AlignedBox, BoxImage, Plane, Sphere, SphereImage};

/// A shape in world space. `None` where it has no extent or is beyond all measure, so that squares of its coordinates
/// would not be numbers any more.
pub(super) fn prepared_shape(shape: &Shape, transform: &WorldTransform) -> Option<PreparedShape> {
    /// Magnitudes of world coordinates, and the inverse of sizes.
    const LARGEST: f64 = 1e150;
    let matrix = transform.affine.matrix3;
    let translation = transform.affine.translation;
    let largest = matrix.to_cols_array().into_iter().fold(0.0, |largest: f64, part| largest.max(part.abs()));
    // Near 1 a determinant is not in danger.
    let unit = matrix * towards_one(largest);
    let measurable = transform.affine.is_finite()
        && (1.0 / LARGEST..LARGEST).contains(&largest)
        && translation.abs().max_element() < LARGEST
        && unit.determinant() != 0.0;
    if !measurable {
        return None;
    }
    let positive = |size: f64| {
        let reach = size * largest;
        size > 0.0 && (1.0 / LARGEST..LARGEST).contains(&reach)
    };
    match *shape {
        Shape::Sphere { radius } => match transform.uniform_scale {
            Some(scale) if positive(radius) => {
                Some(PreparedShape::Sphere(Sphere { center: translation, radius: radius * scale }))
            }
            _ => positive(radius)
                .then(|| PreparedShape::SphereImage(SphereImage::new(transform.affine, radius))),
        },
        Shape::Plane { normal } => {
            // Normals go by the inverse transpose.
            let normal = normal * towards_one(normal.abs().max_element());
            let normal = (unit.inverse().transpose() * normal).try_normalize()?;
            Some(PreparedShape::Plane(Plane { point: translation, normal }))
        }
        Shape::Box { size } => {
            let half = size * 0.5;
            if !(positive(half.x) && positive(half.y) && positive(half.z)) {
                return None;
            }
            let diagonal = DVec3::new(matrix.x_axis.x, matrix.y_axis.y, matrix.z_axis.z);
            if matrix == DMat3::from_diagonal(diagonal) {
                let half = half * diagonal.abs();
                let (min, max) = (translation - half, translation + half);
                let extended = min.cmplt(max).all();
                extended.then_some(PreparedShape::AlignedBox(AlignedBox { min, max }))
            } else {
                Some(PreparedShape::BoxImage(BoxImage::new(transform.affine, half)))
            }
        }
    }
}

/// A power of two that brings a magnitude near 1.
pub(super) fn towards_one(magnitude: f64) -> f64 {
    libm::ldexp(1.0, -libm::ilogb(magnitude).clamp(-1000, 1000))
}
