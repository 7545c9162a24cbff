//! The rays that sixteen surfaces send on.

use fearless_simd::{f32x16, prelude::*};

use super::medium_stack::{MediumStack, MediumStacks};
use super::path_packet::PathPacket;
use super::refraction_packet::RefractionPacket;
use super::secondary::TreeRay;
use crate::trace::math::{
    F64s3, LANES, Scaled, bits, bits16, dot, finite3, half_of, lanes, scaled_lanes, subtract, times,
};
use crate::trace::query::{HitPacket, SurfacePacket};
use crate::trace::rays::{RayPacket, ShapeIds};
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
    let mut unusual = asked & surfaces.tied;
    let mut reflected = reflected_shares(simd, scene, &hits.ids, asked);
    if let Some(branches) = refracted {
        let at = (hits, surfaces);
        let refraction =
            RefractionPacket::at(simd, (scene, media), (rays, paths), at, clear & !unusual, &mut reflected);
        unusual |= refraction.unusual;
        let RefractionPacket { transmitted, directions, beyond, lanes, .. } = refraction;
        let sent = carry(simd, paths, (&transmitted, &beyond, 1), lanes & !unusual, branches);
        let mut usual = 0;
        for half in (0..2).filter(|half| half_of(sent, *half) != 0) {
            usual |= start(simd, surfaces, (half, directions.load(simd, half)), &mut branches.rays);
        }
        unusual |= sent & !usual;
        depart(surfaces, (sent & usual, !surfaces.from_outside), &mut branches.rays);
    }
    let sent = carry(simd, paths, (&reflected, &paths.media, 0), asked & !unusual, mirrored);
    let mut usual = 0;
    for half in (0..2).filter(|half| half_of(sent, *half) != 0) {
        let (direction, normal) = (rays.directions.load(simd, half), surfaces.normals.load(simd, half));
        let twice = dot(direction, normal) * 2.0;
        let direction = subtract(direction, times(normal, twice));
        usual |= start(simd, surfaces, (half, direction), &mut mirrored.rays);
    }
    depart(surfaces, (sent & usual, surfaces.from_outside), &mut mirrored.rays);
    unusual | sent & !usual
}

/// The shares k_r of light that shapes in some lanes mirror.
#[inline(always)]
fn reflected_shares<S: Simd>(simd: S, scene: &PreparedScene, ids: &ShapeIds, asked: u32) -> [f32; LANES] {
    if let Some(id) = ids.common(simd, asked) {
        return [scene.material(id).reflected; LANES];
    }
    let mut shares = [0.0; LANES];
    for lane in lanes(asked) {
        let Some(id) = ids.get(lane) else { continue };
        shares[lane] = scene.material(id).reflected;
    }
    shares
}

/// Lets rays carry shares of what those do that they continue, in media, in place 0 or 1 below them. Returns the lanes, of some, in which
/// that is anything: what [`reaching`](super::secondary::reaching) says.
#[inline(always)]
fn carry<S: Simd>(
    simd: S,
    arrived: &PathPacket,
    (shares, media, place): (&[f32; LANES], &[MediumStack; LANES], u64),
    asked: u32,
    branches: &mut BranchPacket,
) -> u32 {
    let (share, most) = (f32x16::load_array_ref(simd, shares), f32x16::splat(simd, f32::MAX));
    let mut throughputs = arrived.throughputs.load(simd);
    let mut lit = 0;
    for channel in &mut throughputs {
        let product = *channel * share;
        *channel = product.simd_lt(most).select(product, most);
        lit |= bits16(channel.simd_gt(f32x16::splat(simd, 0.0)));
    }
    let paths = &mut branches.paths;
    paths.throughputs.store(throughputs);
    paths.media = *media;
    for (place_below, above) in paths.places.iter_mut().zip(&arrived.places) {
        *place_below = above.wrapping_mul(2).wrapping_add(place);
    }
    asked & lit
}

/// Lets half of the rays start at surfaces, in directions of any length. Returns the lanes of that half in which that is right; the others
/// have to be asked one by one.
#[inline(always)]
fn start<S: Simd>(
    simd: S,
    surfaces: &SurfacePacket,
    (half, direction): (usize, F64s3<S>),
    rays: &mut RayPacket,
) -> u32 {
    let Scaled { direction, usual, .. } = scaled_lanes(simd, direction);
    let point = surfaces.points.load(simd, half);
    rays.origins.store(half, point);
    rays.directions.store(half, direction);
    bits(usual & finite3(simd, point), half)
}

/// Lets rays in some lanes, outward in some, leave surfaces that are tied with no others.
#[inline(always)]
fn depart(surfaces: &SurfacePacket, (sent, outward): (u32, u32), rays: &mut RayPacket) {
    (rays.lanes, rays.departing, rays.outward) = (sent, sent, outward & sent);
    rays.left = surfaces.first_equals;
}
