//! Tests of scripts in scenes: their effects on the world and on pictures, and their error messages.

use std::fs;
use std::path::Path;
use std::sync::atomic::{AtomicBool, Ordering};
use std::time::{Duration, Instant};

use glam::{DQuat, DVec3};
use rayreel::components::{Light, Material, Name, Order, Shape, Transform};
use rayreel::trace::Signals;
use rayreel::{Changes, Context, Engine, EngineError, RenderRequest, RenderedImage, Scene, Step, Time};

use crate::named;
use crate::spent::Spent;

const HEAD: &str = r#"
    timeline: (fps: 10, duration: 4), film: (width: 32, height: 18, transfer: Classic),
    camera: (position: (0, 0, -8), target: (0, 0, 0)), ambient: (1, 1, 1),
    materials: { "clay": (k_a: 1, color: (255, 120, 60)), "stone": (k_a: 0.5, k_d: 0.5) },"#;

fn scene(rest: &str) -> Result<Scene, String> {
    let text = format!("Scene({HEAD}{rest})");
    Scene::from_text("scene.ron", text).map_err(|error| error.to_string())
}

fn engine(rest: &str) -> Engine {
    Engine::from_scene(scene(rest).unwrap_or_else(|error| panic!("{error}")))
}

/// Returns a scene body with a ball whose translation is a script.
fn ball(script: &str) -> String {
    format!(
        r#"entities: [(name: "ball", shape: Sphere(radius: 1), material: "clay", transform: (translation: (1, 2, 3)))],
           animate: [(target: "ball", channel: Translation, track: Script("{script}"))]"#
    )
}

fn transform(engine: &Engine, name: &str) -> Transform {
    *engine.world().get::<&Transform>(named(engine, name)).unwrap()
}

fn translation(engine: &mut Engine, name: &str, seconds: &str) -> DVec3 {
    engine.seek(seconds.parse().unwrap()).unwrap();
    transform(engine, name).translation
}

#[test]
fn script_moves_its_entity() {
    let mut engine = engine(&ball("[3 * cos(t), base[1] + frame / 2, index + len(name)]"));
    for (seconds, t) in [("0", 0.0), ("1.5", 1.5), ("0.25", 0.25)] {
        let expected = DVec3::new(3.0 * libm::cos(t), 2.0 + 5.0 * t, 4.0);
        assert_eq!(translation(&mut engine, "ball", seconds), expected);
    }
}

#[test]
fn values_of_all_kinds_are_written_as_in_files() {
    let mut engine = engine(
        r##"
        entities: [
            (name: "a", shape: Sphere(radius: 1), material: "clay", light: Point(intensity: (1, 1, 1))),
            (name: "b", shape: Sphere(radius: 1), material: "stone"),
        ],
        animate: [
            (target: "a", channel: Rotation, track: Script("[0, 90 * t, 0]")),
            (target: "b", channel: Rotation, track: Script("[0, 0, 0, 2]")),
            (target: "a", channel: Scale, track: Script("1 + t")),
            (target: "b", channel: Scale, track: Script("[1, 2, 3]")),
            (target: "a", channel: Color, track: Script("[255 * t, 1000, -5]")),
            (target: "b", channel: Color, track: Script("`#ff0000`")),
            (target: "a", channel: Intensity, track: Script("[t, 0, -1]")),
            (target: "b", channel: Kd, track: Script("base * 3")),
        ]"##,
    );
    engine.seek("1".parse().unwrap()).unwrap();
    let (a, b) = (transform(&engine, "a"), transform(&engine, "b"));
    let quarter = DQuat::from_xyzw(0.0, 0.5_f64.sqrt(), 0.0, 0.5_f64.sqrt());
    assert!((a.rotation - quarter).length() < 1e-15, "{}", a.rotation);
    assert_eq!(
        (b.rotation, a.scale, b.scale),
        (DQuat::IDENTITY, DVec3::splat(2.0), DVec3::new(1.0, 2.0, 3.0))
    );
    let material = |name: &str| *engine.world().get::<&Material>(named(&engine, name)).unwrap();
    assert_eq!(material("a").color.to_array(), [1.0, 1.0, 0.0]);
    assert_eq!(material("b").color.to_array(), [1.0, 0.0, 0.0]);
    assert_eq!(material("b").k_d, 1.0, "held to its range");
    let light = engine.world().get::<&Light>(named(&engine, "a")).unwrap().intensity;
    assert_eq!(light.to_array(), [1.0, 0.0, 0.0]);
}

#[test]
fn scripts_read_tracks_and_each_other() {
    let mut engine = engine(
        r#"
        entities: [
            (name: "last", shape: Sphere(radius: 1), material: "clay"),
            (name: "middle", shape: Sphere(radius: 1), material: "clay"),
            (name: "first", shape: Sphere(radius: 1), material: "clay"),
        ],
        animate: [
            (target: "last", channel: Translation, track: Script("value(\"middle\", \"Translation\") + [1, 0, 0]")),
            (target: "middle", channel: Translation, track: Script("2 * value(\"first\", \"Translation\")")),
            (target: "first", channel: Translation, track: Keys([(0, (0, 0, 0)), (2, (0, 4, 0))])),
            (target: "first", channel: Color, track: Script("value(\"last\", \"Color\") / 2")),
        ]"#,
    );
    assert_eq!(translation(&mut engine, "last", "1"), DVec3::new(1.0, 4.0, 0.0));
    assert_eq!(translation(&mut engine, "last", "0.5"), DVec3::new(1.0, 2.0, 0.0));
    let material = engine.world().get::<&Material>(named(&engine, "first")).unwrap().color;
    assert!((material.x - 0.5).abs() < 1e-6);
}

#[test]
fn an_entity_s_own_script_or_track_wins_over_its_material_s() {
    let mut engine = engine(
        r#"
        entities: [
            (name: "keyed", shape: Sphere(radius: 1), material: "clay"),
            (name: "scripted", shape: Sphere(radius: 1), material: "clay"),
            (name: "plain", shape: Sphere(radius: 1), material: "clay"),
        ],
        animate: [
            (target: "keyed", channel: Color, track: Keys([(0, (0, 0, 255))])),
            (target: "scripted", channel: Color, track: Script("[0, 255, index]")),
            (material: "clay", channel: Color, track: Script("base / 2 + [0, 0, index]")),
        ]"#,
    );
    engine.seek("1".parse().unwrap()).unwrap();
    let color = |name: &str| engine.world().get::<&Material>(named(&engine, name)).unwrap().color * 255.0;
    assert_eq!(color("keyed").to_array(), [0.0, 0.0, 255.0]);
    assert!((color("scripted") - glam::Vec3::new(0.0, 255.0, 1.0)).length() < 1e-3);
    assert!((color("plain") - glam::Vec3::new(127.5, 60.0, 32.0)).length() < 1e-3, "{}", color("plain"));
}

/// Renders one time after several sequences of other times, and checks that the pictures are equal.
fn assert_order_does_not_matter(text: &str) {
    let film = |moments: &[&str]| {
        let mut engine = engine(text);
        for moment in &moments[..moments.len() - 1] {
            engine.render(moment.parse::<Time>().unwrap()).unwrap();
        }
        engine.world_mut();
        let again: Time = moments[moments.len() - 1].parse().unwrap();
        let film = engine.render(again).unwrap().film;
        engine.world_mut();
        assert_eq!(film, engine.render(again).unwrap().film, "{text}: after an edit of nothing");
        film
    };
    let in_sequence = |moments: &[&str]| {
        let mut engine = engine(text);
        moments
            .iter()
            .map(|moment| engine.render(moment.parse::<Time>().unwrap()).unwrap().film)
            .next_back()
            .unwrap()
    };
    let alone = in_sequence(&["1.5"]);
    assert_eq!(alone, in_sequence(&["0", "0.5", "1.4", "3", "1.5"]), "{text}");
    assert_eq!(alone, film(&["0", "0.5", "3", "1.5"]), "{text}");
    assert_ne!(alone, in_sequence(&["0"]), "{text}: nothing moves");
}

#[test]
fn a_script_of_a_material_is_no_base_for_one_of_an_entity() {
    let text = r#"entities: [(name: "ball", shape: Sphere(radius: 1), material: "stone")],
        animate: [
            (material: "stone", channel: Ka, track: Script("base + 0.1")),
            (target: "ball", channel: Ka, track: Script("base + 0.05 * t")),
            (material: "stone", channel: Kd, track: Keys([(0, 0.5), (4, 0.9)])),
            (target: "ball", channel: Kd, track: Script("base / 2")),
        ]"#;
    assert_order_does_not_matter(text);
    let mut engine = engine(text);
    engine.seek("2".parse().unwrap()).unwrap();
    let material = *engine.world().get::<&Material>(named(&engine, "ball")).unwrap();
    assert!((material.k_a - 0.6).abs() < 1e-6 && (material.k_d - 0.35).abs() < 1e-6, "{material:?}");
}

#[test]
fn scripts_run_after_their_inputs() {
    let balls = r#"entities: [
            (name: "a", shape: Sphere(radius: 1), material: "stone"),
            (name: "b", shape: Sphere(radius: 1), material: "clay", transform: (translation: (2, 0, 0))),
        ],"#;
    for animate in [
        r#"(target: "a", channel: Translation, track: Script("let v = value(`camera`, `View`); [v[0], v[1], 0]")),
           (target: "camera", channel: Position, track: Script("[t, 0, -8]"))"#,
        r#"(target: "a", channel: Translation, track: Script("let v = value(`camera`, `View`); [v[0], v[1], 0]")),
           (target: "camera", channel: Target, track: Script("[t, 0, 0]"))"#,
        r#"(target: "a", channel: Translation, track: Script("0.3 * value(`camera`, `Target`)")),
           (target: "camera", channel: Position, track: Script("[t, 0, -8]")),
           (target: "camera", channel: View, track: Script("[0, t, 8]"))"#,
        r#"(target: "a", channel: Color, track: Script("value(`b`, `AmbientColor`)")),
           (target: "b", channel: Color, track: Script("[t * 60, 0, 0]"))"#,
        r#"(target: "a", channel: Translation, track: Script("[value(`b`, `AmbientColor`)[0] / 100, 0, 0]")),
           (target: "b", channel: Color, track: Script("[t * 60, 0, 0]")),
           (target: "b", channel: AmbientColor, track: Script("base / 2 + [0, t, 0]"))"#,
        r#"(target: "camera", channel: Position, track: Keys([(0, (0, 0, -8)), (4, (2, 0, -8))])),
           (target: "camera", channel: View, track: Script("base"))"#,
    ] {
        assert_order_does_not_matter(&format!("{balls} animate: [{animate}]"));
    }
    // A script that moves a camera may read its target.
    let mut follows = engine(&format!(
        r#"{balls} animate: [(target: "camera", channel: Position, track: Script("value(`camera`, `Target`) + [t, 0, -8]"))]"#
    ));
    follows.seek("1".parse().unwrap()).unwrap();
    let ring = r#"(target: "camera", channel: Position, track: Script("value(`camera`, `View`)"))"#;
    let found = error_text(&format!("Scene({HEAD} {balls} animate: [{ring}])"));
    assert!(found.contains("a ring of scripts"), "{found}");
    let both = r#"(target: "camera", channel: Target, track: Script("[t, 0, 0]")),
        (target: "camera", channel: View, track: Keys([(0, (0, 0, 1))]))"#;
    let found = error_text(&format!("Scene({HEAD} {balls} animate: [{both}])"));
    assert!(found.contains("both Target and View of one camera are animated"), "{found}");
}

#[test]
fn scripted_values_are_restored() {
    use rayreel::components::{Camera, View};
    let mut engine = engine(
        r#"entities: [(name: "ball", shape: Sphere(radius: 1), material: "clay")],
        animate: [
            (target: "camera", channel: View, track: Script("[t, 0, 8]")),
            (target: "ball", channel: AmbientColor, track: Script("[255, 0, 9]")),
        ]"#,
    );
    engine.seek("1".parse().unwrap()).unwrap();
    let (camera, ball) = (named(&engine, "camera"), named(&engine, "ball"));
    let world = engine.world_mut();
    assert_eq!(world.get::<&Camera>(camera).unwrap().view, View::Target(DVec3::ZERO));
    assert_eq!(world.get::<&Material>(ball).unwrap().ambient_color, None);
}

#[test]
fn failed_step_changes_nothing() {
    let build = || {
        let mut engine = engine(
            r#"entities: [
                (name: "ball", shape: Sphere(radius: 1), material: "clay"),
                (name: "other", shape: Sphere(radius: 1), material: "stone", transform: (translation: (3, 0, 0))),
            ],
            animate: [
                (target: "ball", channel: Translation, track: Keys([(0, (0, 0, 0), Hold), (0.5, (2, 0, 0), Hold), (9, (0, 0, 0))])),
                (target: "other", channel: Radius, track: Script("if t == 0.5 { 1 / 0 } else { 1 }")),
            ]"#,
        );
        engine.add_stepped_system(Step::per_second(10), |context: &mut Context<'_>| {
            context.changes.mark_settings();
        });
        engine
    };
    let at = |engine: &mut Engine, moment: &str| engine.render(moment.parse::<Time>().unwrap());
    let mut engine = build();
    at(&mut engine, "0.05").unwrap();
    at(&mut engine, "0.65").unwrap_err();
    assert_eq!(at(&mut engine, "0.55").unwrap(), at(&mut build(), "0.55").unwrap());
}

#[test]
fn scripts_with_thousands_of_reads_are_limited() {
    let scene = |count: u32| {
        format!(
            r#"Scene({HEAD} entities: [(name: "ball")],
            spawn: [Script("for i in 0..{count} {{ spawn(#{{ name: `b${{i}}` }}); }}")],
            animate: [(target: "ball", channel: Translation, track: Script(
                "let s = [0, 0, 0]; for i in 0..{count} {{ s += value(`b${{i}}`, `Translation`); }} s"))])"#
        )
    };
    let found = error_text(&scene(6000));
    assert!(found.contains("this takes too long"), "{found}");
    let found = error_text(&scene(200));
    assert!(found.starts_with("nothing is wrong"), "{found}");
}

/// Returns balls whose scripts each run for some milliseconds.
fn slow_scripts(balls: usize) -> String {
    let entities: String = (0..balls)
        .map(|ball| format!("(name: \"b{ball}\", shape: Sphere(radius: 1), material: \"clay\"),"))
        .collect();
    let scripts: String = (0..balls)
        .map(|ball| {
            let script = "let n = 0; for i in 0..15000 { n += 1; } [t, n / 15000, 0]";
            format!("(target: \"b{ball}\", channel: Translation, track: Script(\"{script}\")),")
        })
        .collect();
    format!("entities: [{entities}], animate: [{scripts}]")
}

fn render_unless(engine: &mut Engine, time: &str, cancelled: &AtomicBool) -> Option<RenderedImage> {
    let signals = Signals::unless(cancelled);
    match engine.render(RenderRequest { signals, ..RenderRequest::at(time.parse().unwrap()) }) {
        Err(EngineError::Cancelled) => None,
        image => Some(image.unwrap()),
    }
}

#[test]
fn a_frame_is_cancelled_while_its_scripts_run() {
    let text = slow_scripts(4000);
    let mut engine = engine(&text);
    let cancelled = AtomicBool::new(false);
    let (film, other, waited) = std::thread::scope(|scope| {
        scope.spawn(|| {
            std::thread::sleep(Duration::from_millis(100));
            cancelled.store(true, Ordering::Relaxed);
        });
        let start = Instant::now();
        let film = render_unless(&mut engine, "1", &cancelled);
        let waited = start.elapsed();
        (film, render_unless(&mut engine, "2", &cancelled), waited)
    });
    assert!(film.is_none() && other.is_none());
    assert!(waited < Duration::from_secs(2), "{waited:?}");
}

#[test]
fn cancelled_frames_change_nothing() {
    let text = slow_scripts(3);
    let mut engine = engine(&text);
    engine.render("1".parse::<Time>().unwrap()).unwrap();
    let cancelled = AtomicBool::new(true);
    assert!(render_unless(&mut engine, "2", &cancelled).is_none());
    let film = engine.render("1.5".parse::<Time>().unwrap()).unwrap().film;
    assert_eq!(film, self::engine(&text).render("1.5".parse::<Time>().unwrap()).unwrap().film);
}

const LIVELY: &str = r#"
    sampling: (samples: 4, seed: 7),
    entities: [
        (name: "sun", light: Point(intensity: (1, 1, 1)), transform: (translation: (3, 5, -6))),
        (name: "ball", shape: Sphere(radius: 1), material: "stone"),
    ],
    spawn: [Script("for i in 0..20 {
        spawn(#{ name: `s${i}`, shape: sphere(0.2 + 0.2 * random(i)), material: `stone`,
                 translation: [4 * random(i, 1) - 2, 2 * noise(i / 3), 2 * random(i, 2)] });
    }")],
    animate: [
        (target: "ball", channel: Translation, track: Script("base + [noise(t), noise(t + 10, 3), noise(t, 1, 2)]")),
        (material: "stone", channel: Color, track: Script("mix([255, 0, 0], [0, 0, 255], random(index))")),
        (target: "s3", channel: Translation, track: Script("value(`ball`, `Translation`) + [0, 1, 0]")),
    ]"#;

#[test]
fn frames_are_the_same_bits_in_any_order_on_any_number_of_threads() {
    let frame = |threads: usize, frames: &[u32]| {
        let pool = rayon::ThreadPoolBuilder::new().num_threads(threads).build().unwrap();
        pool.install(|| {
            let mut engine = engine(LIVELY);
            frames.iter().map(|index| engine.render_frame(*index).unwrap()).next_back().unwrap()
        })
    };
    let alone = frame(1, &[12]);
    assert_eq!(alone, frame(1, &[0, 5, 39, 12]));
    assert_eq!(alone, frame(3, &[12]));
    assert_ne!(alone, frame(1, &[13]));
    let seeded = |seed: u32| {
        let mut engine = engine(&LIVELY.replace("seed: 7", &format!("seed: {seed}")));
        translation(&mut engine, "s4", "0.5")
    };
    assert_ne!(seeded(7), seeded(8));
}

#[test]
fn scripts_blur_what_they_move() {
    let with = |script: &str| {
        let text = format!("Scene({HEAD}sampling: (samples: 16), {})", ball(script));
        let text = text.replace("target: (0, 0, 0))", "target: (0, 0, 0), shutter: 1)");
        let mut engine = Engine::from_scene(Scene::from_text("scene.ron", text).unwrap());
        (
            engine.render_frame(10).unwrap(),
            engine.report().plan.as_ref().unwrap().need(rayreel::Effect::MotionBlur).is_needed(),
        )
    };
    let (moving, blurred) = with("[6 * t - 6, 0, 0]");
    let (still, sharp) = with("[0, 0, 0]");
    assert!(blurred && !sharp);
    assert_ne!(moving, still);
}

#[test]
fn scripts_and_custom_systems_combine() {
    let text = ball("base + [t, 0, 0]");
    let build = || {
        let mut engine = engine(&text);
        engine.add_stepped_system(Step::per_second(10), |context: &mut Context<'_>| {
            for transform in context.world.query_mut::<&mut Transform>() {
                transform.rotation = DQuat::from_rotation_y(transform.translation.x) * transform.rotation;
            }
            *context.changes = Changes::all();
        });
        engine
    };
    let mut first = build();
    let late = (translation(&mut first, "ball", "2"), transform(&first, "ball").rotation);
    translation(&mut first, "ball", "0.3");
    let again = (translation(&mut first, "ball", "2"), transform(&first, "ball").rotation);
    let mut fresh = build();
    let alone = (translation(&mut fresh, "ball", "2"), transform(&fresh, "ball").rotation);
    assert_eq!((late, late), (again, alone));
    assert_eq!(late.0, DVec3::new(3.0, 2.0, 3.0));
    // An edited world has its own values again.
    let ball = named(&first, "ball");
    assert_eq!(first.world_mut().get::<&Transform>(ball).unwrap().translation, DVec3::new(1.0, 2.0, 3.0));
}

#[test]
fn spawned_entities_are_those_of_the_same_file_written_out() {
    let mut scripted = engine(
        r#"entities: [(name: "own", shape: Sphere(radius: 1), material: "clay")],
        spawn: [Script("
            for i in 0..3 {
                spawn(#{ name: `b${i}`, parent: `own`, shape: box([1, 1 + i, 1]), material: `stone`,
                         translation: [2 * i, 0, 0], rotation: [0, 30, 0], scale: 0.5 });
            }
            spawn(#{ light: area(#{ shape: rectangle(1, 2), intensity: [1, 1, 1], samples: 8 / 2 }),
                     transform: #{ translation: [0, 4, 0], rotation: axis_angle([1, 0, 0], 90) } });
        "), Script("spawn(#{ shape: plane([0, 1, 0]), material: `clay`, translation: [0, -2, 0] })")]"#,
    );
    let boxes: String = (0..3)
        .map(|i| {
            format!(
                r#"(name: "b{i}", parent: "own", shape: Box(size: (1, {}, 1)), material: "stone",
                   transform: (translation: ({}, 0, 0), rotation: Euler(0, 30, 0), scale: 0.5)),"#,
                1 + i,
                2 * i
            )
        })
        .collect();
    let mut written = engine(&format!(
        r#"entities: [(name: "own", shape: Sphere(radius: 1), material: "clay"), {boxes}
            (light: Area(shape: Rectangle(width: 1, height: 2), intensity: (1, 1, 1), samples: 4),
             transform: (translation: (0, 4, 0), rotation: AxisAngle((1, 0, 0), 90))),
            (shape: Plane(normal: (0, 1, 0)), material: "clay", transform: (translation: (0, -2, 0)))]"#
    ));
    assert_eq!(scripted.render_frame(0).unwrap(), written.render_frame(0).unwrap());
    let mut orders: Vec<u64> = scripted.world().query::<&Order>().iter().map(|order| order.0).collect();
    orders.sort_unstable();
    assert_eq!(orders, [0, 1, 2, 3, 4, 5]);
    assert_eq!(scripted.world().query::<&Shape>().iter().count(), 5);
}

#[test]
fn files_hold_scripts_too() {
    let folder = tempfile::tempdir().unwrap();
    fs::write(folder.path().join("wave.rhai"), "fn wave(x) { sin(x) }\n[wave(t), 0, 0]\n").unwrap();
    fs::write(folder.path().join("row.rhai"), "for i in 0..4 {\n  spawn(#{ name: `n${i}` });\n}\n").unwrap();
    let text = format!(
        r#"Scene({HEAD} entities: [(name: "ball")], spawn: [File("row.rhai")],
            animate: [(target: "ball", channel: Translation, track: ScriptFile("wave.rhai"))])"#
    );
    let path = folder.path().join("scene.ron");
    fs::write(&path, &text).unwrap();
    let mut engine = Engine::load(&path).unwrap();
    assert_eq!(translation(&mut engine, "ball", "1"), DVec3::new(libm::sin(1.0), 0.0, 0.0));
    assert_eq!(engine.world().query::<&Name>().iter().filter(|name| name.0.starts_with('n')).count(), 4);
    let files = Scene::load(&path).unwrap().files;
    assert_eq!(files, ["scene.ron", "row.rhai", "wave.rhai"].map(|name| folder.path().join(name)));
    fs::write(folder.path().join("wave.rhai"), "let x = 1;\n[x / (t - 1), 0, 0]").unwrap();
    let mut engine = Engine::load(&path).unwrap();
    let error = engine.seek("1".parse().unwrap()).unwrap_err().to_string();
    assert!(error.contains("wave.rhai:2:4\n"), "{error}");
    fs::write(folder.path().join("row.rhai"), "spawn(#{ nmae: 1 })").unwrap();
    let error = Scene::load(&path).err().unwrap();
    let mistake = error.mistakes().next().unwrap();
    assert_eq!(mistake.position.unwrap().to_string(), "1:1");
    assert!(mistake.file.ends_with("row.rhai"));
    assert!(error.to_string().contains("row.rhai:1:1"), "{error}");
    assert!(error.to_string().contains("did you mean `name`?"), "{error}");
    fs::remove_file(folder.path().join("row.rhai")).unwrap();
    fs::write(folder.path().join("raw.rhai"), "").unwrap();
    let error = Scene::load(&path).err().unwrap().to_string();
    assert!(error.contains("there is no file") && error.contains("did you mean `raw.rhai`?"), "{error}");
}

/// Returns the error of loading a scene or rendering its frames, which must take less than 2 seconds of processor time.
fn error_text(text: &str) -> String {
    let start = Spent::now();
    let found = match Scene::from_text("scene.ron", text.to_owned()) {
        Err(error) => error.to_string(),
        Ok(scene) => {
            let mut engine = Engine::from_scene(scene);
            let result = ["0", "1", "2.5"].iter().try_for_each(|time| engine.seek(time.parse().unwrap()));
            match result {
                Err(error @ EngineError::Script(_)) => error.to_string(),
                other => format!("nothing is wrong: {other:?}"),
            }
        }
    };
    let spent = Spent::now().since(start);
    assert!(spent < Duration::from_secs(2), "{spent:?}: {found}");
    found
}

/// Checks the message of every scene in `tests/bad_scripts` against the file next to it. `RAYREEL_BLESS=1 cargo test --test engine scripts`
/// rewrites these files; review the changes before keeping them.
#[test]
fn every_bad_script_has_its_message() {
    let folder = Path::new(env!("CARGO_MANIFEST_DIR")).join("tests/bad_scripts");
    let entries = fs::read_dir(folder).unwrap().map(|entry| entry.unwrap().path());
    let mut scenes: Vec<_> =
        entries.filter(|path| path.extension().is_some_and(|end| end == "ron")).collect();
    scenes.sort();
    assert!(scenes.len() >= 20);
    let mut wrong = Vec::new();
    for path in scenes {
        let found = error_text(&fs::read_to_string(&path).unwrap()) + "\n";
        let message_file = path.with_extension("message");
        if std::env::var_os("RAYREEL_BLESS").is_some() {
            fs::write(&message_file, &found).unwrap();
        }
        let expected = fs::read_to_string(&message_file).unwrap_or_default();
        if found != expected {
            wrong.push(format!("{}\n--- expected\n{expected}\n--- found\n{found}", path.display()));
        }
    }
    assert!(wrong.is_empty(), "{}", wrong.join("\n\n"));
}

#[test]
fn the_examples_of_the_description_work() {
    let [example, moments] = [1, 2].map(|number| {
        let description = include_str!("../../src/script/language.md");
        description.split("```ron\n").nth(number).unwrap().split("```").next().unwrap()
    });
    let entities = r#"entities: [
        (name: "ball", shape: Sphere(radius: 1), material: "wood", transform: (translation: (1, 1, 0))),
        (name: "lamp", light: Point(intensity: (1, 1, 1))),
        (name: "shadow"),
    ],"#;
    let with = |entities: &str, example: &str| {
        engine(&(entities.to_owned() + example).replace("\"wood\"", "\"clay\""))
    };
    let mut engine = with(entities, example);
    assert_eq!(engine.world().query::<&Shape>().iter().count(), 25);
    assert_eq!(translation(&mut engine, "shadow", "0.5"), DVec3::new(1.0, 0.0, 0.0));
    assert_eq!(transform(&engine, "ball").translation, DVec3::new(1.0, 2.0, 0.0));
    assert_eq!(transform(&engine, "post 6").translation.z, 4.0);
    let entities = r#"entities: [(name: "ball"), (name: "echo"), (name: "chaser")],"#;
    let mut engine = with(entities, moments);
    assert_eq!(translation(&mut engine, "echo", "1.5"), DVec3::new(2.0, 1.0, 0.0));
    // The ball is 0.2 further in each frame, and the chaser has covered a tenth of its distance twice.
    let chaser = translation(&mut engine, "chaser", "0.2");
    assert!((chaser - DVec3::new(0.9 * 0.02 + 0.04, 0.19, 0.0)).length() < 1e-15, "{chaser}");
    let camera = *engine.world().get::<&rayreel::components::Camera>(named(&engine, "camera")).unwrap();
    assert_eq!(camera.view, rayreel::components::View::Target(DVec3::new(0.9, 1.0, 0.0)));
}

#[test]
fn scripts_of_included_files_read_their_own_file() {
    let folder = tempfile::tempdir().unwrap();
    let part = r#"Scene(
        materials: { "clay": (k_a: 1) },
        entities: [(name: "wheel", shape: Sphere(radius: 1), material: "clay")],
        spawn: [Script("for i in 0..2 { spawn(#{ name: `spoke${i}`, parent: `wheel` }); }")],
        animate: [
            (target: "wheel", channel: Translation, track: Script("[t * (1 + index), 0, 0]")),
            (target: "spoke1", channel: Translation, track: Script("value(`wheel`, `Translation`) * 2")),
        ],
    )"#;
    fs::write(folder.path().join("part.ron"), part).unwrap();
    let scene = format!(
        r#"Scene(include: [(file: "part.ron", name: "a"), (file: "part.ron", name: "b")], {HEAD}
            entities: [(name: "own")],
            animate: [(target: "own", channel: Translation,
                track: Script("value(`a/spoke1`, `Translation`) + value(`b/wheel`, `Translation`)"))])"#
    );
    let path = folder.path().join("scene.ron");
    fs::write(&path, scene).unwrap();
    let mut engine = Engine::load(&path).unwrap();
    // In document order: a, its wheel and its spokes, b, its wheel and its spokes.
    assert_eq!(translation(&mut engine, "a/wheel", "1").x, 2.0);
    assert_eq!(transform(&engine, "b/wheel").translation.x, 6.0);
    assert_eq!(transform(&engine, "a/spoke1").translation.x, 4.0);
    assert_eq!(transform(&engine, "b/spoke1").translation.x, 12.0);
    assert_eq!(transform(&engine, "own").translation.x, 10.0);
}
