//! Tests of `rayreel probe`: pixels must agree with the picture, and rays with the engine.
//!
//! Ray trees are compared with `tests/probe/*.txt`. `RAYREEL_BLESS=1 cargo test --test command probe` rewrites these files; review the
//! changes before keeping them.

use std::fmt::Write as _;
use std::fs;
use std::io::{BufRead, BufReader, Read, Write};
use std::path::{Path, PathBuf};
use std::process::{Output, Stdio};

use assert_cmd::Command;
use glam::DVec3;
use rayon::prelude::*;
use serde_json::{Value, json};

use rayreel::components::{FilmSettings, Name, Overlay};
use rayreel::{Engine, Film, Ray, Time};

use crate::{RAYREEL, command, text};

const HEADER: &str = "hit,entity,t,px,py,pz,nx,ny,nz";

fn root() -> &'static Path {
    Path::new(env!("CARGO_MANIFEST_DIR"))
}

/// Runs `rayreel probe` in `tests/probe/`.
pub(crate) fn probe(arguments: &[&str], input: &str) -> Output {
    let mut command = Command::cargo_bin("rayreel").unwrap();
    command.current_dir(root().join("tests/probe")).arg("probe").args(arguments);
    command.write_stdin(input).output().unwrap()
}

/// Returns the standard output of a call that must succeed.
pub(crate) fn stdout_of(arguments: &[&str], input: &str) -> String {
    let output = probe(arguments, input);
    assert!(output.status.success() && output.stderr.is_empty(), "{arguments:?}: {}", text(&output.stderr));
    text(&output.stdout)
}

pub(crate) fn json_of(arguments: &[&str]) -> Value {
    serde_json::from_str(&stdout_of(&[arguments, &["--json"]].concat(), "")).unwrap()
}

fn shipped_scenes() -> Vec<PathBuf> {
    let entries = fs::read_dir(root().join("scenes")).unwrap().map(|entry| entry.unwrap().path());
    let mut scenes: Vec<PathBuf> =
        entries.filter(|path| path.extension().is_some_and(|end| end == "ron")).collect();
    scenes.sort();
    assert!(scenes.len() >= 7);
    scenes
}

/// Returns an `f32` that was written as an `f64`.
#[expect(clippy::cast_possible_truncation, reason = "it is one")]
pub(crate) fn single(value: f64) -> f32 {
    value as f32
}

pub(crate) fn numbers(value: &Value) -> Vec<f64> {
    value.as_array().unwrap().iter().map(|number| number.as_f64().unwrap()).collect()
}

#[test]
fn probe_colors_equal_rendered_pixels() {
    shipped_scenes().into_par_iter().with_max_len(1).for_each(|path| {
        let mut engine = Engine::load(&path).unwrap();
        for film in engine.world_mut().query_mut::<&mut FilmSettings>() {
            *film = FilmSettings { width: 48, height: 27, ..*film };
        }
        // Letters are no light of the scene.
        for overlay in engine.world_mut().query_mut::<&mut Overlay>() {
            overlay.0.clear();
        }
        let time = engine.timeline.time_of(engine.timeline.frame_count() / 2);
        let film = engine.render(time).unwrap().film;
        let means = means_of_samples(&mut engine, time, &film);
        for ((j, i), mean) in (0..27).flat_map(|j| (0..48).map(move |i| (j, i))).zip(means) {
            let bits = |color: rayreel::Rgb| color.to_array().map(f32::to_bits);
            assert_eq!(bits(mean), bits(film.pixel(i, j)), "{} at {i},{j}", path.display());
        }
        for outside in [(48, 0), (0, 27)] {
            assert!(engine.probe(time, outside, 0).unwrap().is_none());
        }
    });
}

/// Returns the mean colour of every pixel's samples, row by row.
fn means_of_samples(engine: &mut Engine, time: Time, film: &Film) -> Vec<rayreel::Rgb> {
    let samples = engine.effective_settings().sampling.samples;
    let mut sums = vec![DVec3::ZERO; film.pixels().len()];
    for sample in 0..samples {
        let pixels = (0..film.height()).flat_map(|j| (0..film.width()).map(move |i| (i, j)));
        for (sum, (i, j)) in sums.iter_mut().zip(pixels) {
            *sum += engine.probe(time, (i, j), sample).unwrap().unwrap().color().as_dvec3();
        }
    }
    sums.into_iter().map(|sum| (sum / f64::from(samples)).as_vec3()).collect()
}

/// Copies a scene to `folder` with one sample per pixel, so that the bytes of a sample are the bytes of its pixel.
fn with_one_sample(path: &Path, folder: &Path) -> PathBuf {
    let scene = fs::read_to_string(path).unwrap();
    let lines: Vec<&str> = scene.lines().filter(|line| !line.trim().starts_with("sampling:")).collect();
    let copy = folder.join(path.file_name().unwrap());
    // Paths of referenced files lead to the original folder.
    let directory = path.parent().unwrap().display();
    let naming = ["(file: \"", "File(\"", "source: \""];
    let text = naming
        .iter()
        .fold(lines.join("\n"), |text, start| text.replace(start, &format!("{start}{directory}/")));
    fs::write(&copy, text).unwrap();
    copy
}

#[test]
fn probe_bytes_equal_the_frame_file() {
    let folder = tempfile::tempdir().unwrap();
    let mut omitted = ["shadows", "transparent-shadows", "reflection", "diffuse-light"].into_iter().cycle();
    for path in shipped_scenes() {
        let path = with_one_sample(&path, folder.path());
        let scene = path.to_str().unwrap();
        let name = path.file_stem().unwrap().to_str().unwrap();
        let without = ["--size", "64x36", "--without", omitted.next().unwrap()];
        for (size, when, file) in [
            (&without[..2], ["--frames", "10"], format!("{name}.0010.png")),
            (&without[..], ["--at", "0.3"], format!("{name}.at-0.3s.png")),
        ] {
            let arguments = [&["render", scene, "--out", "o"], size, when.as_slice()].concat();
            crate::stdout_of(folder.path(), arguments);
            let picture = image::open(folder.path().join("o").join(&file)).unwrap().to_rgb8();
            let when = [if when[0] == "--frames" { "--frame" } else { when[0] }, when[1]];
            for (i, j) in [(0, 0), (63, 35), (32, 18), (20, 25), (41, 14)] {
                let pixel = format!("{i},{j}");
                let arguments = [&[scene, "--pixel", &pixel], size, when.as_slice()].concat();
                let report = json_of(&arguments);
                assert_eq!(report["bytes"], json!(picture.get_pixel(i, j).0), "{file} at {pixel}");
                // The text output has the same bytes.
                let text = stdout_of(&arguments, "");
                let bytes = text.lines().find_map(|line| line.strip_prefix("bytes")).unwrap();
                let bytes: Vec<u8> = bytes.split_whitespace().map(|byte| byte.parse().unwrap()).collect();
                assert_eq!(bytes, picture.get_pixel(i, j).0, "{file} at {pixel}");
            }
        }
    }
}

#[test]
fn probe_trees_match_their_snapshots() {
    let bless = std::env::var_os("RAYREEL_BLESS").is_some();
    for (name, arguments) in [
        ("corner.touching", vec!["corner.ron", "--pixel", "2,1"]),
        ("corner.background", vec!["corner.ron", "--pixel", "239,0", "--size", "240x1"]),
        ("mirrors.deep", vec!["mirrors.ron", "--pixel", "2,3", "--frame", "2"]),
        ("lens.sample", vec!["lens.ron", "--pixel", "2,1", "--sample", "3"]),
        ("mirrors.moment", vec!["mirrors.ron", "--pixel", "8,8", "--at", "0.3s"]),
        ("seed.screen", vec!["seed.ron", "--pixel", "10,20", "--terms"]),
        ("seed.sphere", vec!["seed.ron", "--ray", "0,-2,0,1,2,1", "--terms"]),
        ("terms.glass", vec!["terms.ron", "--pixel", "13,8", "--depth", "2", "--terms"]),
        ("sky.terms", vec!["sky.ron", "--pixel", "4,9", "--terms"]),
        ("sky.mirror", vec!["sky.ron", "--pixel", "13,7", "--depth", "2", "--terms"]),
        ("terms.crate", vec!["terms.ron", "--ray", "1.8,0.7,-9,0,0,1", "--depth", "2", "--terms"]),
    ] {
        let found = stdout_of(&arguments, "");
        assert!(found.lines().all(|line| line.chars().count() <= 100 && line.trim_end() == line));
        let path = root().join(format!("tests/probe/{name}.txt"));
        if bless {
            fs::write(&path, &found).unwrap();
        }
        let expected = fs::read_to_string(&path).unwrap_or_default();
        assert!(found == expected, "{name}\n--- expected\n{expected}\n--- found\n{found}");
    }
}

#[test]
fn probe_uses_the_camera_of_the_shot() {
    let folder = tempfile::tempdir().unwrap();
    let scene = |name: &str, camera: &str, shots: &str| {
        let path = folder.path().join(name);
        let text = format!(
            r#"(
    timeline: (fps: 2, duration: 3), {camera}
    cameras: {{
        "wide": (position: (0, 0, -9), target: (0, 0, 0)),
        "close": (position: (0, 0, -3), target: (0, 0, 0)),
    }},
    shots: [(0, "close"), {shots}],
)"#
        );
        fs::write(&path, text).unwrap();
        path
    };
    let several = scene(
        "several.ron",
        "camera: (position: (0, 0, -5), view: (0, 0, 1)),",
        r#"(1, "camera"), (2, "wide")"#,
    );
    let none_alone = scene("none_alone.ron", "", r#"(1, "wide")"#);
    let lines = |scene: &Path| -> Vec<Value> {
        let scene = scene.to_str().unwrap();
        let line = |frame: &str| json_of(&[scene, "--pixel", "0,0", "--frame", frame])["camera_line"].clone();
        ["1", "2", "5"].map(line).to_vec()
    };
    assert_eq!(lines(&several), [json!(5), json!(2), json!(4)]);
    assert_eq!(lines(&none_alone), [json!(5), json!(4), json!(4)]);
    let stdout = stdout_of(&[several.to_str().unwrap(), "--pixel", "0,0"], "");
    assert!(stdout.contains("several.ron:5)\n"), "{stdout}");
}

#[test]
fn json_and_tree_have_the_same_values() {
    let report = json_of(&["corner.ron", "--pixel", "2,1"]);
    assert_eq!(report["scene"], "corner.ron");
    assert_eq!(
        (&report["pixel"], &report["width"], &report["height"]),
        (&json!([2, 1]), &json!(5), &json!(3))
    );
    assert_eq!(
        (&report["frame"], &report["time"], &report["camera_line"]),
        (&json!(0), &json!(0.0), &json!(4))
    );
    let rays = report["rays"].as_array().unwrap();
    let kinds: Vec<_> = rays.iter().map(|ray| (&ray["kind"], &ray["parent"], &ray["finds"])).collect();
    assert_eq!(
        kinds,
        [
            (&json!("camera"), &json!(null), &json!("surface")),
            (&json!("reflection"), &json!(0), &json!("surface")),
            (&json!("reflection"), &json!(1), &json!("depth limit")),
        ]
    );
    let surface = &rays[0]["surface"];
    assert_eq!(
        surface["entity"],
        json!({ "name": "wall, left", "order": 0, "file": "corner.ron", "line": 13 })
    );
    assert_eq!(
        surface["also_there"],
        json!([{ "name": null, "order": 1, "file": "corner.ron", "line": 14 }])
    );
    assert_eq!((&surface["t"], &surface["from_outside"]), (&json!(4.0), &json!(true)));
    let outcomes: Vec<_> = surface["lights"]
        .as_array()
        .unwrap()
        .iter()
        .map(|light| light["outcome"].as_str().unwrap())
        .collect();
    assert_eq!(outcomes, ["reaches", "hidden", "no shadow ray"]);
    assert_eq!(surface["lights"][2]["reason"], "the light is off");
    assert_eq!(
        surface["lights"][1]["hidden_by"],
        json!({ "name": "curtain", "order": 4, "file": "corner.ron", "line": 17 })
    );

    // The contributions to the pixel add up to its colour.
    let sum = rays.iter().fold([0.0_f32; 3], |sum, ray| {
        let part = numbers(&ray["to_pixel"]);
        std::array::from_fn(|channel| sum[channel] + single(part[channel]))
    });
    assert_eq!(sum.map(f64::from).as_slice(), numbers(&report["linear"]));

    assert_eq!(json_of(&["mirrors.ron", "--pixel", "0,0", "--at", "0.25s"])["frame"], json!(null));
}

#[test]
fn json_and_tree_numbers_are_bit_exact() {
    let mut engine = Engine::load(root().join("tests/probe/mirrors.ron")).unwrap();
    engine.render_frame(3).unwrap();
    let expected = engine.probe(engine.report().time, (7, 2), 0).unwrap().unwrap();
    let report = json_of(&["mirrors.ron", "--pixel", "7,2", "--frame", "3"]);
    let tree = stdout_of(&["mirrors.ron", "--pixel", "7,2", "--frame", "3"], "");
    let mut directions = tree.lines().filter_map(|line| line.split_once("direction").map(|(_, rest)| rest));
    assert_eq!(expected.rays.len(), 8);
    for (ray, found) in expected.rays.iter().zip(report["rays"].as_array().unwrap()) {
        assert_eq!(numbers(&found["origin"]), ray.ray.origin().to_array());
        assert_eq!(numbers(&found["direction"]), ray.ray.direction().to_array());
        let drawn: Vec<f64> =
            directions.next().unwrap().split_whitespace().map(|number| number.parse().unwrap()).collect();
        assert_eq!(drawn, ray.ray.direction().to_array());
    }
}

#[test]
fn rays_are_cast_in_order_from_a_file_and_from_standard_input() {
    let rays = "ox,oy,oz,dx,dy,dz\n\
        -0.5,0,-4,0,0,2\n\
        \n\
        0.5,0.25,-4,0,0,0.125\r\n\
        0,0,-4,0,0,-1\n\
        0,5,0,0,1,0";
    let expected = format!(
        "{HEADER}\n\
        1,\"wall, left\",2,-0.5,0,0,0,0,-1\n\
        1,#1,32,0.5,0.25,0,0,0,-1\n\
        1,back mirror,4,0,0,-8,0,0,1\n\
        0,,,,,,,,\n"
    );
    assert_eq!(stdout_of(&["corner.ron", "--rays", "-"], rays), expected);
    let folder = tempfile::tempdir().unwrap();
    let file = folder.path().join("rays.csv");
    fs::write(&file, rays).unwrap();
    assert_eq!(stdout_of(&["corner.ron", "--rays", file.to_str().unwrap()], ""), expected);
    assert_eq!(
        stdout_of(&["corner.ron", "--rays", "-", "--json"], rays),
        "{\"hit\":true,\"entity\":\"wall, left\",\"t\":2.0,\"point\":[-0.5,0.0,0.0],\"normal\":[0.0,0.0,-1.0]}\n\
        {\"hit\":true,\"entity\":\"#1\",\"t\":32.0,\"point\":[0.5,0.25,0.0],\"normal\":[0.0,0.0,-1.0]}\n\
        {\"hit\":true,\"entity\":\"back mirror\",\"t\":4.0,\"point\":[0.0,0.0,-8.0],\"normal\":[0.0,0.0,1.0]}\n\
        {\"hit\":false}\n"
    );
    // Empty input produces only the header.
    assert_eq!(stdout_of(&["corner.ron", "--rays", "-"], ""), format!("{HEADER}\n"));
    assert_eq!(stdout_of(&["corner.ron", "--rays", "-", "--json"], "\n"), "");
}

#[test]
fn rays_are_cast_at_the_given_moment_with_facing_normals() {
    // The bubble's radius is 2 after one second of its two.
    for when in [["--frame", "4"], ["--at", "1s"]] {
        let arguments = [["mirrors.ron", "--rays", "-"].as_slice(), &when].concat();
        assert_eq!(
            stdout_of(&arguments, "0,0,0,0,0,1\n0,0,5,0,0,-1\n"),
            format!("{HEADER}\n1,bubble,2,0,0,2,0,0,-1\n1,bubble,3,0,0,2,0,0,1\n")
        );
    }
}

/// Returns rays by a fixed rule, enough for several batches.
fn many_rays(count: u32) -> Vec<Ray> {
    let part =
        |index: u32, factor: u32| f64::from(index.wrapping_mul(factor) >> 8) / f64::from(1 << 24) - 0.5;
    let ray = |index: u32| Ray {
        origin: [0.5, 2.6, -8.5].into(),
        direction: [part(index, 2_654_435_761), part(index, 2_246_822_519) - 0.1, 1.0].into(),
    };
    (0..count).map(ray).collect()
}

fn csv_of(rays: &[Ray]) -> String {
    let mut lines = String::new();
    for Ray { origin, direction } in rays {
        let (o, d) = (origin, direction);
        writeln!(lines, "{},{},{},{},{},{}", o.x, o.y, o.z, d.x, d.y, d.z).unwrap();
    }
    lines
}

#[test]
fn hits_of_many_batches_are_bit_exact() {
    let scene = root().join("scenes/first_light.ron");
    let rays = many_rays(20_000);
    let mut engine = Engine::load(&scene).unwrap();
    engine.seek(Time::ZERO).unwrap();
    let expected = engine.cast_all(&rays);
    let input = csv_of(&rays);

    let answers = stdout_of(&[scene.to_str().unwrap(), "--rays", "-"], &input);
    let mut lines = answers.lines();
    assert_eq!(lines.next(), Some(HEADER));
    let objects = stdout_of(&[scene.to_str().unwrap(), "--rays", "-", "--json"], &input);
    let mut objects = objects.lines().map(|line| serde_json::from_str::<Value>(line).unwrap());
    let mut hits = 0;
    for hit in &expected {
        let (line, object) = (lines.next().unwrap(), objects.next().unwrap());
        let Some(hit) = hit else {
            assert_eq!((line, object), ("0,,,,,,,,", json!({ "hit": false })));
            continue;
        };
        hits += 1;
        let name = engine.world().get::<&Name>(hit.entity).unwrap().0.clone();
        let mut bits = vec![hit.t.unwrap()];
        bits.extend(hit.point.to_array());
        bits.extend(hit.normal.to_array());
        let fields: Vec<&str> = line.split(',').collect();
        assert_eq!(fields[..2], ["1", &name]);
        let parsed: Vec<f64> = fields[2..].iter().map(|field| field.parse().unwrap()).collect();
        assert_eq!(parsed, bits);
        assert_eq!((&object["hit"], &object["entity"]), (&json!(true), &json!(name)));
        let parsed =
            [vec![object["t"].as_f64().unwrap()], numbers(&object["point"]), numbers(&object["normal"])];
        assert_eq!(parsed.concat(), bits);
    }
    assert!(lines.next().is_none() && objects.next().is_none() && hits > 5_000 && hits < 20_000);
}

#[test]
fn invalid_ray_stops_after_earlier_results() {
    let mut input = csv_of(&many_rays(10_000));
    input += "0,0,0,0,0,zero\n0,0,0,0,0,1\n";
    let scene = root().join("scenes/first_light.ron");
    let output = probe(&[scene.to_str().unwrap(), "--rays", "-"], &input);
    assert_eq!(output.status.code(), Some(1));
    assert_eq!(text(&output.stdout).lines().count(), 10_001);
    assert_eq!(
        text(&output.stderr),
        "error: standard input:10001:11: `zero` is not a number: write one such as 1, -0.25 or 1e-3\n"
    );
}

#[test]
fn invalid_options_report_the_valid_form() {
    let folder = tempfile::tempdir().unwrap();
    let file = folder.path().join("short.csv");
    fs::write(&file, "0,0,0,0,0,1\n0,0,0\n").unwrap();
    let file = file.to_str().unwrap();
    let light = root().join("scenes/first_light.ron");
    let light = light.to_str().unwrap();
    for (arguments, code, message) in [
        (
            vec!["corner.ron", "--pixel", "5,1"],
            1,
            "error: there is no pixel 5,1: the film of 5x3 has columns 0 to 4 and rows 0 to 2\n".to_owned(),
        ),
        (
            vec!["corner.ron", "--pixel", "0,0", "--sample", "1"],
            1,
            "error: there is no sample 1: pixels of this scene have one, 0\n".to_owned(),
        ),
        (
            vec![light, "--pixel", "0,36", "--size", "64x36"],
            1,
            "error: there is no pixel 0,36: the film of 64x36 has columns 0 to 63 and rows 0 to 35\n"
                .to_owned(),
        ),
        (
            vec![light, "--pixel", "0,0", "--frame", "96"],
            1,
            "error: there is no frame 96: the timeline of 4 s at 24 frames a second has frames 0 to 95\n"
                .to_owned(),
        ),
        (
            vec!["corner.ron", "--rays", "-", "--frame", "1"],
            1,
            "error: there is no frame 1: the scene is a single frame, 0\n".to_owned(),
        ),
        (
            vec!["corner.ron", "--pixel", "0,0", "--size", "0x9"],
            2,
            "error: invalid value '0x9' for '--size <WIDTHxHEIGHT>': each side must be from 1 to 32768 pixels\n\nFor more information, try '--help'.\n".to_owned(),
        ),
        (
            vec!["corner.ron", "--rays", file],
            1,
            format!(
                "error: {file}:2: 3 values instead of 6: write a ray as ox,oy,oz,dx,dy,dz, its origin and its direction\n"
            ),
        ),
        (
            vec!["corner.ron", "--rays", "none.csv"],
            1,
            "error: cannot read `none.csv`: No such file or directory (os error 2)\n".to_owned(),
        ),
    ] {
        let output = probe(&arguments, "");
        assert_eq!(output.status.code(), Some(code), "{arguments:?}");
        if cfg!(unix) || !message.contains("os error") {
            assert_eq!(text(&output.stderr), message, "{arguments:?}");
        }
    }
    for (arguments, expected) in [
        (vec!["corner.ron"], "<--pixel <COLUMN,ROW>|--ray <OX,OY,OZ,DX,DY,DZ>|--rays <FILE>>"),
        (vec!["corner.ron", "--pixel", "1,1", "--rays", "-"], "cannot be used with"),
        (vec!["corner.ron", "--rays", "-", "--size", "5x5"], "cannot be used with"),
        (vec!["corner.ron", "--pixel", "1,1", "--frame", "0", "--at", "1s"], "cannot be used with"),
        (
            vec!["corner.ron", "--pixel", "-1,1"],
            "write column and row, from 0 at the top left, as in 480,270",
        ),
        (vec!["corner.ron", "--pixel", "11"], "write column and row, from 0 at the top left, as in 480,270"),
    ] {
        let output = probe(&arguments, "");
        assert_eq!(output.status.code(), Some(2), "{arguments:?}");
        assert!(text(&output.stderr).contains(expected), "{arguments:?}: {}", text(&output.stderr));
        assert!(output.stdout.is_empty());
    }
}

#[test]
fn closed_pipe_ends_probe_without_an_error() {
    let mut probe = command(RAYREEL, root());
    probe.args(["probe", "scenes/first_light.ron", "--rays", "-"]).stdin(Stdio::piped());
    let mut child = probe.spawn().unwrap();
    let mut input = child.stdin.take().unwrap();
    let lines = csv_of(&many_rays(8_192));
    // The feeder writes until the pipe is closed.
    let feeder = std::thread::spawn(move || (0..1_000).all(|_| input.write_all(lines.as_bytes()).is_ok()));
    let mut output = BufReader::new(child.stdout.take().unwrap());
    let mut line = String::new();
    output.read_line(&mut line).unwrap();
    assert_eq!(line.trim_end(), HEADER);
    drop(output);
    let mut errors = String::new();
    child.stderr.take().unwrap().read_to_string(&mut errors).unwrap();
    assert_eq!((child.wait().unwrap().code(), errors.as_str()), (Some(0), ""));
    assert!(!feeder.join().unwrap(), "all was read before the end was noticed");
}

#[test]
fn scene_and_rays_cannot_both_come_from_standard_input() {
    let scene = fs::read_to_string(root().join("scenes/first_light.ron")).unwrap();
    for arguments in [&["-", "--rays", "-"][..], &["--rays", "-", "--json", "-"]] {
        let output = probe(arguments, &scene);
        assert_eq!(output.status.code(), Some(1), "{arguments:?}");
        assert_eq!(text(&output.stdout), "", "{arguments:?}");
        assert_eq!(
            text(&output.stderr),
            "error: both the scene and the rays are to be read from standard input: name a file for one of them\n"
        );
    }
}
