//! The shapes of a scene, in one array a kind.

use glam::{DAffine3, DVec3};
use rayon::prelude::*;

use super::document_order::DocumentOrder;
use crate::trace::math::Bytes;
use crate::trace::rays::ShapeId;
use crate::trace::shapes::{AlignedBox, Bounds, BoxImage, Plane, Sphere, SphereImage};

/// A shape, ready to be asked. The closed set of what the kernel can draw.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum PreparedShape {
    /// Rigidly moved and uniformly scaled.
    Sphere(Sphere),
    /// Infinite.
    Plane(Plane),
    /// Along the world's axes.
    AlignedBox(AlignedBox),
    /// An ellipsoid.
    SphereImage(SphereImage),
    /// A turned or sheared box.
    BoxImage(BoxImage),
}

/// A shape where it is stored.
#[derive(Clone, Copy, Debug)]
pub(crate) enum ShapeRef<'a> {
    Sphere(&'a Sphere),
    Plane(&'a Plane),
    AlignedBox(&'a AlignedBox),
    SphereImage(&'a SphereImage),
    BoxImage(&'a BoxImage),
}

/// The shapes, one array a kind, and a table from ids into them.
#[derive(Clone, Debug, Default)]
pub struct Geometry {
    pub(crate) locations: Vec<Location>,
    order: DocumentOrder,
    pub(crate) spheres: Vec<Sphere>,
    pub(crate) planes: Vec<Plane>,
    pub(crate) boxes: Vec<AlignedBox>,
    pub(crate) sphere_images: Vec<SphereImage>,
    pub(crate) box_images: Vec<BoxImage>,
}

/// Where a shape is stored: in which of the arrays, and at which index.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Location {
    pub(crate) kind: Kind,
    pub(crate) index: u32,
}

#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) enum Kind {
    Sphere,
    Plane,
    AlignedBox,
    SphereImage,
    BoxImage,
}

impl Geometry {
    /// The most shapes a scene can have, 2^28.
    pub const LARGEST_COUNT: usize = 1 << 28;

    /// Adds a shape after all others.
    ///
    /// # Panics
    ///
    /// With more than [`Self::LARGEST_COUNT`] shapes.
    pub fn push(&mut self, shape: PreparedShape) -> ShapeId {
        fn store<T>(list: &mut Vec<T>, kind: Kind, shape: T) -> Location {
            list.push(shape);
            Location { kind, index: to_index(list.len() - 1) }
        }
        let location = match shape {
            PreparedShape::Sphere(shape) => store(&mut self.spheres, Kind::Sphere, shape),
            PreparedShape::Plane(shape) => store(&mut self.planes, Kind::Plane, shape),
            PreparedShape::AlignedBox(shape) => store(&mut self.boxes, Kind::AlignedBox, shape),
            PreparedShape::SphereImage(shape) => store(&mut self.sphere_images, Kind::SphereImage, shape),
            PreparedShape::BoxImage(shape) => store(&mut self.box_images, Kind::BoxImage, shape),
        };
        self.locations.push(location);
        let id = ShapeId(to_index(self.locations.len() - 1));
        self.order.extend([id]);
        id
    }

    /// Returns a shape.
    #[inline(always)]
    pub(crate) fn shape(&self, id: ShapeId) -> ShapeRef<'_> {
        let Location { kind, index } = self.locations[id.index()];
        let index = index as usize;
        match kind {
            Kind::Sphere => ShapeRef::Sphere(&self.spheres[index]),
            Kind::Plane => ShapeRef::Plane(&self.planes[index]),
            Kind::AlignedBox => ShapeRef::AlignedBox(&self.boxes[index]),
            Kind::SphereImage => ShapeRef::SphereImage(&self.sphere_images[index]),
            Kind::BoxImage => ShapeRef::BoxImage(&self.box_images[index]),
        }
    }

    /// Puts another shape of the same kind in the place of one; `false`, and nothing done, if the kinds differ.
    #[must_use]
    pub fn replace(&mut self, id: ShapeId, shape: PreparedShape) -> bool {
        let Location { kind, index } = self.locations[id.index()];
        let index = index as usize;
        match (kind, shape) {
            (Kind::Sphere, PreparedShape::Sphere(shape)) => self.spheres[index] = shape,
            (Kind::Plane, PreparedShape::Plane(shape)) => self.planes[index] = shape,
            (Kind::AlignedBox, PreparedShape::AlignedBox(shape)) => self.boxes[index] = shape,
            (Kind::SphereImage, PreparedShape::SphereImage(shape)) => self.sphere_images[index] = shape,
            (Kind::BoxImage, PreparedShape::BoxImage(shape)) => self.box_images[index] = shape,
            _ => return false,
        }
        true
    }

    /// Says whether a shape is exactly this one.
    #[must_use]
    pub fn holds(&self, id: ShapeId, shape: &PreparedShape) -> bool {
        match (self.shape(id), shape) {
            (ShapeRef::Sphere(held), PreparedShape::Sphere(shape)) => held == shape,
            (ShapeRef::Plane(held), PreparedShape::Plane(shape)) => held == shape,
            (ShapeRef::AlignedBox(held), PreparedShape::AlignedBox(shape)) => held == shape,
            (ShapeRef::SphereImage(held), PreparedShape::SphereImage(shape)) => held == shape,
            (ShapeRef::BoxImage(held), PreparedShape::BoxImage(shape)) => held == shape,
            _ => false,
        }
    }

    /// Says whether two shapes are equal, part by part.
    pub(crate) fn are_equal(&self, one: ShapeId, other: ShapeId) -> bool {
        match (self.shape(one), self.shape(other)) {
            (ShapeRef::Sphere(one), ShapeRef::Sphere(other)) => one == other,
            (ShapeRef::Plane(one), ShapeRef::Plane(other)) => one == other,
            (ShapeRef::AlignedBox(one), ShapeRef::AlignedBox(other)) => one == other,
            (ShapeRef::SphereImage(one), ShapeRef::SphereImage(other)) => one == other,
            (ShapeRef::BoxImage(one), ShapeRef::BoxImage(other)) => one == other,
            _ => false,
        }
    }

    /// Passes on the numbers that a shape is made of, and a last one that differs from kind to kind.
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
        };
        each(last);
    }

    /// Writes the bytes of all that a shape is made of.
    pub(super) fn write(&self, id: ShapeId, bytes: &mut Bytes) {
        bytes.count(self.locations[id.index()].kind as u64);
        self.numbers(id, |number| bytes.number(number));
        if let ShapeRef::Plane(plane) = self.shape(id) {
            bytes.vectors([plane.normal()]);
        }
    }

    /// How many shapes there are.
    #[must_use]
    pub fn len(&self) -> usize {
        self.locations.len()
    }

    /// Returns whether there is nothing to see.
    #[must_use]
    pub fn is_empty(&self) -> bool {
        self.locations.is_empty()
    }

    /// How many of them are planes.
    #[must_use]
    pub fn planes(&self) -> usize {
        self.planes.len()
    }

    /// Which shape comes first in the document.
    pub(crate) fn order(&self) -> &DocumentOrder {
        &self.order
    }

    /// Returns all ids, the first of the document first.
    pub(crate) fn ids_in_order(&self) -> impl Iterator<Item = ShapeId> {
        (0..to_index(self.locations.len())).map(|rank| self.order.shape_at(rank))
    }

    /// Puts the shapes into another document order, and leaves their ids as they are.
    pub(super) fn renumber(&mut self, ids: &[ShapeId]) {
        self.order.renumber(self.len(), ids);
    }

    /// Returns all ids, in the order in which shapes were added.
    pub fn ids(&self) -> impl ExactSizeIterator<Item = ShapeId> + use<> {
        (0..to_index(self.locations.len())).map(ShapeId)
    }

    /// Returns all ids, in the order in which shapes were added, for many threads.
    pub(super) fn par_ids(&self) -> impl IndexedParallelIterator<Item = ShapeId> + use<> {
        (0..to_index(self.locations.len())).into_par_iter().map(ShapeId)
    }

    /// Removes all shapes, and keeps the memory.
    pub(crate) fn clear(&mut self) {
        let Self { locations, order, spheres, planes, boxes, sphere_images, box_images } = self;
        locations.clear();
        order.clear();
        spheres.clear();
        planes.clear();
        boxes.clear();
        sphere_images.clear();
        box_images.clear();
    }

    /// Moves the shapes of another scene behind these.
    ///
    /// # Panics
    ///
    /// With more than [`Self::LARGEST_COUNT`] shapes in all.
    pub(crate) fn append(&mut self, other: &mut Self) {
        let first = to_index(self.len());
        to_index(self.len() + other.len());
        let starts = [Kind::Sphere, Kind::Plane, Kind::AlignedBox, Kind::SphereImage, Kind::BoxImage]
            .map(|kind| to_index(self.count(kind)));
        let moved =
            |Location { kind, index }: Location| Location { kind, index: starts[kind as usize] + index };
        self.locations.extend(other.locations.drain(..).map(moved));
        self.order.extend((first..to_index(self.locations.len())).map(ShapeId));
        other.order.clear();
        self.spheres.append(&mut other.spheres);
        self.planes.append(&mut other.planes);
        self.boxes.append(&mut other.boxes);
        self.sphere_images.append(&mut other.sphere_images);
        self.box_images.append(&mut other.box_images);
    }

    fn count(&self, kind: Kind) -> usize {
        match kind {
            Kind::Sphere => self.spheres.len(),
            Kind::Plane => self.planes.len(),
            Kind::AlignedBox => self.boxes.len(),
            Kind::SphereImage => self.sphere_images.len(),
            Kind::BoxImage => self.box_images.len(),
        }
    }

    /// Returns whether a shape has [bounds](Self::bounds).
    pub(super) fn is_bounded(&self, id: ShapeId) -> bool {
        match self.locations[id.index()].kind {
            Kind::Sphere | Kind::AlignedBox => true,
            Kind::Plane => false,
            Kind::SphereImage | Kind::BoxImage => self.bounds(id).is_some(),
        }
    }

    /// A box around the shape; `None` for planes and for shapes that no box can be trusted with.
    #[must_use]
    pub fn bounds(&self, id: ShapeId) -> Option<Bounds> {
        match self.shape(id) {
            ShapeRef::Sphere(sphere) => Some(sphere.bounds()),
            ShapeRef::Plane(_) => None,
            ShapeRef::AlignedBox(shape) => Some(shape.bounds()),
            ShapeRef::SphereImage(image) => image.bounds(),
            ShapeRef::BoxImage(image) => image.bounds(),
        }
    }
}

fn to_index(length: usize) -> u32 {
    assert!(length <= Geometry::LARGEST_COUNT, "a scene has at most 2^28 shapes");
    u32::try_from(length).unwrap_or(u32::MAX)
}
