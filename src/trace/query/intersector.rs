//! The queries on shapes that searches use at any precision.

use std::cmp::Ordering;

use super::escalations::Escalations;
use super::hit::ShapeHit;
use crate::trace::rays::{PreparedRay, RayView, ShadowLimit, ShapeId};
use crate::trace::shapes::RefinedHit;

/// Intersects rays with shapes at one precision.
pub(crate) trait Intersector: Sync {
    /// Returns the first hit of the ray with the shape.
    fn intersect(&self, id: ShapeId, ray: &RayView<'_>, escalations: &mut Escalations) -> Option<ShapeHit>;

    /// Compares the distances of two hits of a ray.
    fn compare(
        &self,
        ray: &PreparedRay,
        hit: &ShapeHit,
        other: &ShapeHit,
        escalations: &mut Escalations,
    ) -> Ordering;

    /// Returns whether the hit is nearer than `limit`.
    fn is_before(
        &self,
        hit: &ShapeHit,
        ray: &PreparedRay,
        limit: &ShadowLimit,
        escalations: &mut Escalations,
    ) -> bool;

    /// Returns whether the shape occludes the ray before `limit`.
    #[inline]
    fn occludes(
        &self,
        id: ShapeId,
        ray: &RayView<'_>,
        limit: &ShadowLimit,
        escalations: &mut Escalations,
    ) -> bool {
        self.intersect(id, ray, escalations).is_some_and(|hit| self.is_before(&hit, ray, limit, escalations))
    }

    /// Computes the accurate `t`, point and normal of a hit.
    fn refine(&self, ray: &PreparedRay, hit: &ShapeHit, escalations: &mut Escalations) -> RefinedHit;

    /// Returns the number of times that the ray crosses the shape's surface before `limit`, if a fast count is certain.
    #[inline]
    fn certain_crossings(&self, _id: ShapeId, _ray: &RayView<'_>, _limit: &ShadowLimit) -> Option<u32> {
        None
    }
}
