//! Tests of sample counts chosen for an error or a deadline, and of rendering the same frames from the recorded settings.

use std::fs;
use std::path::Path;
use std::time::Instant;

use serde_json::Value;

use crate::{rayreel, stdout_of, text};

const SCENE: &str = "Scene(
    timeline: (fps: 4, duration: 1), film: (width: 64, height: 36), sampling: (samples: 2),
    camera: (position: (0, 1.5, -6), target: (0, 0.8, 0), fov: 40), ambient: (0.3, 0.3, 0.3),
    materials: {
        \"floor\": (k_a: 0.4, k_d: 0.8, color: (200, 190, 170)),
        \"red\": (k_a: 0.4, k_d: 0.8, color: (220, 60, 40)),
    },
    entities: [
        (shape: Plane(normal: (0, 1, 0)), material: \"floor\"),
        (name: \"ball\", shape: Sphere(radius: 1), material: \"red\", transform: (translation: (0, 1, 0))),
        (light: Area(shape: Sphere(radius: 0.5), intensity: (0.8, 0.8, 0.8), samples: 1), transform: (translation: (-3, 5, -4))),
    ],
    animate: [(target: \"ball\", channel: Translation, track: Keys([(0, (0, 1, 0)), (1, (1, 1, 0))]))],
)
";

fn folder() -> tempfile::TempDir {
    let folder = tempfile::tempdir().unwrap();
    fs::write(folder.path().join("a.ron"), SCENE).unwrap();
    folder
}

fn render(folder: &Path, arguments: &[&str]) -> Value {
    let output = stdout_of(folder, [&["render", "a.ron", "--format", "ppm", "--json"], arguments].concat());
    serde_json::from_str(&output).unwrap()
}

fn frames(folder: &Path, count: usize) -> Vec<Vec<u8>> {
    (0..count).map(|frame| fs::read(folder.join(format!("a.{frame:04}.ppm"))).unwrap()).collect()
}

fn settings(folder: &Path) -> Value {
    serde_json::from_str(&fs::read_to_string(folder.join("a.settings.json")).unwrap()).unwrap()
}

#[test]
fn error_targets_are_met_and_settings_reproduce_the_frames() {
    let folder = folder();
    let folder = folder.path();
    let mut rays = 0;
    for error in [1.0, 0.5, 0.25] {
        let report = render(folder, &["--max-error", &error.to_string(), "--out", "chosen"]);
        let before = std::mem::replace(&mut rays, report["frames"][3]["rays"]["camera"].as_u64().unwrap());
        assert!(rays > before, "{error}");
        let chosen = settings(&folder.join("chosen"));
        for (index, frame) in chosen["frames"].as_array().unwrap().iter().enumerate() {
            assert_eq!((&frame["frame"], &frame["max_error"]), (&index.into(), &error.into()));
            assert!(frame["estimated_error"].as_f64().unwrap() <= error);
            assert_eq!(report["frames"][index]["estimated_error"], frame["estimated_error"]);
            assert!(frame["samples_per_pixel"].as_f64().unwrap() >= 1.0);
        }
        for threads in ["1", "3"] {
            render(folder, &["--settings", "chosen/a.settings.json", "--threads", threads, "--out", "again"]);
            assert!(
                frames(&folder.join("again"), 4) == frames(&folder.join("chosen"), 4),
                "{error} {threads}"
            );
            assert!(!folder.join("again/a.settings.json").exists());
        }
    }
    // Rendering one frame again with another target keeps the settings of the other frames.
    render(folder, &["--max-error", "200", "--frames", "2", "--out", "chosen"]);
    let errors: Vec<f64> = settings(&folder.join("chosen"))["frames"]
        .as_array()
        .unwrap()
        .iter()
        .map(|frame| frame["max_error"].as_f64().unwrap())
        .collect();
    assert_eq!(errors, [0.25, 0.25, 200.0, 0.25]);
}

#[test]
fn deadline_is_met_and_settings_reproduce_the_frames() {
    let folder = folder();
    let folder = folder.path();
    let mut samples = 0.0;
    for seconds in [0.5, 4.0] {
        let start = Instant::now();
        render(folder, &["--deadline", &format!("{seconds}s"), "--out", "chosen"]);
        // The limit is loose because other tests run on the same machine.
        assert!(start.elapsed().as_secs_f64() < 10.0 * seconds + 5.0);
        let chosen = settings(&folder.join("chosen"));
        let last = chosen["frames"][3]["samples_per_pixel"].as_f64().unwrap();
        assert!(last > samples, "{last} {samples}");
        samples = last;
        render(folder, &["--settings", "chosen/a.settings.json", "--threads", "3", "--out", "again"]);
        assert!(frames(&folder.join("again"), 4) == frames(&folder.join("chosen"), 4));
    }
}

/// Options for twelve frames of the scene. Changing the last key changes only the last four frames.
const TWELVE: [&str; 4] = [
    "--set",
    "timeline.fps=12",
    "--set",
    "animate.0.track=Keys([(0, (0, 1, 0)), (0.66, (1, 1, 0)), (1, (1, 2, 0))])",
];

fn bytes(folder: &Path) -> Vec<(usize, Vec<u8>)> {
    let read = |frame: usize| Some((frame, fs::read(folder.join(format!("a.{frame:04}.ppm"))).ok()?));
    (0..12).filter_map(read).collect()
}

#[test]
fn frames_with_an_error_target_do_not_depend_on_other_frames() {
    let folder = folder();
    let folder = folder.path();
    let twelve = |arguments: &[&str]| render(folder, &[&TWELVE, arguments].concat());
    twelve(&["--max-error", "2", "--out", "whole"]);
    let whole = bytes(&folder.join("whole"));
    assert_eq!(whole.len(), 12);
    for shards in [2, 3, 7] {
        let out = format!("of{shards}");
        for shard in (0..shards).rev() {
            let (shard, threads) = (format!("{shard}/{shards}"), (1 + shard % 3).to_string());
            twelve(&["--max-error", "2", "--shard", &shard, "--threads", &threads, "--out", &out]);
        }
        assert!(bytes(&folder.join(&out)) == whole, "{shards} shards");
        // The shards together have recorded the settings of all frames.
        twelve(&["--settings", &format!("{out}/a.settings.json"), "--out", "again"]);
        assert!(bytes(&folder.join("again")) == whole, "{shards} shards, from their settings");
        fs::remove_dir_all(folder.join("again")).unwrap();
    }
    for (frame, expected) in &whole {
        twelve(&["--max-error", "2", "--frames", &frame.to_string(), "--out", "alone"]);
        assert!(bytes(&folder.join("alone")) == [(*frame, expected.clone())], "frame {frame} alone");
        fs::remove_dir_all(folder.join("alone")).unwrap();
    }
    let recut = TWELVE.map(|word| word.replace("(1, 2, 0)", "(0, 3, 0)"));
    let recut: Vec<&str> = recut.iter().map(String::as_str).collect();
    let report = render(folder, &[&recut, &["--max-error", "2", "--out", "whole"][..]].concat());
    let frames: Vec<u64> =
        report["frames"].as_array().unwrap().iter().map(|frame| frame["frame"].as_u64().unwrap()).collect();
    assert_eq!(frames, [8, 9, 10, 11]);
    for ((frame, now), (_, before)) in bytes(&folder.join("whole")).iter().zip(&whole) {
        assert_eq!(now == before, *frame < 8, "{frame}");
    }
}

#[test]
fn norm_and_minimum_samples_apply() {
    let folder = folder();
    let folder = folder.path();
    let per_pixel = |arguments: &[&str]| {
        render(folder, &[&["--max-error", "4", "--out", "norms"], arguments].concat());
        settings(&folder.join("norms"))["frames"][0]["samples_per_pixel"].as_f64().unwrap()
    };
    let [rms, p99, max] = ["rms", "p99", "max"].map(|norm| per_pixel(&["--norm", norm]));
    assert!(rms < p99 && p99 < max, "{rms} {p99} {max}");
    assert!(per_pixel(&["--min-samples", "16"]) >= 16.0);
    let report = render(folder, &["--max-error", "4", "--min-samples", "16", "--out", "norms"]);
    assert_eq!(report["frames"].as_array().unwrap().len(), 0, "the same frames are there");
    let stdout = stdout_of(folder, ["verify", "norms"]);
    assert!(stdout.contains("4 of 4 frames"), "{stdout}");
}

#[test]
fn frames_of_the_same_deadline_are_kept() {
    let folder = folder();
    let folder = folder.path();
    let rendered = |arguments: &[&str]| {
        let report = render(folder, &[&["--deadline", "2s", "--out", "kept"], arguments].concat());
        report["frames"].as_array().unwrap().len()
    };
    assert_eq!(rendered(&["--frames", "0-1"]), 2);
    let before = frames(&folder.join("kept"), 2);
    assert_eq!(rendered(&[]), 2, "the others");
    assert!(frames(&folder.join("kept"), 2) == before);
    assert_eq!(rendered(&[]), 0);
    let stdout = stdout_of(folder, ["verify", "kept"]);
    assert!(stdout.contains("4 of 4 frames"), "{stdout}");
    // A missing or corrupt frame is rendered again; the other frames are kept.
    fs::remove_file(folder.join("kept/a.0001.ppm")).unwrap();
    fs::write(folder.join("kept/a.0002.ppm"), "P6").unwrap();
    assert_eq!(rendered(&[]), 2);
    // One frame with a far larger error than the others.
    let file = folder.join("kept/a.settings.json");
    let mut record = settings(&folder.join("kept"));
    for (frame, error) in record["frames"].as_array_mut().unwrap().iter_mut().zip([0.7, 0.8, 2.5, 0.9]) {
        frame["estimated_error"] = error.into();
    }
    fs::write(&file, record.to_string()).unwrap();
    let message = render(folder, &["--deadline", "2s", "--out", "kept"])["unequal"].take();
    let message = message.as_str().unwrap();
    assert!(
        message.contains("frame 2 has an estimated error of 2.5000, half of the frames 0.8000 or less"),
        "{message}"
    );
    // Another deadline or another scene requires all frames again.
    let report = render(folder, &["--deadline", "1s", "--out", "kept"]);
    assert_eq!(report["frames"].as_array().unwrap().len(), 4);
    let changed = ["--deadline", "1s", "--out", "kept", "--set", "camera.fov=41"];
    assert_eq!(render(folder, &changed)["frames"].as_array().unwrap().len(), 4);
}

/// Runs `rayreel render`, and returns its exit code and standard error.
fn refused(folder: &Path, arguments: &[&str]) -> (Option<i32>, String) {
    let output = rayreel(folder, [&["render", "a.ron"], arguments].concat());
    (output.status.code(), text(&output.stderr))
}

#[test]
fn impossible_targets_are_reported() {
    let folder = folder();
    let folder = folder.path();
    // The limit is known only after rendering, and reported then.
    let (code, message) = refused(folder, &["--max-error", "0.001", "--samples", "16", "--out", "o"]);
    assert_eq!(code, Some(0));
    let off = message.split_once("is off by about ").unwrap().1;
    assert!(off.contains("with the largest number of samples per pixel"), "{message}");
    let off: f64 = off.split_once(' ').unwrap().0.parse().unwrap();
    let frames = settings(&folder.join("o"));
    let worst =
        frames["frames"].as_array().unwrap().iter().map(|frame| frame["estimated_error"].as_f64().unwrap());
    assert!((worst.fold(0.0, f64::max) - off).abs() < 0.01 && off > 0.001, "{message}");
    let (code, message) = refused(folder, &["--deadline", "1ms", "--size", "1280x720"]);
    assert_eq!(code, Some(1));
    assert!(message.contains("4 frames cannot be rendered within"), "{message}");
    for arguments in
        [["--max-error", "0"], ["--max-error", "x"], ["--deadline", "0s"], ["--deadline", "soon"]]
    {
        assert_eq!(refused(folder, &arguments).0, Some(2), "{arguments:?}");
    }
    assert_eq!(refused(folder, &["--max-error", "1", "--deadline", "9s"]).0, Some(2));
    for option in [["--max-error", "1"], ["--deadline", "9s"], ["--settings", "s.json"]] {
        let (code, message) = refused(folder, &[&option[..], &["--set", "sampling.max_error=2"]].concat());
        assert_eq!(code, Some(1));
        let expected = format!("{} decides over `sampling.max_error=2`: omit one of them", option[0]);
        assert!(message.contains(&expected), "{message}");
    }

    for (text, problem) in [
        ("{", "is not a file of settings"),
        ("{}", "missing field `frames`"),
        (
            "{\"frames\": [{\"frame\": 0, \"time\": 0, \"samples\": 0, \"max_error\": 1}]}",
            "has 0 `samples` at 0 s",
        ),
        (
            "{\"frames\": [{\"frame\": 0, \"time\": 0, \"samples\": 9, \"max_error\": -1}]}",
            "a `max_error` of -1 at 0 s",
        ),
        (
            "{\"frames\": [{\"frame\": 0, \"time\": 0, \"samples\": 9, \"max_error\": 1}]}",
            "has no settings for frame 1",
        ),
    ] {
        fs::write(folder.join("s.json"), text).unwrap();
        let (code, message) = refused(folder, &["--settings", "s.json"]);
        assert_eq!(code, Some(1));
        assert!(message.contains(problem), "{text}: {message}");
    }
    assert!(refused(folder, &["--settings", "none.json"]).1.contains("cannot read `none.json`"));
}
