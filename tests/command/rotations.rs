//! Tests of warnings about rotation keys more than half a turn apart, between which an entity rotates the short way.

use std::fs;

use serde_json::Value;

use crate::{rayreel, stdout_of, text};

fn scene(keys: &str) -> String {
    format!(
        "(timeline: (fps: 5, duration: 2), film: (width: 8, height: 4), camera: (position: (0, 1, -5), target: (0, 0, 0)),
        ambient: (1, 1, 1), materials: {{ \"m\": (k_a: 1) }},
        entities: [(name: \"arm\", shape: Box(size: (2, 1, 1)), material: \"m\")],
        animate: [(target: \"arm\", channel: Rotation, track: Keys([{keys}]))])"
    )
}

#[test]
fn keys_further_apart_than_half_a_turn_are_reported() {
    let folder = tempfile::tempdir().unwrap();
    let folder = folder.path();
    for (keys, message, help) in [
        (
            "(0, Euler(0, 0, 0)), (2, Euler(0, 360, 0))",
            "its rotation keys at 0 s and 2 s are 360 degrees apart",
            "add keys at 120 and 240 degrees between them",
        ),
        (
            "(0, Euler(0, 0, 0)), (0.5, Euler(0, 90, 0)), (2, Euler(-100, 90, 190)), (3, Euler(-100, 90, -10))",
            "its rotation keys at 0.5 s and 2 s are 190 degrees apart",
            "add a key at 95 degrees between them",
        ),
        (
            "(0, AxisAngle((0, 1, 0), 180)), (1, AxisAngle((0, 1, 0), -540), EaseIn)",
            "its rotation keys at 0 s and 1 s are 720 degrees apart",
            "add keys at 36, -108 and so on degrees between them",
        ),
    ] {
        fs::write(folder.join("a.ron"), scene(keys)).unwrap();
        let checked: Value = serde_json::from_str(&stdout_of(folder, ["check", "--json", "a.ron"])).unwrap();
        let warning = &checked[0]["warnings"][0];
        assert_eq!(warning["message"], format!("turns the short way: {message}"), "{keys}");
        assert_eq!(warning["entity"], "\"arm\"");
        assert!(warning["help"].as_str().unwrap().starts_with(help), "{warning}");
        assert!(warning["help"].as_str().unwrap().contains("Turns(axis: .."), "{warning}");
        let rendered = rayreel(folder, ["render", "a.ron", "--frames", "0", "--out", "o"]);
        assert!(text(&rendered.stderr).contains(message), "{}", text(&rendered.stderr));
        fs::remove_dir_all(folder.join("o")).unwrap();
    }
}

#[test]
fn keys_up_to_half_a_turn_apart_are_not_reported() {
    let folder = tempfile::tempdir().unwrap();
    let folder = folder.path();
    for keys in [
        "(0, Euler(0, 0, 0)), (1, Euler(180, -180, 180)), (2, Euler(0, 0, 360))",
        "(0, Euler(0, 0, 0)), (1, Euler(0, 120, 0)), (2, Euler(0, 240, 0)), (3, Euler(0, 360, 0))",
        "(0, Euler(0, 0, 0), Hold), (1, Euler(0, 360, 0))",
        "(0, AxisAngle((0, 1, 0), 0)), (1, AxisAngle((1, 0, 0), 360))",
        "(0, AxisAngle((0, 1, 0), 0)), (1, Euler(0, 360, 0))",
        "(0, Quat(0, 0, 0, 1)), (1, Quat(0, 0, 0, -1))",
    ] {
        fs::write(folder.join("a.ron"), scene(keys)).unwrap();
        let checked: Value = serde_json::from_str(&stdout_of(folder, ["check", "--json", "a.ron"])).unwrap();
        assert_eq!(checked[0]["warnings"], Value::Array(Vec::new()), "{keys}");
    }
}
