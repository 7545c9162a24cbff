//! Occlusion queries between a surface and a light.

use std::sync::atomic::Ordering::Relaxed;

use super::crossings::{Crossed, Look};
use super::intersector::Intersector;
use super::scratch::Scratch;
use crate::trace::bvh::LeafId;
use crate::trace::rays::{PreparedRay, RayView, ShadowLimit, ShapeId};
use crate::trace::scene::{EqualGroup, PreparedScene};

impl PreparedScene {
    /// Returns any shape, except `except`, between the ray's origin and `limit`: the first one found. If `candidates` are given, only they are
    /// tested instead of the tree.
    #[must_use]
    pub(crate) fn occluder(
        &self,
        ray: &PreparedRay,
        limit: &ShadowLimit,
        (except, candidates): (Option<ShapeId>, Option<&[LeafId]>),
        scratch: &mut Scratch<'_>,
    ) -> Option<ShapeId> {
        let Scratch { stack, intersector, ties, cancelled, .. } = scratch;
        let ray = &RayView::new(ray, ties);
        // Of several equal shapes, at least one is not `except`.
        let counts = |id: ShapeId| Some(id) != except || self.equal_shapes.group(id).is_some();
        let mut hides = |id: ShapeId| counts(id) && intersector.occludes(&self.geometry, id, ray, limit);
        let mut unbounded = self.unbounded.iter().copied();
        let unbounded = unbounded.find(|id| cancelled.load(Relaxed) || hides(*id));
        unbounded.or_else(|| match candidates {
            Some(candidates) => candidates.iter().map(|leaf| self.leaves.id(*leaf)).find(|id| hides(*id)),
            None => {
                let leaf =
                    self.tree.find_any(ray, limit.t(), stack, cancelled, |leaf| hides(self.leaves.id(leaf)));
                leaf.map(|leaf| self.leaves.id(leaf))
            }
        })
    }

    /// Returns any opaque shape, except `except`, between the ray's origin and `limit`. If there is none, `scratch.crossed` contains the
    /// transparent shapes there. `candidates` are as in [`Self::occluder`].
    #[must_use]
    pub(crate) fn occluder_or_crossed(
        &self,
        ray: &PreparedRay,
        limit: &ShadowLimit,
        (except, candidates): (Option<ShapeId>, Option<&[LeafId]>),
        scratch: &mut Scratch<'_>,
    ) -> Option<ShapeId> {
        let Scratch { stack, intersector, ties, crossed, cancelled, .. } = scratch;
        let ray = &RayView::new(ray, ties);
        crossed.clear();
        let mut hides = |id: ShapeId| match self.equal_shapes.group(id) {
            Some(group) => self.group_hides_or_is_crossed(group, ray, (limit, except), crossed, intersector),
            None if Some(id) == except => false,
            None => self.hides_or_is_crossed(id, (ray, limit), Look::Glance, crossed, intersector),
        };
        let mut unbounded = self.unbounded.iter().copied();
        let unbounded = unbounded.find(|id| cancelled.load(Relaxed) || hides(*id));
        unbounded.or_else(|| match candidates {
            Some(candidates) => candidates.iter().map(|leaf| self.leaves.id(*leaf)).find(|id| hides(*id)),
            None => {
                let leaf =
                    self.tree.find_any(ray, limit.t(), stack, cancelled, |leaf| hides(self.leaves.id(leaf)));
                leaf.map(|leaf| self.leaves.id(leaf))
            }
        })
    }

    /// Returns whether the shape occludes the ray. A transparent shape never does; it is added to `crossed` if it is hit.
    #[inline]
    pub(crate) fn hides_or_is_crossed(
        &self,
        id: ShapeId,
        (ray, limit): (&RayView<'_>, &ShadowLimit),
        look: Look,
        crossed: &mut Vec<Crossed>,
        intersector: &mut Intersector<'_>,
    ) -> bool {
        // A ray that leaves a shape also leaves all shapes equal to it.
        let asked = self.first_equal(id);
        if self.material(id).refraction.is_none() {
            return intersector.occludes(&self.geometry, asked, ray, limit);
        }
        crossed.extend(
            Crossed::new(&self.geometry, asked, (ray, limit), look, intersector).map(|met| met.by(id)),
        );
        false
    }

    /// Tests a group of equal shapes at once, like [`Self::hides_or_is_crossed`].
    #[cold]
    fn group_hides_or_is_crossed(
        &self,
        group: &EqualGroup,
        ray: &RayView<'_>,
        (limit, except): (&ShadowLimit, Option<ShapeId>),
        crossed: &mut Vec<Crossed>,
        intersector: &mut Intersector<'_>,
    ) -> bool {
        if let Some(opaque) = group.opaque(except) {
            return self.hides_or_is_crossed(opaque, (ray, limit), Look::Glance, crossed, intersector);
        }
        let mut clear = group.clear().iter().copied().filter(|id| Some(*id) != except);
        if let Some(first) = clear.next() {
            let from = crossed.len();
            self.hides_or_is_crossed(first, (ray, limit), Look::Glance, crossed, intersector);
            if let Some(met) = crossed.get(from).copied() {
                crossed.extend(clear.map(|id| met.by(id)));
            }
        }
        false
    }
}
