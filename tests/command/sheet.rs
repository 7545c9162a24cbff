//! Tests of contact sheets and of drafts.

use std::fs;
use std::path::Path;

use image::RgbImage;
use image::imageops::crop_imm;
use serde_json::Value;
use tempfile::TempDir;

use crate::{FIRST_LIGHT, files, rayreel, stdout_of};

const NEWTONS_CRADLE: &str = concat!(env!("CARGO_MANIFEST_DIR"), "/scenes/newtons_cradle.ron");

/// Width in pixels of the gap around tiles.
const GAP: u32 = 8;
/// Distance in pixels from a tile to the tile below, for tiles less than 800 pixels wide.
const BETWEEN_ROWS: u32 = 5 + 9 + GAP;

/// Renders successfully, and returns the JSON report.
fn render(folder: &TempDir, scene: &str, arguments: &[&str]) -> Value {
    let stdout = stdout_of(folder.path(), [&["render", scene, "--json"], arguments].concat());
    serde_json::from_str(&stdout).unwrap()
}

fn picture(path: &Path) -> RgbImage {
    image::open(path).unwrap().to_rgb8()
}

fn frames(report: &Value) -> Vec<u64> {
    report["frames"].as_array().unwrap().iter().map(|frame| frame["frame"].as_u64().unwrap()).collect()
}

/// Checks that every tile of the sheet equals the frame in `out` that the same arguments make without `--sheet`.
fn assert_tiles_are_frames(folder: &TempDir, scene: &str, report: &Value, arguments: &[&str], out: &str) {
    let side = |value: &Value| u32::try_from(value.as_u64().unwrap()).unwrap();
    let sheet = picture(&folder.path().join(report["sheet"]["file"].as_str().unwrap()));
    assert_eq!(sheet.dimensions(), (side(&report["sheet"]["width"]), side(&report["sheet"]["height"])));
    let (width, height) = (side(&report["width"]), side(&report["height"]));
    let size = format!("{width}x{height}");
    let list = frames(report).iter().map(u64::to_string).collect::<Vec<_>>().join(",");
    render(
        folder,
        scene,
        &[&["--frames", &list, "--size", &size, "--format", "ppm", "--out", "alone"], arguments].concat(),
    );
    let columns = side(&report["sheet"]["columns"]);
    for (index, frame) in (0..).zip(frames(report)) {
        let name = format!("{}.{frame:04}.ppm", Path::new(scene).file_stem().unwrap().to_str().unwrap());
        let (column, row) = (index % columns, index / columns);
        let (left, top) = (GAP + column * (width + GAP), GAP + row * (height + BETWEEN_ROWS));
        let tile = crop_imm(&sheet, left, top, width, height).to_image();
        assert!(tile == picture(&folder.path().join(out).join(name)), "frame {frame}");
    }
}

#[test]
fn sheet_shows_frames_with_the_bytes_of_their_files() {
    let folder = tempfile::tempdir().unwrap();
    let report = render(&folder, FIRST_LIGHT, &["--sheet", "6x4"]);
    assert_eq!(files(&folder.path().join("out/first_light")), ["first_light.sheet.png"]);
    assert_eq!((&report["width"], &report["height"]), (&304.into(), &171.into()));
    let sheet = &report["sheet"];
    assert_eq!((&sheet["columns"], &sheet["rows"]), (&6.into(), &4.into()));
    assert_eq!((&sheet["width"], &sheet["height"]), (&1880.into(), &780.into()));
    assert!(sheet["write_seconds"].as_f64().unwrap() > 0.0);
    let expected: Vec<u64> = (0..24).map(|index| index * 95 / 23).collect();
    assert_eq!(frames(&report), expected);
    assert_eq!(report["frames"][3]["file"], Value::Null);
    assert_tiles_are_frames(&folder, FIRST_LIGHT, &report, &[], "alone");
}

#[test]
fn sheet_of_few_frames_has_no_empty_rows() {
    let folder = tempfile::tempdir().unwrap();
    let report = render(&folder, FIRST_LIGHT, &["--sheet", "3x9", "--frames", "7-9,50", "--size", "40x30"]);
    assert_eq!(frames(&report), [7, 8, 9, 50]);
    let sheet = &report["sheet"];
    assert_eq!((&sheet["columns"], &sheet["rows"]), (&3.into(), &2.into()));
    assert_eq!((&sheet["width"], &sheet["height"]), (&152.into(), &112.into()));
    assert_tiles_are_frames(&folder, FIRST_LIGHT, &report, &[], "alone");

    let report =
        render(&folder, FIRST_LIGHT, &["--sheet", "9x9", "--frames", "7", "--format", "ppm", "--out", "o"]);
    assert_eq!(
        (&report["sheet"]["file"], &report["width"]),
        (&"o/first_light.sheet.ppm".into(), &960.into())
    );
    assert_eq!(files(&folder.path().join("o")), ["first_light.sheet.ppm"]);
}

#[test]
fn sheets_do_not_depend_on_the_thread_count() {
    let folder = tempfile::tempdir().unwrap();
    let sheets = ["1", "2", "8"].map(|threads| {
        let arguments = ["--sheet", "3x2", "--size", "80x45", "--out", threads, "--threads", threads];
        render(&folder, FIRST_LIGHT, &arguments);
        fs::read(folder.path().join(threads).join("first_light.sheet.png")).unwrap()
    });
    assert!(sheets[0] == sheets[1] && sheets[1] == sheets[2]);
}

#[test]
fn variants_are_the_frame_without_each_effect() {
    let folder = tempfile::tempdir().unwrap();
    let arguments = ["--frames", "7", "--variants", "shadows,reflections,stars,shadows", "--size", "160x90"];
    let report = render(&folder, FIRST_LIGHT, &arguments);
    let out = folder.path().join("out/first_light");
    assert_eq!(files(&out), ["first_light.variants.png"]);
    assert_eq!(frames(&report), [7, 7, 7, 7]);
    let sheet = &report["sheet"];
    assert_eq!((&sheet["columns"], &sheet["rows"]), (&3.into(), &2.into()));
    assert_eq!(sheet["variants"], serde_json::json!(["shadows", "reflection", "stars"]));
    // The scene has no stars.
    assert_eq!(sheet["unchanged"], serde_json::json!(["stars"]));
    let sheet = picture(&out.join("first_light.variants.png"));
    let without = [&[][..], &["--without", "shadows"], &["--without", "reflection"], &[]];
    for (index, without) in (0..).zip(without) {
        let arguments = ["--frames", "7", "--size", "160x90", "--out", "alone", "--overwrite"];
        render(&folder, FIRST_LIGHT, &[&arguments, without].concat());
        let (column, row) = (index % 3, index / 3);
        let (left, top) = (GAP + column * (160 + GAP), GAP + row * (90 + BETWEEN_ROWS));
        let tile = crop_imm(&sheet, left, top, 160, 90).to_image();
        assert!(tile == picture(&folder.path().join("alone/first_light.0007.png")), "{without:?}");
        let caption = crop_imm(&sheet, left, top + 90, 160, BETWEEN_ROWS - GAP).to_image();
        let inked = caption.pixels().filter(|pixel| pixel.0 == [200; 3]).count();
        assert!(inked > 100, "{without:?}: {inked}");
    }

    // Text output gives the reason.
    let arguments = ["--frames", "7", "--variants", "stars,spot-lights", "--size", "16x9"];
    let output = rayreel(folder.path(), [&["render", FIRST_LIGHT], &arguments[..]].concat());
    let note = "the picture is the same without stars (the scene has no `stars`)";
    assert!(crate::text(&output.stderr).contains(note), "{}", crate::text(&output.stderr));

    // Two pictures side by side, at a moment, in a grid of one's own.
    let report = render(&folder, FIRST_LIGHT, &["--at", "0.3s", "--variants", "shadows", "--size", "40x30"]);
    assert_eq!((&report["sheet"]["columns"], &report["sheet"]["rows"]), (&2.into(), &1.into()));
    let grid = ["--frames", "0", "--variants", "shadows,stars", "--sheet", "2x9", "--size", "40x30"];
    let report = render(&folder, FIRST_LIGHT, &grid);
    assert_eq!((&report["sheet"]["columns"], &report["sheet"]["rows"]), (&2.into(), &2.into()));
}

#[test]
fn impossible_variants_are_rejected() {
    let folder = tempfile::tempdir().unwrap();
    for (arguments, message) in [
        (
            &["--variants", "shadows"][..],
            "--variants show one frame, and 96 are chosen: choose one, as --frames 0, or a moment, as --at 1s",
        ),
        (
            &["--frames", "0", "--variants", "shadows,fog", "--sheet", "1x2"],
            "--sheet 1x2 has no room for 3 pictures: write --sheet 1x3",
        ),
        (
            &["--frames", "0", "--variants", "fog,shadows", "--without", "shadows"],
            "--variants shadows: the picture has no shadows in any variant, as --without or --only disables it: omit one of them",
        ),
        (
            &["--frames", "0", "--variants", "fog", "--format", "exr"],
            "--variants is made of colours in 8 bits: it takes --format png or ppm, without --alpha",
        ),
        (
            &["--frames", "0", "--variants", "fog", "--out", "-"],
            "frames cannot go to standard output: --variants makes one file; name a folder with --out",
        ),
    ] {
        let output = rayreel(folder.path(), [&["render", FIRST_LIGHT], arguments].concat());
        assert_eq!(output.status.code(), Some(1), "{arguments:?}");
        assert_eq!(crate::text(&output.stderr), format!("error: {message}\n"));
    }
    for (word, remedy) in
        [("frensel", "did you mean `fresnel`?"), ("xyz", "the effects are ambient-light, ambient-occlusion,")]
    {
        let variants = format!("fog,{word}");
        let output =
            rayreel(folder.path(), ["render", FIRST_LIGHT, "--frames", "0", "--variants", &variants]);
        assert_eq!(output.status.code(), Some(2));
        let message = format!("invalid value '{word}' for '--variants <EFFECTS>': {remedy}");
        assert!(crate::text(&output.stderr).contains(&message), "{}", crate::text(&output.stderr));
    }
    assert!(files(folder.path()).is_empty());
}

#[test]
fn drafts_are_small_and_have_their_own_folder() {
    let folder = tempfile::tempdir().unwrap();
    let report = render(&folder, NEWTONS_CRADLE, &["--draft", "--frames", "3"]);
    assert_eq!((&report["width"], &report["height"]), (&320.into(), &180.into()));
    let out = folder.path().join("out/newtons_cradle");
    assert_eq!(files(&out), ["draft"]);
    assert_eq!(files(&out.join("draft")), ["newtons_cradle.0003.png", "newtons_cradle.sequence.json"]);
    let frame = &report["frames"][0];
    assert_eq!(frame["rays"]["camera"], 320 * 180, "one sample a pixel");
    let needed = frame["needed"].as_array().unwrap();
    assert!(
        !needed.contains(&"motion blur".into()) && !needed.contains(&"antialiasing".into()),
        "{needed:?}"
    );

    render(&folder, NEWTONS_CRADLE, &["--draft", "--frames", "3", "--out", "o", "--size", "33x44"]);
    assert_eq!(picture(&folder.path().join("o/draft/newtons_cradle.0003.png")).dimensions(), (33, 44));
}

#[test]
fn drafts_reduce_size_depth_and_samples() {
    let folder = tempfile::tempdir().unwrap();
    let scene = |quality: &str, samples: &str, light: u32, film: &str| {
        format!(
            r#"Scene(
                film: ({film}),
                camera: (position: (0, 1, -6), target: (0, 1, 0), lens: (aperture: 0.5, focus: 3)),
                quality: ({quality}),
                sampling: ({samples}),
                materials: {{
                    "floor": (k_a: 0.2, k_d: 0.8, color: (200, 180, 160)),
                    "glass": (color: (255, 255, 255), refractive: (k_t: 0.9, ior: 1.5), reflective: (k_r: 0.1)),
                }},
                entities: [
                    (shape: Plane(normal: (0, 1, 0)), material: "floor"),
                    (shape: Sphere(radius: 1), material: "glass", transform: (translation: (0, 1, 0))),
                    (light: Area(shape: Sphere(radius: 1), samples: {light}, intensity: (1, 1, 1)),
                     transform: (translation: (3, 6, -3))),
                ],
            )"#
        )
    };
    fs::write(
        folder.path().join("whole.ron"),
        scene("depth: 9, cutoff: 0.5", "samples: 12, max_error: 0.5", 16, "width: 100, height: 80"),
    )
    .unwrap();
    fs::write(
        folder.path().join("less.ron"),
        scene("depth: 5, cutoff: 0.5", "samples: 1", 4, "width: 33, height: 26"),
    )
    .unwrap();
    fs::write(
        folder.path().join("faint.ron"),
        scene("depth: 5, cutoff: 0", "samples: 1", 4, "width: 33, height: 26"),
    )
    .unwrap();
    fs::write(
        folder.path().join("tiny.ron"),
        scene("depth: 1, cutoff: 9", "samples: 1", 1, "width: 2, height: 1"),
    )
    .unwrap();
    let pixels = |name: &str, arguments: &[&str]| {
        let report = render(&folder, &format!("{name}.ron"), arguments);
        picture(&folder.path().join(report["frames"][0]["file"].as_str().unwrap()))
    };
    let draft = pixels("whole", &["--draft"]);
    assert!(draft == pixels("less", &[]));
    assert!(pixels("whole", &["--draft", "--cutoff", "0"]) == pixels("faint", &[]));
    assert!(draft != pixels("whole", &["--size", "33x26"]));
    assert!(pixels("tiny", &["--draft"]) == pixels("tiny", &["--size", "1x1"]), "nothing is raised");
}

#[test]
fn sheets_of_drafts_are_possible() {
    let folder = tempfile::tempdir().unwrap();
    let report = render(&folder, NEWTONS_CRADLE, &["--draft", "--sheet", "3x1"]);
    assert_eq!(report["sheet"]["file"], "out/newtons_cradle/draft/newtons_cradle.sheet.png");
    assert_eq!((&report["width"], &report["height"]), (&320.into(), &180.into()));
    assert_tiles_are_frames(&folder, NEWTONS_CRADLE, &report, &["--draft"], "alone/draft");
}

#[test]
fn invalid_options_report_the_valid_form() {
    let folder = tempfile::tempdir().unwrap();
    for (arguments, code, expected) in [
        (vec!["--sheet", "6"], 2, "write columns and rows, each from 1 to 100, as in 6x4"),
        (vec!["--sheet", "0x4"], 2, "write columns and rows, each from 1 to 100, as in 6x4"),
        (vec!["--sheet", "101x1"], 2, "write columns and rows, each from 1 to 100, as in 6x4"),
        (vec!["--sheet", "2x2", "--at", "1s"], 2, "cannot be used with"),
        (vec!["--sheet", "2x2", "--frames", "96"], 1, "there is no frame 96"),
        (
            vec!["--sheet", "90x1", "--size", "400x400"],
            1,
            "90x1 tiles of 400x400 pixels make a sheet of 36728x430: it may have at most 268435456 pixels, and 32768 on a side",
        ),
    ] {
        let output = rayreel(folder.path(), [vec!["render", FIRST_LIGHT], arguments.clone()].concat());
        let error = String::from_utf8_lossy(&output.stderr);
        assert_eq!(output.status.code(), Some(code), "{arguments:?}: {error}");
        assert!(error.contains(expected), "{arguments:?}: {error}");
    }
    assert!(files(folder.path()).is_empty());
}

#[test]
fn unwritable_sheet_is_reported() {
    let folder = tempfile::tempdir().unwrap();
    fs::create_dir_all(folder.path().join("o/first_light.sheet.png")).unwrap();
    let output =
        rayreel(folder.path(), ["render", FIRST_LIGHT, "--sheet", "2x1", "--size", "8x8", "--out", "o"]);
    let error = String::from_utf8_lossy(&output.stderr);
    assert_eq!(output.status.code(), Some(1));
    assert!(
        error.contains("; no sheet was written\nerror: cannot write `o/first_light.sheet.png`"),
        "{error}"
    );
    assert_eq!(files(&folder.path().join("o")), ["first_light.sheet.png"]);
}

#[cfg(unix)]
#[test]
fn interruption_writes_no_sheet() {
    use std::io::{BufRead, BufReader, Read};

    use crate::{RAYREEL, command, signal};

    let folder = tempfile::tempdir().unwrap();
    let arguments = ["render", FIRST_LIGHT, "--sheet", "10x9", "--size", "960x540", "--json"];
    let mut child = command(RAYREEL, folder.path()).args(arguments).spawn().unwrap();
    let mut stderr = BufReader::new(child.stderr.take().unwrap());
    let mut line = String::new();
    stderr.read_line(&mut line).unwrap();
    assert!(line.starts_with("1/90 frame 0: "), "{line}");
    signal(&child, "TERM");
    let mut rest = String::new();
    stderr.read_to_string(&mut rest).unwrap();
    let output = child.wait_with_output().unwrap();
    assert_eq!(output.status.code(), Some(143), "{rest}");
    let report: Value = serde_json::from_slice(&output.stdout).unwrap();
    assert_eq!((&report["interrupted"], &report["sheet"]), (&true.into(), &Value::Null));
    assert!(frames(&report).len() < 90);
    assert_eq!(files(&folder.path().join("out/first_light")), Vec::<String>::new());
}
