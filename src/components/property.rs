//! Properties: the values that can be animated, with all facts of each in one row.
//!
//! | fact | determines |
//! |---|---|
//! | the name | the name in scene files, scripts and messages |
//! | [`Requirement`] | the entities, cameras and materials that have the property as a channel; the changes that a write declares |
//! | [`Quantity`] | the notation of the values; the valid keys; the range to which values are clamped; use with paths |
//!
//! For a new row the compiler requires an accessor (`systems::property_access`) and a case in `tests/engine/every_channel.rs`; a test requires
//! a line in `scene/manual.md`. A new requirement or quantity needs further changes, which the compiler and the tests report.

use super::quantity::Quantity;
use super::table::table;
use crate::animation::{Notation, ValueKind};

/// The requirement for an entity, a camera or the scene to have a property.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) enum Requirement {
    /// No requirement: every entity has a transform.
    Transform,
    /// An entity that points neither to an entity ([`LookAt`](super::LookAt)) nor to a point ([`Target`](super::Target)).
    Rotation,
    /// A shape that is a sphere, a cylinder or a capsule.
    Radius,
    /// A shape that is a box.
    Box,
    /// A shape that is a plane.
    Plane,
    /// A shape of any kind.
    Shape,
    /// A surface: a material of the scene file, or the material of an entity with a shape.
    Material,
    /// A surface with highlights.
    Specular,
    /// A surface that reflects.
    Reflective,
    /// A surface that refracts.
    Refractive,
    /// A surface with a pattern.
    Pattern,
    /// A surface with a pattern that has a size.
    SizedPattern,
    /// A surface with a pattern that has a direction.
    DirectedPattern,
    /// A surface with stripes.
    Stripes,
    /// A surface with bricks.
    Bricks,
    /// A surface with noise.
    Noise,
    /// A surface that gives off light.
    Emission,
    /// A light of any kind.
    Light,
    /// A directional light.
    DirectionalLight,
    /// A spot light.
    SpotLight,
    /// A light with a falloff.
    Falloff,
    /// An area light that is a sphere.
    SphereLight,
    /// An area light that is a rectangle.
    RectangleLight,
    /// Any camera.
    Camera,
    /// A camera that does not look at an entity ([`LookAt`](super::LookAt)), or another entity that points to a point
    /// ([`Target`](super::Target)).
    Target,
    /// A camera that does not look at an entity.
    View,
    /// A camera with a vertical field of view.
    FieldOfView,
    /// A camera with a horizontal field of view.
    HorizontalFieldOfView,
    /// A camera with an orthographic view.
    Orthographic,
    /// A camera with a screen.
    Screen,
    /// A camera with a screen whose width is given.
    ScreenWidth,
    /// A camera with a lens.
    Lens,
    /// A camera with a lens that does not focus on an entity ([`FocusOn`](super::FocusOn)).
    Focus,
    /// The scene.
    AmbientLight,
    /// The scene, with a background of one colour.
    FlatBackground,
    /// The scene, with a gradient background.
    Gradient,
    /// The scene, with a gradient background that has a horizon.
    Horizon,
    /// The scene, with a sun.
    Sun,
    /// The scene, with stars.
    Stars,
    /// The scene, with fog.
    Fog,
    /// The scene, with fog that has a height.
    FogLayer,
}

table! {
    /// A value of an entity that a [`Motion`](super::Motion) can drive. Angles are in radians, light is linear.
    #[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
    pub enum Property: (Requirement, Quantity) {
        /// [`Transform::translation`](super::Transform::translation).
        Translation => (Requirement::Transform, Quantity::Point),
        /// [`Transform::rotation`](super::Transform::rotation).
        Rotation => (Requirement::Rotation, Quantity::Rotation),
        /// [`Transform::scale`](super::Transform::scale).
        Scale => (Requirement::Transform, Quantity::Factors),
        /// The radius of a [`Shape::Sphere`](super::Shape), a `Cylinder` or a `Capsule`.
        Radius => (Requirement::Radius, Quantity::Length),
        /// The edges of a [`Shape::Box`](super::Shape).
        Size => (Requirement::Box, Quantity::Edges),
        /// The normal of a [`Shape::Plane`](super::Shape).
        Normal => (Requirement::Plane, Quantity::Direction),
        /// [`Visibility::camera`](super::Visibility::camera).
        Visible => (Requirement::Shape, Quantity::Flag),
        /// [`Visibility::shadow`](super::Visibility::shadow).
        CastsShadow => (Requirement::Shape, Quantity::Flag),
        /// [`Visibility::secondary`](super::Visibility::secondary).
        InReflections => (Requirement::Shape, Quantity::Flag),
        /// [`Material::k_a`](super::Material::k_a).
        Ka => (Requirement::Material, Quantity::Coefficient),
        /// [`Material::k_d`](super::Material::k_d).
        Kd => (Requirement::Material, Quantity::Coefficient),
        /// [`Material::color`](super::Material::color).
        Color => (Requirement::Material, Quantity::Color),
        /// [`Material::ambient_color`](super::Material::ambient_color).
        AmbientColor => (Requirement::Material, Quantity::Color),
        /// [`Specular::k_s`](super::Specular::k_s).
        Ks => (Requirement::Specular, Quantity::Coefficient),
        /// [`Specular::shininess`](super::Specular::shininess).
        Shininess => (Requirement::Specular, Quantity::Shininess),
        /// [`Reflective::k_r`](super::Reflective::k_r).
        Kr => (Requirement::Reflective, Quantity::Coefficient),
        /// [`Refractive::k_t`](super::Refractive::k_t).
        Kt => (Requirement::Refractive, Quantity::Coefficient),
        /// [`Refractive::ior`](super::Refractive::ior).
        Ior => (Requirement::Refractive, Quantity::RefractiveIndex),
        /// [`Refractive::absorption`](super::Refractive::absorption).
        Absorption => (Requirement::Refractive, Quantity::Absorption),
        /// [`Pattern::color`](super::Pattern::color).
        PatternColor => (Requirement::Pattern, Quantity::Color),
        /// The size of a [`PatternKind`](super::PatternKind).
        PatternSize => (Requirement::SizedPattern, Quantity::Length),
        /// The direction of a [`PatternKind`](super::PatternKind).
        PatternDirection => (Requirement::DirectedPattern, Quantity::Direction),
        /// The offset of a [`PatternKind`](super::PatternKind) along its direction.
        PatternOffset => (Requirement::DirectedPattern, Quantity::Coordinate),
        /// The ratio of [`PatternKind::Stripes`](super::PatternKind).
        StripeRatio => (Requirement::Stripes, Quantity::StripeRatio),
        /// The size of [`PatternKind::Bricks`](super::PatternKind).
        BrickSize => (Requirement::Bricks, Quantity::Edges),
        /// The mortar of [`PatternKind::Bricks`](super::PatternKind).
        Mortar => (Requirement::Bricks, Quantity::Mortar),
        /// The contrast of [`PatternKind::Noise`](super::PatternKind).
        NoiseContrast => (Requirement::Noise, Quantity::Contrast),
        /// [`Emission`](super::Emission).
        Emission => (Requirement::Emission, Quantity::Light),
        /// [`Light::intensity`](super::Light::intensity).
        Intensity => (Requirement::Light, Quantity::Light),
        /// The direction of a [`LightKind::Directional`](super::LightKind).
        Direction => (Requirement::DirectionalLight, Quantity::Direction),
        /// The angle of a [`LightKind::Spot`](super::LightKind).
        Angle => (Requirement::SpotLight, Quantity::SpotAngle),
        /// The softness of a [`LightKind::Spot`](super::LightKind).
        Softness => (Requirement::SpotLight, Quantity::Softness),
        /// The coefficients c0, c1, c2 of a [`Falloff`](super::Falloff).
        Falloff => (Requirement::Falloff, Quantity::Falloff),
        /// The radius of an [`AreaShape::Sphere`](super::AreaShape).
        LightRadius => (Requirement::SphereLight, Quantity::Length),
        /// The width of an [`AreaShape::Rectangle`](super::AreaShape).
        LightWidth => (Requirement::RectangleLight, Quantity::Length),
        /// The height of an [`AreaShape::Rectangle`](super::AreaShape).
        LightHeight => (Requirement::RectangleLight, Quantity::Length),
        /// [`Camera::position`](super::Camera::position).
        Position => (Requirement::Camera, Quantity::Point),
        /// [`View::Target`](super::View::Target), or [`Target`](super::Target) of an entity without a camera.
        Target => (Requirement::Target, Quantity::Point),
        /// [`View::Direction`](super::View::Direction).
        View => (Requirement::View, Quantity::Direction),
        /// [`Camera::up`](super::Camera::up).
        Up => (Requirement::Camera, Quantity::Direction),
        /// [`Camera::roll`](super::Camera::roll).
        Roll => (Requirement::Camera, Quantity::Turn),
        /// The angle of a [`Projection::FieldOfView`](super::Projection).
        Fov => (Requirement::FieldOfView, Quantity::FieldOfView),
        /// The angle of a [`Projection::HorizontalFieldOfView`](super::Projection).
        HorizontalFov => (Requirement::HorizontalFieldOfView, Quantity::FieldOfView),
        /// The height of a [`Projection::Orthographic`](super::Projection).
        Orthographic => (Requirement::Orthographic, Quantity::Length),
        /// The distance of a [`Projection::Screen`](super::Projection).
        ScreenDistance => (Requirement::Screen, Quantity::Length),
        /// The width of a [`Projection::Screen`](super::Projection), if given.
        ScreenWidth => (Requirement::ScreenWidth, Quantity::Length),
        /// The height of a [`Projection::Screen`](super::Projection).
        ScreenHeight => (Requirement::Screen, Quantity::Length),
        /// [`Lens::aperture`](super::Lens::aperture).
        Aperture => (Requirement::Lens, Quantity::Aperture),
        /// [`Lens::focus`](super::Lens::focus).
        Focus => (Requirement::Focus, Quantity::Length),
        /// [`Ambient`](super::Ambient).
        Ambient => (Requirement::AmbientLight, Quantity::Light),
        /// The colour of a [`Background::Flat`](super::Background).
        Background => (Requirement::FlatBackground, Quantity::Color),
        /// The bottom of a [`Background::Gradient`](super::Background).
        BackgroundBottom => (Requirement::Gradient, Quantity::Color),
        /// The horizon of a [`Background::Gradient`](super::Background), if given.
        BackgroundHorizon => (Requirement::Horizon, Quantity::Color),
        /// The top of a [`Background::Gradient`](super::Background).
        BackgroundTop => (Requirement::Gradient, Quantity::Color),
        /// [`Sun::direction`](super::Sun::direction).
        SunDirection => (Requirement::Sun, Quantity::Direction),
        /// [`Sun::intensity`](super::Sun::intensity).
        SunIntensity => (Requirement::Sun, Quantity::Light),
        /// [`Sun::size`](super::Sun::size).
        SunSize => (Requirement::Sun, Quantity::AngularSize),
        /// [`Sun::glow`](super::Sun::glow).
        SunGlow => (Requirement::Sun, Quantity::Coefficient),
        /// [`Sun::glow_size`](super::Sun::glow_size).
        SunGlowSize => (Requirement::Sun, Quantity::AngularSize),
        /// [`Stars::intensity`](super::Stars::intensity).
        StarsIntensity => (Requirement::Stars, Quantity::Light),
        /// [`Stars::size`](super::Stars::size).
        StarsSize => (Requirement::Stars, Quantity::AngularSize),
        /// [`Fog::color`](super::Fog::color).
        FogColor => (Requirement::Fog, Quantity::Color),
        /// [`Fog::density`](super::Fog::density).
        FogDensity => (Requirement::Fog, Quantity::Density),
        /// [`Fog::height`](super::Fog::height), if given.
        FogHeight => (Requirement::FogLayer, Quantity::Length),
        /// [`Fog::level`](super::Fog::level) of fog with a height.
        FogLevel => (Requirement::FogLayer, Quantity::Coordinate),
    }
}

impl Property {
    /// Returns the property with the given name.
    pub(crate) fn named(name: &str) -> Option<Self> {
        Self::ALL.into_iter().find(|property| property.name() == name)
    }

    /// Returns the name of the property in scene files.
    #[must_use]
    pub const fn name(self) -> &'static str {
        self.row().0
    }

    /// Returns the requirement for having the property.
    pub(crate) const fn part(self) -> Requirement {
        self.row().1.0
    }

    /// Returns the position whose direction of motion can be its value.
    pub(crate) const fn along(self) -> Option<Self> {
        match self {
            Self::View => Some(Self::Position),
            Self::Rotation => Some(Self::Translation),
            _ => None,
        }
    }

    /// Returns the quantity of its values.
    pub(crate) const fn quantity(self) -> Quantity {
        self.row().1.1
    }

    /// Returns the notation of its values in scene files and scripts.
    #[must_use]
    pub const fn notation(self) -> Notation {
        self.quantity().notation()
    }

    /// Returns the kind of its values.
    #[must_use]
    pub const fn kind(self) -> ValueKind {
        self.notation().kind()
    }
}
