//! Tests of coincident shapes: pictures equal the reference bit for bit, at the cost of one shape.

use std::sync::atomic::{AtomicBool, Ordering};
use std::thread;
use std::time::{Duration, Instant};

use glam::{DQuat, DVec3};
use proptest::prelude::*;
use proptest::test_runner::RngSeed;

use rayreel::components::{
    Ambient, AreaShape, Camera, FilmSettings, Light, LightKind, Material, Quality, Reflective, Refractive,
    Sampling, Shape, Transform, View,
};
use rayreel::trace::Signals;
use rayreel::{Engine, EngineError, Film, RenderRequest, RenderSettings, Rgb, Time, World};

/// The material of one shape of a heap, which may also be a lamp.
#[derive(Clone, Debug)]
struct Member {
    color: f32,
    clear: Option<Refractive>,
    mirror: bool,
    lamp: bool,
}

/// Equal, coincident shapes. In document order, the shapes of several heaps alternate.
#[derive(Clone, Debug)]
struct Heap {
    shape: Shape,
    transform: Transform,
    members: Vec<Member>,
}

fn member() -> impl Strategy<Value = Member> {
    let clear = (prop_oneof![Just(1.0f32), 0.2..1.0f32], prop_oneof![Just(1.0), Just(1.5)], 0.0..2.0f32);
    let clear = clear.prop_map(|(k_t, ior, absorption)| Refractive {
        k_t,
        ior,
        absorption: Rgb::new(absorption, 0.0, 0.1),
        fresnel: false,
    });
    (0.1..1.0f32, prop::option::weighted(0.6, clear), prop::bool::weighted(0.2), prop::bool::weighted(0.15))
        .prop_map(|(color, clear, mirror, lamp)| Member { color, clear, mirror, lamp })
}

/// Generates heaps with few positions and sizes, so that different heaps often share faces and positions, too.
fn heap() -> impl Strategy<Value = Heap> {
    let size = || prop_oneof![Just(1.0), Just(2.0)];
    let shape = prop_oneof![
        3 => size().prop_map(|radius| Shape::Sphere { radius }),
        3 => (size(), size(), size()).prop_map(|size| Shape::Box { size: size.into() }),
        2 => (size(), size()).prop_map(|(radius, size)| Shape::Cylinder { radius, from: DVec3::ZERO, to: DVec3::Y * size }),
        2 => (size(), size()).prop_map(|(radius, size)| Shape::Capsule { radius, from: DVec3::ZERO, to: DVec3::Y * size }),
        1 => prop_oneof![Just(DVec3::Y), Just(DVec3::new(1.0, 2.0, 3.0))].prop_map(|normal| Shape::Plane { normal }),
    ];
    let rotation = prop_oneof![3 => Just(DQuat::IDENTITY), 1 => Just(DQuat::from_rotation_y(0.3))];
    let scale = prop_oneof![3 => Just(DVec3::ONE), 1 => Just(DVec3::new(1.0, 0.5, 1.5))];
    let place = prop_oneof![2 => Just(0.0), 1 => Just(1.0), 1 => Just(-0.5)];
    let place = (place.clone(), place.clone(), place).prop_map(|(x, y, z)| DVec3::new(x, y, z));
    let transform = (place, rotation, scale).prop_map(|(translation, rotation, scale)| Transform {
        translation,
        rotation,
        scale,
    });
    let members = prop::collection::vec(member(), 1..9);
    (shape, transform, members).prop_map(|(shape, transform, members)| Heap { shape, transform, members })
}

fn scenery(eye: DVec3, samples: u32) -> World {
    let mut world = World::new();
    world.spawn((Camera { position: eye, view: View::Target(DVec3::ZERO), ..Camera::default() },));
    world.spawn((
        FilmSettings { width: 20, height: 12, ..FilmSettings::default() },
        Ambient(Rgb::splat(0.4)),
        Quality { depth: 5, cutoff: 0.0 },
        Sampling { samples, ..Sampling::default() },
    ));
    let sun = LightKind::Directional { direction: DVec3::new(1.0, -2.0, 0.5) };
    world.spawn((Light::new(sun, Rgb::splat(0.7)), Transform::IDENTITY));
    world
}

fn clay(color: f32) -> Material {
    Material {
        k_a: 0.3,
        k_d: 0.6,
        color: Rgb::new(color, 0.5, 1.0 - color),
        ambient_color: None,
        metallic: false,
    }
}

fn world(heaps: &[Heap], eye: DVec3, samples: u32) -> World {
    let mut world = scenery(eye, samples);
    let most = heaps.iter().map(|heap| heap.members.len()).max().unwrap_or(0);
    for turn in 0..most {
        for heap in heaps {
            let Some(member) = heap.members.get(turn) else { continue };
            let entity = world.spawn((heap.shape, heap.transform, clay(member.color)));
            if let Some(clear) = member.clear {
                world.insert_one(entity, clear).unwrap();
            }
            if member.mirror {
                world.insert_one(entity, Reflective { k_r: 0.4 }).unwrap();
            }
            if member.lamp {
                world.insert_one(entity, Light::new(LightKind::Point, Rgb::splat(0.5))).unwrap();
            }
        }
    }
    world
}

fn first_frame(engine: &mut Engine) -> Film {
    engine.render(Time::ZERO).unwrap().film
}

proptest! {
    #![proptest_config(ProptestConfig {
        cases: 300,
        failure_persistence: None,
        rng_seed: RngSeed::Fixed(2026),
        ..ProptestConfig::default()
    })]

    /// Checks heaps against the reference path, which intersects every shape by itself.
    #[test]
    fn stacked_shapes_equal_a_linear_scan(
        heaps in prop::collection::vec(heap(), 1..5),
        eye in prop_oneof![
            3 => Just(DVec3::new(0.5, 1.0, -5.0)),
            1 => Just(DVec3::new(0.1, 0.2, 0.3)),
            1 => Just(DVec3::new(0.0, 0.0, -1.0)),
        ],
        samples in prop_oneof![3 => Just(1u32), 1 => Just(2)],
    ) {
        let mut engine = Engine::new(world(&heaps, eye, samples));
        let reference = engine.render(RenderRequest { reference: true, ..RenderRequest::at(Time::ZERO) }).unwrap().film;
        prop_assert!(first_frame(&mut engine) == reference, "planned");
        engine.settings = RenderSettings { all_effects: true, ..engine.settings };
        prop_assert!(first_frame(&mut engine) == reference, "full");
    }

    /// Checks that only the first of coincident opaque shapes is visible, and that the others cause no rays and no escalations.
    #[test]
    fn opaque_coincident_shapes_look_like_the_first(heaps in prop::collection::vec(heap(), 1..4)) {
        let opaque = |heap: &Heap| {
            let members = heap.members.iter().map(|member| Member { clear: None, lamp: false, ..member.clone() });
            Heap { members: members.collect(), ..heap.clone() }
        };
        let alone = |heap: &Heap| Heap { members: heap.members[..1].to_vec(), ..heap.clone() };
        let heaps: Vec<Heap> = heaps.iter().map(opaque).collect();
        let firsts: Vec<Heap> = heaps.iter().map(alone).collect();
        let eye = DVec3::new(0.5, 1.0, -5.0);
        let (mut all, mut first) = (Engine::new(world(&heaps, eye, 1)), Engine::new(world(&firsts, eye, 1)));
        // A plan detects that a single plane casts no shadow, but does not detect coincident planes.
        all.settings = RenderSettings { all_effects: true, ..all.settings };
        first.settings = RenderSettings { all_effects: true, ..first.settings };
        prop_assert!(first_frame(&mut all) == first_frame(&mut first));
        prop_assert_eq!(all.report().escalations, first.report().escalations);
        prop_assert_eq!(all.report().rays, first.report().rays);
    }
}

/// Checks that coincident shapes of any kind and material are compared once. Each further comparison would need a hundred bits.
#[test]
fn rays_test_coincident_shapes_once() {
    let glass = Refractive { k_t: 0.9, ior: 1.5, absorption: Rgb::ZERO, fresnel: false };
    let shapes = [
        Shape::Sphere { radius: 1.0 },
        Shape::Box { size: DVec3::ONE },
        Shape::Plane { normal: DVec3::new(0.1, 0.2, -1.0) },
        Shape::Cylinder { radius: 0.5, from: DVec3::NEG_Y, to: DVec3::Y },
        Shape::Capsule { radius: 0.5, from: DVec3::NEG_X, to: DVec3::Y },
    ];
    let maps = [
        Transform::IDENTITY,
        Transform { rotation: DQuat::from_rotation_x(0.4), ..Transform::IDENTITY },
        Transform { scale: DVec3::new(1.0, 2.0, 0.5), ..Transform::IDENTITY },
    ];
    for (shape, transform) in shapes.into_iter().flat_map(|shape| maps.map(|map| (shape, map))) {
        for clear in [None, Some(glass)] {
            let questions = |count: usize| {
                let mut world = scenery(DVec3::new(0.3, 0.4, -5.0), 1);
                for _ in 0..count {
                    let entity = world.spawn((shape, transform, clay(0.5)));
                    if let Some(glass) = clear {
                        world.insert_one(entity, glass).unwrap();
                    }
                }
                let mut engine = Engine::new(world);
                first_frame(&mut engine);
                engine.report().escalations.contested
            };
            let (few, many) = (questions(2), questions(300));
            assert!(many <= few + few / 2 + 64, "{shape:?}, {transform:?}, {clear:?}: {few} became {many}");
        }
    }
}

/// Checks cancellation within a single pixel that takes minutes: thousands of shapes so close together that only a hundred bits can order
/// them, lit by a light with four thousand samples.
#[test]
fn a_picture_can_be_cancelled_within_a_pixel() {
    let mut world = scenery(DVec3::new(0.0, 0.0, -5.0), 1);
    for film in world.query_mut::<&mut FilmSettings>() {
        *film = FilmSettings { width: 1, height: 1, ..*film };
    }
    let lamp =
        LightKind::Area { shape: AreaShape::Sphere { radius: 0.5 }, samples: AreaShape::LARGEST_SAMPLES };
    world.spawn((Light::new(lamp, Rgb::ONE), Transform::from_translation(DVec3::new(2.0, 3.0, -4.0))));
    for index in 0..30_000 {
        let radius = 1.0 + f64::from(index) * f64::EPSILON;
        let glass = Refractive { k_t: 0.999, ior: 1.0, absorption: Rgb::ZERO, fresnel: false };
        world.spawn((Shape::Sphere { radius }, Transform::IDENTITY, clay(0.5), glass));
    }
    let mut engine = Engine::new(world);
    engine.seek(Time::ZERO).unwrap();
    let cancelled = AtomicBool::new(false);
    // Other tests may keep the common threads busy for longer than this takes.
    let own = rayon::ThreadPoolBuilder::new().num_threads(2).build().unwrap();
    thread::scope(|scope| {
        let rendering = scope.spawn(|| {
            let signals = Signals::unless(&cancelled);
            let image =
                own.install(|| engine.render(RenderRequest { signals, ..RenderRequest::at(Time::ZERO) }));
            (image, Instant::now())
        });
        thread::sleep(Duration::from_millis(300));
        let asked = Instant::now();
        cancelled.store(true, Ordering::Relaxed);
        let (image, ended) = rendering.join().unwrap();
        assert!(matches!(image, Err(EngineError::Cancelled)), "the picture took less than it should");
        let took = ended.saturating_duration_since(asked);
        // An idle machine takes a fifth of a second.
        assert!(took < Duration::from_secs(2), "{took:?}");
    });
}
