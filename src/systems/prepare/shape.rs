//! Shapes in world space.

use glam::DVec3;

use crate::components::{Shape, WorldTransform};
use crate::systems::world_transform::ExactAffine;
use crate::trace::PreparedShape;
use crate::trace::exact::{Double, Double3};
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
    let exact = ExactAffine::of(transform);
    match *shape {
        Shape::Sphere { radius } => match transform.uniform_scale {
            Some(scale) if positive(radius) => {
                Some(PreparedShape::Sphere(Sphere { center: translation, radius: radius * scale }))
            }
            _ => positive(radius)
                .then(|| PreparedShape::SphereImage(SphereImage::new(transform.affine, radius))),
        },
        Shape::Plane { normal } => {
            let normal = normal_image(&exact, towards_one(largest), normal);
            Plane::new(translation, normal).map(PreparedShape::Plane)
        }
        Shape::Box { size } => {
            if !(positive(size.x) && positive(size.y) && positive(size.z)) {
                return None;
            }
            let half = Double3::decimal(size).times_power(0.5);
            match aligned_half(&exact, half) {
                Some(half) => {
                    let (min, max) = (exact.translation - half, exact.translation + half);
                    let (min, max) = (min.rounded(), max.rounded());
                    let extended = min.cmplt(max).all();
                    extended.then_some(PreparedShape::AlignedBox(AlignedBox { min, max }))
                }
                None => BoxImage::exact(exact.columns, exact.translation, half).map(PreparedShape::BoxImage),
            }
        }
    }
}

/// The image of a plane's normal, of any length, rounded once: normals go by the inverse transpose, whose columns are the cross
/// products of the map's. `towards_one` is a power of two that brings the map's entries near 1.
fn normal_image(map: &ExactAffine, towards_one: f64, normal: DVec3) -> DVec3 {
    let [a, b, c] = map.columns.map(|column| column.times_power(towards_one));
    let normal = normal * self::towards_one(normal.abs().max_element());
    let [across_a, across_b, across_c] = [b.cross(c), c.cross(a), a.cross(b)];
    let image = across_a.scaled(normal.x.into())
        + across_b.scaled(normal.y.into())
        + across_c.scaled(normal.z.into());
    let determinant = a.dot(across_a).rounded();
    image.rounded() * determinant.signum()
}

/// Half the edge lengths along the world's axes, for a map that does no more than exchange, mirror and stretch axes.
fn aligned_half(map: &ExactAffine, half: Double3) -> Option<Double3> {
    let mut aligned = [Double::ZERO; 3];
    for (column, half) in map.columns.into_iter().zip(half.to_array()) {
        let mut parts = column.to_array().into_iter().enumerate().filter(|(_, part)| part.rounded() != 0.0);
        let (axis, part) = parts.next()?;
        if parts.next().is_some() {
            return None;
        }
        aligned[axis] = part.abs() * half;
    }
    Some(aligned.into())
}

/// A power of two that brings a magnitude near 1.
pub(super) fn towards_one(magnitude: f64) -> f64 {
    libm::ldexp(1.0, -libm::ilogb(magnitude).clamp(-1000, 1000))
}
