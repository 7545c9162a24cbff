//! Visibility by kind of ray.

/// The rays that see an entity's shape. All rays see the shapes of entities without this component.
///
/// For rays that do not see it, a shape does not exist: it neither hides, reflects nor refracts anything, and does not enclose them as a
/// medium. Children of the entity have a visibility of their own. Channels as [`Property::Visible`](super::Property) have no
/// effect on an entity without this component.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Visibility {
    /// True if rays from the camera see the shape.
    pub camera: bool,
    /// True if mirrored and refracted rays see the shape.
    pub secondary: bool,
    /// True if rays to lights see the shape, so that it casts shadows.
    pub shadow: bool,
}

impl Visibility {
    /// All rays see the shape.
    pub const ALL: Self = Self { camera: true, secondary: true, shadow: true };
    /// No ray sees the shape.
    pub const NONE: Self = Self { camera: false, secondary: false, shadow: false };
}

impl Default for Visibility {
    fn default() -> Self {
        Self::ALL
    }
}
