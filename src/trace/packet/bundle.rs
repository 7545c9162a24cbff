//! Closest hits of packets with a common origin.
//!
//! ```text
//! bound the rays by a shaft, divided into parts of half a packet
//! intersect all packets with the shapes outside the tree
//! for each shape of the tree that the frustum of all rays may hit, nearer nodes first:
//!     after too many tests: leave all rays undecided, and stop
//!     intersect it with the parts that may hit it before their limits
//!     limit each part to the depth of its farthest closest hit
//! ```

use fearless_simd::{dispatch, prelude::*};
use glam::DVec3;

use super::reciprocals::Reciprocals;
use super::scratch::PacketScratch;
use super::shape_query::ShapeQuery;
use super::tile_packets::TilePackets;
use crate::trace::bvh::{Depth, FrustumVisitor, LeafBox, LeafId, Limits, PACKETS, Shaft, Slopes};
use crate::trace::query::{HitPacket, Scratch};
use crate::trace::rays::RayPacket;
use crate::trace::scene::PreparedScene;

/// Maximum average number of shape tests per packet; beyond it, all rays escalate to single-ray traversal. If shapes are much smaller than
/// pixels, a single ray hits few of the shapes that its packet hits.
const MOST_TESTS: usize = 1024;

/// Finds the closest hits of packets whose rays have a common origin and leave no shape. `hits.open` holds the undecided lanes. Returns
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
    if !packets.meet_beside(simd, cancelled) {
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
        if self.packets.meet_parts(simd, parts, shape) {
            self.farthest = self.packets.limits.farthest(simd);
        }
        self.farthest
    }
}
