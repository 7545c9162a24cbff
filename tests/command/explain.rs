//! Tests of `rayreel explain` on a scene whose effects start and end over its timeline, and whose rays and colours can be computed by hand.

use std::fs;
use std::process::Output;

use serde_json::{Value, json};

use crate::{rayreel, stdout_of, text};

/// A floor that fills the picture, viewed and lit from straight above, and a marble outside the picture. Ambient light contributes 0.2 of
/// full white. More is added between frames: diffuse light of 0.4 from frame 3, a reflection of 0.2 from frame 5, and a highlight of 0.2 as
/// wide as the floor from frame 8.
const COMING_AND_GOING: &str = r#"Scene(
    timeline: (fps: 10, duration: 1),
    film: (width: 64, height: 36, transfer: Classic),
    sampling: (samples: 4, instants: 2),
    camera: (position: (0, 5, 0), target: (0, 0, 0), up: (0, 0, 1), fov: 30, shutter: 0.5),
    ambient: (1, 1, 1),
    background: (255, 255, 255),
    fog: (color: (255, 255, 255), density: 0),
    materials: {
        "floor": (k_a: 0.2, k_d: 0.4, color: (255, 255, 255), specular: (k_s: 0, shininess: 0), reflective: (k_r: 0)),
        "glass": (k_a: 0, k_d: 0, color: (255, 255, 255), refractive: (k_t: 0, ior: 1.5)),
    },
    entities: [
        (name: "floor", shape: Plane(normal: (0, 1, 0)), material: "floor"),
        (name: "marble", shape: Sphere(radius: 1), transform: (translation: (1000, 1, 0)), material: "glass"),
        (name: "sun", light: Directional(direction: (0, -1, 0), intensity: (0, 0, 0))),
    ],
    animate: [
        (target: "sun", channel: Intensity, track: Keys([(0, (0, 0, 0), Hold), (0.25, (1, 1, 1))])),
        (target: "floor", channel: Kr, track: Keys([(0, 0, Hold), (0.45, 0.2)])),
        (target: "marble", channel: Kt, track: Keys([(0, 0, Hold), (0.55, 0.9)])),
        (target: "marble", channel: Translation, track: Keys([(0.65, (1000, 1, 0)), (1, (1010, 1, 0))])),
        (target: "floor", channel: Ks, track: Keys([(0, 0, Hold), (0.75, 0.2)])),
    ],
)
"#;

/// Number of camera rays in a frame: all pixels, four samples each.
const CAMERA: f64 = 64.0 * 36.0 * 4.0;

/// Runs `rayreel explain` in a folder with the scene.
fn explain(arguments: &[&str]) -> Output {
    let folder = tempfile::tempdir().unwrap();
    fs::write(folder.path().join("scene.ron"), COMING_AND_GOING).unwrap();
    fs::write(folder.path().join("broken.ron"), "Scene(camra: ())").unwrap();
    rayreel(folder.path(), [&["explain"], arguments].concat())
}

fn explained(arguments: &[&str]) -> Value {
    let output = explain(&[&["scene.ron", "--json"], arguments].concat());
    assert!(output.status.success(), "{}", text(&output.stderr));
    serde_json::from_slice(&output.stdout).unwrap()
}

/// Returns the report of an effect.
fn effect<'a>(report: &'a Value, name: &str) -> &'a Value {
    report["effects"].as_array().unwrap().iter().find(|effect| effect["effect"] == name).unwrap()
}

/// Returns the frames of each span of an effect, the need for the effect, and the reason.
fn spans(report: &Value, name: &str) -> Vec<(Value, bool, String)> {
    let all = effect(report, name)["spans"].as_array().unwrap();
    let span = |span: &Value| {
        (span["frames"].clone(), span["needed"].as_bool().unwrap(), span["why"].as_str().unwrap().to_owned())
    };
    all.iter().map(span).collect()
}

/// Returns the cells of a table row without the time column. Two or more blanks separate cells; a cell contains no two blanks in a row.
fn cells(line: &str) -> Vec<&str> {
    let cells = line.split("  ").map(str::trim).filter(|cell| !cell.is_empty());
    cells.filter(|cell| *cell != "time" && !cell.ends_with('%')).collect()
}

#[test]
fn every_effect_has_its_frames_and_reasons() {
    let report = explained(&[]);
    assert_eq!((&report["scene"], &report["frames"]), (&json!("scene.ron"), &json!(10)));
    assert_eq!((&report["width"], &report["height"]), (&json!(64), &json!(36)));
    assert_eq!(report["measured"], Value::Null);
    let expected = [
        ("ambient light", vec![(json!([[0, 9]]), true, "k_a is above 0")]),
        ("ambient occlusion", vec![(json!([[0, 9]]), false, "the scene has no `ambient_occlusion`")]),
        ("emission", vec![(json!([[0, 9]]), false, "no material has `emission`")]),
        (
            "diffuse light",
            vec![
                (json!([[0, 2]]), false, "all lights are off at this time"),
                (json!([[3, 9]]), true, "k_d is above 0 and a light is on"),
            ],
        ),
        (
            "highlights",
            vec![
                (json!([[0, 2]]), false, "all lights are off at this time"),
                (json!([[3, 7]]), false, "k_s is 0 at this time"),
                (json!([[8, 9]]), true, "k_s is above 0 and a light is on"),
            ],
        ),
        (
            "shadows",
            vec![
                (json!([[0, 2]]), false, "all lights are off at this time"),
                (json!([[3, 9]]), true, "a light casts shadows"),
            ],
        ),
        (
            "transparent shadows",
            vec![
                (json!([[0, 2]]), false, "all lights are off at this time"),
                (json!([[3, 5]]), false, "k_t is 0 at this time"),
                (json!([[6, 9]]), true, "a light casts shadows, and a surface is transparent"),
            ],
        ),
        ("area lights", vec![(json!([[0, 9]]), false, "there are no area lights")]),
        ("spot lights", vec![(json!([[0, 9]]), false, "no light is a spot light")]),
        ("falloff", vec![(json!([[0, 9]]), false, "no light has `falloff`")]),
        (
            "reflection",
            vec![
                (json!([[0, 4]]), false, "k_r is 0 at this time"),
                (json!([[5, 9]]), true, "k_r is above 0"),
            ],
        ),
        // The floor, once reflective, could show the marble.
        (
            "refraction",
            vec![
                (json!([[0, 5]]), false, "k_t is 0 at this time"),
                (json!([[6, 9]]), true, "k_t is above 0"),
            ],
        ),
        (
            "Fresnel",
            vec![
                (json!([[0, 5]]), false, "k_t is 0 at this time"),
                (json!([[6, 9]]), false, "no material has `fresnel`"),
            ],
        ),
        (
            "absorption",
            vec![
                (json!([[0, 5]]), false, "k_t is 0 at this time"),
                (json!([[6, 9]]), false, "no medium absorbs"),
            ],
        ),
        ("patterns", vec![(json!([[0, 9]]), false, "no material has `pattern`")]),
        ("fog", vec![(json!([[0, 9]]), false, "its density is 0")]),
        ("gradient", vec![(json!([[0, 9]]), false, "the background is the same everywhere")]),
        ("sun", vec![(json!([[0, 9]]), false, "the scene has no `sun`")]),
        ("stars", vec![(json!([[0, 9]]), false, "the scene has no `stars`")]),
        ("ray visibility", vec![(json!([[0, 9]]), false, "all rays see all shapes")]),
        ("antialiasing", vec![(json!([[0, 9]]), true, "a pixel has several samples")]),
        ("depth of field", vec![(json!([[0, 9]]), false, "the camera has no lens")]),
        (
            "motion blur",
            vec![
                (json!([[0, 6]]), false, "nothing moves while the shutter is open"),
                (json!([[7, 9]]), true, "something moves while the shutter is open"),
            ],
        ),
    ];
    assert_eq!(report["effects"].as_array().unwrap().len(), expected.len());
    for (effect, (name, _)) in report["effects"].as_array().unwrap().iter().zip(&expected) {
        assert_eq!(effect["effect"], *name);
    }
    for (name, expected) in expected {
        let found = spans(&report, name);
        let found: Vec<_> =
            found.iter().map(|(frames, needed, why)| (frames.clone(), *needed, why.as_str())).collect();
        assert_eq!(found, expected, "{name}");
    }
}

#[test]
fn effect_costs_count_rays_and_errors() {
    let report = explained(&["--measure"]);
    // Frame 0 has camera rays, frame 4 also shadow rays, and frame 9 also reflection rays.
    assert_eq!(report["measured"]["rays"], json!(CAMERA * (1.0 + 2.0 + 3.0) / 3.0));
    assert!(report["measured"]["seconds"].as_f64().unwrap() > 0.0);
    // Columns: rays over the three frames in units of a frame's camera rays, the largest error, and the number of frames with that error.
    for (name, rays, max_error, frames) in [
        ("ambient light", 0.0, 51, 3.0),
        // In frame 9 the highlight needs the shadow rays, too.
        ("diffuse light", 1.0, 102, 2.0),
        ("highlights", 0.0, 51, 1.0),
        ("shadows", 2.0, 0, 0.0),
        ("transparent shadows", 0.0, 0, 0.0),
        ("reflection", 1.0, 51, 1.0),
        ("refraction", 0.0, 0, 0.0),
        // It adds three of four samples.
        ("antialiasing", 0.75 * 6.0, 0, 0.0),
        ("motion blur", 0.0, 0, 0.0),
    ] {
        let cost = &effect(&report, name)["cost"];
        assert_eq!(cost["rays"], json!(CAMERA * rays / 3.0), "{name}");
        assert!((cost["max_error"].as_f64().unwrap() - f64::from(max_error)).abs() < 1e-4, "{name}");
        let rms_error = f64::from(max_error) * (frames / 3.0_f64).sqrt();
        assert!((cost["rms_error"].as_f64().unwrap() - rms_error).abs() < 1e-4, "{name}");
        let [low, share, high] = ["share_low", "share", "share_high"].map(|key| cost[key].as_f64().unwrap());
        assert!(0.0 <= low && low <= share && share <= high && high <= 1.0, "{name}");
    }
    for name in ["area lights", "fog", "depth of field"] {
        assert_eq!(effect(&report, name)["cost"], Value::Null, "{name}");
    }
    let unmeasured = explained(&["--frames", "0"]);
    assert_eq!(effect(&unmeasured, "ambient light")["cost"], Value::Null);
    assert_eq!(report["measured"]["frames"], json!([0, 4, 9]));
}

#[test]
fn text_output_is_a_table_of_the_json_values() {
    let output = explain(&["scene.ron", "--measure"]);
    assert!(output.status.success() && output.stderr.is_empty());
    let found = text(&output.stdout);
    assert!(!found.contains('\u{1b}'));
    let mut blocks = found.split("\n\n");
    assert_eq!(blocks.next(), Some("scene.ron: 10 frames of 64x36"));
    let sentences = [
        "Every frame needs ambient light, antialiasing.",
        "Some need diffuse light, highlights, shadows, transparent shadows, reflection, refraction, motion blur.",
        "No frame needs the other 14.",
    ];
    assert_eq!(blocks.next(), Some(sentences.join("\n").as_str()));
    let measured = blocks.next().unwrap();
    assert!(measured.starts_with("Measured at frames 0, 4 and 9: 18 k rays in "), "{measured}");
    assert!(measured.ends_with(" s, on average."), "{measured}");
    let needed: Vec<_> = blocks.next().unwrap().lines().map(cells).collect();
    let expected = [
        ["needed", "frames", "why", "rays", "max error", "rms error"],
        ["ambient light", "all", "k_a is above 0", "-", "51.0", "51.00"],
        ["diffuse light", "3-9", "k_d is above 0 and a light is on", "3 k", "102.0", "83.28"],
        ["highlights", "8-9", "k_s is above 0 and a light is on", "-", "51.0", "29.44"],
        ["shadows", "3-9", "a light casts shadows", "6 k", "0.0", "0.00"],
        [
            "transparent shadows",
            "6-9",
            "a light casts shadows, and a surface is transparent",
            "-",
            "0.0",
            "0.00",
        ],
        ["reflection", "5-9", "k_r is above 0", "3 k", "51.0", "29.44"],
        ["refraction", "6-9", "k_t is above 0", "-", "0.0", "0.00"],
        ["antialiasing", "all", "a pixel has several samples", "14 k", "0.0", "0.00"],
        ["motion blur", "7-9", "something moves while the shutter is open", "-", "0.0", "0.00"],
    ];
    assert_eq!(needed, expected);
    let omitted = blocks.next().unwrap();
    for line in [
        "omitted              frames  why",
        "highlights           0-2     all lights are off at this time",
        "highlights           3-7     k_s is 0 at this time",
        "fog                  all     its density is 0",
        "motion blur          0-6     nothing moves while the shutter is open",
    ] {
        assert!(omitted.lines().any(|found| found == line), "{line}\n{omitted}");
    }
    assert_eq!(omitted.lines().count(), 1 + 25);
    assert_eq!(blocks.next(), None);
}

#[test]
fn text_output_without_measurements_has_reasons_only() {
    let output = explain(&["scene.ron"]);
    assert!(output.status.success() && output.stderr.is_empty());
    let found = text(&output.stdout);
    let blocks: Vec<&str> = found.split("\n\n").collect();
    assert!(blocks[1].starts_with("Every frame needs ambient light, antialiasing.\n"), "{found}");
    let needed: Vec<_> = blocks[2].lines().map(cells).collect();
    assert_eq!(needed[0], ["needed", "frames", "why"]);
    assert_eq!(needed[3], ["highlights", "8-9", "k_s is above 0 and a light is on"]);
    assert!(blocks[3].starts_with("omitted "), "{found}");
    assert_eq!(blocks.len(), 4);
}

#[test]
fn only_selected_frames_are_explained() {
    let report = explained(&["--frames", "8,1-7x2", "--size", "8x2"]);
    assert_eq!((&report["width"], &report["height"], &report["frames"]), (&json!(8), &json!(2), &json!(5)));
    // Spans have no gaps among the chosen frames 1, 3, 5, 7 and 8.
    assert_eq!(spans(&report, "highlights")[1].0, json!([[3, 7]]));
    assert_eq!(spans(&report, "highlights")[2].0, json!([[8, 8]]));
    let measured = explained(&["--frames", "8,1-7x2", "--size", "8x2", "--measure"]);
    assert_eq!(measured["measured"]["frames"], json!([1, 5, 8]));
    let output = explain(&["scene.ron", "--frames", "2", "--size", "8x2", "--measure"]);
    let found = text(&output.stdout);
    assert!(found.starts_with("scene.ron: 1 frame of 8x2\n"), "{found}");
    assert!(
        found.contains("\nEvery frame needs ambient light, antialiasing.\nNo frame needs the other "),
        "{found}"
    );
    assert!(!found.contains("on average"), "{found}");
}

#[test]
fn invalid_options_report_the_valid_form() {
    for (arguments, code, expected) in [
        (
            vec!["scene.ron", "--frames", "5-10"],
            1,
            "there is no frame 10: the timeline of 1 s at 10 frames a second has frames 0 to 9",
        ),
        (vec!["scene.ron", "--frames", "9-3"], 2, "`9-3` runs backwards"),
        (vec!["scene.ron", "--size", "8"], 2, "write width and height in pixels, as in 1280x720"),
        (vec!["scene.ron", "--size", "8x0"], 2, "each side must be from 1 to 32768 pixels"),
        (vec!["scene.ron", "--size", "32768x32768"], 2, "has at most 268435456 pixels"),
        (vec!["scene.ron", "--threads", "0"], 2, "from 1 to 1024"),
        (vec!["nothing.ron"], 1, "there is no file `nothing.ron`"),
        (vec!["broken.ron", "--json"], 1, "camra"),
        (vec![], 2, "<SCENE>"),
    ] {
        let output = explain(&arguments);
        let error = text(&output.stderr);
        assert_eq!(output.status.code(), Some(code), "{arguments:?}");
        assert!(error.contains(expected), "{arguments:?}: {error}");
        assert!(output.stdout.is_empty(), "{arguments:?}");
    }
}

/// Checks a timeline of a hundred million frames, of which ten thousand are examined.
#[test]
fn long_timelines_are_sampled() {
    let folder = tempfile::tempdir().unwrap();
    let (before, after) = ("(fps: 10, duration: 1)", "(fps: 1000000, duration: 100)");
    fs::write(folder.path().join("long.ron"), COMING_AND_GOING.replace(before, after)).unwrap();
    let explain =
        |arguments: &[&str]| stdout_of(folder.path(), [&["explain", "long.ron"], arguments].concat());
    let report: Value = serde_json::from_str(&explain(&["--json"])).unwrap();
    assert_eq!((&report["frames"], &report["spread_over"]), (&json!(10_000), &json!(100_000_000)));
    // The light turns on at frame 250 000, between the examined frames 240 024 and 250 025.
    let lit = &spans(&report, "diffuse light")[1];
    assert_eq!((&lit.0, lit.1), (&json!([[250_025, 99_999_999]]), true));
    let words = explain(&[]);
    assert!(words.starts_with("long.ron: 10000 of 100000000 frames, spread evenly, of 64x36\n"), "{words}");
    assert!(words.contains("--frames looks at some of them one by one"), "{words}");
    // Ten thousand chosen frames are all examined.
    let report: Value = serde_json::from_str(&explain(&["--json", "--frames", "240000-249999"])).unwrap();
    assert_eq!((&report["frames"], &report["spread_over"]), (&json!(10_000), &Value::Null));
    assert!(!explain(&["--frames", "7-8"]).contains("--frames"));
}
