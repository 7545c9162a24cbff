//! Tests of views without perspective.

use std::f64::consts::PI;

use rayreel::{Engine, Film, Scene};

fn film(text: &str) -> Film {
    let scene =
        Scene::from_text("orthographic.ron", text.to_owned()).unwrap_or_else(|error| panic!("{error}"));
    Engine::from_scene(scene).render_frame(0).unwrap()
}

/// Checks the example of the scene manual: balls of one size have the same size in the picture at every distance. The outer borders of the
/// pixels are 4 units apart.
#[test]
fn objects_have_the_same_size_at_every_distance() {
    const SIDE: u32 = 81;
    let example = "camera: (position: (0, 0, -10), view: (0, 0, 1), orthographic: 4)";
    assert!(include_str!("../../src/scene/manual.md").contains(example));
    let film = film(&format!(
        r#"Scene(film: (width: {SIDE}, height: {SIDE}), {example}, ambient: (1, 1, 1),
        materials: {{ "m": (k_a: 1) }}, entities: [
            (shape: Sphere(radius: 0.73), material: "m", transform: (translation: (-1, 1, -9.5))),
            (shape: Sphere(radius: 0.73), material: "m", transform: (translation: (1, 1, 10))),
            (shape: Sphere(radius: 0.73), material: "m", transform: (translation: (-1, -1, 1e6))),
            (shape: Box(size: (1.21, 0.87, 1000)), material: "m", transform: (translation: (1, -1, 500))),
            (shape: Sphere(radius: 2), material: "m", transform: (translation: (0, 0, -13))),
        ])"#
    ));
    for (i, j) in (0..SIDE).flat_map(|j| (0..SIDE).map(move |i| (i, j))) {
        let pitch = 4.0 / f64::from(SIDE);
        let (x, y) = (-2.0 + pitch * (f64::from(i) + 0.5), 2.0 - pitch * (f64::from(j) + 0.5));
        let ball = [(-1.0, 1.0), (1.0, 1.0), (-1.0, -1.0)].iter().any(|(a, b)| (x - a).hypot(y - b) < 0.73);
        let in_box = (x - 1.0).abs() < 0.605 && (y + 1.0).abs() < 0.435;
        assert_eq!(film.pixel(i, j).x > 0.0, ball || in_box, "{x}, {y}");
    }
}

/// Returns the mean of all pixels' first channel.
fn mean(film: &Film) -> f64 {
    film.pixels().iter().map(|pixel| f64::from(pixel.x)).sum::<f64>() / film.pixels().len() as f64
}

#[test]
fn a_sphere_covers_the_area_of_its_disc() {
    for (width, height, view) in [(30, 20, 4.0), (7, 9, 4.5)] {
        let area = view * view * f64::from(width) / f64::from(height);
        for (radius, distance) in [(1.5, 1.6), (1.5, 300.0), (0.31, 5.0)] {
            let film = film(&format!(
                r#"(film: (width: {width}, height: {height}), sampling: (samples: 1024), ambient: (1, 1, 1),
                camera: (position: (1, 2, 3), view: (1, 0.5, -2), roll: 20, orthographic: {view}),
                materials: {{ "m": (k_a: 1) }}, entities: [
                    (name: "aim", transform: (translation: (1, 2, 3)), target: (2, 2.5, 1)),
                    (shape: Sphere(radius: {radius}), material: "m", parent: "aim", transform: (translation: (0.1, -0.2, {distance}))),
                ])"#
            ));
            let (expected, found) = (PI * radius * radius, mean(&film) * area);
            // The samples of a pixel at the edge are off by about 1024^-3/4 of its area.
            let pitch = view / f64::from(height);
            let tolerance = 4.0 * 0.0055 * pitch * pitch * (2.0 * PI * radius / pitch).sqrt();
            assert!((found - expected).abs() < tolerance, "{found}, not {expected} within {tolerance}");
        }
    }
}

/// Returns a scene of all kinds of surfaces and lights in front of this camera.
fn scene(camera: &str, samples: u32) -> String {
    format!(
        r##"(film: (width: 64, height: 48), sampling: (samples: {samples}), camera: ({camera}),
        quality: (cutoff: 0), ambient: (0.2, 0.2, 0.2), background: (bottom: (90, 80, 70), top: (20, 30, 90)),
        materials: {{
            "clay": (k_a: 0.4, k_d: 0.5, color: (250, 120, 60), specular: (k_s: 0.4, shininess: 20)),
            "mirror": (k_d: 0.2, reflective: (k_r: 0.7)),
            "glass": (k_d: 0.1, refractive: (k_t: 0.8, ior: 1.5, absorption: (0.1, 0.2, 0.3), fresnel: true)),
            "tiles": (k_a: 0.3, k_d: 0.6, pattern: Checker(color: (30, 30, 30), size: 0.5)),
        }},
        entities: [
            (shape: Plane(normal: (0, 1, 0)), material: "tiles", transform: (translation: (0, -1, 0))),
            (shape: Sphere(radius: 1), material: "clay", transform: (translation: (-0.5, 0, 0.3))),
            (shape: Sphere(radius: 0.6), material: "mirror", transform: (translation: (1.2, -0.3, 0.6))),
            (shape: Box(size: (0.8, 1, 0.7)), material: "glass", transform: (translation: (0.3, -0.2, -1.4), rotation: Euler(10, 30, 0))),
            (light: Point(intensity: (0.8, 0.7, 0.6)), transform: (translation: (3, 4, -3))),
            (light: Spot(intensity: (0.5, 0.6, 0.9), angle: 40), transform: (translation: (-3, 3, -2)), target: (0, 0, 0)),
        ])"##
    )
}

/// Checks a view against a camera a billion units away, whose screen is within the scene.
#[test]
fn orthographic_view_is_the_limit_of_far_cameras() {
    let (view, far) = ((0.3, -0.4, 1.0), 1e9);
    let from = |distance: f64| {
        let (x, y, z) = view;
        format!("position: ({:?}, {:?}, {:?}), view: {view:?}", -x * distance, -y * distance, -z * distance)
    };
    let near = film(&scene(&format!("{}, orthographic: 4", from(20.0)), 1));
    // The centres of the first and the last row are on the edges of a screen.
    let length = far * (0.09 + 0.16 + 1.0_f64).sqrt();
    let screen = format!("screen: (distance: {length:?}, height: {:?})", 4.0 * 47.0 / 48.0);
    let distant = film(&scene(&format!("{}, {screen}", from(far)), 1));
    for (index, (found, expected)) in near.pixels().iter().zip(distant.pixels()).enumerate() {
        assert!((*found - *expected).abs().max_element() < 1e-6, "pixel {index}: {found}, not {expected}");
    }
    assert!(near.pixels().iter().any(|pixel| *pixel != near.pixel(0, 0)));
}

/// Checks exp(-density z) on a wall at a distance of z from the plane of the camera, in all pixels.
#[test]
fn fog_is_measured_from_the_plane_of_the_camera() {
    let film = film(
        r#"(film: (width: 9, height: 6), camera: (position: (5, 0, -3), view: (0, 0, 1), orthographic: 1000),
        fog: (color: (255, 255, 255), density: 0.25), ambient: (1, 1, 1), materials: { "black": (k_a: 0) },
        entities: [(shape: Plane(normal: (0, 0, 1)), material: "black", transform: (translation: (0, 0, 4)))])"#,
    );
    for pixel in film.pixels() {
        assert!((f64::from(pixel.x) - (1.0 - libm::exp(-0.25 * 7.0))).abs() < 1e-6, "{pixel}");
    }
}

/// Checks that each ray has the media at its own start: half of the picture begins in absorbing glass.
#[test]
fn rays_start_in_the_media_around_them() {
    let film = film(
        r#"(film: (width: 8, height: 4), camera: (position: (0, 0, 0), view: (0, 0, 1), orthographic: 4),
        background: (255, 255, 255), materials: { "glass": (refractive: (k_t: 1, ior: 1, absorption: (0.5, 0.5, 0.5))) },
        entities: [(shape: Box(size: (4, 100, 4)), material: "glass", transform: (translation: (2, 0, 0)))])"#,
    );
    for (i, j) in (0..8).flat_map(|i| (0..4).map(move |j| (i, j))) {
        let expected = if i < 4 { 1.0 } else { libm::exp(-1.0) };
        assert!((f64::from(film.pixel(i, j).x) - expected).abs() < 1e-6, "{i}, {j}: {}", film.pixel(i, j));
    }
}

/// Checks the disc of a small distant light through a lens: its area is that of a disc of diameter aperture |focus - z| / focus.
#[test]
fn a_lens_blurs_as_in_perspective() {
    let text = |lens: &str| {
        format!(
            r#"(film: (width: 40, height: 40), sampling: (samples: 4096), ambient: (1, 1, 1),
            camera: (position: (0, 0, 0), view: (0, 0, 1), orthographic: 4{lens}),
            materials: {{ "m": (k_a: 1) }},
            entities: [(shape: Sphere(radius: 0.2), material: "m", transform: (translation: (0, 0, 15)))])"#
        )
    };
    let (sharp, blurred) = (film(&text("")), film(&text(", lens: (aperture: 2, focus: 10)")));
    assert!((mean(&sharp) / mean(&blurred) - 1.0).abs() < 2e-2, "{} {}", mean(&sharp), mean(&blurred));
    // A disc of radius 0.5, widened by the sphere's own radius.
    let extent = |film: &Film| (0..40).filter(|i| film.pixel(*i, 20).x > 0.0).count();
    assert!(
        extent(&sharp) == 4 && (13..=14).contains(&extent(&blurred)),
        "{} {}",
        extent(&sharp),
        extent(&blurred)
    );
}

#[test]
fn fast_and_reference_paths_have_the_same_bits() {
    use rayreel::systems::RenderSettings;
    use rayreel::{RenderRequest, Time};
    for samples in [1, 4] {
        for camera in [
            "position: (3, 4, -9), target: (0, 0, 0), orthographic: 4",
            "position: (3, 1, -2), target: (0, 0, 0), orthographic: 6, roll: 30",
            "position: (0, 9, 0), view: (0, -1, 0), up: (0, 0, 1), orthographic: 400",
            "position: (0.3, 0, -1.3), view: (0, 0, 1), orthographic: 3, lens: (aperture: 0.2, focus: 2)",
            "position: (3e8, 4e8, -9e8), target: (0, 0, 0), orthographic: 4",
        ] {
            let scene = Scene::from_text("fast.ron", scene(camera, samples)).unwrap();
            let mut engine = Engine::from_scene(scene);
            let request = RenderRequest { reference: true, ..RenderRequest::at(Time::ZERO) };
            let expected = engine.render(request).unwrap().film;
            for (name, level) in rayreel::trace::SimdLevel::all() {
                engine.settings = RenderSettings { simd: Some(level), ..RenderSettings::default() };
                assert!(engine.render(Time::ZERO).unwrap().film == expected, "{name}: {camera}");
            }
        }
    }
}
