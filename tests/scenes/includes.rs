//! Tests of scenes of several files: their contents, their order, and their sources. A scene with includes equals the same scene in one
//! file, to the last bit.

use std::fmt::Write;
use std::fs;
use std::path::{Path, PathBuf};
use std::time::Instant;

use assert_cmd::Command;
use serde_json::{Value, json};
use tempfile::TempDir;

use rayreel::components::{
    Animated, Emission, Light, Material, Name, Order, Parent, Pattern, Reflective, Refractive, Shape,
    Specular, Transform, Visibility,
};
use rayreel::scene::LoadError;
use rayreel::{Engine, Entity, Scene, World};

const CAMERA: &str = "camera: (position: (0, 1, -6), target: (0, 0, 0))";

/// Returns a folder with files of these names and texts.
pub(crate) fn folder(files: &[(&str, &str)]) -> TempDir {
    let folder = tempfile::tempdir().unwrap();
    for (name, text) in files {
        let path = folder.path().join(name);
        fs::create_dir_all(path.parent().unwrap()).unwrap();
        fs::write(path, text).unwrap();
    }
    folder
}

pub(crate) fn load(folder: &TempDir) -> Scene {
    Scene::load(&folder.path().join("scene.ron")).unwrap_or_else(|error| panic!("{error}"))
}

pub(crate) fn refused(folder: &TempDir) -> LoadError {
    Scene::load(&folder.path().join("scene.ron")).err().unwrap()
}

pub(crate) fn messages(error: &LoadError) -> Vec<&str> {
    error.mistakes().map(|mistake| mistake.diagnostic.message.as_str()).collect()
}

/// Returns all properties of entities that a file can set, in document order.
pub(crate) fn described(world: &World) -> Vec<String> {
    fn part<T: hecs::Component + std::fmt::Debug>(world: &World, entity: Entity) -> String {
        world.get::<&T>(entity).map_or_else(|_| String::new(), |part| format!(" {:?}", *part))
    }
    let mut query = world.query::<(Entity, &Order)>();
    let mut entities: Vec<(u64, Entity)> = query.iter().map(|(entity, order)| (order.0, entity)).collect();
    entities.sort_unstable_by_key(|(order, _)| *order);
    let mut described = Vec::new();
    for (order, entity) in entities {
        let mut text = order.to_string();
        text += &part::<Name>(world, entity);
        text += &part::<Transform>(world, entity);
        text += &part::<Shape>(world, entity);
        text += &part::<Visibility>(world, entity);
        text += &part::<Material>(world, entity);
        text += &part::<Specular>(world, entity);
        text += &part::<Reflective>(world, entity);
        text += &part::<Refractive>(world, entity);
        text += &part::<Pattern>(world, entity);
        text += &part::<Emission>(world, entity);
        text += &part::<Light>(world, entity);
        text += &part::<Animated>(world, entity);
        if let Ok(parent) = world.get::<&Parent>(entity) {
            write!(text, " in {}", world.get::<&Order>(parent.0).unwrap().0).unwrap();
        }
        described.push(text);
    }
    described
}

pub(crate) fn names(scene: &Scene) -> Vec<String> {
    let mut query = scene.world.query::<(&Order, &Name)>();
    let mut names: Vec<(Order, String)> =
        query.iter().map(|(order, name)| (*order, name.0.clone())).collect();
    names.sort();
    names.into_iter().map(|(_, name)| name).collect()
}

const PAINT: &str = r#"(materials: { "red": (k_a: 0.4, k_d: 0.6, color: (200, 40, 30)) })"#;

const WHEEL: &str = r#"(
    ambient: (9, 9, 9),
    film: (width: 7, height: 7),
    timeline: (fps: 5, duration: 5),
    materials: { "tyre": (k_a: 0.3, k_d: 0.4, color: (40, 40, 60), specular: (k_s: 0.5, shininess: 20)) },
    entities: [
        (name: "axle"),
        (parent: "axle", shape: Box(size: (0.5, 0.5, 0.2)), material: "tyre"),
    ],
    animate: [
        (target: "axle", channel: Rotation, track: Keys([(0, Euler(0, 0, 0)), (1, Euler(0, 0, 90))]), repeat: Loop),
        (target: "camera", channel: Position, track: Keys([(0, (5, 5, 5))])),
        (material: "tyre", channel: Ks, track: Keys([(0, 0), (2, 1)])),
    ],
)"#;

const CAR: &str = r#"Scene(
    include: [
        (file: "../paint.ron"),
        (file: "wheel.ron", name: "front", transform: (translation: (0.8, -0.5, 0))),
        (file: "wheel.ron", name: "back", transform: (translation: (-0.8, -0.5, 0))),
    ],
    camera: (position: (0, 0, 0), target: (0, 0, 9)),
    background: (255, 0, 0),
    materials: { "glass": (k_a: 0.2, color: (90, 120, 160), reflective: (k_r: 0.3)) },
    entities: [
        (name: "body", shape: Box(size: (2.4, 0.6, 1)), material: "red"),
        (parent: "body", shape: Sphere(radius: 0.5), material: "glass", color: (60, 160, 120), transform: (translation: (0, 0.4, 0))),
        (name: "headlight", light: Point(intensity: (0.3, 0.3, 0.2)), transform: (translation: (1.4, 0, 0))),
    ],
    animate: [
        (target: "back/axle", channel: Rotation, track: Keys([(0, Euler(0, 0, 0)), (2, Euler(0, 0, 90))]), repeat: Loop),
    ],
)"#;

const STREET: &str = r##"Scene(
    include: [
        (file: "parts/car.ron", name: "one", transform: (translation: (0, 0.8, 0))),
        (file: "parts/car.ron", name: "two", transform: (translation: (0, 0.8, 3), rotation: Euler(0, 180, 0))),
        (file: "paint.ron"),
        (file: "sign.ron", transform: (translation: (2, 0, 1), scale: 2)),
        (file: "parts/pole.ron"),
    ],
    timeline: (fps: 8, duration: 2),
    film: (width: 64, height: 36, transfer: Srgb),
    camera: (position: (0, 2, -6), target: (0, 0.5, 0)),
    ambient: (0.5, 0.5, 0.5),
    background: "#203040",
    materials: { "road": (k_a: 0.4, k_d: 0.5) },
    entities: [
        (shape: Plane(normal: (0, 1, 0)), material: "road"),
        (parent: "two/body", shape: Sphere(radius: 0.2), material: "one/front/tyre", transform: (translation: (0, 0.9, 0))),
        (parent: "pole", shape: Sphere(radius: 0.2), material: "red", transform: (translation: (0, 1, 0))),
        (light: Directional(intensity: (0.6, 0.6, 0.6), direction: (1, -2, 1))),
    ],
    animate: [
        (target: "one", channel: Translation, track: Keys([(0, (-2, 0.8, 0)), (2, (2, 0.8, 0))])),
        (target: "two/front/axle", channel: Rotation, track: Keys([(0, Euler(0, 0, 0)), (2, Euler(0, 0, -90))])),
        (target: "two/headlight", channel: Intensity, track: Keys([(0, (0, 0, 0)), (2, (1, 1, 1))])),
        (material: "two/red", channel: Color, track: Keys([(0, (20, 40, 200))])),
    ],
)"##;

const SIGN: &str = r#"(
    include: [(file: "parts/pole.ron", name: "left"), (file: "paint.ron")],
    entities: [
        (shape: Box(size: (0.6, 0.4, 0.05)), material: "red", transform: (translation: (0, 1, 0))),
        (parent: "left/pole", shape: Sphere(radius: 0.1), material: (k_d: 0.4, color: (200, 40, 30)), transform: (translation: (0, 1, 0))),
    ],
)"#;

const POLE: &str = r#"(
    materials: { "wood": (k_a: 0.4, k_d: 0.4, color: (120, 90, 50)) },
    entities: [(name: "pole", shape: Box(size: (0.1, 2, 0.1)), material: "wood")],
)"#;

const STREET_FILES: [(&str, &str); 6] = [
    ("scene.ron", STREET),
    ("paint.ron", PAINT),
    ("sign.ron", SIGN),
    ("parts/car.ron", CAR),
    ("parts/wheel.ron", WHEEL),
    ("parts/pole.ron", POLE),
];

/// Returns one car of the street, as it would be written in one file.
fn flat_car(name: &str, transform: &str, front: &str) -> (String, String, String) {
    let wheel = |end: &str, x: &str| {
        format!(
            r#"(name: "{name}/{end}", parent: "{name}", transform: (translation: ({x}, -0.5, 0))),
            (name: "{name}/{end}/axle", parent: "{name}/{end}"),
            (parent: "{name}/{end}/axle", shape: Box(size: (0.5, 0.5, 0.2)), material: "{name}/{end}/tyre"),"#
        )
    };
    let tyre = "k_a: 0.3, k_d: 0.4, color: (40, 40, 60), specular: (k_s: 0.5, shininess: 20)";
    let materials = format!(
        r#""{name}/red": (k_a: 0.4, k_d: 0.6, color: (200, 40, 30)), "{name}/front/tyre": ({tyre}), "{name}/back/tyre": ({tyre}),
        "{name}/glass": (k_a: 0.2, color: (90, 120, 160), reflective: (k_r: 0.3)),"#
    );
    let entities = format!(
        r#"(name: "{name}", transform: {transform}),
        {}{}
        (name: "{name}/body", parent: "{name}", shape: Box(size: (2.4, 0.6, 1)), material: "{name}/red"),
        (parent: "{name}/body", shape: Sphere(radius: 0.5), material: "{name}/glass", color: (60, 160, 120), transform: (translation: (0, 0.4, 0))),
        (name: "{name}/headlight", parent: "{name}", light: Point(intensity: (0.3, 0.3, 0.2)),
         transform: (translation: (1.4, 0, 0))),"#,
        wheel("front", "0.8"),
        wheel("back", "-0.8"),
    );
    let turning = |end: &str, track: &str| {
        format!(
            r#"(target: "{name}/{end}/axle", channel: Rotation, track: {track}),
            (material: "{name}/{end}/tyre", channel: Ks, track: Keys([(0, 0), (2, 1)])),"#
        )
    };
    let slow = "Keys([(0, Euler(0, 0, 0)), (2, Euler(0, 0, 90))]), repeat: Loop";
    (materials, entities, [turning("front", front), turning("back", slow)].concat())
}

/// Returns [`STREET`] without includes. Names in a file cannot contain `/`, so another sign replaces it.
fn flat_street() -> String {
    let looped = "Keys([(0, Euler(0, 0, 0)), (1, Euler(0, 0, 90))]), repeat: Loop";
    let backwards = "Keys([(0, Euler(0, 0, 0)), (2, Euler(0, 0, -90))])";
    let one = flat_car("one", "(translation: (0, 0.8, 0))", looped);
    let turned = "(translation: (0, 0.8, 3), rotation: Euler(0, 180, 0))";
    let two = flat_car("two", turned, backwards);
    let wood = "k_a: 0.4, k_d: 0.4, color: (120, 90, 50)";
    let text = format!(
        r##"Scene(
        timeline: (fps: 8, duration: 2),
        film: (width: 64, height: 36, transfer: Srgb),
        camera: (position: (0, 2, -6), target: (0, 0.5, 0)),
        ambient: (0.5, 0.5, 0.5),
        background: "#203040",
        materials: {{
            {} {}
            "red": (k_a: 0.4, k_d: 0.6, color: (200, 40, 30)),
            "left/wood": ({wood}), "wood": ({wood}),
            "road": (k_a: 0.4, k_d: 0.5),
        }},
        entities: [
            {} {}
            (name: "unnamed", transform: (translation: (2, 0, 1), scale: 2)),
            (name: "left", parent: "unnamed"),
            (name: "left/pole", parent: "left", shape: Box(size: (0.1, 2, 0.1)), material: "left/wood"),
            (parent: "unnamed", shape: Box(size: (0.6, 0.4, 0.05)), material: "red", transform: (translation: (0, 1, 0))),
            (parent: "left/pole", shape: Sphere(radius: 0.1), material: (k_d: 0.4, color: (200, 40, 30)), transform: (translation: (0, 1, 0))),
            (name: "pole", shape: Box(size: (0.1, 2, 0.1)), material: "wood"),
            (shape: Plane(normal: (0, 1, 0)), material: "road"),
            (parent: "two/body", shape: Sphere(radius: 0.2), material: "one/front/tyre",
             transform: (translation: (0, 0.9, 0))),
            (parent: "pole", shape: Sphere(radius: 0.2), material: "red", transform: (translation: (0, 1, 0))),
            (light: Directional(intensity: (0.6, 0.6, 0.6), direction: (1, -2, 1))),
        ],
        animate: [
            {} {}
            (target: "one", channel: Translation, track: Keys([(0, (-2, 0.8, 0)), (2, (2, 0.8, 0))])),
            (target: "two/headlight", channel: Intensity, track: Keys([(0, (0, 0, 0)), (2, (1, 1, 1))])),
            (material: "two/red", channel: Color, track: Keys([(0, (20, 40, 200))])),
        ],
        )"##,
        one.0, two.0, one.1, two.1, one.2, two.2
    );
    let mut flat = String::new();
    for (index, part) in text.split('"').enumerate() {
        // Every second part is between quotes.
        flat += &if index % 2 == 1 { format!("\"{}\"", part.replace('/', "|")) } else { part.to_owned() };
    }
    flat
}

#[test]
fn included_files_equal_a_flat_scene() {
    let folder = folder(&STREET_FILES);
    let whole = load(&folder);
    let flat = Scene::from_text("flat.ron", flat_street()).unwrap_or_else(|error| panic!("{error}"));
    let expected: Vec<String> = described(&flat.world)
        .into_iter()
        .map(|text| text.replace('|', "/").replace(" Name(\"unnamed\")", ""))
        .collect();
    assert_eq!(described(&whole.world), expected);
    assert_eq!(whole.timeline, flat.timeline);
    let (mut whole, mut flat) = (Engine::from_scene(whole), Engine::from_scene(flat));
    let films: Vec<_> = [0, 5, 15].map(|frame| whole.render_frame(frame).unwrap()).into();
    for (frame, film) in [0, 5, 15].into_iter().zip(&films) {
        assert!(flat.render_frame(frame).unwrap() == *film, "frame {frame}");
    }
    assert!(films[0] != films[1] && films[1] != films[2], "nothing moves");
}

#[test]
fn included_files_with_a_camera_load_alone() {
    let folder = folder(&STREET_FILES);
    let car = Scene::load(&folder.path().join("parts/car.ron")).unwrap();
    assert_eq!(names(&car), ["front", "front/axle", "back", "back/axle", "body", "headlight"]);
    let error = Scene::load(&folder.path().join("parts/pole.ron")).err().unwrap();
    assert_eq!(messages(&error), ["the scene has no camera"]);
}

#[test]
fn included_entities_come_first_in_document_order() {
    let ball = |name: &str| {
        format!(
            "(materials: {{ \"m\": (k_a: 1) }}, entities: [(name: \"{name}\", shape: Sphere(radius: 1), material: \"m\")])"
        )
    };
    let scene = format!(
        "Scene({CAMERA}, include: [(file: \"b.ron\", name: \"x\"), (file: \"a.ron\", name: \"y\")],
        materials: {{ \"m\": () }}, entities: [(name: \"own\", shape: Sphere(radius: 1), material: \"m\")])"
    );
    let folder = folder(&[("scene.ron", &scene), ("a.ron", &ball("a")), ("b.ron", &ball("b"))]);
    let scene = load(&folder);
    assert_eq!(names(&scene), ["x", "x/b", "y", "y/a", "own"]);
    // All three balls are at the same position: the first is visible.
    let mut engine = Engine::from_scene(scene);
    engine.seek(rayreel::Time::ZERO).unwrap();
    let (origin, direction) = (glam::DVec3::new(0.0, 0.0, -5.0), glam::DVec3::Z);
    let hit = engine.cast(rayreel::Ray { origin, direction }).unwrap();
    assert_eq!(engine.world().get::<&Name>(hit.entity).unwrap().0, "x/b");
}

#[test]
fn scenes_list_their_files_including_missing_ones() {
    let folder = folder(&STREET_FILES);
    let relative = |path: &PathBuf| path.strip_prefix(folder.path()).unwrap().display().to_string();
    let scene = load(&folder);
    let found: Vec<String> = scene.files.iter().map(relative).collect();
    assert_eq!(
        found,
        ["scene.ron", "parts/car.ron", "parts/../paint.ron", "parts/wheel.ron", "sign.ron", "parts/pole.ron"]
    );
    fs::remove_file(folder.path().join("parts/wheel.ron")).unwrap();
    fs::write(folder.path().join("sign.ron"), "(").unwrap();
    let error = refused(&folder);
    assert_eq!(error.files().iter().map(relative).collect::<Vec<_>>(), found);
    assert_eq!(error.mistakes().count(), 3);
    let missing = folder.path().join("none.ron");
    assert_eq!(Scene::load(&missing).err().unwrap().files(), [missing]);
}

#[test]
fn texts_include_files_relative_to_their_path() {
    let folder = folder(&STREET_FILES);
    for name in ["scene.ron", "no_such_file.ron"] {
        let file = folder.path().join(name).display().to_string();
        let scene = Scene::from_text(&file, STREET.to_owned()).unwrap();
        assert_eq!(described(&scene.world), described(&load(&folder).world));
    }
    let text = format!("({CAMERA}, include: [(file: \"tests/bad_includes/names/empty.ron\")])");
    let scene = Scene::from_text("a name", text).unwrap();
    assert_eq!(
        scene.files,
        [Path::new("a name"), Path::new("tests/bad_includes/names/empty.ron")],
        "from the working directory"
    );
}

#[test]
fn entities_are_found_in_their_files() {
    let folder = folder(&STREET_FILES);
    let (scene, sources) = Scene::load_with_sources(&folder.path().join("scene.ron")).unwrap();
    let all: Vec<usize> = (0..described(&scene.world).len()).collect();
    let lines: Vec<String> = sources
        .entities(&all)
        .map(|place| {
            let file = Path::new(place.file).strip_prefix(folder.path()).unwrap();
            format!("{}:{}", file.display(), place.line)
        })
        .collect();
    let car = |line: usize| {
        let own = ["parts/car.ron:4", "parts/wheel.ron:7", "parts/wheel.ron:8", "parts/car.ron:5"];
        let rest = [
            "parts/wheel.ron:7",
            "parts/wheel.ron:8",
            "parts/car.ron:11",
            "parts/car.ron:12",
            "parts/car.ron:13",
        ];
        [format!("scene.ron:{line}")]
            .into_iter()
            .chain([&own[..], &rest].concat().into_iter().map(str::to_owned))
    };
    let rest = [
        "scene.ron:6",
        "sign.ron:2",
        "parts/pole.ron:3",
        "sign.ron:4",
        "sign.ron:5",
        "parts/pole.ron:3",
        "scene.ron:16",
        "scene.ron:17",
        "scene.ron:18",
        "scene.ron:19",
    ];
    let expected: Vec<String> = car(3).chain(car(4)).chain(rest.map(str::to_owned)).collect();
    assert_eq!(lines, expected);
    assert_eq!(sources.camera("camera").line, 11);
    // The last entity first, and one that does not exist.
    let some: Vec<usize> = sources.entities(&[29, 0, 99]).map(|place| place.line).collect();
    assert_eq!(some, [19, 3, 15]);
}

#[test]
fn commands_report_the_file_of_a_mistake() {
    let folder = folder(&STREET_FILES);
    let run = |arguments: &[&str]| {
        let mut command = Command::cargo_bin("rayreel").unwrap();
        command.current_dir(folder.path()).args(arguments).output().unwrap()
    };
    let probed = run(&["probe", "scene.ron", "--pixel", "16,14", "--json"]);
    let report: Value = serde_json::from_slice(&probed.stdout).unwrap();
    let entity = &report["rays"][0]["surface"]["entity"];
    assert_eq!(
        (&entity["name"], &entity["file"], &entity["line"]),
        (&json!("one/body"), &json!("parts/car.ron"), &json!(11))
    );
    let output = run(&["probe", "scene.ron", "--pixel", "16,14"]);
    assert!(String::from_utf8(output.stdout).unwrap().contains("\"one/body\" (parts/car.ron:11)"));

    fs::write(folder.path().join("parts/pole.ron"), "(entities: [\n  (shape: Sphere(radius: 0)),\n])")
        .unwrap();
    let checked = run(&["check", "scene.ron", "--json"]);
    let report: Value = serde_json::from_slice(&checked.stdout).unwrap();
    assert_eq!((&report[0]["scene"], &report[0]["ok"]), (&json!("scene.ron"), &json!(false)));
    let mistakes = report[0]["mistakes"].as_array().unwrap();
    let in_pole: Vec<&Value> =
        mistakes.iter().filter(|mistake| mistake["file"] == "parts/pole.ron").collect();
    assert_eq!(in_pole.len(), 2);
    for mistake in in_pole {
        assert_eq!(mistake["line"], 2);
        assert_eq!(mistake["included_from"], json!(["sign.ron:2", "scene.ron:6"]));
    }
}

#[test]
fn include_depth_is_limited() {
    for (depth, good) in [(32, true), (33, false)] {
        let mut files =
            vec![("scene.ron".to_owned(), format!("({CAMERA}, include: [(file: \"1.ron\", name: \"p\")])"))];
        for level in 1..depth {
            let text = format!("(include: [(file: \"{}.ron\", name: \"p\")])", level + 1);
            files.push((format!("{level}.ron"), text));
        }
        files.push((format!("{depth}.ron"), "(entities: [(name: \"last\")])".to_owned()));
        let files: Vec<(&str, &str)> =
            files.iter().map(|(name, text)| (name.as_str(), text.as_str())).collect();
        let folder = folder(&files);
        if good {
            assert_eq!(names(&load(&folder)).last().unwrap(), &("p/".repeat(32) + "last"));
        } else {
            assert_eq!(messages(&refused(&folder)), ["files include each other more than 32 deep"]);
        }
    }
}

#[test]
fn repeated_includes_are_limited() {
    let twice = |what: &str, name: [&str; 2]| {
        let [one, two] = name;
        format!("(include: [(file: \"{what}\"{one}), (file: \"{what}\"{two})], {CAMERA})")
    };
    for name in [[", name: \"a\"", ", name: \"b\""], [", transform: ()", ", transform: ()"], ["", ""]] {
        let mut files = vec![("scene.ron".to_owned(), twice("1.ron", name))];
        for level in 1..30 {
            files.push((format!("{level}.ron"), twice(&format!("{}.ron", level + 1), name)));
        }
        files.push(("30.ron".to_owned(), "(entities: [()])".to_owned()));
        let files: Vec<(&str, &str)> =
            files.iter().map(|(name, text)| (name.as_str(), text.as_str())).collect();
        let start = Instant::now();
        let error = refused(&folder(&files));
        assert!(start.elapsed().as_secs() < 5);
        let [message] = messages(&error)[..] else { panic!("{error}") };
        assert_eq!(message, "more than 4000000 entities, materials and animations are included");
    }
}

#[test]
fn repeated_includes_read_a_file_once() {
    let mut scene = format!("Scene({CAMERA}, include: [");
    for car in 0..100 {
        write!(scene, "(file: \"{}parts/car.ron\", name: \"car {car}\"),", "./".repeat(car % 3)).unwrap();
    }
    scene += "])";
    let folder = folder(&[&STREET_FILES[1..], &[("scene.ron", scene.as_str())]].concat());
    let scene = load(&folder);
    assert_eq!(scene.files.len(), 4);
    assert_eq!(described(&scene.world).len(), 1000);
}

#[test]
#[cfg(unix)]
fn endless_files_are_not_included() {
    let scene = format!("({CAMERA}, include: [(file: \"/dev/zero\")])");
    let error = refused(&folder(&[("scene.ron", &scene)]));
    assert_eq!(messages(&error), ["`/dev/zero` is not a file"]);
}
