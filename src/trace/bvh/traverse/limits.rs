//! Limits of the depth up to which the parts of a bundle of rays extend.

use fearless_simd::{f32x16, prelude::*};

use super::frustum::Frustum;
use super::slopes::{Ends, GROUPS, PartNumbers};
use crate::trace::math::{LANES, bits16};

/// The depth up to which shapes are of interest, by part, in the tree's frame.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Limits(PartNumbers);

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
