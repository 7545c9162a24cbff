//! The rays that sixteen surfaces send on.

use fearless_simd::prelude::*;
use glam::DVec3;

use super::medium_stack::{MediumStack, MediumStacks};
use super::path_packet::PathPacket;
use super::refraction_packet::Shares;
use super::secondary::{TreeRay, reaching};
use crate::trace::math::{
    LANES, Scaled, Vectors, bits, dot_lanes as dot, finite3, half_lanes, half_of, lanes, scaled_lanes,
    subtract, times,
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

/// Finds the rays that surfaces in some lanes send on, of which some are clear: what [`secondary_rays`](super::secondary_rays) finds
/// there, in its operations and their order. The rays that they continue arrive as `rays`, which carry `paths`. Returns the lanes
/// that have to be asked one by one. What refracted rays are inside of is noted in the lists of `media`.
#[inline(always)]
pub(crate) fn branch_lanes<S: Simd>(
    simd: S,
    (scene, media): (&PreparedScene, &mut MediumStacks),
    (rays, paths): (&RayPacket, &PathPacket),
    (hits, surfaces): (&HitPacket, &SurfacePacket),
    (asked, clear): (u32, u32),
    (mirrored, refracted): (&mut BranchPacket, Option<&mut BranchPacket>),
) -> u32 {
    let Shares { reflected, transmitted, directions, beyond, refracted: passing, mut unusual } =
        Shares::of(simd, (scene, media), (rays, paths), (hits, surfaces), (asked, clear));
    if let Some(branches) = refracted {
        let sent = carry(paths, (&transmitted, &beyond, 1), passing & !unusual, branches);
        unusual |= leave(simd, surfaces, &directions, (sent, !surfaces.from_outside), branches);
    }
    let sent = carry(paths, (&reflected, &paths.media, 0), asked & !unusual, mirrored);
    let mut directions = Vectors::splat(DVec3::ONE);
    for half in 0..2 {
        let (direction, normal) = (rays.directions.load(simd, half), surfaces.normals.load(simd, half));
        let twice = dot(direction, normal) * 2.0;
        directions.store(half, subtract(direction, times(normal, twice)));
    }
    unusual | leave(simd, surfaces, &directions, (sent, surfaces.from_outside), mirrored)
}

/// Lets rays carry shares of what those do that they continue, in media, in place 0 or 1 below them. Returns the lanes in which that is
/// anything.
#[inline(always)]
fn carry(
    arrived: &PathPacket,
    (shares, media, place): (&[f32; LANES], &[MediumStack; LANES], u64),
    asked: u32,
    branches: &mut BranchPacket,
) -> u32 {
    let mut sent = 0;
    for lane in lanes(asked) {
        if let Some(state) = reaching(&arrived.get(lane), shares[lane], media[lane], place) {
            branches.paths.set(lane, &state);
            sent |= 1 << lane;
        }
    }
    sent
}

/// Lets rays in some lanes leave surfaces that are tied with no others, in directions of any length. Returns the lanes that have to be
/// asked one by one.
#[inline(always)]
fn leave<S: Simd>(
    simd: S,
    surfaces: &SurfacePacket,
    directions: &Vectors,
    (sent, outward): (u32, u32),
    branches: &mut BranchPacket,
) -> u32 {
    let mut unusual = 0;
    for half in 0..2 {
        if half_of(sent, half) == 0 {
            continue;
        }
        let Scaled { direction, usual, .. } = scaled_lanes(simd, directions.load(simd, half));
        let point = surfaces.points.load(simd, half);
        unusual |= sent & half_lanes(half) & !bits(usual & finite3(simd, point), half);
        branches.rays.origins.store(half, point);
        branches.rays.directions.store(half, direction);
    }
    let sent = sent & !unusual;
    branches.rays.lanes = sent;
    branches.rays.departing = sent;
    branches.rays.outward = outward & sent;
    branches.rays.left = surfaces.first_equals;
    unusual
}
