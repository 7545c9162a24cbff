//! Closest hits, of single rays and of packets.

use std::cmp::Ordering;
use std::sync::atomic::AtomicBool;
use std::sync::atomic::Ordering::Relaxed;

use fearless_simd::{dispatch, prelude::*};

use super::hit::{ClosestHit, HitPacket, ShapeHit, SurfacePoint, TiedHitLists, TiedHits};
use super::intersector::{Intersector, PacketHit, PacketIntersector, ShapeQuery};
use super::scratch::{PacketScratch, Scratch};
use crate::trace::bvh::{FramePacket, LeafId, PacketStack, PacketVisitor};
use crate::trace::math::{BoundedT, F64s, bits, half_of, mask, splat};
use crate::trace::rays::{CoincidentHits, FAR, PreparedRay, RayPacket, RayView, ShapeId, Tie};
use crate::trace::scene::{Geometry, PreparedScene};
use crate::trace::shapes::RefinedHit;

/// Minimum number of active lanes; packets with fewer are left to the scalar code.
const FEWEST: u32 = 3;

impl PreparedScene {
    /// Returns the closest hit of the ray. Of several hits at the same `t`, it is the first in document order.
    #[must_use]
    pub(crate) fn closest(&self, ray: &PreparedRay, scratch: &mut Scratch<'_>) -> Option<ClosestHit> {
        let Scratch { stack, intersector, ties, tied_hits, cancelled, .. } = scratch;
        let ray = &RayView::new(ray, ties);
        let mut nearest = Nearest::new(&self.geometry, tied_hits);
        let mut limit = f64::INFINITY;
        for id in &self.unbounded {
            if cancelled.load(Relaxed) {
                return None;
            }
            limit = nearest.test(*id, ray, intersector);
        }
        self.tree.visit_nearest(ray, limit, stack, cancelled, |leaf| {
            nearest.test(self.leaves.id(leaf), ray, intersector)
        });
        nearest.closest()
    }

    /// Returns the closest hit like [`Self::closest`], by a test of every shape: the oracle of the tree.
    #[must_use]
    pub(crate) fn closest_of_all(&self, ray: &PreparedRay, scratch: &mut Scratch<'_>) -> Option<ClosestHit> {
        let Scratch { intersector, ties, tied_hits, .. } = scratch;
        let ray = &RayView::new(ray, ties);
        let mut nearest = Nearest::new(&self.geometry, tied_hits);
        for id in self.geometry.ids().filter(|id| self.sees(*id)) {
            // A ray that leaves a shape also leaves all shapes equal to it.
            if let Some(hit) = intersector.intersect(&self.geometry, self.first_equal(id), ray) {
                nearest.consider(ShapeHit { id, ..hit }, ray, intersector);
            }
        }
        nearest.closest()
    }

    /// Returns the surface point of a hit, with its normal. Of coincident surfaces the first in document order is visible, with one exception:
    /// a transparent surface that the ray leaves gives way to the first opaque one, so that the surface on which a glass stands is seen
    /// through it.
    #[must_use]
    #[inline]
    pub(crate) fn surface(
        &self,
        ray: &PreparedRay,
        closest: &ClosestHit,
        scratch: &mut Scratch<'_>,
    ) -> SurfacePoint {
        let ClosestHit { hit, tied } = *closest;
        if tied.is_empty() && self.equal_shapes.group(hit.id).is_none() {
            let intersector = &mut scratch.intersector;
            return surface_at(&self.geometry, ray, hit, hit.id, CoincidentHits::NONE, intersector);
        }
        self.tied_surface(ray, closest, scratch)
    }

    #[cold]
    fn tied_surface(
        &self,
        ray: &PreparedRay,
        closest: &ClosestHit,
        Scratch { intersector, ties, tied_hits, .. }: &mut Scratch<'_>,
    ) -> SurfacePoint {
        let mut coincident: Vec<ShapeHit> = tied_hits
            .of(closest.tied)
            .iter()
            .chain([&closest.hit])
            .map(|hit| ShapeHit { id: self.first_equal(hit.id), ..*hit })
            .collect();
        coincident.sort_unstable_by_key(|hit| hit.id.0);
        coincident.dedup_by_key(|hit| hit.id);
        let mut seen_as = |hit: ShapeHit| {
            let first_equal = self.first_equal(hit.id);
            let others = coincident.iter().filter(|other| other.id != first_equal).map(|tied| {
                let normal = intersector.refine(&self.geometry, ray, tied).normal;
                Tie { id: tied.id, normal }
            });
            let ties = ties.add(others);
            surface_at(&self.geometry, ray, hit, first_equal, ties, intersector)
        };
        let seen = seen_as(closest.hit);
        if seen.from_outside || self.material(closest.hit.id).refraction.is_none() {
            return seen;
        }
        let opaque =
            coincident.iter().filter_map(|hit| Some(ShapeHit { id: self.first_opaque(hit.id)?, ..*hit }));
        opaque.min_by_key(|hit| self.order().rank(hit.id)).map_or(seen, seen_as)
    }

    /// Returns the first opaque shape, in document order, among a shape and all shapes equal to it.
    fn first_opaque(&self, first_equal: ShapeId) -> Option<ShapeId> {
        match self.equal_shapes.group(first_equal) {
            Some(group) => group.opaque(None),
            None => self.material(first_equal).refraction.is_none().then_some(first_equal),
        }
    }
}

#[inline(always)]
fn surface_at(
    geometry: &Geometry,
    ray: &PreparedRay,
    hit: ShapeHit,
    first_equal: ShapeId,
    ties: CoincidentHits,
    intersector: &mut Intersector<'_>,
) -> SurfacePoint {
    let RefinedHit { t, point, normal } = intersector.refine(geometry, ray, &hit);
    // A far side is always hit from inside, whatever the rounding errors of a grazing ray.
    let from_outside = !hit.far && ray.direction().dot(normal) <= 0.0;
    SurfacePoint { hit, first_equal, ties, t, point, normal, from_outside }
}

/// The closest hit of one ray so far. Other hits at the same `t` are at the end of the lists.
pub(crate) struct Nearest<'a> {
    best: Option<ShapeHit>,
    geometry: &'a Geometry,
    lists: &'a mut TiedHitLists,
    start: usize,
}

impl<'a> Nearest<'a> {
    #[inline]
    pub(crate) fn new(geometry: &'a Geometry, lists: &'a mut TiedHitLists) -> Self {
        let start = lists.0.len();
        Self { best: None, geometry, lists, start }
    }

    /// Intersects another shape, and returns the `t` beyond which hits no longer matter.
    #[inline(always)]
    pub(crate) fn test(&mut self, id: ShapeId, ray: &RayView<'_>, intersector: &mut Intersector<'_>) -> f64 {
        if let Some(hit) = intersector.intersect(self.geometry, id, ray) {
            self.consider(hit, ray, intersector);
        }
        self.best.as_ref().map_or(f64::INFINITY, |best| best.root.latest())
    }

    /// Takes another hit of the ray into account.
    #[inline(always)]
    pub(crate) fn consider(&mut self, hit: ShapeHit, ray: &RayView<'_>, intersector: &mut Intersector<'_>) {
        let Some(best) = &mut self.best else {
            self.best = Some(hit);
            return;
        };
        match intersector.compare(self.geometry, ray, &hit, best) {
            Ordering::Less => {
                *best = hit;
                self.lists.0.truncate(self.start);
            }
            Ordering::Equal => {
                let order = self.geometry.order();
                let comes_first = order.rank(hit.id) < order.rank(best.id);
                let (first, second) = if comes_first { (hit, *best) } else { (*best, hit) };
                *best = first;
                self.lists.0.push(second);
            }
            Ordering::Greater => {}
        }
    }

    /// Returns the closest hit; of several hits at the same `t`, the first in document order.
    #[inline]
    pub(crate) fn closest(self) -> Option<ClosestHit> {
        // Memory runs out long before a `u32` overflows.
        let number = |count: usize| u32::try_from(count).unwrap_or(u32::MAX);
        let count = self.lists.0.len() - self.start;
        let tied = TiedHits { start: number(self.start), count: number(count) };
        self.best.map(|hit| ClosestHit { hit, tied })
    }
}

/// Finds the closest hits of a packet. `hits.undecided` holds the undecided lanes, which escalate to scalar code.
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
            if cancelled.load(Relaxed) {
                return;
            }
            self.test(simd, ShapeQuery::by_id(scene, *id), active);
        }
        let mut packet = scene.tree.packet(simd, self.intersector.rays, active & !self.hits.undecided, None);
        packet.limit(simd, &self.hits.ts, &self.hits.errors);
        scene.tree.visit_packet(simd, &mut packet, stack, cancelled, self);
    }

    /// Intersects the rays in some lanes with a shape. Returns whether any ray hits it nearer than all shapes before.
    #[inline(always)]
    pub(super) fn test<S: Simd>(&mut self, simd: S, shape: ShapeQuery<'_>, lanes: u32) -> bool {
        let mut nearer = false;
        for half in 0..2 {
            if half_of(lanes, half) == 0 {
                continue;
            }
            if let Some(found) = self.intersector.intersect(simd, shape, half, lanes) {
                nearer |= consider(simd, self.hits, half, shape.id, &found);
            }
        }
        nearer
    }
}

impl<S: Simd> PacketVisitor<S> for ClosestHitSearch<'_> {
    const NEAREST_FIRST: bool = true;

    #[inline(always)]
    fn visit(&mut self, simd: S, leaf: LeafId, lanes: u32, packet: &mut FramePacket) {
        let nearer = self.test(simd, ShapeQuery::leaf(self.scene, leaf), lanes);
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
fn consider<S: Simd>(simd: S, hits: &mut HitPacket, half: usize, id: ShapeId, found: &PacketHit<S>) -> bool {
    let PacketHit { intersection, far } = found;
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
