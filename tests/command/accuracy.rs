//! Tests of `rayreel accuracy`: errors and costs of every setting.

use std::fs;
use std::path::Path;

use serde_json::Value;

use crate::{rayreel, stdout_of, text};

const SCENE: &str = "Scene(
    timeline: (fps: 4, duration: 1), film: (width: 48, height: 27), sampling: (samples: 4),
    camera: (position: (0, 1.5, -6), target: (0, 0.8, 0), fov: 40), ambient: (0.3, 0.3, 0.3),
    materials: {
        \"floor\": (k_a: 0.4, k_d: 0.8, color: (200, 190, 170)),
        \"red\": (k_a: 0.4, k_d: 0.8, color: (220, 60, 40), reflective: (k_r: 0.5)),
    },
    entities: [
        (shape: Plane(normal: (0, 1, 0)), material: \"floor\"),
        (shape: Sphere(radius: 1), transform: (translation: (0, 1, 0)),
         material: \"red\"),
        (light: Area(shape: Sphere(radius: 0.5), intensity: (0.8, 0.8, 0.8), samples: 2), transform: (translation: (-3, 5, -4))),
    ],
)
";

fn measured(folder: &Path, arguments: &[&str]) -> Value {
    fs::write(folder.join("a.ron"), SCENE).unwrap();
    let output = stdout_of(folder, [&["accuracy", "a.ron", "--quick", "--json"], arguments].concat());
    serde_json::from_str(&output).unwrap()
}

fn of_parameter<'a>(report: &'a Value, knob: &str) -> Vec<&'a Value> {
    report["rows"].as_array().unwrap().iter().filter(|row| row["knob"] == knob).collect()
}

fn rms(row: &Value) -> f64 {
    row["error"]["rms"].as_f64().unwrap()
}

#[test]
fn every_relevant_parameter_is_swept() {
    let folder = tempfile::tempdir().unwrap();
    let report = measured(folder.path(), &[]);
    assert_eq!((&report["frames"][0], &report["width"]), (&2.into(), &48.into()));
    assert_eq!(report["rows"][0]["setting"], "the scene's own");
    for (knob, count) in
        [("samples", 3), ("max error", 5), ("light samples", 4), ("cutoff", 4), ("precision", 2)]
    {
        assert_eq!(of_parameter(&report, knob).len(), count, "{knob}");
    }
    assert!(of_parameter(&report, "instants").is_empty(), "nothing moves");
    let samples = of_parameter(&report, "samples");
    assert!(rms(samples[0]) > rms(samples[2]));
    let uncertainty = report["reference"]["rms_uncertainty"].as_f64().unwrap();
    assert!(uncertainty > 0.0 && uncertainty < rms(samples[0]));
    // The error decreases with the depth, as more reflections are traced.
    let depths = of_parameter(&report, "depth");
    assert!(depths[0]["alone"]["rms"].as_f64() > depths[2]["alone"]["rms"].as_f64());
    let without: Vec<_> =
        report["rows"].as_array().unwrap().iter().filter_map(|row| row["without"].as_str()).collect();
    for effect in ["diffuse light", "shadows", "area lights", "reflection", "antialiasing"] {
        assert!(without.contains(&effect), "{effect}: {without:?}");
    }
    for row in report["rows"].as_array().unwrap() {
        let [low, median, high] = ["low", "median", "high"].map(|key| row["relative"][key].as_f64().unwrap());
        assert!(0.0 < low && low <= median && median <= high, "{row}");
        let rays = &row["rays"];
        assert!(rays["camera"].as_u64().unwrap() >= 48 * 27, "{row}");
    }
    assert!(report["rows"].as_array().unwrap().iter().any(|row| row["pareto"] == true));
}

#[test]
fn overrides_and_disabled_effects_apply_to_all_rows() {
    let folder = tempfile::tempdir().unwrap();
    let report = measured(
        folder.path(),
        &[
            &["--without", "shadows", "--samples", "2", "--frames", "0,3", "--size", "16x9"][..],
            &["--vary", "Depth,effects", "--sizes", "8x5"],
        ]
        .concat(),
    );
    assert_eq!(report["frames"], serde_json::json!([0, 3]));
    assert_eq!(report["without"], serde_json::json!(["shadows"]));
    assert_eq!(report["rows"][0]["rays"]["camera"], 16 * 9 * 2);
    assert_eq!(report["rows"][0]["rays"]["shadow"], 0);
    let varied: Vec<_> = report["rows"].as_array().unwrap().iter().skip(1).collect();
    let of = |what: &str| varied.iter().filter(|row| !row[what].is_null()).count();
    let (depths, effects) = (of_parameter(&report, "depth").len(), of("without"));
    assert!(depths > 1 && effects > 3, "{depths} depths, {effects} effects");
    assert_eq!(varied.len(), depths + effects + of("size"));
}

#[test]
fn parameters_without_influence_are_not_varied() {
    let folder = tempfile::tempdir().unwrap();
    fs::write(folder.path().join("a.ron"), SCENE).unwrap();
    for (name, answer) in [
        ("instants", "error: --vary instants: it affects none of the measured frames; leave it out\n"),
        ("max_eror", "did you mean `max-error`?"),
        ("size", "the parameters are samples, max-error, light-samples, "),
    ] {
        let output = rayreel(folder.path(), ["accuracy", "a.ron", "--vary", name]);
        assert!(text(&output.stderr).contains(answer), "{}", text(&output.stderr));
    }
}

#[test]
fn a_page_and_a_table_are_written() {
    let folder = tempfile::tempdir().unwrap();
    let folder = folder.path();
    fs::write(folder.join("a.ron"), SCENE.replace("samples: 4", "samples: 2")).unwrap();
    let table = stdout_of(
        folder,
        [
            &["accuracy", "a.ron", "--quick", "--size", "16x9", "--sizes", "8x5,32x18"][..],
            &["--html", "r.html", "--csv", "r.csv"],
        ]
        .concat(),
    );
    assert!(table.contains("size 8x5 ") && table.contains("size 32x18 "), "{table}");
    assert!(table.contains("the scene's own") && table.contains("max error 0.5"), "{table}");
    assert!(table.lines().any(|line| line.starts_with('*')), "{table}");
    let page = fs::read_to_string(folder.join("r.html")).unwrap();
    assert!(page.starts_with("<!DOCTYPE html>") && page.ends_with("</html>\n"));
    // The page loads nothing from other sites.
    assert!(!page.contains("http://") && !page.contains("https://") && !page.contains("<script"));
    for part in
        ["Error against time", "Effects", "Parameters", "How it was measured", "data:image/png;base64,"]
    {
        assert!(page.contains(part), "{part}");
    }
    let csv = fs::read_to_string(folder.join("r.csv")).unwrap();
    assert!(csv.starts_with("scene,version,width,height,rounds,"));
    assert!(csv.lines().count() > 20 && csv.lines().all(|line| line.split(',').count() == 40), "{csv}");
    assert!(csv.lines().skip(1).all(|line| line.starts_with("a.ron,0.1.0,16,9,4,")), "{csv}");
    // The table, the chart and the CSV file have the same stars and the same settings.
    let in_table = |mark: char| table.lines().skip(5).filter(|line| line.starts_with(mark)).count() - 1;
    let in_csv = |column: &str, value: fn(&str) -> bool| {
        let place = csv.lines().next().unwrap().split(',').position(|name| name == column).unwrap();
        csv.lines().skip(1).filter(|line| value(line.split(',').nth(place).unwrap())).count()
    };
    let overview = &page[page.find("Error against time</h2>").unwrap()..page.find("<h2>Settings").unwrap()];
    let stars = overview.matches("class=\"star\"").count();
    assert!(stars > 0);
    assert_eq!((stars, stars), (in_table('*'), in_csv("pareto", |value| value == "true")));
    assert_eq!(in_table('='), in_csv("same_as", |value| !value.is_empty()));
    for column in csv.lines().next().unwrap().split(',') {
        // Counted only on request, and reached only by some scenes.
        let may_be_empty = ["instructions", "capped", "alone_psnr"].contains(&column);
        assert!(may_be_empty || in_csv(column, |value| !value.is_empty()) > 0, "{column}");
    }
    let settings = in_csv("share", str::is_empty) - in_table('=');
    assert_eq!(overview.matches("<title>").count() - 1, settings, "one is that of the grey area");
    // Every effect has two bars.
    assert_eq!(page.matches("class=\"bar s").count(), 2 * in_csv("share", |value| !value.is_empty()));
}

#[test]
fn capped_targets_are_marked_and_not_on_the_front() {
    let folder = tempfile::tempdir().unwrap();
    let report = measured(folder.path(), &["--error-map", "e.png", "--sample-map", "s.png"]);
    let errors = of_parameter(&report, "max error");
    let (capped, reached): (Vec<&Value>, Vec<&Value>) =
        errors.into_iter().partition(|row| row["capped"] == 16);
    assert!(!capped.is_empty() && !reached.is_empty(), "{capped:?} {reached:?}");
    for row in capped {
        assert_eq!(row["pareto"], false);
        assert!(row["estimated"]["value"].as_f64() > row["value"].as_f64(), "{row}");
    }
    for row in reached {
        assert_eq!(row["capped"], Value::Null);
        assert!(row["estimated"]["value"].as_f64() <= row["value"].as_f64(), "{row}");
    }
    for row in report["rows"].as_array().unwrap() {
        let [low, rms, high] = ["rms_low", "rms", "rms_high"].map(|key| row["error"][key].as_f64().unwrap());
        assert!(low <= rms && rms < high, "{row}");
        assert!(row["same_as"].is_null() || row["pareto"] == false, "{row}");
    }
    for map in ["e.png", "s.png"] {
        assert_eq!(image::open(folder.path().join(map)).unwrap().to_rgb8().dimensions(), (48, 27));
    }
}

#[test]
fn the_scene_is_not_written_over() {
    let folder = tempfile::tempdir().unwrap();
    fs::write(folder.path().join("a.ron"), SCENE).unwrap();
    for option in ["--html", "--csv", "--error-map", "--sample-map"] {
        let output = rayreel(folder.path(), ["accuracy", "a.ron", option, "./a.ron"]);
        assert_eq!(output.status.code(), Some(1));
        assert!(text(&output.stderr).contains("is the scene itself: name another file"));
    }
    let output = rayreel(folder.path(), ["accuracy", "a.ron", "--frames", "9"]);
    assert!(text(&output.stderr).contains("there is no frame 9"));
}
