//! Where sixteen shadow rays cross the surfaces of clear shapes: what [`Crossed::cross`](crate::trace::query::Crossed::cross) says of
//! each.

use fearless_simd::prelude::*;

use super::leaves::Rays;
use super::refine::refine_one;
use super::verdicts::{Asked, exit};
use crate::trace::math::{Numbers, bits, dot_lanes as dot, half_lanes, splat};
use crate::trace::query::{Crossing, HitPacket, SurfacePacket};
use crate::trace::rays::{RayPacket, ShapeId, ShapeIds};
use crate::trace::scene::Geometry;

/// Where shadow rays cross the surface of a clear shape before the light.
#[derive(Clone, Debug)]
pub(crate) struct CrossedPacket {
    id: ShapeId,
    /// Lanes of rays that cross it.
    pub(crate) lanes: u32,
    ts: Numbers,
    /// Of these, lanes of rays that enter it there; the others leave it.
    entering: u32,
    /// Of these, lanes of rays that leave it again.
    leaving: u32,
    far_ts: Numbers,
}

impl CrossedPacket {
    /// Returns what the ray in a lane crosses first, and what then.
    #[inline]
    pub(crate) fn of(&self, lane: usize) -> [Option<Crossing>; 2] {
        let has = |lanes: u32| lanes & (1 << lane) != 0;
        let (id, entering) = (self.id, has(self.entering));
        let first = has(self.lanes).then(|| Crossing { t: self.ts.get(lane), id, entering });
        let then = has(self.leaving).then(|| Crossing { t: self.far_ts.get(lane), id, entering: false });
        [first, then]
    }
}

/// What rays have met, and where: memory for one shape after the other.
#[derive(Clone, Debug)]
pub(super) struct CrossingScratch {
    pub(super) hits: HitPacket,
    surfaces: SurfacePacket,
}

impl CrossingScratch {
    pub(super) const EMPTY: Self = Self { hits: HitPacket::EMPTY, surfaces: SurfacePacket::EMPTY };
}

/// Finds where rays in some lanes cross a shape that no other equals, which they are known to meet, as the scratch says where about.
/// Returns the lanes that have to be asked one by one.
#[inline(always)]
pub(super) fn cross<S: Simd>(
    simd: S,
    geometry: &Geometry,
    rays: (&RayPacket, &Numbers),
    shape: (Asked<'_>, u32),
    scratch: &mut CrossingScratch,
    crossed: &mut Vec<CrossedPacket>,
) -> u32 {
    simd.vectorize(
        #[inline(always)]
        || find(simd, geometry, rays, shape, scratch, crossed),
    )
}

#[inline(always)]
fn find<S: Simd>(
    simd: S,
    geometry: &Geometry,
    (rays, limits): (&RayPacket, &Numbers),
    (Asked { id, shape }, met): (Asked<'_>, u32),
    CrossingScratch { hits, surfaces }: &mut CrossingScratch,
    crossed: &mut Vec<CrossedPacket>,
) -> u32 {
    hits.ids = ShapeIds::splat(id);
    surfaces.clear();
    let mut open = refine_one(simd, geometry, (rays, hits), (id, met), surfaces);
    let (mut entering, mut leaving) = (0, 0);
    let mut far_ts = Numbers::splat(0.0);
    for half in 0..2 {
        let asked = met & !open & half_lanes(half);
        if asked == 0 {
            continue;
        }
        let direction = rays.directions.load(simd, half);
        let inwards = dot(direction, surfaces.normals.load(simd, half)).simd_lt(splat(simd, 0.0));
        let enters = asked & bits(inwards, half) & !hits.far;
        entering |= enters;
        if enters == 0 {
            continue;
        }
        let from_there = Rays { origin: surfaces.points.load(simd, half), direction };
        let Some(out) = exit(simd, &from_there, shape) else { continue };
        let t = surfaces.ts.load(simd, half) + out.t;
        let before = t.simd_lt(limits.load(simd, half)) & out.hit;
        far_ts.store(half, t);
        open |= enters & bits(!out.hit, half);
        leaving |= enters & bits(before, half);
    }
    let lanes = met & !open;
    if lanes != 0 {
        let (entering, leaving) = (entering & lanes, leaving & lanes);
        crossed.push(CrossedPacket { id, lanes, ts: surfaces.ts, entering, leaving, far_ts });
    }
    open
}
