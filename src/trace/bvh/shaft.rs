//! Bundles of rays with a common origin, and their parts, tested against shapes.
//!
//! A part is half a packet. It is bounded like a [frustum](super::frustum), and as conservatively.
//!
//! A sphere of radius r is beyond the slope h if its centre satisfies u - h w > r sqrt(1 + h^2). The sphere touches the sides of its box,
//! which are rounded outwards by less than 3 e: their midpoint is off from its centre by less than 4 e, and half their distance is at most
//! e less than its radius. This contributes less than 5 e (1 + S). The product of radius and root is rounded by less than 3 e (1 + S), and
//! the other errors are the same as for boxes: less than 14 e (1 + E)(1 + S) in total. The rounding of a sphere's own test is negligible.

use fearless_simd::{f32x16, mask32x16, prelude::*};
use glam::DVec3;

use super::Tree;
use super::depth::Depth;
use super::frustum::{Frustum, LeafBox};
use super::slopes::{Ends, GROUPS, PartNumbers, Slopes};
use crate::trace::math::{LANES, bits16};

/// A bundle of rays with a common origin, divided into [`PARTS`](super::PARTS) parts.
#[derive(Clone, Debug)]
pub(crate) struct Shaft {
    pub(crate) frustum: Frustum,
    pub(super) slopes: Slopes,
    /// sqrt(1 + h^2) for each slope h in `slopes`.
    low_root: [PartNumbers; 2],
    high_root: [PartNumbers; 2],
}

/// The depth up to which shapes are of interest, by part, in the tree's frame.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Limits(PartNumbers);

impl Tree {
    /// Creates a shaft of the rays from a point with these slopes. `None` if there is no [frustum](Tree::frustum).
    #[inline(always)]
    pub(crate) fn shaft<S: Simd>(
        &self,
        simd: S,
        origin: DVec3,
        depth: Depth,
        slopes: Slopes,
    ) -> Option<Shaft> {
        let frustum = self.frustum(origin, depth, &slopes.range(simd))?;
        let none = [[[0.0; LANES]; GROUPS]; 2];
        let (mut low_root, mut high_root) = (none, none);
        for side in 0..2 {
            for group in 0..GROUPS {
                let low = f32x16::load_array_ref(simd, &slopes.low[side][group]);
                let high = f32x16::load_array_ref(simd, &slopes.high[side][group]);
                (low * low + 1.0).sqrt().store_array(&mut low_root[side][group]);
                (high * high + 1.0).sqrt().store_array(&mut high_root[side][group]);
            }
        }
        Some(Shaft { frustum, slopes, low_root, high_root })
    }
}

impl Shaft {
    /// Returns a bit mask of the parts whose rays may hit a shape before their limits.
    #[inline(always)]
    pub(crate) fn parts<S: Simd>(&self, simd: S, bounds: &LeafBox, limits: &Limits) -> u32 {
        let mut parts = 0;
        for group in 0..GROUPS {
            let met = if bounds.round {
                self.sphere_parts(simd, &bounds.planes, limits, group)
            } else {
                self.box_parts(simd, &bounds.planes, limits, group)
            };
            parts |= bits16(met) << (group * LANES);
        }
        parts
    }

    #[inline(always)]
    fn box_parts<S: Simd>(&self, simd: S, planes: &[f32; 6], limits: &Limits, group: usize) -> mask32x16<S> {
        let splat = f32x16::splat;
        let [w, u, v] = self.frustum.depth.axes();
        let [near, far] = self.frustum.depth.near_and_far();
        let (near, far) = (planes[near] - self.frustum.origin[w], planes[far] - self.frustum.origin[w]);
        let (near, far) = if self.frustum.depth.upwards { (near, far) } else { (-near, -far) };
        let near = near.max(0.0);
        let mut met = splat(simd, near).simd_le(f32x16::load_array_ref(simd, &limits.0[group]));
        for (side, across) in [u, v].into_iter().enumerate() {
            let (lower, upper) = (
                planes[across] - self.frustum.origin[across],
                planes[across + 3] - self.frustum.origin[across],
            );
            let low = f32x16::load_array_ref(simd, &self.slopes.low[side][group]);
            let high = f32x16::load_array_ref(simd, &self.slopes.high[side][group]);
            let (near, far) = (splat(simd, near), splat(simd, far));
            met &= splat(simd, lower - self.frustum.slack).simd_le((high * near).max(high * far))
                & splat(simd, upper + self.frustum.slack).simd_ge((low * near).min(low * far));
        }
        met
    }

    #[inline(always)]
    fn sphere_parts<S: Simd>(
        &self,
        simd: S,
        planes: &[f32; 6],
        limits: &Limits,
        group: usize,
    ) -> mask32x16<S> {
        let splat = f32x16::splat;
        let load = |numbers: &PartNumbers| f32x16::load_array_ref(simd, &numbers[group]);
        let [w, u, v] = self.frustum.depth.axes();
        let (center, radius) = ball(planes);
        let depth = center[w] - self.frustum.origin[w];
        let depth = if self.frustum.depth.upwards { depth } else { -depth };
        let mut met = splat(simd, depth - radius - self.frustum.slack).simd_le(load(&limits.0));
        let (depth, radius) = (splat(simd, depth), splat(simd, radius));
        for (side, across) in [u, v].into_iter().enumerate() {
            let beside = center[across] - self.frustum.origin[across];
            let (lower, upper) =
                (splat(simd, beside - self.frustum.slack), splat(simd, beside + self.frustum.slack));
            let high = load(&self.slopes.high[side]) * depth + load(&self.high_root[side]) * radius;
            let low = load(&self.slopes.low[side]) * depth - load(&self.low_root[side]) * radius;
            met &= lower.simd_le(high) & upper.simd_ge(low);
        }
        met
    }
}

impl Limits {
    /// The limits of parts for which nothing is of interest.
    pub(crate) const NONE: Self = Self([[f32::NEG_INFINITY; LANES]; GROUPS]);

    /// Limits each part to the depth at which the farthest of its rays ends.
    #[inline(always)]
    pub(crate) fn up_to<S: Simd>(simd: S, ends: &Ends, frustum: &Frustum) -> Self {
        Self::around(simd, &ends.farthest, frustum.slack)
    }

    /// Limits each part to its depth plus a slack.
    #[inline(always)]
    pub(super) fn around<S: Simd>(simd: S, depths: &PartNumbers, slack: f32) -> Self {
        let mut limits = Self::NONE;
        for (limit, depths) in limits.0.iter_mut().zip(depths) {
            let depth = f32x16::load_array_ref(simd, depths) + slack;
            // Covers the rounding of the sum.
            (depth + depth.abs() * f32::EPSILON).store_array(limit);
        }
        limits
    }

    /// Returns a bit mask of the parts whose limits are at this depth or beyond.
    #[inline(always)]
    pub(crate) fn reaching<S: Simd>(&self, simd: S, depth: f32) -> u32 {
        let mut parts = 0;
        for group in 0..GROUPS {
            let reached = self.load(simd, group).simd_ge(f32x16::splat(simd, depth));
            parts |= bits16(reached) << (group * LANES);
        }
        parts
    }

    /// Returns the limits of one group of parts.
    #[inline(always)]
    pub(super) fn load<S: Simd>(&self, simd: S, group: usize) -> f32x16<S> {
        f32x16::load_array_ref(simd, &self.0[group])
    }

    /// Sets the limit of a part.
    #[inline(always)]
    pub(crate) fn set(&mut self, part: usize, depth: f32) {
        self.0[part / LANES % (GROUPS)][part % LANES] = depth;
    }

    /// Returns the largest limit of any part.
    #[inline(always)]
    pub(crate) fn farthest<S: Simd>(&self, simd: S) -> f32 {
        let [first, second] = &self.0;
        f32x16::load_array_ref(simd, first).max(f32x16::load_array_ref(simd, second)).reduce_max()
    }
}

/// Returns the centre and the radius of the sphere that touches the sides of a box.
#[inline(always)]
pub(super) fn ball([x, y, z, upper_x, upper_y, upper_z]: &[f32; 6]) -> ([f32; 3], f32) {
    let middle = |lower: f32, upper: f32| (lower + upper) * 0.5;
    let center = [middle(*x, *upper_x), middle(*y, *upper_y), middle(*z, *upper_z)];
    (center, (upper_x - x).max(upper_y - y).max(upper_z - z) * 0.5)
}
