//! Packets of rays from one point, and what they meet.

use std::sync::atomic::Ordering;

use fearless_simd::{dispatch, prelude::*};
use glam::DVec3;

use super::closest_hit::{Search, latest};
use super::verdicts::{Asking, Inverses};
use crate::trace::bvh::{Depth, Limits, PARTS, Planes, Shaft, ShaftVisitor, Slopes};
use crate::trace::math::lanes;
use crate::trace::query::{Escalations, HitPacket, Scratch};
use crate::trace::rays::{RayPacket, ShapeId};
use crate::trace::scene::PreparedScene;

/// Shapes that packets are tested against before single rays are thought to do better, for each packet: where shapes are much
/// smaller than pixels, a single ray meets few of those that its packet does.
const MOST_TESTS: usize = 64;

/// Finds what the rays of packets meet first that all start at one point and leave no shape. Those that single rays have to decide
/// are left open in `hits`. `false`, and nothing found, where they go too far apart.
pub(crate) fn bundle_hits(
    scene: &PreparedScene,
    origin: DVec3,
    rays: &[RayPacket],
    hits: &mut [HitPacket],
    scratch: &mut Scratch<'_>,
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
    scratch: &mut Scratch<'_>,
) -> bool {
    let Some(first) = rays.iter().find(|packet| packet.lanes != 0) else { return false };
    let depth = Depth::along(first.directions.get(first.lanes.trailing_zeros() as usize));
    let mut slopes = [Slopes::NONE; PARTS];
    for (slopes, packet) in slopes.iter_mut().zip(rays) {
        let Some(found) = depth.slopes_of(simd, &packet.directions, packet.lanes, 1.0) else { return false };
        *slopes = found;
    }
    let Some(shaft) = scene.tree.shaft(origin, depth, &slopes) else { return false };
    hits.iter_mut().for_each(HitPacket::clear);
    let Scratch { stack, cancelled, escalations, .. } = scratch;
    let mut inverses = [const { Inverses::UNKNOWN }; PARTS];
    let mut visitor = Visitor {
        scene,
        shaft: &shaft,
        depth,
        rays,
        hits,
        inverses: &mut inverses,
        limits: Limits::NONE,
        tests: 0,
        escalations,
    };
    for (part, packet) in rays.iter().enumerate() {
        if packet.lanes == 0 {
            continue;
        }
        for id in &scene.beside {
            if cancelled.load(Ordering::Relaxed) {
                return true;
            }
            visitor.meet(simd, part, *id);
        }
        visitor.update_limit(simd, part);
    }
    let limit = visitor.limits.farthest(simd);
    scene.tree.visit_shaft(simd, &shaft, limit, stack, cancelled, &mut visitor);
    true
}

/// A bundle on its way through the tree.
struct Visitor<'a> {
    scene: &'a PreparedScene,
    shaft: &'a Shaft,
    depth: Depth,
    rays: &'a [RayPacket],
    hits: &'a mut [HitPacket],
    inverses: &'a mut [Inverses; PARTS],
    limits: Limits,
    tests: usize,
    escalations: &'a mut Escalations,
}

impl<S: Simd> ShaftVisitor<S> for Visitor<'_> {
    #[inline(always)]
    fn visit(&mut self, simd: S, id: ShapeId, bounds: &Planes) -> f32 {
        let parts = self.shaft.parts(simd, bounds, &self.limits);
        self.tests += 1 + parts.count_ones() as usize;
        if self.tests > MOST_TESTS * PARTS {
            self.hits.iter_mut().zip(self.rays).for_each(|(hits, rays)| hits.open = rays.lanes);
            return f32::NEG_INFINITY;
        }
        for part in lanes(parts) {
            if self.meet(simd, part, id) {
                self.update_limit(simd, part);
            }
        }
        self.limits.farthest(simd)
    }
}

impl Visitor<'_> {
    /// Intersects a packet with a shape. Says whether any of its rays meets that nearer than all before.
    #[inline(always)]
    fn meet<S: Simd>(&mut self, simd: S, part: usize, id: ShapeId) -> bool {
        let rays = &self.rays[part];
        let asking = Asking {
            geometry: self.scene.geometry(),
            rays,
            inverses: &mut self.inverses[part],
            escalations: self.escalations,
        };
        Search { asking, hits: &mut self.hits[part] }.meet(simd, id, rays.lanes)
    }

    /// Limits a packet to the greatest depth at which any of its rays may have its nearest hit.
    #[inline(always)]
    fn update_limit<S: Simd>(&mut self, simd: S, part: usize) {
        let (rays, hits) = (&self.rays[part], &self.hits[part]);
        let along = (&rays.directions, rays.lanes, 1.0);
        let farthest = self.depth.farthest(simd, along, |half| latest(simd, hits, half));
        let farthest = farthest * self.scene.tree.scale();
        self.limits.0[part] = self.shaft.depth_limit(farthest);
    }
}
