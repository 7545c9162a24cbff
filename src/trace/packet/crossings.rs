//! Crossings of sixteen shadow rays with the surfaces of transparent shapes, as computed by
//! [`Crossed::cross`](crate::trace::query::Crossed::cross) for single rays.

use fearless_simd::prelude::*;

use super::refine::{RefineInput, refine_one};
use super::shape_query::{ShapeQuery, exit};
use crate::trace::math::{F64s, Numbers, Vectors, bits, dot, half_lanes, half_of, mask, splat};
use crate::trace::query::{Crossing, HitPacket, SurfacePacket};
use crate::trace::rays::{RayPacket, Rays, ShapeId, ShapeIds};
use crate::trace::scene::Geometry;

/// The crossings of shadow rays with the surface of a transparent shape before the light.
#[derive(Clone, Debug)]
pub(crate) struct CrossedPacket {
    pub(crate) id: ShapeId,
    /// Lanes of rays that cross the shape. `ts` are the first crossings.
    pub(crate) lanes: u32,
    ts: Numbers,
    /// Lanes of rays that enter the shape at the first crossing. The other rays leave it there.
    entering: u32,
    /// Lanes of rays that enter the shape and leave it again before the light, at `far_ts`.
    pub(crate) leaving: u32,
    far_ts: Numbers,
    /// Lanes of rays that pass through another solid inside the shape, from `gap_ts` to `gap_far_ts`.
    gapped: u32,
    gap_ts: Numbers,
    gap_far_ts: Numbers,
}

impl CrossedPacket {
    /// Creates the crossings of rays in some lanes that cross a shape once, at their origins.
    pub(crate) fn once(id: ShapeId, lanes: u32) -> Self {
        let ts = Numbers::splat(0.0);
        Self { id, lanes, ts, entering: 0, leaving: 0, far_ts: ts, gapped: 0, gap_ts: ts, gap_far_ts: ts }
    }

    /// Returns the lengths of the paths through the shape, from entry to exit, minus the gaps.
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

    /// Returns the lanes whose rays leave one of the two shapes before they enter the other.
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

    /// Records the paths through another shape as gaps, for the rays in some lanes that enter it after this shape and leave it before. A lane
    /// holds one gap at most. Returns the lanes in which a gap was added.
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

    /// Returns the first and the second crossing of the ray in a lane.
    #[inline]
    pub(crate) fn of(&self, lane: usize) -> [Option<Crossing>; 2] {
        let has = |lanes: u32| lanes & (1 << lane) != 0;
        let (id, entering) = (self.id, has(self.entering));
        let first = has(self.lanes).then(|| Crossing { t: self.ts.get(lane), id, entering });
        let then = has(self.leaving).then(|| Crossing { t: self.far_ts.get(lane), id, entering: false });
        [first, then]
    }
}

/// Returns the maximum of each number and 0.
#[inline(always)]
fn positive<S: Simd>(simd: S, numbers: F64s<S>) -> F64s<S> {
    let zero = splat(simd, 0.0);
    numbers.simd_gt(zero).select(numbers, zero)
}

/// The hits of one transparent shape, and their surface points. Reused between shapes.
#[derive(Clone, Debug)]
pub(super) struct CrossingScratch {
    pub(super) hits: HitPacket,
    surfaces: SurfacePacket,
}

impl CrossingScratch {
    pub(super) const EMPTY: Self = Self { hits: HitPacket::EMPTY, surfaces: SurfacePacket::EMPTY };
}

/// Computes the crossings of rays in some lanes with a shape that has no equals. The rays are known to hit it, near the `t` in the scratch.
/// Adds the crossings to `crossed`, and returns the undecided lanes.
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
    let mut undecided = refine_one(simd, RefineInput { geometry, rays, hits }, id, met, surfaces);
    let (mut entering, mut leaving) = (0, 0);
    let mut far_ts = Numbers::splat(0.0);
    for half in 0..2 {
        let asked = met & !undecided & half_lanes(half);
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
        // The exit is measured from the refined entry point.
        let from_there = Rays { origin: surfaces.points.load(simd, half), direction };
        let Some(out) = exit(simd, &from_there, shape) else { continue };
        let t = surfaces.ts.load(simd, half) + out.root.t();
        let before = t.simd_lt(limits.load(simd, half)) & out.hit;
        far_ts.store(half, t);
        undecided |= enters & bits(!out.hit, half);
        leaving |= enters & bits(before, half);
    }
    let lanes = met & !undecided;
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
    undecided
}
