//! Lists of possible occluders between a light and the surfaces of a tile, collected once for all packets of the tile, so that each shadow
//! ray is tested against few shapes.
//!
//! ```text
//! bound the shadow rays by a shaft (point light) or a beam (area light), divided into parts of half a packet
//! for each shape outside the tree:
//!     add it to the list for all parts, unless it is a plane that certainly does not separate any point from the light
//! for each shape of the tree that the frustum of all rays may hit:
//!     after MOST_VISITS shapes: mark all parts as overflowed, and stop
//!     parts = parts whose rays may hit the shape
//!     occluded = those parts whose rays all hit it, if it is opaque and fills its bounds
//!     for each part in occluded: replace its list by the shape, and close the part
//!     for each other part: add the shape to its list; if the list has MOST shapes already, mark the part as overflowed and close it
//! ```
//!
//! A closed part accepts no more shapes. The traversal limit is the greatest depth of the remaining parts.
//!
//! # Correctness
//!
//! Shadow rays to a point light have a common end, from which the [shaft](crate::trace::bvh::Shaft) starts. A shadow ray itself starts at a
//! surface point. Its direction is rounded, so that it misses the light by 2^-52 of the distance, and it extends at most 2^-36 of the distance
//! beyond the light. Up to a maximum distance, both are far less than the distance by which a shaft accepts missed shapes. The rays to all
//! points of an area light lie in a [beam](crate::trace::bvh::Beam), so that one list serves all samples of the light.

use std::sync::atomic::AtomicBool;

use fearless_simd::{dispatch, prelude::*};
use glam::DVec3;

use super::occlusion::{OccluderKind, Occluders};
use super::scratch::Scratch;
use crate::trace::bvh::{
    Beam, Depth, Ends, FARTHEST, Frustum, FrustumVisitor, LeafBox, LeafId, Limits, PARTS, Shaft, Slopes,
    Stack,
};
use crate::trace::math::{
    Numbers, Vectors, dot, half_lanes, half_of, mask, set_bits, splat, splat3, subtract,
};
use crate::trace::rays::{RayPacket, ShapeId, ShapeIds};
use crate::trace::scene::{PreparedScene, ShapeRef};
use crate::trace::shapes::Plane;

/// Maximum number of candidates per part; beyond it, traversing the tree is faster.
const MOST: usize = 12;

/// Maximum number of shapes visited: many shapes in a wide shaft are hit by none of its parts.
const MOST_VISITS: usize = 128;

/// Minimum number of rays for which candidates are collected.
const FEWEST: u32 = 32;

/// The possible occluders of a light; those in the tree by part, which is half a packet. Reused to avoid allocations.
#[derive(Clone, Debug, Default)]
pub(crate) struct Candidates {
    parts: [Vec<LeafId>; PARTS],
    /// Parts with too many candidates, as a bit mask. Their rays have to traverse the tree.
    overflowed: u32,
    /// Parts for which one shape occludes the light completely, as a bit mask.
    occluded: u32,
    /// Possible occluders outside the tree, for all parts.
    unbounded: Vec<ShapeId>,
}

/// The shadow rays from the points of a packet to a point light.
#[derive(Clone, Copy, Debug)]
pub(crate) struct ShadowRays<'a> {
    pub(crate) rays: &'a RayPacket,
    /// The `t` of each ray at the light.
    pub(crate) limits: &'a Numbers,
    /// Lanes with shadow rays.
    pub(crate) lanes: u32,
}

/// The points of a packet that an area light may illuminate.
#[derive(Clone, Copy, Debug)]
pub(crate) struct LitPoints<'a> {
    pub(crate) points: &'a Vectors,
    /// The shapes that shadow rays leave.
    pub(crate) left: &'a ShapeIds,
    /// Lanes that may have shadow rays.
    pub(crate) lanes: u32,
}

/// A bounding box of a light, given by its centre and half-extents.
#[derive(Clone, Copy, Debug)]
pub(crate) struct LightBox {
    pub(crate) middle: DVec3,
    pub(crate) reach: DVec3,
}

impl Candidates {
    /// Collects all shapes that may lie between a point light and the points of packets. Returns `false`, without a valid list, if the points
    /// lie too far apart or are too few.
    pub(crate) fn find<'a>(
        &mut self,
        scene: &PreparedScene,
        (light, occluders): (DVec3, Occluders),
        packets: &(impl Iterator<Item = ShadowRays<'a>> + Clone),
        scratch: &mut Scratch<'_>,
    ) -> bool {
        if packets.clone().map(|shadow_rays| shadow_rays.lanes.count_ones()).sum::<u32>() < FEWEST {
            return false;
        }
        self.clear();
        let Scratch { stack, cancelled, .. } = scratch;
        let search = (stack, *cancelled);
        dispatch!(scene.simd.level(), simd => gather(simd, scene, (light, occluders), packets, self, search))
    }

    /// Collects candidates like [`Self::find`] for an area light; they are valid for rays to any point of it.
    pub(crate) fn find_all<'a>(
        &mut self,
        scene: &PreparedScene,
        (light, occluders): (LightBox, Occluders),
        packets: &(impl Iterator<Item = LitPoints<'a>> + Clone),
        scratch: &mut Scratch<'_>,
    ) -> bool {
        if packets.clone().map(|lit| lit.lanes.count_ones()).sum::<u32>() < FEWEST {
            return false;
        }
        self.clear();
        let Scratch { stack, cancelled, .. } = scratch;
        let search = (stack, *cancelled);
        dispatch!(scene.simd.level(), simd => gather_all(simd, scene, (light, occluders), packets, self, search))
    }

    fn clear(&mut self) {
        self.parts.iter_mut().for_each(Vec::clear);
        (self.overflowed, self.occluded) = (0, 0);
        self.unbounded.clear();
    }

    /// Returns whether all parts had too many candidates.
    pub(crate) fn all_overflowed(&self) -> bool {
        self.overflowed == u32::MAX
    }

    /// Returns the lanes of a packet whose shadow rays are certainly occluded. Valid only in lanes for which candidates were collected.
    #[inline]
    pub(crate) fn occluded(&self, packet: usize) -> u32 {
        let halves = self.occluded >> (packet * 2);
        ((halves & 1) * half_lanes(0)) | ((halves >> 1 & 1) * half_lanes(1))
    }

    /// Returns whether the rays of a packet that are not [occluded](Self::occluded) have no possible occluders.
    #[inline]
    pub(crate) fn is_unoccluded(&self, packet: usize) -> bool {
        let remains = |part: usize| self.occluded & (1 << part) == 0;
        let empty = |part: usize| self.overflowed & (1 << part) == 0 && self.parts[part].is_empty();
        self.unbounded.is_empty()
            && [packet * 2, packet * 2 + 1].into_iter().all(|part| !remains(part) || empty(part))
    }

    /// Returns the possible occluders outside the tree, in document order.
    #[inline]
    pub(crate) fn unbounded(&self) -> &[ShapeId] {
        &self.unbounded
    }

    /// Returns the possible occluders in the tree for the rays of half a packet; `None` if the tree has to be traversed.
    #[inline]
    pub(crate) fn of(&self, packet: usize, half: usize) -> Option<&[LeafId]> {
        let part = packet * 2 + half;
        (self.overflowed & (1 << part) == 0).then_some(self.parts[part].as_slice())
    }
}

/// Collects candidates for a point light.
#[inline(always)]
fn gather<'a, S: Simd>(
    simd: S,
    scene: &PreparedScene,
    (light, occluders): (DVec3, Occluders),
    packets: &(impl Iterator<Item = ShadowRays<'a>> + Clone),
    candidates: &mut Candidates,
    (stack, cancelled): (&mut Stack, &AtomicBool),
) -> bool {
    let Some(first) = packets.clone().find(|shadow_rays| shadow_rays.lanes != 0) else { return false };
    // Depth is measured from the light to the points.
    let depth = Depth::along(-first.rays.directions.get(first.lanes.trailing_zeros() as usize));
    let directions = packets.clone().map(|shadow_rays| (&shadow_rays.rays.directions, shadow_rays.lanes));
    let Some(slopes) = Slopes::of(simd, (depth, -1.0), directions) else { return false };
    let Some(shaft) = scene.tree.shaft(simd, light, depth, &slopes) else { return false };
    let shadow_rays = packets
        .clone()
        .map(|shadow_rays| (&shadow_rays.rays.directions, shadow_rays.limits, shadow_rays.lanes));
    let ends = Ends::of(simd, (depth, -1.0), scene.tree.scale(), shadow_rays);
    if f64::from(ends.deepest()) > FARTHEST {
        return false;
    }
    let points = packets.clone().map(|ShadowRays { rays, lanes, .. }| LitPoints {
        points: &rays.origins,
        left: &rays.left,
        lanes,
    });
    find_beside(simd, scene, LightBox { middle: light, reach: DVec3::ZERO }, &points, candidates);
    let limits = Limits::up_to(simd, &ends, &shaft.frustum);
    search(simd, scene, occluders, (Bundles::ToPlace(&shaft, &ends), limits), candidates, (stack, cancelled));
    true
}

/// Collects candidates for an area light.
#[inline(always)]
fn gather_all<'a, S: Simd>(
    simd: S,
    scene: &PreparedScene,
    (light, occluders): (LightBox, Occluders),
    packets: &(impl Iterator<Item = LitPoints<'a>> + Clone),
    candidates: &mut Candidates,
    scratch: (&mut Stack, &AtomicBool),
) -> bool {
    let points = packets.clone().map(|lit| (lit.points, lit.lanes));
    let Some((beam, limits)) = scene.tree.beam(simd, light.middle, light.reach, points) else {
        return false;
    };
    find_beside(simd, scene, light, packets, candidates);
    search(simd, scene, occluders, (Bundles::ToBox(&beam), limits), candidates, scratch);
    true
}

/// Collects possible occluders outside the tree.
#[inline(always)]
fn find_beside<'a, S: Simd>(
    simd: S,
    scene: &PreparedScene,
    light: LightBox,
    packets: &(impl Iterator<Item = LitPoints<'a>> + Clone),
    candidates: &mut Candidates,
) {
    for id in &scene.unbounded {
        if !matches!(scene.geometry.shape(*id), ShapeRef::Plane(plane) if !may_part(simd, (*id, plane), light, packets))
        {
            candidates.unbounded.push(*id);
        }
    }
}

/// Collects possible occluders in the tree.
#[inline(always)]
fn search<S: Simd>(
    simd: S,
    scene: &PreparedScene,
    occluders: Occluders,
    (bundles, limits): (Bundles<'_>, Limits),
    candidates: &mut Candidates,
    (stack, cancelled): (&mut Stack, &AtomicBool),
) {
    let (farthest, frustum) = (limits.farthest(simd), *bundles.frustum());
    let mut visitor = CandidateVisitor { scene, occluders, bundles, candidates, limits, farthest, visits: 0 };
    scene.tree.visit_frustum(simd, &frustum, farthest, stack, cancelled, &mut visitor);
}

/// A bundle of rays that end at one point or in the box of an area light.
#[derive(Clone, Copy)]
enum Bundles<'a> {
    ToPlace(&'a Shaft, &'a Ends),
    ToBox(&'a Beam),
}

impl Bundles<'_> {
    #[inline(always)]
    fn frustum(&self) -> &Frustum {
        match self {
            Self::ToPlace(shaft, _) => &shaft.frustum,
            Self::ToBox(beam) => &beam.frustum,
        }
    }

    /// Returns a bit mask of the parts whose rays may hit a shape.
    #[inline(always)]
    fn parts<S: Simd>(&self, simd: S, bounds: &LeafBox, limits: &Limits) -> u32 {
        match self {
            Self::ToPlace(shaft, _) => shaft.parts(simd, bounds, limits),
            Self::ToBox(beam) => beam.parts(simd, bounds, limits),
        }
    }

    /// Returns a bit mask of the parts whose rays certainly all pass through a shape. It is incomplete: beams report none.
    #[inline(always)]
    fn covered<S: Simd>(&self, simd: S, bounds: &LeafBox) -> u32 {
        match self {
            Self::ToPlace(shaft, ends) => shaft.covered(simd, bounds, ends),
            Self::ToBox(_) => 0,
        }
    }
}

/// Returns whether a plane may lie between a light and any of the points. `false` if the light and every point certainly lie on one side of
/// it, except points whose rays leave the plane.
#[inline(always)]
fn may_part<'a, S: Simd>(
    simd: S,
    (id, plane): (ShapeId, &Plane),
    light: LightBox,
    packets: &(impl Iterator<Item = LitPoints<'a>> + Clone),
) -> bool {
    /// 2^-40, relative to the magnitude of a height's terms: more than the rounding error of a height, and than the error by which rays miss
    /// their light.
    const ROUNDING: f64 = f64::from_bits((1023 - 40) << 52);
    /// More than the error of products that underflow.
    const LEAST: f64 = 1e-290;
    let (from_point, normal, size) = (light.middle - plane.point(), plane.normal(), plane.normal().abs());
    let (height, reach) = (from_point.dot(normal), (from_point.abs() + light.reach).dot(size));
    // Oriented towards the light.
    let up = splat3(simd, normal * height.signum());
    // The height of the lowest corner of the light's box.
    let height = splat(simd, height.abs() - light.reach.dot(size));
    for LitPoints { points, left, lanes } in packets.clone() {
        let active = lanes & !left.lanes_of(simd, id);
        for half in (0..2).filter(|half| half_of(active, *half) != 0) {
            let [x, y, z] = subtract(points.load(simd, half), splat3(simd, plane.point()));
            let sizes = dot([x.abs(), y.abs(), z.abs()], splat3(simd, size));
            let above = dot([x, y, z], up).simd_gt(sizes * ROUNDING + LEAST);
            let lit_from_above = height.simd_gt((sizes + reach) * ROUNDING + LEAST);
            if (mask(simd, active, half) & !(above & lit_from_above)).any_true() {
                return true;
            }
        }
    }
    false
}

/// Collects shapes during traversal.
struct CandidateVisitor<'a> {
    scene: &'a PreparedScene,
    occluders: Occluders,
    bundles: Bundles<'a>,
    candidates: &'a mut Candidates,
    limits: Limits,
    /// The greatest of the limits.
    farthest: f32,
    visits: usize,
}

impl<S: Simd> FrustumVisitor<S> for CandidateVisitor<'_> {
    #[inline(always)]
    fn visit(&mut self, simd: S, leaf: LeafId, bounds: &LeafBox) -> f32 {
        self.visits += 1;
        if self.visits > MOST_VISITS {
            self.candidates.overflowed = u32::MAX;
            return f32::NEG_INFINITY;
        }
        let parts = self.bundles.parts(simd, bounds, &self.limits);
        if parts == 0 {
            return self.farthest;
        }
        let occluded = self.occluded(simd, leaf, bounds) & parts;
        for part in set_bits(occluded) {
            self.candidates.parts[part].clear();
            self.candidates.parts[part].push(leaf);
        }
        self.candidates.occluded |= occluded;
        let mut overflowed = 0;
        for part in set_bits(parts & !occluded) {
            if self.candidates.parts[part].len() < MOST {
                self.candidates.parts[part].push(leaf);
            } else {
                overflowed |= 1 << part;
            }
        }
        self.candidates.overflowed |= overflowed;
        if occluded | overflowed != 0 {
            // Closes the parts.
            set_bits(occluded | overflowed).for_each(|part| self.limits.set(part, f32::NEG_INFINITY));
            self.farthest = self.limits.farthest(simd);
        }
        self.farthest
    }
}

impl CandidateVisitor<'_> {
    /// Returns a bit mask of the parts for which a shape occludes the light completely.
    #[inline(always)]
    fn occluded<S: Simd>(&self, simd: S, leaf: LeafId, bounds: &LeafBox) -> u32 {
        let covered = self.bundles.covered(simd, bounds);
        if covered == 0 {
            return 0;
        }
        let (id, shape) = self.scene.leaves.get(leaf, &self.scene.geometry);
        // Images of shapes under affine maps do not fill their boxes.
        let fills = matches!(shape, ShapeRef::Sphere(_) | ShapeRef::AlignedBox(_));
        if fills && self.occluders.kind_of(self.scene, id) == OccluderKind::Opaque { covered } else { 0 }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::trace::intersect::tests::{OPAQUE, scene, scene_of};
    use crate::trace::math::scaled;
    use crate::trace::rays::PreparedRay;
    use crate::trace::scene::PreparedShape;
    use crate::trace::shapes::{AlignedBox, Sphere};

    /// Creates the rays from a square of 1.5 by 1.5 in the plane y = 0 to a light, with their `t` at the light.
    fn rays_from_floor(light: DVec3) -> Vec<(RayPacket, Numbers)> {
        let mut shadow_rays = vec![(RayPacket::EMPTY, Numbers::splat(0.0)); 16];
        for index in 0..256_u32 {
            let (packet, lane) = (index / 64 * 4 + index % 16 / 4, index / 16 % 4 * 4 + index % 4);
            let point = DVec3::new(f64::from(index % 16) * 0.1, 0.0, f64::from(index / 16) * 0.1);
            let (direction, scale) = scaled(light - point).unwrap();
            shadow_rays[packet as usize].0.set(lane as usize, &PreparedRay::new(point, direction).unwrap());
            shadow_rays[packet as usize].1.set(lane as usize, scale.recip());
        }
        shadow_rays
    }

    /// A shape that covers all points occludes the light for all of them, unless it is transparent, the light's own shape, behind the light or
    /// the points, or leaves a gap.
    #[test]
    fn wide_shadows_are_found_at_once() {
        let light = DVec3::new(0.0, 20.0, 0.0);
        let sphere = |y, radius| PreparedShape::Sphere(Sphere { center: DVec3::new(0.7, y, 0.7), radius });
        let slab = |y: f64, half: f64| {
            let (middle, reach) = (DVec3::new(0.75, y, 0.75), DVec3::new(half, 0.1, half));
            PreparedShape::AlignedBox(AlignedBox { min: middle - reach, max: middle + reach })
        };
        let occluded = |shape: PreparedShape, transparent: bool, except: Option<ShapeId>| {
            let scene = scene_of(&[shape, sphere(-40.0, 1.0)], |_| transparent);
            let shadow_rays = rays_from_floor(light);
            let shadow_rays =
                shadow_rays.iter().map(|(rays, limits)| ShadowRays { rays, limits, lanes: 0xffff });
            let mut candidates = Candidates::default();
            assert!(candidates.find(
                &scene,
                (light, Occluders { except, transparent }),
                &shadow_rays,
                &mut Scratch::default()
            ));
            (0..16).map(|packet| candidates.occluded(packet).count_ones()).sum::<u32>()
        };
        for wide in [sphere(4.0, 3.0), slab(4.0, 2.0)] {
            assert_eq!(occluded(wide, false, None), 256, "{wide:?}");
            assert_eq!(occluded(wide, true, None), 0, "transparent: {wide:?}");
            assert_eq!(occluded(wide, false, Some(ShapeId(0))), 0, "its own: {wide:?}");
        }
        for unbounded in [
            sphere(24.0, 3.0),
            slab(24.0, 2.0),
            sphere(-4.0, 3.0),
            slab(-4.0, 2.0),
            sphere(1.0, 3.0),
            slab(0.0, 2.0),
        ] {
            assert_eq!(occluded(unbounded, false, None), 0, "{unbounded:?}");
        }
        for narrow in [sphere(4.0, 0.5), slab(4.0, 0.5)] {
            assert!((8..200).contains(&occluded(narrow, false, None)), "{narrow:?}");
        }
    }

    /// Lists are short, but not all empty. Otherwise the comparisons of candidates with single rays could not fail.
    #[test]
    fn candidates_are_few() {
        let mut shapes: Vec<PreparedShape> = (0..400)
            .map(|index| DVec3::new(f64::from(index % 20) - 9.7, 5.0, f64::from(index / 20) - 9.6))
            .map(|center| PreparedShape::Sphere(Sphere { center, radius: 0.4 }))
            .collect();
        shapes.push(PreparedShape::Plane(Plane::new(DVec3::ZERO, DVec3::Y).unwrap()));
        let (scene, light) = (scene(&shapes), DVec3::new(0.0, 20.0, 0.0));
        let shadow_rays = rays_from_floor(light);
        let shadow_rays = shadow_rays.iter().map(|(rays, limits)| ShadowRays { rays, limits, lanes: 0xffff });
        let mut candidates = Candidates::default();
        assert!(candidates.find(&scene, (light, OPAQUE), &shadow_rays, &mut Scratch::default()));
        let counts: Vec<usize> =
            (0..32).map(|part| candidates.of(part / 2, part % 2).unwrap().len()).collect();
        assert!(
            counts.iter().any(|count| *count > 0) && counts.iter().all(|count| *count <= 4),
            "{counts:?}"
        );
    }
}
