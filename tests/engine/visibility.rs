//! Tests of shapes that only some rays see: their components, their changes, and the faults that they cause.

use rayreel::animation::{Easing, Key, Track, Value};
use rayreel::components::{Animated, Channel, Property, Visibility};
use rayreel::systems::{Consequence, FaultCause, value};
use rayreel::{Engine, Entity, Scene, Time};

use crate::named;

const HIDDEN: &str = "visible: false, casts_shadow: false, in_reflections: false";

fn engine(body: &str) -> Engine {
    let text = format!(
        "Scene(timeline: (fps: 2, duration: 2), film: (width: 16, height: 9), camera: (position: (0, 1, -5), target: (0, 0, 0)), {body})"
    );
    Engine::from_scene(Scene::from_text("seen.ron", text).unwrap_or_else(|error| panic!("{error}")))
}

fn balls(fields: &str) -> String {
    format!(
        r#"ambient: (1, 1, 1), entities: [(name: "ball", shape: Sphere(radius: 1), color: (9, 9, 9), {fields})]"#
    )
}

fn seen(engine: &Engine, entity: Entity) -> Option<Visibility> {
    engine.world().get::<&Visibility>(entity).ok().map(|seen| *seen)
}

#[test]
fn only_hidden_or_animated_shapes_have_a_component() {
    let ball = |body: &str| {
        let engine = engine(body);
        seen(&engine, named(&engine, "ball"))
    };
    assert_eq!(ball(&balls("")), None);
    assert_eq!(ball(&balls("visible: true, casts_shadow: true, in_reflections: true")), None);
    assert_eq!(ball(&balls(HIDDEN)), Some(Visibility::NONE));
    assert_eq!(ball(&balls("casts_shadow: false")), Some(Visibility { shadow: false, ..Visibility::ALL }));
    let animated = r#", animate: [(target: "ball", channel: InReflections, track: Keys([(0, false)]))]"#;
    assert_eq!(ball(&(balls("") + animated)), Some(Visibility::ALL));
    let spawned = r#"ambient: (1, 1, 1), spawn: [Script("spawn(#{ name: `ball`, shape: sphere(1), color: [9, 9, 9], visible: false })")]"#;
    assert_eq!(ball(spawned), Some(Visibility { camera: false, ..Visibility::ALL }));
}

#[test]
fn scripts_read_the_visibility_of_every_shape() {
    let script = r#", (name: "other", shape: Sphere(radius: 1), color: (9, 9, 9))], animate: [
        (target: "other", channel: Visible, track: Script("!value(`ball`, `Visible`)"))]"#;
    for (fields, expected) in [("", false), ("visible: false", true)] {
        let mut engine = engine(&balls(fields).replace("]", script));
        engine.render_frame(0).unwrap();
        let other = named(&engine, "other");
        assert_eq!(value(engine.world(), other, Property::Visible), Some(Value::Flag(expected)));
    }
}

/// Checks worlds made in code: a channel has no effect on an entity without the component.
#[test]
fn channels_move_the_component_alone() {
    let mut engine = engine(&balls(""));
    let ball = named(&engine, "ball");
    let key = |time, value| Key { time, value, easing: Easing::Hold };
    let track = Track::new(vec![key(0.0, false), key(1.0, true)]).unwrap();
    let channels = Animated(vec![Channel::new(Property::Visible, track)]);
    engine.world_mut().insert_one(ball, channels).unwrap();
    let mut films = [0, 3].map(|frame| engine.render_frame(frame).unwrap());
    assert!(films[0] == films[1]);
    engine.world_mut().insert_one(ball, Visibility::ALL).unwrap();
    let shown = films[0].clone();
    films = [0, 3].map(|frame| engine.render_frame(frame).unwrap());
    assert!(films[0] != shown && films[1] == shown);
}

#[test]
fn pictures_of_hidden_shapes_name_the_cause() {
    let cause = |body: &str| {
        let mut engine = engine(body);
        engine.render(Time::ZERO).unwrap();
        let faults = engine.faults();
        assert!(
            faults.iter().all(|fault| matches!(fault.consequence, Consequence::OneColor(_))),
            "{faults:?}"
        );
        faults.first().map(|fault| (fault.cause, fault.to_string()))
    };
    assert_eq!(cause(&balls("")), None);
    for fields in ["visible: false", HIDDEN] {
        let (found, text) = cause(&balls(fields)).unwrap();
        assert_eq!(found, FaultCause::HiddenShapes { shapes: 1 }, "{fields}");
        assert_eq!(text, "sees only black: the only shape is not visible");
    }
    let away = "visible: true, transform: (translation: (0, 99, 0))";
    let (found, _) = cause(&balls(away)).unwrap();
    assert!(matches!(found, FaultCause::OutOfView { shapes: 1, .. }), "{found:?}");
}

/// Checks that a wall separates a light from the camera only if both see it.
#[test]
fn walls_that_are_not_seen_by_all_rays_separate_no_light() {
    let separated = |fields: &str| {
        let body = format!(
            r#"ambient: (1, 1, 1), entities: [(shape: Sphere(radius: 1), color: (9, 9, 9)),
                (shape: Plane(normal: (0, 0, 1)), color: (9, 9, 9), transform: (translation: (0, 0, 3)), {fields}),
                (light: Point(intensity: (1, 1, 1)), transform: (translation: (0, 5, 8)))]"#
        );
        let mut engine = engine(&body);
        engine.render(Time::ZERO).unwrap();
        engine.faults().iter().any(|fault| fault.cause == FaultCause::Separated)
    };
    assert!(separated(""));
    for fields in ["visible: false", "casts_shadow: false", "in_reflections: false"] {
        assert!(!separated(fields), "{fields}");
    }
}

/// Checks trees that are refitted from frame to frame, as few of many shapes move, against newly built ones.
#[test]
fn refitted_trees_show_what_new_ones_show() {
    let flags = ["", "visible: false", "casts_shadow: false", "in_reflections: false"];
    let balls: String = (0..160)
        .map(|index| {
            let (column, row) = (index % 16, index / 16);
            let material = ["clay", "clay", "glass", "mirror", "clay"][index % 5];
            let place = format!("({column}.5, {}, {})", row % 3, 2 * row);
            let fields = flags[index / 3 % 4];
            format!(
                r#"(name: "b{index}", shape: Sphere(radius: 0.45), material: "{material}", transform: (translation: {place}), {fields}), "#
            )
        })
        .collect();
    let moves: String = (0..12)
        .map(|index| {
            let track = format!("Keys([(0, ({index}, 0, 0)), (2, (-3, {}, 1))])", index % 4);
            format!(r#"(target: "b{}", channel: Translation, track: {track}), "#, 13 * index)
        })
        .collect();
    let body = format!(
        r#"ambient: (0.3, 0.3, 0.3), materials: {{ "clay": (k_a: 1, k_d: 0.6, color: (200, 150, 90)),
            "mirror": (reflective: (k_r: 0.8)), "glass": (refractive: (k_t: 0.8, ior: 1.3, absorption: (0.2, 0, 0.3))) }},
        entities: [{balls} (light: Point(intensity: (1, 1, 1)), transform: (translation: (3, 8, -6)))], animate: [{moves}]"#
    );
    let mut kept = engine(&body);
    for frame in 0..4 {
        let film = kept.render_frame(frame).unwrap();
        assert!(film == engine(&body).render_frame(frame).unwrap(), "{frame}");
    }
}
