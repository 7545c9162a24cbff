//! Tests of sequences that are resumed, verified, and divided into shards.

use std::collections::BTreeMap;
use std::fs;
use std::path::Path;

use rayreel::RenderRequest;
use rayreel::color::Transfer;
use serde_json::Value;

use crate::{RAYREEL, command, output_of, pictures, rayreel, stdout_of, text};

/// Returns a film of three shots, cut to `duration` seconds and edited.
fn film(duration: f64, edit: impl Fn(String) -> String) -> String {
    edit(format!(
        r#"Scene(
    timeline: (fps: 4, duration: {duration}),
    film: (width: 32, height: 18),
    cameras: {{
        "left": (position: (-4, 1, -8), target: (0, 1, 0)),
        "middle": (position: (0, 1, -8), target: (0, 1, 0)),
        "right": (position: (4, 1, -8), target: (0, 1, 0)),
    }},
    shots: [(0, "left"), (1, "middle"), (2, "right")],
    ambient: (0.2, 0.2, 0.2),
    materials: {{ "clay": (k_a: 0.3, k_d: 0.7, color: (255, 120, 60)) }},
    entities: [
        (name: "floor", shape: Plane(normal: (0, 1, 0)), material: "clay"),
        (name: "ball", shape: Sphere(radius: 1), transform: (translation: (0, 1, 0)), material: "clay"),
        (name: "key", light: Point(intensity: (1, 1, 1)), transform: (translation: (4, 6, -4))),
    ],
)"#
    ))
}

fn write_film(folder: &Path, duration: f64, edit: impl Fn(String) -> String) {
    fs::write(folder.join("film.ron"), film(duration, edit)).unwrap();
}

/// Renders the film. Returns the rendered frames and the kept frames.
fn render(folder: &Path, options: &[&str]) -> (Vec<u64>, Vec<u64>) {
    let arguments = ["render", "film.ron", "--out", "out", "--json"];
    let report: Value = serde_json::from_str(&stdout_of(folder, arguments.iter().chain(options))).unwrap();
    let numbers = |list: &Value, number: &dyn Fn(&Value) -> Option<u64>| -> Vec<u64> {
        list.as_array().unwrap().iter().filter_map(number).collect()
    };
    (numbers(&report["frames"], &|frame| frame["frame"].as_u64()), numbers(&report["kept"], &Value::as_u64))
}

/// Returns the report of `verify`, which must exit with 0 exactly if the sequence is complete.
fn verify(folder: &Path, options: &[&str]) -> Value {
    let output = rayreel(folder, ["verify", "out", "--json"].iter().chain(options));
    let verdict: Value =
        serde_json::from_slice(&output.stdout).unwrap_or_else(|_| panic!("{}", text(&output.stderr)));
    assert_eq!(verdict["whole"].as_bool().unwrap(), output.status.success());
    verdict
}

/// Checks that `render` fails with these options and reports the reason.
fn assert_refused(folder: &Path, options: &[&str], why: &str) {
    let output = rayreel(folder, ["render", "film.ron"].iter().chain(options));
    assert!(!output.status.success());
    assert!(text(&output.stderr).contains(why), "{options:?}: {}", text(&output.stderr));
}

fn all(range: std::ops::Range<u64>) -> Vec<u64> {
    range.collect()
}

/// Returns all frames with their bytes.
fn frames(folder: &Path) -> BTreeMap<String, Vec<u8>> {
    pictures(folder).into_iter().map(|name| (name.clone(), fs::read(folder.join(&name)).unwrap())).collect()
}

#[test]
fn only_edited_frames_are_rendered_again() {
    let folder = tempfile::tempdir().unwrap();
    let folder = folder.path();
    write_film(folder, 3.0, |film| film);
    assert_eq!(render(folder, &[]), (all(0..12), vec![]));
    assert_eq!(render(folder, &[]), (vec![], all(0..12)));
    assert_eq!(verify(folder, &[])["whole"], true);
    let before = frames(&folder.join("out"));

    // Other names, comments and equivalent notations do not change the pictures.
    write_film(folder, 3.0, |film| {
        let renamed = film.replace("clay", "terracotta").replace("\"ball\"", "\"globe\"");
        format!("// A film.\n{renamed}").replace("(255, 120, 60)", "\"#ff783c\"")
    });
    assert_eq!(render(folder, &[]), (vec![], all(0..12)));

    // First the last shot's camera changes, then every frame.
    write_film(folder, 3.0, |film| film.replace("(position: (4, 1, -8)", "(position: (4, 2, -8)"));
    let verdict = verify(folder, &[]);
    assert_eq!(verdict["stale"], serde_json::json!([8, 9, 10, 11]));
    assert_eq!(verdict["to_render"], "8-11");
    assert_eq!(render(folder, &[]), (all(8..12), all(0..8)));
    write_film(folder, 3.0, |film| film.replace("radius: 1", "radius: 0.9"));
    assert_eq!(render(folder, &["--frames", "0-2,11-"]), (vec![0, 1, 2, 11], vec![]));
    write_film(folder, 3.0, |film| film);
    assert_eq!(render(folder, &[]), (vec![0, 1, 2, 8, 9, 10, 11], all(3..8)));
    assert_eq!(render(folder, &["--overwrite", "--frames=3"]), (vec![3], vec![]));
    assert_eq!(frames(&folder.join("out")), before);

    // Other thread counts and the full kernel make the same frames; other settings do not.
    assert_eq!(render(folder, &["--threads", "1", "--full"]).0, Vec::<u64>::new());
    assert_eq!(render(folder, &["--frames=0", "--samples", "4"]).0, [0]);
    assert_eq!(render(folder, &["--frames=0", "--set", "film.transfer=Classic"]).0, [0]);
    // A frame at a time is kept like a numbered frame.
    assert_eq!(render(folder, &["--at=0.1s"]).1, Vec::<u64>::new());
    let again = stdout_of(folder, ["render", "film.ron", "--out", "out", "--at=0.1s", "--json"]);
    let report: Value = serde_json::from_str(&again).unwrap();
    assert_eq!((&report["kept"], &report["frames"]), (&serde_json::json!([null]), &serde_json::json!([])));

    // The folder records the settings of the last rendering.
    assert_eq!(verify(folder, &[])["to_render"], "1-11");
}

#[test]
fn shorter_timeline_reports_surplus_frames() {
    let folder = tempfile::tempdir().unwrap();
    let folder = folder.path();
    write_film(folder, 3.0, |film| film);
    render(folder, &[]);
    write_film(folder, 2.5, |film| film);
    fs::copy(folder.join("out/film.0000.png"), folder.join("out/film.00001.png")).unwrap();
    fs::write(folder.join("out/film.9999.png"), "somebody's").unwrap();
    fs::write(folder.join("out/film.sheet.png"), "not a frame").unwrap();

    let output = rayreel(folder, ["render", "film.ron", "--out", "out"]);
    assert!(output.status.success());
    let stderr = text(&output.stderr);
    for file in ["film.0010.png", "film.0011.png", "film.00001.png", "film.9999.png"] {
        assert!(stderr.contains(&format!("{file}` is no frame of this sequence")), "{stderr}");
    }
    assert!(stderr.contains("--clean"), "{stderr}");
    let verdict = verify(folder, &[]);
    assert_eq!((verdict["surplus"].as_array().unwrap().len(), &verdict["to_render"]), (4, &Value::Null));

    let output = rayreel(folder, ["render", "film.ron", "--out", "out", "--clean"]);
    assert!(text(&output.stderr).contains("removed 3 files"), "{}", text(&output.stderr));
    // Files that were not rendered here are not removed.
    assert_eq!(pictures(&folder.join("out")).len(), 12);
    fs::remove_file(folder.join("out/film.9999.png")).unwrap();
    assert_eq!(verify(folder, &[])["whole"], true);

    // Frames of another size are surplus if they are not requested, and stale if they are.
    assert_eq!(render(folder, &["--size", "16x9", "--frames=0"]).0, [0]);
    let verdict = verify(folder, &["--frames=0"]);
    assert_eq!(verdict["surplus"].as_array().unwrap().len(), 9);
    assert_eq!(verify(folder, &[])["stale"].as_array().unwrap().len(), 9);
}

#[test]
fn corrupt_frames_are_rendered_again() {
    let folder = tempfile::tempdir().unwrap();
    let folder = folder.path();
    write_film(folder, 3.0, |film| film);
    render(folder, &[]);
    let whole = frames(&folder.join("out"));
    let path = |frame: usize| folder.join(format!("out/film.{frame:04}.png"));
    let bytes = fs::read(path(5)).unwrap();
    let flipped = |place: usize| {
        let mut bytes = bytes.clone();
        bytes[place] ^= 1;
        bytes
    };
    let mut torn: Vec<Vec<u8>> = (0..10).map(|part| bytes[..bytes.len() * part / 10].to_vec()).collect();
    torn.extend([vec![0; bytes.len()], flipped(3), flipped(bytes.len() / 2), flipped(bytes.len() - 1)]);
    for bytes in &torn {
        fs::write(path(5), bytes).unwrap();
        let verdict = verify(folder, &[]);
        assert_eq!(verdict["torn"], serde_json::json!([5]), "{verdict}");
        assert_eq!(verdict["damage"][0]["frame"], 5);
        assert_eq!(render(folder, &[]).0, [5]);
    }
    // A copy of another frame, a picture without a fingerprint, and a missing file.
    fs::copy(path(0), path(11)).unwrap();
    image::RgbImage::new(32, 18).save(path(6)).unwrap();
    fs::remove_file(path(7)).unwrap();
    let verdict = verify(folder, &[]);
    assert_eq!(verdict["stale"], serde_json::json!([11]));
    assert_eq!(verdict["unknown"], serde_json::json!([6]));
    assert_eq!(verdict["missing"], serde_json::json!([7]));
    let output = rayreel(folder, ["verify", "out"]);
    assert!(text(&output.stdout).contains("9 of 12 frames"), "{}", text(&output.stdout));
    assert!(text(&output.stderr).contains("--frames 6-7,11"), "{}", text(&output.stderr));
    assert_eq!(render(folder, &["--frames", "6-7,11"]).0, [6, 7, 11]);
    assert_eq!(frames(&folder.join("out")), whole);
}

#[test]
fn shards_together_render_every_frame_once() {
    let folder = tempfile::tempdir().unwrap();
    let folder = folder.path();
    write_film(folder, 3.0, |film| film);
    render(folder, &[]);
    let whole = frames(&folder.join("out"));
    for count in 1..=7 {
        fs::remove_dir_all(folder.join("out")).unwrap();
        let mut rendered = Vec::new();
        for index in 0..count {
            let (own, kept) = render(folder, &["--shard", &format!("{index}/{count}"), "--order", "coarse"]);
            assert!(kept.is_empty());
            rendered.extend(own);
        }
        rendered.sort_unstable();
        assert_eq!(rendered, all(0..12), "{count}");
        assert_eq!(frames(&folder.join("out")), whole);
        assert_eq!(verify(folder, &[])["whole"], true);
    }
    // With more shards than frames, some shards are empty.
    assert_eq!(render(folder, &["--shard", "5/7", "--frames", "0-2"]), (vec![], vec![]));
}

#[test]
fn selected_samples_are_verified() {
    let folder = tempfile::tempdir().unwrap();
    let folder = folder.path();
    write_film(folder, 1.0, |film| film);
    assert_eq!(render(folder, &["--max-error", "2"]).0, all(0..4));
    assert_eq!(verify(folder, &[])["whole"], true);
    assert_eq!(render(folder, &["--max-error", "2"]), (vec![], all(0..4)));
    // Lost settings are restored.
    fs::remove_file(folder.join("out/film.settings.json")).unwrap();
    assert_eq!(render(folder, &["--max-error", "2"]), (vec![], all(0..4)));
    assert_eq!(render(folder, &["--settings", "out/film.settings.json"]), (vec![], all(0..4)));
    assert_eq!(verify(folder, &[])["whole"], true);
    assert_eq!(render(folder, &["--samples", "16", "--frames=2"]).0, [2]);
    assert_eq!(verify(folder, &[])["to_render"], "0-1,3");
}

/// Checks that concurrent shards record their chosen samples next to the frames without losing the samples of other shards.
#[test]
fn concurrent_shards_merge_their_settings_files() {
    let folder = tempfile::tempdir().unwrap();
    let folder = folder.path();
    write_film(folder, 3.0, |film| film);
    for _ in 0..4 {
        let shards = ["0/3", "1/3", "2/3"].map(|shard| {
            let arguments =
                ["render", "film.ron", "--out", "out", "--overwrite", "--max-error=2", "--shard", shard];
            command(RAYREEL, folder).args(arguments).spawn().unwrap()
        });
        for shard in shards {
            let output = output_of(shard);
            assert!(output.status.success(), "{}", text(&output.stderr));
        }
        assert_eq!(verify(folder, &[])["whole"], true);
        fs::remove_file(folder.join("out/film.settings.json")).unwrap();
    }
}

#[test]
fn drafts_and_other_folders_are_verified() {
    let folder = tempfile::tempdir().unwrap();
    let folder = folder.path();
    write_film(folder, 1.0, |film| film);
    render(folder, &["--draft", "--format", "ppm"]);
    assert!(rayreel(folder, ["verify", "out/draft"]).status.success());
    // The folder and the scene can be moved together.
    fs::create_dir(folder.join("moved")).unwrap();
    for name in ["film.ron", "out"] {
        fs::rename(folder.join(name), folder.join("moved").join(name)).unwrap();
    }
    assert!(rayreel(folder, ["verify", "moved/out/draft"]).status.success());
    fs::rename(folder.join("moved/film.ron"), folder.join("film.ron")).unwrap();
    let output = rayreel(folder, ["verify", "moved/out/draft"]);
    assert_eq!(output.status.code(), Some(1));
    assert!(text(&output.stderr).contains("film.ron"), "{}", text(&output.stderr));
    assert!(rayreel(folder, ["verify", "moved/out/draft", "--scene", "film.ron"]).status.success());
    let output = rayreel(folder, ["verify", "moved"]);
    assert!(text(&output.stderr).contains("does not say what its frames"), "{}", text(&output.stderr));
}

#[test]
fn standard_output_takes_video() {
    let folder = tempfile::tempdir().unwrap();
    let folder = folder.path();
    write_film(folder, 1.0, |film| film);
    render(folder, &["--format", "ppm"]);
    let raw = rayreel(folder, ["render", "film.ron", "--out", "-", "--format", "raw"]);
    assert!(raw.status.success(), "{}", text(&raw.stderr));
    let files = (0..4).map(|frame| image::open(folder.join(format!("out/film.{frame:04}.ppm"))).unwrap());
    assert_eq!(raw.stdout, files.flat_map(|frame| frame.to_rgb8().into_raw()).collect::<Vec<u8>>());
    let video = rayreel(folder, ["render", "film.ron", "--out", "-", "--frames", "2-"]).stdout;
    let header = b"YUV4MPEG2 W32 H18 F4:1 Ip A1:1 C444 XCOLORRANGE=LIMITED\n";
    assert!(video.starts_with(&[&header[..], b"FRAME\n"].concat()));
    assert_eq!(video.len(), header.len() + 2 * (6 + 3 * 32 * 18));
    assert!(!folder.join("-").exists());
    for (more, expected) in [
        (&["--out", "-", "--json"][..], "frames cannot go to standard output: --json"),
        (
            &["--out", "-", "--format", "png"],
            "png, ppm, pfm, exr and hdr are files: standard output takes --format y4m or raw",
        ),
        (&["--format", "y4m"], "add --out -"),
        (&["--movie", "a.txt"], "a movie ends in .mp4"),
    ] {
        assert_refused(folder, more, expected);
    }
}

/// Checks that a reader that closes the pipe ends the rendering without a failure.
#[test]
fn closed_standard_output_ends_the_stream_without_an_error() {
    use std::io::Read;
    use std::process::{Command, Stdio};

    let folder = tempfile::tempdir().unwrap();
    write_film(folder.path(), 1.0, |film| film);
    let mut command = Command::new(env!("CARGO_BIN_EXE_rayreel"));
    command.current_dir(folder.path()).args(["render", "film.ron", "--out", "-", "--size", "640x360"]);
    let mut child = command.stdout(Stdio::piped()).stderr(Stdio::piped()).spawn().unwrap();
    let mut beginning = [0; 9];
    child.stdout.take().unwrap().read_exact(&mut beginning).unwrap();
    let output = child.wait_with_output().unwrap();
    assert_eq!(&beginning, b"YUV4MPEG2");
    assert!(output.status.success(), "{}", text(&output.stderr));
    let stderr = text(&output.stderr);
    assert!(!stderr.contains("error") && !stderr.contains("panicked"), "{stderr}");
}

/// Checks folders that even root cannot create.
#[cfg(target_os = "linux")]
#[test]
fn unwritable_folder_is_reported() {
    let folder = tempfile::tempdir().unwrap();
    write_film(folder.path(), 1.0, |film| film);
    for out in ["/sys/kernel/rayreel", "/proc/rayreel"] {
        let output = rayreel(folder.path(), ["render", "film.ron", "--out", out]);
        assert_eq!(output.status.code(), Some(1), "{out}");
        assert!(
            text(&output.stderr).contains(&format!("cannot make the folder `{out}`")),
            "{}",
            text(&output.stderr)
        );
    }
}

/// Checks that every format holds the library's light, as exactly as the format allows.
#[test]
fn every_format_stores_the_same_light() {
    let folder = tempfile::tempdir().unwrap();
    let folder = folder.path();
    write_film(folder, 1.0, |film| film);
    let mut engine = rayreel::Engine::load(folder.join("film.ron")).unwrap();
    let film = engine.render_frame(1).unwrap();
    let transfer = engine.effective_settings().film.transfer;
    for format in ["png16", "pfm", "exr", "hdr"] {
        render(folder, &["--format", format]);
        assert_eq!(verify(folder, &[])["whole"], true, "{format}");
        assert_eq!(render(folder, &["--format", format]), (vec![], all(0..4)), "{format}");
    }
    let sixteen = image::open(folder.join("out/film.0001.png")).unwrap();
    assert_eq!(sixteen.color(), image::ColorType::Rgb16);
    let values = film.pixels().iter().flat_map(|pixel| transfer.encode_16(*pixel));
    assert_eq!(sixteen.into_rgb16().into_raw(), values.collect::<Vec<u16>>());

    let light: Vec<u8> =
        film.pixels().iter().flat_map(rayreel::Rgb::to_array).flat_map(f32::to_le_bytes).collect();
    let pfm = fs::read(folder.join("out/film.0001.pfm")).unwrap();
    let pixels = pfm.strip_prefix(b"PF\n32 18\n-1.0\n").unwrap();
    let rows: Vec<u8> = pixels[..light.len()].chunks(32 * 12).rev().flatten().copied().collect();
    assert_eq!(rows, light);

    let hdr = image::open(folder.join("out/film.0001.hdr")).unwrap().into_rgb32f();
    for (found, light) in hdr.pixels().zip(film.pixels()) {
        // A unit is at most 1 / 128 of the largest channel.
        let unit = light.max_element() / 128.0;
        assert!((rayreel::Rgb::from(found.0) - *light).abs().max_element() <= unit, "{found:?} {light}");
    }

    let Some(exr) = planes_by_ffmpeg(&folder.join("out/film.0001.exr"), "gbrpf32le") else { return };
    assert!(exr == planes(&film));
    render(folder, &["--passes", "depth,distance,normal,id,albedo,position", "--frames", "1"]);
    assert!(planes_by_ffmpeg(&folder.join("out/film.0001.exr"), "gbrpf32le").unwrap() == planes(&film));
}

/// Checks that frames with alpha hold the library's values, premultiplied or not, as each format requires.
#[test]
fn frames_with_alpha_omit_the_background() {
    let folder = tempfile::tempdir().unwrap();
    let folder = folder.path();
    write_film(folder, 1.0, |film| film.replace("Scene(", "Scene(sampling: (samples: 4),"));
    let mut engine = rayreel::Engine::load(folder.join("film.ron")).unwrap();
    let time = engine.timeline.time_of(1);
    let image = engine.render(RenderRequest { alpha: true, ..RenderRequest::at(time) }).unwrap();
    let (light, alpha) = (image.film, image.alpha.unwrap());
    let transfer = engine.effective_settings().film.transfer;
    let partly = alpha.pixels().iter().filter(|alpha| **alpha > 0.0 && **alpha < 1.0).count();
    assert!(partly > 5 && alpha.pixels().contains(&0.0) && alpha.pixels().contains(&1.0), "{partly}");

    render(folder, &[]);
    for format in [&["--format", "exr"][..], &["--format", "png16"], &[]] {
        let options = [&["--alpha"], format].concat();
        assert_eq!(render(folder, &options), (all(0..4), vec![]), "{options:?}");
        assert_eq!(render(folder, &options), (vec![], all(0..4)), "{options:?}");
        assert_eq!(verify(folder, &[])["whole"], true, "{options:?}");
        let image = image::open(folder.join("out/film.0001.png")).unwrap();
        let expected = light.pixels().iter().zip(alpha.pixels()).map(|(light, alpha)| {
            (if *alpha > 0.0 { (light.as_dvec3() / f64::from(*alpha)).as_vec3() } else { *light }, *alpha)
        });
        match format {
            ["--format", "png16"] => {
                let share = |alpha: f32| Transfer::Classic.encode_16(rayreel::Rgb::splat(alpha))[0];
                let values = expected
                    .flat_map(|(color, alpha)| transfer.encode_16(color).into_iter().chain([share(alpha)]));
                assert_eq!(image.color(), image::ColorType::Rgba16);
                assert_eq!(image.into_rgba16().into_raw(), values.collect::<Vec<u16>>());
            }
            [] => {
                let share = |alpha: f32| Transfer::Classic.encode(rayreel::Rgb::splat(alpha))[0];
                let values = expected
                    .flat_map(|(color, alpha)| transfer.encode(color).into_iter().chain([share(alpha)]));
                assert_eq!(image.color(), image::ColorType::Rgba8);
                assert_eq!(image.into_rgba8().into_raw(), values.collect::<Vec<u8>>());
            }
            _ => {}
        }
    }
    let Some(exr) = planes_by_ffmpeg(&folder.join("out/film.0001.exr"), "gbrapf32le") else { return };
    let alpha = alpha.pixels().iter().flat_map(|alpha| alpha.to_le_bytes());
    assert!(exr == planes(&light).into_iter().chain(alpha).collect::<Vec<u8>>());
}

/// Returns the green, blue and red planes, and alpha if requested, as ffmpeg decodes a file. Returns `None` without ffmpeg.
fn planes_by_ffmpeg(file: &Path, planes: &str) -> Option<Vec<u8>> {
    let mut command = std::process::Command::new("ffmpeg");
    let command = command.args(["-v", "error", "-i"]).arg(file);
    let read = command.args(["-pix_fmt", planes, "-f", "rawvideo", "-"]).output().ok()?;
    assert!(read.status.success() && read.stderr.is_empty(), "{}", text(&read.stderr));
    Some(read.stdout)
}

fn planes(film: &rayreel::trace::Film) -> Vec<u8> {
    let plane =
        |channel: usize| film.pixels().iter().flat_map(move |pixel| pixel.to_array()[channel].to_le_bytes());
    [1, 2, 0].into_iter().flat_map(plane).collect()
}

#[test]
fn frame_names_follow_the_pattern() {
    let folder = tempfile::tempdir().unwrap();
    let folder = folder.path();
    write_film(folder, 1.0, |film| film);
    let named = &["--name", "shot_%03d_left"];
    assert_eq!(render(folder, named), (all(0..4), vec![]));
    assert!(folder.join("out/shot_003_left.png").is_file());
    assert_eq!(verify(folder, &[])["whole"], true);
    fs::copy(folder.join("out/shot_003_left.png"), folder.join("out/shot_004_left.png")).unwrap();
    assert_eq!(verify(folder, &[])["surplus"].as_array().unwrap().len(), 1);
    assert_eq!(render(folder, &[&named[..], &["--clean"]].concat()), (vec![], all(0..4)));
    assert!(!folder.join("out/shot_004_left.png").exists());
    let output = rayreel(folder, ["render", "film.ron", "--name", "shot_##_##"]);
    assert_eq!(output.status.code(), Some(2));
    assert!(text(&output.stderr).contains("one place for the frame's number"), "{}", text(&output.stderr));
}

#[test]
fn unsupported_channels_of_a_format_are_errors() {
    let folder = tempfile::tempdir().unwrap();
    let folder = folder.path();
    write_film(folder, 1.0, |film| film);
    for (more, expected) in [
        (&["--format", "png", "--passes", "depth"][..], "--passes are for --format exr"),
        (&["--passes", "deep"], "there is no pass `deep`"),
        (&["--format", "exr", "--movie", "a.gif"], "--movie is made of colours in 8 bits"),
        (&["--format", "png16", "--sheet", "2x2"], "--sheet is made of colours in 8 bits"),
        (&["--out", "-", "--passes", "id"], "--passes are for files"),
        (&["--alpha", "--format", "ppm"], "--alpha is for --format png, png16 or exr"),
        (&["--alpha", "--format", "hdr"], "--alpha is for --format png, png16 or exr"),
        (&["--format", "hdr", "--sheet", "2x2"], "--sheet is made of colours in 8 bits"),
        (&["--alpha", "--movie", "a.gif"], "--movie is made of colours in 8 bits"),
        (&["--alpha", "--sheet", "2x2"], "without --alpha"),
        (&["--alpha", "--out", "-"], "--alpha is for files"),
    ] {
        assert_refused(folder, more, expected);
    }
}

#[test]
fn movies_contain_every_frame() {
    use image::AnimationDecoder;

    let folder = tempfile::tempdir().unwrap();
    let folder = folder.path();
    write_film(folder, 1.0, |film| film);
    for (movie, more) in [("a.apng", &[][..]), ("a.gif", &["--order", "coarse"])] {
        render(folder, &[&["--movie", movie], more].concat());
        assert!(folder.join(movie).is_file());
    }
    let bytes = std::io::Cursor::new(fs::read(folder.join("a.apng")).unwrap());
    let decoder = image::codecs::png::PngDecoder::new(bytes).unwrap().apng().unwrap();
    let played = decoder.into_frames().collect_frames().unwrap();
    assert_eq!(played.len(), 4);
    for (index, frame) in played.iter().enumerate() {
        let file = image::open(folder.join(format!("out/film.{index:04}.png"))).unwrap();
        assert_eq!(*frame.buffer(), file.to_rgba8());
    }
    let output =
        rayreel(folder, ["render", "film.ron", "--out", "out", "--size", "31x17", "--movie", "a.mp4"]);
    if std::process::Command::new("ffmpeg").arg("-version").output().is_err() {
        println!("there is no ffmpeg: its error is tested instead");
        assert!(!output.status.success());
        assert!(text(&output.stderr).contains("made by ffmpeg"), "{}", text(&output.stderr));
        return;
    }
    assert!(output.status.success(), "{}", text(&output.stderr));
    let mut probe = std::process::Command::new("ffprobe");
    probe.args(["-v", "error", "-count_frames", "-show_streams", "-of", "json"]).arg(folder.join("a.mp4"));
    let info: Value = serde_json::from_slice(&probe.output().unwrap().stdout).unwrap();
    let stream = &info["streams"][0];
    let expected = [
        ("width", Value::from(32)),
        ("height", 18.into()),
        ("nb_read_frames", "4".into()),
        ("r_frame_rate", "4/1".into()),
        ("pix_fmt", "yuv420p".into()),
        ("color_space", "bt709".into()),
        ("color_range", "tv".into()),
        ("color_primaries", "bt709".into()),
        ("color_transfer", "iec61966-2-1".into()),
    ];
    for (name, value) in expected {
        assert_eq!(stream[name], value, "{name}: {info}");
    }
    assert!(crate::files(folder).iter().all(|name| !name.starts_with('.')));
}

#[test]
fn progress_formats_print_their_events() {
    let folder = tempfile::tempdir().unwrap();
    let folder = folder.path();
    write_film(folder, 1.0, |film| film);
    let run = |more: &[&str]| {
        let output = rayreel(folder, ["render", "film.ron", "--out", "out"].iter().chain(more));
        assert!(output.status.success());
        text(&output.stderr)
    };
    assert_eq!(run(&["--frames=0", "--quiet"]), "");
    let lines = run(&["--progress", "json"]);
    let objects: Vec<Value> = lines.lines().map(|line| serde_json::from_str(line).unwrap()).collect();
    let (objects, notes) = objects.split_at(4);
    assert_eq!(notes.len(), 2, "{lines}");
    for note in notes {
        assert!(note["event"] == "note" && note["message"].is_string(), "{lines}");
    }
    for (index, object) in objects.iter().enumerate() {
        assert_eq!((&object["frame"], &object["total"]), (&index.into(), &4.into()));
        let event = if index == 0 { "kept" } else { "rendered" };
        assert_eq!((&object["done"], &object["event"]), (&(index + 1).into(), &event.into()));
        assert!(index == 0 || object["seconds"]["trace"].is_f64() && object["rays"]["camera"] == 32 * 18);
    }
    assert!(run(&["--progress", "none", "--overwrite"]).lines().count() == 2);
    // All warnings are reported, too.
    let faulty = r#"(camera: (position: (0, 0, -5), target: (0, 0, 0)), materials: { "m": (k_a: 1) }, film: (width: 16, height: 9),
        background: (bottom: (0, 0, 0), top: (255, 255, 255)), entities: [(name: "far", shape: Box(size: (1, 1, 1)), material: "m", transform: (translation: (1e17, 0, 0)))])"#;
    fs::write(folder.join("faulty.ron"), faulty).unwrap();
    fs::create_dir(folder.join("faulty")).unwrap();
    for surplus in 20..27 {
        fs::write(folder.join(format!("faulty/faulty.00{surplus}.png")), "").unwrap();
    }
    let arguments =
        ["render", "faulty.ron", "--out=faulty", "--quiet", "--progress=json", "--set=ambient=(0, 0, 0)"];
    for more in [&[][..], &["--clean"]] {
        let output = rayreel(folder, arguments.iter().chain(more));
        assert!(output.status.success(), "{}", text(&output.stderr));
        let lines = text(&output.stderr);
        let events: Vec<Value> = lines.lines().map(|line| serde_json::from_str(line).unwrap()).collect();
        assert!(
            events[0]["event"].is_string() && events.iter().all(|event| event["event"] != "note"),
            "{lines}"
        );
        let warnings = events.iter().filter(|event| event["event"] == "warning");
        assert_eq!(warnings.count(), 8, "{lines}");
    }
    run(&["--frames=2", "--size=16x9", "--quiet"]);
    fs::write(folder.join("out/film.0003.png"), "").unwrap();
    let details = run(&["-v"]);
    let lines: Vec<&str> = details.lines().collect();
    assert_eq!(lines[..2], ["1/4 out/film.0000.png: kept", "2/4 out/film.0001.png: kept"], "{details}");
    assert!(lines.contains(&"out/film.0002.png is rendered again: its size was 16x9"));
    assert!(lines.iter().any(|line| line.starts_with("out/film.0003.png is rendered again: ")), "{details}");
    assert!(lines.iter().any(|line| line.starts_with("4/4 out/film.0003.png: ")), "{details}");
    let about = |line: &&&str| line.starts_with("  animate ") && line.contains("; rays: 1 k camera");
    assert_eq!(lines.iter().filter(about).count(), 2, "{details}");
}

/// Checks that a very long frame reports its progress until it is interrupted.
#[cfg(unix)]
#[test]
fn slow_frames_report_their_progress() {
    use std::io::{BufRead, BufReader};

    let folder = tempfile::tempdir().unwrap();
    write_film(folder.path(), 1.0, |film| film);
    for more in [&["--samples=65536"][..], &["--samples=65536", "--set=sampling.max_error=0.001"]] {
        let mut child = command(RAYREEL, folder.path());
        child.args(["render", "film.ron", "--frames=1", "--size=1280x720", "--progress=json"]).args(more);
        let mut child = child.spawn().unwrap();
        let mut lines = BufReader::new(child.stderr.take().unwrap()).lines();
        let mut events: Vec<Value> = Vec::new();
        // With an error target, the share is known after the first round.
        while events.len() < 2 || events.last().is_some_and(|event| event["share"].is_null()) {
            events.push(serde_json::from_str(&lines.next().unwrap().unwrap()).unwrap());
        }
        let (signal, code) = crate::ignored::interruption();
        crate::signal(&child, signal);
        let rest: Vec<String> = lines.map(Result::unwrap).collect();
        assert_eq!(output_of(child).status.code(), Some(code), "{rest:?}");
        for event in &events {
            assert_eq!((&event["event"], &event["frame"]), (&"rendering".into(), &1.into()), "{event}");
            assert!(event["samples_per_pixel"].as_f64().unwrap() > 0.0, "{event}");
        }
        assert!(more.len() > 1 || events[0]["share"].is_number(), "{events:?}");
        let share = events.last().unwrap()["share"].as_f64().unwrap();
        assert!(share > 0.0 && share < 1.0, "{events:?}");
        assert!(
            events[0]["samples_per_pixel"].as_f64() <= events[1]["samples_per_pixel"].as_f64(),
            "{events:?}"
        );
    }
}

/// Checks that a name without a placeholder for the number names a single frame.
#[test]
fn single_frame_has_the_given_name() {
    let folder = tempfile::tempdir().unwrap();
    let folder = folder.path();
    write_film(folder, 1.0, |film| film);
    let render = |more: &[&str]| {
        rayreel(folder, ["render", "film.ron", "--out=out", "--name=hero"].iter().chain(more))
    };
    for (more, name) in [(&["--frames=2"][..], "hero.png"), (&["--frames=2", "--format=ppm"], "hero.ppm")] {
        let output = render(more);
        assert!(output.status.success(), "{}", text(&output.stderr));
        assert!(crate::files(&folder.join("out")).contains(&name.to_owned()));
        let verified = rayreel(folder, ["verify", "out"]);
        assert!(verified.status.success(), "{}{}", text(&verified.stdout), text(&verified.stderr));
        assert!(text(&verified.stdout).contains("1 of 1 frames"), "{}", text(&verified.stdout));
    }
    assert!(text(&render(&["--frames=2"]).stderr).contains("1 frame was there already"));
    let kept = fs::read(folder.join("out/hero.png")).unwrap();
    for more in [&[][..], &["--frames=0-1"], &["--frames=0-1", "--shard=0/2"]] {
        let output = render(more);
        assert_eq!(output.status.code(), Some(1), "{more:?}");
        let stderr = text(&output.stderr);
        assert!(stderr.contains("--name=hero####"), "{more:?}: {stderr}");
    }
    assert_eq!(fs::read(folder.join("out/hero.png")).unwrap(), kept);
}

/// Checks that arguments that are not UTF-8 are refused wherever text is required, instead of being converted.
#[cfg(unix)]
#[test]
fn non_utf8_arguments_are_errors() {
    use std::ffi::OsStr;
    use std::os::unix::ffi::OsStrExt;

    let folder = tempfile::tempdir().unwrap();
    let folder = folder.path();
    write_film(folder, 1.0, |film| film);
    for option in [&b"--name=\xff####"[..], b"--set=camera.fov=/*\xff*/ 50", b"--movie=\xff.gif"] {
        let words = ["render", "film.ron"].map(OsStr::new).into_iter().chain([OsStr::from_bytes(option)]);
        let output = rayreel(folder, words);
        assert_eq!(output.status.code(), Some(2), "{option:?}: {}", text(&output.stderr));
        assert!(text(&output.stderr).contains("not UTF-8"), "{option:?}: {}", text(&output.stderr));
        assert_eq!(crate::files(folder), ["film.ron"], "{option:?}");
    }
}

#[cfg(unix)]
#[test]
fn frames_from_standard_input_cannot_be_verified() {
    let folder = tempfile::tempdir().unwrap();
    let folder = folder.path();
    write_film(folder, 1.0, |film| film);
    let scene = fs::File::open(folder.join("film.ron")).unwrap();
    let mut render = command(RAYREEL, folder);
    let rendered = output_of(render.args(["render", "-", "--frames=0"]).stdin(scene).spawn().unwrap());
    assert!(rendered.status.success(), "{}", text(&rendered.stderr));
    let stderr = text(&rayreel(folder, ["verify", "out/stdin"]).stderr);
    assert!(stderr.contains("from standard input") && stderr.contains("render a scene file"), "{stderr}");
}
