//! Secondary rays spawned at sixteen surfaces.

use fearless_simd::{f32x16, prelude::*};

use super::dielectric::mirrored;
use super::medium_stack::{MediumStack, MediumStacks};
use super::path_packet::PathPacket;
use super::refraction_packet::RefractionPacket;
use super::secondary::TreeRay;
use super::terms_packet::add_tint;
use crate::trace::intersect::{HitPacket, SurfacePacket};
use crate::trace::math::{Colors, F64s3, LANES, Scaled, bits, bits16, finite3, half_of, lanes, scaled_lanes};
use crate::trace::rays::{RayPacket, ShapeIds};
use crate::trace::scene::PreparedScene;

/// Secondary rays, in the lanes of the rays that they continue.
#[derive(Clone, Debug)]
pub(crate) struct BranchPacket {
    pub(crate) rays: RayPacket,
    /// Path states of the rays.
    pub(crate) paths: PathPacket,
}

impl BranchPacket {
    /// A packet without rays.
    pub(crate) const EMPTY: Self = Self { rays: RayPacket::EMPTY, paths: PathPacket::AT_CAMERA };

    /// Puts a ray into an empty lane.
    pub(crate) fn set(&mut self, lane: usize, TreeRay { ray, state }: &TreeRay) {
        self.rays.set(lane, ray);
        self.paths.set(lane, state);
    }
}

/// Spawns the secondary rays at the surfaces in lanes `active`, of which `transparent` are transparent: [`secondary_rays`](super::secondary_rays),
/// with the same operations in the same order. `rays`, with path states `paths`, arrive at the surfaces. The transparent solids that
/// contain refracted rays are recorded in `media`. Returns the lanes left to the scalar function.
#[inline(always)]
pub(crate) fn branch_lanes<S: Simd>(
    simd: S,
    (scene, media): (&PreparedScene, &mut MediumStacks),
    (rays, paths): (&RayPacket, &PathPacket),
    (hits, surfaces): (&HitPacket, &SurfacePacket),
    (active, transparent): (u32, u32),
    (reflections, refracted): (&mut BranchPacket, Option<&mut BranchPacket>),
) -> u32 {
    let mut escalated = active & surfaces.tied;
    let (mut reflected, tints) = reflected_shares(simd, scene, &hits.ids, active);
    if let Some(branches) = refracted {
        let at = (hits, surfaces);
        let refraction = RefractionPacket::at(
            simd,
            (scene, media),
            (rays, paths),
            at,
            transparent & !escalated,
            &mut reflected,
        );
        escalated |= refraction.escalated;
        let RefractionPacket { transmitted, directions, beyond, lanes, .. } = refraction;
        let spawned = carry(simd, paths, (&transmitted, &beyond, 1), None, lanes & !escalated, branches);
        let mut in_range = 0;
        for half in (0..2).filter(|half| half_of(spawned, *half) != 0) {
            in_range |= start(simd, surfaces, (half, directions.load(simd, half)), &mut branches.rays);
        }
        escalated |= spawned & !in_range;
        depart(surfaces, (spawned & in_range, !surfaces.from_outside), &mut branches.rays);
    }
    let carried = (&reflected, &paths.media, 0);
    let spawned = carry(simd, paths, carried, tints.as_ref(), active & !escalated, reflections);
    let mut in_range = 0;
    for half in (0..2).filter(|half| half_of(spawned, *half) != 0) {
        let (direction, normal) = (rays.directions.load(simd, half), surfaces.normals.load(simd, half));
        in_range |= start(simd, surfaces, (half, mirrored(direction, normal)), &mut reflections.rays);
    }
    depart(surfaces, (spawned & in_range, surfaces.from_outside), &mut reflections.rays);
    escalated | spawned & !in_range
}

/// Returns the coefficients k_r of the shapes in some lanes, and the tints of their reflected light, if there are any.
#[inline(always)]
fn reflected_shares<S: Simd>(
    simd: S,
    scene: &PreparedScene,
    ids: &ShapeIds,
    active: u32,
) -> ([f32; LANES], Option<Colors>) {
    if let Some(id) = ids.common(simd, active) {
        let material = scene.material(id);
        return ([material.reflected; LANES], material.tint.map(Colors::splat));
    }
    let (mut shares, mut tints) = ([0.0; LANES], None);
    for lane in lanes(active) {
        let Some(id) = ids.get(lane) else { continue };
        let material = scene.material(id);
        shares[lane] = material.reflected;
        add_tint(&mut tints, lane, material);
    }
    (shares, tints)
}

/// Computes the path states of secondary rays in `media` that carry `shares` of the arriving light, in `tints`. They are child `place`, 0
/// or 1, of the rays that they continue. Returns the lanes, among `active`, of nonzero throughput, as
/// [`reaching`](super::secondary::reaching) does.
#[inline(always)]
fn carry<S: Simd>(
    simd: S,
    arrived: &PathPacket,
    (shares, media, place): (&[f32; LANES], &[MediumStack; LANES], u64),
    tints: Option<&Colors>,
    active: u32,
    branches: &mut BranchPacket,
) -> u32 {
    let (share, most) = (f32x16::load_array_ref(simd, shares), f32x16::splat(simd, f32::MAX));
    let mut throughputs = arrived.throughputs.load(simd);
    for channel in &mut throughputs {
        let product = *channel * share;
        *channel = product.simd_lt(most).select(product, most);
    }
    if let Some(tints) = tints {
        throughputs = tints.times(simd, throughputs);
    }
    let mut lit = 0;
    for channel in throughputs {
        lit |= bits16(channel.simd_gt(f32x16::splat(simd, 0.0)));
    }
    let paths = &mut branches.paths;
    paths.throughputs.store(throughputs);
    paths.media = *media;
    for (place_below, above) in paths.places.iter_mut().zip(&arrived.places) {
        *place_below = above.wrapping_mul(2).wrapping_add(place);
    }
    active & lit
}

/// Starts half of the rays at surfaces, in directions of any length. Returns the lanes of that half with valid rays; the others are left to
/// the scalar function.
#[inline(always)]
fn start<S: Simd>(
    simd: S,
    surfaces: &SurfacePacket,
    (half, direction): (usize, F64s3<S>),
    rays: &mut RayPacket,
) -> u32 {
    let Scaled { direction, in_range, .. } = scaled_lanes(simd, direction);
    let point = surfaces.points.load(simd, half);
    rays.origins.store(half, point);
    rays.directions.store(half, direction);
    bits(in_range & finite3(simd, point), half)
}

/// Makes the rays in lanes `spawned`, outward in lanes `outward`, leave surfaces without ties.
#[inline(always)]
fn depart(surfaces: &SurfacePacket, (spawned, outward): (u32, u32), rays: &mut RayPacket) {
    (rays.lanes, rays.departing, rays.outward) = (spawned, spawned, outward & spawned);
    rays.left = surfaces.first_equals;
}
