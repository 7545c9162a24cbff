//! Input and result of refinement.

use fearless_simd::prelude::*;

use crate::trace::math::{F64s, F64s3, Mask, select3};

/// The refined hits of half a packet.
#[derive(Clone, Copy)]
pub(super) struct Points<S: Simd> {
    /// The rounded ray parameter. `rest` is the remainder.
    pub(super) t: F64s<S>,
    pub(super) rest: F64s<S>,
    pub(super) point: F64s3<S>,
    pub(super) normal: F64s3<S>,
    /// Lanes in which the refinement is valid.
    pub(super) found: Mask<S>,
}

/// The rays of half a packet, and the approximate `t` of their hits.
#[derive(Clone, Copy)]
pub(super) struct RefineInput<S: Simd> {
    pub(super) origin: F64s3<S>,
    pub(super) direction: F64s3<S>,
    pub(super) t: F64s<S>,
}

impl<S: Simd> Points<S> {
    /// Selects `these` in lanes in which the mask is true, and `others` elsewhere.
    #[inline(always)]
    pub(super) fn select(mask: Mask<S>, these: Self, others: Option<Self>) -> Self {
        let Some(others) = others else { return these };
        Self {
            t: mask.select(these.t, others.t),
            rest: mask.select(these.rest, others.rest),
            point: select3(mask, these.point, others.point),
            normal: select3(mask, these.normal, others.normal),
            found: (mask & these.found) | (!mask & others.found),
        }
    }
}
