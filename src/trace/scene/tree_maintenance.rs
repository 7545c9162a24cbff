//! Maintenance of a scene's tree, which is refitted while few shapes move, and rebuilt when many do or when it has become too costly.

use rayon::prelude::*;

use super::changes::ShapeChange;
use super::equal_shapes::EqualShapes;
use super::geometry::{Geometry, ShapeRef};
use super::leaf_shapes::LeafShapes;
use super::ray_visibility::RayClass;
use crate::trace::bvh::{Builder, Extent, LeafId, Refitter, Tree};
use crate::trace::rays::ShapeId;

/// If more than one in this many shapes has moved, rebuilding the tree takes about as long as refitting it.
const REFIT_ONE_IN: usize = 8;

/// The data for building and refitting the tree, kept from frame to frame.
#[derive(Clone, Debug, Default)]
pub(super) struct TreeMaintenance {
    builder: Builder,
    /// Created when a shape moves for the first time after the tree was built.
    links: Option<TreeLinks>,
}

/// The links from shapes to leaves, and from leaves up to the root.
#[derive(Clone, Debug)]
struct TreeLinks {
    /// The leaf of a shape, if it has one, by id.
    leaf_of: Vec<Option<LeafId>>,
    refitter: Refitter,
}

/// A scene's tree, the shapes of its leaves, and the shapes that are not in it.
pub(super) struct SceneTree<'a> {
    pub(super) tree: &'a mut Tree,
    pub(super) leaves: &'a mut LeafShapes,
    pub(super) unbounded: &'a mut Vec<ShapeId>,
}

impl TreeMaintenance {
    /// Refits the tree after these shapes have changed, each of which is listed once. Returns whether the tree may be kept; if not, it must
    /// be built.
    #[must_use]
    pub(super) fn refit(
        &mut self,
        geometry: &Geometry,
        equal_shapes: &mut EqualShapes,
        SceneTree { tree, leaves, .. }: SceneTree<'_>,
        changes: &[ShapeChange],
    ) -> bool {
        // Shapes with bounds may be in the tree, shapes without bounds may not.
        let stays = |change: &ShapeChange| change.before.is_some() == change.after.is_some();
        if changes.len() * REFIT_ONE_IN > geometry.len() || !changes.iter().all(stays) {
            return false;
        }
        let changed: Vec<ShapeId> = changes.iter().map(|change| change.id).collect();
        if !equal_shapes.remain_after(geometry, &changed) {
            return false;
        }
        let links = self.links.get_or_insert_with(|| TreeLinks::new(tree, leaves, geometry));
        let moved = changes.iter().filter_map(|change| {
            let leaf = links.leaf_of[change.id.index()]?;
            leaves.refresh(leaf, geometry);
            Some((leaf, change.after?))
        });
        links.refitter.refit(tree, moved)
    }

    /// Builds the tree of the shapes that rays of a class see. Of equal shapes, it holds the first in document order.
    pub(super) fn build(
        &mut self,
        (geometry, class): (&Geometry, RayClass),
        equal_shapes: &EqualShapes,
        SceneTree { tree, leaves, unbounded }: SceneTree<'_>,
    ) {
        self.links = None;
        let is_queried =
            |id: &ShapeId| equal_shapes.first(*id) == *id && geometry.visibility(*id).sees(class);
        let mut ids = Vec::with_capacity(geometry.len());
        unbounded.clear();
        for id in geometry.ids().filter(is_queried) {
            if geometry.is_bounded(id) { ids.push(id) } else { unbounded.push(id) }
        }
        for index in huge_shapes(geometry, &ids).into_iter().rev() {
            unbounded.push(ids.remove(index));
        }
        unbounded.sort_unstable_by_key(|id| geometry.order().rank(*id));
        let extent = |index: usize| {
            let id = ids[index];
            let round = matches!(geometry.shape(id), ShapeRef::Sphere(_));
            Extent { bounds: geometry.bounds(id).unwrap_or_default(), round }
        };
        let order = self.builder.build(ids.len(), extent, tree);
        leaves.fill(geometry, order.into_par_iter().map(move |index| ids[index as usize]));
    }
}

impl TreeLinks {
    fn new(tree: &Tree, leaves: &LeafShapes, geometry: &Geometry) -> Self {
        let mut leaf_of = vec![None; geometry.len()];
        for (leaf, id) in leaves.ids().enumerate() {
            leaf_of[id.index()] = Some(LeafId::new(leaf));
        }
        Self { leaf_of, refitter: Refitter::new(tree, leaves.ids().len()) }
    }
}

/// Returns the indices, ascending, of at most 64 shapes, the largest ones, whose boxes' longest edge exceeds 2^16 times the median. The
/// median is taken over at most some thousands of shapes, evenly spread among all, and ignores boxes without extent.
fn huge_shapes(geometry: &Geometry, ids: &[ShapeId]) -> Vec<usize> {
    const TIMES_MEDIAN: f64 = 65_536.0;
    const MOST: usize = 64;
    const SAMPLE: usize = 4096;
    let edge = |id: &ShapeId| geometry.bounds(*id).unwrap_or_default().extent();
    let sample = ids.iter().step_by(ids.len().div_ceil(SAMPLE).max(1));
    let mut edges: Vec<f64> = sample.map(edge).filter(|edge| *edge > 0.0).collect();
    if edges.is_empty() {
        return Vec::new();
    }
    let middle = edges.len() / 2;
    let median = *edges.select_nth_unstable_by(middle, f64::total_cmp).1;
    let large = |(_, id): &(usize, &ShapeId)| edge(id) > median * TIMES_MEDIAN;
    let mut huge: Vec<usize> = ids.par_iter().enumerate().filter(large).map(|(index, _)| index).collect();
    huge.sort_by(|left, right| edge(&ids[*right]).total_cmp(&edge(&ids[*left])));
    huge.truncate(MOST);
    huge.sort_unstable();
    huge
}
