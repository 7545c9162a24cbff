//! Packets of rays from one point, and what they meet.

use std::sync::atomic::Ordering;

use fearless_simd::{dispatch, prelude::*};
use glam::DVec3;

use super::closest_hit::{Search, latest};
use super::reciprocals::Reciprocals;
use super::scratch::PacketScratch;
use super::verdicts::{Asked, Asking};
use crate::trace::bvh::{Depth, FrustumVisitor, LeafBox, LeafId, Limits, PACKETS, Shaft, Slopes};
use crate::trace::math::{half_lanes, set_bits};
use crate::trace::query::{HitPacket, Scratch};
use crate::trace::rays::RayPacket;
use crate::trace::scene::PreparedScene;

/// The first halves of packets, as parts.
const EVERY_FIRST: u32 = 0x5555_5555;

/// Shapes that packets are tested against before single rays are thought to do better, for each packet: where shapes are much
/// smaller than pixels, a single ray meets few of those that its packet does.
const MOST_TESTS: usize = 1024;

/// Finds what the rays of packets meet first that all start at one point and leave no shape. Those that single rays have to decide
/// are left open in `hits`. `false`, and nothing found, where they go too far apart.
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
    let Some(shaft) = scene.tree.shaft(simd, origin, depth, slopes) else { return false };
    hits.iter_mut().for_each(HitPacket::clear);
    let Scratch { stack, cancelled, .. } = scratch;
    reciprocals.iter_mut().for_each(Reciprocals::forget);
    let mut visitor = Visitor {
        scene,
        shaft: &shaft,
        depth,
        rays,
        hits,
        reciprocals,
        limits: Limits::NONE,
        farthest: f32::NEG_INFINITY,
        tests: 0,
    };
    for (packet, rays) in rays.iter().enumerate() {
        for id in &scene.beside {
            if cancelled.load(Ordering::Relaxed) {
                return true;
            }
            visitor.meet(simd, (packet, rays.lanes), Asked::beside(scene, *id));
        }
        visitor.update_limits(simd, packet);
    }
    visitor.farthest = visitor.limits.farthest(simd);
    let farthest = visitor.farthest;
    scene.tree.visit_frustum(simd, &shaft.frustum, farthest, stack, cancelled, &mut visitor);
    true
}

/// A bundle on its way through the tree.
struct Visitor<'a> {
    scene: &'a PreparedScene,
    shaft: &'a Shaft,
    depth: Depth,
    rays: &'a [RayPacket],
    hits: &'a mut [HitPacket],
    reciprocals: &'a mut [Reciprocals; PACKETS],
    limits: Limits,
    /// The depth up to which shapes are of interest to any part.
    farthest: f32,
    tests: usize,
}

impl<S: Simd> FrustumVisitor<S> for Visitor<'_> {
    #[inline(always)]
    fn visit(&mut self, simd: S, leaf: LeafId, bounds: &LeafBox) -> f32 {
        let parts = self.shaft.parts(simd, bounds, &self.limits);
        self.tests += 1 + parts.count_ones() as usize;
        if self.tests > MOST_TESTS * PACKETS {
            self.hits.iter_mut().zip(self.rays).for_each(|(hits, rays)| hits.open = rays.lanes);
            return f32::NEG_INFINITY;
        }
        let shape = Asked::leaf(self.scene, leaf);
        let mut nearer = false;
        for first in set_bits((parts | parts >> 1) & EVERY_FIRST) {
            let (packet, halves) = (first / 2, parts >> first & 3);
            let asked = ((halves & 1) * half_lanes(0)) | ((halves >> 1) * half_lanes(1));
            if self.meet(simd, (packet, asked), shape) {
                self.update_limits(simd, packet);
                nearer = true;
            }
        }
        if nearer {
            self.farthest = self.limits.farthest(simd);
        }
        self.farthest
    }
}

impl Visitor<'_> {
    /// Intersects a packet's rays, in some lanes, with a shape. Says whether any of them meets that nearer than all before.
    #[inline(always)]
    fn meet<S: Simd>(&mut self, simd: S, (packet, lanes): (usize, u32), shape: Asked<'_>) -> bool {
        let rays = &self.rays[packet];
        let asking = Asking { rays, reciprocals: &mut self.reciprocals[packet] };
        let mut search = Search { scene: self.scene, asking, hits: &mut self.hits[packet] };
        search.meet(simd, shape, lanes & rays.lanes)
    }

    /// Limits both halves of a packet to the greatest depth at which any of its rays may have its nearest hit.
    #[inline(always)]
    fn update_limits<S: Simd>(&mut self, simd: S, packet: usize) {
        let (rays, hits) = (&self.rays[packet], &self.hits[packet]);
        for half in 0..2 {
            let along = (&rays.directions, rays.lanes, half);
            let farthest = self.depth.farthest(simd, along, (latest(simd, hits, half), 1.0));
            let limit = self.shaft.frustum.depth_limit(farthest * self.scene.tree.scale());
            self.limits.set(packet * 2 + half, limit);
        }
    }
}
