//! Tests of entities that look at points and at other entities.

use glam::{DQuat, DVec3};

use rayreel::components::{FilmSettings, Light, LookAt, Parent, Property, Target, Transform, WorldTransform};
use rayreel::systems::{Consequence, Fallback, Fault, FaultCause, propagate};
use rayreel::{Changes, Engine, Entity, Film, Rgb, Scene, Time, World};

use crate::splitmix::Random;

fn number(random: &mut Random) -> f64 {
    f64::from(u32::try_from(random.bits() >> 32).unwrap()) / f64::from(u32::MAX) * 8.0 - 4.0
}

fn vector(random: &mut Random) -> DVec3 {
    DVec3::from_array([(); 3].map(|()| number(random)))
}

fn scale(random: &mut Random) -> DVec3 {
    let factor = |random: &mut Random| [0.25, 0.5, 1.0, 1.0, 2.0, -1.0, -0.5][random.index(7)];
    DVec3::from_array([(); 3].map(|()| factor(random)))
}

fn transform(random: &mut Random) -> Transform {
    let turn = DQuat::from_scaled_axis(vector(random));
    Transform { translation: vector(random), rotation: turn, scale: scale(random) }
}

fn place(world: &World, entity: Entity) -> WorldTransform {
    *world.get::<&WorldTransform>(entity).unwrap()
}

fn close(found: DVec3, expected: DVec3) {
    let (found, expected) = (found.normalize(), expected.normalize());
    assert!(found.distance(expected) < 1e-9, "{found}, not {expected}");
}

/// Random parents, and entities that look at points and at each other.
fn crowd(random: &mut Random) -> (World, Vec<Entity>) {
    let mut world = World::new();
    let mut entities: Vec<Entity> = Vec::new();
    for index in 0..12 {
        let entity = world.spawn((transform(random),));
        if index > 0 && !random.once_in(3) {
            world.insert_one(entity, Parent(entities[random.index(index)])).unwrap();
        }
        entities.push(entity);
    }
    for entity in &entities {
        match random.index(4) {
            0 => world.insert_one(*entity, Target(vector(random))).unwrap(),
            1 => world.insert_one(*entity, LookAt(entities[random.index(12)])).unwrap(),
            _ => {}
        }
    }
    (world, entities)
}

/// Returns an engine at its start, and the entities that look at a part of themselves.
fn started(mut world: World) -> (Engine, Vec<Entity>) {
    world.spawn((FilmSettings::new(3, 3),));
    let mut engine = Engine::new(world);
    engine.plan(Time::ZERO).unwrap();
    let faults = engine.faults();
    let circular = faults.iter().filter(|fault| fault.cause == FaultCause::CircularAim);
    let circular = circular.map(|fault| fault.entity).collect();
    (engine, circular)
}

#[test]
fn z_axes_point_to_targets_with_y_up_in_all_parents() {
    let mut random = Random(1);
    let (mut aimed, mut ignored) = (0, 0);
    for _ in 0..300 {
        let (world, entities) = crowd(&mut random);
        let (engine, circular) = started(world);
        let world = engine.world();
        for entity in entities {
            let own = *world.get::<&Transform>(entity).unwrap();
            let outer = world
                .get::<&Parent>(entity)
                .map_or_else(|_| WorldTransform::IDENTITY, |parent| place(world, parent.0));
            let found = place(world, entity).affine;
            let target = match (world.get::<&Target>(entity), world.get::<&LookAt>(entity)) {
                (_, Ok(target)) => place(world, target.0).affine.translation,
                (Ok(target), _) => outer.affine.transform_point3(target.0),
                _ => continue,
            };
            if circular.contains(&entity) {
                let kept = outer.affine.matrix3.inverse() * found.matrix3;
                close(kept.z_axis, own.rotation * DVec3::Z * own.scale.z);
                ignored += 1;
                continue;
            }
            let towards = target - found.translation;
            let towards = if towards == DVec3::ZERO { DVec3::Z } else { towards };
            close(found.matrix3.z_axis, towards);
            let [x, y, z] = {
                let axes = outer.affine.matrix3.inverse() * found.matrix3;
                [axes.x_axis, axes.y_axis, axes.z_axis]
            };
            assert!(x.y.abs() < 1e-9 && y.y > 0.0 && y.dot(z).abs() < 1e-9, "{x} {y} {z}");
            for (axis, factor) in [x, y, z].into_iter().zip(own.scale.to_array()) {
                assert!((axis.length() - factor.abs()).abs() < 1e-9);
            }
            assert_eq!(x.cross(y).dot(z) > 0.0, own.scale.element_product() > 0.0);
            aimed += 1;
        }
    }
    assert!(aimed > 1000 && ignored > 20, "{aimed} {ignored}");
}

/// Checks that updates after declared changes give the world transforms of a complete pass.
#[test]
fn updates_equal_a_complete_pass() {
    let mut random = Random(2);
    for _ in 0..200 {
        let (mut world, entities) = crowd(&mut random);
        propagate(&mut world, &Changes::all());
        for _ in 0..4 {
            let before: Vec<WorldTransform> = entities.iter().map(|entity| place(&world, *entity)).collect();
            let mut changes = Changes::default();
            for _ in 0..=random.index(3) {
                let entity = entities[random.index(12)];
                *world.get::<&mut Transform>(entity).unwrap() = transform(&mut random);
                if let Ok(mut target) = world.get::<&mut Target>(entity) {
                    target.0 = vector(&mut random);
                }
                changes.mark_transform(entity);
            }
            let moved = propagate(&mut world, &changes);
            let updated: Vec<WorldTransform> = entities.iter().map(|entity| place(&world, *entity)).collect();
            propagate(&mut world, &Changes::all());
            for ((entity, updated), before) in entities.iter().zip(updated).zip(before) {
                assert_eq!(place(&world, *entity), updated);
                assert!(moved.contains(entity) || updated == before);
            }
        }
    }
}

#[test]
fn undefined_aims_have_fixed_fallbacks_and_faults() {
    let mut world = World::new();
    let turn = DQuat::from_rotation_y(1.0);
    let outer = world.spawn((Transform { rotation: turn, ..Transform::at(1.0, 2.0, 3.0) },));
    let here = world.spawn((Transform::at(4.0, 5.0, 6.0), Parent(outer), Target(DVec3::new(4.0, 5.0, 6.0))));
    let lost = world.spawn((Transform { rotation: turn, ..Transform::IDENTITY }, LookAt(Entity::DANGLING)));
    let infinite = world.spawn((Transform::IDENTITY, Target(DVec3::INFINITY)));
    let owner = world.spawn((Transform { rotation: turn, ..Transform::IDENTITY },));
    let part = world.spawn((Transform::at(0.0, 1.0, 1.0), Parent(owner)));
    world.insert_one(owner, LookAt(part)).unwrap();
    let (engine, circular) = started(world);
    assert_eq!(circular, [owner]);
    let z = |entity| place(engine.world(), entity).affine.matrix3.z_axis;
    close(z(here), DVec3::Z);
    assert_eq!(z(infinite), DVec3::Z);
    for entity in [lost, owner] {
        close(z(entity), turn * DVec3::Z);
    }
    let fault =
        |entity, cause, fallback| Fault { entity, consequence: Consequence::Fallback(fallback), cause };
    assert_eq!(
        engine.faults(),
        [
            fault(lost, FaultCause::Missing("looks at"), Fallback::Nothing),
            fault(infinite, FaultCause::NotFinite("target"), Fallback::AlongZ),
            fault(owner, FaultCause::CircularAim, Fallback::Nothing),
        ]
    );
}

/// Returns a scene with a floor, a ball and three lights with these fields.
fn text(spot: &str, panel: &str, sun: &str, animate: &str) -> String {
    format!(
        "Scene(
            timeline: (fps: 10, duration: 2),
            film: (width: 32, height: 20),
            camera: (position: (0, 5, -9), target: (0, 0, 0)),
            materials: {{ \"clay\": (k_d: 1, color: (200, 120, 60)) }},
            entities: [
                (shape: Plane(normal: (0, 1, 0)), material: \"clay\", transform: (translation: (0, -1, 0))),
                (name: \"ball\", shape: Sphere(radius: 0.5), material: \"clay\"),
                (name: \"spot\", light: Spot(intensity: (1, 0, 0), angle: 30), {spot}),
                (light: Area(shape: Rectangle(width: 1, height: 2), intensity: (0, 1, 0), samples: 4), {panel}),
                (light: Directional(intensity: (0, 0, 1)), {sun}),
            ],
            animate: [{animate}],
        )"
    )
}

fn film(text: &str, tenths: u64) -> Film {
    let scene = Scene::from_text("aim.ron", text.to_owned()).unwrap_or_else(|error| panic!("{error}"));
    Engine::from_scene(scene).render(Time::from_ratio(tenths, 10).unwrap()).unwrap().film
}

/// Checks lights that look straight down and sideways against rotations by quarter turns, which are exact.
#[test]
fn lights_that_look_shine_as_rotated_ones() {
    let rotated = text(
        "transform: (translation: (0, 5, 0), rotation: Euler(90, 0, 0))",
        "transform: (translation: (-4, 0, 0), rotation: Euler(0, 90, 0))",
        "transform: (translation: (5, 0, 0), rotation: Euler(0, -90, 0))",
        "",
    );
    let looking = text(
        "transform: (translation: (0, 5, 0)), look_at: \"ball\"",
        "transform: (translation: (-4, 0, 0)), look_at: \"ball\"",
        "transform: (translation: (5, 0, 0)), target: (0, 0, 0)",
        "",
    );
    let straight =
        text("transform: (translation: (0, 5, 0))", "transform: (translation: (-4, 0, 0))", "", "");
    assert!(film(&rotated, 0) == film(&looking, 0));
    assert!(film(&rotated, 0) != film(&straight, 0));
}

#[test]
fn lights_follow_moving_targets() {
    let spot = "transform: (translation: (3, 4, -2)), look_at: \"ball\"";
    let panel = "transform: (translation: (-4, 3, 1)), look_at: \"ball\"";
    let moving = "(target: \"ball\", channel: Translation, track: Keys([(0, (0, 0, 0)), (2, (4, 1, 2))]))";
    let text = text(spot, panel, "look_at: \"ball\", transform: (translation: (0, 9, 1))", moving);
    let still = |at: &str| {
        let ball = "(name: \"ball\", shape: Sphere(radius: 0.5), material: \"clay\"";
        let placed = text.replace(ball, &format!("{ball}, transform: (translation: {at})"));
        film(&placed.replace(moving, ""), 0)
    };
    let films = [still("(0, 0, 0)"), still("(2, 0.5, 1)"), still("(3, 0.75, 1.5)")];
    assert!(films[0] != films[1]);
    let scene = Scene::from_text("aim.ron", text.clone()).unwrap();
    let mut engine = Engine::from_scene(scene);
    for (frame, expected) in [(0, 0), (10, 1), (15, 2), (0, 0), (15, 2), (10, 1)] {
        assert!(engine.render_frame(frame).unwrap() == films[expected], "frame {frame}");
    }
}

#[test]
fn target_points_are_animated_by_keys_and_scripts() {
    let spot = |target: &str| format!("transform: (translation: (3, 4, -2)), target: {target}");
    let written = film(&text(&spot("(1, 0, 2)"), "", "", ""), 0);
    for track in ["Keys([(0, (0, 0, 0)), (2, (2, 0, 4))])", "Script(\"base + [t, 0, 2 * t]\")"] {
        let animate = format!("(target: \"spot\", channel: Target, track: {track})");
        let moving = text(&spot("(0, 0, 0)"), "", "", &animate);
        assert!(film(&moving, 10) == written, "{track}");
        assert!(film(&moving, 0) != written, "{track}");
    }
}

#[test]
fn spawned_and_prefixed_entities_look_at_entities() {
    let folder = tempfile::tempdir().unwrap();
    let part = "(entities: [
        (name: \"ball\", transform: (translation: (1, 2, 3))),
        (name: \"eye\", look_at: \"ball\"),
    ])";
    let scene = "(
        include: [(file: \"part.ron\", name: \"a\"), (file: \"part.ron\", name: \"b\", transform: (translation: (5, 0, 0)))],
        camera: (position: (0, 1, -5), target: (0, 0, 0)),
        entities: [(name: \"outer\", look_at: \"b/ball\")],
        spawn: [Script(\"spawn(#{ name: `made`, look_at: `a/ball` }); spawn(#{ name: `point`, target: [0, 3, 0] });\")],
    )";
    std::fs::write(folder.path().join("part.ron"), part).unwrap();
    std::fs::write(folder.path().join("scene.ron"), scene).unwrap();
    let scene = Scene::load(&folder.path().join("scene.ron")).unwrap_or_else(|error| panic!("{error}"));
    let mut engine = Engine::from_scene(scene);
    engine.seek(Time::ZERO).unwrap();
    let z = |name| place(engine.world(), crate::named(&engine, name)).affine.matrix3.z_axis;
    for (name, expected) in [
        ("a/eye", DVec3::new(1.0, 2.0, 3.0)),
        ("b/eye", DVec3::new(1.0, 2.0, 3.0)),
        ("outer", DVec3::new(6.0, 2.0, 3.0)),
        ("made", DVec3::new(1.0, 2.0, 3.0)),
        ("point", DVec3::Y),
    ] {
        close(z(name), expected);
    }
}

/// Checks that a light with a target is one value of the world, which systems can write.
#[test]
fn systems_write_targets() {
    let mut world = World::new();
    let spot = world.spawn((Light::spot(0.5, 0.0, Rgb::ONE), Transform::IDENTITY, Target(DVec3::X)));
    world.spawn((FilmSettings::new(3, 3),));
    let mut engine = Engine::new(world);
    engine.add_system(move |context| {
        context.world.get::<&mut Target>(spot).unwrap().0 = DVec3::new(context.time.seconds(), 0.0, 1.0);
        context.changes.mark_transform(spot);
    });
    for seconds in [2, 0, 1] {
        engine.seek(Time::from_ratio(seconds, 1).unwrap()).unwrap();
        let z = place(engine.world(), spot).affine.matrix3.z_axis;
        close(z, DVec3::new(Time::from_ratio(seconds, 1).unwrap().seconds(), 0.0, 1.0));
        let target = rayreel::systems::value(engine.world(), spot, Property::Target);
        assert!(target.is_some());
    }
}
