//! Parsers of option values. Their errors state the valid form.

use std::path::{Path, PathBuf};
use std::time::Duration;

use rayreel::Effect;
use rayreel::accuracy::Parameter;
use rayreel::components::{FilmSettings, Quality, Sampling};
use rayreel::output::{MovieFormat, Sheet, UnknownMovieFormat};
use rayreel::scene::{Override, OverrideError, SceneWarning, nearest};
use rayreel::systems::Consequence;

pub(super) fn parse_size(text: &str) -> Result<(u32, u32), String> {
    let (most, area) = (FilmSettings::LARGEST_SIDE, FilmSettings::LARGEST_AREA);
    let (width, height) = pair(text, ['x', 'X']).ok_or("write width and height in pixels, as in 1280x720")?;
    if [width, height].iter().any(|side| !(1..=most).contains(side)) {
        return Err(format!("each side must be from 1 to {most} pixels"));
    }
    if u64::from(width) * u64::from(height) > area {
        return Err(format!("a picture has at most {area} pixels"));
    }
    Ok((width, height))
}

pub(super) fn parse_sheet(text: &str) -> Result<(u32, u32), String> {
    let most = Sheet::LARGEST_COUNT;
    let sheet = pair(text, ['x', 'X'])
        .filter(|(columns, rows)| (1..=most).contains(columns) && (1..=most).contains(rows));
    sheet.ok_or_else(|| format!("write columns and rows, each from 1 to {most}, as in 6x4"))
}

pub(super) fn parse_movie(text: &str) -> Result<PathBuf, UnknownMovieFormat> {
    MovieFormat::of(Path::new(text)).map(|_| PathBuf::from(text))
}

pub(super) fn parse_threads(text: &str) -> Result<u16, String> {
    const MOST: u16 = 1024;
    let count = text.trim().parse().ok().filter(|count| (1..=MOST).contains(count));
    count.ok_or_else(|| format!("write a number of threads from 1 to {MOST}"))
}

pub(super) fn parse_index(text: &str) -> Result<u32, String> {
    text.trim().parse().map_err(|_| format!("write a whole number from 0 to {}, as 12", u32::MAX))
}

pub(super) fn parse_samples(text: &str) -> Result<Override, String> {
    parse_count("sampling.samples", text)
}

pub(super) fn parse_min_samples(text: &str) -> Result<Override, String> {
    parse_count("sampling.min_samples", text)
}

pub(super) fn parse_norm(text: &str) -> Result<Override, String> {
    let norms = [("rms", "Rms"), ("max", "Max"), ("p99", "P99")];
    let name = norms.into_iter().find(|(name, _)| *name == text.trim().to_ascii_lowercase());
    let (_, word) = name.ok_or("write rms, max or p99")?;
    format!("sampling.norm={word}").parse().map_err(|error: OverrideError| error.to_string())
}

pub(super) fn parse_depth(text: &str) -> Result<Override, String> {
    parse_count("quality.depth", text)
}

/// Parses an integer override of a path. Its range is checked when the scene is loaded.
pub(super) fn parse_count(path: &str, text: &str) -> Result<Override, String> {
    let count = parse_index(text)?;
    format!("{path}={count}").parse().map_err(|error: OverrideError| error.to_string())
}

/// Other words for effects.
const EFFECT_WORDS: [(&str, Effect); 21] = [
    ("ambient", Effect::Ambient),
    ("ao", Effect::AmbientOcclusion),
    ("occlusion", Effect::AmbientOcclusion),
    ("diffuse", Effect::Diffuse),
    ("emissive", Effect::Emission),
    ("emitted", Effect::Emission),
    ("specular", Effect::Specular),
    ("specular-highlights", Effect::Specular),
    ("reflected", Effect::Reflection),
    ("reflections", Effect::Reflection),
    ("mirror", Effect::Reflection),
    ("refracted", Effect::Refraction),
    ("refractions", Effect::Refraction),
    ("soft-shadows", Effect::AreaLights),
    ("pattern", Effect::Patterns),
    ("checker", Effect::Patterns),
    ("stripes", Effect::Patterns),
    ("bricks", Effect::Patterns),
    ("anti-aliasing", Effect::Antialiasing),
    ("lens", Effect::DepthOfField),
    ("shutter", Effect::MotionBlur),
];

/// Parses the name of an effect, or another word for it.
pub(super) fn parse_effect(text: &str) -> Result<Effect, String> {
    let named = argument_name(text.trim());
    let names = Effect::ALL.map(effect_name);
    let by_name = Effect::ALL.into_iter().find(|effect| effect_name(*effect) == named);
    let by_word = || EFFECT_WORDS.into_iter().find(|(word, _)| *word == named).map(|(_, effect)| effect);
    let words = || names.iter().map(String::as_str).chain(EFFECT_WORDS.map(|(word, _)| word));
    by_name.or_else(by_word).ok_or_else(|| match nearest(&named, words()) {
        Some(name) => format!("did you mean `{name}`?"),
        None => format!("the effects are {}", names.join(", ")),
    })
}

/// Parses the name of a parameter of `accuracy`. The sizes have an option of their own.
pub(super) fn parse_parameter(text: &str) -> Result<Parameter, String> {
    let named = argument_name(text.trim());
    let mut parameters = Parameter::ALL.into_iter().filter(|parameter| *parameter != Parameter::Size);
    let names: Vec<String> = parameters.clone().map(|parameter| argument_name(parameter.name())).collect();
    let found = parameters.find(|parameter| argument_name(parameter.name()) == named);
    found.ok_or_else(|| match nearest(&named, names.iter().map(String::as_str)) {
        Some(name) => format!("did you mean `{name}`?"),
        None => format!("the parameters are {}", names.join(", ")),
    })
}

/// Parses the name of a warning.
pub(super) fn parse_warning(text: &str) -> Result<&'static str, String> {
    let named = text.trim().to_lowercase();
    let [color, of_data @ ..] = SceneWarning::NAMES;
    let names = || [color].into_iter().chain(Consequence::NAMES).chain(of_data);
    let name = names().find(|name| *name == named);
    name.ok_or_else(|| format!("the warnings are {}", names().collect::<Vec<_>>().join(", ")))
}

/// Returns the name of an effect in arguments.
pub(super) fn effect_name(effect: Effect) -> String {
    argument_name(effect.name())
}

/// Returns a name as it is written in arguments, as `max-error`.
pub(super) fn argument_name(name: &str) -> String {
    name.to_lowercase().replace([' ', '_'], "-")
}

/// Parses two integers separated by one of the given characters.
fn pair<const SIGNS: usize>(text: &str, between: [char; SIGNS]) -> Option<(u32, u32)> {
    let (first, second) = text.split_once(between)?;
    Some((first.trim().parse().ok()?, second.trim().parse().ok()?))
}

pub(super) fn parse_cutoff(text: &str) -> Result<f32, String> {
    let steps = text.trim().parse::<f32>().ok();
    let steps = steps.filter(|steps| (0.0..=Quality::LARGEST_CUTOFF).contains(steps));
    steps.ok_or_else(|| format!("write a number of steps from 0 to {}", Quality::LARGEST_CUTOFF))
}

pub(super) fn parse_max_error(text: &str) -> Result<f32, String> {
    let most = Sampling::LARGEST_ERROR;
    let error = text.trim().parse::<f32>().ok().filter(|error| *error > 0.0 && *error <= most);
    error.ok_or_else(|| format!("write a number of steps above 0, up to {most}, as 0.5"))
}

pub(super) fn parse_tolerance(text: &str) -> Result<f64, String> {
    let steps = text.trim().parse::<f64>().ok().filter(|steps| (0.0..=255.0).contains(steps));
    steps.ok_or_else(|| "write a number of steps from 0 to 255, as 0.5".to_owned())
}

pub(super) fn parse_duration(text: &str) -> Result<Duration, String> {
    const LONGEST: f64 = 1e9;
    let text = text.trim();
    let units = [("ms", 1e-3), ("min", 60.0), ("s", 1.0), ("m", 60.0), ("h", 3600.0)];
    let unit = units.into_iter().find_map(|(unit, seconds)| Some((text.strip_suffix(unit)?, seconds)));
    let (number, unit) = unit.unwrap_or((text, 1.0));
    let seconds = number.trim().parse::<f64>().ok().map(|number| number * unit);
    let seconds = seconds.filter(|seconds| *seconds > 0.0 && *seconds <= LONGEST);
    seconds.map(Duration::from_secs_f64).ok_or_else(|| "write a time above 0, as 90s, 10m or 1.5h".to_owned())
}

pub(super) fn parse_pixel(text: &str) -> Result<(u32, u32), String> {
    pair(text, [',']).ok_or_else(|| "write column and row, from 0 at the top left, as in 480,270".to_owned())
}
