//! Tests that no world causes a panic, that every film has the right size and finite pixels, and that every shape is either drawn or
//! reported as faulty.

use std::collections::BTreeSet;

use assert_cmd::Command;
use glam::{DQuat, DVec3};
use proptest::prelude::*;
use proptest::test_runner::{RngSeed, TestCaseResult};
use serde_json::Value;

use rayreel::color::ErrorNorm;
use rayreel::components::{
    Ambient, AmbientOcclusion, AreaShape, Background, Camera, Emission, Falloff, FilmSettings, FocusOn, Fog,
    Follow, Lens, Light, LightKind, LookAt, Material, Noise, Parent, Pattern, PatternKind, Projection,
    Quality, Reflective, Refractive, Sampling, Shape, Shot, Shots, Specular, Stars, Sun, Transform, View,
    Visibility, WorldTransform,
};
use rayreel::systems::{Consequence, FaultCause};
use rayreel::{Context, Engine, Entity, Fault, Film, Ray, RenderRequest, RenderSettings, Rgb, Time, World};

/// Generates any numbers, with a high share of problematic ones.
fn number() -> impl Strategy<Value = f64> {
    let trouble = [
        0.0,
        -0.0,
        -1.0,
        f64::NAN,
        f64::INFINITY,
        f64::NEG_INFINITY,
        f64::MAX,
        f64::MIN_POSITIVE,
        5e-324,
        1e-160,
        1e-75,
        1e75,
        1e149,
        1e151,
        1e200,
        1e17,
        1e-10,
    ];
    prop_oneof![
        6 => Just(1.0),
        4 => -4.0..4.0f64,
        4 => prop::sample::select(trouble.to_vec()),
        1 => any::<f64>(),
    ]
}

#[expect(clippy::cast_possible_truncation, reason = "whatever becomes of it")]
fn single() -> impl Strategy<Value = f32> {
    number().prop_map(|number| number as f32)
}

fn vector() -> impl Strategy<Value = DVec3> {
    prop_oneof![
        1 => Just(DVec3::ONE),
        1 => Just(DVec3::ZERO),
        3 => (number(), number(), number()).prop_map(DVec3::from),
    ]
}

fn color() -> impl Strategy<Value = Rgb> {
    (single(), single(), single()).prop_map(|(r, g, b)| Rgb::new(r, g, b))
}

fn transform() -> impl Strategy<Value = Transform> {
    let rotation = prop_oneof![
        3 => Just(DQuat::IDENTITY),
        1 => Just(DQuat::from_rotation_x(0.3)),
        1 => (number(), number(), number(), number()).prop_map(|(x, y, z, w)| DQuat::from_xyzw(x, y, z, w)),
    ];
    (vector(), rotation, vector()).prop_map(|(translation, rotation, scale)| Transform {
        translation,
        rotation,
        scale,
    })
}

fn shape() -> impl Strategy<Value = Shape> {
    prop_oneof![
        number().prop_map(|radius| Shape::Sphere { radius }),
        vector().prop_map(|size| Shape::Box { size }),
        vector().prop_map(|normal| Shape::Plane { normal }),
        (number(), vector(), vector()).prop_map(|(radius, from, to)| Shape::Cylinder { radius, from, to }),
        (number(), vector(), vector()).prop_map(|(radius, from, to)| Shape::Capsule { radius, from, to }),
    ]
}

#[derive(Clone, Debug)]
struct Looks {
    material: Material,
    specular: Option<Specular>,
    reflective: Option<Reflective>,
    refractive: Option<Refractive>,
    pattern: Option<Pattern>,
    emission: Option<Emission>,
    visibility: Option<Visibility>,
}

fn visibility() -> impl Strategy<Value = Visibility> {
    any::<[bool; 3]>().prop_map(|[camera, secondary, shadow]| Visibility { camera, secondary, shadow })
}

fn pattern_kind() -> BoxedStrategy<PatternKind> {
    let direction = || (number(), number(), number()).prop_map(DVec3::from);
    prop_oneof![
        number().prop_map(|size| PatternKind::Checker { size }),
        (number(), number(), direction(), number()).prop_map(|(size, ratio, direction, offset)| {
            PatternKind::Stripes { size, ratio, direction, offset }
        }),
        (direction(), number()).prop_map(|(size, mortar)| PatternKind::Bricks { size, mortar }),
        (number(), direction(), number()).prop_map(|(size, direction, offset)| PatternKind::Gradient {
            size,
            direction,
            offset
        }),
        (number(), 0..20u32, number()).prop_map(|(size, octaves, contrast)| PatternKind::Noise {
            size,
            octaves,
            contrast
        }),
    ]
    .boxed()
}

fn looks() -> impl Strategy<Value = Looks> {
    let material = (single(), single(), color(), prop::option::of(color()), any::<bool>());
    let material = material.prop_map(|(k_a, k_d, color, ambient_color, metallic)| Material {
        k_a,
        k_d,
        color,
        ambient_color,
        metallic,
    });
    let refractive = (single(), number(), color(), any::<bool>());
    let refractive =
        refractive.prop_map(|(k_t, ior, absorption, fresnel)| Refractive { k_t, ior, absorption, fresnel });
    (
        material,
        prop::option::weighted(
            0.3,
            (single(), single()).prop_map(|(k_s, shininess)| Specular { k_s, shininess }),
        ),
        prop::option::weighted(0.3, single().prop_map(|k_r| Reflective { k_r })),
        prop::option::weighted(0.3, refractive),
        prop::option::weighted(
            0.3,
            (color(), pattern_kind()).prop_map(|(color, kind)| Pattern { color, kind }),
        ),
        prop::option::weighted(0.3, color().prop_map(Emission)),
        prop::option::weighted(0.2, visibility()),
    )
        .prop_map(|(material, specular, reflective, refractive, pattern, emission, visibility)| Looks {
            material,
            specular,
            reflective,
            refractive,
            pattern,
            emission,
            visibility,
        })
}

fn light() -> impl Strategy<Value = Light> {
    let samples = prop_oneof![Just(0u32), Just(1), Just(3), Just(u32::MAX)];
    let area = prop_oneof![
        number().prop_map(|radius| AreaShape::Sphere { radius }),
        (number(), number()).prop_map(|(width, height)| AreaShape::Rectangle { width, height }),
    ];
    let kind = prop_oneof![
        Just(LightKind::Point),
        (number(), number()).prop_map(|(angle, softness)| LightKind::Spot { angle, softness }),
        vector().prop_map(|direction| LightKind::Directional { direction }),
        // Larger sample counts are valid, but slow.
        (area, samples).prop_map(|(shape, samples)| LightKind::Area { shape, samples: samples.min(5) }),
    ];
    let falloff = (number(), number(), number()).prop_map(|(constant, linear, quadratic)| Falloff {
        constant,
        linear,
        quadratic,
    });
    (kind, color(), any::<bool>(), prop::option::weighted(0.3, falloff)).prop_map(
        |(kind, intensity, casts_shadows, falloff)| Light { kind, intensity, casts_shadows, falloff },
    )
}

/// An entity. Any of its components may be missing.
#[derive(Clone, Debug)]
struct Thing {
    shape: Option<Shape>,
    looks: Option<Looks>,
    light: Option<Light>,
    transform: Option<Transform>,
    /// Index of the parent among all entities, including the entity itself and a despawned one.
    parent: Option<prop::sample::Index>,
}

fn thing() -> impl Strategy<Value = Thing> {
    (
        prop::option::weighted(0.8, shape().boxed()),
        prop::option::weighted(0.8, looks().boxed()),
        prop::option::weighted(0.2, light().boxed()),
        prop::option::weighted(0.8, transform().boxed()),
        prop::option::weighted(0.4, any::<prop::sample::Index>()),
    )
        .prop_map(|(shape, looks, light, transform, parent)| Thing {
            shape,
            looks,
            light,
            transform,
            parent,
        })
}

#[derive(Clone, Debug)]
struct Settings {
    camera: Option<Camera>,
    follows: Option<prop::sample::Index>,
    focuses_on: Option<prop::sample::Index>,
    looks_at: Option<prop::sample::Index>,
    shots: bool,
    ambient: (Rgb, Option<AmbientOcclusion>),
    background: Background,
    fog: Fog,
    sky: Option<(Sun, Stars)>,
    quality: Quality,
    sampling: Sampling,
    film: (u32, u32),
}

fn camera() -> impl Strategy<Value = Camera> {
    let projection = prop_oneof![
        (number(), 0..3).prop_map(|(value, kind)| match kind {
            0 => Projection::FieldOfView { vertical: value },
            1 => Projection::HorizontalFieldOfView { horizontal: value },
            _ => Projection::Orthographic { height: value },
        }),
        (number(), prop::option::of(number()), number())
            .prop_map(|(distance, width, height)| Projection::Screen { distance, width, height }),
    ];
    let view = prop_oneof![vector().prop_map(View::Direction), vector().prop_map(View::Target)];
    let lens = (number(), number()).prop_map(|(aperture, focus)| Lens { aperture, focus });
    (vector(), view, vector(), number(), projection, prop::option::of(lens), prop::option::of(number()))
        .prop_map(|(position, view, up, roll, projection, lens, shutter)| Camera {
            position,
            view,
            up,
            roll,
            projection,
            lens,
            shutter,
        })
}

fn settings() -> impl Strategy<Value = Settings> {
    let background = prop_oneof![
        color().prop_map(Background::Flat),
        (color(), prop::option::of(color()), color())
            .prop_map(|(bottom, horizon, top)| Background::Gradient { bottom, horizon, top }),
    ];
    let fog = (color(), number(), prop::option::of(number()), number())
        .prop_map(|(color, density, height, level)| Fog { height, level, ..Fog::new(color, density) });
    let occlusion = (prop_oneof![Just(0u32), Just(2)], number())
        .prop_map(|(samples, distance)| AmbientOcclusion { samples, distance });
    let sun = (vector(), color(), number(), number(), number()).prop_map(
        |(direction, intensity, size, glow, glow_size)| Sun { direction, intensity, size, glow, glow_size },
    );
    let count = prop_oneof![Just(0u32), Just(9), Just(u32::MAX)];
    let stars = (count, color(), number(), any::<u64>()).prop_map(|(count, intensity, size, seed)| Stars {
        count,
        intensity,
        size,
        seed,
    });
    let depth = prop_oneof![Just(0u32), Just(1), Just(3), Just(u32::MAX)];
    let quality = (depth, single()).prop_map(|(depth, cutoff)| Quality { depth, cutoff });
    let few = || prop_oneof![Just(0u32), Just(1), Just(3)];
    let sampling = (few(), few(), single(), any::<u64>(), few());
    let sampling = sampling.prop_map(|(samples, min_samples, max_error, seed, instants)| Sampling {
        samples,
        min_samples,
        max_error,
        norm: ErrorNorm::Rms,
        seed,
        instants,
        noise: Noise::Fixed,
    });
    let film = prop_oneof![Just((8u32, 5u32)), Just((0, 3)), Just((4, 0)), Just((1, 1))];
    let link = || prop::option::weighted(0.2, any::<prop::sample::Index>());
    (
        prop::option::weighted(0.8, camera()),
        (link(), link(), link(), any::<bool>()),
        ((color(), prop::option::of(occlusion)), background, fog, prop::option::weighted(0.3, (sun, stars))),
        (quality, sampling, film),
    )
        .prop_map(
            |(
                camera,
                (follows, focuses_on, looks_at, shots),
                (ambient, background, fog, sky),
                (quality, mut sampling, film),
            )| {
                if sky.is_some() || ambient.1.is_some() && sampling.max_error > 0.0 {
                    // With one sample, which sets no limit, an error target would take 65 536 samples of a sky or of occlusion.
                    sampling.samples = 3;
                }
                Settings {
                    camera,
                    follows,
                    focuses_on,
                    looks_at,
                    shots,
                    ambient,
                    background,
                    fog,
                    sky,
                    quality,
                    sampling,
                    film,
                }
            },
        )
}

fn put(world: &mut World, entity: Entity, looks: &Looks) {
    world.insert_one(entity, looks.material).unwrap();
    if let Some(specular) = looks.specular {
        world.insert_one(entity, specular).unwrap();
    }
    if let Some(reflective) = looks.reflective {
        world.insert_one(entity, reflective).unwrap();
    }
    if let Some(refractive) = looks.refractive {
        world.insert_one(entity, refractive).unwrap();
    }
    if let Some(emission) = looks.emission {
        world.insert_one(entity, emission).unwrap();
    }
    if let Some(pattern) = looks.pattern {
        world.insert_one(entity, pattern).unwrap();
    }
    if let Some(visibility) = looks.visibility {
        world.insert_one(entity, visibility).unwrap();
    }
}

fn world(things: &[Thing], settings: &Settings) -> World {
    let mut world = World::new();
    let removed = world.spawn(());
    let mut entities: Vec<Entity> = things.iter().map(|_| world.spawn(())).collect();
    entities.push(removed);
    for (thing, entity) in things.iter().zip(&entities) {
        if let Some(shape) = thing.shape {
            world.insert_one(*entity, shape).unwrap();
        }
        if let Some(looks) = &thing.looks {
            put(&mut world, *entity, looks);
        }
        if let Some(light) = thing.light {
            world.insert_one(*entity, light).unwrap();
        }
        if let Some(transform) = thing.transform {
            world.insert_one(*entity, transform).unwrap();
        }
        if let Some(parent) = &thing.parent {
            world.insert_one(*entity, Parent(*parent.get(&entities))).unwrap();
        }
    }
    let (width, height) = settings.film;
    let scene = world.spawn((
        Ambient(settings.ambient.0),
        settings.background,
        settings.fog,
        settings.quality,
        settings.sampling,
        FilmSettings::new(width, height),
    ));
    if let Some(occlusion) = settings.ambient.1 {
        world.insert_one(scene, occlusion).unwrap();
    }
    if let Some(sky) = settings.sky {
        world.insert(scene, sky).unwrap();
    }
    let active = settings.camera.map_or(removed, |camera| world.spawn((camera,)));
    if let Some(followed) = &settings.follows {
        world.insert_one(active, Follow(*followed.get(&entities))).unwrap();
    }
    if let Some(focused) = &settings.focuses_on {
        world.insert_one(active, FocusOn(*focused.get(&entities))).unwrap();
    }
    if let Some(looked_at) = &settings.looks_at {
        world.insert_one(active, LookAt(*looked_at.get(&entities))).unwrap();
    }
    if settings.shots {
        world.insert_one(scene, Shots(vec![Shot { start: 0.0, camera: active }])).unwrap();
    }
    world.despawn(removed).unwrap();
    world
}

fn check_film(engine: &Engine, film: &Film) -> TestCaseResult {
    let size = engine.effective_settings().film;
    prop_assert!(film.width() > 0 && film.height() > 0);
    prop_assert_eq!((film.width(), film.height()), (size.width, size.height));
    for pixel in film.pixels() {
        prop_assert!(pixel.is_finite() && pixel.min_element() >= 0.0, "{}", pixel);
    }
    Ok(())
}

/// Returns the shapes that are not drawn.
fn not_drawn(faults: &[Fault]) -> BTreeSet<Entity> {
    let not_drawn = faults.iter().filter(|fault| fault.consequence == Consequence::NotDrawn);
    not_drawn.map(|fault| fault.entity).collect()
}

/// Checks that a shape is reported if and only if rays cannot hit it, and that every fault has a message and a remedy.
fn check_faults(engine: &Engine) -> TestCaseResult {
    let faults = engine.faults();
    for fault in &faults {
        prop_assert!(!fault.to_string().is_empty() && !fault.remedy().is_empty());
        prop_assert!(fault.cause != FaultCause::Undeclared, "{}", fault);
    }
    let named = not_drawn(&faults);
    let drawn: BTreeSet<Entity> = engine.prepared().unwrap().drawn().iter().copied().collect();
    let shapes: BTreeSet<Entity> = engine.world().query::<hecs::With<Entity, &Shape>>().iter().collect();
    let both: BTreeSet<Entity> = named.union(&drawn).copied().collect();
    prop_assert!(named.is_disjoint(&drawn), "drawn and named");
    // Shapes that no ray sees are meant to be missing.
    let mut hidden = engine.world().query::<(Entity, &Visibility)>();
    let hidden = hidden.iter().filter(|(_, visibility)| **visibility == Visibility::NONE);
    let hidden: BTreeSet<Entity> = hidden.map(|(entity, _)| entity).collect();
    prop_assert!(drawn.is_disjoint(&hidden), "drawn and hidden");
    prop_assert_eq!(&both - &hidden, &shapes - &hidden);
    Ok(())
}

proptest! {
    #![proptest_config(ProptestConfig {
        cases: std::env::var("RAYREEL_CASES").ok().and_then(|cases| cases.parse().ok()).unwrap_or(1500),
        failure_persistence: None,
        rng_seed: RngSeed::Fixed(2026),
        ..ProptestConfig::default()
    })]

    #[test]
    fn every_shape_is_drawn_or_reported(
        things in prop::collection::vec(thing(), 0..6),
        settings in settings(),
        later in prop::collection::vec((any::<prop::sample::Index>(), thing()), 0..4),
    ) {
        let mut engine = Engine::new(world(&things, &settings));
        engine.settings = RenderSettings { all_effects: true, ..engine.settings };
        let film = engine.render(Time::ZERO).unwrap().film;
        check_film(&engine, &film)?;
        check_faults(&engine)?;
        engine.render(RenderRequest { reference: true, ..RenderRequest::at(Time::ZERO) }).unwrap();
        let _ = engine.cast(Ray { origin: DVec3::ZERO, direction: DVec3::ONE });
        let _ = engine.report().plan.as_ref();

        // The same checks follow for a system that changes the world and declares its changes entity by entity.
        let entities: Vec<Entity> = engine.world().query::<hecs::With<Entity, &Shape>>().iter().collect();
        engine.register::<WorldTransform>();
        engine.add_system(move |context: &mut Context<'_>| {
            let seconds = context.time.seconds();
            context.changes.mark_settings();
            for (index, thing) in later.iter().filter(|_| seconds > 0.0 && !entities.is_empty()) {
                let entity = *index.get(&entities);
                if let (Some(shape), Ok(stored)) = (thing.shape, context.world.query_one_mut::<&mut Shape>(entity)) {
                    *stored = shape;
                    context.changes.mark_shape(entity);
                }
                if let (Some(transform), Ok(stored)) =
                    (thing.transform, context.world.query_one_mut::<&mut Transform>(entity))
                {
                    *stored = transform;
                    context.changes.mark_transform(entity);
                }
                if let (Some(looks), Ok(stored)) =
                    (&thing.looks, context.world.query_one_mut::<&mut Material>(entity))
                {
                    *stored = looks.material;
                    context.changes.mark_material(entity);
                }
            }
        });
        for seconds in ["0", "1", "0", "2"] {
            let film = engine.render(seconds.parse::<Time>().unwrap()).unwrap().film;
            check_film(&engine, &film)?;
            check_faults(&engine)?;
            // With an open shutter, rendering leaves the world at another time.
            engine.seek(seconds.parse().unwrap()).unwrap();
            let faults = engine.faults();
            // After `world_mut` the engine reads the whole world again, and must find the same faults.
            engine.world_mut();
            engine.seek(seconds.parse().unwrap()).unwrap();
            prop_assert_eq!(format!("{:?}", engine.faults()), format!("{:?}", faults));
        }
    }
}

fn clay() -> Material {
    Material { k_a: 0.5, k_d: 0.5, color: Rgb::ONE, ambient_color: None, metallic: false }
}

/// Returns the message and the remedy of an entity's only fault.
fn message_of(build: impl FnOnce(&mut World) -> Entity) -> (String, String) {
    let mut world = World::new();
    let entity = build(&mut world);
    let mut engine = Engine::new(world);
    engine.seek(Time::ZERO).unwrap();
    let mut faults = engine.faults();
    assert_eq!(faults.len(), 1, "{faults:?}");
    let fault = faults.remove(0);
    assert_eq!(fault.entity, entity);
    (fault.to_string(), fault.remedy())
}

#[test]
fn faults_have_messages_and_remedies() {
    let ball = Shape::Sphere { radius: 1.0 };
    let cube = Shape::Box { size: DVec3::ONE };
    let at = |x: f64| Transform::at(x, 0.0, 0.0);
    let scaled = |scale: f64| Transform { scale: DVec3::splat(scale), ..Transform::IDENTITY };
    let message =
        |shape: Shape, transform: Transform| message_of(|world| world.spawn((shape, transform, clay()))).0;
    assert_eq!(message(Shape::Sphere { radius: 0.0 }, at(0.0)), "is not drawn: its radius is 0");
    assert_eq!(message(ball, at(f64::NAN)), "is not drawn: its translation is not finite");
    assert_eq!(message(ball, scaled(0.0)), "is not drawn: its scale has a factor of 0");
    assert_eq!(message(ball, at(1e200)), "is not drawn: it is too large, too small or too far away");
    assert_eq!(
        message(Shape::Plane { normal: DVec3::ZERO }, at(0.0)),
        "is not drawn: its normal has no direction"
    );
    assert_eq!(
        message(cube, at(1e17)),
        "is not drawn: its edge of 1 is lost at 1e17, where numbers are 16 apart"
    );
    let (fault, remedy) =
        message_of(|world| world.spawn((Shape::Box { size: DVec3::splat(1e-10) }, at(1e7), clay())));
    assert_eq!(
        fault,
        "is not drawn: its edge of 1e-10 is lost at 1e7, where numbers are 1.862645149230957e-9 apart"
    );
    assert_eq!(remedy, "make it longer than 1.862645149230957e-9, or bring it nearer to the origin");

    let bare = message_of(|world| world.spawn((ball,)));
    assert_eq!(bare.0, "is not drawn: it has a shape but no material");
    let remedy = "give it a material, in code as `Material::matte(color)`, or `Material::default()` for mirrors and glass";
    assert_eq!(bare.1, remedy);
    let through_parents = message_of(|world| {
        let parent = world.spawn((scaled(1e200),));
        world.spawn((ball, scaled(1e200), Parent(parent), clay()))
    });
    assert_eq!(
        through_parents,
        (
            "is not drawn: its transform and those of its parents together are not finite".to_owned(),
            "let its parents move and scale it less".to_owned()
        )
    );
    let dark = message_of(|world| world.spawn((Light::spot(-1.0, 0.0, Rgb::ONE), Transform::IDENTITY)));
    assert_eq!(dark.0, "gives no light: its angle is -57.295779513");
    let (bright, remedy) =
        message_of(|world| world.spawn((Light::point(Rgb::new(1.0, f32::NAN, 0.0)), Transform::IDENTITY)));
    assert_eq!(bright, "is not as it says: its intensity is NaN, and counts as 0");
    assert_eq!(remedy, "keep it 0 or more, and finite");
    let blind = message_of(|world| world.spawn((Camera { position: DVec3::NAN, ..Camera::default() },)));
    assert_eq!(blind.0, "sees nothing: its place is not finite");
    let flat = Camera { projection: Projection::FieldOfView { vertical: 0.0 }, ..Camera::default() };
    assert_eq!(
        message_of(|world| world.spawn((flat,))).0,
        "shows a distorted picture: its field of view is 0"
    );
    let shallow = message_of(|world| world.spawn((Quality { depth: 0, cutoff: 0.0 },)));
    assert_eq!(shallow.0, "is not as it says: its depth is 0, and counts as 1");
}

/// A box that is lost to rounding, and a ball whose scale becomes 0 twice.
const FAULTY: &str = r#"Scene(
    timeline: (fps: 2, duration: 2),
    film: (width: 8, height: 6),
    camera: (position: (0, 0, -5), target: (0, 0, 0)),
    materials: { "clay": (k_a: 0.5, k_d: 0.5, color: (255, 120, 60)) },
    entities: [
        (name: "far", shape: Box(size: (1, 1, 1)), transform: (translation: (1e17, 0, 0)), material: "clay"),
        (name: "ball", shape: Sphere(radius: 1), material: "clay"),
    ],
    animate: [
        (target: "ball", channel: Scale, track: Keys([(0, 1), (1, -1), (2, 1)])),
    ],
)"#;

#[test]
fn commands_print_faults_with_names_and_lines() {
    let directory = tempfile::tempdir().unwrap();
    let scene = directory.path().join("faulty.ron");
    std::fs::write(&scene, FAULTY).unwrap();
    let run = |arguments: &[&str]| {
        let mut command = Command::cargo_bin("rayreel").unwrap();
        let output = command.args(arguments).current_dir(directory.path()).output().unwrap();
        assert!(output.status.success(), "{}", String::from_utf8_lossy(&output.stderr));
        (String::from_utf8(output.stdout).unwrap(), String::from_utf8(output.stderr).unwrap())
    };
    let far = "warning: \"far\" is not drawn: its edge of 1 is lost at 1e17, where numbers are 16 apart
 --> faulty.ron:7, frame 0";
    let ball = "warning: \"ball\" is not drawn: its scale has a factor of 0
 --> faulty.ron:8, frame";
    let help = "  = help: write factors other than 0";
    let (message, warnings) = run(&["check", "faulty.ron"]);
    assert_eq!(message, "faulty.ron: ok, 4 frames, 2 warnings\n");
    for part in [far, &format!("{ball} 3"), help] {
        assert!(warnings.contains(part), "{warnings}");
    }
    let (_, warnings) = run(&["render", "faulty.ron", "--out", "out"]);
    for part in [&format!("{far} and 3 more"), &format!("{ball} 1 and one more"), help] {
        assert!(warnings.contains(part), "{warnings}");
    }
    // `first` is the first of the examined frames.
    for (arguments, first) in [
        (&["check", "faulty.ron", "--json"][..], "frame 3"),
        (&["render", "faulty.ron", "--out", "out2", "--json"], "frame 1"),
    ] {
        let (report, _) = run(arguments);
        let report: Value = serde_json::from_str(&report).unwrap();
        let report = report.get(0).unwrap_or(&report);
        let warning = &report["warnings"][1];
        assert_eq!((&warning["line"], &warning["first"]), (&Value::from(8), &Value::from(first)));
        assert_eq!(warning["message"], "is not drawn: its scale has a factor of 0");
    }
}
