//! The closest hit of a ray, and its surface point.

use std::sync::atomic::Ordering::Relaxed;

use super::hit::{ClosestHit, ShapeHit, SurfacePoint};
use super::intersector::Intersector;
use super::nearest::Nearest;
use super::scratch::Scratch;
use crate::trace::rays::{CoincidentHits, PreparedRay, RayView, ShapeId, Tie};
use crate::trace::scene::{Geometry, PreparedScene};
use crate::trace::shapes::RefinedHit;

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
            limit = nearest.meet(*id, ray, intersector);
        }
        self.tree.visit_nearest(ray, limit, stack, cancelled, |leaf| {
            nearest.meet(self.leaves.id(leaf), ray, intersector)
        });
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
        let mut met: Vec<ShapeHit> = tied_hits
            .of(closest.tied)
            .iter()
            .chain([&closest.hit])
            .map(|hit| ShapeHit { id: self.first_equal(hit.id), ..*hit })
            .collect();
        met.sort_unstable_by_key(|hit| hit.id.0);
        met.dedup_by_key(|hit| hit.id);
        let mut seen_as = |hit: ShapeHit| {
            let first_equal = self.first_equal(hit.id);
            let others = met.iter().filter(|other| other.id != first_equal).map(|tied| {
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
        let opaque = met.iter().filter_map(|hit| Some(ShapeHit { id: self.first_opaque(hit.id)?, ..*hit }));
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
