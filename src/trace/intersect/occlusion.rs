//! Occlusion of lights at surface points, for single rays and for packets. The query of a packet:
//!
//! ```text
//! undecided = rays that leave several coincident shapes
//! active lanes: neither occluded nor undecided
//! test the last occluder on the active lanes without a candidate list
//! test each shape outside the tree on the active lanes
//! for each half packet with a candidate list:
//!     test each candidate on its active lanes
//! rest = active lanes without a candidate list
//! if rest has fewer than FEWEST lanes: add it to undecided
//! else: traverse the tree with rest, and test each shape that the rays may hit
//!
//! test(shape, lanes):
//!     certainly beyond the light, or a miss: no effect
//!     ambiguous, at FAR or more, or too near to the light: undecided
//!     certainly before the light: occluded by an opaque shape, undecided for a coincident shape, crossed for a transparent shape
//! ```
//!
//! The lanes in `undecided` escalate to scalar code. For a point light, the rays in the tree traversal are also bounded by a frustum with its
//! apex at the light. The error analysis in [`candidates`](super::candidates) also holds for this frustum.

use std::sync::atomic::AtomicBool;
use std::sync::atomic::Ordering::Relaxed;

use fearless_simd::{dispatch, prelude::*};
use glam::DVec3;

use super::crossings::{Crossed, CrossedPacket, CrossingDetail, CrossingScratch, cross};
use super::intersector::{Intersector, PacketIntersector, ShapeQuery};
use super::robust::NEAR;
use super::scratch::{PacketScratch, Scratch};
use crate::trace::bvh::{
    Depth, FARTHEST, FramePacket, Frustum, LeafId, PacketStack, PacketVisitor, SlopeRange,
};
use crate::trace::math::{Numbers, bits, half_lanes, half_of, splat};
use crate::trace::rays::{FAR, PreparedRay, RayPacket, RayView, ShadowLimit, ShapeId};
use crate::trace::scene::{EqualGroup, PreparedScene};

/// Minimum number of active lanes for which a packet traverses the tree.
const FEWEST: u32 = 3;

impl PreparedScene {
    /// Returns any shape, except `except`, between the ray's origin and `limit`: the first one found. If `candidates` are given, only they are
    /// tested instead of the tree.
    #[must_use]
    pub(crate) fn occluder(
        &self,
        ray: &PreparedRay,
        limit: &ShadowLimit,
        (except, candidates): (Option<ShapeId>, Option<&[LeafId]>),
        scratch: &mut Scratch<'_>,
    ) -> Option<ShapeId> {
        let Scratch { stack, intersector, ties, cancelled, .. } = scratch;
        let ray = &RayView::new(ray, ties);
        // Of several equal shapes, at least one is not `except`.
        let counts = |id: ShapeId| Some(id) != except || self.equal_shapes.group(id).is_some();
        let mut occludes = |id: ShapeId| counts(id) && intersector.occludes(&self.geometry, id, ray, limit);
        let mut unbounded = self.unbounded.iter().copied();
        let unbounded = unbounded.find(|id| cancelled.load(Relaxed) || occludes(*id));
        unbounded.or_else(|| match candidates {
            Some(candidates) => candidates.iter().map(|leaf| self.leaves.id(*leaf)).find(|id| occludes(*id)),
            None => {
                let leaf = self
                    .tree
                    .find_any(ray, limit.t(), stack, cancelled, |leaf| occludes(self.leaves.id(leaf)));
                leaf.map(|leaf| self.leaves.id(leaf))
            }
        })
    }

    /// Returns any opaque shape, except `except`, between the ray's origin and `limit`. If there is none, `scratch.crossed` contains the
    /// transparent shapes there. `candidates` are as in [`Self::occluder`].
    #[must_use]
    pub(crate) fn occluder_or_crossed(
        &self,
        ray: &PreparedRay,
        limit: &ShadowLimit,
        (except, candidates): (Option<ShapeId>, Option<&[LeafId]>),
        scratch: &mut Scratch<'_>,
    ) -> Option<ShapeId> {
        let Scratch { stack, intersector, ties, crossed, cancelled, .. } = scratch;
        let ray = &RayView::new(ray, ties);
        crossed.clear();
        let mut occludes = |id: ShapeId| match self.equal_shapes.group(id) {
            Some(group) => {
                self.group_occludes_or_is_crossed(group, ray, (limit, except), crossed, intersector)
            }
            None if Some(id) == except => false,
            None => {
                self.occludes_or_is_crossed(id, (ray, limit), CrossingDetail::Count, crossed, intersector)
            }
        };
        let mut unbounded = self.unbounded.iter().copied();
        let unbounded = unbounded.find(|id| cancelled.load(Relaxed) || occludes(*id));
        unbounded.or_else(|| match candidates {
            Some(candidates) => candidates.iter().map(|leaf| self.leaves.id(*leaf)).find(|id| occludes(*id)),
            None => {
                let leaf = self
                    .tree
                    .find_any(ray, limit.t(), stack, cancelled, |leaf| occludes(self.leaves.id(leaf)));
                leaf.map(|leaf| self.leaves.id(leaf))
            }
        })
    }

    /// Returns whether the shape occludes the ray. A transparent shape never does; it is added to `crossed` if it is hit.
    #[inline]
    pub(crate) fn occludes_or_is_crossed(
        &self,
        id: ShapeId,
        (ray, limit): (&RayView<'_>, &ShadowLimit),
        detail: CrossingDetail,
        crossed: &mut Vec<Crossed>,
        intersector: &mut Intersector<'_>,
    ) -> bool {
        // A ray that leaves a shape also leaves all shapes equal to it.
        let first = self.first_equal(id);
        if self.material(id).refraction.is_none() {
            return intersector.occludes(&self.geometry, first, ray, limit);
        }
        crossed.extend(
            Crossed::new(&self.geometry, first, (ray, limit), detail, intersector)
                .map(|crossed| crossed.by(id)),
        );
        false
    }

    /// Tests a group of equal shapes at once, like [`Self::occludes_or_is_crossed`].
    #[cold]
    fn group_occludes_or_is_crossed(
        &self,
        group: &EqualGroup,
        ray: &RayView<'_>,
        (limit, except): (&ShadowLimit, Option<ShapeId>),
        crossed: &mut Vec<Crossed>,
        intersector: &mut Intersector<'_>,
    ) -> bool {
        if let Some(opaque) = group.opaque(except) {
            return self.occludes_or_is_crossed(
                opaque,
                (ray, limit),
                CrossingDetail::Count,
                crossed,
                intersector,
            );
        }
        let mut transparent = group.transparent().iter().copied().filter(|id| Some(*id) != except);
        if let Some(first) = transparent.next() {
            let from = crossed.len();
            self.occludes_or_is_crossed(first, (ray, limit), CrossingDetail::Count, crossed, intersector);
            if let Some(found) = crossed.get(from).copied() {
                crossed.extend(transparent.map(|id| found.by(id)));
            }
        }
        false
    }
}

/// The shapes that occlude a light.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) struct Occluders {
    /// The light's own shape, which does not occlude it.
    pub(crate) except: Option<ShapeId>,
    /// True if transparent shapes do not occlude the light, but are recorded as crossed.
    pub(crate) transparent: bool,
}

/// The effect of a shape on shadow rays.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) enum OccluderKind {
    Opaque,
    /// Attenuates the light.
    Transparent,
    /// Equal to other shapes, none of which is opaque, except possibly the light's own shape. Rays that hit it escalate to scalar code.
    Coincident,
    /// The light's own shape.
    Excluded,
}

impl Occluders {
    /// Classifies a shape, consistently with `PreparedScene::occluder` and `PreparedScene::occluder_or_crossed`.
    #[inline(always)]
    pub(super) fn kind_of(&self, scene: &PreparedScene, id: ShapeId) -> OccluderKind {
        let group = scene.equal_shapes.group(id);
        // At least one shape of a group of equal shapes is not the light's own.
        if self.except == Some(id) && group.is_none() {
            return OccluderKind::Excluded;
        }
        if !self.transparent {
            return OccluderKind::Opaque;
        }
        match group {
            Some(group) if group.opaque(self.except).is_none() => OccluderKind::Coincident,
            None if scene.material(id).refraction.is_some() => OccluderKind::Transparent,
            Some(_) | None => OccluderKind::Opaque,
        }
    }
}

/// A packet of shadow rays, and their possible occluders.
pub(crate) struct ShadowPacket<'a> {
    pub(crate) rays: &'a RayPacket,
    /// The `t` of each ray at the light.
    pub(crate) limits: &'a Numbers,
    /// The common end point of the rays, if there is one.
    pub(crate) light: Option<DVec3>,
    /// The shapes that count as occluders.
    pub(crate) occluders: Occluders,
    /// Possible occluders outside the tree.
    pub(crate) unbounded: &'a [ShapeId],
    /// By half packet: possible occluders in the tree; `None` if the tree has to be traversed.
    pub(crate) candidates: [Option<&'a [LeafId]>; 2],
}

/// The result of an occlusion query, as bit masks. The remaining rays reach the light, through the transparent shapes in
/// `PacketScratch::crossed`.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) struct Occlusion {
    /// Lanes of rays that are certainly occluded.
    pub(crate) occluded: u32,
    /// Undecided lanes, which escalate to scalar code.
    pub(crate) undecided: u32,
}

/// Determines which shadow rays are occluded. `last_occluder` is tested first, and updated with any occluder found. After cancellation the
/// result is incomplete.
pub(crate) fn occluded(
    scene: &PreparedScene,
    shadow: &ShadowPacket<'_>,
    last_occluder: &mut Option<ShapeId>,
    PacketScratch { stack, reciprocals, crossing, crossed }: &mut PacketScratch,
    cancelled: &AtomicBool,
) -> Occlusion {
    let (rays, reciprocals) = (shadow.rays, &mut reciprocals[0]);
    reciprocals.forget();
    let intersector = PacketIntersector { rays, reciprocals };
    // A ray that leaves several coincident shapes can leave each of them on a different side.
    let found = Occlusion { occluded: 0, undecided: rays.tied };
    crossed.clear();
    let mut search = OcclusionSearch { scene, shadow, intersector, found, last_occluder, crossing, crossed };
    dispatch!(scene.simd.level(), simd => search.run(simd, stack, cancelled));
    search.found
}

struct OcclusionSearch<'a> {
    scene: &'a PreparedScene,
    shadow: &'a ShadowPacket<'a>,
    intersector: PacketIntersector<'a>,
    found: Occlusion,
    last_occluder: &'a mut Option<ShapeId>,
    crossing: &'a mut CrossingScratch,
    crossed: &'a mut Vec<CrossedPacket>,
}

impl OcclusionSearch<'_> {
    #[inline(always)]
    fn run<S: Simd>(&mut self, simd: S, stack: &mut PacketStack, cancelled: &AtomicBool) {
        // The last occluder is tested first only without a candidate list: lists are short.
        let unlisted = self.unlisted();
        if let Some(id) = *self.last_occluder
            && self.active() & unlisted != 0
        {
            self.test(simd, ShapeQuery::by_id(self.scene, id), self.active() & unlisted);
        }
        for id in self.shadow.unbounded {
            if self.active() == 0 || cancelled.load(Relaxed) {
                return;
            }
            self.test(simd, ShapeQuery::by_id(self.scene, *id), self.active());
        }
        for (half, candidates) in self.shadow.candidates.iter().enumerate() {
            let Some(candidates) = candidates else { continue };
            let lanes = half_lanes(half);
            for leaf in *candidates {
                if self.active() & lanes == 0 {
                    break;
                }
                self.test(simd, ShapeQuery::leaf(self.scene, *leaf), self.active() & lanes);
            }
        }
        let unlisted = self.active() & unlisted;
        if unlisted.count_ones() < FEWEST {
            self.found.undecided |= unlisted;
        } else {
            let frustum = self.frustum(simd, unlisted);
            let mut packet = self.scene.tree.packet(simd, self.shadow.rays, unlisted, frustum);
            packet.limit(simd, self.shadow.limits, &Numbers::splat(0.0));
            self.scene.tree.visit_packet(simd, &mut packet, stack, cancelled, self);
        }
    }

    /// Returns a frustum around the rays in some lanes, with its apex at the light, and the depth up to which it extends. `None` if the rays
    /// have no common end point, are too long or run too far apart.
    #[inline(always)]
    fn frustum<S: Simd>(&self, simd: S, lanes: u32) -> Option<(Frustum, f32)> {
        let ShadowPacket { rays, limits, light, .. } = self.shadow;
        let light = (*light)?;
        let depth = Depth::along(-rays.directions.get(lanes.trailing_zeros() as usize));
        let slopes = SlopeRange::of(simd, (&rays.directions, lanes), (depth, -1.0))?;
        let mut farthest = f64::NEG_INFINITY;
        for half in 0..2 {
            let back = (&rays.directions, lanes, half);
            farthest = farthest.max(depth.farthest(simd, back, (limits.load(simd, half), -1.0)));
        }
        let tree = &self.scene.tree;
        let farthest = farthest * tree.scale();
        if farthest > FARTHEST {
            return None;
        }
        let frustum = tree.frustum(light, depth, &slopes)?;
        Some((frustum, frustum.depth_limit(farthest)))
    }

    /// Returns the lanes without lists of candidates.
    #[inline(always)]
    fn unlisted(&self) -> u32 {
        let [first, second] = self.shadow.candidates.map(|candidates| candidates.is_none());
        (u32::from(first) * half_lanes(0)) | (u32::from(second) * half_lanes(1))
    }

    /// Returns the active lanes.
    #[inline(always)]
    fn active(&self) -> u32 {
        self.shadow.rays.lanes & !self.found.occluded & !self.found.undecided
    }

    /// Tests a shape on the rays in some lanes.
    #[inline(always)]
    fn test<S: Simd>(&mut self, simd: S, shape: ShapeQuery<'_>, lanes: u32) {
        let kind = self.shadow.occluders.kind_of(self.scene, shape.id);
        if kind == OccluderKind::Excluded {
            return;
        }
        let mut crossed = 0;
        for half in 0..2 {
            if half_of(lanes, half) == 0 {
                continue;
            }
            let limit = self.shadow.limits.load(simd, half);
            // Closer to the light, hits are compared with its exact position, by scalar code.
            let (nearer, farther) = (limit * (1.0 - NEAR), limit * (1.0 + NEAR));
            let Some(answer) = self.intersector.intersect(simd, shape, half, lanes) else { continue };
            let intersection = answer.intersection;
            let root = intersection.root;
            let is_near = root.t().simd_lt(splat(simd, FAR));
            let beyond = intersection.hit & root.earliest().simd_gt(farther);
            let undecided = bits(intersection.undecided | intersection.hit & !is_near & !beyond, half);
            let hit = intersection.hit & is_near;
            let before = bits(hit & root.latest().simd_lt(nearer), half);
            let (hit, beyond) = (bits(hit, half), bits(beyond, half));
            if kind == OccluderKind::Coincident {
                self.found.undecided |= hit & !beyond | undecided;
                continue;
            }
            self.found.undecided |= hit & !before & !beyond | undecided;
            if kind == OccluderKind::Transparent {
                let CrossingScratch { hits, .. } = &mut *self.crossing;
                hits.ts.store(half, root.t());
                hits.errors.store(half, root.error());
                hits.far = hits.far & !half_lanes(half) | answer.far & half_lanes(half);
                crossed |= before;
                continue;
            }
            self.found.occluded |= before;
            if before != 0 {
                *self.last_occluder = Some(shape.id);
            }
        }
        if crossed != 0 {
            let Self { scene, shadow, crossing, .. } = self;
            let rays = (shadow.rays, shadow.limits);
            self.found.undecided |=
                cross(simd, &scene.geometry, rays, (shape, crossed), crossing, self.crossed);
        }
    }
}

impl<S: Simd> PacketVisitor<S> for OcclusionSearch<'_> {
    const NEAREST_FIRST: bool = false;

    #[inline(always)]
    fn visit(&mut self, simd: S, leaf: LeafId, lanes: u32, packet: &mut FramePacket) {
        self.test(simd, ShapeQuery::leaf(self.scene, leaf), lanes);
        packet.finish(self.found.occluded | self.found.undecided);
    }
}
