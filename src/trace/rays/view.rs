//! Rays as shapes see them.

use std::ops::Deref;

use glam::DVec3;

use super::departure::Departure;
use super::ray::Ray;
use super::shape_id::ShapeId;
use super::ties::{Tie, TieLists, Ties};

/// A ray, with what it leaves beside the shape that its departure names.
#[derive(Clone, Copy, Debug)]
pub(crate) struct RayView<'a> {
    ray: &'a Ray,
    ties: &'a [Tie],
}

impl<'a> RayView<'a> {
    /// Pairs a ray with the list that it names.
    #[inline]
    pub(crate) fn new(ray: &'a Ray, lists: &'a TieLists) -> Self {
        let ties = ray.departure().map_or(Ties::NONE, |departure| departure.ties);
        Self { ray, ties: lists.of(ties) }
    }

    /// Returns a ray that leaves no more than one shape.
    #[inline]
    #[cfg(test)]
    pub(crate) fn alone(ray: &'a Ray) -> Self {
        Self { ray, ties: &[] }
    }

    #[inline]
    pub(crate) fn departure(&self) -> Option<&'a Departure> {
        self.ray.departure()
    }

    /// Returns the outward normal of a shape that is left besides the one that the departure names.
    #[inline]
    pub(crate) fn left_normal(&self, id: ShapeId) -> Option<DVec3> {
        let index = self.ties.binary_search_by_key(&id.0, |tie| tie.id.0).ok()?;
        Some(self.ties[index].normal)
    }
}

impl Deref for RayView<'_> {
    type Target = Ray;

    #[inline]
    fn deref(&self) -> &Ray {
        self.ray
    }
}
