//! Tests of options that override a scene's values and effects.

use std::fs;
use std::path::Path;

use serde_json::Value;

use crate::{rayreel, stdout_of, text};

const SCENE: &str = "Scene(
    film: (width: 48, height: 27),
    camera: (position: (0, 1.5, -6), target: (0, 0.8, 0), fov: 40),
    ambient: (0.3, 0.3, 0.3),
    include: [(file: \"parts/things.ron\", name: \"set\")],
    materials: { \"floor\": (k_a: 0.4, k_d: 0.8, color: (200, 190, 170)) },
    entities: [
        (name: \"floor\", shape: Plane(normal: (0, 1, 0)), material: \"floor\"),
        (name: \"lamp\", light: Point(intensity: (1, 1, 1), casts_shadows: true), transform: (translation: (-3, 5, -4))),
    ],
)
";

const THINGS: &str = "Scene(
    materials: { \"ball\": (k_a: 0.4, k_d: 0.8, color: (220, 60, 40)) },
    entities: [(name: \"ball\", shape: Sphere(radius: 1), transform: (translation: (0, 1, 0)), material: \"ball\")],
)
";

/// Writes the scene and its included file, with text replacements.
fn write(folder: &Path, edits: &[(&str, &str)]) {
    let edited = |text: &str| edits.iter().fold(text.to_owned(), |text, (from, to)| text.replace(from, to));
    fs::create_dir_all(folder.join("parts")).unwrap();
    fs::write(folder.join("a.ron"), edited(SCENE)).unwrap();
    fs::write(folder.join("parts/things.ron"), edited(THINGS)).unwrap();
}

/// Renders the scene's frame, and returns its pixels.
fn frame(folder: &Path, arguments: &[&str]) -> Vec<u8> {
    stdout_of(folder, [&["render", "a.ron", "--out", "o", "--format", "ppm", "--json"], arguments].concat());
    image::open(folder.join("o/a.0000.ppm")).unwrap().to_rgb8().into_raw()
}

#[test]
fn overridden_value_equals_an_edit() {
    let folder = tempfile::tempdir().unwrap();
    let folder = folder.path();
    for (arguments, edit) in [
        (&["--set", "camera.fov=55"][..], ("fov: 40", "fov: 55")),
        (&["--samples", "3"], ("ambient:", "sampling: (samples: 3), ambient:")),
        (
            &["--samples", "9", "--set", "sampling.samples=3"],
            ("ambient:", "sampling: (samples: 3), ambient:"),
        ),
        (&["--set", "entities.lamp.transform.translation.0=3"], ("(-3, 5, -4)", "(3, 5, -4)")),
        (
            &["--set", "entities.ball.shape=Box(size: (1, 2, 1))"],
            ("Sphere(radius: 1)", "Box(size: (1, 2, 1))"),
        ),
        (
            &["--set", "materials.ball.reflective=(k_r: 0.5)", "--depth", "1"],
            ("ambient:", "quality: (depth: 1), ambient:"),
        ),
        (&["--without", "shadows"], ("casts_shadows: true", "casts_shadows: false")),
        (
            &["--without", "Diffuse_Light", "--without", "ambient-light"],
            ("k_a: 0.4, k_d: 0.8", "k_a: 0, k_d: 0"),
        ),
        (&["--without", "diffuse,ambient"], ("k_a: 0.4, k_d: 0.8", "k_a: 0, k_d: 0")),
        (&["--only", "ambient"], ("k_d: 0.8", "k_d: 0")),
        (&["--only", "diffuse-light,shadows"], ("k_a: 0.4", "k_a: 0")),
    ] {
        write(folder, &[]);
        let plain = frame(folder, &[]);
        let set = frame(folder, arguments);
        let edits = if arguments[1].starts_with("materials") {
            vec![edit, ("color: (220, 60, 40)", "color: (220, 60, 40), reflective: (k_r: 0.5)")]
        } else {
            vec![edit]
        };
        write(folder, &edits);
        assert!(set == frame(folder, &[]), "{arguments:?}");
        // A depth of 1 traces no reflections.
        assert!(set != plain || arguments.contains(&"--depth"), "{arguments:?}");
    }
}

#[test]
fn overrides_are_listed_in_reports() {
    let folder = tempfile::tempdir().unwrap();
    write(folder.path(), &[]);
    let arguments = ["render", "a.ron", "--set", "camera.fov=55", "--samples", "2", "--without", "shadows"];
    let output = rayreel(folder.path(), arguments);
    let expected = "instead of the scene's own: sampling.samples=2, camera.fov=55, no shadows\n";
    assert!(text(&output.stderr).contains(expected), "{}", text(&output.stderr));
    let report: Value =
        serde_json::from_str(&stdout_of(folder.path(), arguments.into_iter().chain(["--json"]))).unwrap();
    assert_eq!(report["overrides"], serde_json::json!(["sampling.samples=2", "camera.fov=55"]));
    assert_eq!(report["without"], serde_json::json!(["shadows"]));
    let explained = stdout_of(folder.path(), ["explain", "a.ron", "--without", "shadows"]);
    assert!(explained.contains("\ninstead of the scene's own: no shadows\n"), "{explained}");
    let explained: Value = serde_json::from_str(&stdout_of(
        folder.path(),
        ["explain", "a.ron", "--without", "shadows", "--json"],
    ))
    .unwrap();
    assert_eq!(explained["without"], serde_json::json!(["shadows"]));
    let shadows =
        explained["effects"].as_array().unwrap().iter().find(|effect| effect["effect"] == "shadows").unwrap();
    assert_eq!(shadows["spans"][0]["needed"], false);
}

#[test]
fn invalid_override_is_reported_like_a_mistake_in_the_file() {
    let folder = tempfile::tempdir().unwrap();
    write(folder.path(), &[]);
    let wrong = |value: &str| {
        let output = rayreel(folder.path(), ["check", "a.ron", "--set", value]);
        assert_eq!(output.status.code(), Some(1), "{value}");
        text(&output.stderr)
    };
    assert_eq!(
        wrong("camera.fov=400"),
        "error: the field of view must be between 0 and 180 degrees, not 400
 --> a.ron:3:64
  |
3 |     camera: (position: (0, 1.5, -6), target: (0, 0.8, 0), fov: 400),
  |                                                                ^^^ out of range
  |
  = help: write the vertical angle, as 45
  = note: read with camera.fov=400

a.ron: 1 mistake
"
    );
    let shown = wrong("entities.ball.shape.radius=-1");
    assert!(
        shown.contains("parts/things.ron:3:")
            && shown.contains("= note: read with entities.ball.shape.radius=-1"),
        "{shown}"
    );
    let shown = wrong("camera.fow=40");
    assert!(shown.contains("fow: 40") && shown.contains("did you mean `fov`?"), "{shown}");
    assert_eq!(
        wrong("entities.bal.shape.radius=1"),
        "error: `entities.bal.shape.radius=1`: there is no entity called `bal`
--> a.ron
 = help: did you mean `ball`?

a.ron: 1 mistake
"
    );
}

#[test]
fn invalid_override_syntax_is_a_usage_error() {
    let folder = tempfile::tempdir().unwrap();
    write(folder.path(), &[]);
    for (arguments, expected) in [
        (["--set", "camera.fov"], "write a path into the scene, = and a value, as in camera.fov=40"),
        (["--set", "camera.fov=1, roll: 2"], "`1, roll: 2` is not one value: write it as in the file"),
        (["--samples", "many"], "write a whole number"),
        (["--without", "shadow"], "did you mean `shadows`?"),
        (["--only", "ambient-lihgt"], "did you mean `ambient-light`?"),
        (
            ["--without", "xyz"],
            "the effects are ambient-light, ambient-occlusion, emission, diffuse-light, highlights, shadows, transparent-shadows",
        ),
    ] {
        let output = rayreel(folder.path(), ["render", "a.ron"].into_iter().chain(arguments));
        assert_eq!(output.status.code(), Some(2), "{arguments:?}");
        assert!(text(&output.stderr).contains(expected), "{}", text(&output.stderr));
    }
    let output = rayreel(folder.path(), ["render", "a.ron", "--samples", "0"]);
    assert_eq!(output.status.code(), Some(1));
    assert!(text(&output.stderr).contains("sampling: (samples: 0)"), "{}", text(&output.stderr));
}

#[test]
fn names_with_dots_report_the_quoted_form() {
    let folder = tempfile::tempdir().unwrap();
    let folder = folder.path();
    write(folder, &[("name: \"ball\"", "name: \"Sphere.001\"")]);
    let output = rayreel(folder, ["check", "a.ron", "--set", "entities.Sphere.001.shape.radius=2"]);
    let help = text(&output.stderr);
    assert!(help.contains("'entities.\"Sphere.001\"...'"), "{help}");
    let changed = frame(folder, &["--set", "entities.\"Sphere.001\".shape.radius=2"]);
    assert_ne!(changed, frame(folder, &[]));
}

#[test]
fn long_values_are_shortened_in_every_message() {
    let folder = tempfile::tempdir().unwrap();
    let folder = folder.path();
    write(folder, &[]);
    let long = "a".repeat(100_000);
    for set in [
        format!("camera.fov={long}"),
        format!("camera.fov=[{long}]"),
        format!("camera.fov=\"{long}\""),
        format!("camera.{long}=3"),
        format!("{long}=3"),
        format!("entities.{long}.shape=3"),
        format!("entities.lamp.{long}.b=3"),
        format!("entities.lamp.name.{long}=3"),
        format!("materials.floor.color={long}"),
        format!("film.transfer={long}"),
        format!("camera.fov={0} {0}", &long[..50_000]),
        format!("\"{long}"),
        long.clone(),
    ] {
        for json in [&[][..], &["--json"]] {
            let output = rayreel(folder, [&["check", "a.ron", "--set", set.as_str()], json].concat());
            assert!(!output.status.success());
            let message = [text(&output.stdout), text(&output.stderr)].concat();
            assert!(
                message.len() < 2000,
                "{} letters for {}: {}",
                message.len(),
                &set[..20],
                &message[..1000]
            );
        }
    }
}
