//! Tests of render passes against the reference path.

use std::sync::atomic::AtomicBool;

use rayreel::components::{FilmSettings, Sampling};
use rayreel::trace::RayEnd;
use rayreel::trace::{PassPixel, Signals};
use rayreel::{Engine, EngineError, RenderRequest, RenderedImage, Scene, Time};

#[test]
fn passes_equal_the_reference_path() {
    for scene in ["first_light", "glass_marbles", "box_field"] {
        let path = format!("{}/scenes/{scene}.ron", env!("CARGO_MANIFEST_DIR"));
        let mut engine = Engine::load(path).unwrap();
        for film in engine.world_mut().query_mut::<&mut FilmSettings>() {
            (film.width, film.height) = (24, 14);
        }
        for sampling in engine.world_mut().query_mut::<&mut Sampling>() {
            (sampling.samples, sampling.max_error) = (1, 0.0);
        }
        let plain = engine.render(Time::ZERO).unwrap();
        let report = engine.report().clone();
        let cancelled = AtomicBool::new(true);
        let with_passes = || RenderRequest { passes: true, ..RenderRequest::at(Time::ZERO) };
        let request = RenderRequest { signals: Signals::unless(&cancelled), ..with_passes() };
        assert!(matches!(engine.render(request), Err(EngineError::Cancelled)));
        let RenderedImage { film, passes, .. } = engine.render(with_passes()).unwrap();
        let (passes, repeated) = (passes.unwrap(), engine.report().clone());
        assert_eq!((&film, passes.pixels().len()), (&plain.film, film.pixels().len()));
        assert_eq!(
            (
                repeated.fingerprint,
                repeated.rays,
                repeated.ends,
                repeated.error,
                repeated.rounds,
                repeated.plan
            ),
            (report.fingerprint, report.rays, report.ends, report.error, report.rounds, report.plan)
        );
        let mut hits = 0;
        for (index, pass) in (0..).zip(passes.pixels()) {
            let tree = engine.probe(Time::ZERO, (index % 24, index / 24), 0).unwrap().unwrap();
            let traced = &tree.rays[0];
            match &traced.end {
                RayEnd::Surface(lit) => {
                    let surface = &lit.surface;
                    let rounded = |vector: glam::DVec3| (vector + glam::DVec3::ZERO).as_vec3().to_array();
                    assert_eq!(pass.position, rounded(surface.point), "{scene}, pixel {index}");
                    assert_eq!(pass.normal, rounded(surface.facing_normal()));
                    let distance = glam::DVec3::splat(surface.distance(&traced.ray));
                    assert_eq!(pass.distance, rounded(distance)[0]);
                    assert!(pass.id > 0 && pass.albedo.min_element() >= 0.0);
                    hits += 1;
                }
                _ => assert_eq!(*pass, PassPixel::NOTHING),
            }
        }
        assert!(hits > 50, "{scene}");
    }
}

/// Returns the passes of a picture of 5x3 pixels, at a time at which the entity `gone` has no width.
fn passes(camera: &str, entities: &str) -> Vec<PassPixel> {
    let text = format!(
        r#"Scene(timeline: (fps: 1, duration: 3), film: (width: 5, height: 3), camera: ({camera}), materials: {{ "m": (k_d: 0.5, color: (255, 0, 0)) }}, entities: [{entities}],
            animate: [(target: "gone", channel: Scale, track: Keys([(0, (-1, 1, 1)), (2, (1, 1, 1))]))])"#
    );
    let mut engine = Engine::from_scene(Scene::from_text("passes.ron", text).unwrap());
    let time = engine.timeline.time_of(1);
    let request = RenderRequest { passes: true, ..RenderRequest::at(time) };
    engine.render(request).unwrap().passes.unwrap().pixels().to_vec()
}

/// Checks depth on screens 4 wide and 2 high, at a distance of 2 from the eye: pixels are 1 apart.
#[test]
fn depth_is_constant_on_a_wall_across_the_view_and_distance_is_not() {
    let screen = "screen: (distance: 2, width: 4, height: 2)";
    let walls = [
        ("position: (1, 2, 3), view: (0, 0, 1)", "(0, 0, 13)", "(0, 0, 1)", [0.0, 0.0, -1.0]),
        ("position: (0, 0, 0), view: (-1, 0, 0), roll: 20", "(-10, 3, 4)", "(1, 0, 0)", [1.0, 0.0, 0.0]),
        (
            "position: (0, 0, 0), view: (1, 2, 2)",
            "(0, 0, 15)",
            "(1, 2, 2)",
            [-1.0, -2.0, -2.0].map(|part| part / 3.0),
        ),
        // The eye is far away, which leaves almost no perspective.
        ("position: (0, 0, -1e6), view: (0, 0, 1)", "(0, 0, -999990)", "(0, 0, 1)", [0.0, 0.0, -1.0]),
    ];
    for (camera, point, normal, expected) in walls {
        let wall = format!(
            r#"(name: "gone"), (shape: Plane(normal: {normal}), material: "m", transform: (translation: {point}))"#
        );
        let pixels = passes(&format!("{camera}, {screen}"), &wall);
        for (index, pixel) in (0..).zip(&pixels) {
            let (x, y) = (f64::from(index % 5) - 2.0, f64::from(index / 5) - 1.0);
            let distance = 10.0 * libm::sqrt(1.0 + (x * x + y * y) / 4.0);
            assert!((f64::from(pixel.depth) - 10.0).abs() < 1e-5, "{camera}: {pixel:?}");
            assert!((f64::from(pixel.distance) - distance).abs() < 1e-5, "{camera}: {pixel:?}");
            let normal =
                pixel.normal.into_iter().zip(expected).map(|(found, wanted)| f64::from(found) - wanted);
            assert!(normal.into_iter().all(|off| off.abs() < 1e-6), "{camera}: {pixel:?}");
        }
        assert_eq!(pixels.iter().filter(|pixel| pixel.distance > 13.0).count(), 6, "{camera}");
    }
}

#[test]
fn ids_count_drawn_shapes_in_document_order_and_the_background_has_none() {
    let ball = |name: &str, x: i32| {
        format!(
            r#"(name: "{name}", shape: Sphere(radius: 0.1), material: "m", transform: (translation: ({x}, 0, 2))),"#
        )
    };
    let entities = [ball("right", 2), ball("gone", 0), ball("middle", 0), ball("left", -1)].concat();
    let camera = "position: (0, 0, 0), view: (0, 0, 1), screen: (distance: 2, width: 4, height: 2)";
    let pixels = passes(camera, &entities);
    let ids: Vec<u32> = pixels.iter().map(|pixel| pixel.id).collect();
    assert_eq!(ids, [0, 0, 0, 0, 0, 0, 3, 2, 0, 1, 0, 0, 0, 0, 0]);
    for pixel in pixels {
        if pixel.id == 0 {
            assert_eq!(pixel, PassPixel::NOTHING);
        } else {
            assert_eq!(pixel.albedo.to_array(), [0.5, 0.0, 0.0]);
            assert!(pixel.position[2] < 2.0 && pixel.position[1] == 0.0 && pixel.depth == pixel.position[2]);
        }
    }
    let background = PassPixel::NOTHING;
    assert_eq!([background.depth, background.distance], [f32::INFINITY; 2]);
    assert_eq!((background.id, background.normal, background.position), (0, [0.0; 3], [0.0; 3]));
}
