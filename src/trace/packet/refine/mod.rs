//! Refinement of sixteen hits at once, by the shapes' own formulas.

mod shapes;

use fearless_simd::prelude::*;

use self::shapes::{ManyShapes, OneShape, ShapeParameters, Shapes};
use crate::trace::math::{
    BoundedT, Double, F64s, Mask, bits, dot, half_lanes, half_of, lanes, mask, moderate, moderate3, pick3,
    splat,
};
use crate::trace::query::{HitPacket, SurfacePacket};
use crate::trace::rays::{RayPacket, ShapeId};
use crate::trace::scene::{Geometry, PreparedScene, ShapeKind, ShapeRef};
use crate::trace::shapes::{Refined, refine_box, refine_plane, refine_sphere};

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
    asked: u32,
    surfaces: &mut SurfacePacket,
) -> u32 {
    // Coincident hits and hits of equal shapes escalate to scalar code.
    let mut special = asked & hits.tied;
    if scene.equal_shapes.any() {
        let grouped =
            |lane: &usize| hits.ids.get(*lane).is_none_or(|id| scene.equal_shapes.group(id).is_some());
        special |= lanes(asked).filter(grouped).fold(0, |mask, lane| mask | 1 << lane);
    }
    let usual = asked & !special;
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
    asked & !found
}

/// Refines hits of one shape that has no equals. Returns the lanes that were not refined.
#[inline(always)]
pub(super) fn refine_one<S: Simd>(
    simd: S,
    input: RefineInput<'_>,
    id: ShapeId,
    asked: u32,
    surfaces: &mut SurfacePacket,
) -> u32 {
    let shape = OneShape::new(simd, ShapeParameters::of(input.geometry, id), asked);
    asked & !refine_lanes(simd, input, &shape, asked, surfaces)
}

/// Refines hits in some lanes. Returns the lanes that were refined.
#[inline(always)]
fn refine_lanes<S: Simd>(
    simd: S,
    input: RefineInput<'_>,
    shapes: &impl Shapes,
    asked: u32,
    surfaces: &mut SurfacePacket,
) -> u32 {
    let mut found = asked;
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
    asked: u32,
    surfaces: &mut SurfacePacket,
) -> u32 {
    let root = BoundedT::within(hits.ts.load(simd, half), hits.errors.load(simd, half));
    let (rays, t) = (rays.load(simd, half), root.t());
    let moderate = moderate(t) & moderate3(rays.direction);
    let mut refined: Option<Refined<F64s<S>>> = None;
    let these = shapes.lanes_of(ShapeKind::Sphere);
    if half_of(these & asked, half) != 0 {
        refined = Some(refine_sphere(shapes.places(simd, half), shapes.radii(simd, half), &rays, t));
    }
    let these = shapes.lanes_of(ShapeKind::Plane);
    if half_of(these & asked, half) != 0 {
        let (point, normal) = (shapes.places(simd, half), shapes.others(simd, half));
        let plane = refine_plane(point, normal, shapes.units(simd, half), &rays, t);
        refined = Some(select(mask(simd, these, half), plane, refined));
    }
    let these = shapes.lanes_of(ShapeKind::AlignedBox);
    if half_of(these & asked, half) != 0 {
        let aligned = refine_box(shapes.places(simd, half), shapes.others(simd, half), &rays, t);
        refined = Some(select(mask(simd, these, half), aligned, refined));
    }
    let moderate = moderate & shapes.moderate(simd, half);
    let mut unknown = 0;
    let mut images = shapes.images() & asked & half_lanes(half);
    while let Some(id) = hits.ids.get(images.trailing_zeros() as usize).filter(|_| images != 0) {
        let these = hits.ids.lanes_of(simd, id) & images;
        images &= !these;
        let far = mask(simd, hits.far, half);
        let Some(image) = simd.vectorize(
            #[inline(always)]
            || match geometry.shape(id) {
                ShapeRef::SphereImage(image) => Some(image.refined(&rays, t)),
                ShapeRef::BoxImage(image) => Some(image.refined(&rays, t, far)),
                ShapeRef::Sphere(_) | ShapeRef::Plane(_) | ShapeRef::AlignedBox(_) => None,
            },
        ) else {
            unknown |= these;
            continue;
        };
        refined = Some(select(mask(simd, these, half), image, refined));
    }
    let Some(refined) = refined else { return asked & half_lanes(half) };
    let escalated = root.is_rounded() | root.is_rough() | !(moderate & refined.found);
    let special = (bits(escalated, half) | unknown) & asked;
    let outside = dot(rays.direction, refined.normal).simd_le(splat(simd, 0.0));
    surfaces.from_outside |= bits(outside, half) & asked & !special & !hits.far;
    surfaces.points.store(half, refined.point);
    surfaces.normals.store(half, refined.normal);
    surfaces.ts.store(half, refined.t.high);
    surfaces.rests.store(half, refined.t.low);
    special
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
