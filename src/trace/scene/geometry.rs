//! The shapes of a scene, in one array per kind.

use glam::{DAffine3, DVec3};
use rayon::prelude::*;

use super::document_order::DocumentOrder;
use super::ray_visibility::{RayClass, RayVisibility};
use crate::trace::math::Bytes;
use crate::trace::rays::{PreparedRay, ShapeId};
use crate::trace::shapes::{
    AlignedBox, Bounds, BoxImage, Equation, EquationLine, Plane, Rod, RodImage, Sphere, SphereImage,
};

/// A shape prepared for intersection. The closed set of shapes that the kernel can draw.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum PreparedShape {
    /// A sphere, rigidly moved and uniformly scaled.
    Sphere(Sphere),
    /// An infinite plane.
    Plane(Plane),
    /// A box along the world axes.
    AlignedBox(AlignedBox),
    /// An ellipsoid.
    SphereImage(SphereImage),
    /// A rotated or sheared box.
    BoxImage(BoxImage),
    /// A cylinder or a capsule, rigidly moved and uniformly scaled.
    Rod(Rod),
    /// A stretched or sheared cylinder or capsule.
    RodImage(RodImage),
}

/// A reference to a stored shape.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) enum ShapeRef<'a> {
    Sphere(&'a Sphere),
    Plane(&'a Plane),
    AlignedBox(&'a AlignedBox),
    SphereImage(&'a SphereImage),
    BoxImage(&'a BoxImage),
    Rod(&'a Rod),
    RodImage(&'a RodImage),
}

/// The shapes in one array per kind, and a table of their locations by id.
#[derive(Clone, Debug, Default)]
pub struct Geometry {
    pub(crate) locations: Vec<ShapeLocation>,
    order: DocumentOrder,
    /// By id, up to the last shape that some rays do not see. All rays see the shapes beyond.
    visibilities: Vec<RayVisibility>,
    pub(crate) spheres: Vec<Sphere>,
    pub(crate) planes: Vec<Plane>,
    pub(crate) boxes: Vec<AlignedBox>,
    pub(crate) sphere_images: Vec<SphereImage>,
    pub(crate) box_images: Vec<BoxImage>,
    pub(crate) rods: Vec<Rod>,
    pub(crate) rod_images: Vec<RodImage>,
}

/// The location of a shape: its array, and the index in it, which is below 2^28, in one word.
#[derive(Clone, Copy, Debug)]
pub(crate) struct ShapeLocation(u32);

#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) enum ShapeKind {
    Sphere,
    Plane,
    AlignedBox,
    SphereImage,
    BoxImage,
    Rod,
    RodImage,
}

impl ShapeKind {
    const ALL: [Self; 7] = [
        Self::Sphere,
        Self::Plane,
        Self::AlignedBox,
        Self::SphereImage,
        Self::BoxImage,
        Self::Rod,
        Self::RodImage,
    ];
}

impl ShapeLocation {
    /// Bits of an index; those above hold the kind.
    const INDEX_BITS: u32 = Geometry::LARGEST_COUNT.ilog2();

    pub(super) fn new(kind: ShapeKind, index: usize) -> Self {
        assert!(index < Geometry::LARGEST_COUNT, "a scene has at most 2^28 shapes");
        Self((kind as u32) << Self::INDEX_BITS | to_index(index))
    }

    /// Returns the array.
    #[inline(always)]
    pub(crate) fn kind(self) -> ShapeKind {
        ShapeKind::ALL[(self.0 >> Self::INDEX_BITS) as usize]
    }

    /// Returns the index in the array.
    #[inline(always)]
    pub(crate) fn index(self) -> usize {
        self.0 as usize & (Geometry::LARGEST_COUNT - 1)
    }
}

impl Geometry {
    /// Maximum number of shapes in a scene, 2^28.
    pub const LARGEST_COUNT: usize = 1 << 28;

    /// Adds a shape after all others.
    ///
    /// # Panics
    ///
    /// With more than [`Self::LARGEST_COUNT`] shapes.
    pub fn push(&mut self, shape: PreparedShape) -> ShapeId {
        fn store<T>(list: &mut Vec<T>, kind: ShapeKind, shape: T) -> ShapeLocation {
            list.push(shape);
            ShapeLocation::new(kind, list.len() - 1)
        }
        let location = match shape {
            PreparedShape::Sphere(shape) => store(&mut self.spheres, ShapeKind::Sphere, shape),
            PreparedShape::Plane(shape) => store(&mut self.planes, ShapeKind::Plane, shape),
            PreparedShape::AlignedBox(shape) => store(&mut self.boxes, ShapeKind::AlignedBox, shape),
            PreparedShape::SphereImage(shape) => {
                store(&mut self.sphere_images, ShapeKind::SphereImage, shape)
            }
            PreparedShape::BoxImage(shape) => store(&mut self.box_images, ShapeKind::BoxImage, shape),
            PreparedShape::Rod(shape) => store(&mut self.rods, ShapeKind::Rod, shape),
            PreparedShape::RodImage(shape) => store(&mut self.rod_images, ShapeKind::RodImage, shape),
        };
        self.locations.push(location);
        let id = ShapeId(to_index(self.locations.len() - 1));
        self.order.extend([id]);
        id
    }

    /// Reserves memory for `count` more spheres.
    pub fn reserve_spheres(&mut self, count: usize) {
        self.locations.reserve_exact(count);
        self.spheres.reserve_exact(count);
    }

    /// Sets the classes of rays that see a shape.
    pub fn set_visibility(&mut self, id: ShapeId, visibility: RayVisibility) {
        if id.index() >= self.visibilities.len() {
            if visibility == RayVisibility::ALL {
                return;
            }
            self.visibilities.resize(id.index() + 1, RayVisibility::ALL);
        }
        self.visibilities[id.index()] = visibility;
    }

    /// Lets all rays see all shapes.
    pub(super) fn show_all(&mut self) {
        self.visibilities.clear();
    }

    /// Returns the classes of rays that see a shape.
    pub(crate) fn visibility(&self, id: ShapeId) -> RayVisibility {
        self.visibilities.get(id.index()).copied().unwrap_or_default()
    }

    /// Returns the shapes that rays of a class do not see.
    pub(crate) fn hidden_from(&self, class: RayClass) -> impl Iterator<Item = ShapeId> {
        let seen = (0..).map(ShapeId).zip(&self.visibilities);
        seen.filter(move |(_, visibility)| !visibility.sees(class)).map(|(id, _)| id)
    }

    /// Returns the classes of rays that see each shape, by id. All rays see the shapes beyond the end.
    pub(super) fn visibilities(&self) -> &[RayVisibility] {
        &self.visibilities
    }

    /// Returns a shape.
    #[inline(always)]
    pub(crate) fn shape(&self, id: ShapeId) -> ShapeRef<'_> {
        self.shape_at(self.locations[id.index()])
    }

    /// Returns the shape at a location.
    #[inline(always)]
    pub(super) fn shape_at(&self, location: ShapeLocation) -> ShapeRef<'_> {
        let index = location.index();
        match location.kind() {
            ShapeKind::Sphere => ShapeRef::Sphere(&self.spheres[index]),
            ShapeKind::Plane => ShapeRef::Plane(&self.planes[index]),
            ShapeKind::AlignedBox => ShapeRef::AlignedBox(&self.boxes[index]),
            ShapeKind::SphereImage => ShapeRef::SphereImage(&self.sphere_images[index]),
            ShapeKind::BoxImage => ShapeRef::BoxImage(&self.box_images[index]),
            ShapeKind::Rod => ShapeRef::Rod(&self.rods[index]),
            ShapeKind::RodImage => ShapeRef::RodImage(&self.rod_images[index]),
        }
    }

    /// Returns a shape if it is a plane.
    pub(crate) fn plane(&self, id: ShapeId) -> Option<&Plane> {
        match self.shape(id) {
            ShapeRef::Plane(plane) => Some(plane),
            _ => None,
        }
    }

    /// Replaces a shape by another of the same kind. Returns `false`, and does nothing, if the kinds differ.
    #[must_use]
    pub fn replace(&mut self, id: ShapeId, shape: PreparedShape) -> bool {
        let location = self.locations[id.index()];
        let index = location.index();
        match (location.kind(), shape) {
            (ShapeKind::Sphere, PreparedShape::Sphere(shape)) => self.spheres[index] = shape,
            (ShapeKind::Plane, PreparedShape::Plane(shape)) => self.planes[index] = shape,
            (ShapeKind::AlignedBox, PreparedShape::AlignedBox(shape)) => self.boxes[index] = shape,
            (ShapeKind::SphereImage, PreparedShape::SphereImage(shape)) => self.sphere_images[index] = shape,
            (ShapeKind::BoxImage, PreparedShape::BoxImage(shape)) => self.box_images[index] = shape,
            (ShapeKind::Rod, PreparedShape::Rod(shape)) => self.rods[index] = shape,
            (ShapeKind::RodImage, PreparedShape::RodImage(shape)) => self.rod_images[index] = shape,
            _ => return false,
        }
        true
    }

    /// Returns whether a shape is exactly this one.
    #[must_use]
    pub fn holds(&self, id: ShapeId, shape: &PreparedShape) -> bool {
        match (self.shape(id), shape) {
            (ShapeRef::Sphere(held), PreparedShape::Sphere(shape)) => held == shape,
            (ShapeRef::Plane(held), PreparedShape::Plane(shape)) => held == shape,
            (ShapeRef::AlignedBox(held), PreparedShape::AlignedBox(shape)) => held == shape,
            (ShapeRef::SphereImage(held), PreparedShape::SphereImage(shape)) => held == shape,
            (ShapeRef::BoxImage(held), PreparedShape::BoxImage(shape)) => held == shape,
            (ShapeRef::Rod(held), PreparedShape::Rod(shape)) => held == shape,
            (ShapeRef::RodImage(held), PreparedShape::RodImage(shape)) => held == shape,
            _ => false,
        }
    }

    /// Returns whether two shapes are equal in all parts.
    pub(crate) fn are_equal(&self, one: ShapeId, other: ShapeId) -> bool {
        self.shape(one) == self.shape(other)
    }

    /// Passes the numbers that define a shape to `each`. Their count or the last number differs from kind to kind.
    pub(crate) fn numbers(&self, id: ShapeId, mut each: impl FnMut(f64)) {
        let mut all = |vectors: &[DVec3]| vectors.iter().flat_map(DVec3::to_array).for_each(&mut each);
        let map = |forward: &DAffine3| {
            let linear = forward.matrix3;
            [linear.x_axis, linear.y_axis, linear.z_axis, forward.translation]
        };
        let last = match self.shape(id) {
            ShapeRef::Sphere(Sphere { center, radius }) => {
                all(&[*center]);
                *radius
            }
            ShapeRef::Plane(plane) => {
                all(&[plane.point(), plane.unit_normal()]);
                1.0
            }
            ShapeRef::AlignedBox(AlignedBox { min, max }) => {
                all(&[*min, *max]);
                2.0
            }
            ShapeRef::SphereImage(image) => {
                all(&map(image.forward()));
                image.radius()
            }
            ShapeRef::BoxImage(image) => {
                all(&map(image.forward()));
                all(&[image.half()]);
                3.0
            }
            ShapeRef::Rod(rod) => {
                all(&rod.ends());
                if let Some((row, [low, high])) = rod.slab() {
                    all(&[row, DVec3::new(low, high, 4.0)]);
                }
                rod.radius()
            }
            ShapeRef::RodImage(image) => {
                all(&map(image.forward()));
                all(&[image.stop()]);
                if let Some((row, [low, high])) = image.slab() {
                    all(&[row, DVec3::new(low, high, 5.0)]);
                }
                image.radius()
            }
        };
        each(last);
    }

    /// Writes the bytes of everything that defines a shape.
    pub(super) fn write(&self, id: ShapeId, bytes: &mut Bytes) {
        bytes.count(self.locations[id.index()].kind() as u64);
        self.numbers(id, |number| bytes.number(number));
        if let ShapeRef::Plane(plane) = self.shape(id) {
            bytes.vectors([plane.normal()]);
        }
    }

    /// Returns the number of shapes.
    #[must_use]
    pub fn len(&self) -> usize {
        self.locations.len()
    }

    /// Returns whether there are no shapes.
    #[must_use]
    pub fn is_empty(&self) -> bool {
        self.locations.is_empty()
    }

    /// Returns the number of planes.
    #[must_use]
    pub fn planes(&self) -> usize {
        self.planes.len()
    }

    /// Returns the document order of the shapes.
    pub(crate) fn order(&self) -> &DocumentOrder {
        &self.order
    }

    /// Returns all ids, in document order.
    pub(crate) fn ids_in_order(&self) -> impl Iterator<Item = ShapeId> {
        (0..to_index(self.locations.len())).map(|rank| self.order.shape_at(rank))
    }

    /// Sets another document order of the shapes. They keep their ids.
    pub(super) fn renumber(&mut self, ids: &[ShapeId]) {
        self.order.renumber(self.len(), ids);
    }

    /// Returns all ids, in the order in which shapes were added.
    pub fn ids(&self) -> impl ExactSizeIterator<Item = ShapeId> + use<> {
        (0..to_index(self.locations.len())).map(ShapeId)
    }

    /// Returns all ids, in the order in which shapes were added, as a parallel iterator.
    pub(super) fn par_ids(&self) -> impl IndexedParallelIterator<Item = ShapeId> + use<> {
        (0..to_index(self.locations.len())).into_par_iter().map(ShapeId)
    }

    /// Removes all shapes, and keeps the memory.
    pub(crate) fn clear(&mut self) {
        let Self {
            locations,
            order,
            visibilities,
            spheres,
            planes,
            boxes,
            sphere_images,
            box_images,
            rods,
            rod_images,
        } = self;
        locations.clear();
        order.clear();
        visibilities.clear();
        spheres.clear();
        planes.clear();
        boxes.clear();
        sphere_images.clear();
        box_images.clear();
        rods.clear();
        rod_images.clear();
    }

    /// Moves the shapes of another geometry to the end of this one.
    ///
    /// # Panics
    ///
    /// With more than [`Self::LARGEST_COUNT`] shapes in all.
    pub(crate) fn append(&mut self, other: &mut Self) {
        let first = to_index(self.len());
        to_index(self.len() + other.len());
        let starts = ShapeKind::ALL.map(|kind| self.count(kind));
        let moved = |location: ShapeLocation| {
            let kind = location.kind();
            ShapeLocation::new(kind, starts[kind as usize] + location.index())
        };
        self.locations.extend(other.locations.drain(..).map(moved));
        self.order.extend((first..to_index(self.locations.len())).map(ShapeId));
        other.order.clear();
        if !other.visibilities.is_empty() {
            self.visibilities.resize(first as usize, RayVisibility::ALL);
            self.visibilities.append(&mut other.visibilities);
        }
        self.spheres.append(&mut other.spheres);
        self.planes.append(&mut other.planes);
        self.boxes.append(&mut other.boxes);
        self.sphere_images.append(&mut other.sphere_images);
        self.box_images.append(&mut other.box_images);
        self.rods.append(&mut other.rods);
        self.rod_images.append(&mut other.rod_images);
    }

    fn count(&self, kind: ShapeKind) -> usize {
        match kind {
            ShapeKind::Sphere => self.spheres.len(),
            ShapeKind::Plane => self.planes.len(),
            ShapeKind::AlignedBox => self.boxes.len(),
            ShapeKind::SphereImage => self.sphere_images.len(),
            ShapeKind::BoxImage => self.box_images.len(),
            ShapeKind::Rod => self.rods.len(),
            ShapeKind::RodImage => self.rod_images.len(),
        }
    }

    /// Returns the textbook equation of the intersections of a ray's line with a shape. The ray's numbers must be finite.
    #[must_use]
    pub fn equation(&self, id: ShapeId, ray: &PreparedRay) -> Equation {
        let line = EquationLine::new(ray.origin(), ray.direction());
        match self.shape(id) {
            ShapeRef::Sphere(sphere) => sphere.equation(&line),
            ShapeRef::Plane(plane) => plane.equation(&line),
            ShapeRef::AlignedBox(shape) => shape.equation(&line),
            ShapeRef::SphereImage(image) => image.equation(&line),
            ShapeRef::BoxImage(image) => image.equation(&line),
            ShapeRef::Rod(rod) => rod.equation(&line),
            ShapeRef::RodImage(image) => image.equation(&line),
        }
    }

    /// Returns whether a shape has [bounds](Self::bounds).
    pub(super) fn is_bounded(&self, id: ShapeId) -> bool {
        match self.locations[id.index()].kind() {
            ShapeKind::Sphere | ShapeKind::AlignedBox | ShapeKind::Rod => true,
            ShapeKind::Plane => false,
            ShapeKind::SphereImage | ShapeKind::BoxImage | ShapeKind::RodImage => self.bounds(id).is_some(),
        }
    }

    /// Returns a box around the shape; `None` for planes, and for shapes that no box bounds reliably.
    #[must_use]
    #[inline]
    pub fn bounds(&self, id: ShapeId) -> Option<Bounds> {
        match self.shape(id) {
            ShapeRef::Sphere(sphere) => Some(sphere.bounds()),
            ShapeRef::Plane(_) => None,
            ShapeRef::AlignedBox(shape) => Some(shape.bounds()),
            ShapeRef::SphereImage(image) => image.bounds(),
            ShapeRef::BoxImage(image) => image.bounds(),
            ShapeRef::Rod(rod) => Some(rod.bounds()),
            ShapeRef::RodImage(image) => image.bounds(),
        }
    }
}

fn to_index(length: usize) -> u32 {
    assert!(length <= Geometry::LARGEST_COUNT, "a scene has at most 2^28 shapes");
    u32::try_from(length).unwrap_or(u32::MAX)
}
