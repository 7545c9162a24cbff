//! The closest hit by asking every shape: the oracle of the tree.

use super::escalations::Escalations;
use super::hit::{ClosestHit, Hit};
use super::intersector::Intersector;
use crate::trace::rays::Ray;
use crate::trace::scene::PreparedScene;

/// The nearest surface; of several at the same place the first in document order.
#[must_use]
pub(crate) fn closest(scene: &PreparedScene, ray: &Ray) -> Option<ClosestHit> {
    let geometry = scene.geometry();
    let mut best = None;
    let mut escalations = Escalations::default();
    for id in geometry.ids() {
        // A ray that leaves a shape leaves all that equal it.
        if let Some(hit) = geometry.intersect(scene.first_equal(id), ray, &mut escalations) {
            ClosestHit::consider(&mut best, Hit { id, ..hit }, geometry, ray, &mut escalations);
        }
    }
    best
}
