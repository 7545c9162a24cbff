//! What moves, and its keys.

use std::collections::HashMap;

use super::entities::{CAMERA, rotation, scale};
use super::{At, Named, Problems, check};
use crate::scene::document::{
    AnimationDocument, ChannelDocument, EntityDocument, LightDocument, SceneDocument, TrackDocument,
    TracksDocument,
};

pub(super) fn validate(document: &SceneDocument, scene: &At<'_>, problems: &mut Problems) {
    let entities: HashMap<&str, &EntityDocument> =
        document.entities.iter().filter_map(|entity| Some((entity.name.as_deref()?, entity))).collect();
    let mut seen = HashMap::new();
    let list = scene.field("animate");
    for (index, animation) in document.animate.iter().enumerate() {
        let at = list.index(index);
        let target = (animation.target.as_deref(), animation.material.as_deref(), animation.channel);
        if seen.insert(target, index).is_some() {
            problems.add(
                &at.field("channel"),
                "the same value is animated twice",
                "again here",
                "put all keys into one track",
            );
        }
        self::target(document, &entities, animation, &at, problems);
        self::tracks(animation, &at.field("track"), problems);
    }
}

fn target(
    document: &SceneDocument,
    entities: &HashMap<&str, &EntityDocument>,
    animation: &AnimationDocument,
    at: &At<'_>,
    problems: &mut Problems,
) {
    let material = |name: &str| document.materials.0.iter().find(|(known, _)| known == name);
    let mirrors = |name: &str| material(name).is_some_and(|(_, material)| material.reflective.is_some());
    let shines = |name: &str| material(name).is_some_and(|(_, material)| material.specular.is_some());
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
            if material(name).is_none() {
                let known = || document.materials.0.iter().map(|(name, _)| name.as_str());
                problems.add_unknown(&at, Named::Material, name, known);
            } else if !of_material(animation.channel) {
                unfit(animation.channel, "a material", &at, problems);
            } else if animation.channel == ChannelDocument::Kr && !mirrors(name) {
                problems.add(
                    &at,
                    "a material that does not mirror has no k_r",
                    "not reflective",
                    "add `reflective: (k_r: ..)` to the material",
                );
            } else if of_highlights(animation.channel) && !shines(name) {
                problems.add(
                    &at,
                    "a material that is not specular has neither k_s nor shininess",
                    "not specular",
                    "add `specular: (k_s: .., shininess: ..)` to the material",
                );
            }
        }
        (Some(name), None) if name == CAMERA => {
            if !matches!(animation.channel, ChannelDocument::Position | ChannelDocument::Target) {
                unfit(animation.channel, "the camera", &at.field("channel"), problems);
            }
        }
        (Some(name), None) => {
            let Some(entity) = entities.get(name.as_str()) else {
                let named = || document.entities.iter().filter_map(|entity| entity.name.as_deref());
                problems.add_unknown(&at.field("target"), Named::Entity, name, || named().chain([CAMERA]));
                return;
            };
            let at = at.field("channel");
            match animation.channel {
                ChannelDocument::Translation | ChannelDocument::Rotation | ChannelDocument::Scale => {}
                ChannelDocument::Position | ChannelDocument::Target => {
                    unfit(animation.channel, "an entity", &at, problems);
                }
                ChannelDocument::Intensity if entity.light.is_some() => {}
                ChannelDocument::Direction
                    if matches!(entity.light, Some(LightDocument::Directional { .. })) => {}
                ChannelDocument::Intensity => {
                    unfit(animation.channel, "an entity without a light", &at, problems);
                }
                ChannelDocument::Direction => {
                    unfit(animation.channel, "an entity without a directional light", &at, problems);
                }
                ChannelDocument::Kr if entity.material.as_deref().is_some_and(mirrors) => {}
                ChannelDocument::Kr => {
                    unfit(animation.channel, "an entity that does not mirror", &at, problems);
                }
                channel if of_highlights(channel) => {
                    if !entity.material.as_deref().is_some_and(shines) {
                        unfit(channel, "an entity that is not specular", &at, problems);
                    }
                }
                _ if entity.shape.is_some() => {}
                _ => unfit(animation.channel, "an entity without a shape", &at, problems),
            }
        }
    }
}

fn of_material(channel: ChannelDocument) -> bool {
    use ChannelDocument as Channel;
    of_highlights(channel)
        || matches!(channel, Channel::Ka | Channel::Kd | Channel::Color | Channel::AmbientColor | Channel::Kr)
}

fn of_highlights(channel: ChannelDocument) -> bool {
    matches!(channel, ChannelDocument::Ks | ChannelDocument::Shininess)
}

fn unfit(channel: ChannelDocument, what: &str, at: &At<'_>, problems: &mut Problems) {
    use ChannelDocument as Channel;
    let help = match channel {
        Channel::Translation | Channel::Rotation | Channel::Scale => {
            "entities have it; the camera has Position and Target"
        }
        Channel::Position | Channel::Target => {
            "the camera has it: target: \"camera\"; entities have Translation"
        }
        Channel::Intensity | Channel::Direction => "entities with a light have it",
        Channel::Ks | Channel::Shininess => "materials that are specular have it, and entities made of them",
        Channel::Ka | Channel::Kd | Channel::Color | Channel::AmbientColor | Channel::Kr => {
            "materials have it, and entities with a shape"
        }
    };
    problems.add(at, format!("{what} has no {channel:?}"), "not here", help);
}

fn tracks(animation: &AnimationDocument, at: &At<'_>, problems: &mut Problems) {
    let channel = animation.channel;
    match &animation.track {
        TracksDocument::Number(track) => keys(track, at, problems, |value, at, problems| match channel {
            ChannelDocument::Shininess => check::shininess(*value, at, problems),
            _ => check::coefficient(*value, "a coefficient", at, problems),
        }),
        TracksDocument::Vector(track) => keys(track, at, problems, |value, at, problems| match channel {
            ChannelDocument::Intensity => check::intensity(*value, "the intensity", at, problems),
            ChannelDocument::Direction => {
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
    }
}
