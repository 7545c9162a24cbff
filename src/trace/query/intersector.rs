//! What searches ask of shapes, whatever the precision.

use std::cmp::Ordering;

use super::escalations::Escalations;
use super::hit::Hit;
use crate::trace::rays::{Limit, Ray, RayView, ShapeId};
use crate::trace::shapes::RefinedHit;

/// Intersects rays with shapes, at some precision.
pub(crate) trait Intersector: Sync {
    /// Where the ray first meets the shape, if it does.
    fn intersect(&self, id: ShapeId, ray: &RayView<'_>, escalations: &mut Escalations) -> Option<Hit>;

    /// Which of a ray's hits is nearer.
    fn compare(&self, ray: &Ray, hit: &Hit, other: &Hit, escalations: &mut Escalations) -> Ordering;

    /// Returns whether the hit is nearer than `limit`.
    fn is_before(&self, hit: &Hit, ray: &Ray, limit: &Limit, escalations: &mut Escalations) -> bool;

    /// Returns whether the shape occludes the ray before `limit`.
    #[inline]
    fn occludes(&self, id: ShapeId, ray: &RayView<'_>, limit: &Limit, escalations: &mut Escalations) -> bool {
        self.intersect(id, ray, escalations).is_some_and(|hit| self.is_before(&hit, ray, limit, escalations))
    }

    /// What the hit found.
    fn refine(&self, ray: &Ray, hit: &Hit, escalations: &mut Escalations) -> RefinedHit;

    /// How many times the ray crosses the shape's surface before `limit`, if that is certain at a glance.
    #[inline]
    fn certain_crossings(&self, _id: ShapeId, _ray: &RayView<'_>, _limit: &Limit) -> Option<u32> {
        None
    }
}
