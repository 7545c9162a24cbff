//! What differs between a prepared scene and the one before it.

use crate::trace::rays::ShapeId;
use crate::trace::shapes::Bounds;

/// What an update of a prepared scene changed: what may be kept of a picture, or of a BVH, follows from it.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct SceneChanges {
    /// Whether the scene was made anew: ids mean other shapes now, and anything may differ.
    pub remade: bool,
    /// What was done to the BVH. The picture does not depend on it.
    pub bvh: BvhUpdate,
    /// The shapes that moved or changed, in document order.
    pub shapes: Vec<ShapeChange>,
    /// The shapes whose materials differ.
    pub materials: Vec<ShapeId>,
    /// Whether lights differ: any of them, or how many there are.
    pub lights: bool,
    /// Whether the camera differs.
    pub camera: bool,
    /// Whether something of the whole scene differs: ambient light, background, fog, the film, or how many rays there are.
    pub settings: bool,
}

/// What an update did to the BVH, the tree over the shapes.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub enum BvhUpdate {
    /// Nothing: no shape in it has changed.
    #[default]
    Kept,
    /// Where few shapes have moved, the boxes around them were made to fit.
    Refitted,
    /// It was built anew.
    Built,
}

/// A shape that moved or changed.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct ShapeChange {
    /// The shape.
    pub id: ShapeId,
    /// The bounds that it had; `None` where it had none, as planes.
    pub before: Option<Bounds>,
    /// The bounds that it has.
    pub after: Option<Bounds>,
}

impl SceneChanges {
    /// Returns the changes of a scene that was made anew.
    #[must_use]
    pub fn remade() -> Self {
        Self { remade: true, bvh: BvhUpdate::Built, ..Self::default() }
    }

    /// Returns whether the scene is as before.
    #[must_use]
    pub fn is_empty(&self) -> bool {
        *self == Self::default()
    }
}
