//! Shapes in world space.

use std::cmp::Ordering::Less;

use glam::DVec3;

use crate::components::{Shape, WorldTransform};
use crate::systems::FaultCause;
use crate::systems::world_transform::ExactAffine;
use crate::trace::PreparedShape;
use crate::trace::math::{Double, Double3};
use crate::trace::shapes::{AlignedBox, BoxImage, Plane, Sphere, SphereImage};

/// Returns a shape in world space, or why there is none: where it has no extent or is far out of range, squares of its
/// coordinates would no longer be numbers.
pub(super) fn prepared_shape(shape: &Shape, transform: &WorldTransform) -> Result<PreparedShape, FaultCause> {
    /// The largest magnitude of world coordinates, and of the inverse of sizes.
    const LARGEST: f64 = 1e150;
    let matrix = transform.affine.matrix3;
    let translation = transform.affine.translation;
    let largest = matrix.to_cols_array().into_iter().fold(0.0, |largest: f64, part| largest.max(part.abs()));
    // Near 1 a determinant is not in danger.
    let unit = matrix * towards_one(largest);
    let measurable = |size: f64| (1.0 / LARGEST..LARGEST).contains(&size);
    if !transform.affine.is_finite() {
        return Err(FaultCause::NotFinite("transform"));
    }
    if largest == 0.0 {
        return Err(FaultCause::Flat);
    }
    if !measurable(largest) || translation.abs().max_element() >= LARGEST {
        return Err(FaultCause::BeyondMeasure);
    }
    if unit.determinant() == 0.0 {
        return Err(FaultCause::Flat);
    }
    let invertible = || {
        let back = unit.inverse() * towards_one(largest);
        let good = back.to_cols_array().into_iter().all(|part| part.abs() < LARGEST);
        if good { Ok(transform.affine) } else { Err(FaultCause::Flat) }
    };
    let sized = |what: &'static str, size: f64| match size {
        _ if size.is_nan() || size <= 0.0 => Err(FaultCause::NotPositive(what, size)),
        _ if !measurable(size * largest) => Err(FaultCause::BeyondMeasure),
        _ => Ok(()),
    };
    let exact = ExactAffine::of(transform);
    match *shape {
        Shape::Sphere { radius } => {
            sized("radius", radius)?;
            Ok(match transform.uniform_scale {
                Some(scale) => PreparedShape::Sphere(Sphere { center: translation, radius: radius * scale }),
                None => PreparedShape::SphereImage(SphereImage::new(invertible()?, radius)),
            })
        }
        Shape::Plane { normal } if !normal.is_finite() => Err(FaultCause::NotFinite("normal")),
        Shape::Plane { normal } => {
            let normal = normal_image(&exact, towards_one(largest), normal);
            let plane = Plane::new(translation, normal).ok_or(FaultCause::NoDirection("normal"))?;
            Ok(PreparedShape::Plane(plane))
        }
        Shape::Box { size } => {
            for edge in size.to_array() {
                sized("edge", edge)?;
            }
            let half = Double3::decimal(size).times_power(0.5);
            match aligned_half(&exact, half) {
                Some(half) => {
                    let (min, max) = (exact.translation - half, exact.translation + half);
                    let (min, max) = (min.rounded(), max.rounded());
                    if let Some(axis) = (0..3).find(|axis| min[*axis].partial_cmp(&max[*axis]) != Some(Less))
                    {
                        let edge = 2.0 * half.rounded()[axis];
                        return Err(FaultCause::Lost { edge, coordinate: translation[axis] });
                    }
                    Ok(PreparedShape::AlignedBox(AlignedBox { min, max }))
                }
                None => {
                    invertible()?;
                    let edge = size.min_element() * largest;
                    let coordinate = translation.abs().max_element();
                    BoxImage::exact(exact.columns, exact.translation, half)
                        .map(PreparedShape::BoxImage)
                        .ok_or(FaultCause::Lost { edge, coordinate })
                }
            }
        }
    }
}

/// Returns the image of a plane's normal, of any length, rounded once: normals are transformed by the inverse transpose, whose
/// columns are the cross products of the map's. `towards_one` is a power of two that brings the map's entries near 1.
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

/// Returns half the edge lengths along the world's axes, for a map that only exchanges, mirrors and stretches axes.
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

/// Returns a power of two that brings a magnitude near 1.
pub(super) fn towards_one(magnitude: f64) -> f64 {
    libm::ldexp(1.0, -libm::ilogb(magnitude).clamp(-1000, 1000))
}
