//! No text and no numbers make it panic, hang, or put anything on a film that is not a finite number; what is refused is
//! refused with line and column.
//!
//! Texts are shipped scenes with edits, and scenes made up of parts that are often extreme or degenerate. Whatever is read is
//! rendered, at two moments.
//!
//! `RAYREEL_CASES` asks for more than the usual few hundred cases. `RAYREEL_FUZZ_SECONDS` goes on with new seeds for as long,
//! and prints them with `--nocapture`; `RAYREEL_FUZZ_SEED` repeats one.

#![allow(clippy::unwrap_used, clippy::print_stdout, reason = "a test may fail loudly")]

mod parts;

use std::path::Path;
use std::time::{Duration, Instant, SystemTime};

use proptest::prelude::*;
use proptest::test_runner::{RngSeed, TestCaseError, TestCaseResult, TestRunner};

use parts::{number, parts};
use rayreel::components::FilmSettings;
use rayreel::scene::TEMPLATE;
use rayreel::{Engine, Film, Scene, Time};

/// A number from the environment.
fn asked(name: &str) -> Option<u64> {
    Some(std::env::var(name).ok()?.parse().unwrap_or_else(|_| panic!("{name} is not a number")))
}

/// Runs a check on many cases: the same ones every time, unless more of them are asked for.
fn fuzz<S: Strategy>(what: &str, strategy: &S, check: impl Fn(S::Value) -> TestCaseResult) {
    let run = |seed: u64, cases: u32| {
        let rng_seed = RngSeed::Fixed(seed);
        let config =
            ProptestConfig { cases, failure_persistence: None, rng_seed, ..ProptestConfig::default() };
        let outcome = TestRunner::new(config).run(strategy, &check);
        outcome.unwrap_or_else(|error| panic!("{what}, RAYREEL_FUZZ_SEED={seed}: {error}"));
    };
    let cases = asked("RAYREEL_CASES").map_or(400, |cases| u32::try_from(cases).unwrap());
    let fresh = || SystemTime::UNIX_EPOCH.elapsed().map_or(0, |elapsed| elapsed.as_secs() * 1000);
    let seconds = asked("RAYREEL_FUZZ_SECONDS").map(Duration::from_secs);
    match (asked("RAYREEL_FUZZ_SEED"), seconds) {
        (Some(seed), _) => run(seed, cases),
        (None, Some(duration)) => {
            let start = Instant::now();
            let first = fresh();
            let mut seed = first;
            while start.elapsed() < duration {
                println!("{what}: seed {seed}");
                run(seed, cases);
                seed += 1;
            }
            println!("{what}: {} cases", (seed - first) * u64::from(cases));
        }
        (None, None) if asked("RAYREEL_CASES").is_some() => {
            let seed = fresh();
            println!("{what}: seed {seed}");
            run(seed, cases);
        }
        (None, None) => run(2026, cases),
    }
}

/// The scene, if it is one. A refusal must say where; there is no place in a file that holds nothing.
fn read(text: &str) -> Result<Option<Scene>, TestCaseError> {
    let error = match Scene::from_text("fuzz.ron", text.to_owned()) {
        Ok(scene) => return Ok(Some(scene)),
        Err(error) => error,
    };
    prop_assert!(error.to_string().starts_with("error: "));
    prop_assert!(error.mistakes().count() > 0);
    for mistake in error.mistakes() {
        let nothing = ["the file is empty", "the file holds nothing but comments"];
        let diagnostic = mistake.diagnostic;
        prop_assert!(
            mistake.place.is_some_and(|place| place.line > 0 && place.column > 0)
                || nothing.contains(&diagnostic.message.as_str()),
            "no place: {}",
            error
        );
        prop_assert!(!diagnostic.message.is_empty());
    }
    Ok(None)
}

/// An engine for a small film, and two moments of its timeline.
fn small(scene: Scene, frame: u32) -> (Engine, [Time; 2]) {
    let mut engine = Engine::from_scene(scene);
    for film in engine.world_mut().query_mut::<&mut FilmSettings>() {
        *film = FilmSettings { width: 32, height: 18, ..*film };
    }
    let timeline = engine.timeline();
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

/// Renders what is a scene.
fn check_text(text: &str, frame: u32) -> TestCaseResult {
    if let Some(scene) = read(text)? {
        let (mut engine, times) = small(scene, frame);
        for time in times {
            check_film(&engine.render_at(time).unwrap())?;
        }
    }
    Ok(())
}

/// A change to a text, at some place in it.
#[derive(Clone, Debug)]
enum Edit {
    /// Take some characters away and put others there.
    Splice { place: f64, removed: usize, inserted: String },
    /// Put another number in the place of the next.
    Number { place: f64, number: String },
    /// Put a line of the text there once more.
    Line { place: f64, line: f64 },
}

fn other_number(number: impl Strategy<Value = String>) -> impl Strategy<Value = Edit> {
    (0.0..1.0f64, number).prop_map(|(place, number)| Edit::Number { place, number })
}

/// Numbers that are often good.
fn likely_number() -> impl Strategy<Value = Edit> {
    other_number(prop_oneof![
        3 => number().prop_map(|number| format!("{number:?}")),
        3 => (0.0..1.0f64).prop_map(|number| format!("{number:?}")),
        1 => (0u32..40_000).prop_map(|number| number.to_string()),
    ])
}

/// A few changes: of numbers alone, so that many of the texts stay scenes, or of any kind.
fn edits() -> impl Strategy<Value = Vec<Edit>> {
    prop_oneof![prop::collection::vec(likely_number(), 1..4), prop::collection::vec(edit(), 1..6)]
}

fn edit() -> impl Strategy<Value = Edit> {
    let words = prop::sample::select(vec![
        "",
        "(",
        ")",
        "[",
        "]",
        "{",
        "}",
        ",",
        ":",
        "\"",
        "'",
        "/*",
        "*/",
        "//",
        "\\",
        "#",
        "r#\"",
        "Some(",
        "None",
        "-",
        "NaN",
        "inf",
        "1e999",
        "1.2.3f64",
        "0x",
        "b\"",
        "ß",
        "\u{1F600}",
        "\u{feff}",
        "\n",
        "\0",
        "true",
        "()",
        "..",
        "1..=2",
        "_",
        "Sphere",
        "camera",
        "#![enable(implicit_some)]",
        "18446744073709551616",
        "-0.0",
        "EaseIn",
        "\r\n",
        "\u{301}",
    ]);
    let odd = prop::sample::select(vec![
        "NaN", "inf", "-inf", "1e400", "1e-400", "1e61", "0x10", "-7", "0.5.5", "1000",
    ]);
    let removed = prop_oneof![Just(0usize), 0..4usize, 0..60usize];
    prop_oneof![
        2 => (0.0..1.0f64, removed, words).prop_map(|(place, removed, word)| Edit::Splice { place, removed, inserted: word.to_owned() }),
        1 => other_number(odd.prop_map(str::to_owned)),
        3 => likely_number(),
        1 => (0.0..1.0f64, 0.0..1.0f64).prop_map(|(place, line)| Edit::Line { place, line }),
    ]
}

/// The nearest character boundary at or before a share of the text.
#[expect(clippy::cast_possible_truncation, clippy::cast_sign_loss, reason = "a place in the text")]
fn byte_at(text: &str, place: f64) -> usize {
    text.floor_char_boundary((place * text.len() as f64) as usize)
}

fn edited(text: &str, edits: &[Edit]) -> String {
    let mut text = text.to_owned();
    for edit in edits {
        match edit {
            Edit::Splice { place, removed, inserted } => {
                let start = byte_at(&text, *place);
                let length: usize = text[start..].chars().take(*removed).map(char::len_utf8).sum();
                text.replace_range(start..start + length, inserted);
            }
            Edit::Number { place, number } => {
                let start = byte_at(&text, *place);
                let part = |character: char| character.is_ascii_digit() || "+-.".contains(character);
                if let Some(found) = text[start..].find(|character: char| character.is_ascii_digit()) {
                    let start = text[..start + found].trim_end_matches(part).len();
                    let length =
                        text[start..].find(|character| !part(character)).unwrap_or(text.len() - start);
                    text.replace_range(start..start + length, number);
                }
            }
            Edit::Line { place, line } => {
                let from = byte_at(&text, *line);
                let copy = text[from..].lines().next().unwrap_or_default().to_owned();
                let start = byte_at(&text, *place);
                let start = text[..start].rfind('\n').map_or(0, |newline| newline + 1);
                text.insert_str(start, &copy);
            }
        }
    }
    text
}

/// The shipped scenes, the template, and scenes that use every field.
fn texts() -> Vec<String> {
    let root = Path::new(env!("CARGO_MANIFEST_DIR"));
    let folder = |folder: &str| {
        let mut paths: Vec<_> =
            std::fs::read_dir(root.join(folder)).unwrap().map(|entry| entry.unwrap().path()).collect();
        paths.retain(|path| path.is_file());
        paths.sort();
        paths
    };
    let paths =
        [folder("scenes"), folder("tests/flush_faces"), vec![root.join("tests/hard_cases/every_number.ron")]];
    let files = paths.concat().into_iter().map(|path| std::fs::read_to_string(path).unwrap());
    std::iter::once(TEMPLATE.to_owned()).chain(files).collect()
}

#[test]
fn no_edit_of_a_scene_makes_it_fail() {
    let texts = texts();
    let strategy = (0..texts.len(), edits(), 0..200u32);
    fuzz("edited scenes", &strategy, |(text, edits, frame)| check_text(&edited(&texts[text], &edits), frame));
}

#[test]
fn no_scene_makes_it_fail() {
    fuzz("random scenes", &(parts(), 0..10u32), |(parts, frame)| {
        let text = parts.good()?.text();
        let Some(scene) = read(&text)? else {
            return Ok(());
        };
        let (mut engine, [first, later]) = small(scene, frame);
        check_film(&engine.render_at(first).unwrap())?;
        let film = engine.render_at(later).unwrap();
        check_film(&film)?;
        prop_assert!(engine.render_reference(later).unwrap() == film, "the paths differ in\n{}", text);
        let (mut other, _) = small(read(&text)?.unwrap(), frame);
        prop_assert!(other.render_at(later).unwrap() == film, "frame {} alone differs in\n{}", frame, text);
        Ok(())
    });
}
