//! Tests that a reload keeps entities and the BVH if an edit does not affect them.

use std::collections::BTreeMap;

use rayreel::components::{Name, Order, Transform};
use rayreel::{Engine, Entity, Scene, Time};

use super::described::{bits, described};

const HEAD: &str = "film: (width: 12, height: 8), camera: (position: (0, 2, -9), target: (0, 0, 0)), \
    ambient: (0.5, 0.5, 0.5),";

fn scene(body: &str) -> Scene {
    Scene::from_text("kept.ron", format!("Scene({HEAD} {body})")).unwrap_or_else(|error| panic!("{error}"))
}

/// Returns an engine that has rendered a frame.
fn engine(body: &str) -> Engine {
    let mut engine = Engine::from_scene(scene(body));
    engine.render_frame(0).unwrap();
    engine
}

/// Reloads an edited scene, and returns the number of BVH builds for its frame, which must equal the frame of a fresh engine.
fn builds_after(engine: &mut Engine, body: &str) -> u32 {
    engine.reload(scene(body));
    let film = engine.render_frame(0).unwrap();
    let builds = engine.report().bvh_builds;
    assert!(film == Engine::from_scene(scene(body)).render_frame(0).unwrap(), "{body}");
    builds
}

/// Returns the entities in document order, without cameras and settings.
fn entities(engine: &Engine) -> Vec<Entity> {
    let mut query = engine.world().query::<(&Order, Entity)>();
    let entities: BTreeMap<u64, Entity> = query.iter().map(|(order, entity)| (order.0, entity)).collect();
    entities.into_values().collect()
}

fn named(engine: &Engine, name: &str) -> Entity {
    let mut query = engine.world().query::<(Entity, &Name)>();
    query.iter().find(|(_, known)| known.0 == name).unwrap().0
}

/// Returns the body of a scene with two balls and a box, the first without a name.
fn balls(materials: &str, [a, b, c]: [&str; 3], rest: &str) -> String {
    format!(
        "materials: {{ {materials} }}, entities: [
            (shape: Sphere(radius: 1), material: \"clay\", transform: (translation: {a})),
            (name: \"b\", shape: Sphere(radius: 1), material: \"clay\", transform: (translation: {b})),
            (name: \"c\", shape: Box(size: (1, 1, 1)), material: \"clay\", transform: (translation: {c})), {rest} ]"
    )
}

const CLAY: &str = "\"clay\": (k_a: 0.5, k_d: 0.5, color: (255, 120, 60))";
const PLACES: [&str; 3] = ["(-2, 0, 0)", "(0, 0, 0)", "(2, 0, 0)"];

#[test]
fn no_bvh_is_built_where_no_shape_changes() {
    let mut engine = engine(&balls(CLAY, PLACES, ""));
    let before = entities(&engine);
    assert_eq!(engine.report().bvh_builds, 1);
    assert_eq!(builds_after(&mut engine, &balls(CLAY, PLACES, "")), 0);
    for material in [
        "\"clay\": (k_a: 0.5, k_d: 0.5, color: (0, 120, 60))",
        "\"clay\": (k_a: 0.5, reflective: (k_r: 0.5), specular: (k_s: 0.5, shininess: 9))",
        "\"clay\": (k_a: 1), \"other\": (k_a: 1)",
    ] {
        assert_eq!(builds_after(&mut engine, &balls(material, PLACES, "")), 0, "{material}");
    }
    let light = "(light: Point(intensity: (1, 1, 1)), transform: (translation: (0, 9, 0)))";
    assert_eq!(builds_after(&mut engine, &balls(CLAY, PLACES, light)), 0);
    assert_eq!(entities(&engine)[..3], before);
}

#[test]
fn a_light_above_all_others_renumbers_them_and_builds_nothing() {
    let bodies =
        ["", "(name: \"key\", light: Point(intensity: (1, 1, 1)), transform: (translation: (0, 9, 0))),"];
    let body = |light| {
        format!("materials: {{ {CLAY} }}, entities: [ {light}
        (shape: Sphere(radius: 1), material: \"clay\"), (name: \"b\", shape: Box(size: (1, 3, 1)), material: \"clay\") ]")
    };
    let mut engine = engine(&body(bodies[0]));
    let before = entities(&engine);
    assert_eq!(builds_after(&mut engine, &body(bodies[1])), 0);
    assert_eq!(entities(&engine)[1..], before);
    assert_eq!(builds_after(&mut engine, &body(bodies[0])), 0);
    assert_eq!(entities(&engine), before);
}

#[test]
fn structural_edits_build_one_tree_and_keep_other_entities() {
    let mut engine = engine(&balls(CLAY, PLACES, ""));
    let before = entities(&engine);
    let [a, b, c] = PLACES;
    assert_eq!(builds_after(&mut engine, &balls(CLAY, [a, "(0, 1, 0)", c], "")), 1);
    assert_eq!(entities(&engine), before);
    // A moved entity without a name is recognized, because there is no other candidate.
    assert_eq!(builds_after(&mut engine, &balls(CLAY, ["(-3, 0, 0)", b, c], "")), 1);
    assert_eq!(entities(&engine), before);
    let another =
        "(shape: Plane(normal: (0, 1, 0)), material: \"clay\", transform: (translation: (0, -1, 0)))";
    assert_eq!(builds_after(&mut engine, &balls(CLAY, ["(-3, 0, 0)", b, c], another)), 1);
    assert_eq!(entities(&engine)[..3], before);
    assert_eq!(builds_after(&mut engine, &balls(CLAY, ["(-3, 0, 0)", b, c], "")), 1);
    assert_eq!(entities(&engine), before);
}

#[test]
fn unnamed_entities_are_matched_by_content() {
    let row = |places: &[i32]| {
        let balls = places.iter().map(|x| {
            format!("(shape: Sphere(radius: 0.5), material: \"clay\", transform: (translation: ({x}, 0, 0)))")
        });
        format!("materials: {{ {CLAY} }}, entities: [ {} ]", balls.collect::<Vec<_>>().join(", "))
    };
    let mut engine = engine(&row(&[0, 1, 2, 3, 4]));
    let before = entities(&engine);
    builds_after(&mut engine, &row(&[0, 7, 1, 3, 4]));
    let after = entities(&engine);
    assert_eq!([after[0], after[2], after[3], after[4]], [before[0], before[1], before[3], before[4]]);
    // The remaining entities of both versions are taken to be the same.
    assert_eq!(after[1], before[2]);
}

#[test]
fn swapped_names_move_their_entities() {
    let mut engine = engine(&balls(CLAY, PLACES, ""));
    let (b, c) = (named(&engine, "b"), named(&engine, "c"));
    let [at_a, at_b, at_c] = PLACES;
    let exchanged = balls(CLAY, [at_a, at_c, at_b], "").replace("\"b\"", "\"-\"").replace("\"c\"", "\"b\"");
    let exchanged = exchanged.replace("\"-\"", "\"c\"");
    assert_eq!(builds_after(&mut engine, &exchanged), 1);
    assert_eq!((named(&engine, "b"), named(&engine, "c")), (b, c));
}

#[test]
fn removed_track_restores_the_scene_value() {
    let animated = |rest: &str| format!("timeline: (duration: 5), {}, {rest}", balls(CLAY, PLACES, ""));
    let moving = animated(
        "animate: [(target: \"b\", channel: Translation, track: Keys([(0, (0, 0, 0)), (4, (0, 4, 0))])),
        (target: \"c\", channel: Translation, track: Script(\"[t, 0, 0]\"))]",
    );
    let mut engine = engine(&moving);
    let place =
        |engine: &Engine, name| engine.world().get::<&Transform>(named(engine, name)).unwrap().translation;
    engine.seek(Time::from_ratio(2, 1).unwrap()).unwrap();
    assert_eq!((place(&engine, "b").y, place(&engine, "c").x), (2.0, 2.0));
    // At 2 seconds, the script's value equals the scene's value. The picture must change all the same.
    engine.reload(scene(&moving));
    assert_eq!((place(&engine, "b").y, place(&engine, "c").x), (0.0, 2.0));
    assert_eq!(builds_after(&mut engine, &animated("")), 1);
    assert_eq!((place(&engine, "b").y, place(&engine, "c").x), (0.0, 2.0));
}

#[test]
fn first_camera_follows_file_order_after_a_reload() {
    let filmed = |things: &str, cameras: &str| {
        format!(
            "Scene(film: (width: 12, height: 8), ambient: (1, 1, 1), materials: {{ {CLAY} }},
            entities: [(shape: Box(size: (1, 2, 3)), material: \"clay\"), {things}], cameras: {{ {cameras} }})"
        )
    };
    let [near, far] = [("near", 3), ("far", 9)]
        .map(|(name, z)| format!("\"{name}\": (position: (1, 1, -{z}), target: (0, 0, 0))"));
    let load = |text: &str| Scene::from_text("cameras.ron", text.to_owned()).unwrap();
    // The new camera gets the id of the removed entity.
    let mut engine = Engine::from_scene(load(&filmed("(name: \"gone\")", &near)));
    engine.render_frame(0).unwrap();
    engine.reload(load(&filmed("", &near)));
    let both = filmed("", &format!("{near}, {far}"));
    engine.reload(load(&both));
    assert!(named(&engine, "far").id() < named(&engine, "near").id());
    assert!(engine.render_frame(0).unwrap() == Engine::from_scene(load(&both)).render_frame(0).unwrap());
    let turned = filmed("", &format!("{far}, {near}"));
    engine.reload(load(&turned));
    assert!(engine.render_frame(0).unwrap() == Engine::from_scene(load(&turned)).render_frame(0).unwrap());
}

#[test]
fn custom_worlds_can_reload_into_scenes() {
    let mut engine = Engine::new(rayreel::World::new());
    engine.render_frame(0).unwrap();
    assert_eq!(builds_after(&mut engine, &balls(CLAY, PLACES, "")), 1);
}

#[test]
fn zeros_of_different_signs_are_changes() {
    let body =
        |zero: &str| balls(CLAY, [&format!("({zero}, 0, 0)"), &format!("(0, {zero}, 0)"), "(2, 0, 0)"], "");
    let mut engine = engine(&body("0"));
    for zero in ["-0.0", "0"] {
        let mut cold = Engine::from_scene(scene(&body(zero)));
        engine.reload(scene(&body(zero)));
        assert!(bits(&engine.render_frame(0).unwrap()) == bits(&cold.render_frame(0).unwrap()));
        assert_eq!(described(engine.world(), true), described(cold.world(), true), "{zero}");
    }
}
