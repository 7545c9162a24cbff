//! Validation of the settings of a whole scene: timeline, film, light, quality and sampling.

use super::{At, Problems, check};
use crate::color::ColorRamp;
use crate::components::{
    AmbientOcclusion, FilmSettings, Property, Quality, Quantity, Sampling, Stars, ValidRange,
};
use crate::scene::document::{
    AmbientOcclusionDocument, BackgroundDocument, ColorDocument, FilmDocument, FogDocument, QualityDocument,
    SamplingDocument, SceneDocument, StarsDocument, SunDocument, TimelineDocument,
};
use crate::scene::quote::Figure;
use crate::time::{FrameRate, Timeline};

pub(super) fn validate(document: &SceneDocument, scene: &At<'_>, problems: &mut Problems) {
    timeline(&document.timeline, &scene.field("timeline"), problems);
    film(&document.film, &scene.field("film"), problems);
    check::intensity(document.ambient, "ambient light", &scene.field("ambient"), problems);
    if let Some(occlusion) = &document.ambient_occlusion {
        ambient_occlusion(occlusion, &scene.field("ambient_occlusion"), problems);
    }
    background(&document.background, &scene.field("background"), problems);
    if let Some(sun) = &document.sun {
        self::sun(sun, &scene.field("sun"), problems);
    }
    if let Some(stars) = &document.stars {
        self::stars(stars, &scene.field("stars"), problems);
    }
    if let Some(fog) = &document.fog {
        self::fog(fog, &scene.field("fog"), problems);
        if hides_background(fog, document) {
            let help = "add `hides_background: false`, or `true` if this is meant";
            problems.warn(&scene.field("fog"), "the fog hides the background", HIDDEN_LABEL, help);
        }
    }
    quality(&document.quality, &scene.field("quality"), problems);
    sampling(&document.sampling, &scene.field("sampling"), problems);
}

fn ambient_occlusion(document: &AmbientOcclusionDocument, at: &At<'_>, problems: &mut Problems) {
    let help = "8 is enough with several samples per pixel, 64 is smooth with one";
    let most = AmbientOcclusion::LARGEST_SAMPLES;
    check::count(document.samples, most, "samples", help, &at.field("samples"), problems);
    check::size(document.distance, "the distance of ambient occlusion", &at.field("distance"), problems);
}

fn background(document: &BackgroundDocument, at: &At<'_>, problems: &mut Problems) {
    match document {
        BackgroundDocument::Flat(color) => check::color(color.0, at, problems),
        BackgroundDocument::Gradient { bottom, horizon, top } => {
            check::color(bottom.0, &at.field("bottom"), problems);
            if let Some(horizon) = horizon {
                check::color(horizon.0, &at.field("horizon"), problems);
            }
            check::color(top.0, &at.field("top"), problems);
        }
        BackgroundDocument::Stops(list) => stops(list, &at.field("stops"), problems),
    }
}

fn stops(stops: &[(f64, ColorDocument)], at: &At<'_>, problems: &mut Problems) {
    let help = "write the upward part of a direction of length 1: 0 is level, 0.5 is 30 degrees above, 1 straight up";
    if !(2..=ColorRamp::LARGEST_COUNT).contains(&stops.len()) {
        let message =
            format!("a background has 2 to {} stops, not {}", ColorRamp::LARGEST_COUNT, stops.len());
        problems.add(
            at,
            message,
            "out of range",
            "write a list, as [(0, (235, 225, 210)), (1, (70, 120, 200))]",
        );
    }
    let mut before = None;
    for (index, (height, color)) in stops.iter().enumerate() {
        let at = at.index(index);
        let range = ValidRange::Between(-1.0, 1.0);
        check::range(*height, range, "the height of a stop", help, &at.index(0), problems);
        check::color(color.0, &at.index(1), problems);
        if let Some(before) = before
            && *height <= before
        {
            let message = format!("a stop at {} follows one at {}", Figure(*height), Figure(before));
            let help = "write stops from the lowest to the highest, each height once";
            problems.add(&at.index(0), message, "not higher", help);
        }
        before = Some(*height);
    }
}

fn sun(document: &SunDocument, at: &At<'_>, problems: &mut Problems) {
    check::direction(document.direction, "the sun", &at.field("direction"), problems);
    check::intensity(document.intensity, "the sun's intensity", &at.field("intensity"), problems);
    angular_size(document.size, "the sun's size", &at.field("size"), problems);
    check::coefficient(document.glow, "the sun's glow", &at.field("glow"), problems);
    angular_size(document.glow_size, "the size of the sun's glow", &at.field("glow_size"), problems);
}

fn stars(document: &StarsDocument, at: &At<'_>, problems: &mut Problems) {
    let help = "write about how many stars the whole sky has, as 3000";
    let most = Stars::LARGEST_COUNT;
    check::count(document.count, most, "the number of stars", help, &at.field("count"), problems);
    check::intensity(document.intensity, "the intensity of stars", &at.field("intensity"), problems);
    angular_size(document.size, "the size of stars", &at.field("size"), problems);
}

pub(super) fn angular_size(size: f64, what: &str, at: &At<'_>, problems: &mut Problems) {
    let help = "write an angle in degrees, as 0.5, which is the sun's and the moon's";
    check::range(size, Quantity::AngularSize.range(), what, help, at, problems);
}

fn fog(document: &FogDocument, at: &At<'_>, problems: &mut Problems) {
    check::color(document.color.0, &at.field("color"), problems);
    density(document.density, &at.field("density"), problems);
    if let Some(height) = document.height {
        check::size(height, "the fog's height", &at.field("height"), problems);
    }
    let level_at = at.field("level");
    check::number(document.level, &level_at, problems);
    if document.height.is_none() && document.level != 0.0 {
        let help = "add `height: ..`, or remove the level: uniform fog is the same at every height";
        problems.add(&level_at, "a fog without a height has no level", "no height", help);
    }
}

/// The label of warnings about backgrounds that fog hides.
pub(in crate::scene) const HIDDEN_LABEL: &str = "beyond all shapes, only fog shows";

/// Returns whether a background, though given, shows nowhere, and nothing says that this is meant.
fn hides_background(fog: &FogDocument, document: &SceneDocument) -> bool {
    let clears_up = document.animate.iter().any(|animation| animation.channel.0 == Property::FogDensity);
    let is_endless =
        fog.hides_background.is_none() && fog.height.is_none() && fog.density > 0.0 && !clears_up;
    let is_plain =
        [BackgroundDocument::default(), BackgroundDocument::Flat(fog.color)].contains(&document.background);
    is_endless && !(is_plain && document.stars.is_none())
}

pub(super) fn density(density: f64, at: &At<'_>, problems: &mut Problems) {
    let help = "write how fast it thickens per scene unit of length, as 0.05; 0 is no fog";
    check::range(density, Quantity::Density.range(), "the fog's density", help, at, problems);
}

fn quality(document: &QualityDocument, at: &At<'_>, problems: &mut Problems) {
    let help = "1 traces camera rays alone, 5 adds four reflections";
    check::count(document.depth, Quality::LARGEST_DEPTH, "depth", help, &at.field("depth"), problems);
    let help = "write how many steps of 8-bit output may be cut off, as 0.25; 0 cuts nothing off";
    let range = ValidRange::Between(0.0, Quality::LARGEST_CUTOFF.into());
    check::range(document.cutoff, range, "cutoff", help, &at.field("cutoff"), problems);
}

fn sampling(document: &SamplingDocument, at: &At<'_>, problems: &mut Problems) {
    let help = "1 is the pixel's centre alone, 16 gives smooth edges";
    let most = Sampling::LARGEST_COUNT;
    check::count(document.samples, most, "samples", help, &at.field("samples"), problems);
    let help = "write how many samples each pixel takes at least where there is a max_error, as 16";
    check::count(document.min_samples, most, "min_samples", help, &at.field("min_samples"), problems);
    let help = "write by how many steps of 8-bit output the picture may be off, in its norm, as in 0.5; 0 gives every pixel as many samples";
    let range = ValidRange::Between(0.0, Sampling::LARGEST_ERROR.into());
    check::range(document.max_error, range, "max_error", help, &at.field("max_error"), problems);
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
            format!("frames per second are written with numbers from 1 to {}", FrameRate::LARGEST_PART);
        problems.add(
            &at.field("fps"),
            message,
            "out of range",
            "write a whole number, as 24, or a ratio, as (30000, 1001)",
        );
    }
    let duration = document.duration;
    let duration_at = at.field("duration");
    let help = "write seconds, as 4; 0 is a single frame";
    if !check::range(duration, ValidRange::NotNegative, "the duration", help, &duration_at, problems) {
        return;
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
