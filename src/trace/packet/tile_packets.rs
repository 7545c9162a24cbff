//! Closest-hit search of all packets of a tile, shape by shape.

use std::sync::atomic::{AtomicBool, Ordering};

use fearless_simd::prelude::*;

use super::closest_hit::{ClosestHitSearch, latest};
use super::reciprocals::Reciprocals;
use super::shape_query::{PacketIntersector, ShapeQuery};
use crate::trace::bvh::{Depth, Limits, PACKETS};
use crate::trace::math::{half_lanes, set_bits};
use crate::trace::query::HitPacket;
use crate::trace::rays::RayPacket;
use crate::trace::scene::PreparedScene;

/// The parts that are first halves of packets.
const EVERY_FIRST: u32 = 0x5555_5555;

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
    pub(super) fn meet_beside<S: Simd>(&mut self, simd: S, cancelled: &AtomicBool) -> bool {
        for packet in 0..self.rays.len() {
            for id in &self.scene.unbounded {
                if cancelled.load(Ordering::Relaxed) {
                    return false;
                }
                self.meet(simd, (packet, self.rays[packet].lanes), ShapeQuery::by_id(self.scene, *id));
            }
            self.update_limits(simd, packet);
        }
        true
    }

    /// Intersects the rays of some parts with a shape. Returns whether any ray hits it nearer than all shapes before.
    #[inline(always)]
    pub(super) fn meet_parts<S: Simd>(&mut self, simd: S, parts: u32, shape: ShapeQuery<'_>) -> bool {
        let mut nearer = false;
        for first in set_bits((parts | parts >> 1) & EVERY_FIRST) {
            let (packet, halves) = (first / 2, parts >> first & 3);
            let asked = ((halves & 1) * half_lanes(0)) | ((halves >> 1) * half_lanes(1));
            if self.meet(simd, (packet, asked), shape) {
                self.update_limits(simd, packet);
                nearer = true;
            }
        }
        nearer
    }

    /// Intersects a packet's rays in some lanes with a shape. Returns whether any ray hits it nearer than all shapes before.
    #[inline(always)]
    fn meet<S: Simd>(&mut self, simd: S, (packet, lanes): (usize, u32), shape: ShapeQuery<'_>) -> bool {
        let rays = &self.rays[packet];
        let intersector = PacketIntersector { rays, reciprocals: &mut self.reciprocals[packet] };
        let mut search = ClosestHitSearch { scene: self.scene, intersector, hits: &mut self.hits[packet] };
        search.meet(simd, shape, lanes & rays.lanes)
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
