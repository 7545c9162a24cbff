//! Tests of warnings about what is surely not meant: each with scenes that raise it, and with scenes that nearly do.

use std::fs;
use std::path::Path;

use serde_json::Value;

use crate::{rayreel, stdout_of, text};

/// Returns the names of the warnings about a scene.
fn warned_of(folder: &Path, scene: &str, more: &[&str]) -> Vec<String> {
    fs::write(folder.join("a.ron"), scene).unwrap();
    let checked = stdout_of(folder, ["check", "--json", "a.ron"].iter().chain(more));
    let checked: Value = serde_json::from_str(&checked).unwrap();
    let warnings = checked[0]["warnings"].as_array().unwrap();
    for warning in warnings {
        assert!(
            warning["line"].is_u64() && warning["help"].as_str().is_some_and(|help| !help.is_empty()),
            "{warning}"
        );
    }
    warnings.iter().map(|warning| warning["name"].as_str().unwrap().to_owned()).collect()
}

/// Returns a scene of a ball on a floor, seen from the front and above, with other content.
fn ball(material: &str, more: &str, settings: &str) -> String {
    format!(
        r#"(film: (width: 32, height: 18), camera: (position: (0, 1, -5), target: (0, 0, 0)), {settings}
        materials: {{ "clay": {material} }}, entities: [
            (name: "ball", shape: Sphere(radius: 1), material: "clay"),
            (name: "floor", shape: Plane(normal: (0, 1, 0)), material: "clay", transform: (translation: (0, -1, 0))),
            {more}
        ])"#
    )
}

const LAMP: &str = "(light: Point(intensity: (1, 1, 1)), transform: (translation: (3, 5, -5))),";
const MATTE: &str = "(k_d: 0.7, color: (230, 90, 40))";

fn with_light(light: &str, place: &str) -> String {
    ball(MATTE, &format!("{LAMP} (light: {light}, transform: ({place}))"), "")
}

/// Checks that each of these scenes raises one warning, of this name, and none if it is allowed; and that the others raise none.
fn check(name: &str, raising: &[String], others: &[String]) {
    let folder = tempfile::tempdir().unwrap();
    for scene in raising {
        assert_eq!(warned_of(folder.path(), scene, &[]), [name], "{scene}");
        assert!(warned_of(folder.path(), scene, &["--allow", &format!("short-turn,{name}")]).is_empty());
    }
    for scene in others {
        assert_eq!(warned_of(folder.path(), scene, &[]), [""; 0], "{scene}");
    }
}

#[test]
fn colors_from_0_to_1() {
    let lit = |color: &str, settings: &str| ball(&format!("(k_d: 0.7, color: {color})"), LAMP, settings);
    check(
        "dark-color",
        &[
            lit("(1, 0, 0)", ""),
            lit("(0.9, 0.35, 0.15)", ""),
            lit("\"#e65a28\"", "background: (0.5, 0.7, 1),"),
            lit("\"#e65a28\"", "fog: (color: (1, 1, 1), density: 0.01),"),
        ],
        &[
            lit("(2, 0, 0)", ""),
            lit("(0.9, 35, 15)", ""),
            lit("\"#010101\"", "background: (0, 0, 0), ambient: (0.1, 0.1, 0.1),"),
        ],
    );
    // Equal warnings are grouped.
    let keys: Vec<String> = (0..40).map(|time| format!("({time}, (1, 0.5, 0))")).collect();
    let animated = format!(
        "animate: [(material: \"clay\", channel: Color, track: Keys([{}]))], timeline: (duration: 1),",
        keys.join(", ")
    );
    let folder = tempfile::tempdir().unwrap();
    let scene = lit("(200, 0, 0)", &animated);
    assert_eq!(warned_of(folder.path(), &scene, &[]), ["dark-color"; 3]);
    let printed = rayreel(folder.path(), ["check", "a.ron"]);
    let printed = text(&printed.stderr);
    assert!(printed.contains("no channel is above 1 (and 37 more like this)"), "{printed}");
}

#[test]
fn backgrounds_hidden_by_fog() {
    const SKY: &str = "(bottom: (200, 200, 200), top: (90, 90, 200))";
    const CLEARS_UP: &str = "(target: \"scene\", channel: FogDensity, track: Keys([(0, 0.1), (1, 0)]))";
    let foggy = |background: &str, fog: &str| {
        let settings = format!("background: {background}, fog: (color: (90, 90, 90), density: {fog}),");
        ball(MATTE, LAMP, &settings)
    };
    check(
        "hidden-background",
        &[
            foggy(SKY, "0.1"),
            foggy("(90, 90, 200)", "0.1"),
            foggy("(stops: [(0, (9, 9, 9)), (1, (90, 90, 90))])", "0.1"),
            foggy("(90, 90, 90), stars: ()", "0.1"),
        ],
        &[
            foggy(SKY, "0"),
            foggy(SKY, "0.1, height: 2"),
            foggy(SKY, "0.1, hides_background: true"),
            foggy(SKY, "0.1, hides_background: false"),
            foggy("(90, 90, 90)", "0.1"),
            foggy("(0, 0, 0)", "0.1"),
            foggy(SKY, "0.1")
                .replace("entities:", &format!("animate: [{CLEARS_UP}], timeline: (duration: 1), entities:")),
        ],
    );
}

#[test]
fn pictures_of_one_color() {
    let ambient = "ambient: (1, 1, 1),";
    let away = r#"(film: (width: 32, height: 18), camera: (position: (0, 0, -5), view: (0, 0, -1)), ambient: (1, 1, 1),
        materials: { "clay": (k_a: 1) }, entities: [(shape: Sphere(radius: 1), material: "clay")])"#;
    // A ball as large as a hundredth of a pixel, at the centre of a pixel or between the centres of four.
    let tiny = |width: u32, samples: u32| {
        format!(
            r#"(film: (width: {width}, height: {width}), sampling: (samples: {samples}),
            camera: (position: (0, 0, -10), view: (0, 0, 1)), ambient: (1, 1, 1), materials: {{ "clay": (k_a: 1) }},
            entities: [(shape: Sphere(radius: {radius:?}), material: "clay")])"#,
            radius = 0.4 / f64::from(width),
        )
    };
    check(
        "one-color",
        &[
            ball("(k_d: 1)", "", ""),
            ball("(k_d: 1)", "(light: Point(intensity: (0, 0, 0)))", ""),
            ball("(k_d: 1)", "", ambient),
            ball("(reflective: (k_r: 0.9))", LAMP, ""),
            ball(MATTE, LAMP, "fog: (color: (200, 200, 200), density: 1e3),"),
            away.to_owned(),
            away.replace("k_a: 1", "k_a: 0").replace("view: (0, 0, -1)", "target: (0, 0, 0)"),
            tiny(304, 1),
            "(camera: (position: (0, 0, 0), view: (0, 0, 1)), film: (width: 8, height: 8))".to_owned(),
        ],
        &[
            ball("(k_d: 1)", LAMP, ""),
            ball("(k_a: 1)", "", ambient),
            ball("(reflective: (k_r: 0.9))", LAMP, "background: (9, 9, 9),"),
            ball(MATTE, LAMP, "fog: (color: (200, 200, 200), density: 0.1),"),
            away.replace("view: (0, 0, -1)", "target: (0, 1, 0)"),
            // The draft of 75 x 75 pixels has the ball, or the picture in full has it.
            tiny(300, 1),
            tiny(8, 1024),
            "(camera: (position: (0, 0, 0), view: (0, 0, 1)), film: (width: 1, height: 1))".to_owned(),
        ],
    );
}

#[test]
fn films_may_start_black() {
    let fade = ball(
        "(k_a: 1)",
        "",
        r#"timeline: (fps: 4, duration: 1),
        animate: [(target: "scene", channel: Ambient, track: Keys([(0, (0, 0, 0)), (1, (1, 1, 1))]))],"#,
    );
    let folder = tempfile::tempdir().unwrap();
    assert_eq!(warned_of(folder.path(), &fade, &[]), [""; 0]);
    let render = |frames: &str| {
        let output =
            rayreel(folder.path(), ["render", "a.ron", "--out", frames, "--frames", frames, "--quiet"]);
        text(&output.stderr)
    };
    assert_eq!(render("0-3"), "");
    let black = render("0");
    assert!(
        black.starts_with("warning: the camera sees only black: there is no ambient light, and "),
        "{black}"
    );
    // Effects that are disabled by request are meant to be missing.
    let arguments =
        ["render", "a.ron", "--out", "o", "--frames", "3", "--quiet", "--without", "ambient-light"];
    assert_eq!(text(&rayreel(folder.path(), arguments).stderr), "");
}

#[test]
fn lights_that_reach_nothing() {
    let point = "Point(intensity: (1, 1, 1))";
    let room = |place: &str| {
        let walls = "(shape: Box(size: (40, 40, 40)), material: \"clay\"),";
        ball(MATTE, &format!("{walls} {LAMP} (light: {point}, transform: (translation: {place}))"), "")
    };
    let spot = |angle: f64, turn: f64| {
        let light = format!("Spot(intensity: (1, 1, 1), angle: {angle:?})");
        with_light(&light, &format!("translation: (0, 4, 0), rotation: Euler({turn:?}, 0, 0)"))
    };
    check(
        "idle-light",
        &[
            with_light("Directional(intensity: (1, 1, 1), direction: (0, 1, 0))", ""),
            with_light("Directional(intensity: (1, 1, 1), direction: (1, 0.01, 0))", ""),
            with_light(point, "translation: (3, -1.001, 0)"),
            with_light(point, "translation: (0, 0.9, 0)"),
            with_light("Area(shape: Sphere(radius: 0.5), intensity: (1, 1, 1))", "translation: (0, -2, 0)"),
            spot(90.0, -90.0),
            spot(179.0, -90.0),
            room("(0, 0, -20.1)"),
            room("(0, 99, 0)"),
        ],
        &[
            with_light("Directional(intensity: (1, 1, 1), direction: (1, -0.01, 0))", ""),
            with_light("Directional(intensity: (1, 1, 1), direction: (0, 1, 0), casts_shadows: false)", ""),
            with_light(point, "translation: (3, -0.999, 0)"),
            with_light(point, "translation: (0, 1.001, 0)"),
            with_light("Area(shape: Sphere(radius: 0.5), intensity: (1, 1, 1))", "translation: (0, -1.4, 0)"),
            with_light("Area(shape: Rectangle(width: 3, height: 3), intensity: (1, 1, 1))", ""),
            with_light("Point(intensity: (0, 0, 0))", "translation: (3, -2, 0)"),
            spot(90.0, 90.0),
            spot(180.0, -91.0),
            room("(0, 0, -19.9)"),
            // A lamp shines out of its own shape, and through glass.
            ball(
                MATTE,
                &format!(
                    "(name: \"bulb\", shape: Sphere(radius: 0.1), material: \"clay\", light: {point}, transform: (translation: (0, 3, 0)))"
                ),
                "",
            ),
            ball("(k_d: 0.7, refractive: (k_t: 0.5, ior: 1.5))", &format!("(light: {point})"), ""),
        ],
    );
}

#[test]
fn rays_cut_at_the_maximum_depth() {
    let panes = |count: usize, depth: u32, k_t: f64| {
        let pane = |index| {
            format!(
                "(shape: Box(size: (99, 99, 0.1)), material: \"glass\", transform: (translation: (0, 0, {index}))),"
            )
        };
        let panes: String = (0..count).map(pane).collect();
        format!(
            r#"(film: (width: 32, height: 18), camera: (position: (0, 0, -5), view: (0, 0, 1)), background: (bottom: (90, 120, 200), top: (0, 0, 0)),
            ambient: (1, 1, 1), quality: (depth: {depth}), materials: {{ "glass": (refractive: (k_t: {k_t:?}, ior: 1.5)), "clay": (k_a: 1) }},
            entities: [{panes} (shape: Sphere(radius: 1), material: "clay", transform: (translation: (0, 0, 9)))])"#
        )
    };
    // Three panes have six faces, and the ray behind them is the seventh.
    check(
        "cut-off",
        &[panes(3, 5, 0.97), panes(3, 6, 0.97), panes(2, 3, 0.97)],
        &[panes(3, 7, 0.97), panes(2, 5, 0.97), panes(3, 5, 0.8)],
    );
}

#[test]
fn shipped_scenes_raise_none() {
    let scenes = Path::new(env!("CARGO_MANIFEST_DIR")).join("scenes");
    let files = fs::read_dir(&scenes).unwrap().map(|file| file.unwrap().file_name());
    let files: Vec<_> =
        files.filter(|name| Path::new(name).extension().is_some_and(|end| end == "ron")).collect();
    assert!(files.len() > 10);
    let checked = stdout_of(&scenes, ["check".into(), "--json".into()].into_iter().chain(files));
    let checked: Value = serde_json::from_str(&checked).unwrap();
    for scene in checked.as_array().unwrap() {
        assert_eq!(scene["warnings"], Value::Array(Vec::new()), "{}", scene["scene"]);
    }
}

#[test]
fn unknown_warnings_cannot_be_allowed() {
    let folder = tempfile::tempdir().unwrap();
    let output = rayreel(folder.path(), ["check", "a.ron", "--allow", "black"]);
    assert_eq!(output.status.code(), Some(2));
    let stderr = text(&output.stderr);
    assert!(stderr.contains("the warnings are dark-color, not-drawn"), "{stderr}");
    let help = stdout_of(folder.path(), ["check", "--help"]);
    let names = stderr.split("the warnings are ").nth(1).unwrap().lines().next().unwrap();
    let help = help.split_whitespace().collect::<Vec<_>>().join(" ");
    assert!(help.contains(names), "{help}");
}
