//! Tests that no text and no numbers cause a panic, a hang, exhausted memory, or pixels that are not finite, and that errors have a line
//! and a column.
//!
//! Scenes are valid and invalid ones with edits, random ones with parts that are often extreme or degenerate, and ones with a very large
//! number of something. Valid scenes are rendered, in this process at two times, and some of them by the command, with limited memory and
//! time.
//!
//! `RAYREEL_CASES` sets the number of cases, by default a few hundred. `RAYREEL_FUZZ_SECONDS` continues with new seeds for this time, and
//! prints them with `--nocapture`; `RAYREEL_FUZZ_SEED` repeats one.

#![allow(clippy::unwrap_used, clippy::print_stdout, reason = "a test may fail loudly")]

mod animations;
mod cameras;
#[cfg(unix)]
mod command;
mod edits;
mod entities;
mod files;
mod fuzz;
mod large_scenes;
mod parts;
mod scripts;
#[path = "../processor_time/spent.rs"]
mod spent;
mod values;

use std::path::Path;

use proptest::prelude::*;
use proptest::test_runner::{TestCaseError, TestCaseResult};

use edits::{Edit, edits, with_little_effort};
use files::{Files, SCENE, good_scenes, refused_scenes};
use fuzz::fuzz;
use large_scenes::large_scenes;
use parts::parts;
use rayreel::components::FilmSettings;
use rayreel::scene::LoadError;
use rayreel::{Engine, EngineError, Film, RenderRequest, RenderedImage, Scene, Time};

/// Returns the scene if it is valid. An error must have a position, except for an empty file.
fn good(read: Result<Scene, LoadError>) -> Result<Option<Scene>, TestCaseError> {
    let error = match read {
        Ok(scene) => return Ok(Some(scene)),
        Err(error) => error,
    };
    prop_assert!(error.to_string().starts_with("error: "));
    prop_assert!(error.mistakes().count() > 0);
    for mistake in error.mistakes() {
        let nothing = ["the file is empty", "the file holds nothing but comments"];
        let diagnostic = mistake.diagnostic;
        prop_assert!(
            mistake.position.is_some_and(|position| position.line > 0 && position.column > 0)
                || nothing.contains(&diagnostic.message.as_str()),
            "no place: {}",
            error
        );
        prop_assert!(!diagnostic.message.is_empty());
    }
    Ok(None)
}

fn read(text: &str) -> Result<Option<Scene>, TestCaseError> {
    good(Scene::from_text("fuzz.ron", text.to_owned()))
}

/// Returns an engine for a small film, and two times of its timeline.
fn small(scene: Scene, frame: u32) -> (Engine, [Time; 2]) {
    let mut engine = Engine::from_scene(scene);
    for film in engine.world_mut().query_mut::<&mut FilmSettings>() {
        *film = FilmSettings { width: 32, height: 18, ..*film };
    }
    let timeline = engine.timeline;
    let times = [0, frame % timeline.frame_count()].map(|frame| timeline.time_of(frame));
    (engine, times)
}

fn check_film(film: &Film) -> TestCaseResult {
    prop_assert_eq!((film.width(), film.height()), (32, 18));
    for (index, pixel) in film.pixels().iter().enumerate() {
        let good = pixel.is_finite() && pixel.min_element() >= 0.0;
        prop_assert!(good, "pixel ({}, {}) is {}", index % 32, index / 32, pixel);
    }
    Ok(())
}

/// Returns the film, or `None` if a script fails at this time. The error must have a position.
fn film(rendered: Result<RenderedImage, EngineError>) -> Result<Option<Film>, TestCaseError> {
    match rendered {
        Ok(image) => check_film(&image.film).map(|()| Some(image.film)),
        Err(EngineError::Script(mistake)) => {
            prop_assert!(mistake.to_string().starts_with("error: "));
            prop_assert!(mistake.position().is_some(), "no position: {}", mistake);
            Ok(None)
        }
        Err(error) => Err(TestCaseError::fail(error.to_string())),
    }
}

/// Renders the scene if it is valid.
fn check_files(folder: &Path, frame: u32) -> TestCaseResult {
    if let Some(scene) = good(Scene::load(&folder.join(SCENE)))? {
        let (mut engine, times) = small(scene, frame);
        for time in times {
            film(engine.render(time))?;
        }
    }
    Ok(())
}

/// Edits some of a scene's files.
fn edited(mut files: Files, edits: &[(Edit, prop::sample::Index)]) -> Files {
    for (edit, index) in edits {
        let count = files.0.len();
        edit.apply(&mut files.0[index.index(count)].1);
    }
    for (_, text) in &mut files.0 {
        with_little_effort(text);
    }
    files
}

/// Generates edited scenes. Edits affect any of the files of a scene.
fn edited_scenes() -> impl Strategy<Value = Files> {
    let (good, refused) = (good_scenes(), refused_scenes());
    let edits = edits(&[&good[..], &refused].concat());
    let scenes = prop_oneof![5 => prop::sample::select(good), 1 => prop::sample::select(refused)];
    (scenes, edits, any::<[prop::sample::Index; 6]>())
        .prop_map(|(files, edits, places)| edited(files, &edits.into_iter().zip(places).collect::<Vec<_>>()))
}

#[test]
fn edits_of_scenes_do_not_panic() {
    fuzz("edited scenes", 400, &(edited_scenes(), 0..200u32), |(files, frame)| {
        files.check(|folder| check_files(folder, frame))
    });
}

#[test]
fn random_scenes_do_not_panic() {
    fuzz("random scenes", 400, &(parts(), 0..10u32), |(parts, frame)| {
        let text = parts.good()?.text();
        let Some(scene) = read(&text)? else {
            return Ok(());
        };
        let (mut engine, [first, later]) = small(scene, frame);
        film(engine.render(first))?;
        let Some(film) = film(engine.render(later))? else {
            return Ok(());
        };
        prop_assert!(
            engine.render(RenderRequest { reference: true, ..RenderRequest::at(later) }).unwrap().film
                == film,
            "the paths differ in\n{}",
            text
        );
        let (mut other, _) = small(read(&text)?.unwrap(), frame);
        prop_assert!(other.render(later).unwrap().film == film, "frame {} alone differs in\n{}", frame, text);
        Ok(())
    });
}

#[test]
fn large_scenes_do_not_panic() {
    fuzz("large scenes", 60, &(large_scenes(1000), 0..10u32), |(files, frame)| {
        files.check(|folder| check_files(folder, frame))
    });
}

/// Generates scenes that are mostly valid.
#[cfg(unix)]
fn good_parts() -> impl Strategy<Value = parts::Parts> {
    parts().prop_filter_map("refused without a place", |parts| parts.good().ok())
}

/// Generates edited and random scenes.
#[cfg(unix)]
fn any_scene() -> impl Strategy<Value = Files> {
    prop_oneof![
        12 => edited_scenes(),
        3 => parts().prop_map(|parts| Files::of_text(parts.text())),
        3 => good_parts().prop_map(|parts| Files::of_text(parts.text())),
        1 => large_scenes(20_000),
    ]
}

#[cfg(unix)]
fn run_command(what: &str, few: u32, arguments: impl Strategy<Value = Vec<&'static str>>) {
    let taken = std::cell::Cell::new(command::Taken::default());
    fuzz(what, few, &(any_scene(), arguments), |(files, arguments)| {
        let run = files.check(|folder| command::rayreel(folder, &arguments))?;
        taken.set(taken.get().and(run));
        Ok(())
    });
    println!("{what}: {:?}", taken.get());
}

#[test]
#[cfg(unix)]
fn check_accepts_any_scene() {
    run_command("check", 100, Just(vec!["check", SCENE]));
}

#[test]
#[cfg(unix)]
fn render_accepts_any_scene() {
    let moment = prop::sample::select(vec!["0s", "0.7s", "1.37s", "12.5s"]);
    let arguments = moment.prop_map(|moment| vec!["render", SCENE, "--size", "32x18", "--at", moment]);
    run_command("render", 40, arguments);
}
