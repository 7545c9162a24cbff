//! No text and no numbers make it panic, hang, or put anything on a film that is not a finite number; what is refused is
//! refused with line and column.
//!
//! Texts are shipped scenes with edits, and scenes made up of parts that are often extreme or degenerate. Whatever is read is
//! rendered, at two moments.
//!
//! `RAYREEL_CASES` asks for more than the usual few hundred cases. `RAYREEL_FUZZ_SECONDS` goes on with new seeds for as long,
//! and prints them with `--nocapture`; `RAYREEL_FUZZ_SEED` repeats one.

#![allow(clippy::unwrap_used, clippy::print_stdout, reason = "a test may fail loudly")]

use std::path::Path;
use std::time::{Duration, Instant, SystemTime};

use proptest::prelude::*;
use proptest::test_runner::{RngSeed, TestCaseError, TestCaseResult, TestRunner};

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
    prop_assert!(!error.diagnostics().is_empty());
    for diagnostic in error.diagnostics() {
        let nothing = ["the file is empty", "the file holds nothing but comments"];
        let place = error.place(diagnostic);
        prop_assert!(
            place.is_some_and(|place| place.line > 0 && place.column > 0)
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
    let mut byte = (place * text.len() as f64) as usize;
    while !text.is_char_boundary(byte) {
        byte -= 1;
    }
    byte
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
        paths.sort();
        paths
    };
    let paths =
        [folder("scenes"), folder("tests/flush_faces"), vec![root.join("tests/hard_cases/every_number.ron")]];
    let files = paths.concat().into_iter().map(|path| std::fs::read_to_string(path).unwrap());
    std::iter::once(TEMPLATE.to_owned()).chain(files).collect()
}

/// Numbers from the far ends of what a scene file may hold, and beyond.
fn number() -> impl Strategy<Value = f64> {
    let extreme = prop::sample::select(vec![
        0.0,
        -0.0,
        1.0,
        -1.0,
        1e-60,
        -1e-60,
        1e60,
        -1e60,
        1e-310,
        -1e-310,
        5e-324,
        1e-20,
        1e20,
        1e-9,
        1e9,
        1e300,
        0.1,
        1.0 + f64::EPSILON,
        90.0,
        180.0,
        360.0,
    ]);
    prop_oneof![
        6 => -3.0..3.0f64,
        3 => (-8i32..8).prop_map(f64::from),
        2 => extreme,
        1 => (-60.0..60.0f64).prop_map(libm::exp10),
    ]
}

/// Sizes: mostly good ones.
fn size() -> impl Strategy<Value = String> {
    prop_oneof![4 => (0.01..4.0f64).boxed(), 1 => number().prop_map(f64::abs).boxed()]
        .prop_map(|size| format!("{size:?}"))
}

fn triple() -> impl Strategy<Value = String> {
    (number(), number(), number()).prop_map(|(x, y, z)| format!("({x:?}, {y:?}, {z:?})"))
}

/// A point in the middle of things, mostly.
fn point() -> impl Strategy<Value = String> {
    let near = (-4i32..=4, -4i32..=4, -4i32..=4).prop_map(|(x, y, z)| format!("({x}, {y}, {z})"));
    prop_oneof![2 => near, 2 => triple()]
}

fn rotation() -> impl Strategy<Value = String> {
    prop_oneof![
        3 => Just("Euler(0, 0, 0)".to_owned()),
        1 => triple().prop_map(|angles| format!("Euler{angles}")),
        1 => (triple(), number()).prop_map(|(axis, angle)| format!("AxisAngle({axis}, {angle:?})")),
        1 => (number(), number(), number(), number()).prop_map(|(x, y, z, w)| format!("Quat({x:?}, {y:?}, {z:?}, {w:?})")),
    ]
}

fn scale() -> impl Strategy<Value = String> {
    prop_oneof![3 => Just("1".to_owned()), 2 => number().prop_map(|factor| format!("{factor:?}")), 2 => triple()]
}

fn intensity() -> impl Strategy<Value = String> {
    let channel =
        || prop_oneof![4 => 0.0..2.0f64, 1 => prop::sample::select(vec![0.0, 1e30, 1e29, 1e-40, 1e-310])];
    (channel(), channel(), channel()).prop_map(|(r, g, b)| format!("({r:?}, {g:?}, {b:?})"))
}

fn coefficient() -> impl Strategy<Value = String> {
    prop_oneof![3 => (0.0..=1.0f64).boxed(), 1 => prop::sample::select(vec![0.0, 1.0, 1e-310, 1e-45]).boxed()]
        .prop_map(|value| format!("{value:?}"))
}

fn shininess() -> impl Strategy<Value = String> {
    prop_oneof![1.0..200.0f64, prop::sample::select(vec![0.0, 1e-310, 1e6])]
        .prop_map(|value| format!("{value:?}"))
}

fn color() -> impl Strategy<Value = String> {
    prop_oneof![
        ((0u8..), (0u8..), (0u8..)).prop_map(|(r, g, b)| format!("({r}, {g}, {b})")),
        (0u32..0x100_0000).prop_map(|color| format!("\"#{color:06x}\"")),
    ]
}

fn material() -> impl Strategy<Value = String> {
    let reflective = prop::option::of(coefficient());
    let specular = prop::option::of((coefficient(), shininess()));
    (coefficient(), coefficient(), color(), prop::option::of(color()), specular, reflective).prop_map(
        |(k_a, k_d, color, ambient, specular, reflective)| {
            let ambient = ambient.map_or_else(String::new, |color| format!(", ambient_color: {color}"));
            let mirror = reflective.map_or_else(String::new, |k_r| format!(", reflective: (k_r: {k_r})"));
            let gloss = specular.map_or_else(String::new, |(k_s, shininess)| {
                format!(", specular: (k_s: {k_s}, shininess: {shininess})")
            });
            format!("(k_a: {k_a}, k_d: {k_d}, color: {color}{ambient}{gloss}{mirror})")
        },
    )
}

fn falloff() -> impl Strategy<Value = String> {
    let some = (size(), 0.0..2.0f64, prop_oneof![Just(0.0), 0.0..2.0, Just(1e60)]);
    prop::option::of(some).prop_map(|some| {
        some.map_or_else(String::new, |(c0, c1, c2)| format!(", falloff: ({c0}, {c1:?}, {c2:?})"))
    })
}

/// What is between an entity's brackets besides its name and parent.
fn entity() -> impl Strategy<Value = String> {
    let shape = prop_oneof![
        size().prop_map(|radius| format!("Sphere(radius: {radius})")),
        (size(), size(), size()).prop_map(|(x, y, z)| format!("Box(size: ({x}, {y}, {z}))")),
        point().prop_map(|normal| format!("Plane(normal: {normal})")),
    ];
    let shape =
        (shape, 0..3).prop_map(|(shape, material)| format!("shape: {shape}, material: \"m{material}\", "));
    let light = prop_oneof![
        (intensity(), any::<bool>(), falloff()).prop_map(|(intensity, shadows, falloff)| format!(
            "light: Point(intensity: {intensity}, casts_shadows: {shadows}{falloff}), "
        )),
        (intensity(), 0.001..180.0f64, coefficient(), falloff()).prop_map(
            |(intensity, angle, softness, falloff)| format!(
                "light: Spot(intensity: {intensity}, angle: {angle:?}, softness: {softness}{falloff}), "
            )
        ),
        (intensity(), point()).prop_map(|(intensity, direction)| format!(
            "light: Directional(intensity: {intensity}, direction: {direction}), "
        )),
    ];
    let what = prop_oneof![
        6 => shape.clone(),
        2 => light.clone(),
        1 => (shape, light).prop_map(|(shape, light)| shape + &light),
        1 => Just(String::new()),
    ];
    (what, point(), rotation(), scale()).prop_map(|(what, translation, rotation, scale)| {
        format!("{what}transform: (translation: {translation}, rotation: {rotation}, scale: {scale})")
    })
}

fn camera() -> impl Strategy<Value = String> {
    let view = prop_oneof![
        3 => point().prop_map(|target| format!("target: {target}")),
        1 => triple().prop_map(|view| format!("view: {view}")),
    ];
    let up = prop_oneof![2 => Just("(0, 1, 0)".to_owned()), 1 => triple()];
    let projection = prop_oneof![
        2 => Just(String::new()),
        1 => prop_oneof![1.0..179.0f64, number()].prop_map(|fov| format!(", fov: {fov:?}")),
        1 => (size(), size(), size()).prop_map(|(distance, width, height)| {
            format!(", screen: (distance: {distance}, width: {width}, height: {height})")
        }),
    ];
    (point(), view, up, projection).prop_map(|(position, view, up, projection)| {
        format!("position: {position}, {view}, up: {up}{projection}")
    })
}

fn keys(value: impl Strategy<Value = String>) -> impl Strategy<Value = String> {
    let easing =
        prop::sample::select(vec!["Hold", "Linear", "EaseIn", "EaseOut", "EaseInOut", "Cubic", "Cubic"]);
    let gap =
        prop_oneof![6 => 0.1..1.0f64, 1 => prop::sample::select(vec![5e-324, 1e-300, 1e-16, 1e-9, 1e9])];
    prop::collection::vec((gap, value, easing), 1..5).prop_map(|keys| {
        let mut time = -0.5;
        let mut text = String::new();
        for (gap, value, easing) in keys {
            time += gap;
            text += &format!("({time:?}, {value}, {easing}), ");
        }
        format!("Keys([{text}])")
    })
}

fn animation() -> impl Strategy<Value = String> {
    let of = |targets: &'static str, channel: &'static str, keys: BoxedStrategy<String>| {
        (0..6u32, keys).prop_map(move |(index, keys)| {
            let target = targets.replace('#', &index.to_string());
            format!("({target}, channel: {channel}, track: {keys})")
        })
    };
    let (entity, camera, material) = ("target: \"e#\"", "target: \"camera\"", "material: \"m#\"");
    prop_oneof![
        2 => of(entity, "Translation", keys(point()).boxed()),
        2 => of(entity, "Rotation", keys(rotation()).boxed()),
        2 => of(entity, "Scale", keys(scale()).boxed()),
        1 => of(entity, "Intensity", keys(intensity()).boxed()),
        1 => of(entity, "Direction", keys(point()).boxed()),
        1 => of(entity, "Kd", keys(coefficient()).boxed()),
        1 => of(material, "Ka", keys(coefficient()).boxed()),
        1 => of(material, "Ks", keys(coefficient()).boxed()),
        1 => of(entity, "Shininess", keys(shininess()).boxed()),
        1 => of(material, "Kr", keys(coefficient()).boxed()),
        1 => of(material, "Color", keys(color()).boxed()),
        1 => of(entity, "AmbientColor", keys(color()).boxed()),
        2 => of(camera, "Position", keys(point()).boxed()),
        2 => of(camera, "Target", keys(point()).boxed()),
    ]
}

/// The parts of a scene.
#[derive(Clone, Debug)]
struct Parts {
    transfer: &'static str,
    depth: u32,
    camera: String,
    ambient: String,
    background: String,
    materials: [String; 3],
    /// What each is, and perhaps the index of its parent.
    entities: Vec<(String, Option<usize>)>,
    animations: Vec<String>,
}

fn parts() -> impl Strategy<Value = Parts> {
    let depth = prop_oneof![20 => 1u32..8, 1 => Just(1000)];
    let settings = (prop::sample::select(vec!["Classic", "Srgb"]), depth, camera(), intensity(), color());
    let materials = [material(), material(), material()];
    let entities = prop::collection::vec((entity(), prop::option::weighted(0.3, 0..12usize)), 0..12);
    (settings, materials, entities, prop::collection::vec(animation(), 0..5)).prop_map(
        |((transfer, depth, camera, ambient, background), materials, entities, animations)| Parts {
            transfer,
            depth,
            camera,
            ambient,
            background,
            materials,
            entities,
            animations,
        },
    )
}

impl Parts {
    fn text(&self) -> String {
        let Self { transfer, depth, camera, ambient, background, materials: [m0, m1, m2], .. } = self;
        let mut entities = String::new();
        for (index, (what, parent)) in self.entities.iter().enumerate() {
            // An odd one out may make a ring.
            let parent = parent.filter(|parent| *parent < index || *parent == 11);
            let parent = parent.map_or_else(String::new, |parent| format!("parent: \"e{parent}\", "));
            entities += &format!("(name: \"e{index}\", {parent}{what}),\n");
        }
        let animations = self.animations.join(",\n");
        format!(
            r#"Scene(timeline: (fps: 5, duration: 2), film: (width: 32, height: 18, transfer: {transfer}),
            quality: (depth: {depth}), camera: ({camera}), ambient: {ambient}, background: {background},
            materials: {{ "m0": {m0}, "m1": {m1}, "m2": {m2} }},
            entities: [{entities}], animate: [{animations}])"#
        )
    }

    /// Leaves parts out that are refused, so that one of them does not waste the others.
    fn good(mut self) -> Result<Self, TestCaseError> {
        let alone = Self { entities: Vec::new(), animations: Vec::new(), ..self.clone() };
        if read(&alone.text())?.is_none() {
            "position: (0, 0, -9), target: (0, 0, 0)".clone_into(&mut self.camera);
        }
        let frame = Self { entities: Vec::new(), animations: Vec::new(), ..self.clone() };
        let mut entities = Vec::new();
        for (what, parent) in self.entities {
            if read(&Self { entities: vec![(what.clone(), None)], ..frame.clone() }.text())?.is_some() {
                entities.push((what, parent));
            }
        }
        let mut good = Self { entities, ..frame };
        for animation in self.animations {
            good.animations.push(animation);
            if read(&good.text())?.is_none() {
                good.animations.pop();
            }
        }
        Ok(good)
    }
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
