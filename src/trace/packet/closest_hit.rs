//! Closest hits of sixteen rays.

use std::sync::atomic::{AtomicBool, Ordering};

use fearless_simd::{dispatch, prelude::*};

use super::scratch::PacketScratch;
use super::shape_query::{PacketHit, PacketIntersector, ShapeQuery};
use crate::trace::bvh::{FramePacket, LeafId, PacketStack, PacketVisitor};
use crate::trace::math::{BoundedT, F64s, bits, half_of, mask, splat};
use crate::trace::query::HitPacket;
use crate::trace::rays::{FAR, RayPacket, ShapeId};
use crate::trace::scene::PreparedScene;

/// Minimum number of active lanes; packets with fewer are left to the scalar code.
const FEWEST: u32 = 3;

/// Finds the closest hits of a packet. `hits.open` holds the undecided lanes, which escalate to scalar code.
pub(crate) fn closest_hits(
    scene: &PreparedScene,
    rays: &RayPacket,
    hits: &mut HitPacket,
    PacketScratch { stack, reciprocals, .. }: &mut PacketScratch,
    cancelled: &AtomicBool,
) {
    hits.clear();
    // A ray that leaves several coincident shapes can leave each of them on a different side.
    hits.undecided = rays.tied;
    let active = rays.lanes & !rays.tied;
    if active.count_ones() < FEWEST {
        hits.undecided = rays.lanes;
        return;
    }
    let reciprocals = &mut reciprocals[0];
    reciprocals.forget();
    let intersector = PacketIntersector { rays, reciprocals };
    let mut search = ClosestHitSearch { scene, intersector, hits };
    dispatch!(scene.simd.level(), simd => search.run(simd, active, stack, cancelled));
}

/// A closest-hit search of one packet.
pub(super) struct ClosestHitSearch<'a> {
    pub(super) scene: &'a PreparedScene,
    pub(super) intersector: PacketIntersector<'a>,
    pub(super) hits: &'a mut HitPacket,
}

impl ClosestHitSearch<'_> {
    #[inline(always)]
    fn run<S: Simd>(&mut self, simd: S, active: u32, stack: &mut PacketStack, cancelled: &AtomicBool) {
        let scene = self.scene;
        for id in &scene.unbounded {
            if cancelled.load(Ordering::Relaxed) {
                return;
            }
            self.meet(simd, ShapeQuery::by_id(scene, *id), active);
        }
        let mut packet = scene.tree.packet(simd, self.intersector.rays, active & !self.hits.undecided, None);
        packet.limit(simd, &self.hits.ts, &self.hits.errors);
        scene.tree.visit_packet(simd, &mut packet, stack, cancelled, self);
    }

    /// Intersects the rays in some lanes with a shape. Returns whether any ray hits it nearer than all shapes before.
    #[inline(always)]
    pub(super) fn meet<S: Simd>(&mut self, simd: S, shape: ShapeQuery<'_>, lanes: u32) -> bool {
        let mut nearer = false;
        for half in 0..2 {
            if half_of(lanes, half) == 0 {
                continue;
            }
            if let Some(answer) = self.intersector.intersect(simd, shape, half, lanes) {
                nearer |= consider(simd, self.hits, half, shape.id, &answer);
            }
        }
        nearer
    }
}

impl<S: Simd> PacketVisitor<S> for ClosestHitSearch<'_> {
    const NEAREST_FIRST: bool = true;

    #[inline(always)]
    fn visit(&mut self, simd: S, leaf: LeafId, lanes: u32, packet: &mut FramePacket) {
        let nearer = self.meet(simd, ShapeQuery::leaf(self.scene, leaf), lanes);
        packet.finish(self.hits.undecided);
        if nearer {
            packet.limit(simd, &self.hits.ts, &self.hits.errors);
        }
    }
}

/// Returns upper bounds of the `t` of the closest hits so far, for half of the rays.
#[inline(always)]
pub(super) fn latest<S: Simd>(simd: S, hits: &HitPacket, half: usize) -> F64s<S> {
    hits.ts.load(simd, half) + hits.errors.load(simd, half)
}

/// Updates the closest hits of half of the rays with their hits of a shape. If a hit may coincide with the closest hit so far, its lane is
/// marked as undecided. Returns whether any hit is nearer than the closest hit before.
#[inline(always)]
fn consider<S: Simd>(simd: S, hits: &mut HitPacket, half: usize, id: ShapeId, answer: &PacketHit<S>) -> bool {
    let PacketHit { intersection, far } = answer;
    let root = intersection.root;
    let best = BoundedT::within(hits.ts.load(simd, half), hits.errors.load(simd, half));
    let is_near = root.t().simd_lt(splat(simd, FAR));
    let (hit, undecided) = (intersection.hit & is_near, intersection.undecided | intersection.hit & !is_near);
    let not_farther = bits(hit & root.earliest().simd_le(best.latest()), half);
    let nearer = bits(hit & root.latest().simd_lt(best.earliest()), half);
    hits.undecided |= not_farther & !nearer | bits(undecided, half);
    if nearer == 0 {
        return false;
    }
    let chosen = mask(simd, nearer, half);
    let chosen = BoundedT::pick(chosen, root, best);
    hits.ts.store(half, chosen.t());
    hits.errors.store(half, chosen.error());
    hits.ids.replace(simd, nearer, id);
    hits.far = hits.far & !nearer | far & nearer;
    true
}
