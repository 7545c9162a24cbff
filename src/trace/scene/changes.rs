//! What differs between a prepared scene and the one before it.

use crate::trace::rays::ShapeId;
use crate::trace::shapes::Bounds;

/// What an update of a prepared scene changed: what may be kept of a picture, or of a BVH, follows from it.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct SceneChanges {
    /// Whether the scene was made anew: ids mean other shapes now, and anything may differ.
    pub remade: bool,
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
        Self { remade: true, ..Self::default() }
    }

    /// Returns whether the BVH was built.
    #[must_use]
    pub fn built_bvh(&self) -> bool {
        self.remade || !self.shapes.is_empty()
    }

    /// Returns whether the scene is as before.
    #[must_use]
    pub fn is_empty(&self) -> bool {
        *self == Self::default()
    }
}
