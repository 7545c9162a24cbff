//! Closest hits of packets with a common origin, and the search of all packets of a tile that they share with those through a
//! [lens](super::lens).
//!
//! ```text
//! bound the rays by a shaft, divided into parts of half a packet
//! intersect all packets with the shapes outside the tree
//! for each shape of the tree that the frustum of all rays may hit, nearer nodes first:
//!     after too many tests: leave all rays undecided, and stop
//!     intersect it with the parts that may hit it before their limits
//!     limit each part to the depth of its farthest closest hit
//! ```

use std::sync::atomic::{AtomicBool, Ordering};

use fearless_simd::{dispatch, prelude::*};
use glam::DVec3;

use super::closest_hit::{ClosestHitSearch, latest};
use super::hit::HitPacket;
use super::intersector::{PacketIntersector, ShapeQuery};
use super::reciprocals::Reciprocals;
use super::scratch::{PacketScratch, Scratch};
use crate::trace::bvh::{Depth, FrustumVisitor, LeafBox, LeafId, Limits, PACKETS, Shaft, Slopes};
use crate::trace::math::{half_lanes, set_bits};
use crate::trace::rays::RayPacket;
use crate::trace::scene::PreparedScene;

/// Maximum average number of shape tests per packet; beyond it, all rays escalate to single-ray traversal. If shapes are much smaller than
/// pixels, a single ray hits few of the shapes that its packet hits.
const MOST_TESTS: usize = 1024;

/// The parts that are first halves of packets.
const EVERY_FIRST: u32 = 0x5555_5555;

/// Finds the closest hits of packets whose rays have a common origin and leave no shape. `hits.undecided` holds the undecided lanes. Returns
/// `false`, without hits, if the rays diverge too much.
pub(crate) fn bundle_hits(
    scene: &PreparedScene,
    origin: DVec3,
    rays: &[RayPacket],
    hits: &mut [HitPacket],
    scratch: (&mut Scratch<'_>, &mut PacketScratch),
) -> bool {
    dispatch!(scene.simd.level(), simd => find(simd, scene, origin, rays, hits, scratch))
}

#[inline(always)]
fn find<S: Simd>(
    simd: S,
    scene: &PreparedScene,
    origin: DVec3,
    rays: &[RayPacket],
    hits: &mut [HitPacket],
    (scratch, PacketScratch { reciprocals, .. }): (&mut Scratch<'_>, &mut PacketScratch),
) -> bool {
    let Some(first) = rays.iter().find(|packet| packet.lanes != 0) else { return false };
    let depth = Depth::along(first.directions.get(first.lanes.trailing_zeros() as usize));
    let directions = rays.iter().map(|packet| (&packet.directions, packet.lanes));
    let Some(slopes) = Slopes::of(simd, (depth, 1.0), directions) else { return false };
    let Some(shaft) = scene.tree.shaft(simd, origin, depth, &slopes) else { return false };
    hits.iter_mut().for_each(HitPacket::clear);
    let Scratch { stack, cancelled, .. } = scratch;
    reciprocals.iter_mut().for_each(Reciprocals::forget);
    let depth_limit = |farthest| shaft.frustum.depth_limit(farthest);
    let limits = Limits::NONE;
    let mut packets = TilePackets { scene, rays, hits, reciprocals, depth, depth_limit, limits };
    if !packets.test_unbounded(simd, cancelled) {
        return true;
    }
    let farthest = packets.limits.farthest(simd);
    let mut visitor = BundleVisitor { packets, shaft: &shaft, farthest, tests: 0 };
    scene.tree.visit_frustum(simd, &shaft.frustum, farthest, stack, cancelled, &mut visitor);
    true
}

/// A bundle during traversal.
struct BundleVisitor<'a, F> {
    packets: TilePackets<'a, F>,
    shaft: &'a Shaft,
    /// The depth up to which shapes are of interest to any part: the greatest of the limits.
    farthest: f32,
    tests: usize,
}

impl<S: Simd, F: Fn(f64) -> f32> FrustumVisitor<S> for BundleVisitor<'_, F> {
    #[inline(always)]
    fn visit(&mut self, simd: S, leaf: LeafId, bounds: &LeafBox) -> f32 {
        let parts = self.shaft.parts(simd, bounds, &self.packets.limits);
        self.tests += 1 + parts.count_ones() as usize;
        if self.tests > MOST_TESTS * PACKETS {
            let TilePackets { rays, hits, .. } = &mut self.packets;
            hits.iter_mut().zip(*rays).for_each(|(hits, rays)| hits.undecided = rays.lanes);
            return f32::NEG_INFINITY;
        }
        let shape = ShapeQuery::leaf(self.packets.scene, leaf);
        if self.packets.test_parts(simd, parts, shape) {
            self.farthest = self.packets.limits.farthest(simd);
        }
        self.farthest
    }
}

/// The packets of a tile, and their closest hits so far. `depth_limit` maps the greatest depth that rays reach to the depth, in the tree's
/// frame, up to which boxes are of interest to them.
pub(super) struct TilePackets<'a, F> {
    pub(super) scene: &'a PreparedScene,
    pub(super) rays: &'a [RayPacket],
    pub(super) hits: &'a mut [HitPacket],
    pub(super) reciprocals: &'a mut [Reciprocals; PACKETS],
    pub(super) depth: Depth,
    pub(super) depth_limit: F,
    /// The depths up to which shapes are of interest, by part.
    pub(super) limits: Limits,
}

impl<F: Fn(f64) -> f32> TilePackets<'_, F> {
    /// Intersects all rays with the shapes outside the tree. Returns `false` if cancelled.
    #[inline(always)]
    pub(super) fn test_unbounded<S: Simd>(&mut self, simd: S, cancelled: &AtomicBool) -> bool {
        for packet in 0..self.rays.len() {
            for id in &self.scene.unbounded {
                if cancelled.load(Ordering::Relaxed) {
                    return false;
                }
                self.test(simd, (packet, self.rays[packet].lanes), ShapeQuery::by_id(self.scene, *id));
            }
            self.update_limits(simd, packet);
        }
        true
    }

    /// Intersects the rays of some parts with a shape. Returns whether any ray hits it nearer than all shapes before.
    #[inline(always)]
    pub(super) fn test_parts<S: Simd>(&mut self, simd: S, parts: u32, shape: ShapeQuery<'_>) -> bool {
        let mut nearer = false;
        for first in set_bits((parts | parts >> 1) & EVERY_FIRST) {
            let (packet, halves) = (first / 2, parts >> first & 3);
            let lanes = ((halves & 1) * half_lanes(0)) | ((halves >> 1) * half_lanes(1));
            if self.test(simd, (packet, lanes), shape) {
                self.update_limits(simd, packet);
                nearer = true;
            }
        }
        nearer
    }

    /// Intersects a packet's rays in some lanes with a shape. Returns whether any ray hits it nearer than all shapes before.
    #[inline(always)]
    fn test<S: Simd>(&mut self, simd: S, (packet, lanes): (usize, u32), shape: ShapeQuery<'_>) -> bool {
        let rays = &self.rays[packet];
        let intersector = PacketIntersector { rays, reciprocals: &mut self.reciprocals[packet] };
        let mut search = ClosestHitSearch { scene: self.scene, intersector, hits: &mut self.hits[packet] };
        search.test(simd, shape, lanes & rays.lanes)
    }

    /// Limits each half of a packet to the greatest depth at which any of its rays may have its closest hit.
    #[inline(always)]
    fn update_limits<S: Simd>(&mut self, simd: S, packet: usize) {
        let (rays, hits) = (&self.rays[packet], &self.hits[packet]);
        for half in 0..2 {
            let along = (&rays.directions, rays.lanes, half);
            let farthest = self.depth.farthest(simd, along, (latest(simd, hits, half), 1.0));
            let limit = (self.depth_limit)(farthest * self.scene.tree.scale());
            self.limits.set(packet * 2 + half, limit);
        }
    }
}
