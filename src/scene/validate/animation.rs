//! Validation of animations and their keys. Path, orbit and turns tracks are validated in `paths`.

use std::collections::{HashMap, HashSet};

use super::easing::easing;
use super::entities::{box_size, rotation, scale};
use super::{At, Problems, cameras, channels, check, lights, materials, paths, settings};
use crate::components::{Property, Quantity};
use crate::scene::document::{
    AnimationDocument, ChannelDocument, RepeatDocument, SceneDocument, TrackDocument, TracksDocument, Triple,
};
use crate::scene::files::Scope;
use crate::scene::quote::Figure;

pub(super) fn validate(document: &SceneDocument, scope: Scope<'_>, scene: &At<'_>, problems: &mut Problems) {
    let mut seen = HashMap::new();
    let list = scene.field("animate");
    let is_way = |animation: &&AnimationDocument| animation.track.is_way();
    let ways = document.animate.iter().filter(is_way);
    let ways: Ways<'_> = ways.map(|way| (way.target.as_deref(), way.channel.0)).collect();
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
        if one_view(animation.channel.0).is_some_and(|other| seen.contains_key(&(target.0, target.1, other)))
        {
            problems.add(
                &at.field("channel"),
                "both Target and View of one camera are animated",
                "the other one is",
                "keep Target to look at a point, or View to look in a direction",
            );
        }
        channels::target(document, scope, animation, &at, problems);
        if animation.track.is_along() {
            along(animation, &ways, &at.field("track"), problems);
        }
        self::tracks(animation, &at.field("track"), problems);
        playback(animation, &at, problems);
    }
}

/// The targets and properties that are animated along a path or an orbit.
type Ways<'a> = HashSet<(Option<&'a str>, Property)>;

/// Checks a track along the way of another track of the same entity.
fn along(animation: &AnimationDocument, ways: &Ways<'_>, at: &At<'_>, problems: &mut Problems) {
    let property = animation.channel.0;
    let Some(position) = property.along() else {
        let message = format!("{} is not a direction along a way", property.name());
        let help = "View of a camera can be Along the way of its Position, and Rotation of an entity Along that of its Translation";
        problems.add(at, message, "not here", help);
        return;
    };
    if animation.target.is_some() && !ways.contains(&(animation.target.as_deref(), position)) {
        let name = position.name();
        let message = format!("Along takes the direction of a way, and {name} has none in this file");
        let help = format!("animate {name} of the same target with a Path or an Orbit, or write Keys here");
        problems.add(at, message, "along nothing", help);
    }
}

/// Returns the alternative property for a camera's view direction: `View` for `Target`, and vice versa.
fn one_view(property: Property) -> Option<Property> {
    match property {
        Property::Target => Some(Property::View),
        Property::View => Some(Property::Target),
        _ => None,
    }
}

fn playback(animation: &AnimationDocument, at: &At<'_>, problems: &mut Problems) {
    let is_script = animation.track.script().is_some();
    if is_script || animation.track.is_along() {
        let AnimationDocument { repeat, offset, speed, .. } = animation;
        let (what, label) = if is_script { ("a script", "of keys only") } else { ("Along", "not here") };
        let help = match is_script {
            true => "remove it, and write another time into the script, as sin(2 * (t - 1)) or mod(t, 3)",
            false => "remove it, or write it where the way is: Along has the same times",
        };
        for (name, is_usual) in [
            ("repeat", *repeat == RepeatDocument::default()),
            ("offset", *offset == 0.0),
            ("speed", *speed == 1.0),
        ] {
            if !is_usual {
                problems.add(&at.field(name), format!("{what} has no `{name}`"), label, help);
            }
        }
    }
    check::number(animation.offset, &at.field("offset"), problems);
    let at = at.field("speed");
    if check::number(animation.speed, &at, problems) && animation.speed == 0.0 {
        let help = "2 plays at double speed, 0.5 at half of it, -1 backwards";
        problems.add(&at, "at a speed of 0 nothing moves", "zero", help);
    }
}

fn tracks(animation: &AnimationDocument, at: &At<'_>, problems: &mut Problems) {
    let channel = animation.channel;
    match &animation.track {
        TracksDocument::Number(track) => keys(channel, track, at, problems, |value, at, problems| {
            number(channel.0, *value, at, problems);
        }),
        TracksDocument::Vector(track) => keys(channel, track, at, problems, |value, at, problems| {
            vector(channel.0, *value, at, problems);
        }),
        TracksDocument::Scale(track) => keys(channel, track, at, problems, scale),
        TracksDocument::Rotation(track) => keys(channel, track, at, problems, rotation),
        TracksDocument::Color(track) => keys(channel, track, at, problems, |value, at, problems| {
            check::color(value.0, at, problems);
        }),
        TracksDocument::Flag(track) => keys(channel, track, at, problems, |_, _, _| {}),
    }
}

fn number(property: Property, value: f64, at: &At<'_>, problems: &mut Problems) {
    match property.quantity() {
        Quantity::Length => {
            check::size(value, property.name(), at, problems);
        }
        Quantity::Coefficient => check::coefficient(value, property.name(), at, problems),
        Quantity::Shininess => check::shininess(value, at, problems),
        Quantity::RefractiveIndex => check::ior(value, at, problems),
        Quantity::AngularSize => settings::angular_size(value, property.name(), at, problems),
        Quantity::SpotAngle => lights::angle(value, at, problems),
        Quantity::Softness => lights::softness(value, at, problems),
        Quantity::StripeRatio => materials::stripe_ratio(value, at, problems),
        Quantity::Mortar => materials::mortar(value, at, problems),
        Quantity::Contrast => materials::contrast(value, at, problems),
        Quantity::FieldOfView => {
            let axis = if property == Property::HorizontalFov { "horizontal" } else { "vertical" };
            cameras::field_of_view(value, axis, at, problems);
        }
        Quantity::Aperture => cameras::aperture(value, at, problems),
        Quantity::Density => settings::density(value, at, problems),
        _ => {
            check::number(value, at, problems);
        }
    }
}

fn vector(property: Property, value: Triple, at: &At<'_>, problems: &mut Problems) {
    match property.quantity() {
        Quantity::Direction => {
            check::direction(value, noun(property), at, problems);
        }
        Quantity::Edges if property == Property::BrickSize => materials::brick_size(value, at, problems),
        Quantity::Edges => box_size(value, at, problems),
        Quantity::Absorption => check::absorption(value, at, problems),
        Quantity::Light => check::intensity(value, noun(property), at, problems),
        Quantity::Falloff => lights::falloff(value, at, problems),
        _ => {
            check::vector(value, at, problems);
        }
    }
}

/// Returns the noun for a property in messages.
fn noun(property: Property) -> &'static str {
    match property {
        Property::Normal => "the normal",
        Property::Direction => "the direction",
        Property::SunDirection => "the sun",
        Property::View => "view",
        Property::Up => "up",
        Property::Intensity => "the intensity",
        Property::Ambient => "ambient light",
        _ => property.name(),
    }
}

fn keys<T>(
    channel: ChannelDocument,
    track: &TrackDocument<T>,
    at: &At<'_>,
    problems: &mut Problems,
    value: impl Fn(&T, &At<'_>, &mut Problems),
) {
    let keys = match track {
        TrackDocument::Keys(keys) => keys,
        TrackDocument::Path { .. } | TrackDocument::Orbit { .. } | TrackDocument::Turns { .. } => {
            return paths::validate(channel.0, track, at, problems);
        }
        // Scripts are checked when they are compiled, and `along` checks the others.
        TrackDocument::Along | TrackDocument::Script(_) | TrackDocument::ScriptFile(_) => return,
    };
    let list = at.index(0);
    if keys.is_empty() {
        problems.add(&list, "a track without keys", "empty", "write at least one key, as (0, (0, 1, 0))");
    }
    let mut previous = f64::NEG_INFINITY;
    for (index, key) in keys.iter().enumerate() {
        let at = list.index(index);
        if check::number(key.time, &at.index(0), problems) {
            if key.time <= previous {
                let message =
                    format!("a key at {} s follows one at {} s", Figure(key.time), Figure(previous));
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
        easing(key.easing, channel.0.notation(), &at.index(2), problems);
    }
}
