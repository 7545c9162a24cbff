//! Checks that animated entities, materials and cameras have the animated property.

use super::{At, Named, Problems};
use crate::components::{Property, Requirement};
use crate::scene::document::{
    AnimationDocument, AreaShapeDocument, BackgroundDocument, CameraDocument, LightDocument,
    MaterialDocument, PatternDocument, SceneDocument, ShapeDocument,
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
                lack_of_scene(document, property.part())
            } else if let Some((_, camera)) = document.named_cameras().find(|(known, _)| *known == name) {
                lack_of_camera(camera, property.part())
            } else if name == SceneDocument::CAMERA && !scope.is_scene() {
                // A file may animate a camera that it does not have; the animation is dropped where the file is included.
                None
            } else {
                match scope.entity(name) {
                    Lookup::Found(entity) => lack_of_entity(entity, property.part()),
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
        _ if !of_material(property.part()) => {
            unfit(property, "a material", &animation.field("channel"), problems);
        }
        Lookup::Found(material) => {
            if let Some((message, label, help)) = missing(material, property.part()) {
                problems.add(at, message, label, help);
            }
        }
        Lookup::Unread => {}
    }
}

/// Returns a description of the scene if it lacks the part.
fn lack_of_scene(document: &SceneDocument, part: Requirement) -> Option<&'static str> {
    use BackgroundDocument::{Flat, Gradient, Stops};
    let background = &document.background;
    let kind = match background {
        Flat(_) => "a background of one colour",
        Gradient { .. } => "a background of two colours",
        Stops(_) => "a background of `stops`",
    };
    let (fits, otherwise) = match part {
        Requirement::AmbientLight => return None,
        Requirement::FlatBackground => (matches!(background, Flat(_)), kind),
        Requirement::Gradient => (matches!(background, Gradient { .. }), kind),
        Requirement::Horizon => {
            (matches!(background, Gradient { horizon: Some(_), .. }), "a background without a `horizon`")
        }
        Requirement::Sun => (document.sun.is_some(), "a scene without a `sun`"),
        Requirement::Stars => (document.stars.is_some(), "a scene without `stars`"),
        Requirement::Fog => (document.fog.is_some(), "a scene without `fog`"),
        Requirement::FogLayer => (
            document.fog.is_some_and(|fog| fog.height.is_some()),
            "a scene without a fog that has a `height`",
        ),
        _ => (false, "the scene"),
    };
    (!fits).then_some(otherwise)
}

/// Returns a description of the camera if it lacks the part.
fn lack_of_camera(camera: &CameraDocument, part: Requirement) -> Option<&'static str> {
    let screen = camera.screen.as_ref();
    let (fits, otherwise) = match part {
        Requirement::Camera => return None,
        Requirement::Target | Requirement::View => (camera.look_at.is_none(), "a camera with `look_at`"),
        Requirement::FieldOfView if screen.is_some() => (false, "a camera with a `screen`"),
        Requirement::FieldOfView if camera.horizontal_fov.is_some() => {
            (false, "a camera with `horizontal_fov`")
        }
        Requirement::FieldOfView => (camera.orthographic.is_none(), "an `orthographic` camera"),
        Requirement::Orthographic => (camera.orthographic.is_some(), "a camera that is not `orthographic`"),
        Requirement::HorizontalFieldOfView => {
            (camera.horizontal_fov.is_some(), "a camera without `horizontal_fov`")
        }
        Requirement::Screen => (screen.is_some(), "a camera without a `screen`"),
        Requirement::ScreenWidth if screen.is_none() => (false, "a camera without a `screen`"),
        Requirement::ScreenWidth => {
            (screen.is_some_and(|screen| screen.width.is_some()), "a screen without a `width`")
        }
        Requirement::Focus if camera.focus_on.is_some() => (false, "a camera with `focus_on`"),
        Requirement::Lens | Requirement::Focus => (camera.lens.is_some(), "a camera without a `lens`"),
        _ => (false, "the camera"),
    };
    (!fits).then_some(otherwise)
}

/// Returns a description of the entity if it lacks the part.
fn lack_of_entity(entity: KnownEntity<'_>, part: Requirement) -> Option<&'static str> {
    use ShapeDocument::{Box, Capsule, Cylinder, Plane, Sphere};
    let lacks = |material: Option<&MaterialDocument>| material.is_none_or(|material| lacks(material, part));
    let (fits, otherwise) = match part {
        Requirement::Transform => return None,
        Requirement::Rotation | Requirement::Target if entity.looks_at => (false, "an entity with `look_at`"),
        Requirement::Rotation => (!entity.has_target, "an entity with a `target`"),
        Requirement::Target => (entity.has_target, "an entity without a `target`"),
        Requirement::Radius => {
            let has_radius = matches!(entity.shape, Some(Sphere { .. } | Cylinder(_) | Capsule(_)));
            (has_radius, "an entity that is no sphere, cylinder or capsule")
        }
        Requirement::Box => (matches!(entity.shape, Some(Box { .. })), "an entity that is no box"),
        Requirement::Plane => (matches!(entity.shape, Some(Plane { .. })), "an entity that is no plane"),
        Requirement::Material | Requirement::Shape => (entity.shape.is_some(), "an entity without a shape"),
        Requirement::Specular => (!lacks(entity.material), "an entity that is not specular"),
        Requirement::Reflective => (!lacks(entity.material), "an entity that does not mirror"),
        Requirement::Refractive => (!lacks(entity.material), "an entity that is not refractive"),
        Requirement::Pattern | Requirement::SizedPattern => {
            (!lacks(entity.material), "an entity without a pattern")
        }
        Requirement::DirectedPattern => (!lacks(entity.material), "an entity without stripes or a gradient"),
        Requirement::Stripes => (!lacks(entity.material), "an entity without stripes"),
        Requirement::Bricks => (!lacks(entity.material), "an entity without bricks"),
        Requirement::Noise => (!lacks(entity.material), "an entity without noise"),
        Requirement::Emission => (!lacks(entity.material), "an entity that gives off no light"),
        _ => return lack_of_light(entity.light, part),
    };
    (!fits).then_some(otherwise)
}

/// Returns a description of the entity if its light lacks the part.
fn lack_of_light(light: Option<&LightDocument>, part: Requirement) -> Option<&'static str> {
    use AreaShapeDocument::{Rectangle, Sphere};
    use LightDocument::{Area, Directional, Point, Spot};
    let (fits, otherwise) = match part {
        Requirement::Light => (light.is_some(), "an entity without a light"),
        Requirement::DirectionalLight => {
            (matches!(light, Some(Directional { .. })), "an entity without a directional light")
        }
        Requirement::SpotLight => (matches!(light, Some(Spot { .. })), "an entity without a Spot light"),
        Requirement::Falloff => {
            let weakens = matches!(
                light,
                Some(
                    Point { falloff: Some(_), .. }
                        | Spot { falloff: Some(_), .. }
                        | Area { falloff: Some(_), .. }
                )
            );
            (weakens, "an entity without a light with `falloff`")
        }
        Requirement::SphereLight => {
            let is_sphere = matches!(light, Some(Area { shape: Sphere { .. }, .. }));
            (is_sphere, "an entity without an Area light of the shape Sphere")
        }
        Requirement::RectangleLight => {
            let is_rectangle = matches!(light, Some(Area { shape: Rectangle { .. }, .. }));
            (is_rectangle, "an entity without an Area light of the shape Rectangle")
        }
        _ => (false, "an entity"),
    };
    (!fits).then_some(otherwise)
}

fn of_material(part: Requirement) -> bool {
    use Requirement::{
        Bricks, DirectedPattern, Emission, Material, Noise, Pattern, Reflective, Refractive, SizedPattern,
        Specular, Stripes,
    };
    let is_pattern = matches!(part, Pattern | SizedPattern | DirectedPattern | Stripes | Bricks | Noise);
    is_pattern || matches!(part, Material | Specular | Reflective | Refractive | Emission)
}

fn lacks(material: &MaterialDocument, part: Requirement) -> bool {
    missing(material, part).is_some()
}

/// Returns message, label and help if the material lacks an optional part.
fn missing(
    material: &MaterialDocument,
    part: Requirement,
) -> Option<(&'static str, &'static str, &'static str)> {
    match part {
        Requirement::Specular if material.specular.is_none() => Some((
            "a material that is not specular has neither k_s nor shininess",
            "not specular",
            "add `specular: (k_s: .., shininess: ..)` to the material",
        )),
        Requirement::Reflective if material.reflective.is_none() => Some((
            "a material that does not mirror has no k_r",
            "not reflective",
            "add `reflective: (k_r: ..)` to the material",
        )),
        Requirement::Refractive if material.refractive.is_none() => Some((
            "a material that is not refractive has neither k_t, ior nor absorption",
            "not refractive",
            "add `refractive: (k_t: .., ior: ..)` to the material",
        )),
        Requirement::Pattern
        | Requirement::SizedPattern
        | Requirement::DirectedPattern
        | Requirement::Stripes
        | Requirement::Bricks
        | Requirement::Noise => missing_in_pattern(material.pattern.as_ref(), part),
        Requirement::Emission if material.emission.is_none() => Some((
            "a material that gives off no light has no emission",
            "not emissive",
            "add `emission: (1, 1, 1)` to the material",
        )),
        _ => None,
    }
}

/// Returns message, label and help if the pattern lacks a part.
fn missing_in_pattern(
    pattern: Option<&PatternDocument>,
    part: Requirement,
) -> Option<(&'static str, &'static str, &'static str)> {
    use PatternDocument::{Bricks, Gradient, Noise, Stripes};
    let (fits, message, label, help) = match part {
        Requirement::Stripes => (
            matches!(pattern, Some(Stripes { .. })),
            "a material without stripes has no StripeRatio",
            "no stripes",
            "write `pattern: Stripes(color: .., size: ..)` in the material",
        ),
        Requirement::DirectedPattern => (
            matches!(pattern, Some(Stripes { .. } | Gradient { .. })),
            "a material without stripes or a gradient has neither PatternDirection nor PatternOffset",
            "neither stripes nor a gradient",
            "write `pattern: Stripes(color: .., size: ..)` or `pattern: Gradient(color: .., size: ..)` in the material",
        ),
        Requirement::Bricks => (
            matches!(pattern, Some(Bricks { .. })),
            "a material without bricks has neither BrickSize nor Mortar",
            "no bricks",
            "write `pattern: Bricks(color: .., size: .., mortar: ..)` in the material",
        ),
        Requirement::Noise => (
            matches!(pattern, Some(Noise { .. })),
            "a material without noise has no NoiseContrast",
            "no noise",
            "write `pattern: Noise(color: .., size: ..)` in the material",
        ),
        Requirement::SizedPattern if matches!(pattern, Some(Bricks { .. })) => (
            false,
            "bricks have three sizes",
            "bricks",
            "write `channel: BrickSize`, and three numbers in each key",
        ),
        _ => (
            pattern.is_some(),
            "a material without a pattern has neither its colour nor its size",
            "no pattern",
            "add `pattern: Checker(color: .., size: ..)` to the material",
        ),
    };
    (!fits).then_some((message, label, help))
}

fn unfit(property: Property, what: &str, at: &At<'_>, problems: &mut Problems) {
    let message = format!("{what} has no {}", property.name());
    problems.add(at, message, "not here", home(property.part()));
}

/// Returns a description of the elements that have the part.
fn home(part: Requirement) -> &'static str {
    match part {
        Requirement::Transform => "entities have it; cameras have Position and Target",
        Requirement::Rotation => {
            "entities have it that have neither `target` nor `look_at`; cameras have Position and Target"
        }
        Requirement::Target => "cameras have it: `target: \"camera\"`; and entities with a `target`",
        Requirement::Radius => "entities with the shape Sphere, Cylinder or Capsule have it",
        Requirement::Box => "entities with the shape Box have it",
        Requirement::Plane => "entities with the shape Plane have it",
        Requirement::Shape => "entities with a shape have it, each for itself",
        Requirement::Material | Requirement::Reflective => "materials have it, and entities with a shape",
        Requirement::Specular => "materials that are specular have it, and entities made of them",
        Requirement::Refractive => "materials that are refractive have it, and entities made of them",
        Requirement::Pattern => "materials with a `pattern` have it, and entities made of them",
        Requirement::SizedPattern => {
            "materials with a `pattern` have it, and entities made of them; Bricks have BrickSize"
        }
        Requirement::DirectedPattern => {
            "materials with the pattern Stripes or Gradient have it, and entities made of them"
        }
        Requirement::Stripes => "materials with the pattern Stripes have it, and entities made of them",
        Requirement::Bricks => "materials with the pattern Bricks have it, and entities made of them",
        Requirement::Noise => "materials with the pattern Noise have it, and entities made of them",
        Requirement::Emission => "materials with `emission` have it, and entities made of them",
        Requirement::Light | Requirement::DirectionalLight => "entities with a light have it",
        Requirement::SpotLight => "entities with a Spot light have it",
        Requirement::Falloff => "lights with `falloff` have it: add `falloff: (1, 0, 0)` to the light",
        Requirement::SphereLight => "entities with an Area light of the shape Sphere have it",
        Requirement::RectangleLight => "entities with an Area light of the shape Rectangle have it",
        Requirement::Camera | Requirement::View => {
            "cameras have it: `target: \"camera\"`; entities have Translation"
        }
        Requirement::FieldOfView => {
            "the camera has it where it has no `screen`, `horizontal_fov` or `orthographic`"
        }
        Requirement::Orthographic => "the camera has it where it has `orthographic`",
        Requirement::HorizontalFieldOfView => "the camera has it where it has `horizontal_fov`",
        Requirement::Screen => "the camera has it where it has a `screen`",
        Requirement::ScreenWidth => "the camera has it where its `screen` has a `width`",
        Requirement::Lens => "the camera has it where it has a `lens`",
        Requirement::Focus => "the camera has it where it has a `lens` and no `focus_on`",
        Requirement::AmbientLight => "the scene has it: `target: \"scene\"`",
        Requirement::FlatBackground => "the scene has it where its background is one colour",
        Requirement::Gradient => "the scene has it where its background is `(bottom: .., top: ..)`",
        Requirement::Horizon => {
            "the scene has it where its background is `(bottom: .., horizon: .., top: ..)`"
        }
        Requirement::Sun => "the scene has it where it has a `sun`",
        Requirement::Stars => "the scene has it where it has `stars`",
        Requirement::Fog => "the scene has it where it has `fog`",
        Requirement::FogLayer => "the scene has it where its `fog` has a `height`",
    }
}
