//! Refinement of sixteen hits at once to surface points, by the shapes' own formulas.

use fearless_simd::prelude::*;
use glam::DVec3;

use super::hit::{HitPacket, SurfacePacket};
use crate::trace::math::{
    BoundedT, Double, F64s, F64s3, Mask, Numbers, Vectors, bits, dot, half_lanes, half_of, lanes, mask,
    moderate, moderate3, pick3, splat, splat3,
};
use crate::trace::rays::{RayPacket, Rays, ShapeId, ShapeIds};
use crate::trace::scene::{Geometry, PreparedScene, ShapeKind, ShapeRef};
use crate::trace::shapes::{AlignedBox, Refined, Sphere, refine_box, refine_plane, refine_sphere};

/// The rays of a packet and their hits.
#[derive(Clone, Copy)]
pub(super) struct RefineInput<'a> {
    pub(super) geometry: &'a Geometry,
    pub(super) rays: &'a RayPacket,
    pub(super) hits: &'a HitPacket,
}

/// Computes the surface points of the hits in some lanes by one step from their approximate `t`. Returns the lanes for which one step does not
/// suffice; `PreparedScene::surface` refines those one by one.
#[inline(always)]
pub(crate) fn refine<S: Simd>(
    simd: S,
    scene: &PreparedScene,
    rays: &RayPacket,
    hits: &HitPacket,
    active: u32,
    surfaces: &mut SurfacePacket,
) -> u32 {
    // Coincident hits and hits of equal shapes escalate to scalar code.
    let mut special = active & hits.tied;
    if scene.equal_shapes.any() {
        let grouped =
            |lane: &usize| hits.ids.get(*lane).is_none_or(|id| scene.equal_shapes.group(id).is_some());
        special |= lanes(active).filter(grouped).fold(0, |mask, lane| mask | 1 << lane);
    }
    let usual = active & !special;
    let input = RefineInput { geometry: scene.geometry(), rays, hits };
    let found = match hits.ids.common(simd, usual) {
        _ if usual == 0 => 0,
        Some(id) => usual & !refine_one(simd, input, id, usual, surfaces),
        None => {
            let shapes = ManyShapes::gather(input.geometry, &hits.ids, usual);
            refine_lanes(simd, input, &shapes, usual, surfaces)
        }
    };
    surfaces.lanes |= found;
    surfaces.first_equals = hits.ids;
    active & !found
}

/// Refines hits of one shape that has no equals. Returns the lanes that were not refined.
#[inline(always)]
pub(super) fn refine_one<S: Simd>(
    simd: S,
    input: RefineInput<'_>,
    id: ShapeId,
    active: u32,
    surfaces: &mut SurfacePacket,
) -> u32 {
    let shape = OneShape::new(simd, ShapeParameters::of(input.geometry, id), active);
    active & !refine_lanes(simd, input, &shape, active, surfaces)
}

/// Refines hits in some lanes. Returns the lanes that were refined.
#[inline(always)]
fn refine_lanes<S: Simd>(
    simd: S,
    input: RefineInput<'_>,
    shapes: &impl Shapes,
    active: u32,
    surfaces: &mut SurfacePacket,
) -> u32 {
    let mut found = active;
    for half in 0..2 {
        if half_of(found, half) != 0 {
            found &= !refine_half(simd, input, shapes, half, found, surfaces);
        }
    }
    found
}

/// Refines hits of half a packet. Returns its lanes that have to be refined one by one.
#[inline(always)]
fn refine_half<S: Simd>(
    simd: S,
    RefineInput { geometry, rays, hits }: RefineInput<'_>,
    shapes: &impl Shapes,
    half: usize,
    active: u32,
    surfaces: &mut SurfacePacket,
) -> u32 {
    let root = BoundedT::within(hits.ts.load(simd, half), hits.errors.load(simd, half));
    // Not as a tuple, out of which the rays would be copied.
    let rays = rays.load(simd, half);
    let t = root.t();
    let moderate = moderate(t) & moderate3(rays.direction);
    let mut refined: Option<Refined<F64s<S>>> = None;
    let these = shapes.lanes_of(ShapeKind::Sphere);
    if half_of(these & active, half) != 0 {
        refined = Some(refine_sphere(shapes.places(simd, half), shapes.radii(simd, half), &rays, t));
    }
    let these = shapes.lanes_of(ShapeKind::Plane);
    if half_of(these & active, half) != 0 {
        let (point, normal) = (shapes.places(simd, half), shapes.others(simd, half));
        let plane = refine_plane(point, normal, shapes.units(simd, half), &rays, t);
        refined = Some(select(mask(simd, these, half), plane, refined));
    }
    let these = shapes.lanes_of(ShapeKind::AlignedBox);
    if half_of(these & active, half) != 0 {
        let aligned = refine_box(shapes.places(simd, half), shapes.others(simd, half), &rays, t);
        refined = Some(select(mask(simd, these, half), aligned, refined));
    }
    let moderate = moderate & shapes.moderate(simd, half);
    let mut unknown = 0;
    let mut images = shapes.images() & active & half_lanes(half);
    while let Some(id) = hits.ids.get(images.trailing_zeros() as usize).filter(|_| images != 0) {
        let these = hits.ids.lanes_of(simd, id) & images;
        images &= !these;
        let far = mask(simd, hits.far, half);
        let Some(image) = refine_image(simd, &rays, t, far, geometry.shape(id)) else {
            unknown |= these;
            continue;
        };
        refined = Some(select(mask(simd, these, half), image, refined));
    }
    let Some(refined) = refined else { return active & half_lanes(half) };
    let escalated = root.is_rounded() | root.is_rough() | !(moderate & refined.found);
    let special = (bits(escalated, half) | unknown) & active;
    let outside = dot(rays.direction, refined.normal).simd_le(splat(simd, 0.0));
    surfaces.from_outside |= bits(outside, half) & active & !special & !hits.far;
    surfaces.points.store(half, refined.point);
    surfaces.normals.store(half, refined.normal);
    surfaces.ts.store(half, refined.t.high);
    surfaces.rests.store(half, refined.t.low);
    special
}

/// Refines the hits of half of a packet's rays with a rod or with an image of a shape. `None` for other shapes.
#[inline(never)]
fn refine_image<S: Simd>(
    simd: S,
    rays: &Rays<F64s<S>>,
    t: F64s<S>,
    far: Mask<S>,
    shape: ShapeRef<'_>,
) -> Option<Refined<F64s<S>>> {
    simd.vectorize(
        #[inline(always)]
        || match shape {
            ShapeRef::SphereImage(image) => Some(image.refined(rays, t)),
            ShapeRef::BoxImage(image) => Some(image.refined(rays, t, far)),
            ShapeRef::Rod(rod) => Some(rod.refined(rays, t, far)),
            ShapeRef::RodImage(image) => Some(image.refined(rays, t, far)),
            ShapeRef::Sphere(_) | ShapeRef::Plane(_) | ShapeRef::AlignedBox(_) => None,
        },
    )
}

/// Selects `these` in lanes in which the mask is true, and `others` elsewhere.
#[inline(always)]
fn select<S: Simd>(
    mask: Mask<S>,
    these: Refined<F64s<S>>,
    others: Option<Refined<F64s<S>>>,
) -> Refined<F64s<S>> {
    let Some(others) = others else { return these };
    Refined {
        t: Double {
            high: mask.select(these.t.high, others.t.high),
            low: mask.select(these.t.low, others.t.low),
        },
        point: pick3(mask, these.point, others.point),
        normal: pick3(mask, these.normal, others.normal),
        found: (mask & these.found) | (!mask & others.found),
    }
}

/// The parameters of a shape. Those that its kind does not have hold neutral values; an image and a rod have only their kind.
#[derive(Clone, Copy)]
struct ShapeParameters {
    kind: ShapeKind,
    /// The centre of a sphere, the point of a plane, or the lower corner of a box.
    place: DVec3,
    /// The normal of a plane, or the upper corner of a box.
    other: DVec3,
    /// The unit normal of a plane.
    unit: DVec3,
    radius: f64,
}

/// The shapes in the lanes of a packet.
trait Shapes {
    /// Returns the lanes with shapes of a kind other than an image or a rod.
    fn lanes_of(&self, kind: ShapeKind) -> u32;
    /// Returns the lanes with images and rods, each refined by its own formulas.
    fn images(&self) -> u32;
    fn places<S: Simd>(&self, simd: S, half: usize) -> F64s3<S>;
    fn others<S: Simd>(&self, simd: S, half: usize) -> F64s3<S>;
    fn units<S: Simd>(&self, simd: S, half: usize) -> F64s3<S>;
    fn radii<S: Simd>(&self, simd: S, half: usize) -> F64s<S>;
    /// Returns the lanes in which the radius and the normal or upper corner are [`moderate`].
    fn moderate<S: Simd>(&self, simd: S, half: usize) -> Mask<S>;
}

/// The same shape in some lanes.
struct OneShape {
    shape: ShapeParameters,
    lanes: u32,
    moderate: bool,
}

/// A separate shape in each lane.
struct ManyShapes {
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
    fn of(geometry: &Geometry, id: ShapeId) -> Self {
        let location = geometry.locations[id.index()];
        let (kind, index) = (location.kind(), location.index());
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
            ShapeKind::SphereImage | ShapeKind::BoxImage | ShapeKind::Rod | ShapeKind::RodImage => none,
        }
    }
}

impl OneShape {
    #[inline(always)]
    fn new<S: Simd>(simd: S, shape: ShapeParameters, lanes: u32) -> Self {
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
        match self.shape.kind {
            ShapeKind::Sphere | ShapeKind::Plane | ShapeKind::AlignedBox => 0,
            ShapeKind::SphereImage | ShapeKind::BoxImage | ShapeKind::Rod | ShapeKind::RodImage => self.lanes,
        }
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
    fn gather(geometry: &Geometry, ids: &ShapeIds, active: u32) -> Self {
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
        for lane in lanes(active) {
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
                ShapeKind::SphereImage | ShapeKind::BoxImage | ShapeKind::Rod | ShapeKind::RodImage => {
                    all.images |= bit;
                }
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
            ShapeKind::SphereImage | ShapeKind::BoxImage | ShapeKind::Rod | ShapeKind::RodImage => 0,
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
