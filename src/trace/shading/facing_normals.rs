//! Normals on the side from which rays arrived.

use fearless_simd::prelude::*;
use glam::DVec3;

use crate::trace::intersect::SurfacePacket;
use crate::trace::math::{F64s3, mask, negative, pick3};

/// Returns the normal on the side from which the ray arrived.
pub(super) fn facing_normal(surfaces: &SurfacePacket, lane: usize) -> DVec3 {
    let normal = surfaces.normals.get(lane);
    if surfaces.from_outside & (1 << lane) != 0 { normal } else { -normal }
}

/// Computes [`facing_normal`] for half of the lanes.
#[inline(always)]
pub(super) fn facing_normals<S: Simd>(simd: S, surfaces: &SurfacePacket, half: usize) -> F64s3<S> {
    let normal = surfaces.normals.load(simd, half);
    let outside = mask(simd, surfaces.from_outside, half);
    pick3(outside, normal, negative(normal))
}
