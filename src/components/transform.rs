//! Where an entity is.

use glam::{DAffine3, DMat3, DQuat, DVec3};

/// Position, orientation and size relative to the [`Parent`], or to the world.
///
/// A point `p` of the entity's own space is at `translation + rotation * (scale * p)`.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Transform {
    /// Scene units.
    pub translation: DVec3,
    /// A unit quaternion.
    pub rotation: DQuat,
    /// Factor per own axis; never zero.
    pub scale: DVec3,
}

impl Transform {
    /// Neither moved, turned nor scaled.
    pub const IDENTITY: Self =
        Self { translation: DVec3::ZERO, rotation: DQuat::IDENTITY, scale: DVec3::ONE };

    /// Moved only.
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
/// Structure is followed through the products instead of being read off the rounded matrix: a turned sphere under a
/// turned parent is still exactly a sphere.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct WorldTransform {
    /// The map itself.
    pub affine: DAffine3,
    /// The factor of all lengths, if there is a single one (rotations, uniform scales and mirrorings only).
    pub uniform_scale: Option<f64>,
}

impl WorldTransform {
    /// The world transform of an entity without a parent.
    #[must_use]
    pub fn from_root(local: &Transform) -> Self {
        let Transform { translation, rotation, scale } = *local;
        // An unturned entity keeps an exactly diagonal matrix.
        let matrix3 = if rotation == DQuat::IDENTITY {
            DMat3::from_diagonal(scale)
        } else {
            DMat3::from_quat(rotation) * DMat3::from_diagonal(scale)
        };
        let size = scale.abs();
        let uniform = size.x == size.y && size.y == size.z;
        Self { affine: DAffine3 { matrix3, translation }, uniform_scale: uniform.then_some(size.x) }
    }

    /// The world transform of an entity whose parent has this one.
    #[must_use]
    pub fn child(&self, local: &Transform) -> Self {
        let local = Self::from_root(local);
        let uniform_scale = self.uniform_scale.zip(local.uniform_scale).map(|(outer, inner)| outer * inner);
        Self { affine: self.affine * local.affine, uniform_scale }
    }
}

impl Default for WorldTransform {
    fn default() -> Self {
        Self::from_root(&Transform::IDENTITY)
    }
}
