//! A tile's rays with a common origin, and what they meet.

use std::sync::atomic::Ordering;

use fearless_simd::{dispatch, prelude::*};

use super::leaves;
use super::rays::{HALF, LANES, Packet, bits};
use crate::trace::bvh::{Depth, Limits, PARTS, Planes, Shaft, ShaftVisitor, Slopes};
use crate::trace::query::{ClosestHit, Escalations, Intersector, Scratch};
use crate::trace::rays::{Ray, RayView, ShapeId};
use crate::trace::scene::{Kind, Location, PreparedScene};

/// Shapes that packets are tested against before single rays are thought to do better, for each packet: where shapes are much
/// smaller than pixels, a single ray meets few of those that its packet does.
const MOST_TESTS: usize = 64;

/// Rays with a common origin, packet by packet; kept for its memory.
#[derive(Clone, Debug)]
pub(crate) struct Bundle {
    packets: Box<[Packet; PARTS]>,
    rays: Vec<Ray>,
    /// Index of the ray in each lane.
    indices: [[u32; LANES]; PARTS],
    /// Indices of rays that the scalar code has to decide, ascending.
    open: Vec<u32>,
}

impl Default for Bundle {
    fn default() -> Self {
        Self {
            packets: Box::new([const { Packet::EMPTY }; PARTS]),
            rays: Vec::new(),
            indices: [[0; LANES]; PARTS],
            open: Vec::new(),
        }
    }
}

impl Bundle {
    /// Finds what rays from a camera meet first, each given with the number of the packet that it belongs to: rays near each
    /// other belong in one, which has at most 16. Returns the indices of those that single rays have to decide; `None` where
    /// that is all of them, as they do not start at one point, or go too far apart.
    pub(crate) fn closest_hits(
        &mut self,
        scene: &PreparedScene,
        rays: impl Iterator<Item = (usize, Ray)>,
        scratch: &mut Scratch<'_>,
        hits: &mut Vec<Option<ClosestHit>>,
    ) -> Option<&[u32]> {
        let shaft = self.gather(scene, rays)?;
        dispatch!(scene.simd.level(), simd => intersect(simd, scene, &shaft, self, scratch));
        hits.clear();
        hits.resize(self.rays.len(), None);
        self.open.clear();
        for (packet, indices) in self.packets.iter().zip(&self.indices) {
            for (lane, index) in indices.iter().enumerate().take(packet.count()) {
                if packet.is_open(lane) {
                    self.open.push(*index);
                } else {
                    hits[*index as usize] = packet.nearest(lane).map(ClosestHit::alone);
                }
            }
        }
        self.open.sort_unstable();
        Some(&self.open)
    }

    /// Sorts rays into packets.
    fn gather(&mut self, scene: &PreparedScene, rays: impl Iterator<Item = (usize, Ray)>) -> Option<Shaft> {
        self.rays.clear();
        self.packets.iter_mut().for_each(Packet::clear);
        let mut rays = rays.peekable();
        let (_, first) = *rays.peek()?;
        let (origin, depth, scale) = (first.origin(), Depth::along(first.direction()), scene.tree.scale());
        let mut slopes = [Slopes::NONE; PARTS];
        for (index, (part, ray)) in (0..).zip(rays) {
            if ray.origin() != origin || ray.departure().is_some() {
                return None;
            }
            let (speed, across) = depth.slopes(ray.direction())?;
            slopes[part].add(across);
            let packet = &mut self.packets[part];
            self.indices[part][packet.count()] = index;
            packet.push(&ray, speed * scale);
            self.rays.push(ray);
        }
        scene.tree.shaft(origin, depth, &slopes)
    }
}

/// Intersects the packets of a bundle with a scene.
#[inline(always)]
fn intersect<S: Simd>(
    simd: S,
    scene: &PreparedScene,
    shaft: &Shaft,
    bundle: &mut Bundle,
    scratch: &mut Scratch<'_>,
) {
    let Scratch { stack, cancelled, escalations, .. } = scratch;
    let mut visitor = Visitor { scene, shaft, bundle, limits: Limits::NONE, tests: 0, escalations };
    for part in 0..PARTS {
        if visitor.bundle.packets[part].count() == 0 {
            continue;
        }
        for id in &scene.beside {
            if cancelled.load(Ordering::Relaxed) {
                return;
            }
            visitor.meet(simd, part, *id);
        }
        visitor.update_limit(simd, part);
    }
    let limit = visitor.limits.farthest(simd);
    scene.tree.visit_shaft(simd, shaft, limit, stack, cancelled, &mut visitor);
}

/// A bundle on its way through the tree.
struct Visitor<'a> {
    scene: &'a PreparedScene,
    shaft: &'a Shaft,
    bundle: &'a mut Bundle,
    limits: Limits,
    tests: usize,
    escalations: &'a mut Escalations,
}

impl<S: Simd> ShaftVisitor<S> for Visitor<'_> {
    #[inline(always)]
    fn visit(&mut self, simd: S, id: ShapeId, bounds: &Planes) -> f32 {
        let mut parts = self.shaft.parts(simd, bounds, &self.limits);
        self.tests += 1 + parts.count_ones() as usize;
        if self.tests > MOST_TESTS * PARTS {
            self.bundle.packets.iter_mut().for_each(Packet::leave_open);
            return f32::NEG_INFINITY;
        }
        while parts != 0 {
            let part = parts.trailing_zeros() as usize % PARTS;
            parts &= parts - 1;
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
        let geometry = self.scene.geometry();
        let origin = self.bundle.rays[0].origin();
        let Location { kind, index } = geometry.locations[id.index()];
        let index = index as usize;
        let packet = &mut self.bundle.packets[part];
        let mut nearer = false;
        for half in 0..packet.halves() {
            let verdicts = match kind {
                Kind::Sphere => {
                    let sphere = &geometry.spheres[index];
                    let Some(verdicts) = leaves::sphere(simd, origin, sphere, packet, half) else { continue };
                    verdicts
                }
                Kind::Plane => leaves::plane(simd, origin, &geometry.planes[index], packet, half),
                Kind::AlignedBox => {
                    packet.leave_slow_open();
                    leaves::aligned_box(simd, origin, &geometry.boxes[index], packet, half)
                }
                Kind::SphereImage | Kind::BoxImage => return self.meet_one_by_one(simd, part, id),
            };
            nearer |= packet.consider(simd, half, &verdicts, id);
        }
        nearer
    }

    /// The same ray by ray, for those that meet the shape's bounds.
    #[inline(always)]
    fn meet_one_by_one<S: Simd>(&mut self, simd: S, part: usize, id: ShapeId) -> bool {
        let geometry = self.scene.geometry();
        let Bundle { packets, rays, indices, .. } = &mut *self.bundle;
        let packet = &mut packets[part];
        let mut lanes = packet.all();
        if let Some(bounds) = geometry.bounds(id) {
            lanes = packet.slow();
            for half in 0..packet.halves() {
                let met = leaves::may_meet(simd, rays[0].origin(), &bounds, packet, half);
                lanes |= bits(met) << (half * HALF) & packet.all();
            }
        }
        let mut nearer = false;
        while lanes != 0 {
            let lane = lanes.trailing_zeros() as usize % LANES;
            lanes &= lanes - 1;
            let ray = RayView::alone(&rays[indices[part][lane] as usize]);
            if let Some(hit) = geometry.intersect(id, &ray, self.escalations) {
                nearer |= packet.consider_one(lane, &hit);
            }
        }
        nearer
    }

    #[inline(always)]
    fn update_limit<S: Simd>(&mut self, simd: S, part: usize) {
        self.limits.0[part] = self.shaft.depth_limit(self.bundle.packets[part].farthest(simd));
    }
}
