//! Tests of the `rayreel` command as a person or a script uses it.

use std::fs;
#[cfg(unix)]
use std::path::{Path, PathBuf};
#[cfg(unix)]
use std::process::Child;

use crate::{FIRST_LIGHT, files, pictures, rayreel, stdout_of, text};
#[cfg(unix)]
use crate::{RAYREEL, command, signal, until};

#[test]
fn single_frames_equal_sequence_frames_on_any_thread_count() {
    let folder = tempfile::tempdir().unwrap();
    let sequence = rayreel(folder.path(), ["render", FIRST_LIGHT, "--frames", "36-44", "--size", "320x180"]);
    assert!(sequence.status.success(), "{}", text(&sequence.stderr));
    let whole = fs::read(folder.path().join("out/first_light/320x180/first_light.0040.png")).unwrap();
    for threads in ["1", "2", "8"] {
        let arguments = [
            "render",
            FIRST_LIGHT,
            "--frames",
            "40",
            "--size",
            "320x180",
            "--threads",
            threads,
            "--out",
            threads,
        ];
        assert!(rayreel(folder.path(), arguments).status.success());
        assert_eq!(pictures(&folder.path().join(threads)), ["first_light.0040.png"]);
        let alone = fs::read(folder.path().join(threads).join("first_light.0040.png")).unwrap();
        assert!(alone == whole, "{threads} threads");
    }
}

#[test]
fn frames_moments_sizes_and_formats_can_be_chosen() {
    let folder = tempfile::tempdir().unwrap();
    let run = |arguments: &[&str]| {
        let output = rayreel(
            folder.path(),
            [&["render", FIRST_LIGHT, "--size", "32x18", "--out", "o"], arguments].concat(),
        );
        assert!(output.status.success(), "{}", text(&output.stderr));
    };
    run(&["--frames", "0-10x5,3"]);
    run(&["--at", "1.5s", "--format", "ppm"]);
    run(&["--frames", "36", "--format", "ppm"]);
    let names =
        ["first_light.0000.png", "first_light.0003.png", "first_light.0005.png", "first_light.0010.png"];
    let moments = ["first_light.0036.ppm", "first_light.at-1.5s.ppm"];
    let all = [names.as_slice(), &moments, &["first_light.sequence.json"]].concat();
    assert_eq!(files(&folder.path().join("o")), all);
    // At 24 frames per second, 1.5 s is frame 36.
    let [frame, moment] = moments.map(|name| fs::read(folder.path().join("o").join(name)).unwrap());
    assert_eq!(frame, moment);
    assert_eq!(image::load_from_memory(&frame).unwrap().to_rgb8().dimensions(), (32, 18));
}

#[test]
fn report_has_the_cost_of_every_frame() {
    let folder = tempfile::tempdir().unwrap();
    let output = rayreel(
        folder.path(),
        ["render", FIRST_LIGHT, "--frames", "5,6", "--size", "64x36", "--threads", "2", "--json"],
    );
    let report: serde_json::Value = serde_json::from_slice(&output.stdout).unwrap();
    assert_eq!(report["threads"], 2);
    assert_eq!((&report["width"], &report["height"]), (&64.into(), &36.into()));
    assert_eq!(report["interrupted"], false);
    let frames = report["frames"].as_array().unwrap();
    assert_eq!(frames.len(), 2);
    for (frame, index) in frames.iter().zip([5, 6]) {
        assert_eq!(frame["frame"], index);
        assert_eq!(frame["rays"]["camera"], 64 * 36 * 8);
        assert!(
            frame["rays"]["shadow"].as_u64().unwrap() > 0
                && frame["rays"]["reflection"].as_u64().unwrap() > 0
        );
        for phase in ["animate", "prepare", "trace", "write"] {
            assert!(frame["seconds"][phase].as_f64().unwrap() > 0.0, "{phase}");
        }
    }
    if cfg!(target_os = "linux") {
        assert!(report["peak_memory_bytes"].as_u64().unwrap() > 1_000_000);
    }
}

#[test]
fn invalid_options_report_the_valid_form() {
    let folder = tempfile::tempdir().unwrap();
    for (arguments, code, expected) in [
        (
            vec!["render", FIRST_LIGHT, "--frames", "90-100"],
            1,
            "there is no frame 100: the timeline of 4 s at 24 frames a second has frames 0 to 95",
        ),
        (vec!["render", FIRST_LIGHT, "--frames", "9-3"], 2, "`9-3` runs backwards"),
        (vec!["render", FIRST_LIGHT, "--at", "soon"], 2, "`soon` is not a time"),
        (vec!["render", FIRST_LIGHT, "--size", "640"], 2, "write width and height in pixels, as in 1280x720"),
        (vec!["render", FIRST_LIGHT, "--size", "0x10"], 2, "each side must be from 1 to 32768 pixels"),
        (vec!["explain", FIRST_LIGHT, "--size", "32768x32768"], 2, "a picture has at most 268435456 pixels"),
        (vec!["probe", FIRST_LIGHT, "--size", "9x32769"], 2, "each side must be from 1 to 32768 pixels"),
        (vec!["render", FIRST_LIGHT, "--threads", "0"], 2, "write a number of threads from 1 to 1024"),
        (vec!["render", FIRST_LIGHT, "--threads", "many"], 2, "write a number of threads from 1 to 1024"),
        (vec!["watch", FIRST_LIGHT, "--frame", "first"], 2, "write a whole number from 0 to 4294967295"),
        (vec!["render", FIRST_LIGHT, "--at", "1", "--frames", "1"], 2, "cannot be used with"),
        (vec!["render", "nothing.ron"], 1, "there is no file `nothing.ron`"),
        (vec!["rendre"], 2, "tip: some similar subcommands exist"),
    ] {
        let output = rayreel(folder.path(), &arguments);
        let error =
            text(&output.stderr).replace("a similar subcommand exists", "some similar subcommands exist");
        assert_eq!(output.status.code(), Some(code), "{arguments:?}");
        assert!(error.contains(expected), "{arguments:?}: {error}");
        assert!(output.stdout.is_empty());
    }
    assert_eq!(files(&folder.path().join("out")), Vec::<String>::new());
}

/// Checks that an option's value that starts with a hyphen is reported as an invalid value, not as an unknown option.
#[test]
fn values_with_a_hyphen_report_the_valid_form() {
    let folder = tempfile::tempdir().unwrap();
    for (command, option, expected) in [
        ("render", "--frames", "is not a frame or a range: write `12`, `10-20`, `40-80x5` or `90-`"),
        ("render", "--at", "is not a time: write seconds such as `1.5s`"),
        ("render", "--size", "write width and height in pixels, as in 1280x720"),
        ("render", "--sheet", "write columns and rows"),
        ("render", "--threads", "write a number of threads from 1 to 1024"),
        ("render", "--cutoff", "write a number of steps from 0 to"),
        ("explain", "--frames", "is not a frame or a range"),
        ("explain", "--size", "write width and height"),
        ("explain", "--threads", "write a number of threads"),
        ("watch", "--frame", "write a whole number from 0"),
        ("probe", "--pixel", "write column and row, from 0 at the top left"),
        ("probe", "--sample", "write a whole number from 0"),
        ("probe", "--frame", "write a whole number from 0"),
        ("probe", "--at", "is not a time"),
        ("probe", "--size", "write width and height"),
    ] {
        for value in ["-1", "-1.5", "-5-9", "--json"] {
            let output = rayreel(folder.path(), [command, FIRST_LIGHT, option, value]);
            let error = text(&output.stderr);
            assert_eq!(output.status.code(), Some(2), "{command} {option} {value}");
            assert!(
                error.contains(expected) && !error.contains("tip"),
                "{command} {option} {value}: {error}"
            );
            // Messages contain no programming jargon.
            assert!(!error.contains("..=") && !error.contains("invalid digit"), "{error}");
        }
    }
}

#[test]
fn folder_creation_failure_is_reported() {
    let folder = tempfile::tempdir().unwrap();
    fs::write(folder.path().join("taken"), "").unwrap();
    let output = rayreel(
        folder.path(),
        ["render", FIRST_LIGHT, "--frames", "0", "--size", "8x8", "--out", "taken/here"],
    );
    assert_eq!(output.status.code(), Some(1));
    assert!(text(&output.stderr).contains("cannot make the folder `taken/here`"));
}

#[test]
fn unwritable_frame_is_reported_and_others_stay() {
    let folder = tempfile::tempdir().unwrap();
    fs::create_dir_all(folder.path().join("o/first_light.0001.png")).unwrap();
    let output =
        rayreel(folder.path(), ["render", FIRST_LIGHT, "--frames", "0-1", "--size", "8x8", "--out", "o"]);
    assert_eq!(output.status.code(), Some(1));
    assert!(
        text(&output.stderr).contains("cannot write `o/first_light.0001.png`"),
        "{}",
        text(&output.stderr)
    );
    assert_eq!(pictures(&folder.path().join("o")), ["first_light.0000.png", "first_light.0001.png"]);
}

/// A scene whose script fails at frame 6.
const FAILS_MIDWAY: &str = r#"(
    timeline: (fps: 10, duration: 1.2),
    film: (width: 8, height: 8),
    camera: (position: (0, 0, -8), target: (0, 0, 0)),
    materials: { "clay": (k_a: 1) },
    entities: [(name: "ball", shape: Sphere(radius: 1), material: "clay")],
    animate: [(target: "ball", channel: Radius, track: Script("if frame == 6 { throw \"worn out\" } 1"))],
)"#;

#[test]
fn script_failure_reports_the_written_frames() {
    let folder = tempfile::tempdir().unwrap();
    fs::write(folder.path().join("s.ron"), FAILS_MIDWAY).unwrap();
    let run =
        |more: &[&str]| rayreel(folder.path(), [&["render", "s.ron", "--frames", "0-11"][..], more].concat());
    let output = run(&["--out", "machines", "--json"]);
    assert_eq!(output.status.code(), Some(1));
    assert!(text(&output.stderr).contains("worn out"), "{}", text(&output.stderr));
    let report: serde_json::Value = serde_json::from_slice(&output.stdout).unwrap();
    let frames = report["frames"].as_array().unwrap();
    let reported: Vec<&str> =
        frames.iter().map(|frame| frame["file"].as_str().unwrap().trim_start_matches("machines/")).collect();
    assert_eq!(reported, pictures(&folder.path().join("machines")));
    assert_eq!(reported.len(), 6);

    let output = run(&["--out", "people"]);
    assert!(text(&output.stderr).contains("6 frames in "), "{}", text(&output.stderr));
    // On a sheet, no frame is written.
    let output = run(&["--out", "sheet", "--sheet", "3x4", "--json"]);
    let report: serde_json::Value = serde_json::from_slice(&output.stdout).unwrap();
    assert_eq!((report["frames"].as_array().unwrap().len(), report["sheet"].is_null()), (6, true));
    assert!(files(&folder.path().join("sheet")).is_empty());
}

#[test]
fn script_failure_still_reports_unwritable_frames() {
    let folder = tempfile::tempdir().unwrap();
    fs::write(folder.path().join("s.ron"), FAILS_MIDWAY).unwrap();
    fs::create_dir_all(folder.path().join("o/s.0005.png")).unwrap();
    let output = rayreel(folder.path(), ["render", "s.ron", "--frames", "5-6", "--out", "o"]);
    let stderr = text(&output.stderr);
    assert_eq!(output.status.code(), Some(1));
    assert!(stderr.contains("cannot write `o/s.0005.png`"), "{stderr}");
}

#[test]
fn check_prints_text_and_json() {
    let folder = tempfile::tempdir().unwrap();
    fs::write(
        folder.path().join("bad.ron"),
        "Scene(\n    camera: (position: (0, 0, 0), view: (0, 0, 0)),\n)\n",
    )
    .unwrap();
    let output = rayreel(folder.path(), ["check", FIRST_LIGHT, "bad.ron"]);
    assert_eq!(output.status.code(), Some(1));
    assert_eq!(text(&output.stdout), format!("{FIRST_LIGHT}: ok, 96 frames\n"));
    let error = text(&output.stderr);
    assert!(error.contains("--> bad.ron:2:41") && error.contains("bad.ron: 1 mistake"), "{error}");
    assert!(!error.contains('\u{1b}'), "no colours off a terminal");

    let output = rayreel(folder.path(), ["check", "bad.ron", "--json"]);
    let report: serde_json::Value = serde_json::from_slice(&output.stdout).unwrap();
    assert_eq!(report[0]["ok"], false);
    let mistake = &report[0]["mistakes"][0];
    assert_eq!((&mistake["line"], &mistake["column"]), (&2.into(), &41.into()));
    assert_eq!(mistake["message"], "view has no direction");
}

#[test]
fn new_writes_a_scene_that_renders_and_never_overwrites() {
    let folder = tempfile::tempdir().unwrap();
    assert!(rayreel(folder.path(), ["new", "mine.ron"]).status.success());
    let own_size = rayreel(folder.path(), ["render", "mine.ron", "--size", "640x360", "--frames", "0"]);
    assert!(own_size.status.success(), "{}", text(&own_size.stderr));
    let finished = fs::read(folder.path().join("out/mine/mine.0000.png")).unwrap();
    let output = rayreel(folder.path(), ["render", "mine.ron", "--size", "32x18"]);
    assert!(output.status.success(), "{}", text(&output.stderr));
    assert_eq!(pictures(&folder.path().join("out/mine/32x18")).len(), 48);
    assert_eq!(
        pictures(&folder.path().join("out/mine")),
        ["mine.0000.png"],
        "a test leaves finished frames alone"
    );
    assert!(fs::read(folder.path().join("out/mine/mine.0000.png")).unwrap() == finished);

    fs::write(folder.path().join("mine.ron"), "precious").unwrap();
    let output = rayreel(folder.path(), ["new", "mine.ron"]);
    assert_eq!(output.status.code(), Some(1));
    assert!(text(&output.stderr).contains("exists already, and is left as it is"));
    assert_eq!(fs::read_to_string(folder.path().join("mine.ron")).unwrap(), "precious");
}

#[test]
fn new_from_data_writes_a_scene_that_shows_it() {
    let folder = tempfile::tempdir().unwrap();
    fs::create_dir(folder.path().join("data")).unwrap();
    let water = "3\nwater\nO 0 0 0\nH 0.96 0 0\nH -0.24 0.93 0\n";
    fs::write(folder.path().join("data/water.xyz"), water.repeat(5)).unwrap();
    let error = text(&rayreel(folder.path(), ["render", "data/water.xyz"]).stderr);
    assert!(error.contains("`rayreel new --from DATA my.ron` writes a scene"), "{error}");
    stdout_of(folder.path(), ["new", "--from", "data/water.xyz", "water.ron"]);
    let checked = stdout_of(folder.path(), ["check", "water.ron"]);
    assert_eq!(checked, "water.ron: ok, 96 frames\n");
    // The oxygen is to the left of the middle of the picture, and below it; its bonds go to the right and up.
    for (pixel, name) in [("545,482", "particles/0"), ("680,482", "particles/0-1")] {
        let probed = stdout_of(folder.path(), ["probe", "water.ron", "--pixel", pixel]);
        let is_there = probed.contains(&format!("\"{name}\" (water.ron:"));
        assert!(is_there && probed.contains("data/water.xyz, frame 0)"), "{probed}");
    }
    // Kinds that are no elements.
    let mixture = water.replace("O 0", "A 0").replace("H -", "B -");
    fs::write(folder.path().join("data/mixture.xyz"), mixture).unwrap();
    stdout_of(folder.path(), ["new", "--from", "data/mixture.xyz", "mixture.ron"]);
    assert_eq!(stdout_of(folder.path(), ["check", "mixture.ron"]), "mixture.ron: ok, 144 frames\n");
    let written = fs::read_to_string(folder.path().join("mixture.ron")).unwrap();
    assert!(written.contains("color_by: Category(\"element\")"), "{written}");
    let output = rayreel(folder.path(), ["new", "--from", "data/wine.xyz", "wine.ron"]);
    assert!(!output.status.success() && text(&output.stderr).contains("data/wine.xyz"));
    assert!(!folder.path().join("wine.ron").exists());
}

#[test]
fn help_shows_examples_and_completions_are_scripts() {
    let folder = tempfile::tempdir().unwrap();
    for command in ["render", "check", "probe", "new", "completions"] {
        let output = rayreel(folder.path(), [command, "--help"]);
        assert!(output.status.success() && text(&output.stdout).contains("Example"), "{command}");
    }
    assert!(text(&rayreel(folder.path(), ["completions", "bash"]).stdout).contains("_rayreel"));
}

/// Starts a long rendering, and waits for its first frames.
#[cfg(unix)]
fn start_long_rendering(folder: &Path) -> (Child, PathBuf) {
    let arguments = ["render", FIRST_LIGHT, "--size", "800x450", "--json"];
    let child = command(RAYREEL, folder).args(arguments).spawn().unwrap();
    let out = folder.join("out/first_light/800x450");
    let whole = || files(&out).iter().filter(|name| name.ends_with(".png")).count();
    until("a few frames", || whole() >= 2);
    (child, out)
}

#[cfg(unix)]
#[test]
fn interruption_leaves_complete_files_and_is_reported() {
    let folder = tempfile::tempdir().unwrap();
    let (child, out) = start_long_rendering(folder.path());
    // Shells start background processes with SIGINT ignored.
    signal(&child, "TERM");
    let output = child.wait_with_output().unwrap();
    assert_eq!(output.status.code(), Some(143), "{}", text(&output.stderr));
    let report: serde_json::Value = serde_json::from_slice(&output.stdout).unwrap();
    assert_eq!(report["interrupted"], true);
    let names = pictures(&out);
    assert_eq!(names.len(), report["frames"].as_array().unwrap().len());
    assert!(names.len() < 96);
    for name in names {
        image::open(out.join(&name)).unwrap_or_else(|error| panic!("{name}: {error}"));
    }
}

#[cfg(unix)]
#[test]
fn kill_leaves_no_corrupt_frame_file() {
    let folder = tempfile::tempdir().unwrap();
    let (mut child, out) = start_long_rendering(folder.path());
    signal(&child, "KILL");
    child.wait().unwrap();
    for name in pictures(&out) {
        image::open(out.join(&name)).unwrap_or_else(|error| panic!("{name}: {error}"));
    }
}

#[test]
fn every_command_has_a_manual_page() {
    let folder = tempfile::tempdir().unwrap();
    let page = |command: &[&str]| {
        let output = rayreel(folder.path(), [&["man"], command].concat());
        assert!(output.status.success(), "{}", text(&output.stderr));
        text(&output.stdout)
    };
    let all = page(&[]);
    assert!(all.contains(".TH rayreel 1"), "{all}");
    for command in ["render", "verify", "farm", "watch", "check", "explain", "accuracy", "probe", "new"] {
        let name = format!("rayreel\\-{command}");
        assert!(all.contains(&name), "{command}: {all}");
        assert!(page(&[command]).contains(&name), "{command}");
    }
    let unknown = rayreel(folder.path(), ["man", "rendre"]);
    assert!(text(&unknown.stderr).contains("there is no command `rendre`"));
}
