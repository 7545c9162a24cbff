//! Differences between a prepared scene and its previous state.

use crate::trace::rays::ShapeId;
use crate::trace::shapes::Bounds;

/// The changes made by an update of a prepared scene. They determine which parts of a picture or of a BVH may be kept.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct SceneChanges {
    /// True if the scene was rebuilt: ids refer to other shapes, and anything may differ.
    pub remade: bool,
    /// The update of the BVH. The picture does not depend on it.
    pub bvh: BvhUpdate,
    /// The shapes that moved or changed, in document order.
    pub shapes: Vec<ShapeChange>,
    /// The shapes with different materials.
    pub materials: Vec<ShapeId>,
    /// True if any light differs, or the number of lights.
    pub lights: bool,
    /// True if the camera differs.
    pub camera: bool,
    /// True if a global setting differs: ambient light, background, fog, the film, or the number of rays.
    pub settings: bool,
}

/// The update of the BVH, the tree over the shapes.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub enum BvhUpdate {
    /// Unchanged: no shape in the tree has changed.
    #[default]
    Kept,
    /// Refitted boxes, as few shapes have moved.
    Refitted,
    /// A rebuilt tree.
    Built,
}

/// A shape that moved or changed.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct ShapeChange {
    /// The shape.
    pub id: ShapeId,
    /// The bounds before the update; `None` for unbounded shapes such as planes.
    pub before: Option<Bounds>,
    /// The bounds after the update.
    pub after: Option<Bounds>,
}

impl SceneChanges {
    /// Returns the changes of a rebuilt scene.
    #[must_use]
    pub fn remade() -> Self {
        Self { remade: true, bvh: BvhUpdate::Built, ..Self::default() }
    }

    /// Returns whether nothing has changed.
    #[must_use]
    pub fn is_empty(&self) -> bool {
        *self == Self::default()
    }
}
