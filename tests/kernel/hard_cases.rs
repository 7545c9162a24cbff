//! Tests of hard cases outside of intersection, each with its defined outcome.
//!
//! | case | outcome |
//! |---|---|
//! | camera at its target | refused in a file; at a time of an animation it looks along +z |
//! | up parallel to the view | refused in a file below an angle of 1e-9; in an animation, below 1e-12, y or else z is up |
//! | up nearly parallel | right and up of the picture are perpendicular to the last bits |
//! | directions of any length | of views, ups, normals, axes and lights only the direction counts, down to a length of 5e-324 |
//! | a resolution of 1 | the middle of the screen |
//! | sizes and scales of zero | refused in a file; at a time of an animation, the entity is not drawn |
//! | sizes of any magnitude | the same picture, from 1e-60 to 1e60 |
//! | transforms that lose all digits | the same picture by both paths |
//! | rotations | the short way, of unit length, exact to the last bits; for a half turn, the sign decides the direction |
//! | keys | at the same time: refused; one key: always; at adjacent floating-point times: a jump |
//! | empty scenes | the background |
//! | heaps of coincident shapes | as one shape |
//! | numbers that are not finite | refused in every position |
//!
//! Rays against single shapes are in `numerics` and `oracle`, flush faces in `model` and among the goldens, the messages of refusals in
//! `tests/scenes/messages.rs`, and random input in `tests/robustness`. `RAYREEL_CASES=1000000` sets a larger size of heaps.

use std::f64::consts::{PI, TAU};

use dashu_float::FBig;
use glam::{DQuat, DVec3};
use serde_json::Value;

use rayreel::animation::{Ease, Easing, Key, Rotation, Track, slerp};
use rayreel::components::{
    Ambient, Background, Camera, FilmSettings, Light, LightKind, Material, Quality, Reflective, Shape,
    Transform, View,
};
use rayreel::{Engine, Film, RenderRequest, Rgb, Scene, Time, World, trace};

use crate::engine;

/// The smallest number, numbers near the limits of squares, the largest number, and numbers in between.
const LENGTHS: [f64; 10] =
    [5e-324, 1e-310, f64::MIN_POSITIVE, 1e-300, 1e-160, 1.0, 1e160, 1e300, 8.9e307, f64::MAX];

const BLUE: Background = Background::Flat(Rgb::new(0.1, 0.2, 0.3));

fn refusal(text: &str) -> String {
    let error = Scene::from_text("hard.ron", text.to_owned()).err();
    let error = error.unwrap_or_else(|| panic!("not refused: {text}"));
    assert!(error.mistakes().all(|mistake| mistake.position.is_some()), "{text}: {error}");
    error.mistakes().next().unwrap().diagnostic.message.clone()
}

/// Returns a scene with a ball, a reflective crate and lights, for tests of the camera.
fn scene(camera: &str, animate: &str) -> String {
    format!(
        r#"Scene(timeline: (fps: 1, duration: 3), film: (width: 24, height: 14, transfer: Classic), camera: ({camera}), ambient: (0.3, 0.3, 0.3),
        background: (40, 80, 120), materials: {{ "clay": (k_a: 0.5, k_d: 0.5, color: (200, 100, 50)),
            "glass": (k_a: 0.2, k_d: 0.2, reflective: (k_r: 0.5)) }},
        entities: [
            (name: "ball", shape: Sphere(radius: 1), material: "clay", transform: (translation: (-1, 0, 5))),
            (name: "crate", shape: Box(size: (1, 2, 3)), material: "glass",
             transform: (translation: (1, 0.5, 5), rotation: Euler(0, 30, 0))),
            (name: "lamp", light: Point(intensity: (1, 1, 1)), transform: (translation: (-3, 4, 0))),
            (name: "sun", light: Directional(intensity: (0.4, 0.4, 0.4), direction: (1, -1, 1))),
        ], animate: [{animate}])"#
    )
}

fn pictures_of(text: &str) -> [Film; 3] {
    let mut engine = engine(text);
    [0, 1, 2].map(|frame| engine.render_frame(frame).unwrap())
}

/// Returns the right, up and forward axes of a camera, computed from its rays.
fn axes(view: DVec3, up: DVec3) -> [DVec3; 3] {
    let camera = |distance, size| trace::PreparedCamera::new(DVec3::ZERO, view, up, distance, size, (3, 3));
    // The sizes differ so much that a ray shows only one axis.
    let (huge, tiny) = (libm::ldexp(1.0, 300), libm::ldexp(1.0, -300));
    [
        camera(tiny, (2.0 * huge, tiny)).towards(2, 1) / huge,
        camera(tiny, (tiny, 2.0 * huge)).towards(1, 0) / huge,
        camera(huge, (tiny, tiny)).towards(1, 1) / huge,
    ]
}

/// Returns a unit vector along a x b, exact to the last bits.
fn exact_across(a: DVec3, b: DVec3) -> DVec3 {
    let [a, b] =
        [a, b].map(|v| v.to_array().map(|part| FBig::try_from(part).unwrap().with_precision(400).value()));
    let cross: [FBig; 3] = std::array::from_fn(|axis| {
        let (next, last) = ((axis + 1) % 3, (axis + 2) % 3);
        &a[next] * &b[last] - &a[last] * &b[next]
    });
    let largest = cross.iter().map(|part| part.to_f64().value().abs()).fold(0.0, f64::max);
    let scale: FBig = FBig::try_from(largest).unwrap().with_precision(400).value();
    DVec3::from_array(cross.map(|part| (part / &scale).to_f64().value())).normalize()
}

#[test]
fn camera_at_its_target_is_an_error_or_looks_forward() {
    let message = refusal(&scene("position: (1, 2, 3), target: (1, 2, 3)", ""));
    assert_eq!(message, "the camera's target is where it stands");
    let passing = r#"(target: "camera", channel: Target, track: Keys([(0, (-9, 0, 0)), (2, (9, 0, 0))]))"#;
    let [_, met, _] = pictures_of(&scene("position: (0, 0, 0), target: (0, 0, 1)", passing));
    let [forward, ..] = pictures_of(&scene("position: (0, 0, 0), view: (0, 0, 1)", ""));
    assert!(met == forward);
}

#[test]
fn targets_may_be_arbitrarily_near() {
    let [expected, ..] = pictures_of(&scene("position: (0, 0, 0), view: (0, 0, 1), up: (1, 1, 0)", ""));
    for distance in [5e-324, 1e-300, 1e-100, 1e60] {
        let target = format!("position: (0, 0, 0), target: (0, 0, {distance:?}), up: (1, 1, 0)");
        assert!(pictures_of(&scene(&target, ""))[0] == expected, "{distance:e}");
        let aside = format!("position: (0, 0, 0), target: ({distance:?}, 0, 0)");
        assert!(pictures_of(&scene(&aside, ""))[0] != expected, "{distance:e}");
    }
}

#[test]
fn camera_axes_are_perpendicular_for_any_up() {
    let views =
        [DVec3::Y, DVec3::new(1.0, 2.0, 3.0), DVec3::new(-0.3, 0.9, 1e-5), DVec3::new(3.0, 1e-3, 7.0)];
    for view in views {
        for exponent in 3..=17 {
            for side in [DVec3::X, DVec3::new(0.3, -0.2, 0.7)] {
                let angle: f64 = format!("1e-{exponent}").parse().unwrap();
                let up = view.normalize() + side * angle;
                let [right, upward, forward] = axes(view, up);
                let shown =
                    format!("view {view}, up 1e-{exponent} off along {side}: {right} {upward} {forward}");
                for axis in [right, upward, forward] {
                    assert!((axis.length() - 1.0).abs() < 1e-15, "{shown}");
                }
                let off = [right.dot(upward), upward.dot(forward), forward.dot(right)];
                assert!(off.iter().all(|cosine| cosine.abs() < 1e-15), "{shown}: {off:?}");
                assert!((upward.cross(forward) - right).length() < 1e-15, "{shown}");
                // The axes follow `up` while it has a significant part across the view.
                if exponent <= 11 {
                    assert!((right - exact_across(up, view)).length() < 1e-15, "{shown}");
                }
                if exponent >= 14 {
                    let instead = if view == DVec3::Y { DVec3::Z } else { DVec3::Y };
                    assert!((right - exact_across(instead, view)).length() < 1e-15, "{shown}");
                }
            }
        }
    }
}

#[test]
fn up_parallel_to_the_view_is_an_error() {
    for up in ["(0, 0, 1)", "(0, 0, -1e-60)", "(0, 1e-10, 1)", "(1e-20, 0, 1e10)"] {
        let message = refusal(&scene(&format!("position: (0, 0, 0), view: (0, 0, 5), up: {up}"), ""));
        assert_eq!(message, "the camera's up is parallel to its view", "{up}");
    }
    for up in ["(0, 0, 0)", "(0, 1e-61, 0)", "(5e-324, 1e-300, -0.0)"] {
        let message = refusal(&scene(&format!("position: (0, 0, 0), view: (0, 0, 1), up: {up}"), ""));
        assert_eq!(message, "up has no direction", "{up}");
    }
    assert!(
        Scene::from_text("hard.ron", scene("position: (0, 0, 0), view: (0, 0, 5), up: (0, 1e-8, 1)", ""))
            .is_ok()
    );
}

/// Returns true if vectors differ only in the last bits.
fn same(found: impl IntoIterator<Item = DVec3>, expected: impl IntoIterator<Item = DVec3>) -> bool {
    found.into_iter().zip(expected).all(|(found, expected)| (found - expected).length() < 1e-15)
}

#[test]
fn length_of_view_and_up_is_irrelevant() {
    for length in LENGTHS {
        for (view, up) in [(DVec3::X, DVec3::Y), (DVec3::NEG_Y, DVec3::Z), (DVec3::Z, DVec3::X)] {
            for (view_length, up_length) in [(length, 1.0), (1.0, length), (length, length)] {
                let found = axes(view * view_length, up * up_length);
                assert!(same(found, axes(view, up)), "{length:e}: {found:?}");
            }
        }
        // Subnormal numbers have too few digits.
        if (f64::MIN_POSITIVE..1e307).contains(&length) {
            let (view, up) = (DVec3::new(1.0, -0.5, 2.0), DVec3::new(0.25, 1.0, 0.5));
            assert!(same(axes(view * length, up * length), axes(view, up)), "{length:e}");
        }
    }
}

#[test]
fn a_resolution_of_one_is_the_middle_of_the_screen() {
    let film = |width: u32, height: u32| {
        let text =
            scene("position: (0, 0, 0), view: (0, 0, 1), screen: (distance: 1, width: 0.8, height: 0.5)", "");
        let mut engine = engine(&text);
        for film in engine.world_mut().query_mut::<&mut FilmSettings>() {
            *film = FilmSettings { width, height, ..*film };
        }
        engine.render_frame(0).unwrap()
    };
    let whole = film(41, 27);
    let (one, row, column) = (film(1, 1), film(41, 1), film(1, 27));
    assert_eq!(one.pixel(0, 0), whole.pixel(20, 13));
    assert!((0..41).all(|i| row.pixel(i, 0) == whole.pixel(i, 13)));
    assert!((0..27).all(|j| column.pixel(0, j) == whole.pixel(20, j)));
    for (width, height) in [(1, 1), (1, 9), (9, 1)] {
        let text = format!(
            "Scene(film: (width: {width}, height: {height}, transfer: Classic), background: (9, 9, 9), camera: (position: (0, 0, 0), view: (0, 0, 1), fov: 60))"
        );
        assert!(
            engine(&text)
                .render_frame(0)
                .unwrap()
                .pixels()
                .iter()
                .all(|pixel| *pixel == Rgb::splat(9.0 / 255.0))
        );
    }
}

/// Returns a world with one shape, a sun along `light`, and a camera at -5 that looks along +z.
fn world(shape: Shape, transform: Transform, light: DVec3) -> World {
    let mut world = World::new();
    let material =
        Material { k_a: 0.2, k_d: 0.8, color: Rgb::new(0.9, 0.6, 0.3), ambient_color: None, metallic: false };
    world.spawn((shape, transform, material));
    let kind = LightKind::Directional { direction: light };
    world.spawn((Light::new(kind, Rgb::ONE), Transform::IDENTITY));
    world.spawn((Camera::default(),));
    let film = FilmSettings { width: 24, height: 14, ..FilmSettings::default() };
    world.spawn((film, Ambient(Rgb::ONE), BLUE, Quality { depth: 2, ..Quality::default() }));
    world
}

fn film_of(world: World) -> Film {
    Engine::new(world).render_frame(0).unwrap()
}

fn is_blank(film: &Film) -> bool {
    film.pixels().iter().all(|pixel| *pixel == film.pixel(0, 0))
}

#[test]
fn length_of_normals_and_light_directions_is_irrelevant() {
    let plane = |normal: DVec3, light: DVec3| {
        film_of(world(Shape::Plane { normal }, Transform::from_translation(DVec3::NEG_Y), light))
    };
    let expected = plane(DVec3::Y, DVec3::NEG_Y);
    assert!(!is_blank(&expected));
    for length in LENGTHS {
        assert!(plane(DVec3::Y * length, DVec3::NEG_Y) == expected, "normal {length:e}");
        assert!(plane(DVec3::Y, DVec3::NEG_Y * length) == expected, "light {length:e}");
    }
    // Without a direction there is no plane and no light.
    assert!(is_blank(&plane(DVec3::ZERO, DVec3::NEG_Y)));
    assert!(plane(DVec3::Y, DVec3::ZERO) == plane(DVec3::Y, DVec3::Y));
}

#[test]
fn length_of_rotation_axes_is_irrelevant() {
    let turned = |rotation: Rotation| [DVec3::X, DVec3::Y, DVec3::Z].map(|axis| rotation.quaternion() * axis);
    for length in LENGTHS {
        let about = |length: f64| turned(Rotation::AxisAngle(DVec3::Y * length, 1.0));
        assert!(same(about(length), about(1.0)), "{length:e}");
        let quaternion = |length: f64| turned(Rotation::Quat(0.0, length, 0.0, -length));
        assert!(same(quaternion(length), quaternion(1.0)), "{length:e}");
    }
}

#[test]
fn sizes_and_scales_of_zero_are_errors() {
    let entity = |entity: &str| {
        refusal(&format!(
            r#"Scene(camera: (position: (0, 0, 0), view: (0, 0, 1)), materials: {{ "m": () }}, entities: [({entity})])"#
        ))
    };
    let shape = |shape: &str| entity(&format!(r#"shape: {shape}, material: "m""#));
    for zero in ["0", "-0.0", "5e-324", "1e-61", "1e-400"] {
        let value: f64 = zero.parse().unwrap();
        let refused = |what: &str| match value {
            0.0 => format!("{what} must be greater than 0, not {value}"),
            _ => format!("{what} must be at least 1e-60, not {value:e}"),
        };
        let radius = shape(&format!("Sphere(radius: {zero})"));
        assert_eq!(radius, refused("the radius"));
        let edge = shape(&format!("Box(size: (1, {zero}, 1))"));
        assert_eq!(edge, refused("every edge of a box"));
        assert_eq!(shape(&format!("Plane(normal: (0, {zero}, 0))")), "the normal has no direction");
        for scale in [zero.to_owned(), format!("(1, 1, {zero})")] {
            let expected = match value {
                0.0 => "a scale of 0 leaves nothing".to_owned(),
                _ => format!("{value:e} is too small for a scale"),
            };
            assert_eq!(entity(&format!("transform: (scale: {scale})")), expected);
        }
        let axis = entity(&format!("transform: (rotation: AxisAngle(({zero}, 0, 0), 90))"));
        assert_eq!(axis, "the axis of the rotation has no direction");
        let light = entity(&format!("light: Directional(intensity: (1, 1, 1), direction: (0, {zero}, 0))"));
        assert_eq!(light, "the direction has no direction");
    }
}

#[test]
fn zero_scale_hides_the_entity_for_that_moment() {
    for keys in ["(0, 1), (2, -1)", "(0, (1, 1, 1)), (2, (1, 1, -1))"] {
        let camera = "position: (-1, 0, 0), view: (0, 0, 1), fov: 12";
        let track = format!(r#"(target: "ball", channel: Scale, track: Keys([{keys}]))"#);
        let [before, at, after] = pictures_of(&scene(camera, &track));
        let background = DVec3::new(40.0, 80.0, 120.0).as_vec3() / 255.0;
        assert!(at.pixels().iter().all(|pixel| *pixel == background), "{keys}");
        assert!(before == after && before.pixels().iter().all(|pixel| *pixel != background), "{keys}");
    }
}

#[test]
fn light_without_a_direction_is_off_for_that_moment() {
    let camera = "position: (0, 0, 0), view: (0, 0, 1)";
    let turning = r#"(target: "sun", channel: Direction, track: Keys([(0, (0, 0, 1)), (2, (0, 0, -1))]))"#;
    let off = r#"(target: "sun", channel: Intensity, track: Keys([(0, (0, 0, 0))]))"#;
    let [_, at, _] = pictures_of(&scene(camera, turning));
    assert!(at == pictures_of(&scene(camera, off))[1]);
}

/// Checks that powers of two change no bit while all numbers stay in range.
#[test]
fn shapes_of_any_size_look_alike() {
    let rotation = DQuat::from_xyzw(0.1, 0.2, 0.3, 0.9).normalize();
    let way = DVec3::new(0.3, 1.0, -0.2);
    let things = [
        (Shape::Sphere { radius: 1.5 }, DVec3::ONE, DQuat::IDENTITY),
        (Shape::Sphere { radius: 1.0 }, DVec3::new(1.5, 0.5, -1.0), rotation),
        (Shape::Box { size: DVec3::new(2.0, 1.0, 3.0) }, DVec3::ONE, DQuat::IDENTITY),
        (Shape::Box { size: DVec3::new(2.0, 1.0, 3.0) }, DVec3::new(1.0, 2.0, 1.0), rotation),
        (Shape::Cylinder { radius: 0.8, from: -way, to: way }, DVec3::ONE, rotation),
        (Shape::Cylinder { radius: 0.8, from: -way, to: way }, DVec3::new(1.0, 2.0, 1.0), rotation),
        (Shape::Capsule { radius: 0.8, from: -way, to: way }, DVec3::ONE, rotation),
        (Shape::Capsule { radius: 0.8, from: -way, to: way }, DVec3::new(1.5, 0.5, -1.0), rotation),
    ];
    for (shape, scale, rotation) in things {
        // The size is in the shape, in the scale, or half in one and half in the other.
        let picture = |exponent: i32, of_shape: i32| {
            let power = |exponent: i32| libm::ldexp(1.0, exponent);
            let inner = power(of_shape);
            let shape = match shape {
                Shape::Sphere { radius } => Shape::Sphere { radius: radius * inner },
                Shape::Box { size } => Shape::Box { size: size * inner },
                Shape::Plane { normal } => Shape::Plane { normal },
                Shape::Cylinder { radius, from, to } => {
                    Shape::Cylinder { radius: radius * inner, from: from * inner, to: to * inner }
                }
                Shape::Capsule { radius, from, to } => {
                    Shape::Capsule { radius: radius * inner, from: from * inner, to: to * inner }
                }
            };
            let transform =
                Transform { translation: DVec3::ZERO, rotation, scale: scale * power(exponent - of_shape) };
            let mut world = world(shape, transform, DVec3::new(1.0, -2.0, 3.0));
            for camera in world.query_mut::<&mut Camera>() {
                camera.position *= power(exponent);
            }
            film_of(world)
        };
        let expected = picture(0, 0);
        assert!(!is_blank(&expected));
        for exponent in [-480, -199, -60, 60, 199, 480] {
            for of_shape in [0, exponent / 2, exponent] {
                assert!(
                    picture(exponent, of_shape) == expected,
                    "{shape:?} times 2^{exponent}, 2^{of_shape} of it in the shape"
                );
            }
        }
    }
}

/// Checks distances whose squares overflow. `oracle` has the general rule; these cases occurred in practice.
#[test]
fn rays_from_extreme_distances_miss() {
    let miss = |entity: &str, origin: [f64; 3], direction: DVec3| {
        let mut engine = engine(&format!(
            r#"Scene(camera: (position: (0, 0, -9), target: (0, 0, 0)), materials: {{ "m": () }}, entities: [(material: "m", {entity})])"#
        ));
        engine.seek(Time::ZERO).unwrap();
        let origin = DVec3::from_array(origin);
        assert!(engine.cast(rayreel::Ray { origin, direction }).is_none(), "{entity}");
        // A ray from as far away that is aimed at a shape hits it.
        let aimed = rayreel::Ray { origin: direction * -origin.abs().max_element(), direction };
        let mut there = crate::engine(
            r#"Scene(camera: (position: (0, 0, -9), target: (0, 0, 0)), materials: { "m": () }, entities: [
                (material: "m", shape: Sphere(radius: 1), transform: (scale: (1, 2, 1), rotation: Euler(10, 20, 30)))])"#,
        );
        there.seek(Time::ZERO).unwrap();
        assert!(there.cast(aimed).is_some());
    };
    miss("shape: Sphere(radius: 1)", [1e308, 50.0, -8.0], DVec3::NEG_X);
    let ellipsoid = "shape: Sphere(radius: 1), transform: (translation: (5, 0, 0), rotation: Euler(10, 20, 30), scale: (1, 2, 1))";
    miss(ellipsoid, [1e200, 50.0, -8.0], DVec3::NEG_X);
    let tiny = "shape: Sphere(radius: 1), transform: (scale: (1.25e-23, 2.5e-23, 3.75e-23),
        rotation: Quat(0.0565, -2.0377, 0.0338, -1.5035))";
    miss(tiny, [-2.74e140, -5.53e140, -3.67e139], DVec3::Y);
}

#[test]
fn tiny_shapes_are_hit_before_huge_ones() {
    let text = |tiny: &str, near: &str, huge: &str| {
        format!(
            r#"Scene(film: (width: 3, height: 3, transfer: Classic), camera: (position: (0, 0, -{near}), view: (0, 0, 1), fov: 90), ambient: (1, 1, 1),
            materials: {{ "red": (k_a: 1, color: (255, 0, 0)), "blue": (k_a: 1, color: (0, 0, 255)) }}, entities: [
                (shape: Sphere(radius: {huge}), material: "blue"), (shape: Sphere(radius: {tiny}), material: "red")])"#
        )
    };
    for (tiny, near, huge) in
        [("1e-60", "4e-60", "1e60"), ("1", "4", "1e60"), ("1e-60", "4e-60", "1"), ("1e-30", "4e-30", "1e30")]
    {
        let film = engine(&text(tiny, near, huge)).render_frame(0).unwrap();
        for (index, pixel) in film.pixels().iter().enumerate() {
            let expected = if index == 4 { Rgb::X } else { Rgb::Z };
            assert_eq!(*pixel, expected, "{tiny} in {huge}, pixel {index}");
        }
    }
}

/// Checks a rotated child of a parent whose scales differ so much that the smaller ones vanish in the product.
#[test]
fn paths_agree_on_maps_that_lose_all_digits() {
    for ratio in ["1e6", "1e8", "1e12", "1e16", "1e17", "7.149242111760633e18", "1e30"] {
        for shape in [
            "Sphere(radius: 0.01)",
            "Box(size: (0.01, 0.02, 0.03))",
            "Cylinder(radius: 0.01, height: 0.03)",
            "Capsule(radius: 0.01, from: (0.01, 0, 0), to: (0, 0.03, 0))",
        ] {
            let text = format!(
                r#"Scene(film: (width: 32, height: 18, transfer: Classic), camera: (position: (0, -2, 0), target: (0, 0, -1)), ambient: (1, 1, 1),
                materials: {{ "m": (k_a: 1) }}, entities: [(name: "p", transform: (translation: (4.579567336728584e54, 0, 0),
                scale: ({ratio}, 180, -0.8573814706000129), rotation: Quat(-1.1974842809408361, 0, -1.8180114775544707, -2))), (parent: "p",
                shape: {shape}, material: "m", transform: (rotation: AxisAngle((1.7201252341157094, -1.8373047611384268, 0), 1.5969372108396579e56)))])"#
            );
            let mut engine = engine(&text);
            let fast = engine.render(Time::ZERO).unwrap().film;
            assert!(
                engine
                    .render(RenderRequest { reference: true, ..RenderRequest::at(Time::ZERO) })
                    .unwrap()
                    .film
                    == fast,
                "{ratio} {shape}"
            );
        }
    }
}

fn about(axis: DVec3, angle: f64) -> DQuat {
    let (sine, cosine) = libm::sincos(0.5 * angle);
    DQuat::from_vec4((axis.normalize() * sine).extend(cosine))
}

#[test]
fn slerp_is_exact_where_others_were_not() {
    let parts = |value: &Value| -> [f64; 4] {
        let part = |part: &Value| part.as_f64().unwrap_or_else(|| part.as_str().unwrap().parse().unwrap());
        std::array::from_fn(|index| part(&value[index]))
    };
    for line in include_str!("numerics/slerp.jsonl").lines() {
        let case: Value = serde_json::from_str(line).unwrap();
        let end = |name: &str| {
            let [x, y, z, w] = parts(&case[name]);
            Rotation::Quat(x, y, z, w).quaternion()
        };
        let found = slerp(end("from"), end("to"), case["fraction"].as_f64().unwrap());
        let expected = DQuat::from_array(parts(&case["exact"]));
        let error = (found - expected).length();
        // Four units in the last place of 1, because both ends are rounded before.
        assert!(
            error <= 4.0 * f64::EPSILON,
            "{}: {found} instead of {expected}, {error:e} off",
            case["source"]
        );
    }
}

#[test]
fn slerp_takes_the_short_way_at_constant_speed_and_unit_length() {
    let half_turn_and_more = [PI - 1e-9, PI - 1e-15, PI, PI + 1e-15, PI + 1e-9, 4.0, TAU - 1e-9, TAU];
    let small = [
        0.0, 5e-324, 1e-300, 1e-160, 1e-17, 1e-16, 1e-15, 1e-9, 1e-8, 1e-7, 1e-6, 1.5e-6, 3e-6, 1e-5, 1e-3,
        1.0,
    ];
    for axis in [DVec3::Y, DVec3::new(1.0, -2.0, 0.5)] {
        for angle in small.into_iter().chain(half_turn_and_more) {
            for start in [DQuat::IDENTITY, about(DVec3::new(0.2, 1.0, -3.0), 2.0)] {
                for sign in [1.0, -1.0] {
                    let end = about(axis, angle) * start * sign;
                    let short = if angle > PI { angle - TAU } else { angle };
                    for step in 0..=16 {
                        let u = f64::from(step) / 16.0;
                        let found = slerp(start, end, u);
                        let shown = format!("{angle:e} about {axis} from {start}, sign {sign}, {u}: {found}");
                        assert!((found.length() - 1.0).abs() <= 2.0 * f64::EPSILON, "{shown}");
                        let off =
                            |expected: DQuat| (found - expected).length().min((found + expected).length());
                        let mut error = off(about(axis, u * short) * start);
                        if (angle - PI).abs() < 1e-14 {
                            // Both directions are equally short.
                            error = error.min(off(about(axis, u * (short - TAU)) * start));
                        }
                        assert!(error <= 4.0 * f64::EPSILON, "{shown}: {error:e} off");
                    }
                }
            }
        }
    }
    // For an exact half turn, the sign decides the direction.
    let half = DQuat::from_xyzw(0.0, 1.0, 0.0, 0.0);
    let quarter = about(DVec3::Y, 0.5 * PI);
    assert!((slerp(DQuat::IDENTITY, half, 0.5) - quarter).length() < 1e-15);
    assert!((slerp(DQuat::IDENTITY, -half, 0.5) - quarter.conjugate()).length() < 1e-15);
}

fn track(keys: &[(f64, f64, Easing)]) -> Option<Track<f64>> {
    Track::new(keys.iter().map(|&(time, value, easing)| Key { time, value, easing }).collect())
}

const EASINGS: [Easing; 14] = [
    Easing::Hold,
    Easing::Linear,
    Easing::EaseIn,
    Easing::EaseOut,
    Easing::EaseInOut,
    Easing::In(Ease::Circ),
    Easing::Out(Ease::Expo),
    Easing::InOut(Ease::Back),
    Easing::Out(Ease::Elastic),
    Easing::Steps(3),
    Easing::Bezier(0.3, -0.6, 0.7, 1.6),
    Easing::Cubic,
    Easing::CatmullRom,
    Easing::Monotone,
];

#[test]
fn equal_key_times_are_errors_and_adjacent_ones_jump() {
    let keys = |keys: &str| {
        scene(
            "position: (0, 0, 0), view: (0, 0, 1)",
            &format!(r#"(target: "ball", channel: Scale, track: Keys([{keys}]))"#),
        )
    };
    assert_eq!(refusal(&keys("(1, 1), (1, 2)")), "a key at 1 s follows one at 1 s");
    assert_eq!(refusal(&keys("(0, 1), (-0.0, 2)")), "a key at -0 s follows one at 0 s");
    assert_eq!(
        refusal(&keys("(1, 1), (0.9999999999999999, 2)")),
        "a key at 0.9999999999999999 s follows one at 1 s"
    );
    assert_eq!(refusal(&keys("")), "a track without keys");
    for easing in EASINGS {
        assert!(track(&[]).is_none() && track(&[(1.0, 1.0, easing), (1.0, 2.0, easing)]).is_none());
        for time in [0.0, 1.0, -7.5, 1e60] {
            let jump = track(&[(time, 3.0, easing), (f64::next_up(time), 5.0, easing)]).unwrap();
            assert_eq!((jump.at(time), jump.at(time.next_up())), (3.0, 5.0), "{easing:?} at {time}");
            assert_eq!((jump.at(-1e60), jump.at(2e60)), (3.0, 5.0), "{easing:?} at {time}");
        }
    }
}

#[test]
fn single_key_is_constant() {
    for easing in EASINGS {
        let single = track(&[(2.0, 7.25, easing)]).unwrap();
        for time in [-1e60, 0.0, 2.0, 2.0 + 1e-9, 1e60] {
            assert_eq!(single.at(time), 7.25, "{easing:?} at {time}");
        }
    }
}

#[test]
fn constant_values_stay_constant_between_dense_keys() {
    for easing in EASINGS {
        for gap in [5e-324, 1e-300, 1e-16, 1e-9, 1e-3, 1.0] {
            let value = 0.3;
            let times = [0.0, gap, 1.0 + gap, 3.0];
            let track = track(&times.map(|time| (time, value, easing))).unwrap();
            for step in 0..=300 {
                let found = track.at(f64::from(step) / 100.0);
                assert!((found - value).abs() < 1e-15, "{easing:?}, {gap:e} apart: {found}");
            }
        }
    }
}

#[test]
fn empty_scene_shows_the_background() {
    let mut empty = Engine::new(World::new());
    let film = empty.render_frame(0).unwrap();
    assert_eq!((film.width(), film.height()), (640, 360));
    assert!(film.pixels().iter().all(|pixel| *pixel == Rgb::ZERO));

    let lamp = "(light: Point(intensity: (1, 1, 1))), (light: Directional(intensity: (1, 1, 1)))";
    for entities in ["", lamp, "(name: \"nobody\")"] {
        let text = format!(
            "Scene(film: (width: 5, height: 4, transfer: Classic), background: (51, 102, 153), ambient: (1, 1, 1), camera: (position: (0, 0, 0), target: (1, 2, 3)), entities: [{entities}])"
        );
        let film = engine(&text).render_frame(0).unwrap();
        assert!(film.pixels().iter().all(|pixel| *pixel == Rgb::new(0.2, 0.4, 0.6)), "{entities}");
    }
    assert_eq!(refusal("Scene()"), "the scene has no camera");
}

/// Returns the number of shapes in a heap: `RAYREEL_CASES`, clamped to 100 000..=1 000 000.
fn heap() -> u32 {
    let asked = std::env::var("RAYREEL_CASES").ok().and_then(|cases| cases.parse().ok());
    asked.unwrap_or(0).clamp(100_000, 1_000_000)
}

/// Renders concentric reflective spheres with a lamp.
fn heap_of_spheres(radii: impl Iterator<Item = f64>) -> Film {
    let mut world = World::new();
    let material =
        Material { k_a: 0.2, k_d: 0.8, color: Rgb::new(0.9, 0.6, 0.3), ambient_color: None, metallic: false };
    let mirror = Reflective { k_r: 0.5 };
    world
        .spawn_batch(radii.map(|radius| (Shape::Sphere { radius }, Transform::IDENTITY, material, mirror)))
        .for_each(drop);
    let lamp = Light::new(LightKind::Point, Rgb::ONE);
    world.spawn((lamp, Transform::from_translation(DVec3::new(-3.0, 4.0, -5.0))));
    world.spawn((Camera { view: View::Direction(DVec3::Z), ..Camera::default() },));
    let film = FilmSettings { width: 5, height: 3, ..FilmSettings::default() };
    world.spawn((film, Ambient(Rgb::ONE), BLUE, Quality { depth: 3, ..Quality::default() }));
    let mut engine = Engine::new(world);
    let film = engine.render(Time::ZERO).unwrap().film;
    assert!(!is_blank(&film));
    film
}

#[test]
fn coincident_spheres_look_like_one() {
    let one = heap_of_spheres(std::iter::once(1.25));
    assert!(heap_of_spheres((0..heap()).map(|_| 1.25)) == one);
}

#[test]
fn concentric_spheres_look_like_the_outermost() {
    let one = heap_of_spheres(std::iter::once(1.25));
    let count = heap();
    let radius = |index: u32| 0.5 + 0.75 * f64::from(index + 1) / f64::from(count);
    assert!(heap_of_spheres((0..count).map(radius)) == one, "outwards");
    assert!(heap_of_spheres((0..count).rev().map(radius)) == one, "inwards");
}

#[test]
fn non_finite_numbers_are_errors_in_every_field() {
    let text = include_str!("../hard_cases/every_number.ron");
    drop(engine(text));
    let is_digit = |character: char| character.is_ascii_digit() || character == '.';
    let (mut count, mut start) = (0, 0);
    while let Some(found) = text[start..].find(|character: char| character.is_ascii_digit()) {
        let begin = start + found;
        let end = begin + text[begin..].find(|character| !is_digit(character)).unwrap();
        start = end;
        count += 1;
        for number in ["inf", "-inf", "NaN", "-NaN", "1e999"] {
            let broken = format!("{}{number}{}", &text[..begin], &text[end..]);
            let error = Scene::from_text("hard.ron", broken).err();
            let error = error.unwrap_or_else(|| panic!("{number} at byte {begin} is not refused"));
            let diagnostic = error.mistakes().next().unwrap().diagnostic;
            assert!(
                (begin..begin + number.len()).contains(&diagnostic.span.as_ref().unwrap().start),
                "{error}"
            );
        }
    }
    assert!(count > 120, "{count}");
}
