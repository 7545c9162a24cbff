//! Tests of warnings about camera targets whose paths end before the camera's path.

use std::fs;

use serde_json::Value;

use crate::{rayreel, stdout_of, text};

fn scene(duration: f64, position: &str, target: &str) -> String {
    format!(
        "(timeline: (fps: 5, duration: {duration}), film: (width: 8, height: 4),
        camera: (position: (0, 1, -5), target: (0, 0, 0)), background: (bottom: (0, 0, 0), top: (255, 255, 255)),
        entities: [],
        animate: [
            (target: \"camera\", channel: Position, {position}),
            (target: \"camera\", channel: Target, {target}),
        ])"
    )
}

const POSITION: &str = "track: Path(points: [(0, 1, -5), (4, 1, 0), (0, 1, 5)], duration: 4)";

fn target(pace: &str) -> String {
    format!("track: Path(points: [(0, 1, 0), (4, 1, 4)], {pace}")
}

#[test]
fn targets_that_stop_before_their_cameras_are_reported() {
    let folder = tempfile::tempdir().unwrap();
    let folder = folder.path();
    for (pace, end) in [
        ("duration: 3)", "3"),
        ("start: 1, duration: 0.5)", "1.5"),
        ("duration: 3), offset: 0.25, speed: 2", "1.75"),
    ] {
        fs::write(folder.join("a.ron"), scene(4.0, POSITION, &target(pace))).unwrap();
        let checked: Value = serde_json::from_str(&stdout_of(folder, ["check", "--json", "a.ron"])).unwrap();
        let warning = &checked[0]["warnings"][0];
        let message = format!(
            "moves on past a fixed target: its target path ends at {end} s, its position path at 4 s"
        );
        assert_eq!(warning["message"], message, "{pace}");
        assert_eq!(warning["entity"], "the camera");
        assert!(
            warning["help"].as_str().unwrap().starts_with("end both paths at the same time"),
            "{warning}"
        );
        for (frame, is_warned_of) in [("0", false), ("19", true)] {
            let rendered = rayreel(folder, ["render", "a.ron", "--frames", frame, "--out", "o"]);
            assert_eq!(text(&rendered.stderr).contains(&message), is_warned_of, "{}", text(&rendered.stderr));
        }
        fs::remove_dir_all(folder.join("o")).unwrap();
    }
}

#[test]
fn targets_that_stop_with_their_cameras_or_later_are_not_reported() {
    let folder = tempfile::tempdir().unwrap();
    let folder = folder.path();
    let keys = "track: Keys([(0, (0, 1, 0)), (1, (4, 1, 4))])";
    let point = "track: Path(points: [(0, 1, 0)], duration: 1)";
    let moving = target("duration: 1)");
    for (duration, position, target) in [
        (4.0, POSITION, &*target("duration: 4)")),
        // 3.7 + 0.3 may differ from 4 in binary floating point.
        (4.0, POSITION, &target("start: 3.7, duration: 0.3)")),
        (4.0, POSITION, &target("duration: 8), speed: 2")),
        (9.0, POSITION, &target("duration: 6)")),
        (4.0, POSITION, &target("duration: 1), repeat: PingPong")),
        (4.0, &format!("{POSITION}, repeat: Loop"), &moving),
        // The timeline ends before both.
        (1.0, POSITION, &moving),
        (4.0, POSITION, keys),
        (4.0, POSITION, point),
        (4.0, "track: Orbit(center: (0, 1, 0), radius: 5, duration: 4)", &moving),
    ] {
        fs::write(folder.join("a.ron"), scene(duration, position, target)).unwrap();
        let checked: Value = serde_json::from_str(&stdout_of(folder, ["check", "--json", "a.ron"])).unwrap();
        assert_eq!(checked[0]["warnings"], Value::Array(Vec::new()), "{position} {target}");
    }
}
