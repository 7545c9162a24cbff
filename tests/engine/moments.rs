//! Tests of scripts that read values at other moments.

use std::fmt::Write as _;
use std::time::Duration;

use glam::DVec3;
use rayreel::components::{Camera, Transform};
use rayreel::{Changes, Context, Effect, Engine, Scene, Step};

use crate::named;
use crate::spent::Spent;
use crate::splitmix::Random;

fn with_rate(fps: &str, rest: &str) -> Engine {
    let text = format!(
        "Scene(timeline: (fps: {fps}, duration: 4), film: (width: 32, height: 18), ambient: (1, 1, 1),
        materials: {{ \"clay\": (k_a: 1, color: (255, 120, 60)) }}, {rest})"
    );
    Engine::from_scene(Scene::from_text("scene.ron", text).unwrap_or_else(|error| panic!("{error}")))
}

/// Returns an engine of a scene with 8 frames per second.
fn engine(rest: &str) -> Engine {
    with_rate("8", &format!("camera: (position: (0, 0, -8), target: (0, 0, 0)), {rest}"))
}

fn script(target: &str, channel: &str, script: &str) -> String {
    format!("(target: \"{target}\", channel: {channel}, track: Script(r#\"{script}\"#)),")
}

fn translation(engine: &mut Engine, name: &str, frame: u32) -> DVec3 {
    let time = engine.timeline.time_of(frame);
    engine.seek(time).unwrap_or_else(|error| panic!("{error}"));
    engine.world().get::<&Transform>(named(engine, name)).unwrap().translation
}

fn error_text(engine: &mut Engine, frame: u32) -> String {
    engine.seek(engine.timeline.time_of(frame)).unwrap_err().to_string()
}

/// Animations of `leader` and other entities, and an expression of three numbers of the value `v` of a channel.
const LEADERS: [(&str, &str, &str); 15] = [
    ("Translation", "v", ""),
    ("Position", "v", ""),
    (
        "Translation",
        "v",
        r#"(target: "leader", channel: Translation, track: Keys([(0, (0, 1, 0)), (1, (3, 0.1, 2), EaseInOut), (2.5, (0, 4, 0), Hold)])),"#,
    ),
    (
        "Translation",
        "v",
        r#"(target: "leader", channel: Translation, track: Keys([(0.25, (0, 1, 0), CatmullRom), (1, (3, 0.1, 2)), (1.3, (0, 4, 0))]), repeat: Loop),"#,
    ),
    (
        "Translation",
        "v",
        r#"(target: "leader", channel: Translation, track: Keys([(0, (0, 1, 0)), (0.7, (3, 0.1, 2))]), repeat: PingPong, offset: 0.3, speed: 1.7),"#,
    ),
    (
        "Translation",
        "v",
        r#"(target: "leader", channel: Translation, track: Path(points: [(0, 0, 0), (1, 2, 0), (3, 1, 1)], duration: 1.2), repeat: Loop),"#,
    ),
    (
        "Translation",
        "v",
        r#"(target: "leader", channel: Translation, track: Orbit(center: (0, 1, 0), radius: 2, duration: 1.1)),"#,
    ),
    (
        "Rotation",
        "[v[0] + 2 * v[3], v[1], v[2]]",
        r#"(target: "leader", channel: Rotation, track: Turns(axis: (1, 2, 0), turns: 3, duration: 1.7)),"#,
    ),
    (
        "Rotation",
        "[v[0] + 2 * v[3], v[1], v[2]]",
        r#"(target: "leader", channel: Translation, track: Path(points: [(0, 0, 0), (1, 2, 0), (3, 1, 1)], duration: 1.2), repeat: Loop), (target: "leader", channel: Rotation, track: Along),"#,
    ),
    (
        "Radius",
        "[v, 0, 0]",
        r#"(target: "leader", channel: Radius, track: Keys([(0, 1), (3, 0.01, OutBack), (4, 0.001)])),"#,
    ),
    (
        "Translation",
        "v",
        r#"(target: "leader", channel: Translation, track: Script("[frame, floor(frame / 3), noise(7 * t)]")),"#,
    ),
    ("Color", "v", r#"(material: "clay", channel: Color, track: Script("base * 0.5 + [frame, 0, 0]")),"#),
    (
        "Translation",
        "v",
        r#"(target: "other", channel: Translation, track: Keys([(0, (0, 0, 0)), (9, (9, 1, 0))])),
           (target: "third", channel: Translation, track: Script("value(`other`, `Translation`, t / 2) + [frame, t, 0]")),
           (target: "leader", channel: Translation, track: Script("value(`third`, `Translation`) * 2 - value(`third`, `Translation`, t - 0.3)")),"#,
    ),
    // Derived from a direction on a track, and a position from a script.
    (
        "Target",
        "v",
        r#"(target: "wide", channel: View, track: Keys([(0, (0, 0, 1)), (9, (1, 0, 1))])),
           (target: "wide", channel: Position, track: Script("base + [frame, sin(t), 0]")),"#,
    ),
    (
        "View",
        "v",
        r#"(target: "wide", channel: Position, track: Path(points: [(0, 0, -9), (1, 2, -9), (3, 1, -8)], duration: 1.2), repeat: PingPong),
           (target: "wide", channel: Target, track: Script("[0, t, frame]")),"#,
    ),
];

fn led(fps: &str, (channel, parts, animate): (&str, &str, &str), moment: &str) -> Engine {
    let owner = if ["Position", "View", "Target"].contains(&channel) { "wide" } else { "leader" };
    let read = format!("let v = value(\"{owner}\", \"{channel}\"{moment}); {parts}");
    with_rate(
        fps,
        &format!(
            r#"cameras: {{ "wide": (position: (0, 0, -8), target: (0, 0, 0)), "close": (position: (0, 0, -4), target: (0, 0, 0)) }},
            shots: [(0, "close"), (1, "wide")],
            entities: [(name: "leader", shape: Sphere(radius: 1), material: "clay"), (name: "other"), (name: "third"), (name: "reader")],
            animate: [{} {animate}]"#,
            script("reader", "Translation", &read)
        ),
    )
}

#[test]
fn followers_have_the_values_of_other_frames_bit_for_bit() {
    for leader in LEADERS {
        for fps in ["24", "(30000, 1001)", "10"] {
            let mut now = led(fps, leader, "");
            let values: Vec<DVec3> = (0..60).map(|frame| translation(&mut now, "reader", frame)).collect();
            assert!(leader.2.is_empty() || values.iter().any(|value| *value != values[0]), "{leader:?}");
            for (moment, offset) in
                [(", t - 12 / fps", -12), (", t + 7 / fps", 7), (", t", 0), (", t - 0", 0)]
            {
                let mut moved = led(fps, leader, moment);
                for frame in [0_u32, 5, 12, 13, 17, 29, 30, 47] {
                    let Some(expected) = frame.checked_add_signed(offset) else { continue };
                    let found = translation(&mut moved, "reader", frame);
                    assert_eq!(
                        found.to_array().map(f64::to_bits),
                        values[expected as usize].to_array().map(f64::to_bits),
                        "{leader:?}, {fps}, {moment}, frame {frame}"
                    );
                }
            }
        }
    }
}

#[test]
fn moments_before_the_start_and_after_the_end() {
    let read = |track: &str, moment: &str| {
        let animate = format!("(target: \"ball\", channel: Translation, track: {track}),");
        let read = script("reader", "Translation", &format!("value(\"ball\", \"Translation\", {moment})"));
        let mut engine =
            engine(&format!("entities: [(name: \"ball\"), (name: \"reader\")], animate: [{animate} {read}]"));
        translation(&mut engine, "reader", 4)
    };
    let keys = "Keys([(0.25, (1, 0, 0)), (2.25, (5, 0, 0))])";
    let looped = format!("{keys}, repeat: Loop");
    assert_eq!(read(keys, "t - 0.75").x, 1.0);
    assert_eq!(read(keys, "-1e9").x, 1.0);
    assert_eq!(read(keys, "t + 1e6").x, 5.0);
    assert_eq!(read(&looped, "t - 0.75").x, 4.0);
    assert_eq!(read(&looped, "t + 1000").x, read(&looped, "t").x);
    assert_eq!(read("Script(\"[t, frame, fps]\")", "t - 0.75"), DVec3::new(-0.25, -2.0, 8.0));
    assert_eq!(read("Script(\"[t, frame, duration]\")", "100.0625"), DVec3::new(100.0625, 800.5, 4.0));
    assert_eq!(read("Script(\"[t, frame, duration]\")", "-0.0").x.to_bits(), 0);
}

#[test]
fn scripts_that_read_themselves_come_to_an_end() {
    let halves = script(
        "ball",
        "Translation",
        "if t <= 0 { base } else { mix(value(name, `Translation`, t - 1 / fps), [1, frame, 0], 0.5) }",
    );
    for fps in ["24", "(30000, 1001)", "10"] {
        let rest = format!(
            "camera: (position: (0, 0, -8), target: (0, 0, 0)), entities: [(name: \"ball\")], animate: [{halves}]"
        );
        for frame in [0, 1, 40, 50, 3] {
            // Alone, and after no other frame.
            let found = translation(&mut with_rate(fps, &rest), "ball", frame);
            let sum = (1..=frame).fold(0.0, |sum, frame| sum * 0.5 + f64::from(frame) * 0.5);
            let rest = (0..frame).fold(1.0, |rest, _| rest * 0.5);
            assert_eq!(found, DVec3::new(1.0 - rest, sum, 0.0), "{fps}");
        }
    }
    // A spring without stored speed, at a frame that needs 2000 evaluations.
    let spring = script(
        "ball",
        "Translation",
        "if t <= 0 { base } else { let p = value(name, `Translation`, t - 1 / fps);
         p + 0.9 * (p - value(name, `Translation`, t - 2 / fps)) + 0.1 * ([1, 0, 0] - p) }",
    );
    let mut engine = engine(&format!("entities: [(name: \"ball\")], animate: [{spring}]"));
    let (mut before, mut place) = (0.0, 0.0);
    for _ in 0..2000 {
        (before, place) = (place, place + 0.9 * (place - before) + 0.1 * (1.0 - place));
    }
    assert_eq!(translation(&mut engine, "ball", 2000), DVec3::new(place, 0.0, 0.0));
}

/// Entities with scripts that read each other, and the same arithmetic.
struct Readers(Vec<[(usize, f64); 2]>);

impl Readers {
    fn new(random: &mut Random) -> Self {
        let read = |random: &mut Random| (random.index(5), [0.125, 0.25, 0.375, 1.0][random.index(4)]);
        Self((0..5).map(|_| [read(random), read(random)]).collect())
    }

    fn scene(&self, order: &[usize]) -> String {
        let mut animate = String::new();
        for index in order {
            let [(one, delay), (other, other_delay)] = self.0[*index];
            let read = format!(
                "if t <= 0 {{ base }} else {{ value(`e{one}`, `Translation`, t - {delay:?}) * 0.75
                 + value(`e{other}`, `Translation`, t - {other_delay:?}) * 0.3 + [t, frame, {index}] }}"
            );
            animate += &script(&format!("e{index}"), "Translation", &read);
        }
        let entities = order.iter().fold(String::new(), |mut entities, index| {
            let _ = write!(entities, "(name: \"e{index}\", transform: (translation: ({index}, 1, 2))),");
            entities
        });
        format!("entities: [{entities}], animate: [{animate}]")
    }

    fn place(&self, index: usize, eighths: i32) -> DVec3 {
        let number = f64::from(u32::try_from(index).unwrap());
        if eighths <= 0 {
            return DVec3::new(number, 1.0, 2.0);
        }
        #[expect(clippy::cast_possible_truncation, reason = "a few eighths")]
        let read = |(other, delay): (usize, f64)| self.place(other, eighths - (8.0 * delay) as i32);
        let [one, other] = self.0[index];
        let (t, frame) = (f64::from(eighths) / 8.0, f64::from(eighths));
        read(one) * 0.75 + read(other) * 0.3 + DVec3::new(t, frame, number)
    }
}

#[test]
fn values_do_not_depend_on_the_order_of_evaluation() {
    let random = &mut Random(7);
    for _ in 0..40 {
        let readers = Readers::new(random);
        let mut order = [0, 1, 2, 3, 4];
        (1..5).for_each(|index| order.swap(index, random.index(index + 1)));
        let frame = 1 + u32::try_from(random.index(9)).unwrap();
        for order in [[0, 1, 2, 3, 4], order] {
            let mut engine = engine(&readers.scene(&order));
            // Other frames leave no trace.
            for at in [frame, 12, frame, 0, frame] {
                translation(&mut engine, "e0", at);
            }
            for index in 0..5 {
                let found = translation(&mut engine, &format!("e{index}"), frame);
                assert_eq!(
                    found,
                    readers.place(index, frame.try_into().unwrap()),
                    "{}",
                    readers.scene(&order)
                );
            }
        }
    }
}

/// Reads more values at other moments than are kept, by 300 entities.
#[test]
fn discarded_values_are_computed_again() {
    let entities: String = (0..300).map(|index| format!("(name: \"e{index}\"),")).collect();
    let read = "let s = [0, 0, 0]; for i in 0..50 { s += value(`ball`, `Translation`, t - i / 8 - index / 1024); } s";
    let scripts: String = (0..300).map(|index| script(&format!("e{index}"), "Translation", read)).collect();
    let ball = script("ball", "Translation", "[sin(t), t, frame]");
    let mut all = engine(&format!("entities: [{entities} (name: \"ball\")], animate: [{scripts} {ball}]"));
    let last = script("e299", "Translation", read);
    let mut one = engine(&format!("entities: [{entities} (name: \"ball\")], animate: [{last} {ball}]"));
    assert_eq!(translation(&mut all, "e299", 9), translation(&mut one, "e299", 9));
}

#[test]
fn reads_at_other_moments_are_limited() {
    let start = Spent::now();
    let ball = script("ball", "Translation", "[sin(t), 0, 0]");
    let sum = |count: u32, moment: &str| {
        let read = format!(
            "let s = [0, 0, 0]; for i in 0..{count} {{ s += value(`ball`, `Translation`, {moment}); }} s"
        );
        engine(&format!(
            "entities: [(name: \"ball\"), (name: \"sum\")], animate: [{ball} {}]",
            script("sum", "Translation", &read)
        ))
    };
    translation(&mut sum(100, "t - i"), "sum", 3);
    assert!(error_text(&mut sum(1000, "t - i"), 3).contains("this takes too long"));
    // Every read has two more, at other moments each.
    let tree = script(
        "ball",
        "Translation",
        "value(name, `Translation`, t - 0.1 - random(t)) + value(name, `Translation`, t - 0.2 - random(t, 1))",
    );
    let mut tree = engine(&format!("entities: [(name: \"ball\")], animate: [{tree}]"));
    let found = error_text(&mut tree, 3);
    assert!(found.contains("this takes too long") && found.contains("if t <= 0 { base }"), "{found}");
    let spent = Spent::now().since(start);
    assert!(spent < Duration::from_secs(4), "{spent:?}");
}

#[test]
fn values_that_stepped_systems_may_change_have_no_other_moments() {
    let build = |read: &str, base: &str| {
        let mut engine = engine(&format!(
            r#"entities: [(name: "ball"), (name: "reader")],
            animate: [{base} {}]"#,
            script("reader", "Translation", read)
        ));
        engine.add_stepped_system(Step::per_second(8), |context: &mut Context<'_>| {
            for transform in context.world.query_mut::<&mut Transform>() {
                transform.translation.y += 1.0;
            }
            *context.changes = Changes::all();
        });
        engine
    };
    let read = "value(`ball`, `Translation`, t - 0.5)";
    let found = error_text(&mut build(read, ""), 8);
    for part in [
        "Translation of \"reader\" at t = 0: Translation of \"ball\" is not known at other moments",
        "stepped systems may change it",
        "scene.ron:",
    ] {
        assert!(found.contains(part), "{found}");
    }
    assert_eq!(translation(&mut build("value(`ball`, `Translation`)", ""), "reader", 8).y, 8.0);
    assert_eq!(translation(&mut build("value(`ball`, `Translation`, t)", ""), "reader", 8).y, 8.0);
    let driven = script("ball", "Translation", "[t, frame, 0]");
    assert_eq!(translation(&mut build(read, &driven), "reader", 8), DVec3::new(0.5, 4.0, 0.0));
    let keys = r#"(target: "ball", channel: Translation, track: Keys([(0, (0, 0, 0)), (1, (8, 0, 0))])),"#;
    assert_eq!(translation(&mut build(read, keys), "reader", 8), DVec3::new(4.0, 0.0, 0.0));
    // Pure systems run after scripts, which see none of their writes.
    let mut pure = engine(&format!(
        "entities: [(name: \"ball\"), (name: \"reader\")], animate: [{}]",
        script(
            "reader",
            "Translation",
            &read.replace("- 0.5", "- 0.5) + [frame, 0, 0").replace("0, 0)", "0, 0]")
        )
    ));
    pure.add_system(|context: &mut Context<'_>| {
        for transform in context.world.query_mut::<&mut Transform>() {
            transform.translation.y += 1.0;
        }
        *context.changes = Changes::all();
    });
    for frame in [8, 3, 8] {
        assert_eq!(translation(&mut pure, "reader", frame), DVec3::new(frame.into(), 1.0, 0.0));
    }
}

#[test]
fn parts_read_their_own_entities_at_other_moments() {
    let folder = tempfile::tempdir().unwrap();
    let part = format!(
        "Scene(entities: [(name: \"wheel\"), (name: \"spoke\")], animate: [{} {}])",
        script(
            "wheel",
            "Translation",
            "if t <= 0 { [index, 0, 0] } else { value(name, `Translation`, t - 1) + [t, 0, 0] }"
        ),
        script(
            "spoke",
            "Translation",
            "value(`wheel`, `Translation`, t - 1) + value(`wheel`, `Translation`)"
        ),
    );
    std::fs::write(folder.path().join("part.ron"), part).unwrap();
    let sum = "value(`a/spoke`, `Translation`, t + 1) * 100 + value(`b/spoke`, `Translation`, t - 1)";
    let scene = format!(
        r#"Scene(include: [(file: "part.ron", name: "a"), (file: "part.ron", name: "b")], timeline: (fps: 1, duration: 9),
            camera: (position: (0, 0, -8), target: (0, 0, 0)), entities: [(name: "sum")], animate: [{}])"#,
        script("sum", "Translation", sum)
    );
    let path = folder.path().join("scene.ron");
    std::fs::write(&path, scene).unwrap();
    let mut engine = Engine::load(&path).unwrap();
    let [a, b] = ["a/wheel", "b/wheel"].map(|name| translation(&mut engine, name, 0).x);
    let wheel = |start: f64, seconds: f64| start + seconds * (seconds + 1.0) / 2.0;
    let spoke = |start: f64, seconds: f64| wheel(start, seconds - 1.0) + wheel(start, seconds);
    assert_ne!(a, b);
    assert_eq!(translation(&mut engine, "sum", 4).x, spoke(a, 5.0) * 100.0 + spoke(b, 3.0));
}

#[test]
fn followers_blur_while_the_shutter_is_open() {
    let film = |read: &str| {
        let mut engine = with_rate(
            "8",
            &format!(
                r#"camera: (position: (0, 0, -8), target: (0, 0, 0), shutter: 1), sampling: (samples: 16),
                entities: [(name: "leader"), (name: "ball", shape: Sphere(radius: 1), material: "clay")],
                animate: [(target: "leader", channel: Translation, track: Keys([(0, (-3, 0, 0)), (1, (3, 1, 0), InOutSine)])), {}]"#,
                script("ball", "Translation", read)
            ),
        );
        let film = engine.render_frame(6).unwrap();
        let plan = engine.report().plan.clone().unwrap();
        (film, plan.need(Effect::MotionBlur).is_needed())
    };
    let (now, blurred) = film("value(`leader`, `Translation`)");
    assert!(blurred);
    assert_eq!(film("value(`leader`, `Translation`, t)"), (now.clone(), true));
    let (late, blurred) = film("value(`leader`, `Translation`, t - 0.25)");
    assert!(blurred && late != now);
    let still = film("value(`leader`, `Translation`, 0.5)");
    assert!(!still.1);
    // Half of a frame's time before the end of the motion, the follower of the last instants still moves.
    assert!(film("value(`leader`, `Translation`, t + 0.3)").1);
}

#[test]
fn cameras_look_ahead_across_cuts() {
    let mut engine = with_rate(
        "8",
        &format!(
            r#"cameras: {{ "wide": (position: (0, 0, -8), target: (0, 0, 0)), "close": (position: (0, 0, -4), target: (0, 0, 0)) }},
            shots: [(0, "close"), (1, "wide")], entities: [(name: "ball")],
            animate: [(target: "ball", channel: Translation, track: Keys([(0, (0, 0, 0)), (4, (8, 0, 0))])), {} {}]"#,
            script("close", "Position", "value(`wide`, `Position`, t - 0.5) + [0, 0, 4]"),
            script("wide", "Position", "value(`ball`, `Translation`, t + 0.25) - [0, 0, 8]"),
        ),
    );
    for frame in [12, 2, 7, 8] {
        engine.seek(engine.timeline.time_of(frame)).unwrap();
        let position = |name| engine.world().get::<&Camera>(named(&engine, name)).unwrap().position;
        let t = f64::from(frame) / 8.0;
        assert_eq!(position("wide"), DVec3::new((2.0 * t + 0.5).max(0.0), 0.0, -8.0));
        assert_eq!(position("close"), DVec3::new((2.0 * t - 0.5).max(0.0), 0.0, -4.0));
    }
}
