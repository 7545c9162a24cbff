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

    /// Creates a transform that only translates, by coordinates in scene units.
    #[must_use]
    pub const fn at(x: f64, y: f64, z: f64) -> Self {
        Self::from_translation(DVec3::new(x, y, z))
    }

    /// Returns the transform with a rotation of the own +z axis towards a point, in the same space as the translation. The own +y axis is
    /// up: as near to +y of that space as possible, or to +z if the point is straight above or below. Axes with negative scale factors are
    /// turned too, so that the mirrored axes point there. The transform is unchanged if the translation is at the point.
    ///
    /// ```
    /// use glam::DVec3;
    /// use rayreel::components::Transform;
    /// let transform = Transform::at(0.0, 4.0, 3.0).looking_at(DVec3::ZERO);
    /// let forward = transform.rotation * DVec3::Z;
    /// assert!(forward.distance(DVec3::new(0.0, -0.8, -0.6)) < 1e-12);
    /// ```
    #[must_use]
    pub fn looking_at(self, point: DVec3) -> Self {
        self.facing(point - self.translation).unwrap_or(self)
    }

    /// Returns the transform of [`looking_at`](Self::looking_at) for the direction to the point, of any length. `None` if it is zero or not
    /// finite.
    pub(crate) fn facing(self, direction: DVec3) -> Option<Self> {
        // Scaled first, so that the squares neither underflow nor overflow.
        let forward = (direction / direction.abs().max_element()).try_normalize()?;
        let across = |up: DVec3| Some(up.cross(forward)).filter(|right| right.length_squared() > 1e-24);
        let right = across(DVec3::Y).or_else(|| across(DVec3::Z)).unwrap_or(DVec3::X).normalize();
        let DVec3 { y, z, .. } = self.scale.signum();
        let axes = DMat3::from_cols(right * (y * z), forward.cross(right) * y, forward * z);
        let rotation = DQuat::from_mat3(&axes);
        Some(Self { rotation, ..self })
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

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn transforms_look_at_points_in_all_directions() {
        let start = Transform::at(1.0, -2.0, 3.0);
        for direction in
            (0..125).map(|cell| DVec3::from([cell % 5, cell / 5 % 5, cell / 25].map(f64::from)) - 2.0)
        {
            let looking = start.looking_at(start.translation + direction);
            let Some(forward) = direction.try_normalize() else {
                assert_eq!(looking, start);
                continue;
            };
            let [right, up, ahead] = DVec3::AXES.map(|axis| looking.rotation * axis);
            assert!(ahead.distance(forward) < 1e-14 && right.cross(up).distance(ahead) < 1e-14);
            let is_vertical = direction.x == 0.0 && direction.z == 0.0;
            let (vertical, level) = if is_vertical { (up.z, right.z) } else { (up.y, right.y) };
            assert!(vertical > 0.0 && level.abs() < 1e-14, "{direction}: {right}, {up}");
        }
    }
}
