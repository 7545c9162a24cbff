//! Shapes at the end of a ray that the ray does not see, but rays of another class that start there do.
//!
//! Such rays must not hit the surfaces on which they start, and must know the solids in which they start. The ray that arrives has found
//! neither, so they are determined here: exactly, as the ties of closest hits are.
//!
//! ```text
//! for each shape that the ray may hit up to its end, and that it does not see:
//!     equal to the shape at the end:              tied, and contains the ray if that is left there
//!     first hit after the end, or none:           contains the ray if it starts inside
//!     first hit exactly at the end:               tied, and contains the ray if it leaves the shape there
//!     first hit before the end, and entered:      tied if it is a box or a rod and the ray leaves it exactly at the end;
//!                                                 contains the ray unless it is left before
//!     first hit before the end, and left:         neither
//! ```
//!
//! All comparisons are exact, since the point at the end is rounded, and may lie on the other side of a face that is nearly there. Spheres
//! are the exception: unless two spheres are equal, they do not coincide along an area. For them, the rounded point decides whether the
//! ray has left.

use std::cmp::Ordering;

use glam::DVec3;

use super::hit::SurfacePoint;
use super::intersector::Intersector;
use super::scratch::Scratch;
use crate::trace::rays::{PreparedRay, RayView, ShapeId};
use crate::trace::scene::PreparedScene;
use crate::trace::shapes::RefinedHit;

/// A shape at the end of a ray that does not see it.
#[derive(Clone, Copy, Debug)]
pub(crate) struct UnseenShape {
    /// The first in document order of the shape and all shapes equal to it.
    pub(crate) id: ShapeId,
    /// The outward normal, if the surface of the shape coincides with the surface at the end.
    pub(crate) normal: Option<DVec3>,
    /// True if the ray is inside the shape just before its end.
    pub(crate) contains_ray: bool,
}

impl PreparedScene {
    /// Finds the shapes of this scene at a surface point that `ray`, which sees the shapes of `other`, has found there without seeing them.
    pub(crate) fn unseen(
        &self,
        other: &Self,
        (ray, surface): (&PreparedRay, &SurfacePoint),
        scratch: &mut Scratch<'_>,
    ) -> Vec<UnseenShape> {
        let mut found = Vec::new();
        if self.sees_more_than(other) {
            let Scratch { stack, intersector, ties, cancelled, .. } = scratch;
            let ray = &RayView::new(ray, ties);
            let mut test = |id| found.extend(self.unseen_shape(id, other, (ray, surface), intersector));
            self.unbounded.iter().for_each(|id| test(*id));
            self.tree.find_any(ray, surface.hit.root.latest(), stack, cancelled, |leaf| {
                test(self.leaves.id(leaf));
                false
            });
            found.sort_unstable_by_key(|shape| shape.id.0);
        }
        found
    }

    /// Finds the same shapes as [`Self::unseen`], by a test of every shape: the oracle of the tree.
    pub(crate) fn unseen_of_all(
        &self,
        other: &Self,
        (ray, surface): (&PreparedRay, &SurfacePoint),
        Scratch { intersector, ties, .. }: &mut Scratch<'_>,
    ) -> Vec<UnseenShape> {
        let ray = &RayView::new(ray, ties);
        let first_equals = self.geometry().ids().filter(|id| self.sees(*id) && self.first_equal(*id) == *id);
        first_equals.filter_map(|id| self.unseen_shape(id, other, (ray, surface), intersector)).collect()
    }

    fn unseen_shape(
        &self,
        id: ShapeId,
        other: &Self,
        (ray, surface): (&RayView<'_>, &SurfacePoint),
        intersector: &mut Intersector<'_>,
    ) -> Option<UnseenShape> {
        let is_seen = match self.equal_shapes.group(id) {
            Some(group) => group.ids().iter().all(|id| other.sees(*id)),
            None => other.sees(id),
        };
        if is_seen {
            return None;
        }
        let relation = self.relation(id, (ray, surface), intersector);
        let is_medium = relation.contains_ray && !self.media_at(&id).is_empty();
        (relation.normal.is_some() || is_medium).then_some(relation)
    }

    /// Determines whether the surface of a shape coincides with a surface point, and whether the arriving ray is inside the shape.
    fn relation(
        &self,
        id: ShapeId,
        (ray, surface): (&RayView<'_>, &SurfacePoint),
        intersector: &mut Intersector<'_>,
    ) -> UnseenShape {
        let geometry = self.geometry();
        let tied = |normal, contains_ray| UnseenShape { id, normal: Some(normal), contains_ray };
        let apart = |contains_ray| UnseenShape { id, normal: None, contains_ray };
        if geometry.are_equal(id, surface.hit.id) {
            return tied(surface.normal, !surface.from_outside);
        }
        let leaves_outward = match ray.exclusion() {
            Some(exclusion) if exclusion.id == id => Some(exclusion.outward),
            _ => ray.left_normal(id).map(|normal| ray.direction().dot(normal) >= 0.0),
        };
        let Some(near) = intersector.intersect(geometry, id, ray) else {
            return apart(
                leaves_outward.map_or_else(|| geometry.contains(id, ray.origin()), |outward| !outward),
            );
        };
        let RefinedHit { normal, .. } = intersector.refine(geometry, ray, &near);
        let enters = !near.far && ray.direction().dot(normal) < 0.0;
        match intersector.compare(geometry, ray, &near, &surface.hit) {
            Ordering::Equal => tied(normal, !enters),
            Ordering::Greater => apart(!enters),
            Ordering::Less if !enters => apart(false),
            // A ray never leaves the half-space behind a plane.
            Ordering::Less if geometry.plane(id).is_some() => apart(true),
            Ordering::Less => {
                let Some(exit) = intersector.solid_exit(geometry, id, ray) else {
                    return apart(geometry.contains(id, surface.point));
                };
                match intersector.compare(geometry, ray, &exit, &surface.hit) {
                    Ordering::Equal => tied(intersector.refine(geometry, ray, &exit).normal, true),
                    order => apart(order.is_gt()),
                }
            }
        }
    }
}
