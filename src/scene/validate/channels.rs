//! Has what is animated such a value?

use super::{At, Named, Problems};
use crate::components::Property;
use crate::scene::document::{
    AnimationDocument, AreaShapeDocument, BackgroundDocument, CameraDocument, LightDocument,
    MaterialDocument, SceneDocument, ShapeDocument,
};
use crate::scene::files::{KnownEntity, Lookup, Scope};

pub(super) fn target(
    document: &SceneDocument,
    scope: Scope<'_>,
    animation: &AnimationDocument,
    at: &At<'_>,
    problems: &mut Problems,
) {
    let property = animation.channel.0;
    match (animation.target.as_deref(), animation.material.as_deref()) {
        (Some(_), Some(_)) => {
            problems.add(
                &at.field("material"),
                "an animation of both an entity and a material",
                "one too many",
                "write one animation for each",
            );
        }
        (None, None) => {
            problems.add(
                at,
                "an animation of nothing",
                "neither `target` nor `material`",
                "add `target: \"name\"` of an entity, or \"camera\" or \"scene\", or `material: \"name\"`",
            );
        }
        (None, Some(name)) => material_target(scope, property, name, at, problems),
        (Some(name), None) => {
            let lack = if name == SceneDocument::SCENE {
                lack_of_scene(document, property)
            } else if let Some((_, camera)) = document.named_cameras().find(|(known, _)| *known == name) {
                lack_of_camera(camera, property)
            } else if name == SceneDocument::CAMERA && !scope.is_scene() {
                // A part for whose camera there is no place yet.
                None
            } else {
                match scope.entity(name) {
                    Lookup::Found(entity) => lack_of_entity(entity, property),
                    Lookup::Unread => None,
                    Lookup::Missing => {
                        let cameras = document.named_cameras().map(|(name, _)| name.into());
                        let known = scope.entity_names().into_iter().chain(cameras);
                        let known = || known.chain([SceneDocument::SCENE.into()]).collect();
                        problems.add_unknown(&at.field("target"), Named::Entity, name, known);
                        None
                    }
                }
            };
            if let Some(what) = lack {
                unfit(property, what, &at.field("channel"), problems);
            }
        }
    }
}

fn material_target(
    scope: Scope<'_>,
    property: Property,
    name: &str,
    animation: &At<'_>,
    problems: &mut Problems,
) {
    let at = &animation.field("material");
    match scope.material(name) {
        Lookup::Missing => problems.add_unknown(at, Named::Material, name, || scope.material_names()),
        _ if !of_material(property) => unfit(property, "a material", &animation.field("channel"), problems),
        Lookup::Found(material) => {
            if let Some(part) = Part::with(property).filter(|part| !part.is_of(material)) {
                let (message, label, help) = part.missing();
                problems.add(at, message, label, help);
            }
        }
        Lookup::Unread => {}
    }
}

/// What the scene is that lacks the value, if it does.
fn lack_of_scene(document: &SceneDocument, property: Property) -> Option<&'static str> {
    let flat = matches!(document.background, BackgroundDocument::Flat(_));
    match property {
        Property::Ambient => None,
        Property::Background if flat => None,
        Property::Background => Some("a background of two colours"),
        Property::BackgroundBottom | Property::BackgroundTop if !flat => None,
        Property::BackgroundBottom | Property::BackgroundTop => Some("a background of one colour"),
        Property::FogColor | Property::FogDensity if document.fog.is_some() => None,
        Property::FogColor | Property::FogDensity => Some("a scene without `fog`"),
        _ => Some("the scene"),
    }
}

/// What the camera is that lacks the value, if it does.
fn lack_of_camera(camera: &CameraDocument, property: Property) -> Option<&'static str> {
    match (property, &camera.screen) {
        (Property::Target | Property::View, _) if camera.look_at.is_some() => Some("a camera with `look_at`"),
        (Property::Position | Property::Target | Property::View | Property::Up | Property::Roll, _)
        | (Property::Fov, None)
        | (Property::ScreenDistance | Property::ScreenHeight, Some(_)) => None,
        (Property::Fov, Some(_)) => Some("a camera with a `screen`"),
        (Property::ScreenWidth, Some(screen)) if screen.width.is_some() => None,
        (Property::ScreenWidth, Some(_)) => Some("a screen without a `width`"),
        (Property::ScreenDistance | Property::ScreenWidth | Property::ScreenHeight, None) => {
            Some("a camera without a `screen`")
        }
        (Property::Aperture | Property::Focus, _) if camera.lens.is_some() => None,
        (Property::Aperture | Property::Focus, _) => Some("a camera without a `lens`"),
        _ => Some("the camera"),
    }
}

/// What the entity is that lacks the value, if it does.
fn lack_of_entity(entity: KnownEntity<'_>, property: Property) -> Option<&'static str> {
    match property {
        Property::Translation | Property::Rotation | Property::Scale => None,
        Property::Radius | Property::Size | Property::Normal => match (property, entity.shape) {
            (Property::Radius, Some(ShapeDocument::Sphere { .. }))
            | (Property::Size, Some(ShapeDocument::Box { .. }))
            | (Property::Normal, Some(ShapeDocument::Plane { .. })) => None,
            (Property::Radius, _) => Some("an entity that is no sphere"),
            (Property::Size, _) => Some("an entity that is no box"),
            _ => Some("an entity that is no plane"),
        },
        _ if of_light(property) => lack_of_light(entity.light, property),
        _ if of_material(property) => match Part::with(property) {
            Some(part) if entity.material.is_none_or(|material| !part.is_of(material)) => {
                Some(part.entity_without())
            }
            None if entity.shape.is_none() => Some("an entity without a shape"),
            _ => None,
        },
        _ => Some("an entity"),
    }
}

/// What the entity is whose light lacks the value, if it does.
fn lack_of_light(light: Option<&LightDocument>, property: Property) -> Option<&'static str> {
    use AreaShapeDocument::{Rectangle, Sphere};
    use LightDocument::{Area, Directional, Point, Spot};
    match (property, light) {
        (Property::Intensity, Some(_))
        | (Property::Direction, Some(Directional { .. }))
        | (Property::Angle | Property::Softness, Some(Spot { .. }))
        | (
            Property::Falloff,
            Some(
                Point { falloff: Some(_), .. }
                | Spot { falloff: Some(_), .. }
                | Area { falloff: Some(_), .. },
            ),
        )
        | (Property::LightRadius, Some(Area { shape: Sphere { .. }, .. }))
        | (Property::LightWidth | Property::LightHeight, Some(Area { shape: Rectangle { .. }, .. })) => None,
        (Property::Intensity, None) => Some("an entity without a light"),
        (Property::Direction, _) => Some("an entity without a directional light"),
        (Property::Falloff, _) => Some("an entity without a light with `falloff`"),
        (Property::LightRadius, _) => Some("an entity without an Area light of the shape Sphere"),
        (Property::LightWidth | Property::LightHeight, _) => {
            Some("an entity without an Area light of the shape Rectangle")
        }
        _ => Some("an entity without a Spot light"),
    }
}

fn of_light(property: Property) -> bool {
    matches!(
        property,
        Property::Intensity
            | Property::Direction
            | Property::Angle
            | Property::Softness
            | Property::Falloff
            | Property::LightRadius
            | Property::LightWidth
            | Property::LightHeight
    )
}

/// What not every material has.
#[derive(Clone, Copy, Debug)]
enum Part {
    Specular,
    Reflective,
    Refractive,
    Checker,
}

impl Part {
    /// The part that has a value, if it is in one.
    fn with(property: Property) -> Option<Self> {
        match property {
            Property::Ks | Property::Shininess => Some(Self::Specular),
            Property::Kr => Some(Self::Reflective),
            Property::Kt | Property::Ior | Property::Absorption => Some(Self::Refractive),
            Property::CheckerColor | Property::CheckerSize => Some(Self::Checker),
            _ => None,
        }
    }

    fn is_of(self, material: &MaterialDocument) -> bool {
        match self {
            Self::Specular => material.specular.is_some(),
            Self::Reflective => material.reflective.is_some(),
            Self::Refractive => material.refractive.is_some(),
            Self::Checker => material.checker.is_some(),
        }
    }

    /// Message, label and help for a material that lacks it.
    fn missing(self) -> (&'static str, &'static str, &'static str) {
        match self {
            Self::Specular => (
                "a material that is not specular has neither k_s nor shininess",
                "not specular",
                "add `specular: (k_s: .., shininess: ..)` to the material",
            ),
            Self::Reflective => (
                "a material that does not mirror has no k_r",
                "not reflective",
                "add `reflective: (k_r: ..)` to the material",
            ),
            Self::Refractive => (
                "a material that is not refractive has neither k_t, ior nor absorption",
                "not refractive",
                "add `refractive: (k_t: .., ior: ..)` to the material",
            ),
            Self::Checker => (
                "a material without squares has neither their colour nor their size",
                "not chequered",
                "add `checker: (color: .., size: ..)` to the material",
            ),
        }
    }

    fn entity_without(self) -> &'static str {
        match self {
            Self::Specular => "an entity that is not specular",
            Self::Reflective => "an entity that does not mirror",
            Self::Refractive => "an entity that is not refractive",
            Self::Checker => "an entity that is not chequered",
        }
    }
}

fn of_material(property: Property) -> bool {
    Part::with(property).is_some()
        || matches!(property, Property::Ka | Property::Kd | Property::Color | Property::AmbientColor)
}

fn unfit(property: Property, what: &str, at: &At<'_>, problems: &mut Problems) {
    problems.add(at, format!("{what} has no {}", property.name()), "not here", home(property));
}

/// Where such a value is.
fn home(property: Property) -> &'static str {
    match property {
        Property::Translation | Property::Rotation | Property::Scale => {
            "entities have it; cameras have Position and Target"
        }
        Property::Radius => "entities with the shape Sphere have it",
        Property::Size => "entities with the shape Box have it",
        Property::Normal => "entities with the shape Plane have it",
        Property::Ka | Property::Kd | Property::Color | Property::AmbientColor | Property::Kr => {
            "materials have it, and entities with a shape"
        }
        Property::Ks | Property::Shininess => {
            "materials that are specular have it, and entities made of them"
        }
        Property::Kt | Property::Ior | Property::Absorption => {
            "materials that are refractive have it, and entities made of them"
        }
        Property::CheckerColor | Property::CheckerSize => {
            "materials with `checker` have it, and entities made of them"
        }
        Property::Intensity | Property::Direction => "entities with a light have it",
        Property::Angle | Property::Softness => "entities with a Spot light have it",
        Property::Falloff => "lights with `falloff` have it: add `falloff: (1, 0, 0)` to the light",
        Property::LightRadius => "entities with an Area light of the shape Sphere have it",
        Property::LightWidth | Property::LightHeight => {
            "entities with an Area light of the shape Rectangle have it"
        }
        Property::Position | Property::Target | Property::View | Property::Up | Property::Roll => {
            "cameras have it: `target: \"camera\"`; entities have Translation"
        }
        Property::Fov => "the camera has it where it has no `screen`",
        Property::ScreenDistance | Property::ScreenHeight => "the camera has it where it has a `screen`",
        Property::ScreenWidth => "the camera has it where its `screen` has a `width`",
        Property::Aperture | Property::Focus => "the camera has it where it has a `lens`",
        Property::Ambient => "the scene has it: `target: \"scene\"`",
        Property::Background => "the scene has it where its background is one colour",
        Property::BackgroundBottom | Property::BackgroundTop => {
            "the scene has it where its background is `(bottom: .., top: ..)`"
        }
        Property::FogColor | Property::FogDensity => "the scene has it where it has `fog`",
    }
}
