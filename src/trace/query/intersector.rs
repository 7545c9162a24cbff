//! Queries of single rays on single shapes, robustly or by naive formulas.

use std::cmp::Ordering;

use super::escalations::Escalations;
use super::hit::ShapeHit;
use super::naive::Naive;
use crate::trace::rays::{PreparedRay, RayView, ShadowLimit, ShapeId};
use crate::trace::scene::Geometry;
use crate::trace::shapes::RefinedHit;

/// Intersects rays with shapes, and counts escalations.
#[derive(Clone, Debug, Default)]
pub(crate) struct Intersector<'a> {
    /// The shapes of a scene in a naive number type, which replace those of its geometry.
    naive: Option<&'a Naive>,
    pub(crate) escalations: Escalations,
}

impl<'a> Intersector<'a> {
    /// Creates an intersector: robust, unless there are naive shapes.
    pub(crate) fn new(naive: Option<&'a Naive>) -> Self {
        Self { naive, escalations: Escalations::default() }
    }

    /// Returns the first hit of the ray with the shape.
    #[inline(always)]
    pub(crate) fn intersect(
        &mut self,
        geometry: &Geometry,
        id: ShapeId,
        ray: &RayView<'_>,
    ) -> Option<ShapeHit> {
        match self.naive {
            None => geometry.intersect(id, ray, &mut self.escalations),
            Some(naive) => naive.intersect(id, ray),
        }
    }

    /// Compares the distances of two hits of a ray.
    #[inline(always)]
    pub(crate) fn compare(
        &mut self,
        geometry: &Geometry,
        ray: &PreparedRay,
        hit: &ShapeHit,
        other: &ShapeHit,
    ) -> Ordering {
        match self.naive {
            None => geometry.compare(ray, hit, other, &mut self.escalations),
            Some(_) => hit.root.t().total_cmp(&other.root.t()),
        }
    }

    /// Returns whether the hit is nearer than `limit`.
    #[inline(always)]
    pub(crate) fn is_before(
        &mut self,
        geometry: &Geometry,
        hit: &ShapeHit,
        ray: &PreparedRay,
        limit: &ShadowLimit,
    ) -> bool {
        match self.naive {
            None => geometry.is_before(hit, ray, limit, &mut self.escalations),
            Some(_) => hit.root.t() < limit.t(),
        }
    }

    /// Returns whether the shape occludes the ray before `limit`.
    #[inline]
    pub(crate) fn occludes(
        &mut self,
        geometry: &Geometry,
        id: ShapeId,
        ray: &RayView<'_>,
        limit: &ShadowLimit,
    ) -> bool {
        self.intersect(geometry, id, ray).is_some_and(|hit| self.is_before(geometry, &hit, ray, limit))
    }

    /// Computes the accurate `t`, point and normal of a hit.
    #[inline(always)]
    pub(crate) fn refine(&mut self, geometry: &Geometry, ray: &PreparedRay, hit: &ShapeHit) -> RefinedHit {
        match self.naive {
            None => geometry.refine(ray, hit, &mut self.escalations),
            Some(naive) => naive.refine(ray, hit),
        }
    }

    /// Returns the number of times that the ray crosses the shape's surface before `limit`, if a fast count is certain.
    #[inline]
    pub(crate) fn certain_crossings(
        &self,
        geometry: &Geometry,
        id: ShapeId,
        ray: &RayView<'_>,
        limit: &ShadowLimit,
    ) -> Option<u32> {
        if self.naive.is_some() { None } else { geometry.crossings_at_a_glance(id, ray, limit) }
    }
}
