//! Tests of scenes that extend others: their contents and order, and the places that are reported. Random scenes are tested against changes
//! made by hand in `tests/engine/extends.rs`.

use std::fs;
use std::path::Path;

use assert_cmd::Command;
use serde_json::{Value, json};

use rayreel::components::{Background, Camera, FilmSettings, Fog, Light, LightKind, Name, Shape, View};
use rayreel::scene::Override;
use rayreel::{Engine, EngineError, Scene, Time};

use crate::includes::{described, folder, load, messages, names, refused};

const BASE: &str = r#"Scene(
    timeline: (fps: 8, duration: 2),
    film: (width: 64, height: 36, transfer: Classic),
    camera: (position: (0, 1, -6), target: (0, 0, 0), fov: 40),
    fog: (color: (10, 20, 30), density: 0.5),
    materials: {
        "clay": (k_a: 0.5, k_d: 0.25, specular: (k_s: 0.5, shininess: 9)),
        "tin": (k_a: 0.1),
    },
    entities: [
        (name: "floor", shape: Plane(normal: (0, 1, 0)), material: "tin"),
        (name: "ball", shape: Sphere(radius: 1), material: "clay", transform: (translation: (1, 2, 3), scale: 2)),
        (name: "lamp", light: Point(intensity: (1, 1, 1), falloff: (1, 0, 1))),
    ],
    animate: [
        (target: "ball", channel: Radius, track: Keys([(0, 1), (1, 2)])),
        (target: "lamp", channel: Intensity, track: Keys([(0, (1, 1, 1))])),
    ],
)"#;

/// Returns the scene that extends [`BASE`] with these fields.
fn extended(fields: &str) -> Scene {
    load(&folder(&[("base.ron", BASE), ("scene.ron", &format!("(extends: \"base.ron\", {fields})"))]))
}

/// Returns [`BASE`] with replaced parts.
fn by_hand(replaced: &[(&str, &str)]) -> Scene {
    let mut text = BASE.to_owned();
    for (part, with) in replaced {
        assert_eq!(text.matches(part).count(), 1, "{part}");
        text = text.replace(part, with);
    }
    Scene::from_text("by_hand.ron", text).unwrap_or_else(|error| panic!("{error}"))
}

fn only<T: hecs::Component + Clone>(scene: &Scene) -> Option<T> {
    let mut query = scene.world.query::<&T>();
    let mut found = query.iter().cloned();
    found.next().filter(|_| found.next().is_none())
}

fn of<T: hecs::Component + Clone>(scene: &Scene, name: &str) -> T {
    let mut query = scene.world.query::<(&Name, &T)>();
    query.iter().find(|(known, _)| known.0 == name).unwrap_or_else(|| panic!("{name}")).1.clone()
}

#[test]
fn written_fields_replace_and_others_stay() {
    let plain = extended("");
    assert_eq!(described(&plain.world), described(&by_hand(&[]).world));
    let film = |scene: &Scene| only::<FilmSettings>(scene).unwrap();
    let wide = extended("film: (width: 1280)");
    assert_eq!(film(&wide), FilmSettings { width: 1280, ..film(&plain) });
    assert_eq!(extended("timeline: (duration: 1)").timeline.frame_count(), 8);
    assert_eq!(only::<Fog>(&extended("fog: (density: 0.25)")).unwrap().density, 0.25);
    assert_eq!(
        only::<Fog>(&extended("fog: (density: 0.25)")).unwrap().color,
        only::<Fog>(&plain).unwrap().color
    );
    assert!(only::<Fog>(&plain).is_some() && only::<Fog>(&extended("fog: None")).is_none());

    for (fields, part, with) in [
        ("materials: { \"clay\": (k_d: 1) }", "k_d: 0.25", "k_d: 1"),
        ("materials: { \"clay\": (specular: (k_s: 1)) }", "k_s: 0.5", "k_s: 1"),
        ("materials: { \"clay\": (specular: None) }", ", specular: (k_s: 0.5, shininess: 9)", ""),
        ("materials: { \"gold\": (), \"tin\": (k_d: 1) }", "(k_a: 0.1)", "(k_a: 0.1, k_d: 1), \"gold\": ()"),
        ("entities: [(name: \"ball\", transform: (scale: 3))]", "scale: 2", "scale: 3"),
        ("entities: [(name: \"ball\", shape: (radius: 3))]", "radius: 1", "radius: 3"),
        ("entities: [(name: Some(\"ball\"), material: \"tin\")]", "material: \"clay\"", "material: \"tin\""),
        ("entities: [(name: \"lamp\", light: Point(falloff: (1, 1, 0)))]", "(1, 0, 1)", "(1, 1, 0)"),
        (
            "entities: [(name: \"lamp\", light: Directional(intensity: (2, 2, 2)))]",
            "Point(intensity: (1, 1, 1), falloff: (1, 0, 1))",
            "Directional(intensity: (2, 2, 2))",
        ),
        (
            "animate: [(target: \"ball\", channel: Radius, track: Keys([(0, 3)]), repeat: Loop)]",
            "Keys([(0, 1), (1, 2)])",
            "Keys([(0, 3)]), repeat: Loop",
        ),
        (
            "animate: [(target: \"lamp\", channel: Translation, track: Keys([(0, (0, 0, 0))]))]",
            "(1, 1, 1))])),\n",
            "(1, 1, 1))])), (target: \"lamp\", channel: Translation, track: Keys([(0, (0, 0, 0))])),\n",
        ),
    ] {
        let (found, expected) =
            (described(&extended(fields).world), described(&by_hand(&[(part, with)]).world));
        assert_eq!(found, expected, "{fields}");
        assert!(found != described(&plain.world) || fields.contains("gold"), "{fields}");
    }
}

#[test]
fn exclusive_fields_replace_each_other() {
    let view = |fields: &str| only::<Camera>(&extended(fields)).unwrap();
    let direction = glam::DVec3::new(0.0, 0.0, 1.0);
    assert_eq!(view("camera: (view: (0, 0, 1))").view, View::Direction(direction));
    assert_eq!(view("camera: (view: None)").view, view("").view);
    let screen = view("camera: (screen: (distance: 1, height: 2))");
    assert!(screen.projection != view("").projection && screen.view == view("").view);
    let [ends, stops] =
        ["bottom: (9, 9, 9), top: (0, 0, 0)", "stops: [(0, (9, 9, 9)), (0.5, (0, 0, 0)), (1, (9, 9, 9))]"];
    for (base, change) in [(ends, stops), (stops, ends)] {
        let base = BASE.replace("fog:", &format!("background: ({base}), fog:"));
        let change = format!("(extends: \"base.ron\", background: ({change}))");
        let scene = load(&folder(&[("base.ron", &base), ("scene.ron", &change)]));
        let has_stops = matches!(only::<Background>(&scene), Some(Background::Stops(_)));
        assert_eq!(has_stops, change.contains("stops"));
    }
    let error = refused(&folder(&[
        ("base.ron", BASE),
        ("scene.ron", "(\nextends: \"base.ron\",\ncamera: (target: (0, 0, 1),\nview: (0, 0, 1)))"),
    ]));
    let lines: Vec<_> =
        error.mistakes().map(|mistake| (mistake.file, mistake.position.unwrap().line)).collect();
    assert!(matches!(lines[..], [(file, 4)] if file.ends_with("scene.ron")), "{error}");
}

#[test]
fn base_entities_keep_their_place_in_document_order() {
    let scene = extended(
        "spawn: [Script(\"spawn(#{ name: `spawned` })\")],
        entities: [(name: \"first\"), (name: \"lamp\", parent: \"first\"), (name: \"last\"), (name: \"floor\", material: \"clay\")]",
    );
    assert_eq!(names(&scene), ["floor", "ball", "lamp", "first", "last", "spawned"]);
    assert!(matches!(of::<Shape>(&scene, "floor"), Shape::Plane { .. }));
}

#[test]
fn names_can_be_left_out_and_written_anew() {
    let scene = extended("without: [\"ball\"]");
    assert_eq!(names(&scene), ["floor", "lamp"]);
    let scene =
        extended("without: [\"lamp\"], entities: [(name: \"lamp\", light: Point(intensity: (1, 1, 1)))]");
    assert_eq!(names(&scene), ["floor", "ball", "lamp"]);
    assert!(
        of::<Light>(&scene, "lamp").falloff.is_none() && of::<Light>(&scene, "lamp").kind == LightKind::Point
    );
    let error = refused(&folder(&[
        ("base.ron", BASE),
        ("scene.ron", "(extends: \"base.ron\", without: [\"camera\"])"),
    ]));
    assert_eq!(messages(&error), ["the scene has no camera"]);
    assert!(error.mistakes().all(|mistake| mistake.file.ends_with("scene.ron")), "{error}");
    let scene =
        extended("without: [\"camera\"], cameras: { \"side\": (position: (0, 0, -1), view: (0, 0, 1)) }");
    assert!(only::<Camera>(&scene).is_some());
}

const STEPS: [(&str, &str); 7] = [
    ("scene.ron", "(\n  extends: \"steps/two.ron\",\n  entities: [\n    (name: \"new\"),\n    (name: \"ball\", material: \"red\"),\n  ],\n)"),
    ("steps/two.ron", "(\n  extends: \"base/one.ron\",\n  without: [\"part\"],\n  spawn: [File(\"two.rhai\")],\n)"),
    ("steps/two.rhai", "spawn(#{ name: `two` });"),
    (
        "steps/base/one.ron",
        "(\n  camera: (position: (0, 0, -5), view: (0, 0, 1)),\n  include: [(file: \"paint.ron\"), (file: \"part.ron\", name: \"part\"), (file: \"part.ron\", name: \"other\")],
        spawn: [File(\"../one.rhai\")],
        entities: [(name: \"ball\", shape: Sphere(radius: 1), material: \"red\")],
        animate: [\n(target: \"ball\", channel: Radius, track: ScriptFile(\"radius.rhai\")), (target: \"part/thing\", channel: Translation, track: Keys([(0, (0, 0, 0))]))],\n)",
    ),
    ("steps/base/paint.ron", "(materials: { \"red\": (k_d: 1) })"),
    ("steps/base/part.ron", "(entities: [(name: \"thing\")])"),
    ("steps/one.rhai", "spawn(#{ name: `one` });"),
];

#[test]
fn paths_are_relative_to_the_file_that_writes_them() {
    let radius = ("steps/base/radius.rhai", "1 + t");
    let folder = folder(&[&STEPS[..], &[radius]].concat());
    let path = folder.path().join("scene.ron");
    let (scene, sources) = Scene::load_with_sources(&path).unwrap_or_else(|error| panic!("{error}"));
    assert_eq!(names(&scene), ["other", "other/thing", "ball", "new", "one", "two"]);
    let relative = |path: &Path| path.strip_prefix(folder.path()).unwrap().display().to_string();
    let mut files: Vec<String> = scene.files.iter().map(|path| relative(path)).collect();
    files.sort();
    let mut expected: Vec<String> = STEPS
        .iter()
        .chain([&radius])
        .map(|(name, _)| (*name).replace("steps/one.rhai", "steps/base/../one.rhai"))
        .collect();
    expected.sort();
    assert_eq!(files, expected);

    let place =
        |line: rayreel::scene::SourceLine<'_>| format!("{}:{}", relative(Path::new(line.file)), line.line);
    let lines: Vec<String> = sources.entities(&[0, 2, 3]).map(place).collect();
    assert_eq!(lines, ["steps/base/one.ron:3", "scene.ron:5", "scene.ron:4"]);
    assert_eq!(place(sources.camera("camera")), "steps/base/one.ron:2");
    assert_eq!(sources.material(2).as_deref(), Some("red"));
}

#[test]
fn scripts_of_the_base_are_reported_in_their_files() {
    let folder = folder(&[&STEPS[..], &[("steps/base/radius.rhai", "1 +\n nothing")]].concat());
    assert!(refused(&folder).to_string().contains("steps/base/radius.rhai:2:2"), "{}", refused(&folder));
    fs::write(folder.path().join("steps/base/radius.rhai"), "1 +\n list(0, |i| i)[0]").unwrap();
    let text = STEPS[3].1.replace("ScriptFile(\"radius.rhai\")", "Script(\"1 + [1, 2][index + 3]\")");
    fs::write(folder.path().join("steps/base/one.ron"), text).unwrap();
    let Err(EngineError::Script(mistake)) = Engine::from_scene(load(&folder)).seek(Time::ZERO) else {
        panic!()
    };
    assert!(mistake.to_string().contains("steps/base/one.ron:7:"), "{mistake}");
    assert_eq!(mistake.position().unwrap().line, 7);
}

#[test]
fn overrides_apply_to_the_extended_scene() {
    let folder = folder(&[
        ("base.ron", BASE),
        (
            "scene.ron",
            "(\n extends: \"base.ron\",\n camera: (view: (0, 0, 1)),\n entities: [(name: \"ball\",\n shape: (radius: 2))])",
        ),
    ]);
    let load = |overrides: &[&str]| {
        let overrides: Vec<Override> = overrides.iter().map(|one| one.parse().unwrap()).collect();
        Scene::load_overridden(&folder.path().join("scene.ron"), &overrides)
    };
    let (scene, sources) = load(&[
        "camera.roll=90",
        "film=(\n\nwidth: 9)",
        "entities.ball.shape.radius=3",
        "entities.0.name=\"ground\"",
        "materials.tin.k_a=1",
    ])
    .unwrap_or_else(|error| panic!("{error}"));
    assert_eq!(names(&scene), ["ground", "ball", "lamp"]);
    assert_eq!(of::<Shape>(&scene, "ball"), Shape::Sphere { radius: 3.0 });
    assert_eq!(only::<Camera>(&scene).unwrap().roll, 90f64.to_radians());
    assert_eq!(
        (only::<FilmSettings>(&scene).unwrap().width, only::<FilmSettings>(&scene).unwrap().height),
        (9, 360)
    );
    let lines: Vec<usize> = sources.entities(&[0, 1, 2]).map(|place| place.line).collect();
    assert_eq!(lines, [13, 4, 15]);

    let error =
        load(&["entities.ball.shape.radius=-3", "materials.clay.k_d=7", "film.width=0"]).err().unwrap();
    let text = error.to_string();
    for part in [
        "scene.ron:5:18",
        "shape: (radius: -3)",
        "base.ron:3:19",
        "film: (width: 0, height: 36",
        "base.ron:7:33",
        "k_d: 7",
        "= note: read with film.width=0",
    ] {
        assert!(text.contains(part), "{part}\n{text}");
    }
    assert_eq!(error.mistakes().count(), 3);
}

#[test]
fn commands_report_the_file_of_a_value() {
    let folder = folder(&[
        ("base.ron", BASE),
        (
            "scene.ron",
            "(\n extends: \"base.ron\",\n entities: [\n  (name: \"other\", shape: Sphere(radius: 0), material: \"clay\"),\n ])",
        ),
        ("good.ron", "(extends: \"base.ron\", without: [\"lamp\"])"),
    ]);
    let run = |arguments: &[&str], input: &str| {
        let mut command = Command::cargo_bin("rayreel").unwrap();
        command.current_dir(folder.path()).args(arguments).write_stdin(input).output().unwrap()
    };
    let base = BASE.replace("k_d: 0.25", "k_d: 25");
    fs::write(folder.path().join("base.ron"), base).unwrap();
    let report: Value = serde_json::from_slice(&run(&["check", "scene.ron", "--json"], "").stdout).unwrap();
    let places: Vec<_> = report[0]["mistakes"]
        .as_array()
        .unwrap()
        .iter()
        .map(|mistake| (mistake["file"].clone(), mistake["line"].clone(), mistake["included_from"].clone()))
        .collect();
    assert_eq!(
        places,
        [(json!("scene.ron"), json!(4), json!([])), (json!("base.ron"), json!(7), json!(["scene.ron:2"]))]
    );
    fs::write(folder.path().join("base.ron"), BASE).unwrap();
    // Standard input can be the scene that extends another, but not the one that is extended.
    let piped = run(
        &["probe", "-", "--pixel", "32,18", "--json"],
        "(extends: \"base.ron\", without: [\"lamp\"], fog: None)",
    );
    let file = run(&["probe", "good.ron", "--set", "fog=None", "--pixel", "32,18", "--json"], "");
    let rays = |output: &[u8]| serde_json::from_slice::<Value>(output).unwrap()["rays"].clone();
    assert_eq!(rays(&piped.stdout), rays(&file.stdout));
    assert_eq!(
        rays(&piped.stdout)[0]["surface"]["entity"]["file"],
        json!("base.ron"),
        "{}",
        rays(&piped.stdout)
    );
    let refused = run(&["check", "-"], "(extends: \"-\")");
    assert!(String::from_utf8(refused.stderr).unwrap().contains("`-` extends `-`"));
}

#[test]
fn the_number_of_extended_scenes_is_limited() {
    for (depth, is_good) in [(32, true), (33, false)] {
        let name = |level: usize| if level == 0 { "scene.ron".to_owned() } else { format!("{level}.ron") };
        let text = |level: usize| match level {
            _ if level == depth => BASE.to_owned(),
            _ => format!("(extends: \"{}\", entities: [(name: \"e{level}\")])", name(level + 1)),
        };
        let files: Vec<(String, String)> = (0..=depth).map(|level| (name(level), text(level))).collect();
        let files: Vec<(&str, &str)> =
            files.iter().map(|(name, text)| (name.as_str(), text.as_str())).collect();
        let folder = folder(&files);
        if is_good {
            assert_eq!(names(&load(&folder)).last().unwrap(), "e0");
            assert_eq!(names(&load(&folder)).len(), 3 + 32);
        } else {
            assert_eq!(messages(&refused(&folder)), ["scenes extend each other more than 32 deep"]);
        }
    }
}

#[test]
fn files_can_extend_their_includes_but_not_the_files_that_include_them() {
    let ball = "(name: \"ball\", shape: Sphere(radius: 1), material: \"clay\")";
    let part = format!("(materials: {{ \"clay\": (k_d: 1) }}, entities: [{ball}])");
    let include =
        "include: [(file: \"part.ron\", name: \"part\")], camera: (position: (0, 0, -5), view: (0, 0, 1))";
    let scene =
        format!("(extends: \"part.ron\", {include}, entities: [(name: \"ball\", shape: (radius: 2))])");
    let both = load(&folder(&[("part.ron", &part), ("scene.ron", &scene)]));
    assert_eq!(names(&both), ["part", "part/ball", "ball"]);
    assert_eq!(of::<Shape>(&both, "part/ball"), Shape::Sphere { radius: 1.0 });
    assert_eq!(of::<Shape>(&both, "ball"), Shape::Sphere { radius: 2.0 });
    let ring = folder(&[("part.ron", "(extends: \"scene.ron\")"), ("scene.ron", &format!("({include})"))]);
    let error = refused(&ring);
    assert_eq!(error.mistakes().count(), 1, "{error}");
    assert!(messages(&error)[0].ends_with("part.ron`"), "{error}");
}
