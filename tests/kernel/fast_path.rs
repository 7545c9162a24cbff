//! Tests with random scenes and random effects: the planned effects, all effects and the reference path make the same pictures, bit for
//! bit, at all SIMD levels of the processor and on any number of threads, and all numbers are finite.

use std::sync::LazyLock;

use glam::{DQuat, DVec3};
use proptest::prelude::*;
use proptest::test_runner::RngSeed;
use rayon::{ThreadPool, ThreadPoolBuilder};

use rayreel::animation::{Easing, Key, Track};
use rayreel::color::ColorRamp;
use rayreel::components::{
    Ambient, AmbientOcclusion, Animated, AreaShape, Background, Camera, Channel, Emission, Falloff,
    FilmSettings, Fog, Lens, Light, LightKind, Material, Pattern, PatternKind, Projection, Property, Quality,
    Reflective, Refractive, Sampling, Shape, Specular, Stars, Sun, Transform, View, Visibility,
};
use rayreel::trace::SimdLevel;
use rayreel::{Effect, Engine, Film, RenderRequest, RenderSettings, Rgb, Time, World};

/// Optional effects of a scene.
#[derive(Clone, Copy, Debug)]
struct Effects {
    lights: bool,
    mirrors: bool,
    glass: bool,
    patterns: bool,
    area_lights: bool,
    fog: bool,
    gradient: bool,
    horizon: bool,
    layer: bool,
    clear_sky: bool,
    sun: bool,
    stars: bool,
    motion: bool,
    orthographic: bool,
    hidden: bool,
    /// The distance of ambient occlusion.
    occlusion: Option<f64>,
}

#[derive(Clone, Debug)]
struct Thing {
    shape: Shape,
    transform: Transform,
    color: [f32; 3],
    /// k_d; at 0, only highlights remain.
    diffuse: f32,
    specular: Option<Specular>,
    mirror: bool,
    is_metal: bool,
    glass: Option<Refractive>,
    pattern: Option<Pattern>,
    emission: Option<Emission>,
    visibility: Option<Visibility>,
    /// Position after a second, if shapes move.
    later: DVec3,
}

/// Generates coordinates that often coincide, so that faces are flush, shapes equal and origins on surfaces.
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
        2 => (length(), prop_oneof![Just(DVec3::Y), Just(DVec3::Z), point()]).prop_map(|(radius, to)| {
            let to = if to == DVec3::ZERO { DVec3::Z } else { to };
            Shape::Cylinder { radius, from: DVec3::ZERO, to }
        }),
        2 => (length(), prop_oneof![Just(DVec3::Y), Just(DVec3::Z), point()]).prop_map(|(radius, to)| {
            let to = if to == DVec3::ZERO { DVec3::Z } else { to };
            Shape::Capsule { radius, from: -to, to }
        }),
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

fn glass() -> impl Strategy<Value = Option<Refractive>> {
    let ior = prop_oneof![3 => Just(1.5), 1 => Just(1.0), 1 => 0.5..2.5f64];
    let absorption = prop_oneof![2 => Just(Rgb::ZERO), 1 => Just(Rgb::new(0.0, 0.3, 2.0))];
    let some = (prop_oneof![1 => Just(0.0f32), 4 => 0.3..1.0f32], ior, absorption, any::<bool>());
    let some = some.prop_map(|(k_t, ior, absorption, fresnel)| Refractive { k_t, ior, absorption, fresnel });
    prop::option::weighted(0.4, some)
}

fn pattern() -> impl Strategy<Value = Option<Pattern>> {
    let size = || prop_oneof![2 => Just(1.0), 1 => 0.05..2.0f64, 1 => Just(1e-9)];
    let direction = || prop_oneof![Just(DVec3::X), Just(DVec3::Y), point().prop_map(|point| point + 0.1)];
    let kind = prop_oneof![
        size().prop_map(|size| PatternKind::Checker { size }),
        (size(), 0.0..=1.0f64, direction(), coordinate()).prop_map(|(size, ratio, direction, offset)| {
            PatternKind::Stripes { size, ratio, direction, offset }
        }),
        ((size(), size(), size()), prop_oneof![Just(0.0), 0.0..0.2f64])
            .prop_map(|(size, mortar)| PatternKind::Bricks { size: size.into(), mortar }),
        (size(), direction(), coordinate()).prop_map(|(size, direction, offset)| PatternKind::Gradient {
            size,
            direction,
            offset
        }),
        (size(), 1..=6u32, 0.0..5.0f64).prop_map(|(size, octaves, contrast)| PatternKind::Noise {
            size,
            octaves,
            contrast
        }),
    ];
    prop::option::of(kind.prop_map(|kind| Pattern { color: Rgb::new(0.9, 0.1, 0.4), kind }))
}

fn emission() -> impl Strategy<Value = Option<Emission>> {
    let light =
        prop_oneof![1 => Just(Rgb::ZERO), 3 => Just(Rgb::new(2.5, 0.3, 0.0)), 1 => Just(Rgb::splat(1e30))];
    prop::option::weighted(0.3, light.prop_map(Emission))
}

fn visibility() -> impl Strategy<Value = Option<Visibility>> {
    let some = any::<[bool; 3]>();
    let some = some.prop_map(|[camera, secondary, shadow]| Visibility { camera, secondary, shadow });
    prop::option::weighted(0.3, some)
}

fn things() -> impl Strategy<Value = Vec<Thing>> {
    let diffuse = prop_oneof![1 => Just(0.0), 3 => Just(0.7f32)];
    let surface = (
        [0.0..1.0f32, 0.0..1.0, 0.0..1.0],
        diffuse,
        specular(),
        (any::<bool>(), any::<bool>()),
        glass(),
        (pattern(), emission(), visibility()),
    );
    let thing = (shape(), transform(), surface, point()).prop_map(|(shape, transform, surface, later)| {
        let (color, diffuse, specular, (mirror, is_metal), glass, (pattern, emission, visibility)) = surface;
        Thing {
            shape,
            transform,
            color,
            diffuse,
            specular,
            mirror,
            is_metal,
            glass,
            pattern,
            emission,
            visibility,
            later,
        }
    });
    prop::collection::vec(thing, 0..40)
}

fn effects() -> impl Strategy<Value = Effects> {
    let some = prop::bool::weighted;
    let surroundings = (some(0.3), some(0.3), some(0.5), some(0.5), some(0.3), some(0.2), some(0.2));
    let distance = prop_oneof![Just(1.0), 0.1..6.0f64, Just(1e-7), Just(1e9)];
    let hidden = (some(0.4), prop::option::weighted(0.4, distance));
    (some(0.85), some(0.5), some(0.4), some(0.3), some(0.3), surroundings, some(0.25), some(0.2), hidden)
        .prop_map(
            |(
                lights,
                mirrors,
                glass,
                patterns,
                area_lights,
                (fog, gradient, horizon, layer, clear_sky, sun, stars),
                motion,
                orthographic,
                (hidden, occlusion),
            )| Effects {
                lights,
                mirrors,
                glass,
                patterns,
                area_lights,
                fog,
                gradient,
                horizon,
                layer,
                clear_sky,
                sun,
                stars,
                motion,
                orthographic,
                hidden,
                occlusion,
            },
        )
}

/// Generates a light and its transform.
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
        (0.0..1.0f64, 1..4u32)
            .prop_map(|(radius, samples)| LightKind::Area { shape: AreaShape::Sphere { radius }, samples }),
        (0.0..3.0f64, 1..4u32).prop_map(|(width, samples)| {
            LightKind::Area { shape: AreaShape::Rectangle { width, height: 0.5 }, samples }
        }),
    ];
    (kind, options, transform()).prop_map(|(kind, (casts_shadows, falloff), transform)| {
        (Light { casts_shadows, falloff, ..Light::new(kind, Rgb::splat(0.6)) }, transform)
    })
}

fn world(
    effects: Effects,
    things: &[Thing],
    lights: &[(Light, Transform)],
    eye: DVec3,
    samples: u32,
    cutoff: f32,
) -> World {
    let mut world = World::new();
    for thing in things {
        let color = Rgb::from_array(thing.color);
        let material =
            Material { k_a: 0.3, k_d: thing.diffuse, color, ambient_color: None, metallic: thing.is_metal };
        let entity = world.spawn((thing.shape, thing.transform, material));
        if let Some(specular) = thing.specular {
            world.insert_one(entity, specular).unwrap();
        }
        if thing.mirror && effects.mirrors {
            world.insert_one(entity, Reflective { k_r: 0.5 }).unwrap();
        }
        if let Some(glass) = thing.glass.filter(|_| effects.glass) {
            world.insert_one(entity, glass).unwrap();
        }
        if let Some(pattern) = thing.pattern.filter(|_| effects.patterns) {
            world.insert_one(entity, pattern).unwrap();
        }
        if let Some(emission) = thing.emission {
            world.insert_one(entity, emission).unwrap();
        }
        if let Some(visibility) = thing.visibility.filter(|_| effects.hidden) {
            world.insert_one(entity, visibility).unwrap();
        }
        if effects.motion {
            let key = |time, value| Key { time, value, easing: Easing::Linear };
            let track = Track::new(vec![key(0.0, thing.transform.translation), key(1.0, thing.later)]);
            world
                .insert_one(entity, Animated(vec![Channel::new(Property::Translation, track.unwrap())]))
                .unwrap();
        }
    }
    for (light, transform) in lights.iter().filter(|_| effects.lights) {
        let is_area = matches!(light.kind, LightKind::Area { .. });
        if effects.area_lights || !is_area {
            world.spawn((*light, *transform));
        }
    }
    let projection = match effects.orthographic {
        true => Projection::Orthographic { height: 6.0 },
        false => Projection::FieldOfView { vertical: 1.2 },
    };
    world.spawn((Camera {
        position: eye,
        view: View::Target(DVec3::new(0.0, 0.5, 0.0)),
        up: DVec3::Y,
        roll: 0.0,
        projection,
        lens: (samples > 2).then_some(Lens { aperture: 0.3, focus: 4.0 }),
        shutter: effects.motion.then_some(0.5),
    },));
    let flat = Background::Flat(Rgb::new(0.1, 0.2, 0.3));
    let gradient = Background::Gradient {
        bottom: Rgb::new(0.3, 0.2, 0.1),
        horizon: effects.horizon.then_some(Rgb::new(0.9, 0.8, 0.7)),
        top: Rgb::new(0.1, 0.4, 0.9),
    };
    let stops = [(-0.7, Rgb::X), (-0.1, Rgb::new(0.3, 0.2, 0.1)), (0.05, Rgb::splat(0.9)), (0.8, Rgb::Z)];
    let stops = ColorRamp::new(&stops).map(Background::Stops).unwrap();
    let gradient = if effects.clear_sky { stops } else { gradient };
    let settings = world.spawn((
        FilmSettings { width: 32, height: 18, ..FilmSettings::default() },
        Ambient(Rgb::splat(0.4)),
        if effects.gradient { gradient } else { flat },
        Quality { depth: 4, cutoff },
        Sampling { samples, instants: 3, ..Sampling::default() },
    ));
    if let Some(distance) = effects.occlusion {
        world.insert_one(settings, AmbientOcclusion { samples: 1 + samples, distance }).unwrap();
    }
    if effects.sun {
        let sun = Sun::new(DVec3::new(0.2, 0.5, 1.0), Rgb::new(9.0, 7.0, 5.0));
        world.insert_one(settings, Sun { size: 0.4, glow: 0.1, ..sun }).unwrap();
    }
    if effects.stars {
        world.insert_one(settings, Stars { count: 300, size: 0.05, ..Stars::default() }).unwrap();
    }
    if effects.fog {
        let fog = Fog::new(Rgb::splat(0.7), 0.1);
        let layer = Fog { height: effects.layer.then_some(1.5), level: -0.5, ..fog };
        world.insert_one(settings, Fog { hides_background: !effects.clear_sky, ..layer }).unwrap();
    }
    world
}

fn assert_same(found: &Film, expected: &Film) -> Result<(), TestCaseError> {
    prop_assert!(found.pixels().iter().all(|pixel| pixel.is_finite()));
    for (index, (found, expected)) in found.pixels().iter().zip(expected.pixels()).enumerate() {
        prop_assert_eq!(found, expected, "pixel ({}, {})", index % 32, index / 32);
    }
    Ok(())
}

/// Returns the number of cases, `RAYREEL_CASES` or 400.
fn cases() -> u32 {
    std::env::var("RAYREEL_CASES").ok().and_then(|cases| cases.parse().ok()).unwrap_or(400)
}

/// Returns a fixed seed, or a random one if `RAYREEL_CASES` is set.
fn seed() -> RngSeed {
    if std::env::var_os("RAYREEL_CASES").is_some() { RngSeed::Random } else { RngSeed::Fixed(2026) }
}

static POOLS: LazyLock<[ThreadPool; 3]> =
    LazyLock::new(|| [1, 2, 8].map(|threads| ThreadPoolBuilder::new().num_threads(threads).build().unwrap()));

proptest! {
    #![proptest_config(ProptestConfig { cases: cases(), failure_persistence: None, rng_seed: seed(), ..ProptestConfig::default() })]

    #[test]
    fn planned_full_and_reference_pictures_agree(
        effects in effects(),
        things in things(),
        lights in prop::collection::vec(light(), 0..4),
        eye in point(),
        samples in prop_oneof![3 => Just(1), 1 => 2..=4u32],
        cutoff in prop_oneof![Just(0.0f32), Just(0.25), Just(20.0)],
        omitted in prop::option::weighted(0.3, prop::sample::select(&Effect::ALL[..])),
    ) {
        let mut engine = Engine::new(world(effects, &things, &lights, eye, samples, cutoff));
        engine.settings = RenderSettings { without: omitted.into_iter().collect(), ..engine.settings };
        let reference = engine.render(RenderRequest { reference: true, ..RenderRequest::at(Time::ZERO) }).unwrap().film;
        let planned = engine.render(Time::ZERO).unwrap().film;
        assert_same(&planned, &reference)?;
        let rays = engine.report().rays;
        for (name, level) in SimdLevel::all() {
            engine.settings = RenderSettings { simd: Some(level), ..engine.settings };
            for pool in POOLS.iter() {
                let film = pool.install(|| engine.render(Time::ZERO)).unwrap().film;
                prop_assert!(film == planned, "{} threads, {name}", pool.current_num_threads());
                prop_assert_eq!(engine.report().rays, rays);
            }
        }
        engine.settings = RenderSettings { all_effects: true, ..engine.settings };
        let full = engine.render(Time::ZERO).unwrap().film;
        assert_same(&full, &reference)?;
    }
}

proptest! {
    #![proptest_config(ProptestConfig { cases: cases().div_ceil(8), failure_persistence: None, rng_seed: seed(), ..ProptestConfig::default() })]

    /// Checks adaptive sampling, which decides sample counts from sums of samples, in the same way on any number of threads.
    #[test]
    fn adaptive_pictures_agree(
        effects in effects(),
        things in things(),
        lights in prop::collection::vec(light(), 0..4),
        eye in point(),
        has_lens in any::<bool>(),
        samples in prop_oneof![Just(7u32), Just(40)],
        error in prop_oneof![Just(0.3f32), Just(2.0), Just(8.0)],
    ) {
        let mut engine = Engine::new(world(effects, &things, &lights, eye, if has_lens { 3 } else { 2 }, 0.25));
        engine.settings = RenderSettings { samples: Some(samples), max_error: Some(error), ..RenderSettings::default() };
        let reference = engine.render(RenderRequest { reference: true, ..RenderRequest::at(Time::ZERO) }).unwrap().film;
        let planned = engine.render(Time::ZERO).unwrap().film;
        assert_same(&planned, &reference)?;
        let report = engine.report().clone();
        prop_assert!(report.error.is_some());
        prop_assert!(report.rays.camera >= 32 * 18);
        for (name, level) in SimdLevel::all() {
            engine.settings = RenderSettings { simd: Some(level), ..engine.settings };
            for pool in POOLS.iter() {
                let film = pool.install(|| engine.render(Time::ZERO)).unwrap().film;
                prop_assert!(film == planned, "{} threads, {name}", pool.current_num_threads());
                prop_assert_eq!(engine.report().rays, report.rays);
                prop_assert_eq!(engine.report().error, report.error);
            }
        }
    }
}
