//! Validation of cameras and shots.

use std::collections::HashSet;

use glam::DVec3;

use super::materials::SLASH;
use super::{At, Named, Problems, check};
use crate::components::{Quantity, ValidRange};
use crate::scene::document::{CameraDocument, SceneDocument, ShotDocument, Triple};
use crate::scene::files::Scope;
use crate::scene::quote::{Figure, short};

pub(super) fn validate(document: &SceneDocument, scope: Scope<'_>, scene: &At<'_>, problems: &mut Problems) {
    if let Some(camera) = &document.camera {
        let at = scene.field("camera");
        self::camera(camera, &at, problems);
        links(camera, scope, &at, problems);
    } else if document.cameras.0.is_empty() && scope.is_scene() {
        problems.add(
            scene,
            "the scene has no camera",
            "neither `camera` nor `cameras`",
            "add `camera: (position: (0, 1, -5), target: (0, 0, 0))`; only parts of other scenes have none",
        );
    }
    let list = scene.field("cameras");
    let mut names = HashSet::new();
    for (index, (name, camera)) in document.cameras.0.iter().enumerate() {
        self::name(document, name, scope, &list.key(index), problems);
        if !names.insert(name.as_str()) {
            let message = format!("two cameras are called \"{}\"", short(name));
            problems.add(&list.key(index), message, "again here", "give each its own name");
        }
        let at = list.index(index);
        self::camera(camera, &at, problems);
        links(camera, scope, &at, problems);
    }
    shots(document, &scene.field("shots"), problems);
}

fn name(document: &SceneDocument, name: &str, scope: Scope<'_>, at: &At<'_>, problems: &mut Problems) {
    let taken = match name {
        "" => {
            problems.add(at, "an empty name", "names nothing", "write a name");
            return;
        }
        SceneDocument::CAMERA if document.camera.is_some() => "that of the camera in `camera`",
        SceneDocument::SCENE => "that of the whole scene",
        _ if name.contains('/') => {
            problems.add(at, "a name with a `/` in it", SLASH, "write another sign, as `-`");
            return;
        }
        _ if scope.entity(name).found().is_some() => "an entity's too",
        _ => return,
    };
    problems.add(at, format!("the name \"{}\" is {taken}", short(name)), "taken", "choose another name");
}

/// Checks the references of a camera to entities.
fn links(document: &CameraDocument, scope: Scope<'_>, at: &At<'_>, problems: &mut Problems) {
    for (field, name) in document.links() {
        if let Some(name) = name
            && scope.entity(name).is_missing()
        {
            problems.add_unknown(&at.field(field), Named::Entity, name, || scope.entity_names());
        }
    }
}

fn shots(document: &SceneDocument, at: &At<'_>, problems: &mut Problems) {
    let mut previous = f64::NEG_INFINITY;
    for (index, ShotDocument(start, name)) in document.shots.iter().enumerate() {
        let at = at.index(index);
        if check::number(*start, &at.index(0), problems) {
            if *start <= previous {
                let message =
                    format!("a shot from {} s on follows one from {} s on", Figure(*start), Figure(previous));
                let help = "write shots in the order of their times, each time once";
                problems.add(&at.index(0), message, "not later", help);
            }
            previous = *start;
        }
        let known = || document.named_cameras().map(|(name, _)| name.into()).collect();
        if document.named_cameras().all(|(known, _)| known != name) {
            problems.add_unknown(&at.index(1), Named::Camera, name, known);
        }
    }
}

/// Reports the fields `target` and `view` of a camera with `look_at`.
fn one_view(document: &CameraDocument, at: &At<'_>, problems: &mut Problems) {
    for (field, written) in [("target", document.target), ("view", document.view)] {
        if let Some(written) = written {
            check::vector(written, &at.field(field), problems);
            problems.add(
                &at.field(field),
                format!("the camera has both `look_at` and `{field}`"),
                "one too many",
                "keep `look_at` to look at an entity, `target` at a point, or `view` in a direction",
            );
        }
    }
}

fn camera(document: &CameraDocument, at: &At<'_>, problems: &mut Problems) {
    let position_good = check::vector(document.position, &at.field("position"), problems);
    let up_good = check::direction(document.up, "up", &at.field("up"), problems);
    let view = view(document, position_good, at, problems);
    if let Some((view, name)) = view.filter(|_| up_good) {
        across(document.up, view, name, at, problems);
    }
    check::number(document.roll, &at.field("roll"), problems);
    projection(document, at, problems);
    lens(document, at, problems);
    if let Some(share) = document.shutter {
        shutter(share, &at.field("shutter"), problems);
    }
}

/// Returns the view direction of a camera, and the name of the field that defines it. Reports a missing, zero or ambiguous direction.
fn view(
    document: &CameraDocument,
    position_good: bool,
    at: &At<'_>,
    problems: &mut Problems,
) -> Option<(DVec3, &'static str)> {
    match (document.target, document.view) {
        _ if document.look_at.is_some() => {
            one_view(document, at, problems);
            None
        }
        (Some(target), None) => {
            let at = at.field("target");
            if !(check::vector(target, &at, problems) && position_good) {
                None
            } else if target == document.position {
                problems.add(
                    &at,
                    "the camera's target is where it stands",
                    "the same as position",
                    "move one of the two: the camera looks from position to target",
                );
                None
            } else {
                Some((DVec3::from(target) - DVec3::from(document.position), "target"))
            }
        }
        (None, Some(view)) => {
            check::direction(view, "view", &at.field("view"), problems).then_some((DVec3::from(view), "view"))
        }
        (Some(target), Some(view)) => {
            check::vector(target, &at.field("target"), problems);
            check::vector(view, &at.field("view"), problems);
            problems.add(
                &at.field("view"),
                "the camera has both `target` and `view`",
                "one too many",
                "keep `target` to look at a point, or `view` to look in a direction",
            );
            None
        }
        (None, None) => {
            problems.add(
                at,
                "the camera looks nowhere",
                "neither `target` nor `view` nor `look_at`",
                "add `target: (x, y, z)` to look at a point, or `view: (0, 0, 1)` to look in a direction",
            );
            None
        }
    }
}

/// Reports an up direction that is parallel to the view direction.
fn across(up: Triple, view: DVec3, name: &str, at: &At<'_>, problems: &mut Problems) {
    let up = DVec3::from(up);
    // Both vectors are scaled by their largest components, so that the cross product does not overflow.
    let across = (up / up.abs().max_element()).cross(view / view.abs().max_element());
    if across.length() < 1e-9 {
        let message = format!("the camera's up is parallel to its {name}");
        let explicit = at.field("up");
        problems.add(
            &explicit,
            message,
            "no way to tell which way is up",
            "choose another `up`, as (0, 0, 1) for a camera that looks down",
        );
    }
}

fn shutter(share: f64, at: &At<'_>, problems: &mut Problems) {
    let help = "write the share of the time from frame to frame during which it is open, as 0.5";
    check::range(share, ValidRange::AboveZero(1.0), "shutter", help, at, problems);
}

fn lens(document: &CameraDocument, at: &At<'_>, problems: &mut Problems) {
    let Some(lens) = &document.lens else {
        if document.focus_on.is_some() {
            let help = "add a lens, as `lens: (aperture: 0.1)`, or remove `focus_on`";
            let message = "without a `lens` everything is in focus";
            problems.add(&at.field("focus_on"), message, "nothing to focus", help);
        }
        return;
    };
    let at = at.field("lens");
    aperture(lens.aperture, &at.field("aperture"), problems);
    if let Some(focus) = lens.focus {
        check::size(focus, "the distance in focus", &at.field("focus"), problems);
    } else if document.focus_on.is_none() {
        let help = "add the distance, as `focus: 5`, or `focus_on: \"name\"` to the camera";
        problems.add(&at, "the lens has no distance in focus", "neither `focus` nor `focus_on`", help);
    }
}

pub(super) fn aperture(aperture: f64, at: &At<'_>, problems: &mut Problems) {
    let help = "write the lens's diameter in scene units, as 0.1; 0 is no lens";
    check::range(aperture, Quantity::Aperture.range(), "the lens's aperture", help, at, problems);
}

/// Checks a field of view; `axis` is "vertical" or "horizontal".
pub(super) fn field_of_view(fov: f64, axis: &str, at: &At<'_>, problems: &mut Problems) {
    let help = format!("write the {axis} angle, as 45");
    check::range(fov, Quantity::FieldOfView.range(), "the field of view", &help, at, problems);
}

fn projection(document: &CameraDocument, at: &At<'_>, problems: &mut Problems) {
    if let Some(screen) = &document.screen {
        let at = at.field("screen");
        check::size(screen.distance, "the screen's distance", &at.field("distance"), problems);
        check::size(screen.height, "the screen's height", &at.field("height"), problems);
        if let Some(width) = screen.width {
            check::size(width, "the screen's width", &at.field("width"), problems);
        }
    }
    let CameraDocument { fov, horizontal_fov, orthographic, .. } = *document;
    let mut first = document.screen.as_ref().map(|_| "screen");
    for (field, value) in [("fov", fov), ("horizontal_fov", horizontal_fov), ("orthographic", orthographic)] {
        let Some(value) = value else { continue };
        let at = at.field(field);
        match field {
            "orthographic" => _ = check::size(value, "the height of the view", &at, problems),
            "fov" => field_of_view(value, "vertical", &at, problems),
            _ => field_of_view(value, "horizontal", &at, problems),
        }
        if let Some(first) = first {
            let message = format!("the camera has both `{first}` and `{field}`");
            problems.add(&at, message, "one too many", "keep one: both say how wide the view is");
        }
        first.get_or_insert(field);
    }
}
