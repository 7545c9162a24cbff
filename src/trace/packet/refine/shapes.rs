//! Parameters of the shapes that rays hit, by lane.

use fearless_simd::prelude::*;
use glam::DVec3;

use crate::trace::math::{F64s, F64s3, Mask, Numbers, Vectors, lanes, moderate, moderate3, splat, splat3};
use crate::trace::rays::{ShapeId, ShapeIds};
use crate::trace::scene::{Geometry, ShapeKind, ShapeLocation};
use crate::trace::shapes::{AlignedBox, Sphere};

/// The parameters of a shape. Those that its kind does not have hold neutral values; an image has only its kind.
#[derive(Clone, Copy)]
pub(super) struct ShapeParameters {
    pub(super) kind: ShapeKind,
    /// The centre of a sphere, the point of a plane, or the lower corner of a box.
    place: DVec3,
    /// The normal of a plane, or the upper corner of a box.
    other: DVec3,
    /// The unit normal of a plane.
    unit: DVec3,
    radius: f64,
}

/// The shapes in the lanes of a packet.
pub(super) trait Shapes {
    /// Returns the lanes with shapes of a kind other than an image.
    fn lanes_of(&self, kind: ShapeKind) -> u32;
    /// Returns the lanes with images of either kind.
    fn images(&self) -> u32;
    fn places<S: Simd>(&self, simd: S, half: usize) -> F64s3<S>;
    fn others<S: Simd>(&self, simd: S, half: usize) -> F64s3<S>;
    fn units<S: Simd>(&self, simd: S, half: usize) -> F64s3<S>;
    fn radii<S: Simd>(&self, simd: S, half: usize) -> F64s<S>;
    /// Returns the lanes in which the radius and the normal or upper corner are [`moderate`].
    fn moderate<S: Simd>(&self, simd: S, half: usize) -> Mask<S>;
}

/// The same shape in some lanes.
pub(super) struct OneShape {
    shape: ShapeParameters,
    lanes: u32,
    moderate: bool,
}

/// A separate shape in each lane.
pub(super) struct ManyShapes {
    places: Vectors,
    others: Vectors,
    units: Vectors,
    radii: Numbers,
    spheres: u32,
    planes: u32,
    boxes: u32,
    images: u32,
}

impl ShapeParameters {
    /// Looks up the parameters of a shape.
    #[inline(always)]
    pub(super) fn of(geometry: &Geometry, id: ShapeId) -> Self {
        let ShapeLocation { kind, index } = geometry.locations[id.index()];
        let index = index as usize;
        let none = Self { kind, place: DVec3::ZERO, other: DVec3::ONE, unit: DVec3::Y, radius: 1.0 };
        match kind {
            ShapeKind::Sphere => {
                let Sphere { center, radius } = geometry.spheres[index];
                Self { place: center, radius, ..none }
            }
            ShapeKind::Plane => {
                let plane = &geometry.planes[index];
                let (place, other, unit) = (plane.point(), plane.normal(), plane.unit_normal());
                Self { place, other, unit, ..none }
            }
            ShapeKind::AlignedBox => {
                let AlignedBox { min, max } = geometry.boxes[index];
                Self { place: min, other: max, ..none }
            }
            ShapeKind::SphereImage | ShapeKind::BoxImage => none,
        }
    }
}

impl OneShape {
    #[inline(always)]
    pub(super) fn new<S: Simd>(simd: S, shape: ShapeParameters, lanes: u32) -> Self {
        let numbers = moderate3(splat3(simd, shape.other)) & moderate(splat(simd, shape.radius));
        Self { shape, lanes, moderate: numbers.all_true() }
    }
}

impl Shapes for OneShape {
    #[inline(always)]
    fn moderate<S: Simd>(&self, simd: S, _half: usize) -> Mask<S> {
        // One bit per lane of half a packet.
        Mask::<S>::from_bitmask(simd, if self.moderate { 0xff } else { 0 })
    }

    #[inline(always)]
    fn lanes_of(&self, kind: ShapeKind) -> u32 {
        if self.shape.kind == kind { self.lanes } else { 0 }
    }

    #[inline(always)]
    fn images(&self) -> u32 {
        self.lanes_of(ShapeKind::SphereImage) | self.lanes_of(ShapeKind::BoxImage)
    }

    #[inline(always)]
    fn places<S: Simd>(&self, simd: S, _half: usize) -> F64s3<S> {
        splat3(simd, self.shape.place)
    }

    #[inline(always)]
    fn others<S: Simd>(&self, simd: S, _half: usize) -> F64s3<S> {
        splat3(simd, self.shape.other)
    }

    #[inline(always)]
    fn units<S: Simd>(&self, simd: S, _half: usize) -> F64s3<S> {
        splat3(simd, self.shape.unit)
    }

    #[inline(always)]
    fn radii<S: Simd>(&self, simd: S, _half: usize) -> F64s<S> {
        splat(simd, self.shape.radius)
    }
}

impl ManyShapes {
    #[inline(always)]
    pub(super) fn gather(geometry: &Geometry, ids: &ShapeIds, asked: u32) -> Self {
        let mut all = Self {
            places: Vectors::splat(DVec3::ZERO),
            others: Vectors::splat(DVec3::ONE),
            units: Vectors::splat(DVec3::Y),
            radii: Numbers::splat(1.0),
            spheres: 0,
            planes: 0,
            boxes: 0,
            images: 0,
        };
        for lane in lanes(asked) {
            let Some(id) = ids.get(lane) else { continue };
            let ShapeParameters { kind, place, other, unit, radius } = ShapeParameters::of(geometry, id);
            all.places.set(lane, place);
            let bit = 1 << lane;
            match kind {
                ShapeKind::Sphere => {
                    all.radii.set(lane, radius);
                    all.spheres |= bit;
                }
                ShapeKind::Plane => {
                    all.others.set(lane, other);
                    all.units.set(lane, unit);
                    all.planes |= bit;
                }
                ShapeKind::AlignedBox => {
                    all.others.set(lane, other);
                    all.boxes |= bit;
                }
                ShapeKind::SphereImage | ShapeKind::BoxImage => all.images |= bit,
            }
        }
        all
    }
}

impl Shapes for ManyShapes {
    #[inline(always)]
    fn moderate<S: Simd>(&self, simd: S, half: usize) -> Mask<S> {
        moderate(self.radii.load(simd, half)) & moderate3(self.others.load(simd, half))
    }

    #[inline(always)]
    fn lanes_of(&self, kind: ShapeKind) -> u32 {
        match kind {
            ShapeKind::Sphere => self.spheres,
            ShapeKind::Plane => self.planes,
            ShapeKind::AlignedBox => self.boxes,
            ShapeKind::SphereImage | ShapeKind::BoxImage => 0,
        }
    }

    #[inline(always)]
    fn images(&self) -> u32 {
        self.images
    }

    #[inline(always)]
    fn places<S: Simd>(&self, simd: S, half: usize) -> F64s3<S> {
        self.places.load(simd, half)
    }

    #[inline(always)]
    fn others<S: Simd>(&self, simd: S, half: usize) -> F64s3<S> {
        self.others.load(simd, half)
    }

    #[inline(always)]
    fn units<S: Simd>(&self, simd: S, half: usize) -> F64s3<S> {
        self.units.load(simd, half)
    }

    #[inline(always)]
    fn radii<S: Simd>(&self, simd: S, half: usize) -> F64s<S> {
        self.radii.load(simd, half)
    }
}
