//! Tests of the messages for any change of a scene: they are in a reader's words, at the place of the change, with a remedy, and short.
//!
//! Every word, number, string and sign of a scene with every form of value is removed, doubled, and replaced with typical mistakes. Every
//! field is removed, duplicated and misspelled.

use std::collections::BTreeSet;
use std::ops::Range;

use rayon::prelude::*;
use rayreel::scene::SourcePosition;
use rayreel::{Engine, Scene};

/// A scene with every form of value.
const SCENE: &str = r##"Scene(
    timeline: (fps: (24, 1), duration: 4.5),
    film: (width: 64, height: 36, transfer: Srgb),
    quality: (depth: 5, cutoff: 0.25),
    sampling: (samples: 4, instants: 2, seed: 7, noise: PerFrame),
    camera: (position: (0, 2, -8), target: (0, 1, 0), up: (0, 1, 0), roll: 5, screen: (distance: 1, width: 1.6, height: 0.9), lens: (aperture: 0.1, focus: 8), shutter: 0.5),
    cameras: {
        "side": (position: (8, 2, 0), view: (-1, 0, 0), fov: 40, parent: "ball"),
        "near": (position: (0, 2, 3), look_at: "ball", follow: "crate"),
    },
    shots: [(0, "camera"), (2.5, "side")],
    ambient: (0.2, 0.2, 0.2),
    background: (bottom: (255, 255, 255), top: "#80b3ff"),
    fog: (color: (200, 200, 200), density: 0.05),
    materials: {
        "clay": (k_a: 0.3, k_d: 0.7, color: (255, 120, 60), ambient_color: "#ffffff", specular: (k_s: 0.4, shininess: 32), reflective: (k_r: 0.1)),
        "glass": (refractive: (k_t: 0.9, ior: 1.5, absorption: (0.1, 0.1, 0.1), fresnel: true)),
        "tiles": (k_d: 0.5, pattern: Checker(color: (0, 0, 0), size: 0.5)),
    },
    entities: [
        (name: "ball", shape: Sphere(radius: 1), material: "clay", transform: (translation: (0, 1, 0), rotation: Euler(0, 90, 0), scale: 2)),
        (name: "crate", parent: "ball", shape: Box(size: (1, 1, 1)), material: "glass", transform: (rotation: AxisAngle((0, 1, 0), 45), scale: (1, 2, 1))),
        (name: "floor", shape: Plane(normal: (0, 1, 0)), material: "tiles", transform: (rotation: Quat(0, 0, 0, 1))),
        (name: "lamp", light: Point(intensity: (1, 1, 1), falloff: (1, 0, 1))),
        (name: "sun", light: Directional(intensity: (1, 1, 1), direction: (0, -1, 0), casts_shadows: false)),
        (name: "spot", light: Spot(intensity: (1, 1, 1), angle: 40, softness: 0.5)),
        (name: "globe", light: Area(shape: Sphere(radius: 0.5), intensity: (1, 1, 1), samples: 16)),
        (name: "panel", light: Area(shape: Rectangle(width: 2, height: 1), intensity: (1, 1, 1))),
    ],
    animate: [
        (target: "ball", channel: Translation, track: Keys([(0, (0, 1, 0), CatmullRom), (2, (0, 3, 0), Handles((1, 0, 0), (0, 1, 0)))]), repeat: PingPong, offset: 0.5, speed: 2),
        (target: "ball", channel: Rotation, track: Keys([(0, Euler(0, 0, 0), EaseInOut), (1, AxisAngle((0, 1, 0), 90), Bezier(0.25, 0.1, 0.25, 1)), (2, Quat(0, 0, 0, 1))])),
        (target: "ball", channel: Scale, track: Keys([(0, 1), (1, (1, 2, 1), Steps(8))])),
        (material: "clay", channel: Color, track: Keys([(0, (255, 0, 0)), (1, "#00ff00")])),
        (target: "spot", channel: Angle, track: Keys([(0, 30), (1, 50, Hold)])),
        (target: "camera", channel: Position, track: Orbit(center: (0, 1, 0), radius: 8, axis: (0, 1, 0), height: 1, from: 0, turns: 1, start: 0, duration: 4, ease: InOutSine)),
        (target: "camera", channel: Target, track: Path(points: [(0, 1, 0), (1, 1, 0)], closed: false, start: 0, speed: 2, ease: Linear)),
    ],
)
"##;

/// Texts that people write by mistake.
const MISTAKES: [&str; 52] = [
    "\"words\"",
    "word",
    "Word(1)",
    "Word(x: 1)",
    "Sphere(radius: 1)",
    "Linear",
    "1",
    "-1",
    "2.5",
    "1e3",
    "1e300",
    "1e-61",
    "1e999",
    "99999999999999999999",
    "-99999999999999999999",
    "0x1F",
    "1f32",
    "12abc",
    "1.2.3",
    "--1",
    "1_",
    "_1",
    "1/2",
    "1..2",
    "..=3",
    "2*3",
    "50%",
    "NaN",
    "inf",
    "true",
    "TRUE",
    "None",
    "Some(1)",
    "()",
    "(1)",
    "(1, 2)",
    "(1, 2, 3)",
    "(1, 2, 3, 4, 5)",
    "(x: 0, y: 1, z: 2)",
    "[1, 2, 3]",
    "[]",
    "{ \"a\": 1 }",
    "{ a: 1 }",
    "'words'",
    "'w'",
    "“words”",
    "\"a\\qb\"",
    "\"ba\\u{110000}\"",
    "b\"words\"",
    "r#\"words\"#",
    "−1",
    "r#word",
];

/// Texts that are inserted by mistake.
const INTRUDERS: [&str; 20] = [
    "\u{a0}", "\u{200b}", "\u{feff}", "\u{3000}", "\u{7}", "，", "#", "/", ";", "=", "\\", "\"", "'", ":",
    ",", "/*", "*/", "# note\n", "x ", "1 ",
];

/// Words of parsers and programmers, which mean nothing to readers.
const FORBIDDEN: [&str; 41] = [
    "identifier",
    "std",
    "document",
    "struct",
    "newtype",
    "variant",
    "variants",
    "enum",
    "tuple",
    "sequence",
    "serde",
    "ron",
    "integer",
    "integers",
    "float",
    "floating",
    "f32",
    "f64",
    "u8",
    "u64",
    "i64",
    "usize",
    "signed",
    "unsigned",
    "boolean",
    "char",
    "chars",
    "string",
    "array",
    "option",
    "optional",
    "unexpected",
    "deserialize",
    "visitor",
    "extension",
    "attribute",
    "base",
    "bounds",
    "recursion",
    "escape",
    "token",
];

/// Accepted distance of an error from a change, in bytes: white space before a word, or the next word.
const NEAR: usize = 14;

/// Returns words, numbers, strings and signs.
fn tokens(text: &str) -> Vec<Range<usize>> {
    let (mut tokens, mut at) = (Vec::new(), 0);
    while let Some(first) = text[at..].chars().next() {
        let rest = &text[at..];
        let length = match first {
            '"' => rest[1..].find('"').unwrap() + 2,
            _ if first.is_alphanumeric() || "_+-.".contains(first) => {
                rest.find(|next: char| !(next.is_alphanumeric() || "_+-.".contains(next))).unwrap()
            }
            _ => first.len_utf8(),
        };
        if !first.is_whitespace() {
            tokens.push(at..at + length);
        }
        at += length;
    }
    tokens
}

/// Returns words, numbers, strings and signs. Of similar ones in the same context in fields of the same name, only the first is returned.
fn distinct_tokens(text: &str) -> Vec<Range<usize>> {
    let tokens = tokens(text);
    let alike = |token: &Range<usize>| match &text[token.clone()] {
        word if word.starts_with('"') => "\"",
        word if word.parse::<f64>().is_ok() => "0",
        word => word,
    };
    let (mut seen, mut field) = (BTreeSet::new(), "");
    let mut distinct = Vec::new();
    for (index, token) in tokens.iter().enumerate() {
        let around = &tokens[index.saturating_sub(2)..tokens.len().min(index + 2)];
        if around.last().is_some_and(|next| &text[next.clone()] == ":") {
            field = &text[token.clone()];
        }
        let place: Vec<&str> = around.iter().map(alike).collect();
        if seen.insert((field, place)) {
            distinct.push(token.clone());
        }
    }
    distinct
}

/// Returns the fields with their values, each from its name to the comma or bracket that ends it.
fn fields(text: &str) -> Vec<Range<usize>> {
    let tokens = tokens(text);
    let named = tokens.windows(2).enumerate().filter(|(_, pair)| &text[pair[1].clone()] == ":");
    let end = |index: usize| {
        let mut depth = 0;
        for token in &tokens[index..] {
            match &text[token.clone()] {
                "(" | "[" | "{" => depth += 1,
                ")" | "]" | "}" | "," if depth == 0 => return token.start,
                ")" | "]" | "}" => depth -= 1,
                _ => {}
            }
        }
        text.len()
    };
    named.map(|(index, pair)| pair[0].start..end(index)).collect()
}

/// A changed scene, and the place of the change.
struct Change {
    text: String,
    place: Range<usize>,
    /// Set if the change may cause errors elsewhere.
    reaches_far: bool,
}

fn changed(place: Range<usize>, by: &str, reaches_far: bool) -> Change {
    let mut text = SCENE.to_owned();
    text.replace_range(place.clone(), by);
    Change { text, place: place.start..place.start + by.len(), reaches_far }
}

fn changes() -> Vec<Change> {
    let mut changes = Vec::new();
    for token in distinct_tokens(SCENE) {
        let word = &SCENE[token.clone()];
        let is_bracket = "()[]{}".contains(word);
        let is_text = word.starts_with('"');
        changes.push(changed(token.clone(), "", is_bracket));
        changes.push(changed(token.end..token.end, &format!(" {word}"), is_bracket));
        for by in MISTAKES {
            // If a name changes, the errors are where it is used.
            let renames = is_text && (by.contains("words") || by == "None");
            let is_cut = is_bracket && word != "(" || by.contains(':');
            changes.push(changed(token.clone(), by, renames || is_cut || is_bracket));
        }
        for by in INTRUDERS {
            changes.push(changed(token.start..token.start, by, by.starts_with(['"', '\'', '*', '/'])));
        }
        if word.len() > 3 && word.is_ascii() && !is_text {
            changes.push(changed(token.start + 1..token.start + 2, "", false));
        }
        if is_text {
            changes.push(changed(token.start..token.start + 1, "", true));
            changes.push(changed(token.end - 1..token.end, "", true));
        }
    }
    for field in fields(SCENE) {
        let written = &SCENE[field.clone()];
        changes.push(changed(field.end..field.end, &format!(", {written}"), true));
        changes.push(changed(field.start..field.end + 1, "", true));
    }
    changes
}

/// Returns true if a text contains a word.
fn has_word(text: &str, word: &str) -> bool {
    text.to_lowercase().split(|sign: char| !sign.is_alphanumeric()).any(|part| part == word)
}

/// Returns the faults of the messages for a change.
fn faults(change: &Change) -> Vec<String> {
    let Err(error) = Scene::from_text("scene.ron", change.text.clone()) else { return Vec::new() };
    let mut faults = Vec::new();
    let lines = |place: &Range<usize>| {
        let line = |byte: usize| SourcePosition::of(&change.text, byte).line;
        line(place.start.saturating_sub(1))..=line(place.end)
    };
    for mistake in error.mistakes() {
        let diagnostic = mistake.diagnostic;
        let help = diagnostic.help.clone().unwrap_or_default();
        let message = [&diagnostic.message, &diagnostic.label, &help].map(String::as_str).join("\n");
        let forbidden = FORBIDDEN.iter().find(|word| has_word(&message, word));
        faults.extend(forbidden.map(|word| format!("says `{word}`")));
        for phrase in ["r#", "base 10", "unit v", "_[", "opening `", "closing `"] {
            if message.contains(phrase) && !change.text.contains(phrase) {
                faults.push(format!("says {phrase}"));
            }
        }
        if help.is_empty() {
            faults.push("has no remedy".to_owned());
        }
        if message.len() > 600 {
            faults.push("says too much".to_owned());
        }
        let marked = diagnostic.span.clone().unwrap_or_default();
        let quoted = diagnostic.label.strip_prefix("found the ").and_then(|rest| rest.split('`').nth(1));
        if quoted.is_some_and(|quoted| change.text[marked.clone()] != *quoted) {
            faults.push("marks another thing than it names".to_owned());
        }
        // A syntax error is at the change itself, or at a neighbour that the change made invalid.
        let is_near = marked.start <= change.place.end + NEAR && change.place.start <= marked.end + NEAR;
        if diagnostic.message.starts_with("expected ") && !(is_near || change.reaches_far) {
            faults.push("is not at the change".to_owned());
        }
        let is_there = mistake.position.is_some_and(|position| lines(&change.place).contains(&position.line));
        if !(is_there || change.reaches_far) {
            faults.push("is elsewhere".to_owned());
        }
    }
    for fault in &mut faults {
        *fault = format!("`{}` {fault}:\n{error}", &change.text[change.place.clone()]);
    }
    faults
}

#[test]
fn messages_use_plain_words() {
    assert!(Scene::from_text("scene.ron", SCENE.to_owned()).is_ok());
    let changes = changes();
    assert!(changes.len() > 20_000, "{}", changes.len());
    let faults: Vec<String> = changes.par_iter().flat_map_iter(faults).collect();
    let kinds: BTreeSet<&String> = faults.iter().collect();
    let some: Vec<String> = faults.iter().take(10).cloned().collect();
    assert!(
        faults.is_empty(),
        "{} of {}, {}:\n\n{}",
        faults.len(),
        changes.len(),
        kinds.len(),
        some.join("\n\n")
    );
}

/// Checks that names, numbers and words of any length, in any place, are quoted only in part.
#[test]
fn long_inputs_have_short_messages() {
    const LENGTH: usize = 10_000;
    let long = ["x", "7", "(", "[0,", "ß"].map(|piece| piece.repeat(LENGTH));
    let texts = ["x", "\\n", "\u{1b}"].map(|piece| format!("\"{}\"", piece.repeat(LENGTH)));
    for token in distinct_tokens(SCENE) {
        for by in long.iter().chain(&texts) {
            let Err(error) = Scene::from_text("scene.ron", changed(token.clone(), by, true).text) else {
                continue;
            };
            let mistakes = error.mistakes().count();
            let rendered = error.to_string();
            assert!(rendered.len() < 3000 * mistakes, "{} of {mistakes}", rendered.len());
            assert!(!rendered.contains('\u{1b}'));
            for mistake in error.mistakes() {
                let diagnostic = mistake.diagnostic;
                let help = diagnostic.help.as_deref().unwrap_or_default();
                let lengths = [diagnostic.message.len(), diagnostic.label.len(), help.len()];
                assert!(lengths.iter().all(|length| *length < 810), "{lengths:?}");
            }
        }
    }
}

#[test]
fn long_rings_are_shortened_in_messages() {
    let count = 100_000;
    let entities: String = (0..count)
        .map(|index| format!("(name: \"e{index}\", parent: \"e{}\"),", (index + 1) % count))
        .collect();
    let text = format!("(camera: (position: (0, 0, -5), target: (0, 0, 0)), entities: [{entities}])");
    let error = Scene::from_text("ring.ron", text).err().unwrap();
    let label = &error.mistakes().next().unwrap().diagnostic.label;
    let between = "(99993 more)";
    assert_eq!(
        *label,
        format!(
            "\"e0\" -> \"e1\" -> \"e2\" -> \"e3\" -> {between} -> \"e99997\" -> \"e99998\" -> \"e99999\" -> \"e0\""
        )
    );
    assert!(error.to_string().len() < 1000);
}

#[test]
fn further_mistakes_are_counted() {
    let with = |count: usize| {
        let entities: String = (0..count).map(|index| format!("(parent: \"nobody{index}\"),")).collect();
        let text = format!("(camera: (position: (0, 0, -5), target: (0, 0, 0)), entities: [{entities}])");
        Scene::from_text("many.ron", text).err().unwrap().to_string()
    };
    assert!(with(51).ends_with("and 1 more mistake"));
    assert!(with(52).ends_with("and 2 more mistakes"));
}

/// Checks that whole numbers may be written with a point or an exponent.
#[test]
fn integers_are_accepted_in_any_notation() {
    let plain = "(timeline: (fps: 24, duration: 2), film: (width: 640, height: 360), sampling: (samples: 4, seed: 100),
        camera: (position: (0, 0, -5), target: (0, 0, 0)))";
    let other =
        plain.replace("24,", "24.0,").replace("640", "6.4e2").replace("360", "360.00").replace("4,", "4.,");
    let other = other.replace("100", "1e2");
    let read = |text: &str| Engine::from_scene(Scene::from_text("whole.ron", text.to_owned()).unwrap());
    let (plain, other) = (read(plain), read(&other));
    assert_eq!(plain.effective_settings().film, other.effective_settings().film);
    assert_eq!(plain.effective_settings().sampling, other.effective_settings().sampling);
    assert_eq!(plain.timeline, other.timeline);
    let refused = |number: &str| {
        let text = format!("(camera: (position: (0, 0, -5), target: (0, 0, 0)), sampling: (seed: {number}))");
        Scene::from_text("part.ron", text)
            .err()
            .unwrap()
            .mistakes()
            .next()
            .unwrap()
            .diagnostic
            .message
            .clone()
    };
    for part in ["2.5", "-1", "-1.0", "1e-3", "NaN", "\"4\""] {
        assert_eq!(refused(part), "expected a whole number", "{part}");
    }
    // Beyond 2^53, not every whole number has an exact `f64`.
    for large in ["18446744073709551616", "9007199254740993.0", "1e300", "inf"] {
        assert_eq!(refused(large), "this whole number is too large", "{large}");
    }
}
