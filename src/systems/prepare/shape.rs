//! Shapes in world space.

use std::cmp::Ordering::Less;

use glam::{DAffine3, DMat3, DVec3};

use crate::components::{Shape, Transform, ValidRange, Visibility, WorldTransform};
use crate::systems::FaultCause;
use crate::systems::world_transform::{self, ExactAffine};
use crate::trace::math::{Double, Double3};
use crate::trace::shapes::{AlignedBox, BoxImage, Plane, Rod, RodImage, Sphere, SphereImage};
use crate::trace::{PreparedShape, RayVisibility};

/// The largest magnitude of world coordinates and of inverse sizes.
const LARGEST: f64 = 1e150;

/// Returns a shape in world space, or the cause for which it cannot be drawn. Shapes without extent or far out of range are rejected, since
/// the squares of their coordinates would overflow or underflow.
pub(super) fn prepared_shape(shape: &Shape, transform: &WorldTransform) -> Result<PreparedShape, FaultCause> {
    let map = ShapeTransform::new(transform)?;
    match *shape {
        Shape::Sphere { radius } => map.sphere(radius),
        Shape::Plane { normal } => map.plane(normal),
        Shape::Box { size } => map.cuboid(size),
        Shape::Cylinder { radius, from, to } => map.rod(radius, [from, to], false),
        Shape::Capsule { radius, from, to } => map.rod(radius, [from, to], true),
    }
}

/// Returns the shape of a particle of a cloud with this transform: that of an entity at `position`, with the factor `scale` of its size, whose
/// parent is the cloud.
pub(super) fn particle_shape(
    shape: &Shape,
    cloud: &WorldTransform,
    position: DVec3,
    scale: f64,
) -> Result<PreparedShape, FaultCause> {
    if let (Shape::Sphere { radius }, true) = (*shape, *cloud == WorldTransform::IDENTITY) {
        // The most frequent shape by far needs no product of transforms.
        let radius = radius * scale;
        let is_near = position.abs().max_element() < LARGEST && position.is_finite();
        if is_near && measurable(scale) && measurable(radius) {
            return Ok(PreparedShape::Sphere(Sphere { center: position, radius }));
        }
    }
    if scale.is_nan() || scale <= 0.0 {
        return Err(FaultCause::OutOfRange { what: "scale", error: ValidRange::Positive.violated_by(scale) });
    }
    let own = Transform { translation: position, scale: DVec3::splat(scale), ..Transform::IDENTITY };
    prepared_shape(shape, &world_transform::child(cloud, &own))
}

/// Returns the rod of a bond of a cloud with this transform: all of it, or the half at one of its ends. Both halves end in the same plane.
pub(super) fn bond_shape(
    cloud: &WorldTransform,
    radius: f64,
    ends: [DVec3; 2],
    half: Option<usize>,
) -> Result<PreparedShape, FaultCause> {
    let [from, to] = ends.map(Double3::decimal);
    let middle = (from + to).times_power(0.5);
    let part = match half {
        None => [from, to],
        Some(0) => [from, middle],
        Some(_) => [middle, to],
    };
    ShapeTransform::new(cloud)?.part_of_rod(radius, [from, to], part, false)
}

/// Returns the classes of rays that see an entity's shape. `None` if no ray sees it, so that it is not drawn.
pub(super) fn ray_visibility(visibility: Option<&Visibility>) -> Option<RayVisibility> {
    let visibility = visibility.copied().unwrap_or_default();
    let Visibility { camera, secondary, shadow } = visibility;
    (visibility != Visibility::NONE).then_some(RayVisibility { camera, secondary, shadow })
}

/// Returns whether the squares of a size and of its inverse neither overflow nor underflow.
fn measurable(size: f64) -> bool {
    (1.0 / LARGEST..LARGEST).contains(&size)
}

/// A transform that can map shapes: finite, in range and not flat.
struct ShapeTransform<'a> {
    transform: &'a WorldTransform,
    /// The largest magnitude of the matrix entries.
    largest: f64,
}

impl<'a> ShapeTransform<'a> {
    fn new(transform: &'a WorldTransform) -> Result<Self, FaultCause> {
        let entries = transform.affine.matrix3.to_cols_array();
        let map = Self {
            transform,
            largest: entries.into_iter().fold(0.0, |largest: f64, part| largest.max(part.abs())),
        };
        if !transform.affine.is_finite() {
            return Err(FaultCause::NotFinite("transform"));
        }
        if map.largest == 0.0 {
            return Err(FaultCause::Flat);
        }
        if !measurable(map.largest) || transform.affine.translation.abs().max_element() >= LARGEST {
            return Err(FaultCause::BeyondMeasure);
        }
        if map.unit().determinant() == 0.0 {
            return Err(FaultCause::Flat);
        }
        Ok(map)
    }

    /// Returns the matrix scaled to entries near 1, for which a determinant neither overflows nor underflows.
    fn unit(&self) -> DMat3 {
        self.transform.affine.matrix3 * towards_one(self.largest)
    }

    /// Returns the map if the entries of its inverse are in range too.
    fn invertible(&self) -> Result<DAffine3, FaultCause> {
        let back = self.unit().inverse() * towards_one(self.largest);
        let good = back.to_cols_array().into_iter().all(|part| part.abs() < LARGEST);
        if good { Ok(self.transform.affine) } else { Err(FaultCause::Flat) }
    }

    /// Checks a size of a shape. `what` is the name of the size.
    fn check_size(&self, what: &'static str, size: f64) -> Result<(), FaultCause> {
        match size {
            _ if size.is_nan() || size <= 0.0 => {
                Err(FaultCause::OutOfRange { what, error: ValidRange::Positive.violated_by(size) })
            }
            _ if !measurable(size * self.largest) => Err(FaultCause::BeyondMeasure),
            _ => Ok(()),
        }
    }

    fn sphere(&self, radius: f64) -> Result<PreparedShape, FaultCause> {
        self.check_size("radius", radius)?;
        let center = self.transform.affine.translation;
        Ok(match self.transform.uniform_scale {
            Some(scale) => PreparedShape::Sphere(Sphere { center, radius: radius * scale }),
            None => PreparedShape::SphereImage(SphereImage::new(self.invertible()?, radius)),
        })
    }

    fn plane(&self, normal: DVec3) -> Result<PreparedShape, FaultCause> {
        if !normal.is_finite() {
            return Err(FaultCause::NotFinite("normal"));
        }
        let normal = normal * towards_one(normal.abs().max_element());
        let exact = ExactAffine::of(self.transform);
        let normal = normal_image(&exact, towards_one(self.largest), normal.into()).rounded();
        let plane = Plane::new(self.transform.affine.translation, normal);
        plane.map(PreparedShape::Plane).ok_or(FaultCause::NoDirection("normal"))
    }

    fn cuboid(&self, size: DVec3) -> Result<PreparedShape, FaultCause> {
        for edge in size.to_array() {
            self.check_size("edge", edge)?;
        }
        let exact = ExactAffine::of(self.transform);
        let half = Double3::decimal(size).times_power(0.5);
        if let Some(half) = aligned_half(&exact, half) {
            return self.aligned_box(&exact, half);
        }
        self.invertible()?;
        let edge = size.min_element() * self.largest;
        let coordinate = self.transform.affine.translation.abs().max_element();
        BoxImage::exact(exact.columns, exact.translation, half)
            .map(PreparedShape::BoxImage)
            .ok_or(FaultCause::Lost { what: "edge", length: edge, coordinate })
    }

    /// Returns a cylinder or, if its ends are round, a capsule.
    fn rod(&self, radius: f64, ends: [DVec3; 2], is_round: bool) -> Result<PreparedShape, FaultCause> {
        for (what, end) in ["from", "to"].into_iter().zip(ends) {
            if !end.is_finite() {
                return Err(FaultCause::NotFinite(what));
            }
        }
        let ends = ends.map(Double3::decimal);
        self.part_of_rod(radius, ends, ends, is_round)
    }

    /// Returns the part of a rod between two points of its axis.
    fn part_of_rod(
        &self,
        radius: f64,
        [from, to]: [Double3; 2],
        [start, stop]: [Double3; 2],
        is_round: bool,
    ) -> Result<PreparedShape, FaultCause> {
        self.check_size("radius", radius)?;
        let normal = to - from;
        let axis = stop - start;
        let length = axis.rounded().abs().max_element();
        if length == 0.0 {
            return Err(FaultCause::NoDirection("axis"));
        }
        let exact = ExactAffine::of(self.transform);
        let places = [start, stop].map(|end| exact.point(end));
        let [start, stop] = places.map(Double3::rounded);
        let coordinate = start.abs().max(stop.abs()).max_element();
        let is_near = start.is_finite() && stop.is_finite() && coordinate < LARGEST;
        if !(is_near && measurable(length * self.largest)) {
            return Err(FaultCause::BeyondMeasure);
        }
        let lost = FaultCause::Lost { what: "length", length: length * self.largest, coordinate };
        let row = || normal_image(&exact, towards_one(self.largest), normal);
        match self.transform.uniform_scale {
            Some(scale) => {
                let radius = radius * scale;
                let rod = match is_round {
                    true => Rod::capsule(start, stop, radius),
                    false => Rod::exact_cylinder(places, row(), radius),
                };
                rod.map(PreparedShape::Rod).ok_or(lost)
            }
            None => {
                let forward = DAffine3 { translation: start, ..self.invertible()? };
                let image = match is_round {
                    true => RodImage::capsule(forward, axis.rounded(), radius),
                    false => RodImage::exact_cylinder(forward, axis.rounded(), radius, (row(), places)),
                };
                image.map(PreparedShape::RodImage).ok_or(lost)
            }
        }
    }

    fn aligned_box(&self, exact: &ExactAffine, half: Double3) -> Result<PreparedShape, FaultCause> {
        let (min, max) = (exact.translation - half, exact.translation + half);
        let (min, max) = (min.rounded(), max.rounded());
        if let Some(axis) = (0..3).find(|axis| min[*axis].partial_cmp(&max[*axis]) != Some(Less)) {
            let (length, coordinate) = (2.0 * half.rounded()[axis], self.transform.affine.translation[axis]);
            return Err(FaultCause::Lost { what: "edge", length, coordinate });
        }
        Ok(PreparedShape::AlignedBox(AlignedBox { min, max }))
    }
}

/// Returns the image of a plane's normal, of any length. Normals are transformed by the inverse transpose, whose columns are
/// the cross products of the map's columns. `towards_one` is a power of two that brings the map's entries near 1.
fn normal_image(map: &ExactAffine, towards_one: f64, normal: Double3) -> Double3 {
    let [a, b, c] = map.columns.map(|column| column.times_power(towards_one));
    let [across_a, across_b, across_c] = [b.cross(c), c.cross(a), a.cross(b)];
    let image = across_a.scaled(normal.x) + across_b.scaled(normal.y) + across_c.scaled(normal.z);
    if a.dot(across_a).rounded() < 0.0 { -image } else { image }
}

/// Returns half the edge lengths along the world's axes for a map that only permutes, mirrors and stretches axes, `None` for other maps.
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
