//! All shapes of a scene, and how they answer a ray's questions: [`guaranteed`], or as textbooks have it.

mod glance;
mod guaranteed;
mod textbook;

use std::cmp::Ordering;

use glam::{DAffine3, DVec3};

use super::shapes::{AlignedBox, BoxImage, Plane, Sphere, SphereImage};
use super::{Bounds, Guards, Hit, Limit, Ray, Refined};

pub(super) use textbook::Textbook;

/// The leaves of a search: the shapes, asked with some precision.
pub(super) trait Leaves: Sync {
    /// Where the ray first meets the shape, if it does.
    fn first_hit(&self, slot: Slot, ray: &Ray, guards: &mut Guards) -> Option<Hit>;

    /// Which of a ray's hits is nearer.
    fn compare(&self, ray: &Ray, hit: &Hit, other: &Hit, guards: &mut Guards) -> Ordering;

    /// Is the hit nearer than `limit`?
    fn is_before(&self, hit: &Hit, ray: &Ray, limit: &Limit, guards: &mut Guards) -> bool;

    /// Does the shape stand in the ray's way before `limit`?
    #[inline]
    fn stands_before(&self, slot: Slot, ray: &Ray, limit: &Limit, guards: &mut Guards) -> bool {
        self.first_hit(slot, ray, guards).is_some_and(|hit| self.is_before(&hit, ray, limit, guards))
    }

    /// What the hit found.
    fn refined(&self, ray: &Ray, hit: &Hit, guards: &mut Guards) -> Refined;

    /// How many times the ray crosses the shape's surface before `limit`, if that is certain at a glance.
    #[inline]
    fn certain_crossings(&self, _slot: Slot, _ray: &Ray, _limit: &Limit) -> Option<u32> {
        None
    }
}

/// How precisely shapes are asked what a ray meets.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub enum Precision {
    /// Every verdict and every digit right.
    #[default]
    Guaranteed,
    /// The schoolbook's formulas in `f64`; rays leave surfaces 1e-9 ahead. What guarantees cost, and what they save from.
    TextbookF64,
    /// The same in `f32`; rays leave surfaces 1e-4 ahead.
    TextbookF32,
}

/// A shape's place in the kernel's arrays. Slots are numbered in document order: of two surfaces at the same distance
/// the one with the lower slot is seen.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord, Hash)]
pub struct Slot(pub u32);

impl Slot {
    /// As an index into per-slot arrays.
    #[must_use]
    pub fn index(self) -> usize {
        self.0 as usize
    }
}

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

/// The shapes, one array a kind, and a table from slots into them.
#[derive(Clone, Debug, Default)]
pub struct Geometry {
    places: Vec<Place>,
    spheres: Vec<Sphere>,
    planes: Vec<Plane>,
    boxes: Vec<AlignedBox>,
    sphere_images: Vec<SphereImage>,
    box_images: Vec<BoxImage>,
}

#[derive(Clone, Copy, Debug)]
struct Place {
    kind: Kind,
    index: u32,
}

#[derive(Clone, Copy, Debug, PartialEq, Eq)]
enum Kind {
    Sphere,
    Plane,
    AlignedBox,
    SphereImage,
    BoxImage,
}

/// Evaluates an expression with `$leaves` bound to a scene's shapes, to be asked as its precision says.
macro_rules! with_leaves {
    ($scene:expr, $leaves:ident => $work:expr) => {
        match $scene.precision {
            $crate::trace::Precision::Guaranteed => {
                let $leaves = $scene.geometry();
                $work
            }
            $crate::trace::Precision::TextbookF64 => {
                let $leaves = &$crate::trace::geometry::Textbook::<f64>::new($scene.geometry());
                $work
            }
            $crate::trace::Precision::TextbookF32 => {
                let $leaves = &$crate::trace::geometry::Textbook::<f32>::new($scene.geometry());
                $work
            }
        }
    };
}

pub(super) use with_leaves;

impl Geometry {
    /// The most shapes a scene can have, 2^28.
    pub const LARGEST_COUNT: usize = 1 << 28;

    /// Adds a shape after all others.
    ///
    /// # Panics
    ///
    /// With more than [`Self::LARGEST_COUNT`] shapes.
    pub fn push(&mut self, shape: PreparedShape) -> Slot {
        fn store<T>(list: &mut Vec<T>, kind: Kind, shape: T) -> Place {
            list.push(shape);
            Place { kind, index: to_index(list.len() - 1) }
        }
        let place = match shape {
            PreparedShape::Sphere(shape) => store(&mut self.spheres, Kind::Sphere, shape),
            PreparedShape::Plane(shape) => store(&mut self.planes, Kind::Plane, shape),
            PreparedShape::AlignedBox(shape) => store(&mut self.boxes, Kind::AlignedBox, shape),
            PreparedShape::SphereImage(shape) => store(&mut self.sphere_images, Kind::SphereImage, shape),
            PreparedShape::BoxImage(shape) => store(&mut self.box_images, Kind::BoxImage, shape),
        };
        self.places.push(place);
        Slot(to_index(self.places.len() - 1))
    }

    /// Puts another shape of the same kind into a slot; `false`, and nothing done, if the kinds differ.
    #[must_use]
    pub fn replace(&mut self, slot: Slot, shape: PreparedShape) -> bool {
        let Place { kind, index } = self.places[slot.index()];
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

    /// Is this the very shape in the slot?
    #[must_use]
    pub fn holds(&self, slot: Slot, shape: &PreparedShape) -> bool {
        let Place { kind, index } = self.places[slot.index()];
        let index = index as usize;
        match (kind, shape) {
            (Kind::Sphere, PreparedShape::Sphere(shape)) => self.spheres[index] == *shape,
            (Kind::Plane, PreparedShape::Plane(shape)) => self.planes[index] == *shape,
            (Kind::AlignedBox, PreparedShape::AlignedBox(shape)) => self.boxes[index] == *shape,
            (Kind::SphereImage, PreparedShape::SphereImage(shape)) => self.sphere_images[index] == *shape,
            (Kind::BoxImage, PreparedShape::BoxImage(shape)) => self.box_images[index] == *shape,
            _ => false,
        }
    }

    /// Are the shapes in two slots equal, part by part?
    pub(super) fn are_equal(&self, one: Slot, other: Slot) -> bool {
        let Place { kind, index } = self.places[other.index()];
        let index = index as usize;
        match kind {
            Kind::Sphere => self.holds(one, &PreparedShape::Sphere(self.spheres[index])),
            Kind::Plane => self.holds(one, &PreparedShape::Plane(self.planes[index])),
            Kind::AlignedBox => self.holds(one, &PreparedShape::AlignedBox(self.boxes[index])),
            Kind::SphereImage => self.holds(one, &PreparedShape::SphereImage(self.sphere_images[index])),
            Kind::BoxImage => self.holds(one, &PreparedShape::BoxImage(self.box_images[index])),
        }
    }

    /// Passes on the numbers that a shape is made of, and a last one that differs from kind to kind.
    pub(super) fn numbers(&self, slot: Slot, mut each: impl FnMut(f64)) {
        let Place { kind, index } = self.places[slot.index()];
        let index = index as usize;
        let mut all = |vectors: &[DVec3]| vectors.iter().flat_map(DVec3::to_array).for_each(&mut each);
        let map = |forward: &DAffine3| {
            let linear = forward.matrix3;
            [linear.x_axis, linear.y_axis, linear.z_axis, forward.translation]
        };
        let last = match kind {
            Kind::Sphere => {
                let Sphere { center, radius } = self.spheres[index];
                all(&[center]);
                radius
            }
            Kind::Plane => {
                all(&[self.planes[index].point(), self.planes[index].unit_normal()]);
                1.0
            }
            Kind::AlignedBox => {
                let AlignedBox { min, max } = self.boxes[index];
                all(&[min, max]);
                2.0
            }
            Kind::SphereImage => {
                all(&map(self.sphere_images[index].forward()));
                self.sphere_images[index].radius()
            }
            Kind::BoxImage => {
                all(&map(self.box_images[index].forward()));
                all(&[self.box_images[index].half()]);
                3.0
            }
        };
        each(last);
    }

    /// How many shapes there are.
    #[must_use]
    pub fn len(&self) -> usize {
        self.places.len()
    }

    /// Is there nothing to see?
    #[must_use]
    pub fn is_empty(&self) -> bool {
        self.places.is_empty()
    }

    /// How many of them are planes.
    #[must_use]
    pub fn planes(&self) -> usize {
        self.planes.len()
    }

    /// All slots, in document order.
    pub fn slots(&self) -> impl ExactSizeIterator<Item = Slot> + use<> {
        (0..to_index(self.places.len())).map(Slot)
    }

    /// A box around the shape; `None` for planes and for shapes that no box can be trusted with.
    #[must_use]
    pub fn bounds(&self, slot: Slot) -> Option<Bounds> {
        let Place { kind, index } = self.places[slot.index()];
        let index = index as usize;
        match kind {
            Kind::Sphere => Some(self.spheres[index].bounds()),
            Kind::Plane => None,
            Kind::AlignedBox => Some(self.boxes[index].bounds()),
            Kind::SphereImage => self.sphere_images[index].bounds(),
            Kind::BoxImage => self.box_images[index].bounds(),
        }
    }
}

fn to_index(length: usize) -> u32 {
    assert!(length <= Geometry::LARGEST_COUNT, "a scene has at most 2^28 shapes");
    u32::try_from(length).unwrap_or(u32::MAX)
}
