//! The closest hit of a ray, and its surface point.

use std::sync::atomic::Ordering::Relaxed;

use super::escalations::Escalations;
use super::hit::{ClosestHit, ShapeHit, SurfacePoint};
use super::intersector::Intersector;
use super::nearest::Nearest;
use super::scratch::Scratch;
use crate::trace::rays::{CoincidentHits, PreparedRay, RayView, ShapeId, Tie};
use crate::trace::scene::PreparedScene;
use crate::trace::shapes::RefinedHit;

/// Evaluates an expression with `$shapes` bound to the intersector of a scene's precision.
macro_rules! with_intersector {
    ($scene:expr, $shapes:ident => $work:expr) => {
        match $scene.precision {
            $crate::trace::Precision::Guaranteed => {
                let $shapes = $scene.geometry();
                $work
            }
            $crate::trace::Precision::TextbookF64 => {
                let $shapes = &$crate::trace::query::Textbook::<f64>::new($scene.geometry());
                $work
            }
            $crate::trace::Precision::TextbookF32 => {
                let $shapes = &$crate::trace::query::Textbook::<f32>::new($scene.geometry());
                $work
            }
        }
    };
}

pub(crate) use with_intersector;

impl PreparedScene {
    /// Returns the closest hit of the ray. Of several hits at the same `t`, it is the first in document order.
    #[must_use]
    pub(crate) fn closest(
        &self,
        shapes: &impl Intersector,
        ray: &PreparedRay,
        scratch: &mut Scratch<'_>,
    ) -> Option<ClosestHit> {
        let Scratch { stack, escalations, ties, tied_hits, cancelled, .. } = scratch;
        let ray = &RayView::new(ray, ties);
        let mut nearest = Nearest::new(self.order(), tied_hits);
        let mut limit = f64::INFINITY;
        for id in &self.unbounded {
            if cancelled.load(Relaxed) {
                return None;
            }
            limit = nearest.meet(*id, shapes, ray, escalations);
        }
        self.tree.visit_nearest(ray, limit, stack, cancelled, |leaf| {
            nearest.meet(self.leaves.id(leaf), shapes, ray, escalations)
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
        shapes: &impl Intersector,
        ray: &PreparedRay,
        closest: &ClosestHit,
        scratch: &mut Scratch<'_>,
    ) -> SurfacePoint {
        let ClosestHit { hit, tied } = *closest;
        if tied.is_empty() && self.equal_shapes.group(hit.id).is_none() {
            return surface_at(shapes, ray, hit, (hit.id, CoincidentHits::NONE), &mut scratch.escalations);
        }
        self.tied_surface(shapes, ray, closest, scratch)
    }

    #[cold]
    fn tied_surface(
        &self,
        shapes: &impl Intersector,
        ray: &PreparedRay,
        closest: &ClosestHit,
        Scratch { escalations, ties, tied_hits, .. }: &mut Scratch<'_>,
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
                let normal = shapes.refine(ray, tied, escalations).normal;
                Tie { id: tied.id, normal }
            });
            let ties = ties.add(others);
            surface_at(shapes, ray, hit, (first_equal, ties), escalations)
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
    shapes: &impl Intersector,
    ray: &PreparedRay,
    hit: ShapeHit,
    (first_equal, ties): (ShapeId, CoincidentHits),
    escalations: &mut Escalations,
) -> SurfacePoint {
    let RefinedHit { t, point, normal } = shapes.refine(ray, &hit, escalations);
    // A far side is always hit from inside, whatever the rounding errors of a grazing ray.
    let from_outside = !hit.far && ray.direction().dot(normal) <= 0.0;
    SurfacePoint { hit, first_equal, ties, t, point, normal, from_outside }
}
