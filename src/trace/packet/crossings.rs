//! Where sixteen shadow rays cross the surfaces of clear shapes: what [`Crossed::cross`](crate::trace::query::Crossed::cross) says of
//! each.

use fearless_simd::prelude::*;

use super::leaves::HalfRays;
use super::refine::refine_one;
use super::shape_query::{ShapeQuery, exit};
use crate::trace::math::{F64s, Numbers, Vectors, bits, dot, half_lanes, half_of, mask, splat};
use crate::trace::query::{Crossing, HitPacket, SurfacePacket};
use crate::trace::rays::{RayPacket, ShapeId, ShapeIds};
use crate::trace::scene::Geometry;

/// Where shadow rays cross the surface of a clear shape before the light.
#[derive(Clone, Debug)]
pub(crate) struct CrossedPacket {
    pub(crate) id: ShapeId,
    /// Lanes of rays that cross it.
    pub(crate) lanes: u32,
    ts: Numbers,
    /// Of these, lanes of rays that enter it there; the others leave it.
    entering: u32,
    /// Of these, lanes of rays that leave it again.
    pub(crate) leaving: u32,
    far_ts: Numbers,
    /// Of these, lanes of rays that go through another solid inside of it, and from where to where.
    gapped: u32,
    gap_ts: Numbers,
    gap_far_ts: Numbers,
}

impl CrossedPacket {
    /// Of rays in some lanes that cross a shape once, where they start.
    pub(crate) fn once(id: ShapeId, lanes: u32) -> Self {
        let ts = Numbers::splat(0.0);
        Self { id, lanes, ts, entering: 0, leaving: 0, far_ts: ts, gapped: 0, gap_ts: ts, gap_far_ts: ts }
    }

    /// Returns how long the ways are from where rays enter the shape to where they leave it, without their gaps.
    #[inline(always)]
    pub(crate) fn lengths<S: Simd>(&self, simd: S, directions: &Vectors) -> Numbers {
        let mut lengths = Numbers::splat(0.0);
        for half in 0..2 {
            let direction = directions.load(simd, half);
            let per_t = dot(direction, direction).sqrt();
            let (near, far) = (self.ts.load(simd, half), self.far_ts.load(simd, half));
            let mut length = positive(simd, (far - near) * per_t);
            if half_of(self.gapped, half) != 0 {
                let before = (self.gap_ts.load(simd, half) - near) * per_t;
                let after = (far - self.gap_far_ts.load(simd, half)) * per_t;
                let both = positive(simd, before) + positive(simd, after);
                length = mask(simd, self.gapped, half).select(both, length);
            }
            lengths.store(half, length);
        }
        lengths
    }

    /// Returns the lanes of rays that leave one of two shapes before they enter the other.
    #[inline(always)]
    pub(crate) fn apart<S: Simd>(&self, simd: S, other: &Self) -> u32 {
        let mut apart = 0;
        for half in 0..2 {
            let before = self.far_ts.load(simd, half).simd_lt(other.ts.load(simd, half));
            let after = other.far_ts.load(simd, half).simd_lt(self.ts.load(simd, half));
            apart |= bits(before | after, half);
        }
        apart
    }

    /// Notes the ways through another shape as gaps, of rays in some lanes that go through it while they are in this one. Returns those
    /// of these lanes in which there is no gap yet.
    #[inline(always)]
    pub(crate) fn leave_gaps<S: Simd>(&mut self, simd: S, inner: &Self, asked: u32) -> u32 {
        let mut within = 0;
        for half in 0..2 {
            let enters = self.ts.load(simd, half).simd_lt(inner.ts.load(simd, half));
            let leaves = inner.far_ts.load(simd, half).simd_lt(self.far_ts.load(simd, half));
            within |= bits(enters & leaves, half);
        }
        let new = within & asked & !self.gapped;
        if new != 0 {
            for half in 0..2 {
                let gaps = mask(simd, new, half);
                let gap = gaps.select(inner.ts.load(simd, half), self.gap_ts.load(simd, half));
                let far_gap = gaps.select(inner.far_ts.load(simd, half), self.gap_far_ts.load(simd, half));
                self.gap_ts.store(half, gap);
                self.gap_far_ts.store(half, far_gap);
            }
            self.gapped |= new;
        }
        new
    }

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

/// Numbers, or 0 instead of less.
#[inline(always)]
fn positive<S: Simd>(simd: S, numbers: F64s<S>) -> F64s<S> {
    let zero = splat(simd, 0.0);
    numbers.simd_gt(zero).select(numbers, zero)
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
    shape: (ShapeQuery<'_>, u32),
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
    (ShapeQuery { id, shape }, met): (ShapeQuery<'_>, u32),
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
        let from_there = HalfRays { origin: surfaces.points.load(simd, half), direction };
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
        crossed.push(CrossedPacket {
            ts: surfaces.ts,
            entering,
            leaving,
            far_ts,
            ..CrossedPacket::once(id, lanes)
        });
    }
    open
}
