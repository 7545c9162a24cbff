//! Depth: the distance along the dominant axis of rays.

use fearless_simd::prelude::*;
use glam::DVec3;

use crate::trace::math::{F64s, Vectors, mask, splat};

/// The axis along which depth is measured, and its sign.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) struct Depth {
    axis: usize,
    pub(super) upwards: bool,
}

impl Depth {
    /// Measures depth along the dominant axis of a direction.
    pub(crate) fn along(direction: DVec3) -> Self {
        let axis = direction.abs().max_position();
        Self { axis, upwards: direction[axis] > 0.0 }
    }

    /// Returns the greatest depth that half of a packet's rays in some lanes reach at their `t`, along their directions times `sense`, 1 or
    /// -1; minus infinity if there are no lanes.
    #[inline(always)]
    pub(crate) fn farthest<S: Simd>(
        self,
        simd: S,
        (directions, lanes, half): (&Vectors, u32, usize),
        (t, sense): (F64s<S>, f64),
    ) -> f64 {
        let speed = directions.axis(self.axis).load(simd, half) * (self.sign() * sense);
        mask(simd, lanes, half).select(t * speed, splat(simd, f64::NEG_INFINITY)).reduce_max()
    }

    pub(super) fn sign(self) -> f64 {
        if self.upwards { 1.0 } else { -1.0 }
    }

    /// Returns the depth axis, and the two axes across it.
    #[inline(always)]
    pub(super) fn axes(self) -> [usize; 3] {
        [self.axis, (self.axis + 1) % 3, (self.axis + 2) % 3]
    }

    /// Returns the indices of the near and the far plane of a box in a [`LeafBox`](super::frustum::LeafBox).
    #[inline(always)]
    pub(super) fn near_and_far(self) -> [usize; 2] {
        if self.upwards { [self.axis, self.axis + 3] } else { [self.axis + 3, self.axis] }
    }
}
