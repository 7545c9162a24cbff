//! The running closest hit of a ray.

use std::cmp::Ordering;

use super::hit::{ClosestHit, ShapeHit, TiedHits};
use super::intersector::Intersector;
use crate::trace::rays::{RayView, ShapeId};
use crate::trace::scene::Geometry;

/// Lists of the hits at the same `t` as the closest hits of rays, one list after another.
#[derive(Clone, Debug, Default)]
pub(crate) struct TiedHitLists(Vec<ShapeHit>);

/// The closest hit of one ray so far. Other hits at the same `t` are at the end of the lists.
pub(crate) struct Nearest<'a> {
    best: Option<ShapeHit>,
    geometry: &'a Geometry,
    lists: &'a mut TiedHitLists,
    start: usize,
}

impl TiedHitLists {
    /// Returns a list, in no particular order. The first of equal shapes in document order represents all of them.
    pub(crate) fn of(&self, tied: TiedHits) -> &[ShapeHit] {
        let TiedHits { start, count } = tied;
        if count == 0 { &[] } else { &self.0[start as usize..][..count as usize] }
    }

    pub(crate) fn clear(&mut self) {
        self.0.clear();
    }
}

impl<'a> Nearest<'a> {
    #[inline]
    pub(crate) fn new(geometry: &'a Geometry, lists: &'a mut TiedHitLists) -> Self {
        let start = lists.0.len();
        Self { best: None, geometry, lists, start }
    }

    /// Intersects another shape, and returns the `t` beyond which hits no longer matter.
    #[inline(always)]
    pub(crate) fn meet(&mut self, id: ShapeId, ray: &RayView<'_>, intersector: &mut Intersector<'_>) -> f64 {
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
