//! What moves, and its keys.

use std::collections::HashMap;

use super::entities::{CAMERA, rotation, scale};
use super::{At, Named, Problems, check};
use crate::components::Property;
use crate::scene::document::{
    AnimationDocument, EasingDocument, LightDocument, MaterialDocument, SceneDocument, TrackDocument,
    TracksDocument,
};
use crate::scene::include::{KnownEntity, Lookup, Scope};

pub(super) fn validate(document: &SceneDocument, scope: Scope<'_>, scene: &At<'_>, problems: &mut Problems) {
    let mut seen = HashMap::new();
    let list = scene.field("animate");
    for (index, animation) in document.animate.iter().enumerate() {
        let at = list.index(index);
        let target = (animation.target.as_deref(), animation.material.as_deref(), animation.channel.0);
        if seen.insert(target, index).is_some() {
            problems.add(
                &at.field("channel"),
                "the same value is animated twice",
                "again here",
                "put all keys into one track",
            );
        }
        self::target(scope, animation, &at, problems);
        self::tracks(animation, &at.field("track"), problems);
        playback(animation, &at, problems);
    }
}

fn playback(animation: &AnimationDocument, at: &At<'_>, problems: &mut Problems) {
    check::number(animation.offset, &at.field("offset"), problems);
    let at = at.field("speed");
    if check::number(animation.speed, &at, problems) && animation.speed == 0.0 {
        let help = "2 plays at double speed, 0.5 at half of it, -1 backwards";
        problems.add(&at, "at a speed of 0 nothing moves", "zero", help);
    }
}

fn target(scope: Scope<'_>, animation: &AnimationDocument, at: &At<'_>, problems: &mut Problems) {
    match (&animation.target, &animation.material) {
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
                "add `target: \"name\"` of an entity, or \"camera\", or `material: \"name\"`",
            );
        }
        (None, Some(name)) => {
            let at = at.field("material");
            match scope.material(name) {
                Lookup::Missing => {
                    problems.add_unknown(&at, Named::Material, name, || scope.material_names());
                }
                _ if !of_material(animation.channel.0) => {
                    unfit(animation.channel.0, "a material", &at, problems);
                }
                Lookup::Found(material) => {
                    if let Some(part) = Part::with(animation.channel.0).filter(|part| !part.is_of(material)) {
                        let (message, label, help) = part.missing();
                        problems.add(&at, message, label, help);
                    }
                }
                Lookup::Unread => {}
            }
        }
        (Some(name), None) if name == CAMERA => {
            if !matches!(animation.channel.0, Property::Position | Property::Target) {
                unfit(animation.channel.0, "the camera", &at.field("channel"), problems);
            }
        }
        (Some(name), None) => {
            let known = || scope.entity_names().into_iter().chain([CAMERA.into()]).collect();
            match scope.entity(name) {
                Lookup::Found(entity) => {
                    self::entity(&entity, animation.channel.0, &at.field("channel"), problems);
                }
                Lookup::Missing => {
                    problems.add_unknown(&at.field("target"), Named::Entity, name, known);
                }
                Lookup::Unread => {}
            }
        }
    }
}

fn entity(entity: &KnownEntity<'_>, property: Property, at: &At<'_>, problems: &mut Problems) {
    match property {
        Property::Translation | Property::Rotation | Property::Scale => {}
        Property::Position | Property::Target => {
            unfit(property, "an entity", at, problems);
        }
        Property::Intensity if entity.light.is_some() => {}
        Property::Direction if matches!(entity.light, Some(LightDocument::Directional { .. })) => {}
        Property::Intensity => {
            unfit(property, "an entity without a light", at, problems);
        }
        Property::Direction => {
            unfit(property, "an entity without a directional light", at, problems);
        }
        _ => match Part::with(property) {
            Some(part) if entity.material.is_none_or(|material| !part.is_of(material)) => {
                unfit(property, part.entity_without(), at, problems);
            }
            None if entity.shape.is_none() => {
                unfit(property, "an entity without a shape", at, problems);
            }
            _ => {}
        },
    }
}

/// What not every material has.
#[derive(Clone, Copy, Debug)]
enum Part {
    Specular,
    Reflective,
    Refractive,
}

impl Part {
    /// The part that has a channel's value, if it is in one.
    fn with(property: Property) -> Option<Self> {
        match property {
            Property::Ks | Property::Shininess => Some(Self::Specular),
            Property::Kr => Some(Self::Reflective),
            Property::Kt | Property::Ior | Property::Absorption => Some(Self::Refractive),
            _ => None,
        }
    }

    fn is_of(self, material: &MaterialDocument) -> bool {
        match self {
            Self::Specular => material.specular.is_some(),
            Self::Reflective => material.reflective.is_some(),
            Self::Refractive => material.refractive.is_some(),
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
        }
    }

    fn entity_without(self) -> &'static str {
        match self {
            Self::Specular => "an entity that is not specular",
            Self::Reflective => "an entity that does not mirror",
            Self::Refractive => "an entity that is not refractive",
        }
    }
}

fn of_material(property: Property) -> bool {
    Part::with(property).is_some()
        || matches!(property, Property::Ka | Property::Kd | Property::Color | Property::AmbientColor)
}

fn unfit(property: Property, what: &str, at: &At<'_>, problems: &mut Problems) {
    let help = match property {
        Property::Translation | Property::Rotation | Property::Scale => {
            "entities have it; the camera has Position and Target"
        }
        Property::Position | Property::Target => {
            "the camera has it: target: \"camera\"; entities have Translation"
        }
        Property::Intensity | Property::Direction => "entities with a light have it",
        Property::Ks | Property::Shininess => {
            "materials that are specular have it, and entities made of them"
        }
        Property::Kt | Property::Ior | Property::Absorption => {
            "materials that are refractive have it, and entities made of them"
        }
        Property::Ka | Property::Kd | Property::Color | Property::AmbientColor | Property::Kr => {
            "materials have it, and entities with a shape"
        }
    };
    problems.add(at, format!("{what} has no {}", property.name()), "not here", help);
}

fn tracks(animation: &AnimationDocument, at: &At<'_>, problems: &mut Problems) {
    let property = animation.channel.0;
    match &animation.track {
        TracksDocument::Number(track) => keys(track, at, problems, |value, at, problems| match property {
            Property::Shininess => check::shininess(*value, at, problems),
            Property::Ior => check::ior(*value, at, problems),
            _ => check::coefficient(*value, "a coefficient", at, problems),
        }),
        TracksDocument::Vector(track) => keys(track, at, problems, |value, at, problems| match property {
            Property::Intensity => check::intensity(*value, "the intensity", at, problems),
            Property::Absorption => check::absorption(*value, at, problems),
            Property::Direction => {
                check::direction(*value, "the direction", at, problems);
            }
            _ => {
                check::vector(*value, at, problems);
            }
        }),
        TracksDocument::Scale(track) => keys(track, at, problems, scale),
        TracksDocument::Rotation(track) => keys(track, at, problems, rotation),
        TracksDocument::Color(track) => keys(track, at, problems, |value, at, problems| {
            check::color(value.0, at, problems);
        }),
    }
}

fn keys<T>(
    track: &TrackDocument<T>,
    at: &At<'_>,
    problems: &mut Problems,
    value: impl Fn(&T, &At<'_>, &mut Problems),
) {
    let TrackDocument::Keys(keys) = track;
    let list = at.index(0);
    if keys.is_empty() {
        problems.add(&list, "a track without keys", "empty", "write at least one key, as (0, (0, 1, 0))");
    }
    let mut previous = f64::NEG_INFINITY;
    for (index, key) in keys.iter().enumerate() {
        let at = list.index(index);
        if check::number(key.time, &at.index(0), problems) {
            if key.time <= previous {
                let message = format!("a key at {} s follows one at {previous} s", key.time);
                problems.add(
                    &at.index(0),
                    message,
                    "not later",
                    "write keys in the order of their times, each time once",
                );
            }
            previous = key.time;
        }
        value(&key.value, &at.index(1), problems);
        easing(key.easing, &at.index(2), problems);
    }
}

fn easing(easing: EasingDocument, at: &At<'_>, problems: &mut Problems) {
    /// So that values stay far from overflow.
    const FARTHEST: f64 = 1000.0;
    match easing {
        EasingDocument::Steps(count) => {
            let help = "write how many equal jumps to make, as Steps(8)";
            check::count(count, u32::MAX, "the number of steps", help, &at.index(0), problems);
        }
        EasingDocument::Bezier(x1, y1, x2, y2) => {
            for (index, x) in [(0, x1), (2, x2)] {
                if !(0.0..=1.0).contains(&x) {
                    let message = format!("a handle's time must be from 0 to 1, not {x}");
                    let help =
                        "write Bezier(x1, y1, x2, y2), x being shares of the time, as in cubic-bezier of CSS";
                    problems.add(&at.index(index), message, "out of range", help);
                }
            }
            for (index, y) in [(1, y1), (3, y2)] {
                if !(-FARTHEST..=FARTHEST).contains(&y) {
                    let message =
                        format!("a handle's progress must be from -{FARTHEST} to {FARTHEST}, not {y}");
                    let help = "0 is at this key, 1 at the next; a little below or above swings beyond them";
                    problems.add(&at.index(index), message, "out of range", help);
                }
            }
        }
        _ => {}
    }
}
