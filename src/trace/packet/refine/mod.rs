//! Refinement of sixteen hits at once: the operations of the shapes' `refine` in the same order.

mod images;
mod points;
mod shapes;
mod world;

use fearless_simd::prelude::*;

use self::points::{Points, RefineInput};
use self::shapes::{ManyShapes, OneShape, ShapeParameters, Shapes};
use self::world::{boxes, planes, spheres};
use crate::trace::math::{bits, dot, half_lanes, half_of, lanes, mask, moderate, moderate3, splat};
use crate::trace::query::{HitPacket, SurfacePacket};
use crate::trace::rays::{RayPacket, ShapeId};
use crate::trace::scene::{Geometry, PreparedScene, ShapeKind};

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
    let geometry = scene.geometry();
    let found = match hits.ids.common(simd, usual) {
        _ if usual == 0 => 0,
        Some(id) => usual & !refine_one(simd, geometry, (rays, hits), (id, usual), surfaces),
        None => {
            let shapes = ManyShapes::gather(geometry, &hits.ids, usual);
            refine_lanes(simd, geometry, (rays, hits), &shapes, usual, surfaces)
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
    geometry: &Geometry,
    (rays, hits): (&RayPacket, &HitPacket),
    (id, asked): (ShapeId, u32),
    surfaces: &mut SurfacePacket,
) -> u32 {
    let shape = OneShape::new(simd, ShapeParameters::of(geometry, id), asked);
    asked & !refine_lanes(simd, geometry, (rays, hits), &shape, asked, surfaces)
}

/// Refines hits in some lanes. Returns the lanes that were refined.
#[inline(always)]
fn refine_lanes<S: Simd>(
    simd: S,
    geometry: &Geometry,
    packet: (&RayPacket, &HitPacket),
    shapes: &impl Shapes,
    asked: u32,
    surfaces: &mut SurfacePacket,
) -> u32 {
    let mut found = asked;
    for half in 0..2 {
        if half_of(found, half) != 0 {
            found &= !refine_half(simd, geometry, packet, shapes, (half, found), surfaces);
        }
    }
    found
}

/// Refines hits of half a packet. Returns its lanes that have to be refined one by one.
#[inline(always)]
fn refine_half<S: Simd>(
    simd: S,
    geometry: &Geometry,
    (rays, hits): (&RayPacket, &HitPacket),
    shapes: &impl Shapes,
    (half, asked): (usize, u32),
    surfaces: &mut SurfacePacket,
) -> u32 {
    let (t, error) = (hits.ts.load(simd, half), hits.errors.load(simd, half));
    let rounded = error.simd_le(t * f64::EPSILON);
    let rough = error.simd_gt(t * (1.0 / 268_435_456.0));
    let direction = rays.directions.load(simd, half);
    let inexact = RefineInput { origin: rays.origins.load(simd, half), direction, t };
    let moderate = moderate(simd, t) & moderate3(simd, direction);
    let mut points: Option<Points<S>> = None;
    if half_of(shapes.lanes_of(ShapeKind::Sphere) & asked, half) != 0 {
        points = Some(spheres(simd, &inexact, shapes, half));
    }
    if half_of(shapes.lanes_of(ShapeKind::Plane) & asked, half) != 0 {
        let these = mask(simd, shapes.lanes_of(ShapeKind::Plane), half);
        points = Some(Points::select(these, planes(simd, &inexact, shapes, half), points));
    }
    if half_of(shapes.lanes_of(ShapeKind::AlignedBox) & asked, half) != 0 {
        let these = mask(simd, shapes.lanes_of(ShapeKind::AlignedBox), half);
        points = Some(Points::select(these, boxes(simd, &inexact, shapes, half), points));
    }
    let mut unknown = 0;
    let mut images = shapes.images() & asked & half_lanes(half);
    while let Some(id) = hits.ids.get(images.trailing_zeros() as usize).filter(|_| images != 0) {
        let these = hits.ids.lanes_of(simd, id) & images;
        images &= !these;
        let Some(image) = simd.vectorize(
            #[inline(always)]
            || images::refine(simd, &inexact, geometry.shape(id), mask(simd, hits.far, half)),
        ) else {
            unknown |= these;
            continue;
        };
        points = Some(Points::select(mask(simd, these, half), image, points));
    }
    let Some(points) = points else { return asked & half_lanes(half) };
    let special = (bits(rounded | rough | !(moderate & points.found), half) | unknown) & asked;
    let outside = dot(direction, points.normal).simd_le(splat(simd, 0.0));
    surfaces.from_outside |= bits(outside, half) & asked & !special & !hits.far;
    surfaces.points.store(half, points.point);
    surfaces.normals.store(half, points.normal);
    surfaces.ts.store(half, points.t);
    surfaces.rests.store(half, points.rest);
    special
}
