//! The fast path against the reference path, on random scenes: the same pictures, bit for bit, and never a number that is
//! not finite.

#![allow(clippy::unwrap_used, clippy::print_stdout, reason = "a test may fail loudly")]

use glam::{DQuat, DVec3};
use proptest::prelude::*;
use proptest::test_runner::RngSeed;

use rayreel::components::{
    Ambient, Background, Camera, Falloff, FilmSettings, Lens, Light, LightKind, Material, Projection,
    Quality, Reflective, Sampling, Shape, Specular, Transform, View,
};
use rayreel::{Engine, Rgb, Time, World};

#[derive(Clone, Debug)]
struct Thing {
    shape: Shape,
    transform: Transform,
    color: [f32; 3],
    /// k_d; 0 leaves highlights alone.
    diffuse: f32,
    specular: Option<Specular>,
    mirror: bool,
}

/// Coordinates that often coincide, so that faces are flush, shapes equal and origins on surfaces.
fn coordinate() -> impl Strategy<Value = f64> {
    prop_oneof![3 => (-4i32..=4).prop_map(f64::from), 2 => -4.0..4.0f64, 1 => (-8i32..=8).prop_map(|half| f64::from(half) / 2.0)]
}

fn point() -> impl Strategy<Value = DVec3> {
    (coordinate(), coordinate(), coordinate()).prop_map(DVec3::from)
}

fn length() -> impl Strategy<Value = f64> {
    prop_oneof![4 => Just(1.0), 2 => 0.05..3.0f64, 1 => Just(1e-6), 1 => Just(1e7)]
}

fn shape() -> impl Strategy<Value = Shape> {
    prop_oneof![
        3 => length().prop_map(|radius| Shape::Sphere { radius }),
        3 => (length(), length(), length()).prop_map(|size| Shape::Box { size: size.into() }),
        1 => prop_oneof![Just(DVec3::Y), Just(DVec3::X), point()].prop_map(|normal| Shape::Plane {
            normal: if normal == DVec3::ZERO { DVec3::Z } else { normal },
        }),
    ]
}

fn transform() -> impl Strategy<Value = Transform> {
    let rotation = prop_oneof![2 => Just(DQuat::IDENTITY), 1 => (point(), coordinate()).prop_map(|(axis, w)| {
        DQuat::from_xyzw(axis.x, axis.y, axis.z, w + 0.1).normalize()
    })];
    let scale = prop_oneof![3 => Just(DVec3::ONE), 1 => Just(DVec3::splat(-0.5)), 1 => (0.1..2.0f64, 0.1..2.0f64, -2.0..-0.1f64).prop_map(DVec3::from)];
    (point(), rotation, scale).prop_map(|(translation, rotation, scale)| Transform {
        translation,
        rotation,
        scale,
    })
}

fn specular() -> impl Strategy<Value = Option<Specular>> {
    let exponent = prop_oneof![Just(0.0), Just(1.0), 1.0..200.0f32, Just(Specular::LARGEST_SHININESS)];
    let some = (prop_oneof![Just(0.0), 0.1..1.0f32], exponent);
    prop::option::of(some.prop_map(|(k_s, shininess)| Specular { k_s, shininess }))
}

fn things() -> impl Strategy<Value = Vec<Thing>> {
    let diffuse = prop_oneof![1 => Just(0.0), 3 => Just(0.7f32)];
    let surface = ([0.0..1.0f32, 0.0..1.0, 0.0..1.0], diffuse, specular(), any::<bool>());
    let thing = (shape(), transform(), surface).prop_map(|(shape, transform, surface)| {
        let (color, diffuse, specular, mirror) = surface;
        Thing { shape, transform, color, diffuse, specular, mirror }
    });
    prop::collection::vec(thing, 0..40)
}

/// A light, and where it is.
fn light() -> impl Strategy<Value = (Light, Transform)> {
    let falloff =
        prop_oneof![Just((1.0, 0.0, 0.0)), Just((1e-300, 0.0, 0.0)), (0.1..1.0, 0.0..1.0, 0.0..1.0f64)]
            .prop_map(|(constant, linear, quadratic)| Falloff { constant, linear, quadratic });
    let options = (prop::bool::weighted(0.8), prop::option::of(falloff));
    let kind = prop_oneof![
        Just(LightKind::Point),
        point().prop_map(|direction| LightKind::Directional { direction }),
        (0.1..3.2f64, prop_oneof![Just(0.0), Just(1.0), 0.0..1.0])
            .prop_map(|(angle, softness)| LightKind::Spot { angle, softness }),
    ];
    (kind, options, transform()).prop_map(|(kind, (casts_shadows, falloff), transform)| {
        (Light { casts_shadows, falloff, ..Light::new(kind, Rgb::splat(0.6)) }, transform)
    })
}

fn world(things: &[Thing], lights: &[(Light, Transform)], eye: DVec3, samples: u32) -> World {
    let mut world = World::new();
    for Thing { shape, transform, color, diffuse, specular, mirror } in things {
        let color = Rgb::from_array(*color);
        let material = Material { k_a: 0.3, k_d: *diffuse, color, ambient_color: None };
        let entity = world.spawn((*shape, *transform, material));
        if let Some(specular) = specular {
            world.insert_one(entity, *specular).unwrap();
        }
        if *mirror {
            world.insert_one(entity, Reflective { k_r: 0.5 }).unwrap();
        }
    }
    for light in lights {
        world.spawn(*light);
    }
    let projection = Projection::FieldOfView { vertical: 1.2 };
    world.spawn((Camera {
        position: eye,
        view: View::Target(DVec3::new(0.0, 0.5, 0.0)),
        up: DVec3::Y,
        projection,
        lens: (samples > 2).then_some(Lens { aperture: 0.3, focus: 4.0 }),
    },));
    world.spawn((
        FilmSettings { width: 32, height: 18, ..FilmSettings::default() },
        Ambient(Rgb::splat(0.4)),
        Background(Rgb::new(0.1, 0.2, 0.3)),
        Quality { depth: 4 },
        Sampling { samples, ..Sampling::default() },
    ));
    world
}

/// `RAYREEL_CASES` asks for more than the usual few hundred.
fn cases() -> u32 {
    std::env::var("RAYREEL_CASES").ok().and_then(|cases| cases.parse().ok()).unwrap_or(400)
}

/// The same cases every time, unless more of them are asked for.
fn seed() -> RngSeed {
    if std::env::var_os("RAYREEL_CASES").is_some() { RngSeed::Random } else { RngSeed::Fixed(2026) }
}

proptest! {
    #![proptest_config(ProptestConfig { cases: cases(), failure_persistence: None, rng_seed: seed(), ..ProptestConfig::default() })]

    #[test]
    fn fast_and_reference_paths_agree(
        things in things(),
        lights in prop::collection::vec(light(), 0..4),
        eye in point(),
        samples in prop_oneof![3 => Just(1), 1 => 2..=4u32],
    ) {
        let mut engine = Engine::new(world(&things, &lights, eye, samples));
        let fast = engine.render_at(Time::ZERO).unwrap();
        let reference = engine.render_reference(Time::ZERO).unwrap();
        prop_assert!(fast.pixels().iter().all(|pixel| pixel.is_finite()));
        for (index, (found, expected)) in fast.pixels().iter().zip(reference.pixels()).enumerate() {
            prop_assert_eq!(found, expected, "pixel ({}, {})", index % 32, index / 32);
        }
    }
}
