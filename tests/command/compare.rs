//! Tests of `rayreel compare`: differences between two pictures.

use std::fs;
use std::path::Path;

use serde_json::Value;

use crate::{FIRST_LIGHT, rayreel, text};

/// Writes a binary PPM file.
fn ppm(folder: &Path, name: &str, width: usize, pixels: &[[u8; 3]]) {
    let header = format!("P6 {width} {} 255\n", pixels.len() / width);
    fs::write(folder.join(name), [header.as_bytes(), pixels.as_flattened()].concat()).unwrap();
}

/// Writes a PFM file of a single row.
fn pfm(folder: &Path, name: &str, numbers: &[[f32; 3]]) {
    let header = format!("PF\n{} 1\n-1.0\n", numbers.len());
    let numbers: Vec<u8> = numbers.as_flattened().iter().flat_map(|number| number.to_le_bytes()).collect();
    fs::write(folder.join(name), [header.as_bytes(), &numbers].concat()).unwrap();
}

/// Compares two files, and returns the exit code and the JSON report.
fn compared(folder: &Path, files: [&str; 2], options: &[&str]) -> (i32, Value) {
    let output = rayreel(folder, [&["compare", files[0], files[1], "--json"], options].concat());
    let report = serde_json::from_slice(&output.stdout);
    (output.status.code().unwrap(), report.unwrap_or_else(|_| panic!("{}", text(&output.stderr))))
}

fn gray(count: usize, value: u8) -> Vec<[u8; 3]> {
    vec![[value; 3]; count]
}

#[test]
fn a_constant_offset_has_exact_errors() {
    let folder = tempfile::tempdir().unwrap();
    let folder = folder.path();
    ppm(folder, "a.ppm", 5, &gray(20, 100));
    ppm(folder, "b.ppm", 5, &gray(20, 104));
    for files in [["a.ppm", "b.ppm"], ["b.ppm", "a.ppm"]] {
        let (code, report) = compared(folder, files, &[]);
        assert_eq!((code, &report["equal"]), (1, &false.into()));
        assert_eq!((&report["max"], &report["rms"]), (&4.0.into(), &4.0.into()));
        assert_eq!((&report["width"], &report["height"]), (&5.into(), &4.into()));
        let psnr = report["psnr"].as_f64().unwrap();
        assert!((psnr - 20.0 * f64::log10(255.0 / 4.0)).abs() < 1e-12, "{psnr}");
        assert_eq!((&report["share_off"], &report["pixel"]), (&1.0.into(), &serde_json::json!([0, 0])));
        assert_eq!((&report["relative_mse"], &report["max_alpha"]), (&Value::Null, &Value::Null));
    }
    for (tolerance, code) in [("3.99", 1), ("4", 0), ("255", 0)] {
        assert_eq!(compared(folder, ["a.ppm", "b.ppm"], &["--tolerance", tolerance]).0, code, "{tolerance}");
    }
}

#[test]
fn single_pixel_difference_is_found_in_both_directions() {
    let folder = tempfile::tempdir().unwrap();
    let folder = folder.path();
    let mut pixels = gray(600, 30);
    ppm(folder, "a.ppm", 30, &pixels);
    pixels[7 * 30 + 4] = [30, 90, 30];
    ppm(folder, "b.ppm", 30, &pixels);
    let (code, one) = compared(folder, ["a.ppm", "b.ppm"], &[]);
    assert_eq!((code, &one["pixel"], &one["max"]), (1, &serde_json::json!([4, 7]), &60.0.into()));
    let rms = one["rms"].as_f64().unwrap();
    assert!((rms - 60.0 / f64::sqrt(1800.0)).abs() < 1e-12, "{rms}");
    let (_, other) = compared(folder, ["b.ppm", "a.ppm"], &[]);
    for key in ["max", "rms", "psnr", "ssim", "flip", "pixel", "share_off"] {
        assert_eq!(one[key], other[key], "{key}");
    }
}

#[test]
fn equal_pictures_in_any_format_exit_with_0() {
    let folder = tempfile::tempdir().unwrap();
    let folder = folder.path();
    for (format, options) in [
        ("png", &[][..]),
        ("png16", &["--alpha"]),
        ("ppm", &[]),
        ("pfm", &[]),
        ("exr", &["--passes", "depth"]),
        ("hdr", &[]),
    ] {
        let arguments =
            ["render", FIRST_LIGHT, "--frames", "9", "--size", "32x18", "--format", format, "--out", format];
        assert!(rayreel(folder, [&arguments[..], options].concat()).status.success());
    }
    let file = |format: &str, ending: &str| format!("{format}/first_light.0009.{ending}");
    let files = [
        file("png", "png"),
        file("png16", "png"),
        file("ppm", "ppm"),
        file("pfm", "pfm"),
        file("exr", "exr"),
    ];
    for one in &files {
        let (code, report) = compared(folder, [one, one], &[]);
        assert_eq!(
            (code, &report["equal"], &report["max"], &report["rms"]),
            (0, &true.into(), &0.0.into(), &0.0.into())
        );
        assert_eq!(
            (&report["ssim"], &report["flip"], &report["psnr"]),
            (&1.0.into(), &0.0.into(), &Value::Null)
        );
        assert_eq!(report["relative_mse"].is_null(), !one.ends_with("pfm") && !one.ends_with("exr"));
        let output = rayreel(folder, ["compare", one, one]);
        assert!(text(&output.stdout).contains("32x18: equal\n"), "{}", text(&output.stdout));
    }
    // The scene's transfer rounds to the nearest of 255 steps.
    for one in &files {
        for other in &files {
            let is_over_nothing = one.contains("png16") != other.contains("png16");
            let (code, report) = compared(folder, [one, other], &["--tolerance", "0.500001"]);
            assert_eq!(code, i32::from(is_over_nothing), "{one} {other}: {report}");
        }
    }
    assert_eq!(compared(folder, [&files[0], &files[2]], &[]).0, 0);
    assert_eq!(compared(folder, [&files[3], &files[4]], &[]).0, 0);
    let hdr = file("hdr", "hdr");
    assert_eq!(compared(folder, [&hdr, &hdr], &[]).0, 0);
}

#[test]
fn radiance_hdr_rounds_to_a_part_of_the_largest_channel() {
    let folder = tempfile::tempdir().unwrap();
    let folder = folder.path();
    let render = |scene: &str, format: &str| {
        let arguments =
            ["render", scene, "--frames", "9", "--size", "32x18", "--format", format, "--out", "."];
        assert!(rayreel(folder, arguments).status.success());
    };
    ["hdr", "pfm"].into_iter().for_each(|format| render(FIRST_LIGHT, format));
    let (_, report) = compared(folder, ["first_light.0009.hdr", "first_light.0009.pfm"], &[]);
    assert!(report["relative_mse"].as_f64().unwrap() < 1e-5, "{report}");
    let rounded = image::open(folder.join("first_light.0009.hdr")).unwrap().into_rgb32f();
    let file = std::fs::read(folder.join("first_light.0009.pfm")).unwrap();
    let numbers = file[b"PF\n32 18\n-1.0\n".len()..].chunks_exact(4).take(32 * 18 * 3);
    let exact: Vec<f32> = numbers.map(|bytes| f32::from_le_bytes(bytes.try_into().unwrap())).collect();
    // Bytes are rounded, and the largest of three is at least 128. Rows of PFM files are from the bottom to the top.
    let exact = exact.chunks_exact(32 * 3).rev().flat_map(|row| row.chunks_exact(3));
    for (exact, rounded) in exact.zip(rounded.pixels()) {
        let largest = exact.iter().copied().fold(0.0, f32::max);
        for (exact, rounded) in exact.iter().zip(rounded.0) {
            assert!((exact - rounded).abs() < largest / 256.0, "{exact} {rounded} {largest}");
        }
    }

    // Colours with channels of similar size lose less than a level.
    let scene = concat!(env!("CARGO_MANIFEST_DIR"), "/scenes/clay_balls.ron");
    ["hdr", "exr"].into_iter().for_each(|format| render(scene, format));
    let files = ["clay_balls.0009.hdr", "clay_balls.0009.exr"];
    let (code, report) = compared(folder, files, &["--tolerance", "1"]);
    assert!(code == 0 && report["relative_mse"].as_f64().unwrap() < 1e-5, "{report}");
}

#[test]
fn light_above_1_counts_only_without_tolerance() {
    let folder = tempfile::tempdir().unwrap();
    let folder = folder.path();
    pfm(folder, "a.pfm", &[[2.0, 0.5, 0.5], [0.5; 3]]);
    pfm(folder, "b.pfm", &[[4.0, 0.5, 0.5], [0.5; 3]]);
    let (code, report) = compared(folder, ["a.pfm", "b.pfm"], &[]);
    assert_eq!((code, &report["max"]), (1, &0.0.into()));
    let relative = report["relative_mse"].as_f64().unwrap();
    assert!((relative - 4.0 / 16.01 / 6.0).abs() < 1e-12, "{relative}");
    assert_eq!(compared(folder, ["a.pfm", "b.pfm"], &["--tolerance", "0.001"]).0, 0);
    // An intensity of 0.5 has the output value 127.5 with `classic`, and 187.516 with `srgb`.
    pfm(folder, "c.pfm", &[[1.0, 0.5, 0.5], [0.0; 3]]);
    for (transfer, expected) in [("classic", 127.5), ("srgb", 187.516)] {
        let (_, report) = compared(folder, ["a.pfm", "c.pfm"], &["--transfer", transfer]);
        assert!((report["max"].as_f64().unwrap() - expected).abs() < 1e-3, "{report}");
    }
}

#[test]
fn alpha_is_compared() {
    let folder = tempfile::tempdir().unwrap();
    let folder = folder.path();
    let save = |name: &str, pixel: [u8; 4]| {
        image::RgbaImage::from_pixel(2, 2, image::Rgba(pixel)).save(folder.join(name)).unwrap();
    };
    save("open.png", [200, 10, 10, 0]);
    save("also_open.png", [3, 4, 5, 0]);
    save("closed.png", [0, 0, 0, 255]);
    ppm(folder, "black.ppm", 2, &gray(4, 0));
    // Colours of fully transparent pixels are ignored, and an opaque alpha channel is equal to no alpha channel.
    assert_eq!(compared(folder, ["open.png", "also_open.png"], &[]).0, 0);
    assert_eq!(compared(folder, ["closed.png", "black.ppm"], &[]).0, 0);
    let (code, report) = compared(folder, ["open.png", "black.ppm"], &[]);
    assert_eq!((code, &report["max"], &report["max_alpha"]), (1, &0.0.into(), &255.0.into()));
    let output = rayreel(folder, ["compare", "open.png", "black.ppm"]);
    assert!(text(&output.stdout).contains("max, alpha    255.00 at pixel 0,0\n"), "{}", text(&output.stdout));
}

#[test]
fn difference_picture_marks_different_pixels() {
    let folder = tempfile::tempdir().unwrap();
    let folder = folder.path();
    ppm(folder, "a.ppm", 3, &[[10, 10, 10], [10, 10, 10], [10, 10, 10]]);
    ppm(folder, "b.ppm", 3, &[[10, 10, 10], [10, 11, 10], [110, 10, 10]]);
    assert_eq!(compared(folder, ["a.ppm", "b.ppm"], &["--out", "d.png"]).0, 1);
    let picture = image::open(folder.join("d.png")).unwrap().to_rgb8();
    let [equal, faint, most] = [0, 1, 2].map(|column| picture.get_pixel(column, 0).0);
    assert_eq!((equal, most), ([0; 3], [255; 3]));
    assert!(faint[0] > 50 && faint[1] == 0, "{faint:?}");
    let output = rayreel(folder, ["compare", "a.ppm", "b.ppm", "--out", "./b.ppm"]);
    assert_eq!(output.status.code(), Some(2));
    assert!(text(&output.stderr).contains("is a picture that is compared itself: name another file"));
}

#[test]
fn incomparable_pictures_exit_with_2() {
    let folder = tempfile::tempdir().unwrap();
    let folder = folder.path();
    ppm(folder, "a.ppm", 2, &gray(4, 0));
    ppm(folder, "wide.ppm", 4, &gray(4, 0));
    pfm(folder, "nan.pfm", &[[0.0; 3], [0.0, f32::NAN, 0.0]]);
    fs::write(folder.join("text.png"), "not a picture").unwrap();
    fs::write(folder.join("large.ppm"), "P6 4000000000 4000000000 255\n").unwrap();
    fs::write(folder.join("short.ppm"), "P6 2 2 255\n123").unwrap();
    fs::create_dir(folder.join("folder.png")).unwrap();
    for (file, message) in [
        ("wide.ppm", "pictures of different sizes cannot be compared: 2x2 and 4x1 pixels"),
        ("nan.pfm", "cannot read `nan.pfm`: its pixel 1,0 has a number that is not finite"),
        (
            "text.png",
            "cannot read `text.png`: it is no PNG, binary PPM (P6), PFM (PF), Radiance HDR (#?RADIANCE) or OpenEXR file",
        ),
        ("large.ppm", "it has 4000000000x4000000000 pixels, and pictures have from 1 to 67108864 pixels"),
        ("short.ppm", "it has 3 bytes of pixels instead of 12"),
        ("folder.png", "cannot read `folder.png`: it is not a regular file"),
        ("none.png", "cannot read `none.png`: No such file"),
    ] {
        let output = rayreel(folder, ["compare", "a.ppm", file]);
        assert_eq!(output.status.code(), Some(2), "{file}");
        assert!(
            text(&output.stderr).contains(message) && output.stdout.is_empty(),
            "{}",
            text(&output.stderr)
        );
    }
    for value in ["-1", "many", "256", "nan"] {
        let output = rayreel(folder, ["compare", "a.ppm", "a.ppm", "--tolerance", value]);
        assert_eq!(output.status.code(), Some(2));
        assert!(text(&output.stderr).contains("write a number of steps from 0 to 255, as 0.5"));
    }
}
