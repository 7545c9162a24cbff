//! Validation of path, orbit and turns tracks.

use super::easing::easing;
use super::{At, Problems, check};
use crate::animation::Notation;
use crate::components::{Property, Quantity, ValidRange};
use crate::scene::document::{EasingDocument, TrackDocument};

/// Checks a path, orbit or turns track.
pub(super) fn validate<T>(
    property: Property,
    track: &TrackDocument<T>,
    at: &At<'_>,
    problems: &mut Problems,
) {
    let turns = matches!(track, TrackDocument::Turns { .. });
    if turns && property.quantity() != Quantity::Rotation {
        let message = format!("{} is not a rotation that could make turns", property.name());
        let help = "write its values as Keys([(0, ..), (2, ..)]); Rotation can make Turns, and points can go along an Orbit";
        problems.add(at, message, "not here", help);
        return;
    }
    if !turns && property.quantity() != Quantity::Point {
        problems.add(
            at,
            format!("{} is not a point that could go along a way", property.name()),
            "not here",
            "write its values as Keys([(0, ..), (2, ..)]); Translation, Position and Target can go along a Path or an Orbit",
        );
        return;
    }
    match track {
        TrackDocument::Keys(_)
        | TrackDocument::Along
        | TrackDocument::Script(_)
        | TrackDocument::ScriptFile(_) => {}
        TrackDocument::Path { points, start, duration, speed, ease, .. } => {
            self::points(points, &at.field("points"), problems);
            check::number(*start, &at.field("start"), problems);
            pace(*duration, *speed, at, problems);
            progress(*ease, &at.field("ease"), problems);
        }
        TrackDocument::Orbit { center, radius, axis, height, from, turns, start, duration, ease } => {
            check::vector(*center, &at.field("center"), problems);
            self::radius(*radius, &at.field("radius"), problems);
            check::direction(*axis, "the axis", &at.field("axis"), problems);
            for (name, number) in [("height", height), ("from", from), ("turns", turns), ("start", start)] {
                check::number(*number, &at.field(name), problems);
            }
            self::duration(*duration, &at.field("duration"), problems);
            progress(*ease, &at.field("ease"), problems);
        }
        TrackDocument::Turns { axis, turns, from, start, duration, ease } => {
            check::direction(*axis, "the axis", &at.field("axis"), problems);
            for (name, number) in [("turns", turns), ("from", from), ("start", start)] {
                check::number(*number, &at.field(name), problems);
            }
            self::duration(*duration, &at.field("duration"), problems);
            progress(*ease, &at.field("ease"), problems);
        }
    }
}

fn points(points: &[[f64; 3]], at: &At<'_>, problems: &mut Problems) {
    if points.is_empty() {
        problems.add(at, "a path without points", "empty", "write at least one, as [(0, 1, 0), (4, 1, 2)]");
    }
    for (index, point) in points.iter().enumerate() {
        check::vector(*point, &at.index(index), problems);
    }
}

/// Checks that exactly one of duration and speed is given.
fn pace(duration: Option<f64>, speed: Option<f64>, at: &At<'_>, problems: &mut Problems) {
    match (duration, speed) {
        (None, None) => problems.add(
            at,
            "a path that takes no time",
            "neither `duration` nor `speed`",
            "add `duration: 10`, in seconds, or `speed: 2`, in scene units per second",
        ),
        (Some(_), Some(_)) => problems.add(
            &at.field("speed"),
            "a path with both a duration and a speed",
            "one too many",
            "remove one of them: the other follows from the path's length",
        ),
        (Some(seconds), None) => self::duration(seconds, &at.field("duration"), problems),
        (None, Some(speed)) => {
            let help = "write scene units per second; to go backwards, write the points the other way round";
            let range = ValidRange::Positive;
            check::range(speed, range, "the speed along a path", help, &at.field("speed"), problems);
        }
    }
}

fn duration(seconds: f64, at: &At<'_>, problems: &mut Problems) {
    check::range(seconds, ValidRange::Positive, "the duration", "write seconds, as 10", at, problems);
}

fn radius(radius: f64, at: &At<'_>, problems: &mut Problems) {
    let help = "write 0 or more; negative `turns` go round the other way";
    check::range(radius, ValidRange::NotNegative, "the radius of an orbit", help, at, problems);
}

/// Checks the easing of progress along a path or an orbit.
fn progress(ease: EasingDocument, at: &At<'_>, problems: &mut Problems) {
    match ease {
        EasingDocument::Hold
        | EasingDocument::Cubic
        | EasingDocument::CatmullRom
        | EasingDocument::Monotone
        | EasingDocument::Handles(..) => {
            let name = format!("{ease:?}");
            let name = name.split('(').next().unwrap_or_default();
            let message = format!("{name} says how one gets from key to key, and a way has none");
            problems.add(at, message, "not here", "write how progress is made, as Linear or InOutSine");
        }
        _ => easing(ease, Notation::Number, at, problems),
    }
}
