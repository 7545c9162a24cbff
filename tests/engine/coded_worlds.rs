//! Tests of the faults of worlds built in code: missing components, invalid values, and changes that systems do not declare.

use glam::DVec3;

use rayreel::components::{
    Ambient, Background, Camera, FilmSettings, Light, Material, Parent, Pattern, PatternKind, Reflective,
    Shape, Transform, View, Visibility,
};
use rayreel::systems::{Consequence, FaultCause, UndeclaredChange};
use rayreel::time::Timeline;
use rayreel::{Context, Engine, Entity, Fault, Rgb, Step, Time, World};

const BALL: Shape = Shape::Sphere { radius: 1.0 };
const CLAY: Material = Material::matte(Rgb::new(1.0, 0.5, 0.2));

fn stage() -> World {
    let mut world = World::new();
    world.spawn((Camera::default(),));
    world.spawn((FilmSettings::new(9, 5), Ambient(Rgb::ONE), Background::Flat(Rgb::splat(0.5))));
    world
}

/// Returns the faults of a world with their entities, as text.
fn faults(world: World) -> Vec<(Entity, String, String)> {
    let mut engine = Engine::new(world);
    engine.seek(Time::ZERO).unwrap();
    engine.faults().iter().map(|fault| (fault.entity, fault.to_string(), fault.remedy())).collect()
}

/// Checks the only fault of a world and a part of its remedy.
fn assert_fault(world: World, entity: Entity, message: &str, remedy: &str) {
    let found = faults(world);
    assert_eq!(found.len(), 1, "{found:?}");
    assert_eq!((found[0].0, &*found[0].1), (entity, message));
    assert!(found[0].2.contains(remedy), "{}", found[0].2);
}

#[test]
fn missing_components_of_the_world_are_faults_of_the_first_shape() {
    let mut world = World::new();
    world.spawn((Ambient(Rgb::ONE),));
    let ball = world.spawn((BALL, CLAY));
    world.spawn((BALL, CLAY, Transform::at(2.0, 0.0, 0.0)));
    assert_fault(world, ball, "is seen by a default camera: no entity has a camera", "Camera::looking_at");

    let unlit = || {
        let mut world = World::new();
        world.spawn((Camera::default(),));
        world.spawn((BALL, Material::default(), Reflective::MIRROR, Transform::at(-2.0, 0.0, 0.0)));
        let ball = world.spawn((BALL, CLAY));
        (world, ball)
    };
    let (world, ball) = unlit();
    let message = "is black: no entity has a light, and none has ambient light";
    assert_fault(world, ball, message, "(Ambient(Rgb::ONE),)");
    let (mut world, _) = unlit();
    world.spawn((Light::point(Rgb::ONE), Transform::at(-5.0, 5.0, -5.0)));
    assert_eq!(faults(world), []);
    let (mut world, _) = unlit();
    world.spawn((Ambient(Rgb::ONE),));
    assert_eq!(faults(world), []);
    let (mut world, ball) = unlit();
    world.insert_one(ball, Material::default()).unwrap();
    assert_eq!(faults(world), [], "surfaces that only reflect need no light");
}

#[test]
fn lights_without_transforms_are_faults_unless_they_have_no_position() {
    let mut world = stage();
    let light = world.spawn((Light::point(Rgb::ONE),));
    assert_fault(world, light, "shines from the origin: it has a light but no transform", "Transform::at");
    let mut world = stage();
    world.spawn((Light::point(Rgb::ONE), Transform::IDENTITY));
    world.spawn((Light::directional(DVec3::NEG_Y, Rgb::ONE),));
    let lamp = world.spawn((Shape::Plane { normal: DVec3::Y }, CLAY));
    world.spawn((Light::point(Rgb::ONE), Parent(lamp)));
    assert_eq!(faults(world), []);

    let mut world = stage();
    let light = world.spawn((Light::point(Rgb::ONE),));
    let mut engine = Engine::new(world);
    engine.add_system(|_| {});
    engine.seek(Time::ZERO).unwrap();
    assert_eq!(engine.faults().len(), 1);
    engine.world_mut().insert_one(light, Transform::at(1.0, 2.0, 3.0)).unwrap();
    engine.seek(Time::ZERO).unwrap();
    assert_eq!(engine.faults(), []);
}

#[test]
fn missing_materials_and_parents_name_the_remedy() {
    let mut world = stage();
    let ball = world.spawn((BALL, Reflective::MIRROR));
    assert_fault(world, ball, "is not drawn: it has a shape but no material", "Material::matte(color)");
    let mut world = stage();
    let parent = world.spawn((Transform::IDENTITY,));
    let ball = world.spawn((BALL, CLAY, Parent(parent)));
    world.despawn(parent).unwrap();
    let message = "is not as it says: the entity that it is a child of does not exist, and is omitted";
    assert_fault(world, ball, message, "an entity that exists");
}

#[test]
fn values_that_components_do_not_hold_are_faults() {
    let white = Material::matte(Rgb::new(255.0, 120.0, 60.0));
    let message = "reflects more light than it receives: its color has a channel of 255, and 1 is white";
    let mut world = stage();
    let ball = world.spawn((BALL, white));
    assert_fault(world, ball, message, "`color::srgb(255, 120, 60)`");
    let mut world = stage();
    let pattern = Pattern { color: Rgb::splat(1.5), kind: PatternKind::Checker { size: 1.0 } };
    let floor = world.spawn((Shape::Plane { normal: DVec3::Y }, CLAY, pattern));
    let message =
        "reflects more light than it receives: its pattern colour has a channel of 1.5, and 1 is white";
    assert_fault(world, floor, message, "0 to 1");
    let mut world = stage();
    world.spawn((BALL, Material::matte(Rgb::ONE)));
    world.spawn((Light::point(Rgb::splat(9.0)), Transform::at(4.0, 4.0, -4.0)));
    assert_eq!(faults(world), [], "light may be brighter than 1");

    let seen = |camera: Camera| {
        let mut world = World::new();
        let entity = world.spawn((camera,));
        let found = faults(world);
        assert!(found.len() == 1 && found[0].0 == entity, "{found:?}");
        found[0].1.clone()
    };
    let camera = Camera::default();
    let blind = Camera { view: View::Direction(DVec3::ZERO), ..camera };
    assert_eq!(seen(blind), "is not as it says: its view has no direction, and looks along +z");
    let message = "is not as it says: its up vector has no direction, and has +y upwards";
    assert_eq!(seen(Camera { up: DVec3::ZERO, ..camera }), message);
    let message = "is not as it says: its up vector is not finite, and has +y upwards";
    assert_eq!(seen(Camera { up: DVec3::new(0.0, f64::NAN, 0.0), ..camera }), message);
}

#[derive(Clone)]
struct Velocity;

#[test]
fn unregistered_components_are_named_by_their_entity() {
    let mut world = stage();
    world.spawn((BALL, CLAY, Transform::IDENTITY, Velocity));
    let mut engine = Engine::new(world);
    engine.add_stepped_system(Step::per_second(24), |_| {});
    let error = engine.render_frame(0).unwrap_err().to_string();
    assert!(error.starts_with("entity 2 (with "), "{error}");
    assert!(error.contains("Transform") && error.contains("Shape") && error.contains("Material"), "{error}");
    assert!(error.contains("call `engine.register::<T>()`") && error.ends_with("none so far"), "{error}");
}

#[test]
fn reports_list_the_faults_of_all_frames() {
    let mut world = stage();
    let (clay, ball) = (CLAY, world.spawn((BALL, CLAY, Transform::IDENTITY)));
    world.spawn((BALL, Transform::at(3.0, 0.0, 0.0), rayreel::components::Name::new("bare")));
    let mut engine = Engine::new(world);
    engine.timeline = Timeline::new(4, 1.0);
    engine.add_system(move |context| {
        let late = context.time.seconds() > 0.3;
        context.world.insert_one(ball, Material { k_a: if late { 2.0 } else { 0.5 }, ..clay }).unwrap();
    });
    let folder = tempfile::tempdir().unwrap();
    let report = engine.render_to(folder.path().join("ball")).unwrap();
    let expected = format!(
        "4 frames rendered, 0 kept
frame 0 and 3 more: \"bare\" is not drawn: it has a shape but no material; {}
frame 2 and one more: entity {ball:?} is not as it says: its k_a is 2, and counts as 1; keep it from 0 to 1",
        report.faults[0].fault.remedy()
    );
    assert_eq!(report.to_string(), expected);
    let again = engine.render_to(folder.path().join("ball")).unwrap();
    assert_eq!((again.kept, again.faults), (4, report.faults.clone()));
    assert_eq!(engine.render_movie(folder.path().join("ball.gif")).unwrap().faults, report.faults);
}

/// A change of the ball or its parent, with the call that declares it.
type Change =
    (Option<UndeclaredChange>, fn(&mut Context<'_>, [Entity; 2]), fn(&mut Context<'_>, [Entity; 2]));

const CHANGES: [Change; 8] = [
    (
        Some(UndeclaredChange::Transform),
        |context, [ball, _]| context.world.get::<&mut Transform>(ball).unwrap().translation.x += 1.0,
        |context, [ball, _]| context.changes.mark_transform(ball),
    ),
    (
        Some(UndeclaredChange::Transform),
        |context, [_, parent]| context.world.get::<&mut Transform>(parent).unwrap().translation.x += 1.0,
        |context, [_, parent]| context.changes.mark_transform(parent),
    ),
    (
        Some(UndeclaredChange::Shape),
        |context, [ball, _]| *context.world.get::<&mut Shape>(ball).unwrap() = Shape::Sphere { radius: 0.4 },
        |context, [ball, _]| context.changes.mark_shape(ball),
    ),
    (
        Some(UndeclaredChange::Material),
        |context, [ball, _]| context.world.get::<&mut Material>(ball).unwrap().k_a = 1.0,
        |context, [ball, _]| context.changes.mark_material(ball),
    ),
    (
        Some(UndeclaredChange::Material),
        |context, [ball, _]| context.world.insert_one(ball, Reflective::MIRROR).unwrap(),
        |context, [ball, _]| context.changes.mark_material(ball),
    ),
    (
        Some(UndeclaredChange::Visibility),
        |context, [ball, _]| context.world.insert_one(ball, Visibility::NONE).unwrap(),
        |context, [ball, _]| context.changes.mark_shape(ball),
    ),
    (
        Some(UndeclaredChange::Removal),
        |context, [ball, _]| context.world.despawn(ball).unwrap(),
        |context, _| context.changes.mark_all(),
    ),
    (
        None,
        |context, _| {
            context.world.spawn((BALL, CLAY, Transform::at(0.0, 1.0, 0.0)));
        },
        |context, _| context.changes.mark_all(),
    ),
];

/// Returns an engine with a system that makes a change in step 1, and declares it or only the absence of others.
fn changing((_, change, declare): Change, is_declared: bool) -> Engine {
    let mut world = stage();
    let parent = world.spawn((Transform::IDENTITY,));
    let ball = world.spawn((BALL, CLAY, Transform::IDENTITY, Parent(parent)));
    let mut engine = Engine::new(world);
    engine.add_stepped_system(Step::per_second(1), move |context| {
        if context.time == Time::ZERO {
            change(context, [ball, parent]);
            if is_declared {
                declare(context, [ball, parent]);
            }
        }
        context.changes.mark_settings();
    });
    engine
}

#[test]
fn undeclared_changes_are_faults_in_debug_builds() {
    for change in CHANGES {
        let mut images = [true, false].map(|is_declared| {
            let mut engine = changing(change, is_declared);
            engine.seek(Time::ZERO).unwrap();
            assert_eq!(engine.faults(), []);
            let film = engine.render("1".parse::<Time>().unwrap()).unwrap().film;
            let is_of_image = |fault: &Fault| matches!(fault.consequence, Consequence::OneColor(_));
            (film, engine.faults().into_iter().filter(|fault| !is_of_image(fault)).collect::<Vec<_>>())
        });
        assert!(images[0].0 != images[1].0, "{change:?}: the image is not out of date");
        assert_eq!(images[0].1, [], "{change:?}");
        let found = std::mem::take(&mut images[1].1);
        let expected = change.0.map_or(FaultCause::Undeclared, FaultCause::UndeclaredChange);
        if cfg!(debug_assertions) || change.0.is_none() {
            assert!(found.iter().any(|fault| fault.cause == expected), "{change:?}: {found:?}");
            assert!(found[0].remedy().contains("context.changes.mark_"), "{}", found[0].remedy());
        } else {
            assert_eq!(found, []);
        }
    }
}
