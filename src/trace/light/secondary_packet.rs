//! The rays that sixteen surfaces send on.

use fearless_simd::prelude::*;

use super::path_packet::PathPacket;
use super::secondary::{TreeRay, reaching};
use crate::trace::math::{
    Mask, Scaled, bits, dot_lanes as dot, finite3, half_of, lanes, scaled_lanes, subtract, times,
};
use crate::trace::query::{HitPacket, SurfacePacket};
use crate::trace::rays::RayPacket;
use crate::trace::scene::PreparedScene;

/// Rays that are sent on, in the lanes of those that they continue.
#[derive(Clone, Debug)]
pub(crate) struct BranchPacket {
    pub(crate) rays: RayPacket,
    /// What they carry.
    pub(crate) paths: PathPacket,
}

impl BranchPacket {
    /// Of no ray.
    pub(crate) const EMPTY: Self = Self { rays: RayPacket::EMPTY, paths: PathPacket::AT_CAMERA };

    /// Puts a ray into a lane that has none.
    pub(crate) fn set(&mut self, lane: usize, TreeRay { ray, state }: &TreeRay) {
        self.rays.set(lane, ray);
        self.paths.set(lane, state);
    }
}

/// Finds the mirrored rays of surfaces, in some lanes, that send on no others: what [`secondary_rays`](super::secondary_rays) finds
/// there, in its operations and their order. The rays that they continue arrive as `rays`, which carry `paths`. Returns the lanes
/// that have to be asked one by one.
#[inline(always)]
pub(crate) fn mirrored_lanes<S: Simd>(
    simd: S,
    scene: &PreparedScene,
    (rays, paths): (&RayPacket, &PathPacket),
    (hits, surfaces): (&HitPacket, &SurfacePacket),
    asked: u32,
    branches: &mut BranchPacket,
) -> u32 {
    let mut sent = 0;
    for lane in lanes(asked) {
        let Some(id) = hits.ids.get(lane) else { continue };
        let arrived = paths.get(lane);
        if let Some(state) = reaching(&arrived, scene.material(id).reflected, arrived.medium, 0) {
            branches.paths.set(lane, &state);
            sent |= 1 << lane;
        }
    }
    let mut unusual = sent & surfaces.tied;
    for half in 0..2 {
        if half_of(sent, half) == 0 {
            continue;
        }
        let (direction, normal) = (rays.directions.load(simd, half), surfaces.normals.load(simd, half));
        let twice = dot(direction, normal) * 2.0;
        let Scaled { direction, usual, .. } = scaled_lanes(simd, subtract(direction, times(normal, twice)));
        let point = surfaces.points.load(simd, half);
        unusual |= sent
            & bits(Mask::<S>::from_bitmask(simd, 0xff), half)
            & !bits(usual & finite3(simd, point), half);
        branches.rays.origins.store(half, point);
        branches.rays.directions.store(half, direction);
    }
    let sent = sent & !unusual;
    branches.rays.lanes = sent;
    branches.rays.departing = sent;
    branches.rays.outward = surfaces.from_outside & sent;
    branches.rays.left = surfaces.first_equals;
    unusual
}
