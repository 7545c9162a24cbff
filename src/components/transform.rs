//! Position, orientation and size of an entity.

use glam::{DAffine3, DMat3, DQuat, DVec3};

/// Position, orientation and size relative to the [`Parent`], or to the world.
///
/// A point `p` of the entity's own space is at `translation + rotation * (scale * p)`.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Transform {
    /// Scene units.
    pub translation: DVec3,
    /// A unit quaternion, to the precision of `f64`: its length does not scale anything.
    pub rotation: DQuat,
    /// Factor per own axis; never zero.
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

/// The entity whose space a [`Transform`] is relative to.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Parent(pub hecs::Entity);

/// Own space to world space, as a matrix, with what is known of its structure.
///
/// Structure is tracked through the products instead of being read off the rounded matrix: a turned sphere under a turned parent
/// is still exactly a sphere.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct WorldTransform {
    /// The map, rounded.
    pub affine: DAffine3,
    /// The rounding error: the map is the sum of both, so that faces that are flush as written stay so through parents.
    pub rest: DAffine3,
    /// The factor of all lengths, if there is a single one (rotations, uniform scales and reflections only).
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
