//! What refinement starts from, and where it leads.

use fearless_simd::prelude::*;

use crate::trace::math::{F64s, F64s3, Mask, select3};

/// Points of half of the lanes.
#[derive(Clone, Copy)]
pub(super) struct Points<S: Simd> {
    /// The parameter, rounded, and what that leaves over.
    pub(super) t: F64s<S>,
    pub(super) rest: F64s<S>,
    pub(super) point: F64s3<S>,
    pub(super) normal: F64s3<S>,
    /// Where that is right.
    pub(super) found: Mask<S>,
}

/// A ray each, and the inexact `t` of its hit.
#[derive(Clone, Copy)]
pub(super) struct RefineInput<S: Simd> {
    pub(super) origin: F64s3<S>,
    pub(super) direction: F64s3<S>,
    pub(super) t: F64s<S>,
}

impl<S: Simd> Points<S> {
    /// These where the mask is true, else others.
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
