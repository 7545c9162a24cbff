//! Timeline, film, camera and lights of the whole scene.

use glam::DVec3;

use super::{At, Problems, check};
use crate::components::{FilmSettings, Quality, Sampling};
use crate::scene::document::{
    BackgroundDocument, CameraDocument, FilmDocument, FogDocument, QualityDocument, SamplingDocument,
    SceneDocument, TimelineDocument,
};
use crate::scene::include::Scope;
use crate::time::{FrameRate, Timeline};

pub(super) fn validate(document: &SceneDocument, scope: Scope<'_>, scene: &At<'_>, problems: &mut Problems) {
    timeline(&document.timeline, &scene.field("timeline"), problems);
    film(&document.film, &scene.field("film"), problems);
    match &document.camera {
        Some(camera) => self::camera(camera, &scene.field("camera"), problems),
        None if scope.is_scene() => {
            let help = "add `camera: (position: (0, 1, -5), target: (0, 0, 0))`; only parts of other scenes have none";
            problems.add(scene, "missing field `camera` of `Scene`", "no camera", help);
        }
        None => {}
    }
    check::intensity(document.ambient, "ambient light", &scene.field("ambient"), problems);
    background(&document.background, &scene.field("background"), problems);
    if let Some(fog) = &document.fog {
        self::fog(fog, &scene.field("fog"), problems);
    }
    quality(&document.quality, &scene.field("quality"), problems);
    sampling(&document.sampling, &scene.field("sampling"), problems);
}

fn background(document: &BackgroundDocument, at: &At<'_>, problems: &mut Problems) {
    match document {
        BackgroundDocument::Flat(color) => check::color(color.0, at, problems),
        BackgroundDocument::Gradient { bottom, top } => {
            check::color(bottom.0, &at.field("bottom"), problems);
            check::color(top.0, &at.field("top"), problems);
        }
    }
}

fn fog(document: &FogDocument, at: &At<'_>, problems: &mut Problems) {
    check::color(document.color.0, &at.field("color"), problems);
    let at = at.field("density");
    if check::number(document.density, &at, problems) && document.density < 0.0 {
        let message = format!("the fog's density must not be negative, but is {}", document.density);
        let help = "write how fast it thickens per scene unit of length, as 0.05; 0 is no fog";
        problems.add(&at, message, "below 0", help);
    }
}

fn quality(document: &QualityDocument, at: &At<'_>, problems: &mut Problems) {
    let help = "1 traces camera rays alone, 5 adds four reflections";
    check::count(document.depth, Quality::LARGEST_DEPTH, "depth", help, &at.field("depth"), problems);
    let largest = f64::from(Quality::LARGEST_CUTOFF);
    if !(0.0..=largest).contains(&document.cutoff) {
        let message = format!("cutoff must be from 0 to {largest}, not {}", document.cutoff);
        let help = "write how many steps of 8-bit output may be left out, as 0.25; 0 leaves nothing out";
        problems.add(&at.field("cutoff"), message, "out of range", help);
    }
}

fn sampling(document: &SamplingDocument, at: &At<'_>, problems: &mut Problems) {
    let help = "1 is the pixel's centre alone, 16 gives smooth edges";
    let most = Sampling::LARGEST_COUNT;
    check::count(document.samples, most, "samples", help, &at.field("samples"), problems);
    let help = "write at how many moments, at most, things are drawn while the shutter is open, as 16";
    let most = Sampling::LARGEST_INSTANTS;
    check::count(document.instants, most, "instants", help, &at.field("instants"), problems);
}

fn timeline(document: &TimelineDocument, at: &At<'_>, problems: &mut Problems) {
    let part =
        |value: u64| u32::try_from(value).ok().filter(|value| (1..=FrameRate::LARGEST_PART).contains(value));
    let rate = part(document.fps.numerator).zip(part(document.fps.denominator));
    if rate.is_none() {
        let message =
            format!("frames per second must be made of numbers from 1 to {}", FrameRate::LARGEST_PART);
        problems.add(
            &at.field("fps"),
            message,
            "out of range",
            "write a whole number, as 24, or a ratio, as (30000, 1001)",
        );
    }
    let duration = document.duration;
    let duration_at = at.field("duration");
    if !(check::number(duration, &duration_at, problems)) {
        return;
    }
    if duration < 0.0 {
        let message = format!("the duration must not be negative, but is {duration}");
        problems.add(&duration_at, message, "below 0", "write seconds, as 4; 0 is a single frame");
    }
    let rate = rate.and_then(|(numerator, denominator)| FrameRate::new(numerator, denominator));
    if let Some(rate) = rate
        && duration * rate.per_second() > f64::from(Timeline::LARGEST_COUNT)
    {
        let message = format!("a timeline has at most {} frames", Timeline::LARGEST_COUNT);
        problems.add(&duration_at, message, "too long", "write the duration in seconds, not in frames");
    }
}

fn film(document: &FilmDocument, at: &At<'_>, problems: &mut Problems) {
    let sides = 1..=u64::from(FilmSettings::LARGEST_SIDE);
    let mut fits = true;
    for (name, side) in [("width", document.width), ("height", document.height)] {
        if !sides.contains(&side) {
            let message = format!(
                "the film's {name} must be from 1 to {} pixels, not {side}",
                FilmSettings::LARGEST_SIDE
            );
            problems.add(&at.field(name), message, "out of range", "write a number of pixels, as 1280");
            fits = false;
        }
    }
    if fits && document.width * document.height > FilmSettings::LARGEST_AREA {
        let message = format!("a film has at most {} pixels", FilmSettings::LARGEST_AREA);
        problems.add(
            at,
            message,
            format!("{} pixels", document.width * document.height),
            "make it smaller; 16384 x 16384 is the largest square",
        );
    }
}

fn camera(document: &CameraDocument, at: &At<'_>, problems: &mut Problems) {
    let position_good = check::vector(document.position, &at.field("position"), problems);
    let up_good = check::direction(document.up, "up", &at.field("up"), problems);
    let view = match (document.target, document.view) {
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
        (Some(_), Some(_)) => {
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
                "neither `target` nor `view`",
                "add `target: (x, y, z)` to look at a point, or `view: (0, 0, 1)` to look in a direction",
            );
            None
        }
    };
    if let Some((view, name)) = view
        && up_good
    {
        let up = DVec3::from(document.up);
        // In units of the larger components, so that nothing overflows.
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
    projection(document, at, problems);
    lens(document, at, problems);
    if let Some(share) = document.shutter {
        shutter(share, &at.field("shutter"), problems);
    }
}

fn shutter(share: f64, at: &At<'_>, problems: &mut Problems) {
    if !(share > 0.0 && share <= 1.0) {
        let message = format!("shutter must be above 0, at most 1, not {share}");
        let help = "write the share of the time from frame to frame during which it is open, as 0.5";
        problems.add(at, message, "out of range", help);
    }
}

fn lens(document: &CameraDocument, at: &At<'_>, problems: &mut Problems) {
    let Some(lens) = &document.lens else { return };
    let at = at.field("lens");
    let aperture_at = at.field("aperture");
    if check::number(lens.aperture, &aperture_at, problems) && lens.aperture < 0.0 {
        let message = format!("the lens's aperture must not be negative, but is {}", lens.aperture);
        problems.add(
            &aperture_at,
            message,
            "below 0",
            "write the lens's diameter in scene units, as 0.1; 0 is no lens",
        );
    }
    check::size(lens.focus, "the distance in focus", &at.field("focus"), problems);
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
    if let Some(fov) = document.fov {
        let at = at.field("fov");
        if document.screen.is_some() {
            problems.add(
                &at,
                "the camera has both `screen` and `fov`",
                "one too many",
                "keep one: both say how wide the view is",
            );
        } else if !(fov > 0.0 && fov < 180.0) {
            let message = format!("the field of view must be between 0 and 180 degrees, not {fov}");
            problems.add(&at, message, "out of range", "write the vertical angle, as 45");
        }
    }
}
