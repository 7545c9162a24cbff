//! Tests of systems added by a program. Pure systems leave no state behind; stepped systems do not depend on the frames rendered before.

use std::sync::Arc;
use std::sync::atomic::{AtomicBool, AtomicU32, Ordering::Relaxed};

use glam::{DQuat, DVec3};

use rayreel::animation::{Easing, Key, Track};
use rayreel::components::{
    Animated, Camera, Channel, FilmSettings, Light, Material, Name, Order, Parent, Property, Sampling, Shape,
    Transform, WorldTransform,
};
use rayreel::trace::Signals;
use rayreel::{Context, Engine, EngineError, Entity, Film, RenderRequest, Rgb, Step, Time, World};

const CLAY: Material = Material::matte(Rgb::new(1.0, 0.5, 0.2));

fn ball(place: DVec3) -> (Shape, Material, Transform) {
    (Shape::Sphere { radius: 1.0 }, CLAY, Transform::from_translation(place))
}

fn stage() -> World {
    let mut world = World::new();
    world.spawn((Light::point(Rgb::ONE), Transform::at(9.0, 9.0, 9.0)));
    world.spawn((Camera { position: DVec3::new(0.0, 1.0, -12.0), ..Camera::default() },));
    world.spawn((FilmSettings::new(32, 18),));
    world
}

fn at(seconds: u64) -> Time {
    Time::from_ratio(seconds, 10).unwrap()
}

/// Renders films at these tenths of a second on one engine.
fn films(engine: &mut Engine, tenths: &[u64]) -> Vec<Film> {
    tenths.iter().map(|tenth| engine.render(at(*tenth)).unwrap().film).collect()
}

/// Checks that films are equal if rendered forwards, backwards, and each on a fresh engine.
fn assert_frames_are_pure(make: impl Fn() -> Engine) {
    let moments = [0, 1, 2, 5, 9, 10, 17];
    let forwards = films(&mut make(), &moments);
    let mut backwards = films(&mut make(), &moments.iter().rev().copied().collect::<Vec<_>>());
    backwards.reverse();
    let alone: Vec<Film> = moments.iter().map(|moment| make().render(at(*moment)).unwrap().film).collect();
    // `assert_eq!` would print whole films.
    assert!(forwards == backwards, "backwards");
    assert!(forwards == alone, "alone");
    assert!(forwards.windows(2).any(|pair| pair[0] != pair[1]), "nothing moves: the test shows nothing");
}

#[test]
fn pure_systems_do_not_accumulate() {
    assert_frames_are_pure(|| {
        let mut world = stage();
        let ball = world.spawn(ball(DVec3::ZERO));
        let mut engine = Engine::new(world);
        engine.add_system(move |context| {
            let seconds = context.time.seconds();
            context.world.get::<&mut Transform>(ball).unwrap().translation.x += seconds;
            context.changes.mark_transform(ball);
        });
        engine
    });
}

#[test]
fn undeclared_writes_are_reported_and_undone() {
    assert_frames_are_pure(|| {
        let mut world = stage();
        let ball = world.spawn(ball(DVec3::ZERO));
        let mut engine = Engine::new(world);
        engine.add_system(move |context| {
            let seconds = context.time.seconds();
            context.world.get::<&mut Material>(ball).unwrap().color *= if seconds < 0.5 { 0.9 } else { 0.5 };
            if seconds > 0.6 {
                context.world.insert_one(ball, Shape::Box { size: DVec3::ONE }).unwrap();
            }
            if seconds > 1.2 {
                context.world.despawn(ball).unwrap();
            }
        });
        engine
    });
}

#[derive(Clone)]
struct Velocity(DVec3);

fn gravity(context: &mut Context<'_>) {
    let dt = context.step_seconds();
    for (transform, velocity) in context.world.query_mut::<(&mut Transform, &mut Velocity)>() {
        velocity.0.y -= 9.81 * dt;
        transform.translation += velocity.0 * dt;
    }
}

#[test]
fn stepped_systems_replay_with_spawning_and_despawning() {
    assert_frames_are_pure(|| {
        let mut world = stage();
        world.spawn(ball(DVec3::new(-2.0, 3.0, 0.0))).id();
        let mut engine = Engine::new(world);
        engine.register::<Velocity>();
        engine.add_stepped_system(Step::per_second(50), gravity);
        // A fountain emits a ball every 3/10 s; balls live only briefly.
        engine.add_stepped_system(Step::of_seconds(3, 10).unwrap(), |context| {
            let x = context.time.seconds();
            let (shape, material, transform) = ball(DVec3::new(x, 2.0, 0.0));
            context.spawn((shape, material, transform, Velocity(DVec3::new(0.0, 2.0, 0.0))));
            let fallen: Vec<Entity> = context
                .world
                .query_mut::<(Entity, &Transform, &Velocity)>()
                .into_iter()
                .filter(|(_, transform, _)| transform.translation.y < 1.0)
                .map(|(entity, ..)| entity)
                .collect();
            for entity in fallen {
                context.world.despawn(entity).unwrap();
            }
        });
        // A pure system is added on top.
        engine.add_system(|context| {
            let tilt = DQuat::from_rotation_z(context.time.seconds());
            for transform in context.world.query_mut::<&mut Transform>() {
                transform.rotation = tilt * transform.rotation;
                transform.translation.x += 0.01;
            }
        });
        engine
    });
}

#[test]
fn steps_see_tracks_at_their_own_time() {
    let mut world = stage();
    let key = |time, x| Key { time, value: DVec3::new(x, 0.0, 0.0), easing: Easing::Linear };
    let track = Track::new(vec![key(0.0, 0.0), key(10.0, 10.0)]).unwrap();
    let (shape, material, transform) = ball(DVec3::ZERO);
    let leader =
        world.spawn((shape, material, transform, Animated(vec![Channel::new(Property::Translation, track)])));
    let follower = world.spawn(ball(DVec3::new(0.0, 3.0, 0.0)));
    let mut engine = Engine::new(world);
    engine.add_stepped_system(Step::per_second(10), move |context| {
        let x = context.world.get::<&Transform>(leader).unwrap().translation.x;
        let mut own = context.world.get::<&mut Transform>(follower).unwrap();
        own.translation.x += x;
    });
    engine.seek(at(5)).unwrap();
    let x = engine.world().get::<&Transform>(follower).unwrap().translation.x;
    assert!((x - (0.0 + 0.1 + 0.2 + 0.3 + 0.4)).abs() < 1e-12, "{x}");
    engine.seek(at(20)).unwrap();
    engine.seek(at(5)).unwrap();
    assert_eq!(engine.world().get::<&Transform>(follower).unwrap().translation.x, x);
}

#[test]
fn uncopyable_component_is_an_error() {
    let mut world = stage();
    world.spawn((Velocity(DVec3::ZERO),));
    let mut engine = Engine::new(world);
    engine.render_frame(0).unwrap();
    engine.add_system(|_| {});
    let error = engine.render_frame(0).unwrap_err().to_string();
    assert!(error.contains("engine.register::<T>()"), "{error}");
    engine.register::<Velocity>();
    engine.render_frame(0).unwrap();
}

#[test]
fn the_world_can_be_edited_between_frames() {
    let mut world = stage();
    let ball = world.spawn(ball(DVec3::ZERO));
    let mut engine = Engine::new(world);
    let before = engine.render_frame(0).unwrap();
    engine.world_mut().get::<&mut Transform>(ball).unwrap().translation.y = 3.0;
    let after = engine.render_frame(0).unwrap();
    assert!(before != after);
    engine.world_mut().get::<&mut Transform>(ball).unwrap().translation.y = 0.0;
    assert!(engine.render_frame(0).unwrap() == before);
    engine.world_mut().despawn(ball).unwrap();
    assert!(engine.render_frame(0).unwrap() != before);
}

#[test]
fn children_follow_parents_and_only_moved_entities_are_prepared() {
    let mut world = stage();
    let key = |time, x| Key { time, value: DVec3::new(x, 0.0, 0.0), easing: Easing::Linear };
    let track = Track::new(vec![key(0.0, 0.0), key(1.0, 1.0)]).unwrap();
    let parent =
        world.spawn((Transform::IDENTITY, Animated(vec![Channel::new(Property::Translation, track)])));
    let arm = world.spawn((Transform::from_translation(DVec3::Y), Parent(parent)));
    let (shape, material, transform) = ball(DVec3::new(0.0, 1.0, 0.0));
    let hand = world.spawn((shape, material, transform, Parent(arm), Name::new("hand"), Order(7)));
    let mut engine = Engine::new(world);
    for tenth in [0, 4, 10] {
        engine.seek(at(tenth)).unwrap();
        let hit = engine
            .cast(rayreel::Ray {
                origin: DVec3::new(tenth as f64 / 10.0, 2.0, -8.0),
                direction: DVec3::new(0.0, 0.0, 1e-30),
            })
            .unwrap();
        assert_eq!((hit.entity, hit.normal), (hand, DVec3::NEG_Z));
        assert!((hit.distance - 7.0).abs() < 1e-12);
    }
}

#[test]
fn writes_to_lights_and_settings_last_one_frame() {
    assert_frames_are_pure(|| {
        let mut world = stage();
        world.spawn(ball(DVec3::ZERO));
        let mut engine = Engine::new(world);
        engine.add_system(|context| {
            let dimmed = if context.time.seconds() < 0.4 { 0.5 } else { 0.8 };
            for light in context.world.query_mut::<&mut Light>() {
                light.intensity *= dimmed;
            }
            for camera in context.world.query_mut::<&mut Camera>() {
                camera.position.x += context.time.seconds();
            }
            context.changes.mark_settings();
        });
        engine
    });
}

#[test]
fn lamp_material_change_keeps_its_light() {
    let text = r#"Scene(
        timeline: (fps: 10, duration: 2), film: (width: 32, height: 18),
        camera: (position: (0, 2, -8), target: (0, 1, 0)), ambient: (0.1, 0.1, 0.1),
        materials: { "m": (k_a: 1, k_d: 1, color: (200, 100, 50)) },
        entities: [
            (shape: Plane(normal: (0, 1, 0)), material: "m"),
            (name: "lamp", shape: Sphere(radius: 0.2), material: "m", light: Point(intensity: (1, 1, 1)), transform: (translation: (0, 3, 0))),
            (name: "moon", parent: "lamp", shape: Sphere(radius: 0.4), material: "m", transform: (translation: (1, 0, 0))),
        ],
        animate: [(target: "lamp", channel: Ka, track: Keys([(0, 0), (2, 1)]))],
    )"#;
    assert_frames_are_pure(|| {
        let mut engine = Engine::from_scene(rayreel::Scene::from_text("lamp.ron", text.to_owned()).unwrap());
        engine.add_system(|context| context.changes.mark_settings());
        engine
    });
}

/// Checks steps that read the order of rows and world transforms.
#[test]
fn steps_do_not_see_which_frames_were_rendered() {
    assert_frames_are_pure(|| {
        let mut world = stage();
        for index in 0..5 {
            world.spawn(ball(DVec3::new(f64::from(index) - 2.0, 0.0, 0.0)));
        }
        let mut engine = Engine::new(world);
        engine.add_stepped_system(Step::per_second(10), |context| {
            let mut query = context.world.query::<(Entity, &Transform, &WorldTransform, &Shape)>();
            let rows: Vec<(Entity, f64)> =
                query.iter().map(|(entity, _, world, _)| (entity, world.affine.translation.x)).collect();
            drop(query);
            // The first row's x moves the last row. Late steps also replace the first row.
            if let (Some((first, x)), Some((last, _))) = (rows.first(), rows.last()) {
                context.world.get::<&mut Transform>(*last).unwrap().translation.y += 0.1 * x + 0.05;
                if context.time.seconds() > 0.75 && rows.len() > 3 {
                    context.world.despawn(*first).unwrap();
                    let (shape, material, transform) = ball(DVec3::new(0.0, *x, 1.0));
                    context.spawn((shape, material, transform));
                }
            }
        });
        engine.add_system(|context| {
            for transform in context.world.query_mut::<&mut Transform>() {
                transform.translation.x += 0.1 * context.time.seconds();
            }
        });
        engine
    });
}

#[test]
fn cyclic_parents_keep_local_transforms() {
    assert_frames_are_pure(|| {
        let mut world = stage();
        let key = |time, x| Key { time, value: DVec3::new(x, 0.0, 0.0), easing: Easing::Linear };
        let track = Track::new(vec![key(0.0, 0.0), key(10.0, 10.0)]).unwrap();
        let (shape, material, transform) = ball(DVec3::ZERO);
        let mover = world.spawn((
            shape,
            material,
            transform,
            Animated(vec![Channel::new(Property::Translation, track)]),
        ));
        let first = world.spawn(ball(DVec3::new(1.0, 2.0, 0.0)));
        let second = world.spawn(ball(DVec3::new(2.0, -2.0, 0.0)));
        let third = world.spawn(ball(DVec3::new(0.0, 1.5, 0.0)));
        world.insert_one(first, Parent(second)).unwrap();
        world.insert_one(second, Parent(first)).unwrap();
        world.insert_one(third, Parent(second)).unwrap();
        let removed = world.spawn(());
        world.despawn(removed).unwrap();
        world.insert_one(mover, Parent(removed)).unwrap();
        Engine::new(world)
    });
}

#[test]
fn frames_do_not_depend_on_what_a_system_did_to_the_shutter_before() {
    let key = |time, value| Key { time, value, easing: Easing::Linear };
    let track = Track::new(vec![key(0.0, DVec3::ZERO), key(1.0, DVec3::X * 5.0)]).unwrap();
    let mut world = World::new();
    let moving = Animated(vec![Channel::new(Property::Translation, track)]);
    world.spawn((Shape::Sphere { radius: 1.0 }, CLAY, Transform::default(), moving));
    world.spawn((Light::point(Rgb::ONE), Transform::at(9.0, 9.0, 9.0)));
    world.spawn((Camera { shutter: Some(0.5), ..Camera::default() },));
    world.spawn((FilmSettings::new(32, 18),));
    world.spawn((Sampling { samples: 8, ..Sampling::default() },));
    let mut engine = Engine::new(world);
    engine.add_system(|context: &mut Context<'_>| {
        let late = context.time.seconds() > 0.2;
        for camera in context.world.query_mut::<&mut Camera>() {
            camera.shutter = None;
        }
        for sampling in context.world.query_mut::<&mut Sampling>() {
            sampling.samples = if late { 4 } else { 8 };
        }
        for film in context.world.query_mut::<&mut FilmSettings>() {
            film.width = if late { 16 } else { 32 };
        }
        context.changes.mark_settings();
    });
    // The shutter of frame 5 opens before 0.2 s and closes after it.
    let first = engine.render_frame(5).unwrap();
    assert_eq!(engine.render_frame(5).unwrap(), first);
    engine.render_frame(20).unwrap();
    assert_eq!(engine.render_frame(5).unwrap(), first);
    assert_eq!(
        engine
            .render(RenderRequest { reference: true, ..RenderRequest::at(engine.timeline.time_of(5)) })
            .unwrap()
            .film,
        first
    );
    assert_eq!((first.width(), first.height()), (32, 18));
}

/// Checks that a cancelled simulation stops before its next step and continues there, with and without pure systems.
#[test]
fn cancelled_steps_are_continued() {
    for has_pure_system in [false, true] {
        let (steps, cancelled) = (Arc::new(AtomicU32::new(0)), Arc::new(AtomicBool::new(false)));
        let make = |cancel_at: u32| {
            let mut world = stage();
            let ball = world.spawn(ball(DVec3::ZERO));
            let mut engine = Engine::new(world);
            let (steps, cancelled) = (Arc::clone(&steps), Arc::clone(&cancelled));
            engine.add_stepped_system(Step::per_second(10), move |context| {
                context.world.get::<&mut Transform>(ball).unwrap().translation.x += context.time.seconds();
                context.changes.mark_transform(ball);
                if steps.fetch_add(1, Relaxed) + 1 == cancel_at {
                    cancelled.store(true, Relaxed);
                }
            });
            if has_pure_system {
                engine.add_system(|context| context.changes.mark_settings());
            }
            engine
        };
        let mut engine = make(4);
        let cancelling = RenderRequest { signals: Signals::unless(&cancelled), ..RenderRequest::at(at(9)) };
        assert!(matches!(engine.render(cancelling), Err(EngineError::Cancelled)));
        assert_eq!(steps.load(Relaxed), 4);
        let film = engine.render(at(9)).unwrap().film;
        assert_eq!(steps.swap(0, Relaxed), 9);
        assert!(film == make(u32::MAX).render(at(9)).unwrap().film);
        steps.store(0, Relaxed);
        cancelled.store(false, Relaxed);
    }
}
