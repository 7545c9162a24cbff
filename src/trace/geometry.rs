//! All shapes of a scene, and which of them a ray's questions go to.

use std::cmp::Ordering;

use glam::DVec3;

use super::exact::Double;
use super::ray::Departure;
use super::shapes::{AlignedBox, BoxImage, Plane, Sphere, SphereImage};
use super::{Bounds, Hit, Ray};

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

/// Evaluates an expression with `$shape` bound to the shape at a slot, whatever its kind.
macro_rules! ask {
    ($geometry:expr, $slot:expr, $shape:ident => $question:expr) => {{
        let Place { kind, index } = $geometry.places[$slot.index()];
        let index = index as usize;
        match kind {
            Kind::Sphere => {
                let $shape = &$geometry.spheres[index];
                $question
            }
            Kind::Plane => {
                let $shape = &$geometry.planes[index];
                $question
            }
            Kind::AlignedBox => {
                let $shape = &$geometry.boxes[index];
                $question
            }
            Kind::SphereImage => {
                let $shape = &$geometry.sphere_images[index];
                $question
            }
            Kind::BoxImage => {
                let $shape = &$geometry.box_images[index];
                $question
            }
        }
    }};
}

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

    /// Where the ray first meets the shape, if it does.
    ///
    /// The shape that the ray leaves is met again only from inside, on its far side; and so is every other shape whose
    /// surface coincided with it where the ray starts, each in its own sense.
    #[must_use]
    #[inline]
    pub fn first_hit(&self, slot: Slot, ray: &Ray) -> Option<Hit> {
        let (origin, direction) = (ray.origin(), ray.direction());
        let Some(departure) = ray.departure() else {
            return self.near_hit(slot, origin, direction);
        };
        if slot == departure.left.slot {
            return if departure.outward { None } else { self.far_hit(slot, origin, direction) };
        }
        if let Some(normal) = self.also_left(slot, departure) {
            return if direction.dot(normal) < 0.0 { self.far_hit(slot, origin, direction) } else { None };
        }
        self.near_hit(slot, origin, direction)
    }

    /// If a ray leaves this shape besides another: its outward normal there.
    fn also_left(&self, slot: Slot, departure: &Departure) -> Option<DVec3> {
        let Departure { left, ties, arrived_from, arrived_along, .. } = departure;
        let (from, along) = (*arrived_from, *arrived_along);
        let far = match ties.find(slot) {
            Some(far) => far,
            // Heaps of coincident shapes: the ray that arrived is asked again.
            None if ties.overflowed() && !left.far => {
                let near = self.near_hit(slot, from, along)?;
                let met = near.root.may_equal(&left.root)
                    && self.exact_t(&near, from, along) == self.exact_t(left, from, along);
                met.then_some(false)?
            }
            None => return None,
        };
        let (_, normal) = ask!(self, slot, shape => {
            shape.surface_at(from, along, left.root.t().into(), far)
        });
        Some(normal)
    }

    #[inline]
    fn near_hit(&self, slot: Slot, origin: DVec3, direction: DVec3) -> Option<Hit> {
        let root = ask!(self, slot, shape => shape.first_hit(origin, direction))?;
        // What is infinitely far away is not met.
        (root.t() < f64::INFINITY).then_some(Hit { root, slot, far: false })
    }

    fn far_hit(&self, slot: Slot, origin: DVec3, direction: DVec3) -> Option<Hit> {
        ask!(self, slot, shape => shape.far_hit(origin, direction)).map(|root| Hit { root, slot, far: true })
    }

    /// A hit's `t` with a hundred bits. A far side's is as exact as the point that the ray starts from.
    fn exact_t(&self, hit: &Hit, origin: DVec3, direction: DVec3) -> Double {
        let inexact = || hit.root.t().into();
        if hit.far {
            return inexact();
        }
        ask!(self, hit.slot, shape => shape.exact_hit(origin, direction)).unwrap_or_else(inexact)
    }

    /// Which of a ray's hits is nearer, exactly.
    #[must_use]
    #[inline]
    pub fn compare(&self, ray: &Ray, hit: &Hit, other: &Hit) -> Ordering {
        if !hit.root.may_equal(&other.root) {
            return hit.root.t().total_cmp(&other.root.t());
        }
        let exact = |hit: &Hit| self.exact_t(hit, ray.origin(), ray.direction());
        exact(hit).partial_cmp(&exact(other)).unwrap_or(Ordering::Equal)
    }

    /// Does the shape stand in the ray's way before `limit`?
    #[must_use]
    #[inline]
    pub fn stands_before(&self, slot: Slot, ray: &Ray, limit: f64) -> bool {
        self.first_hit(slot, ray).is_some_and(|hit| {
            hit.root.latest() < limit
                || hit.root.earliest() < limit
                    && self.exact_t(&hit, ray.origin(), ray.direction()) < Double::from(limit)
        })
    }

    /// The hit's `t`, right to the last bit of an `f64` and some beyond.
    #[must_use]
    pub fn polished_t(&self, ray: &Ray, hit: &Hit) -> Double {
        let t = hit.root.t();
        if hit.far {
            return t.into();
        }
        // A Newton step squares the relative error, and cannot better what was decided with a hundred bits.
        if hit.root.is_rough() || hit.root.is_rounded() {
            return self.exact_t(hit, ray.origin(), ray.direction());
        }
        ask!(self, hit.slot, shape => shape.polished(ray.origin(), ray.direction(), t))
    }

    /// The point that the hit found, rounded once, and the outward unit normal there.
    #[must_use]
    pub fn surface_at(&self, ray: &Ray, hit: &Hit) -> (DVec3, DVec3) {
        let t = self.polished_t(ray, hit);
        ask!(self, hit.slot, shape => shape.surface_at(ray.origin(), ray.direction(), t, hit.far))
    }
}

fn to_index(length: usize) -> u32 {
    assert!(length <= Geometry::LARGEST_COUNT, "a scene has at most 2^28 shapes");
    u32::try_from(length).unwrap_or(u32::MAX)
}
