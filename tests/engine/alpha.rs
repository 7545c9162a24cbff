//! Tests of pictures with alpha, against the reference path and against pictures with backgrounds.

use rayreel::components::{Background, FilmSettings, Sampling};
use rayreel::scene::Scene;
use rayreel::trace::{RenderedImage, SimdLevel};
use rayreel::{Engine, RenderRequest, RenderSettings, Rgb, Time};

const SIZE: (u32, u32) = (45, 27);

/// Returns an engine with a shipped scene at a small size and these sampling settings.
fn engine(scene: &str, samples: u32, max_error: f32) -> Engine {
    let path = format!("{}/scenes/{scene}.ron", env!("CARGO_MANIFEST_DIR"));
    let mut engine = Engine::load(path).unwrap();
    for film in engine.world_mut().query_mut::<&mut FilmSettings>() {
        (film.width, film.height) = SIZE;
    }
    for sampling in engine.world_mut().query_mut::<&mut Sampling>() {
        *sampling = Sampling { samples, max_error, ..*sampling };
    }
    engine
}

fn render(engine: &mut Engine, time: Time) -> RenderedImage {
    engine.render(RenderRequest { alpha: true, ..RenderRequest::at(time) }).unwrap()
}

#[test]
fn alpha_equals_the_reference_path() {
    for scene in ["first_light", "glass_marbles", "fairground", "foggy_avenue", "box_field"] {
        for (samples, max_error, full) in [(1, 0.0, true), (3, 0.0, false), (32, 2.0, false)] {
            let mut engine = engine(scene, samples, max_error);
            engine.settings = RenderSettings { all_effects: full, ..engine.settings };
            let time = "0.7".parse().unwrap();
            let film = render(&mut engine, time);
            let expected = engine
                .render(RenderRequest { alpha: true, reference: true, ..RenderRequest::at(time) })
                .unwrap();
            assert!(film == expected, "{scene}, {samples} samples, error {max_error}");
        }
    }
}

#[test]
fn covered_light_and_background_add_up_to_the_picture() {
    for (samples, max_error) in [(1, 0.0), (5, 0.0), (64, 1.0)] {
        let mut engine = engine("fairground", samples, max_error);
        for background in engine.world_mut().query_mut::<&mut Background>() {
            *background = Background::Flat(Rgb::new(0.3, 0.45, 0.65));
        }
        let picture = engine.render(Time::ZERO).unwrap().film;
        let report = engine.report().clone();
        let RenderedImage { film: light, alpha, .. } = render(&mut engine, Time::ZERO);
        let alpha = alpha.unwrap();
        if max_error == 0.0 {
            assert_eq!(engine.report().rays, report.rays);
        } else {
            // The error of alpha counts, too, so pixels may take more samples, and the pictures differ.
            assert!(engine.report().rays.camera >= report.rays.camera);
            continue;
        }
        assert_eq!(engine.report().fingerprint, report.fingerprint);
        let background = picture.pixel(0, 0);
        let (mut none, mut partly, mut opaque) = (0, 0, 0);
        for ((picture, light), alpha) in picture.pixels().iter().zip(light.pixels()).zip(alpha.pixels()) {
            match *alpha {
                0.0 => {
                    assert_eq!((*picture, *light), (background, Rgb::ZERO));
                    none += 1;
                }
                1.0 => {
                    assert_eq!(picture, light);
                    opaque += 1;
                }
                share => {
                    let over = light + (1.0 - share) * background;
                    assert!((over - picture).abs().max_element() < 1e-6, "{over} {picture}");
                    partly += 1;
                }
            }
        }
        assert!(none > 200 && opaque > 500, "{none} {partly} {opaque}");
        assert_eq!(partly > 30, samples > 1, "{none} {partly} {opaque}");
    }
}

/// A transparent, a tinted and a reflective ball in front of a background of two colours.
const GLASS: &str = r#"
    Scene(
        film: (width: 45, height: 27),
        camera: (position: (0, 0, -8), target: (0, 0, 0), fov: 40),
        background: (bottom: (255, 172, 84), top: (52, 82, 160)),
        materials: {
            "clear": (refractive: (k_t: 1, ior: 1)),
            "tinted": (refractive: (k_t: 1, ior: 1.5, absorption: (0.5, 0, 0))),
            "mirror": (reflective: (k_r: 1)),
        },
        entities: [
            (name: "left", shape: Sphere(radius: 1), material: "clear", transform: (translation: (-2.5, 0, 0))),
            (name: "middle", shape: Sphere(radius: 1), material: "tinted"),
            (name: "right", shape: Sphere(radius: 1), material: "mirror", transform: (translation: (2.5, 0, 0))),
        ],
    )"#;

/// Checks that mirrors and glass cover the background that they show, and that fog covers it.
#[test]
fn hits_cover_the_background() {
    let fog = render(&mut engine("foggy_avenue", 2, 0.0), Time::ZERO);
    assert!(fog.alpha.unwrap().pixels().iter().all(|alpha| *alpha == 1.0));
    let scene = Scene::from_text("glass.ron", GLASS.to_owned()).unwrap_or_else(|error| panic!("{error}"));
    let mut glass = Engine::from_scene(scene);
    let alpha = render(&mut glass, Time::ZERO).alpha.unwrap();
    let request = RenderRequest { passes: true, ..RenderRequest::at(Time::ZERO) };
    let (passes, mut hits) = (glass.render(request).unwrap().passes.unwrap(), 0);
    for (alpha, pass) in alpha.pixels().iter().zip(passes.pixels()) {
        let is_hit = pass.id > 0;
        assert_eq!(*alpha, f32::from(u8::from(is_hit)));
        hits += u32::from(is_hit);
    }
    assert!(hits > 100 && hits < SIZE.0 * SIZE.1, "{hits}");
}

/// Checks that fog covers the background where it dims it, and nowhere else: with height, it is too thin to change a bit near the zenith.
#[test]
fn fog_covers_the_background_that_it_dims() {
    for (fog, shares) in [
        ("density: 0.4, hides_background: false", 0.05..=0.4),
        ("density: 0.4, height: 2", 1.0..=1.0),
        ("density: 3e-9, height: 2", 0.4..=0.9),
    ] {
        let fog = format!("fog: (color: (200, 210, 220), {fog}), materials: {{");
        let text = GLASS.replace("materials: {", &fog);
        let scene = Scene::from_text("fog.ron", text).unwrap_or_else(|error| panic!("{error}"));
        let mut engine = Engine::from_scene(scene);
        let expected = engine
            .render(RenderRequest { alpha: true, reference: true, ..RenderRequest::at(Time::ZERO) })
            .unwrap();
        for (name, level) in SimdLevel::all() {
            engine.settings = RenderSettings { simd: Some(level), ..engine.settings };
            assert!(render(&mut engine, Time::ZERO) == expected, "{fog}, {name}");
        }
        let alpha = expected.alpha.unwrap();
        let share = alpha.pixels().iter().sum::<f32>() / (SIZE.0 * SIZE.1) as f32;
        assert!(shares.contains(&share), "{fog}: {share}");
    }
}

#[test]
fn threads_and_instruction_sets_do_not_change_alpha() {
    let time = "0.7".parse().unwrap();
    let picture = render(&mut engine("fairground", 16, 1.0), time);
    for threads in [1, 3] {
        let pool = rayon::ThreadPoolBuilder::new().num_threads(threads).build().unwrap();
        assert!(pool.install(|| render(&mut engine("fairground", 16, 1.0), time)) == picture);
    }
    for (name, level) in SimdLevel::all() {
        let mut engine = engine("fairground", 16, 1.0);
        engine.settings = RenderSettings { simd: Some(level), ..engine.settings };
        assert!(render(&mut engine, time) == picture, "{name}");
    }
}
