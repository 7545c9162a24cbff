//! Position, orientation and size of an entity.

use glam::{DAffine3, DMat3, DQuat, DVec3};

/// Position, orientation and size relative to the [`Parent`], or to the world.
///
/// A point `p` of the entity's own space is mapped to `translation + rotation * (scale * p)`.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Transform {
    /// The translation in scene units.
    pub translation: DVec3,
    /// The rotation, a unit quaternion to `f64` precision. Its length has no effect on the scale.
    pub rotation: DQuat,
    /// The scale factors along the entity's own axes; never zero.
    pub scale: DVec3,
}

impl Transform {
    /// No translation, rotation or scale.
    pub const IDENTITY: Self =
        Self { translation: DVec3::ZERO, rotation: DQuat::IDENTITY, scale: DVec3::ONE };

    /// Creates a transform that only translates.
    #[must_use]
    pub const fn from_translation(translation: DVec3) -> Self {
        Self { translation, ..Self::IDENTITY }
    }
}

impl Default for Transform {
    fn default() -> Self {
        Self::IDENTITY
    }
}

/// The parent: the entity whose space a [`Transform`] is relative to.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Parent(pub hecs::Entity);

/// The map from own space to world space as a matrix, with structural information.
///
/// The structure is tracked through the products instead of being derived from the rounded matrix: a rotated sphere under a rotated parent
/// is still exactly a sphere.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct WorldTransform {
    /// The map, rounded.
    pub affine: DAffine3,
    /// The rounding error. The exact map is the sum of `affine` and `rest`, so that faces that are flush as written stay flush through
    /// parents.
    pub rest: DAffine3,
    /// The scale factor of all lengths, if it is the same in all directions (rotations, uniform scales and reflections only).
    pub uniform_scale: Option<f64>,
}

impl WorldTransform {
    /// No translation, rotation or scale.
    pub const IDENTITY: Self = Self {
        affine: DAffine3::IDENTITY,
        rest: DAffine3 { matrix3: DMat3::ZERO, translation: DVec3::ZERO },
        uniform_scale: Some(1.0),
    };
}

impl Default for WorldTransform {
    fn default() -> Self {
        Self::IDENTITY
    }
}
