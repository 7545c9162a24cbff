//! Tests that the components of a world have the values of the scene file, at the start and at every time.

use rayreel::color::{ErrorNorm, Transfer};
use rayreel::components::{
    AmbientOcclusion, AreaShape, Background, Camera, Falloff, FilmSettings, Fog, Light, LightKind, Material,
    Name, Noise, Pattern, PatternKind, Quality, Refractive, Sampling, Specular, Transform,
};
use rayreel::{Engine, Rgb, Scene, Time, World};

/// A film with which the colours of a file are light in 255ths.
const CLASSIC: &str = "film: (transfer: Classic)";

/// Returns a scene with a camera and these fields.
fn scene(body: &str) -> Scene {
    let text = format!("Scene(camera: (position: (0, 0, -5), view: (0, 0, 1)), {body})");
    Scene::from_text("test.ron", text).unwrap_or_else(|error| panic!("{error}"))
}

/// Returns a component of the entity with a name.
fn of<T: hecs::Component + Clone>(world: &World, name: &str) -> Option<T> {
    let mut query = world.query::<(&Name, Option<&T>)>();
    let found = query.iter().find(|(known, _)| known.0 == name);
    found.unwrap_or_else(|| panic!("no {name}")).1.cloned()
}

/// Returns the only component of its type.
fn setting<T: hecs::Component + Clone>(world: &World) -> Option<T> {
    let mut query = world.query::<&T>();
    let mut found = query.iter().cloned();
    let setting = found.next();
    assert_eq!(found.count(), 0);
    setting
}

#[test]
fn material_effects_apply_to_every_entity_of_the_material() {
    let world = scene(
        r##"film: (transfer: Classic), materials: {
            "glass": (refractive: (k_t: 0.75, ior: 1.5, absorption: (0.5, 0.25, 0), fresnel: true)),
            "haze": (refractive: (k_t: 0.5, ior: 1)),
            "board": (pattern: Checker(color: "#ff0033", size: 0.125)),
        },
        entities: [
            (name: "lens", shape: Sphere(radius: 1), material: "glass"),
            (name: "pane", shape: Box(size: (1, 1, 1)), material: "glass"),
            (name: "cloud", shape: Sphere(radius: 1), material: "haze"),
            (name: "floor", shape: Plane(normal: (0, 1, 0)), material: "board"),
        ]"##,
    )
    .world;
    let glass = Refractive { k_t: 0.75, ior: 1.5, absorption: Rgb::new(0.5, 0.25, 0.0), fresnel: true };
    assert_eq!(of(&world, "lens"), Some(glass));
    assert_eq!(of(&world, "pane"), Some(glass));
    let haze = Refractive { k_t: 0.5, ior: 1.0, absorption: Rgb::ZERO, fresnel: false };
    assert_eq!(of(&world, "cloud"), Some(haze));
    assert_eq!(
        of(&world, "floor"),
        Some(Pattern { color: Rgb::new(1.0, 0.0, 0.2), kind: PatternKind::Checker { size: 0.125 } })
    );
    assert_eq!(of::<Pattern>(&world, "lens"), None);
    assert_eq!(of::<Refractive>(&world, "floor"), None);
}

/// Returns the material that an entity of a Classic scene has, whose `materials` have this one.
fn material(written: &str) -> Material {
    let body = format!(
        "{CLASSIC}, materials: {{ \"m\": ({written}) }}, entities: [(name: \"it\", shape: Box(size: (1, 1, 1)), material: \"m\")]"
    );
    of(&scene(&body).world, "it").unwrap()
}

#[test]
fn colours_without_coefficients_are_matte() {
    let (red, white) = (Rgb::new(1.0, 0.0, 0.0), Rgb::ONE);
    let color = "color: (255, 0, 0)";
    assert_eq!(material(color), Material::matte(red));
    for more in ["specular: (k_s: 0.5, shininess: 9)", "reflective: (k_r: 0.5)", "k_a: None, k_d: None"] {
        assert_eq!(material(&format!("{color}, {more}")), Material::matte(red), "{more}");
    }
    assert_eq!(material("pattern: Checker(color: (0, 0, 0), size: 1)"), Material::matte(white));
    let ambient_color = Some(red);
    assert_eq!(material("ambient_color: (255, 0, 0)"), Material { ambient_color, ..Material::matte(white) });

    // The other coefficient is 0, also if the one that is written is.
    let dark = Material { color: red, ..Material::default() };
    assert_eq!(material(&format!("{color}, k_a: 0.5")), Material { k_a: 0.5, ..dark });
    assert_eq!(material(&format!("{color}, k_d: 0.5")), Material { k_d: 0.5, ..dark });
    assert_eq!(material(&format!("{color}, k_d: 0")), dark);

    let glass = "refractive: (k_t: 0.9, ior: 1.5)";
    for without in ["", "reflective: (k_r: 0.9)", "specular: (k_s: 0.5, shininess: 9)", glass] {
        assert_eq!(material(without), Material::default(), "{without}");
    }
    assert_eq!(material(&format!("{color}, {glass}")), dark);
    let (manual, matte) = (include_str!("../../src/scene/manual.md"), Material::matte(white));
    assert!(manual.contains(&format!("k_a is {} and k_d {},", matte.k_a, matte.k_d)));
}

/// A red, shiny clay, glass, and a scene's entities made of them, with a script and an animation.
const SURFACES: &str = r##"film: (transfer: Classic), timeline: (duration: 2), materials: {
        "clay": (k_a: 0.125, k_d: 0.5, color: (255, 0, 0), specular: (k_s: 0.25, shininess: 9)),
        "glass": (refractive: (k_t: 0.75, ior: 1.5)),
    },
    entities: [
        (name: "ball", shape: Sphere(radius: 1), color: (0, 255, 0)),
        (name: "clay", shape: Sphere(radius: 1), material: "clay"),
        (name: "green clay", shape: Sphere(radius: 1), material: "clay", color: "#00ff00"),
        (name: "green glass", shape: Sphere(radius: 1), material: "glass", color: "#00ff00"),
        (name: "in place", shape: Sphere(radius: 1), material: (k_d: 0.5, color: (0, 255, 0), specular: (k_s: 0.25, shininess: 9))),
        (name: "with its word", shape: Box(size: (1, 1, 1)), material: Material(pattern: Checker(color: (0, 0, 0), size: 1)), color: (0, 255, 0)),
    ],
    spawn: [Script(r#"
        spawn(#{ name: "spawned ball", shape: sphere(1), color: [0, 255, 0] });
        spawn(#{ name: "spawned clay", shape: sphere(1), material: "clay", color: [0, 255, 0] });
        spawn(#{ name: "spawned in place", shape: sphere(1), material: #{ k_d: 0.5, color: [0, 255, 0], specular: #{ k_s: 0.25, shininess: 9 } } });
    "#)],
    animate: [
        (material: "clay", channel: Color, track: Keys([(0, (255, 0, 0)), (1, (0, 0, 255))])),
        (material: "clay", channel: Kd, track: Keys([(0, 0.5), (1, 1)])),
        (target: "in place", channel: Ks, track: Keys([(0, 0.25), (1, 0.5)])),
    ]"##;

#[test]
fn surfaces_are_named_or_written_in_place_or_have_a_colour() {
    let mut engine = Engine::from_scene(scene(SURFACES));
    engine.seek(Time::from_ratio(0, 1).unwrap()).unwrap();
    let (green, shine) = (Rgb::new(0.0, 1.0, 0.0), Some(Specular { k_s: 0.25, shininess: 9.0 }));
    let clay = Material {
        k_a: 0.125,
        k_d: 0.5,
        color: Rgb::new(1.0, 0.0, 0.0),
        ambient_color: None,
        metallic: false,
    };
    let green_clay = Material { color: green, ..clay };
    let in_place = Material { k_a: 0.0, ..green_clay };
    for (name, material, specular) in [
        ("ball", Material::matte(green), None),
        ("clay", clay, shine),
        ("green clay", green_clay, shine),
        ("green glass", Material { color: green, ..Material::default() }, None),
        ("in place", in_place, shine),
        ("with its word", Material::matte(green), None),
        ("spawned ball", Material::matte(green), None),
        ("spawned clay", green_clay, shine),
        ("spawned in place", in_place, shine),
    ] {
        assert_eq!(of(engine.world(), name), Some(material), "{name}");
        assert_eq!(of(engine.world(), name), specular, "{name}");
    }
    assert!(of::<Refractive>(engine.world(), "green glass").is_some());
    assert!(of::<Pattern>(engine.world(), "with its word").is_some());

    // A colour of an entity stays as the material's changes; everything else of the material reaches it.
    engine.seek(Time::from_ratio(1, 1).unwrap()).unwrap();
    let later = |name| of::<Material>(engine.world(), name).map(|material| (material.k_d, material.color));
    assert_eq!(later("clay"), Some((1.0, Rgb::new(0.0, 0.0, 1.0))));
    for name in ["green clay", "spawned clay"] {
        assert_eq!(later(name), Some((1.0, green)), "{name}");
    }
    assert_eq!(later("in place"), Some((0.5, green)));
    assert_eq!(of(engine.world(), "in place"), Some(Specular { k_s: 0.5, shininess: 9.0 }));
}

#[test]
fn area_lights_have_an_extent() {
    let world = scene(
        r#"entities: [
            (name: "lamp", light: Area(shape: Sphere(radius: 0.25), intensity: (1, 2, 3))),
            (name: "sheet", light: Area(shape: Rectangle(width: 2, height: 0.5), intensity: (1, 1, 1), samples: 64,
                casts_shadows: false, falloff: (1, 0, 0.5))),
        ]"#,
    )
    .world;
    let lamp = LightKind::Area { shape: AreaShape::Sphere { radius: 0.25 }, samples: 16 };
    assert_eq!(of(&world, "lamp"), Some(Light::new(lamp, Rgb::new(1.0, 2.0, 3.0))));
    let sheet = LightKind::Area { shape: AreaShape::Rectangle { width: 2.0, height: 0.5 }, samples: 64 };
    let falloff = Some(Falloff { constant: 1.0, linear: 0.0, quadratic: 0.5 });
    let sheet = Light { casts_shadows: false, falloff, ..Light::new(sheet, Rgb::ONE) };
    assert_eq!(of(&world, "sheet"), Some(sheet));
}

#[test]
fn background_has_one_to_three_colours() {
    let background = |body: &str| setting::<Background>(&scene(&format!("{CLASSIC}, {body}")).world);
    let blue = Rgb::new(0.0, 0.2, 1.0);
    assert_eq!(background(""), Some(Background::Flat(Rgb::ZERO)));
    assert_eq!(background("background: (0, 51, 255)"), Some(Background::Flat(blue)));
    assert_eq!(background("background: \"#0033ff\""), Some(Background::Flat(blue)));
    let gradient = Background::Gradient { bottom: Rgb::ONE, horizon: None, top: blue };
    assert_eq!(background("background: (bottom: \"#ffffff\", top: (0, 51, 255))"), Some(gradient));
    assert_eq!(background("background: (top: (0, 51, 255), bottom: (255, 255, 255))"), Some(gradient));
    let sky = Background::Gradient { bottom: Rgb::ONE, horizon: Some(Rgb::X), top: blue };
    let text = "background: (bottom: \"#ffffff\", horizon: (255, 0, 0), top: (0, 51, 255))";
    assert_eq!(background(text), Some(sky));
}

#[test]
fn defaults_are_the_same_in_files_and_in_code() {
    let world = scene("").world;
    assert_eq!(setting(&world), Some(FilmSettings::default()));
    assert_eq!(setting(&world), Some(Quality::default()));
    assert_eq!(setting(&world), Some(Sampling::default()));
    assert_eq!(FilmSettings::default().transfer, Transfer::Srgb);
}

#[test]
fn ambient_occlusion_is_read_from_the_scene() {
    let occlusion = |body: &str| setting::<AmbientOcclusion>(&scene(&format!("{CLASSIC}, {body}")).world);
    assert_eq!(occlusion(""), None);
    let with = |samples| Some(AmbientOcclusion { samples, distance: 2.5 });
    assert_eq!(occlusion("ambient_occlusion: (distance: 2.5)"), with(8));
    assert_eq!(occlusion("ambient_occlusion: (samples: 64, distance: 2.5)"), with(64));
}

#[test]
fn fog_is_read_from_the_scene() {
    let fog = |body: &str| setting::<Fog>(&scene(&format!("{CLASSIC}, {body}")).world);
    assert_eq!(fog(""), None);
    assert_eq!(
        fog("fog: (color: (255, 51, 0), density: 0.05)"),
        Some(Fog::new(Rgb::new(1.0, 0.2, 0.0), 0.05))
    );
    assert_eq!(
        fog("fog: (color: (255, 51, 0), density: 0.05, height: 3, level: -1.5, hides_background: false)"),
        Some(Fog {
            height: Some(3.0),
            level: -1.5,
            hides_background: false,
            ..Fog::new(Rgb::new(1.0, 0.2, 0.0), 0.05)
        })
    );
}

#[test]
fn shutter_instants_and_cutoff_are_read_from_the_scene() {
    let world = scene("").world;
    assert_eq!(setting::<Quality>(&world), Some(Quality { depth: 5, cutoff: 0.25 }));
    assert_eq!(setting::<Sampling>(&world), Some(Sampling::default()));
    assert_eq!(setting::<Camera>(&world).unwrap().shutter, None);
    let text =
        "Scene(camera: (position: (0, 0, -5), view: (0, 0, 1), shutter: 0.5), quality: (depth: 3, cutoff: 2),
        sampling: (samples: 64, min_samples: 2, max_error: 0.5, norm: P99, instants: 8, seed: 5, noise: PerFrame))";
    let world = Scene::from_text("test.ron", text.to_owned()).unwrap().world;
    assert_eq!(setting::<Quality>(&world), Some(Quality { depth: 3, cutoff: 2.0 }));
    let sampling = Sampling {
        samples: 64,
        min_samples: 2,
        max_error: 0.5,
        norm: ErrorNorm::P99,
        seed: 5,
        noise: Noise::PerFrame,
        instants: 8,
    };
    assert_eq!(setting::<Sampling>(&world), Some(sampling));
    assert_eq!(setting::<Camera>(&world).unwrap().shutter, Some(0.5));
}

#[test]
fn a_single_sample_may_have_a_shutter_and_glass_may_add_light() {
    let text = "Scene(camera: (position: (0, 0, -5), view: (0, 0, 1), shutter: 1), sampling: (samples: 1),
        materials: { \"m\": (reflective: (k_r: 1), refractive: (k_t: 1, ior: 1000)) })";
    assert!(Scene::from_text("test.ron", text.to_owned()).is_ok());
}

#[test]
fn transparency_tracks_stay_in_range() {
    let mut engine = Engine::from_scene(scene(
        r#"timeline: (fps: 1, duration: 5), film: (width: 1, height: 1),
        materials: { "glass": (refractive: (k_t: 0.5, ior: 1.5)) },
        entities: [
            (name: "lens", shape: Sphere(radius: 1), material: "glass"),
            (name: "pane", shape: Box(size: (1, 1, 1)), material: "glass"),
        ],
        animate: [
            (material: "glass", channel: Kt, track: Keys([(0, 0), (1, 0.5), (2, 1, Cubic), (4, 1, Cubic), (5, 0)])),
            (material: "glass", channel: Ior, track: Keys([(0, 1), (2, 2)])),
            (target: "lens", channel: Ior, track: Keys([(0, 900), (2, 1000, Cubic), (4, 1000, Cubic), (5, 1)])),
            (material: "glass", channel: Absorption,
                track: Keys([(0, (1, 2, 4)), (2, (0, 0, 0), Cubic), (4, (0, 0, 0), Cubic), (5, (9, 9, 9))])),
        ]"#,
    ));
    let mut at = |frame: u32, name: &str| {
        engine.render_frame(frame).unwrap();
        of::<Refractive>(engine.world(), name).unwrap()
    };
    assert_eq!(
        at(1, "pane"),
        Refractive { k_t: 0.5, ior: 1.5, absorption: Rgb::new(0.5, 1.0, 2.0), fresnel: false }
    );
    assert_eq!(at(1, "lens").ior, 950.0);
    // The curve overshoots between two keys at the limit.
    let held = at(3, "lens");
    assert_eq!((held.k_t, held.ior, held.absorption), (1.0, Refractive::LARGEST_IOR, Rgb::ZERO));
    assert_eq!(at(4, "pane").ior, 2.0);
}

#[test]
fn tracks_ease_repeat_shift_and_scale_as_written() {
    let mut engine = Engine::from_scene(scene(
        r#"timeline: (fps: 4, duration: 10), film: (width: 1, height: 1),
        entities: [(name: "eased"), (name: "looped"), (name: "turning"), (name: "late")],
        animate: [
            (target: "eased", channel: Translation, track: Keys([
                (0, (0, 0, 0), InCubic), (1, (8, 0, 0), Steps(2)), (2, (0, 0, 0), Bezier(0.5, 0.5, 0.5, 0.5)),
                (3, (8, 0, 0), CatmullRom), (4, (8, 8, 0), Monotone), (5, (8, 8, 8)),
            ])),
            (target: "looped", channel: Translation, track: Keys([(0, (0, 0, 0)), (2, (8, 0, 0))]), repeat: Loop),
            (repeat: PingPong, target: "turning", channel: Translation, track: Keys([(1, (0, 0, 0)), (2, (8, 0, 0))])),
            (target: "late", channel: Translation, track: Keys([(0, (0, 0, 0)), (2, (8, 0, 0))]), offset: 1, speed: -0.5,
                repeat: Loop),
        ]"#,
    ));
    let mut x = |frame: u32, name: &str| {
        engine.render_frame(frame).unwrap();
        of::<Transform>(engine.world(), name).unwrap().translation.x
    };
    let eased = [(2, 1.0), (4, 8.0), (5, 8.0), (6, 4.0), (9, 2.0), (12, 8.0), (20, 8.0)];
    for (frame, expected) in eased {
        assert!((x(frame, "eased") - expected).abs() < 1e-14, "frame {frame}");
    }
    assert_eq!([0, 7, 8, 9, 36].map(|frame| x(frame, "looped")), [0.0, 7.0, 0.0, 1.0, 4.0]);
    assert_eq!([0, 4, 7, 8, 9, 12].map(|frame| x(frame, "turning")), [8.0, 0.0, 6.0, 8.0, 6.0, 0.0]);
    assert_eq!([0, 4, 8, 12, 20].map(|frame| x(frame, "late")), [2.0, 0.0, 6.0, 4.0, 0.0]);
}
