//! Values that can move.

use crate::animation::{Kind, Notation};

/// A value of an entity that a [`Motion`](super::Motion) can drive. Angles are radians here, light is linear.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
pub enum Property {
    /// [`Transform::translation`](super::Transform::translation).
    Translation,
    /// [`Transform::rotation`](super::Transform::rotation).
    Rotation,
    /// [`Transform::scale`](super::Transform::scale).
    Scale,
    /// The radius of a [`Shape::Sphere`](super::Shape).
    Radius,
    /// The edges of a [`Shape::Box`](super::Shape).
    Size,
    /// The normal of a [`Shape::Plane`](super::Shape).
    Normal,
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
    /// [`Checker::color`](super::Checker::color).
    CheckerColor,
    /// [`Checker::size`](super::Checker::size).
    CheckerSize,
    /// [`Light::intensity`](super::Light::intensity).
    Intensity,
    /// The direction of a [`LightKind::Directional`](super::LightKind).
    Direction,
    /// The angle of a [`LightKind::Spot`](super::LightKind).
    Angle,
    /// The softness of a [`LightKind::Spot`](super::LightKind).
    Softness,
    /// The coefficients c0, c1, c2 of a [`Falloff`](super::Falloff).
    Falloff,
    /// The radius of an [`AreaShape::Sphere`](super::AreaShape).
    LightRadius,
    /// The width of an [`AreaShape::Rectangle`](super::AreaShape).
    LightWidth,
    /// The height of an [`AreaShape::Rectangle`](super::AreaShape).
    LightHeight,
    /// [`Camera::position`](super::Camera::position).
    Position,
    /// [`View::Target`](super::View::Target).
    Target,
    /// [`View::Direction`](super::View::Direction).
    View,
    /// [`Camera::up`](super::Camera::up).
    Up,
    /// [`Camera::roll`](super::Camera::roll).
    Roll,
    /// The angle of a [`Projection::FieldOfView`](super::Projection).
    Fov,
    /// The distance of a [`Projection::Screen`](super::Projection).
    ScreenDistance,
    /// The width of a [`Projection::Screen`](super::Projection) that is given one.
    ScreenWidth,
    /// The height of a [`Projection::Screen`](super::Projection).
    ScreenHeight,
    /// [`Lens::aperture`](super::Lens::aperture).
    Aperture,
    /// [`Lens::focus`](super::Lens::focus).
    Focus,
    /// [`Ambient`](super::Ambient).
    Ambient,
    /// The colour of a [`Background::Flat`](super::Background).
    Background,
    /// The bottom of a [`Background::Gradient`](super::Background).
    BackgroundBottom,
    /// The top of a [`Background::Gradient`](super::Background).
    BackgroundTop,
    /// [`Fog::color`](super::Fog::color).
    FogColor,
    /// [`Fog::density`](super::Fog::density).
    FogDensity,
}

impl Property {
    /// All, in the order of the file format's reference.
    pub const ALL: [Self; 43] = [
        Self::Translation,
        Self::Rotation,
        Self::Scale,
        Self::Radius,
        Self::Size,
        Self::Normal,
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
        Self::CheckerColor,
        Self::CheckerSize,
        Self::Intensity,
        Self::Direction,
        Self::Angle,
        Self::Softness,
        Self::Falloff,
        Self::LightRadius,
        Self::LightWidth,
        Self::LightHeight,
        Self::Position,
        Self::Target,
        Self::View,
        Self::Up,
        Self::Roll,
        Self::Fov,
        Self::ScreenDistance,
        Self::ScreenWidth,
        Self::ScreenHeight,
        Self::Aperture,
        Self::Focus,
        Self::Ambient,
        Self::Background,
        Self::BackgroundBottom,
        Self::BackgroundTop,
        Self::FogColor,
        Self::FogDensity,
    ];

    /// Its name in scene files.
    #[must_use]
    pub const fn name(self) -> &'static str {
        match self {
            Self::Translation => "Translation",
            Self::Rotation => "Rotation",
            Self::Scale => "Scale",
            Self::Radius => "Radius",
            Self::Size => "Size",
            Self::Normal => "Normal",
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
            Self::CheckerColor => "CheckerColor",
            Self::CheckerSize => "CheckerSize",
            Self::Intensity => "Intensity",
            Self::Direction => "Direction",
            Self::Angle => "Angle",
            Self::Softness => "Softness",
            Self::Falloff => "Falloff",
            Self::LightRadius => "LightRadius",
            Self::LightWidth => "LightWidth",
            Self::LightHeight => "LightHeight",
            Self::Position => "Position",
            Self::Target => "Target",
            Self::View => "View",
            Self::Up => "Up",
            Self::Roll => "Roll",
            Self::Fov => "Fov",
            Self::ScreenDistance => "ScreenDistance",
            Self::ScreenWidth => "ScreenWidth",
            Self::ScreenHeight => "ScreenHeight",
            Self::Aperture => "Aperture",
            Self::Focus => "Focus",
            Self::Ambient => "Ambient",
            Self::Background => "Background",
            Self::BackgroundBottom => "BackgroundBottom",
            Self::BackgroundTop => "BackgroundTop",
            Self::FogColor => "FogColor",
            Self::FogDensity => "FogDensity",
        }
    }

    /// How its values are written in scene files and programs.
    #[must_use]
    pub const fn notation(self) -> Notation {
        match (self, self.kind()) {
            (Self::Angle | Self::Roll | Self::Fov, _) => Notation::Degrees,
            (Self::Scale, _) => Notation::Scale,
            (Self::Absorption | Self::Intensity | Self::Ambient, _) => Notation::Light,
            (_, Kind::Number) => Notation::Number,
            (_, Kind::Vector) => Notation::Vector,
            (_, Kind::Rotation) => Notation::Rotation,
            (_, Kind::Color) => Notation::Color,
        }
    }

    /// The kind of its values.
    #[must_use]
    pub const fn kind(self) -> Kind {
        match self {
            Self::Translation
            | Self::Scale
            | Self::Size
            | Self::Normal
            | Self::Direction
            | Self::Falloff
            | Self::Position
            | Self::Target
            | Self::View
            | Self::Up => Kind::Vector,
            Self::Rotation => Kind::Rotation,
            Self::Color
            | Self::AmbientColor
            | Self::Absorption
            | Self::CheckerColor
            | Self::Intensity
            | Self::Ambient
            | Self::Background
            | Self::BackgroundBottom
            | Self::BackgroundTop
            | Self::FogColor => Kind::Color,
            _ => Kind::Number,
        }
    }
}
