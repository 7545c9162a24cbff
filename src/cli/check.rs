//! `rayreel check`

use std::collections::BTreeSet;

use serde_json::{Value, json};

use rayreel::scene::{LoadError, ScriptMistake, Sources};
use rayreel::trace::Signals;
use rayreel::{Engine, EngineError, RenderRequest, RenderSettings, Scene, Time};

use super::args::{AllowArguments, CheckArguments};
use super::exit::Failure;
use super::print;
use super::warnings::Warnings;

/// The longest side of the small frames, in pixels: with some thousand pixels, the share of rays that end at the maximum depth is known to
/// a few per cent, in a few milliseconds.
const LONGEST_SIDE: u32 = 96;

pub(super) fn run(arguments: &CheckArguments) -> Result<(), Failure> {
    let mut results = Vec::new();
    let mut good = true;
    let overrides = arguments.overrides.all();
    for path in &arguments.scenes {
        let file = path.display().to_string();
        let loaded = Scene::load_overridden(path, &overrides);
        let checked = check(loaded, &arguments.allowed, Signals::none());
        good &= checked.is_ok();
        match checked {
            Ok(CheckPassed { count, warnings, sources }) if arguments.json => {
                let warnings = warnings.to_json(Some(&sources));
                results.push(json!({
                    "scene": file,
                    "ok": true,
                    "mistakes": [],
                    "frames": count,
                    "warnings": warnings,
                }));
            }
            Ok(CheckPassed { count, warnings, sources }) => {
                warnings.print(Some(&sources));
                print::result_line(&format!("{file}: ok, {}{}", frames(count), warnings.count()))?;
            }
            Err(CheckFailed::Scene(error)) if arguments.json => results.push(mistakes(&error)),
            Err(CheckFailed::Script(mistake)) if arguments.json => results.push(json!({
                "scene": file,
                "ok": false,
                "mistakes": [script_mistake(&mistake)],
                "unlisted": 0,
            })),
            Err(CheckFailed::Cloud(message)) if arguments.json => results.push(json!({
                "scene": file,
                "ok": false,
                "mistakes": [{ "message": message }],
                "unlisted": 0,
            })),
            Err(wrong) => {
                let count = match wrong {
                    CheckFailed::Scene(error) => {
                        print::mistakes(|color| error.render(color) + "\n");
                        error.mistakes().count() + error.unlisted()
                    }
                    CheckFailed::Script(mistake) => {
                        print::mistakes(|color| mistake.render(color) + "\n");
                        1
                    }
                    CheckFailed::Cloud(message) => {
                        print::error(&message);
                        1
                    }
                };
                let mistakes = if count == 1 { "mistake" } else { "mistakes" };
                print::error_line(&format!("{file}: {count} {mistakes}"));
            }
        }
    }
    if arguments.json {
        print::json(Value::Array(results))?;
    }
    if good { Ok(()) } else { Err(Failure::Reported) }
}

fn frames(count: u32) -> String {
    if count == 1 { "1 frame".to_owned() } else { format!("{count} frames") }
}

/// A valid scene.
pub(super) struct CheckPassed {
    /// The number of frames.
    count: u32,
    pub(super) warnings: Warnings,
    pub(super) sources: Sources,
}

/// The mistakes of a scene.
pub(super) enum CheckFailed {
    Scene(LoadError),
    Script(Box<ScriptMistake>),
    /// A cloud without particles.
    Cloud(String),
}

/// Renders the first, the middle and the last frame of a loaded scene small, and counts the frames. If the signals cancel it, warnings are
/// missing.
pub(super) fn check(
    loaded: Result<(Scene, Sources), LoadError>,
    allowed: &AllowArguments,
    signals: Signals<'_>,
) -> Result<CheckPassed, CheckFailed> {
    let (scene, sources) = loaded.map_err(CheckFailed::Scene)?;
    let timeline = scene.timeline;
    let count = timeline.frame_count();
    let mut engine = Engine::from_scene(scene);
    let mut warnings = Warnings::except(allowed);
    for frame in BTreeSet::from([0, count / 2, count - 1]) {
        match render(&mut engine, timeline.time_of(frame), signals) {
            Err(EngineError::Script(mistake)) => return Err(CheckFailed::Script(mistake.into())),
            Err(EngineError::Scene(error)) => return Err(CheckFailed::Scene(error)),
            Err(EngineError::Cloud(message)) => return Err(CheckFailed::Cloud(message)),
            Ok(()) | Err(EngineError::UnknownComponent(_) | EngineError::Cancelled) => {
                warnings.collect(&engine, &format!("frame {frame}"));
            }
        }
    }
    Ok(CheckPassed { count, warnings, sources })
}

/// Renders a frame small and with one sample per pixel, for its faults. If it has one colour, it is rendered in full: small things may be
/// between the samples.
fn render(engine: &mut Engine, time: Time, signals: Signals<'_>) -> Result<(), EngineError> {
    let film = engine.effective_settings().film;
    let small = RenderSettings::draft(film, film.width.max(film.height).div_ceil(LONGEST_SIDE));
    engine.render(RenderRequest { settings: Some(small), signals, ..RenderRequest::at(time) })?;
    if engine.report().one_color.is_some() {
        engine.render(RenderRequest { signals, ..RenderRequest::at(time) })?;
    }
    Ok(())
}

fn mistakes(error: &LoadError) -> Value {
    let mistakes: Vec<Value> = error
        .mistakes()
        .map(|mistake| {
            json!({
                "file": mistake.file,
                "line": mistake.position.map(|position| position.line),
                "column": mistake.position.map(|position| position.column),
                "message": mistake.diagnostic.message,
                "label": mistake.diagnostic.label,
                "help": mistake.diagnostic.help,
                "included_from": mistake.included_from.iter().map(ToString::to_string).collect::<Vec<_>>(),
            })
        })
        .collect();
    json!({ "scene": error.file(), "ok": false, "mistakes": mistakes, "unlisted": error.unlisted() })
}

fn script_mistake(mistake: &ScriptMistake) -> Value {
    let (position, diagnostic) = (mistake.position(), mistake.diagnostic());
    json!({
        "file": diagnostic.source.as_ref().map(|source| source.file.as_str()),
        "line": position.map(|position| position.line),
        "column": position.map(|position| position.column),
        "message": diagnostic.message,
        "label": diagnostic.label,
        "help": diagnostic.help,
        "included_from": [],
    })
}
