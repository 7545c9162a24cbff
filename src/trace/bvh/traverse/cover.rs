//! Search for the parts of a shaft whose rays all pass through one shape.
//!
//! A point sees a convex shape in a convex set of directions. If four rays pass through the shape, then so do all rays between them; the
//! four are the corners of a part's slope range. If the shape lies between the shaft's origin and the points at which a part's rays end,
//! all of them are blocked by it.
//!
//! As for a [frustum](super::frustum), rounding shifts points across the depth by less than the slack, and enlarges a sphere's radius or a
//! box's side by less than that. Shapes are therefore shrunk by three times the slack, and their far ends are moved farther away by the
//! same amount. The squared distance of a sphere's centre from a line is a sum of squares, one of which is the square of a difference: with
//! slopes up to S its error is less than 8 e S^2 plus a few e of the sum, which is 2^-12 for the steepest slopes.

use fearless_simd::{f32x16, mask32x16, prelude::*};

use super::beam::{Shaft, ball};
use super::frustum::LeafBox;
use super::slopes::{Ends, GROUPS};
use crate::trace::math::{LANES, bits16};

/// Factor larger than the relative error by which rounding reduces a squared distance.
const FARTHER: f32 = 1.0 + 1.0 / 1024.0;

/// A shape's box, shrunk, as seen from the shaft's origin in the tree's frame.
struct SeenBox {
    /// Depths at which the box begins and ends.
    near: f32,
    far: f32,
    /// Depth beyond which the shape certainly does not extend.
    end: f32,
    /// Range along each of the axes across.
    low: [f32; 2],
    high: [f32; 2],
}

impl Shaft {
    /// Returns a bit mask of the parts whose rays all pass through a shape before they end. The shape is a sphere if it touches all sides
    /// of its box, otherwise the box itself. Parts without rays may be included.
    #[inline(always)]
    pub(crate) fn covered<S: Simd>(&self, simd: S, bounds: &LeafBox, ends: &Ends) -> u32 {
        let Some(seen) = self.seen(bounds) else { return 0 };
        simd.vectorize(
            #[inline(always)]
            || self.covered_by(simd, bounds, &seen, ends),
        )
    }

    #[inline(always)]
    fn covered_by<S: Simd>(&self, simd: S, bounds: &LeafBox, seen: &SeenBox, ends: &Ends) -> u32 {
        let mut covered = 0;
        for group in 0..GROUPS {
            let nearest = f32x16::load_array_ref(simd, &ends.nearest[group]);
            let before = f32x16::splat(simd, seen.end).simd_lt(nearest);
            let within = if bounds.round {
                self.in_sphere(simd, &bounds.planes, group)
            } else {
                self.in_box(simd, seen, group)
            };
            covered |= bits16(before & within) << (group * LANES);
        }
        covered
    }

    /// Returns a shape's box as seen from the origin. `None` if it is not ahead, or too small to be worth testing: a part is about an
    /// eighth as wide as the frustum.
    #[inline(always)]
    fn seen(&self, bounds: &LeafBox) -> Option<SeenBox> {
        const NARROWEST: f32 = 1.0 / 8.0;
        let (frustum, planes) = (&self.frustum, &bounds.planes);
        let shrunk = 3.0 * frustum.slack;
        let [w, u, v] = frustum.depth.axes();
        let [near, far] = frustum.depth.near_and_far();
        let (near, far) = (planes[near] - frustum.origin[w], planes[far] - frustum.origin[w]);
        let (near, far) = if frustum.depth.upwards { (near, far) } else { (-near, -far) };
        let mut seen = SeenBox { near, far, end: far + shrunk, low: [0.0; 2], high: [0.0; 2] };
        let mut worth = near > shrunk;
        for (side, across) in [u, v].into_iter().enumerate() {
            seen.low[side] = planes[across] - frustum.origin[across] + shrunk;
            seen.high[side] = planes[across + 3] - frustum.origin[across] - shrunk;
            let width = (frustum.high[side] - frustum.low[side]) * near;
            worth &= seen.high[side] - seen.low[side] > width * NARROWEST;
        }
        worth.then_some(seen)
    }

    /// Returns the parts whose slope ranges all pass through the near side or the far side of a box.
    #[inline(always)]
    fn in_box<S: Simd>(&self, simd: S, seen: &SeenBox, group: usize) -> mask32x16<S> {
        let splat = |number: f32| f32x16::splat(simd, number);
        let (mut on_near, mut on_far) = (splat(0.0).simd_le(splat(0.0)), splat(0.0).simd_le(splat(0.0)));
        for side in 0..2 {
            let low = f32x16::load_array_ref(simd, &self.low[side].slopes[group]);
            let high = f32x16::load_array_ref(simd, &self.high[side].slopes[group]);
            let (lower, upper) = (splat(seen.low[side]), splat(seen.high[side]));
            on_near &= (low * seen.near).simd_ge(lower) & (high * seen.near).simd_le(upper);
            on_far &= (low * seen.far).simd_ge(lower) & (high * seen.far).simd_le(upper);
        }
        on_near | on_far
    }

    /// Returns the parts for which the lines of all corner slopes pass a sphere's centre at a distance of at most its radius.
    #[inline(always)]
    fn in_sphere<S: Simd>(&self, simd: S, planes: &[f32; 6], group: usize) -> mask32x16<S> {
        let frustum = &self.frustum;
        let [w, u, v] = frustum.depth.axes();
        let (center, radius) = ball(planes);
        let depth = center[w] - frustum.origin[w];
        let depth = if frustum.depth.upwards { depth } else { -depth };
        let (u, v) = (center[u] - frustum.origin[u], center[v] - frustum.origin[v]);
        let radius = radius - 3.0 * frustum.slack;
        let square = f32x16::splat(simd, radius * radius);
        let load = |numbers: &[[f32; LANES]; GROUPS]| f32x16::load_array_ref(simd, &numbers[group]);
        let mut within = square.simd_gt(f32x16::splat(simd, 0.0));
        for across in [load(&self.low[0].slopes), load(&self.high[0].slopes)] {
            let beside_u = u - across * depth;
            for along in [load(&self.low[1].slopes), load(&self.high[1].slopes)] {
                let beside_v = v - along * depth;
                let turned = along * beside_u - across * beside_v;
                let distance = beside_u * beside_u + beside_v * beside_v + turned * turned;
                let length = across * across + along * along + 1.0;
                within &= (distance * FARTHER).simd_le(square * length);
            }
        }
        within
    }
}
