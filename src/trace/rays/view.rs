//! Rays together with all shapes that they leave.

use std::ops::Deref;

use glam::DVec3;

use super::coincident_hits::{CoincidentHits, Tie, TieLists};
use super::ray::PreparedRay;
use super::shape_id::ShapeId;
use super::surface_exclusion::SurfaceExclusion;

/// A ray, with the shapes that it leaves besides the one in its departure.
#[derive(Clone, Copy, Debug)]
pub(crate) struct RayView<'a> {
    ray: &'a PreparedRay,
    ties: &'a [Tie],
}

impl<'a> RayView<'a> {
    /// Pairs a ray with its list of ties.
    #[inline]
    pub(crate) fn new(ray: &'a PreparedRay, lists: &'a TieLists) -> Self {
        let ties = ray.exclusion().map_or(CoincidentHits::NONE, |exclusion| exclusion.ties);
        Self { ray, ties: lists.of(ties) }
    }

    /// Returns the view of a ray that leaves at most one shape.
    #[inline]
    #[cfg(test)]
    pub(crate) fn alone(ray: &'a PreparedRay) -> Self {
        Self { ray, ties: &[] }
    }

    #[inline]
    pub(crate) fn exclusion(&self) -> Option<&'a SurfaceExclusion> {
        self.ray.exclusion()
    }

    /// Returns the outward normal of a shape that the ray leaves besides the one in its departure.
    #[inline]
    pub(crate) fn left_normal(&self, id: ShapeId) -> Option<DVec3> {
        let index = self.ties.binary_search_by_key(&id.0, |tie| tie.id.0).ok()?;
        Some(self.ties[index].normal)
    }
}

impl Deref for RayView<'_> {
    type Target = PreparedRay;

    #[inline]
    fn deref(&self) -> &PreparedRay {
        self.ray
    }
}
