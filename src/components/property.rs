//! Values that can move.

use crate::timeline::Kind;

/// A value of an entity that a [`Motion`](super::Motion) can drive. Angles are radians here, light is linear.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
pub enum Property {
    /// [`Transform::translation`](super::Transform::translation).
    Translation,
    /// [`Transform::rotation`](super::Transform::rotation).
    Rotation,
    /// [`Transform::scale`](super::Transform::scale).
    Scale,
    /// [`Material::k_a`](super::Material::k_a).
    Ka,
    /// [`Material::k_d`](super::Material::k_d).
    Kd,
    /// [`Material::color`](super::Material::color).
    Color,
    /// [`Material::ambient_color`](super::Material::ambient_color).
    AmbientColor,
    /// [`Specular::k_s`](super::Specular::k_s).
    Ks,
    /// [`Specular::shininess`](super::Specular::shininess).
    Shininess,
    /// [`Reflective::k_r`](super::Reflective::k_r).
    Kr,
    /// [`Refractive::k_t`](super::Refractive::k_t).
    Kt,
    /// [`Refractive::ior`](super::Refractive::ior).
    Ior,
    /// [`Refractive::absorption`](super::Refractive::absorption).
    Absorption,
    /// [`Light::intensity`](super::Light::intensity).
    Intensity,
    /// [`LightKind::Directional::direction`](super::LightKind).
    Direction,
    /// [`Camera::position`](super::Camera::position).
    Position,
    /// [`View::Target`](super::View::Target).
    Target,
}

impl Property {
    /// All, in the order in which the file format lists them.
    pub const ALL: [Self; 17] = [
        Self::Translation,
        Self::Rotation,
        Self::Scale,
        Self::Ka,
        Self::Kd,
        Self::Color,
        Self::AmbientColor,
        Self::Ks,
        Self::Shininess,
        Self::Kr,
        Self::Kt,
        Self::Ior,
        Self::Absorption,
        Self::Intensity,
        Self::Direction,
        Self::Position,
        Self::Target,
    ];

    /// Its name in scene files.
    #[must_use]
    pub const fn name(self) -> &'static str {
        match self {
            Self::Translation => "Translation",
            Self::Rotation => "Rotation",
            Self::Scale => "Scale",
            Self::Ka => "Ka",
            Self::Kd => "Kd",
            Self::Color => "Color",
            Self::AmbientColor => "AmbientColor",
            Self::Ks => "Ks",
            Self::Shininess => "Shininess",
            Self::Kr => "Kr",
            Self::Kt => "Kt",
            Self::Ior => "Ior",
            Self::Absorption => "Absorption",
            Self::Intensity => "Intensity",
            Self::Direction => "Direction",
            Self::Position => "Position",
            Self::Target => "Target",
        }
    }

    /// The kind of its values.
    #[must_use]
    pub const fn kind(self) -> Kind {
        match self {
            Self::Ka | Self::Kd | Self::Ks | Self::Shininess | Self::Kr | Self::Kt | Self::Ior => {
                Kind::Number
            }
            Self::Translation | Self::Scale | Self::Direction | Self::Position | Self::Target => Kind::Vector,
            Self::Rotation => Kind::Rotation,
            Self::Color | Self::AmbientColor | Self::Absorption | Self::Intensity => Kind::Color,
        }
    }
}
