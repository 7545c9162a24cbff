//! The closest hit by a test of every shape: the oracle of the tree.

use super::hit::{ClosestHit, ShapeHit};
use super::nearest::Nearest;
use super::scratch::Scratch;
use crate::trace::rays::{PreparedRay, RayView};
use crate::trace::scene::PreparedScene;

/// Returns the closest hit; of several hits at the same `t`, the first in document order.
#[must_use]
pub(crate) fn closest(
    scene: &PreparedScene,
    ray: &PreparedRay,
    scratch: &mut Scratch<'_>,
) -> Option<ClosestHit> {
    let geometry = scene.geometry();
    let Scratch { intersector, ties, tied_hits, .. } = scratch;
    let ray = &RayView::new(ray, ties);
    let mut nearest = Nearest::new(geometry, tied_hits);
    for id in geometry.ids() {
        // A ray that leaves a shape also leaves all shapes equal to it.
        if let Some(hit) = intersector.intersect(geometry, scene.first_equal(id), ray) {
            nearest.consider(ShapeHit { id, ..hit }, ray, intersector);
        }
    }
    nearest.closest()
}
