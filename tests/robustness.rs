//! No text and no numbers make it panic, hang, or put anything on a film that is not a finite number.
//!
//! `RAYREEL_CASES` asks for more than the usual few hundred cases.

#![allow(clippy::unwrap_used, reason = "a test may fail loudly")]

use proptest::prelude::*;
use proptest::test_runner::RngSeed;

use rayreel::scene::TEMPLATE;
use rayreel::{Engine, Scene};

fn config() -> ProptestConfig {
    let cases = std::env::var("RAYREEL_CASES").ok().and_then(|cases| cases.parse().ok()).unwrap_or(400);
    ProptestConfig { cases, failure_persistence: None, rng_seed: seed(), ..ProptestConfig::default() }
}

/// A change to a text: at some place, take some characters away and put others there.
#[derive(Clone, Debug)]
struct Edit {
    place: f64,
    removed: usize,
    inserted: String,
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
    (0.0..1.0f64, prop_oneof![Just(0usize), 0..4usize, 0..60usize], words)
        .prop_map(|(place, removed, word)| Edit { place, removed, inserted: word.to_owned() })
}

fn edited(text: &str, edits: &[Edit]) -> String {
    let mut characters: Vec<char> = text.chars().collect();
    for Edit { place, removed, inserted } in edits {
        #[expect(clippy::cast_possible_truncation, clippy::cast_sign_loss, reason = "a place in the text")]
        let start = (place * characters.len() as f64) as usize;
        let end = (start + removed).min(characters.len());
        characters.splice(start..end, inserted.chars());
    }
    characters.into_iter().collect()
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
        1e300,
        0.1,
        1.0 + f64::EPSILON,
    ]);
    prop_oneof![3 => -3.0..3.0f64, 2 => extreme, 1 => (-8i32..8).prop_map(f64::from)]
}

fn triple() -> impl Strategy<Value = String> {
    (number(), number(), number()).prop_map(|(x, y, z)| format!("({x:?}, {y:?}, {z:?})"))
}

/// An entity with any numbers: often refused, which is an answer too.
fn entity() -> impl Strategy<Value = String> {
    let shape = prop_oneof![
        number().prop_map(|radius| format!("shape: Sphere(radius: {radius:?}), material: \"m\"")),
        triple().prop_map(|size| format!("shape: Box(size: {size}), material: \"m\"")),
        triple().prop_map(|normal| format!("shape: Plane(normal: {normal}), material: \"m\"")),
        triple().prop_map(|direction| format!(
            "light: Directional(intensity: (1, 1e29, 0), direction: {direction})"
        )),
        Just("light: Point(intensity: (1e30, 1, 0))".to_owned()),
    ];
    let rotation = prop_oneof![
        3 => Just("Euler(0, 0, 0)".to_owned()),
        1 => (triple(), number()).prop_map(|(axis, angle)| format!("AxisAngle({axis}, {angle:?})")),
    ];
    let parent = prop_oneof![2 => Just(""), 1 => Just("parent: \"p\", ")];
    (shape, triple(), rotation, triple(), parent).prop_map(|(shape, translation, rotation, scale, parent)| {
        format!("({parent}{shape}, transform: (translation: {translation}, rotation: {rotation}, scale: {scale})),")
    })
}

/// The same cases every time, unless more of them are asked for.
fn seed() -> RngSeed {
    if std::env::var_os("RAYREEL_CASES").is_some() { RngSeed::Random } else { RngSeed::Fixed(2026) }
}

proptest! {
    #![proptest_config(config())]

    #[test]
    fn no_text_makes_it_panic(edits in prop::collection::vec(edit(), 1..6)) {
        match Scene::from_text("edited.ron", edited(TEMPLATE, &edits)) {
            Ok(scene) => drop(scene),
            Err(error) => {
                prop_assert!(error.to_string().starts_with("error: "));
                prop_assert!(!error.diagnostics().is_empty());
                for diagnostic in error.diagnostics() {
                    prop_assert!(diagnostic.span.is_none() || error.place(diagnostic).is_some());
                }
            }
        }
    }

    #[test]
    fn no_numbers_make_it_panic(
        entities in prop::collection::vec(entity(), 0..12),
        camera in (triple(), triple(), triple()),
        parent in (triple(), triple()),
    ) {
        let (position, view, up) = camera;
        let (translation, scale) = parent;
        // Each entity alone first, so that one refused number does not waste the others.
        let scene = |entities: &str| format!(
            r#"Scene(film: (width: 8, height: 5), camera: (position: {position}, view: {view}, up: {up}), ambient: (1, 1, 1),
            background: (9, 9, 9), materials: {{ "m": (k_a: 0.5, k_d: 0.5, reflective: (k_r: 0.9)) }},
            entities: [(name: "p", transform: (translation: {translation}, scale: {scale})), {entities}])"#
        );
        let good = |entity: &&String| Scene::from_text("random.ron", scene(entity)).is_ok();
        let entities: String = entities.iter().filter(good).map(String::as_str).collect();
        if let Ok(scene) = Scene::from_text("random.ron", scene(&entities)) {
            let mut engine = Engine::from_scene(scene);
            let film = engine.render_frame(0).unwrap();
            prop_assert!(film.pixels().iter().all(|pixel| pixel.is_finite() && pixel.min_element() >= 0.0));
            let reference = engine.render_reference(rayreel::Time::ZERO).unwrap();
            prop_assert!(film == reference, "the paths differ");
        }
    }
}
