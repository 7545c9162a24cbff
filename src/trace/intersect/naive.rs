//! Naive intersection, as in textbooks, in `f64` or `f32`: the quadratic with b^2 - 4ac, slabs by reciprocals, points by origin + t direction,
//! and rays that start ahead of their origin by an epsilon that fits no scene.
//!
//! It exists for comparison: `tests/kernel/oracle` measures its errors, `benches/precision.rs` its cost.

use std::ops::{Add, Div, Mul, Neg, Sub};

use glam::{DAffine3, DMat3, DVec3};

use super::hit::ShapeHit;
use crate::trace::math::{BoundedT, Double};
use crate::trace::rays::{FAR, PreparedRay, RayView, ShapeId};
use crate::trace::scene::{Geometry, Precision, PreparedScene, ShapeKind, ShapeLocation};
use crate::trace::shapes::{RefinedHit, Rod, RodImage};

/// `f64` or `f32`.
pub(crate) trait Number:
    Copy
    + PartialOrd
    + Neg<Output = Self>
    + Add<Output = Self>
    + Sub<Output = Self>
    + Mul<Output = Self>
    + Div<Output = Self>
    + Send
    + Sync
{
    const ZERO: Self;
    /// The epsilon: the smallest `t` of a hit of a ray that leaves a surface.
    const AHEAD: Self;
    fn new(value: f64) -> Self;
    fn value(self) -> f64;
    fn sqrt(self) -> Self;
}

impl Number for f64 {
    const ZERO: Self = 0.0;
    const AHEAD: Self = 1e-9;

    fn new(value: f64) -> Self {
        value
    }

    fn value(self) -> f64 {
        self
    }

    fn sqrt(self) -> Self {
        self.sqrt()
    }
}

impl Number for f32 {
    const ZERO: Self = 0.0;
    const AHEAD: Self = 1e-4;

    #[expect(clippy::cast_possible_truncation, reason = "single precision is what is wanted")]
    fn new(value: f64) -> Self {
        value as Self
    }

    fn value(self) -> f64 {
        self.into()
    }

    fn sqrt(self) -> Self {
        self.sqrt()
    }
}

#[derive(Clone, Copy, Debug)]
struct Vector<T>([T; 3]);

impl<T: Number> Vector<T> {
    fn new(vector: DVec3) -> Self {
        Self(vector.to_array().map(T::new))
    }

    fn value(self) -> DVec3 {
        DVec3::from_array(self.0.map(T::value))
    }

    #[inline]
    fn minus(self, other: Self) -> Self {
        Self(std::array::from_fn(|axis| self.0[axis] - other.0[axis]))
    }

    #[inline]
    fn along(self, direction: Self, t: T) -> Self {
        Self(std::array::from_fn(|axis| self.0[axis] + direction.0[axis] * t))
    }

    #[inline]
    fn dot(self, other: Self) -> T {
        self.0[0] * other.0[0] + self.0[1] * other.0[1] + self.0[2] * other.0[2]
    }
}

/// The inverse of a shape's transform, to its own space.
#[derive(Debug)]
struct Back<T> {
    translation: Vector<T>,
    rows: [Vector<T>; 3],
}

impl<T: Number> Back<T> {
    fn new(forward: &DAffine3) -> Self {
        let rows = forward.matrix3.inverse().transpose();
        Self {
            translation: Vector::new(forward.translation),
            rows: [rows.x_axis, rows.y_axis, rows.z_axis].map(Vector::new),
        }
    }

    fn direction(&self, direction: Vector<T>) -> Vector<T> {
        Vector(self.rows.map(|row| row.dot(direction)))
    }

    fn point(&self, point: Vector<T>) -> Vector<T> {
        self.direction(point.minus(self.translation))
    }

    fn normal(&self, own: DVec3) -> DVec3 {
        let [x, y, z] = self.rows.map(Vector::value);
        DMat3::from_cols(x, y, z) * own
    }
}

/// All shapes of a scene, in the number type of its precision.
#[derive(Debug)]
pub(crate) enum Naive {
    Double(NaiveShapes<f64>),
    Single(NaiveShapes<f32>),
}

impl Naive {
    /// Converts the shapes of a scene; `None` if its precision is robust.
    pub(crate) fn of(scene: &PreparedScene) -> Option<Self> {
        match scene.precision {
            Precision::Robust => None,
            Precision::NaiveF64 => Some(Self::Double(NaiveShapes::new(scene.geometry()))),
            Precision::NaiveF32 => Some(Self::Single(NaiveShapes::new(scene.geometry()))),
        }
    }

    /// Returns the first hit of the ray with the shape.
    pub(super) fn intersect(&self, id: ShapeId, ray: &RayView<'_>) -> Option<ShapeHit> {
        match self {
            Self::Double(shapes) => shapes.intersect(id, ray),
            Self::Single(shapes) => shapes.intersect(id, ray),
        }
    }

    /// Computes the point and normal of a hit.
    pub(super) fn refine(&self, ray: &PreparedRay, hit: &ShapeHit) -> RefinedHit {
        match self {
            Self::Double(shapes) => shapes.refine(ray, hit),
            Self::Single(shapes) => shapes.refine(ray, hit),
        }
    }
}

/// All shapes of a scene, in one number type.
#[derive(Debug)]
pub(crate) struct NaiveShapes<T> {
    locations: Vec<ShapeLocation>,
    spheres: Vec<(Vector<T>, T)>,
    planes: Vec<(Vector<T>, Vector<T>)>,
    boxes: Vec<[Vector<T>; 2]>,
    sphere_images: Vec<(Back<T>, T)>,
    box_images: Vec<(Back<T>, [Vector<T>; 2])>,
    rods: Vec<NaiveRod<T>>,
    rod_images: Vec<(Back<T>, NaiveRod<T>)>,
}

/// A cylinder or a capsule.
#[derive(Clone, Copy, Debug)]
struct NaiveRod<T> {
    ends: [Vector<T>; 2],
    /// The unit vector from the first end to the second.
    axis: Vector<T>,
    length: T,
    radius: T,
    is_round: bool,
}

impl<T: Number> NaiveShapes<T> {
    fn new(geometry: &Geometry) -> Self {
        let vector = Vector::<T>::new;
        Self {
            locations: geometry.locations.clone(),
            spheres: geometry
                .spheres
                .iter()
                .map(|sphere| (vector(sphere.center), T::new(sphere.radius)))
                .collect(),
            planes: geometry
                .planes
                .iter()
                .map(|plane| (vector(plane.point()), vector(plane.unit_normal())))
                .collect(),
            boxes: geometry.boxes.iter().map(|shape| [vector(shape.min), vector(shape.max)]).collect(),
            sphere_images: geometry
                .sphere_images
                .iter()
                .map(|shape| (Back::new(shape.forward()), T::new(shape.radius())))
                .collect(),
            box_images: geometry
                .box_images
                .iter()
                .map(|shape| (Back::new(shape.forward()), [vector(-shape.half()), vector(shape.half())]))
                .collect(),
            rods: geometry.rods.iter().map(NaiveRod::of).collect(),
            rod_images: geometry.rod_images.iter().map(NaiveRod::of_image).collect(),
        }
    }
}

#[inline]
fn sphere<T: Number>(
    center: Vector<T>,
    radius: T,
    origin: Vector<T>,
    direction: Vector<T>,
    least: T,
) -> Option<T> {
    quadratic(center, radius, origin, direction)?.into_iter().find(|t| *t >= least)
}

/// Returns the roots of |origin + t direction - center|^2 = radius^2, the lesser one first.
#[inline]
fn quadratic<T: Number>(
    center: Vector<T>,
    radius: T,
    origin: Vector<T>,
    direction: Vector<T>,
) -> Option<[T; 2]> {
    let (two, four) = (T::new(2.0), T::new(4.0));
    let from_center = origin.minus(center);
    let a = direction.dot(direction);
    let b = two * from_center.dot(direction);
    let c = from_center.dot(from_center) - radius * radius;
    let discriminant = b * b - four * a * c;
    if discriminant < T::ZERO {
        return None;
    }
    let root = discriminant.sqrt();
    Some([(-b - root) / (two * a), (-b + root) / (two * a)])
}

impl<T: Number> NaiveRod<T> {
    fn new(ends: [DVec3; 2], radius: f64, is_round: bool) -> Self {
        let axis = ends[1] - ends[0];
        Self {
            ends: ends.map(Vector::new),
            axis: Vector::new(axis.normalize_or(DVec3::Y)),
            length: T::new(axis.length()),
            radius: T::new(radius),
            is_round,
        }
    }

    fn of(rod: &Rod) -> Self {
        Self::new(rod.ends(), rod.radius(), rod.is_round())
    }

    fn of_image(image: &RodImage) -> (Back<T>, Self) {
        let ends = [DVec3::ZERO, image.stop()];
        (Back::new(image.forward()), Self::new(ends, image.radius(), image.is_round()))
    }

    fn height(&self, point: Vector<T>) -> T {
        point.minus(self.ends[0]).dot(self.axis)
    }

    /// Returns the vector from the axis to a point.
    fn across(&self, point: Vector<T>) -> Vector<T> {
        let height = self.height(point);
        point.minus(self.ends[0].along(self.axis, height))
    }

    fn intersect(&self, origin: Vector<T>, direction: Vector<T>, least: T) -> Option<T> {
        let rate = direction.dot(self.axis);
        let (from_axis, away) = (self.across(origin), direction.along(self.axis, -rate));
        let zero = Vector::new(DVec3::ZERO);
        let height = |t: T| self.height(origin.along(direction, t));
        let mut first: Option<T> = None;
        let mut meet = |t: T, fits: bool| {
            if fits && t >= least && first.is_none_or(|first| t < first) {
                first = Some(t);
            }
        };
        for root in quadratic(zero, self.radius, from_axis, away).into_iter().flatten() {
            meet(root, height(root) >= T::ZERO && height(root) <= self.length);
        }
        for (index, end) in self.ends.into_iter().enumerate() {
            if self.is_round {
                for root in quadratic(end, self.radius, origin, direction).into_iter().flatten() {
                    let beyond = if index == 0 { height(root) < T::ZERO } else { height(root) > self.length };
                    meet(root, beyond);
                }
            } else {
                let t = end.minus(origin).dot(self.axis) / rate;
                let across = self.across(origin.along(direction, t));
                meet(t, across.dot(across) <= self.radius * self.radius);
            }
        }
        first
    }

    /// Returns the outward normal at the surface closest to a point.
    fn normal(&self, point: Vector<T>) -> DVec3 {
        let (height, across) = (self.height(point).value(), self.across(point).value());
        let (length, radius) = (self.length.value(), self.radius.value());
        let depths = [(across.length() - radius).abs(), height.abs(), (height - length).abs()];
        match self.is_round {
            true if height < 0.0 => point.minus(self.ends[0]).value(),
            true if height > length => point.minus(self.ends[1]).value(),
            false if depths[1] < depths[0] && depths[1] <= depths[2] => -self.axis.value(),
            false if depths[2] < depths[0] => self.axis.value(),
            _ => across,
        }
    }
}

#[inline]
fn slabs<T: Number>(
    [min, max]: &[Vector<T>; 2],
    origin: Vector<T>,
    direction: Vector<T>,
    least: T,
) -> Option<T> {
    let lesser = |a: T, b: T| if a < b { a } else { b };
    let greater = |a: T, b: T| if a > b { a } else { b };
    let (mut entry, mut exit) = (T::new(f64::NEG_INFINITY), T::new(f64::INFINITY));
    for axis in 0..3 {
        let inverse = T::new(1.0) / direction.0[axis];
        let at_min = (min.0[axis] - origin.0[axis]) * inverse;
        let at_max = (max.0[axis] - origin.0[axis]) * inverse;
        entry = greater(entry, lesser(at_min, at_max));
        exit = lesser(exit, greater(at_min, at_max));
    }
    if entry > exit {
        return None;
    }
    [entry, exit].into_iter().find(|t| *t >= least)
}

#[inline]
fn plane<T: Number>(
    point: Vector<T>,
    normal: Vector<T>,
    origin: Vector<T>,
    direction: Vector<T>,
    least: T,
) -> Option<T> {
    let t = point.minus(origin).dot(normal) / direction.dot(normal);
    (t >= least).then_some(t)
}

/// Returns the outward normal of the face closest to a point.
fn face_normal(min: DVec3, max: DVec3, point: DVec3) -> DVec3 {
    let from_center = (point - (min + max) * 0.5) / ((max - min) * 0.5);
    let size = from_center.abs();
    let axis = if size.x >= size.y && size.x >= size.z {
        DVec3::X
    } else if size.y >= size.z {
        DVec3::Y
    } else {
        DVec3::Z
    };
    axis * from_center.dot(axis).signum()
}

impl<T: Number> NaiveShapes<T> {
    fn intersect(&self, id: ShapeId, ray: &RayView<'_>) -> Option<ShapeHit> {
        let (origin, direction) = (Vector::<T>::new(ray.origin()), Vector::<T>::new(ray.direction()));
        let least = if ray.exclusion().is_some() { T::AHEAD } else { T::ZERO };
        let location = self.locations[id.index()];
        let index = location.index();
        let t = match location.kind() {
            ShapeKind::Sphere => {
                let (center, radius) = self.spheres[index];
                sphere(center, radius, origin, direction, least)
            }
            ShapeKind::Plane => {
                let (point, normal) = self.planes[index];
                plane(point, normal, origin, direction, least)
            }
            ShapeKind::AlignedBox => slabs(&self.boxes[index], origin, direction, least),
            ShapeKind::SphereImage => {
                let (back, radius) = &self.sphere_images[index];
                sphere(
                    Vector::new(DVec3::ZERO),
                    *radius,
                    back.point(origin),
                    back.direction(direction),
                    least,
                )
            }
            ShapeKind::BoxImage => {
                let (back, own) = &self.box_images[index];
                slabs(own, back.point(origin), back.direction(direction), least)
            }
            ShapeKind::Rod => self.rods[index].intersect(origin, direction, least),
            ShapeKind::RodImage => {
                let (back, own) = &self.rod_images[index];
                own.intersect(back.point(origin), back.direction(direction), least)
            }
        }?;
        let point = || origin.along(direction, t).value();
        let t = t.value();
        (t < FAR || point().is_finite()).then_some(ShapeHit {
            root: BoundedT::within(t, 0.0),
            id,
            far: false,
        })
    }

    fn refine(&self, ray: &PreparedRay, hit: &ShapeHit) -> RefinedHit {
        let t = hit.root.t();
        let point = Vector::<T>::new(ray.origin()).along(Vector::new(ray.direction()), T::new(t));
        let location = self.locations[hit.id.index()];
        let index = location.index();
        let normal = match location.kind() {
            ShapeKind::Sphere => point.minus(self.spheres[index].0).value(),
            ShapeKind::Plane => self.planes[index].1.value(),
            ShapeKind::AlignedBox => {
                let [min, max] = self.boxes[index];
                face_normal(min.value(), max.value(), point.value())
            }
            ShapeKind::SphereImage => {
                let (back, _) = &self.sphere_images[index];
                back.normal(back.point(point).value())
            }
            ShapeKind::BoxImage => {
                let (back, [min, max]) = &self.box_images[index];
                back.normal(face_normal(min.value(), max.value(), back.point(point).value()))
            }
            ShapeKind::Rod => self.rods[index].normal(point),
            ShapeKind::RodImage => {
                let (back, own) = &self.rod_images[index];
                back.normal(own.normal(back.point(point)))
            }
        };
        RefinedHit { t: Double::from(t), point: point.value(), normal: normal.normalize_or(DVec3::Y) }
    }
}
