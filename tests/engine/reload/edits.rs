//! Tests of random edits, against engines that start from each edited scene.

use std::fs;

use tempfile::TempDir;

use rayreel::components::{Light, Material, Shape, Transform};
use rayreel::scene::Reader;
use rayreel::{Context, Engine, Rgb, Scene, Step, Time};

use super::described::{bits, described};
use super::model::Model;
use super::random::Random;

const EDITS: usize = 10;

#[test]
fn edits_equal_a_cold_start() {
    let cases = std::env::var("RAYREEL_CASES").ok().and_then(|cases| cases.parse().ok()).unwrap_or(500);
    let mut tally = Tally::default();
    for seed in 0..cases {
        sequence(seed, |_| (), &mut tally);
    }
    // Enough edits must be valid, invalid, without effect on the BVH, and of scenes that extend another.
    let edits = usize::try_from(cases).unwrap() * EDITS;
    assert!(tally.reloads > edits * 6 / 10 && tally.broken > edits / 20, "{tally:?}");
    assert!(tally.kept_bvhs > edits / 5 && tally.extended > edits / 5, "{tally:?}");
}

#[test]
fn custom_systems_restart_after_a_reload() {
    for seed in 0..20 {
        sequence(1_000_000 + seed, add_systems, &mut Tally::default());
    }
}

#[derive(Debug, Default)]
struct Tally {
    reloads: usize,
    /// Number of edits that made the scene invalid.
    broken: usize,
    /// Number of frames after an edit that needed no BVH build.
    kept_bvhs: usize,
    /// Number of valid edits of a scene that extends another, or of its base.
    extended: usize,
}

/// Edits a random scene repeatedly, in an engine that reloads it and in engines that start from each version.
fn sequence(seed: u64, prepare: impl Fn(&mut Engine), tally: &mut Tally) {
    let random = &mut Random(seed);
    let folder = tempfile::tempdir().unwrap();
    let mut model = Model::new(random);
    let mut reader = Reader::new();
    let scene = loop {
        if let Some(scene) = load(&model, &folder, &mut reader) {
            break scene;
        }
        model = Model::new(random);
    };
    let mut engine = Engine::from_scene(scene);
    prepare(&mut engine);
    for step in 0..EDITS {
        let mut edited = model.clone();
        edited.edit(random);
        if random.once_in(3) {
            edited.edit(random);
        }
        let about = || format!("seed {seed}, edit {step}: {}", edited.files().0);
        if let Some(scene) = load(&edited, &folder, &mut reader) {
            engine.reload(scene);
            tally.reloads += 1;
            tally.extended += usize::from(edited.files().0.contains("  extends: "));
            let mut cold = Engine::load(folder.path().join("scene.ron")).unwrap();
            prepare(&mut cold);
            assert_eq!(engine.timeline, cold.timeline, "{}", about());
            assert_same(&described(engine.world(), false), &described(cold.world(), false), &about);
            if !random.once_in(4) {
                compare(&mut engine, &mut cold, random, tally, &about);
            }
            model = edited;
        } else {
            tally.broken += 1;
        }
        if random.once_in(6) {
            edit_world(&mut engine, random);
        }
    }
}

/// Loads the scene of a model with a reader that has read earlier versions. Its errors must equal the errors of a fresh reader.
fn load(model: &Model, folder: &TempDir, reader: &mut Reader) -> Option<Scene> {
    let (text, files) = model.files();
    for (name, text) in files.into_iter().chain([("scene.ron", text)]) {
        fs::write(folder.path().join(name), text).unwrap();
    }
    let path = folder.path().join("scene.ron");
    match reader.load(&path) {
        Ok((scene, _)) => Some(scene),
        Err(error) => {
            let expected = Scene::load(&path).err().map(|expected| expected.to_string());
            assert_eq!(Some(error.to_string()), expected, "{}", model.files().0);
            None
        }
    }
}

/// Compares worlds and pictures at some times.
fn compare(
    engine: &mut Engine,
    cold: &mut Engine,
    random: &mut Random,
    tally: &mut Tally,
    about: &impl Fn() -> String,
) {
    for _ in 0..=random.index(2) {
        let time = Time::from_ratio(random.bits() % 24, 10).unwrap();
        match (engine.render(time), cold.render(time)) {
            (Ok(film), Ok(expected)) => {
                assert_eq!(bits(&film.film), bits(&expected.film), "at {time:?}, {}", about());
                let plans = [engine.report().plan.as_ref(), cold.report().plan.as_ref()]
                    .map(|plan| format!("{plan:?}"));
                assert_eq!(plans[0], plans[1], "{}", about());
                tally.kept_bvhs += usize::from(engine.report().bvh_builds == 0);
            }
            (Err(error), Err(expected)) => assert_eq!(error.to_string(), expected.to_string(), "{}", about()),
            (found, _) => {
                panic!("only one engine makes a frame, the reloaded one: {}, {}", found.is_ok(), about())
            }
        }
        if engine.seek(time).is_ok() && cold.seek(time).is_ok() {
            assert_same(&described(engine.world(), true), &described(cold.world(), true), about);
        }
    }
}

fn assert_same(world: &[String], expected: &[String], about: &impl Fn() -> String) {
    for (found, expected) in world.iter().zip(expected) {
        assert_eq!(found, expected, "{}", about());
    }
    assert_eq!(world.len(), expected.len(), "{}", about());
}

/// Changes the world in ways that no scene file describes.
fn edit_world(engine: &mut Engine, random: &mut Random) {
    let world = engine.world_mut();
    let mut entities: Vec<_> = world.iter().map(|entity| entity.entity()).collect();
    entities.sort();
    let entity = entities[random.index(entities.len())];
    match random.index(4) {
        0 => world.despawn(entity).unwrap(),
        1 => world.insert_one(entity, "a note").unwrap(),
        2 => {
            let _ = world.remove_one::<Transform>(entity);
        }
        _ => {
            world.spawn(ball(random.number()));
        }
    }
}

fn ball(x: f64) -> (Shape, Material, Transform) {
    let material = Material {
        k_a: 1.0,
        k_d: 0.5,
        color: Rgb::new(1.0, 0.5, 0.25),
        ambient_color: None,
        metallic: false,
    };
    (Shape::Sphere { radius: 0.5 }, material, Transform::at(x, 0.5, 0.0))
}

/// Adds a stepped system that spawns entities, and a system that is a function of time.
fn add_systems(engine: &mut Engine) {
    engine.register::<&'static str>();
    engine.add_stepped_system(Step::per_second(2), |context: &mut Context<'_>| {
        for transform in context.world.query_mut::<&mut Transform>() {
            transform.translation.y += 0.125;
        }
        for x in [-1.0, 0.0, 0.25] {
            context.world.spawn(ball(x));
        }
        context.world.spawn((Light::point(Rgb::splat(0.25)), Transform::at(0.0, 4.0, -4.0)));
    });
    engine.add_system(|context: &mut Context<'_>| {
        let sideways = 0.25 * context.time.seconds();
        for (transform, _) in context.world.query_mut::<(&mut Transform, &Shape)>() {
            transform.translation.x += sideways;
        }
    });
}
