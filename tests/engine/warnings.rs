//! Tests that warnings about images are true: random scenes, compared with their images.

use glam::{DQuat, DVec3};

use rayreel::components::{
    Ambient, AreaShape, Camera, FilmSettings, Light, LightKind, Material, Quality, Reflective, Refractive,
    Sampling, Shape, Transform, Visibility,
};
use rayreel::systems::{Consequence, OneColor};
use rayreel::{Engine, Rgb, Scene, World};

use crate::splitmix::Random;

/// Returns a number from -1 to 1 in steps of 1/8, so that shapes often touch, contain or hide each other.
fn coordinate(random: &mut Random) -> f64 {
    (random.index(17) as f64 - 8.0) / 8.0
}

fn vector(random: &mut Random, size: f64) -> DVec3 {
    DVec3::from_array([(); 3].map(|()| size * coordinate(random)))
}

fn direction(random: &mut Random) -> DVec3 {
    let vector = vector(random, 1.0);
    if vector == DVec3::ZERO { DVec3::Y } else { vector }
}

fn light(random: &mut Random) -> Light {
    let kind = match random.index(5) {
        0 => LightKind::Directional { direction: direction(random) },
        1 => LightKind::Spot { angle: 0.2 + 0.3 * random.index(9) as f64, softness: 0.5 },
        2 => LightKind::Area { shape: AreaShape::Sphere { radius: 0.25 }, samples: 2 },
        3 => LightKind::Area { shape: AreaShape::Rectangle { width: 1.0, height: 0.5 }, samples: 2 },
        _ => LightKind::Point,
    };
    Light { casts_shadows: !random.once_in(8), ..Light::new(kind, Rgb::splat(0.75)) }
}

fn world(random: &mut Random) -> World {
    let mut world = World::new();
    let clay = Material { k_a: 0.25, k_d: if random.once_in(8) { 0.0 } else { 0.75 }, ..Material::default() };
    for _ in 0..random.index(6) {
        let shape = match random.index(5) {
            4 => Shape::Capsule { radius: 0.5, from: DVec3::ZERO, to: direction(random) },
            0 => Shape::Plane { normal: direction(random) },
            1 => Shape::Box { size: DVec3::splat(0.5 + random.index(30) as f64) },
            _ => Shape::Sphere { radius: 0.125 * (1 + random.index(30)) as f64 },
        };
        let place = Transform {
            translation: vector(random, 6.0),
            rotation: DQuat::from_axis_angle(direction(random).normalize(), coordinate(random)),
            ..Transform::IDENTITY
        };
        let entity = world.spawn((shape, clay, place));
        match random.index(8) {
            0 => world.insert_one(entity, Refractive { k_t: 0.5, ..Refractive::GLASS }).unwrap(),
            1 => world.insert_one(entity, Reflective::MIRROR).unwrap(),
            2 => world.insert_one(entity, light(random)).unwrap(),
            3 => {
                let [camera, secondary, shadow] = [(); 3].map(|()| random.once_in(2));
                world.insert_one(entity, Visibility { camera, secondary, shadow }).unwrap();
            }
            _ => {}
        }
    }
    for _ in 0..random.index(4) {
        world.spawn((light(random), Transform { translation: vector(random, 6.0), ..Transform::IDENTITY }));
    }
    world.spawn((Camera::looking_at(vector(random, 8.0) + DVec3::splat(0.01), vector(random, 2.0)),));
    if random.once_in(3) {
        world.spawn((Ambient(Rgb::ONE),));
    }
    // A light that is on raises the bounds by which rays are cut off.
    let quality = Quality { cutoff: 0.0, ..Quality::default() };
    world.spawn((FilmSettings::new(16, 9), Sampling { samples: 4, ..Sampling::default() }, quality));
    world
}

#[test]
fn warnings_about_images_are_true() {
    let (mut idle, mut black, mut colored) = (0, 0, 0);
    for seed in 0..2000 {
        let mut engine = Engine::new(world(&mut Random(seed)));
        let film = engine.render_frame(0).unwrap();
        let faults = engine.faults();
        let first = film.pixels()[0];
        let expected =
            film.pixels().iter().all(|pixel| *pixel == first).then_some(match first == Rgb::ZERO {
                true => OneColor::Black,
                false => OneColor::Other,
            });
        let found = faults.iter().find_map(|fault| match fault.consequence {
            Consequence::OneColor(color) => Some(color),
            _ => None,
        });
        let is_cut_off = faults.iter().any(|fault| fault.consequence == Consequence::CutOff);
        assert!(found == expected || found.is_none() && is_cut_off, "{seed}: {found:?}, not {expected:?}");
        black += u32::from(found == Some(OneColor::Black));
        colored += u32::from(found == Some(OneColor::Other));

        // A light that lights nothing in view can be turned off.
        for fault in faults.iter().filter(|fault| fault.consequence == Consequence::ReachesNothing) {
            engine.world_mut().get::<&mut Light>(fault.entity).unwrap().intensity = Rgb::ZERO;
            assert!(engine.render_frame(0).unwrap() == film, "{seed}: {fault}");
            idle += 1;
        }
    }
    println!("{idle} idle lights, {black} black images, {colored} of another colour");
    assert!(idle > 100 && black > 100 && colored > 10);
}

/// Checks that a film may start black: such a frame is a fault of a sequence only if all frames are black.
#[test]
fn sequences_report_black_frames_if_all_are_black() {
    let folder = tempfile::tempdir().unwrap();
    let rendered = |name: &str, last: f64| {
        let text = format!(
            "(timeline: (fps: 2, duration: 1), film: (width: 8, height: 4), camera: (position: (0, 0, -3), target: (0, 0, 0)),
            entities: [(shape: Sphere(radius: 1), material: (k_a: 1))],
            animate: [(target: \"scene\", channel: Ambient, track: Keys([(0, (0, 0, 0), Hold), (0.5, ({last:?}, 0, 0))]))])"
        );
        let mut engine = Engine::from_scene(Scene::from_text("fade.ron", text).unwrap());
        let report = engine.render_to(folder.path().join(name)).unwrap();
        assert_eq!(report.written, 2);
        report.faults.iter().map(|found| (found.fault.consequence, found.frames)).collect::<Vec<_>>()
    };
    assert_eq!(rendered("fade", 1.0), []);
    assert_eq!(rendered("dark", 0.0), [(Consequence::OneColor(OneColor::Black), 2)]);
}
