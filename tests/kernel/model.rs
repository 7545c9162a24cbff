//! Tests of the shading model, on scenes small enough to be computed by hand.

use glam::DVec3;

use rayreel::components::Name;
use rayreel::{Engine, Ray};

fn engine(body: &str) -> Engine {
    crate::engine(&format!("Scene({body})"))
}

/// Returns the bytes of the only pixel, which is straight ahead of the camera.
fn pixel(body: &str) -> [u8; 3] {
    let mut engine = engine(&format!("film: (width: 1, height: 1, transfer: Classic), {body}"));
    let film = engine.render_frame(0).unwrap();
    engine.effective_settings().film.transfer.encode(film.pixel(0, 0))
}

/// Renders one shape at the origin with a camera at (0, 0, -5) that looks along z.
fn look_at(shape: &str, material: &str, more: &str) -> [u8; 3] {
    pixel(&format!(
        r#"camera: (position: (0, 0, -5), view: (0, 0, 1)),
        materials: {{ "m": {material} }},
        entities: [(shape: {shape}, material: "m"), {more}"#
    ))
}

fn name(engine: &Engine, hit: &rayreel::Hit) -> String {
    engine.world().get::<&Name>(hit.entity).unwrap().0.clone()
}

#[test]
fn ambient_light_is_k_a_times_colour_times_intensity() {
    let ball = "Sphere(radius: 1)";
    let lit = |material: &str| look_at(ball, material, "], ambient: (0.5, 1, 0)");
    assert_eq!(lit("(k_a: 0.5, color: (200, 100, 50))"), [50, 50, 0]);
    assert_eq!(lit("(k_a: 1, color: (200, 100, 50), ambient_color: (20, 30, 40))"), [10, 30, 0]);
    assert_eq!(lit("(k_d: 1)"), [0, 0, 0]);
    // Values are at most 255.
    assert_eq!(look_at(ball, "(k_a: 1)", "], ambient: (9, 9, 9)"), [255; 3]);
}

#[test]
fn file_colours_round_trip_in_both_transfers() {
    for transfer in ["Classic", "Srgb"] {
        let film = format!("film: (width: 1, height: 1, transfer: {transfer})");
        let mut engine = engine(&format!(
            r##"{film}, camera: (position: (0, 0, -5), view: (0, 0, 1)), ambient: (1, 1, 1),
            materials: {{ "m": (k_a: 1, color: "#0d80f3") }}, entities: [(shape: Sphere(radius: 1), material: "m")]"##
        ));
        let film = engine.render_frame(0).unwrap();
        assert_eq!(
            engine.effective_settings().film.transfer.encode(film.pixel(0, 0)),
            [0x0d, 0x80, 0xf3],
            "{transfer}"
        );
    }
}

#[test]
fn diffuse_light_is_k_d_times_colour_times_intensity_times_cosine() {
    let matte = "(k_d: 0.8, color: (200, 100, 50))";
    // The normal at (0, 0, -1) is -z.
    let lit = |light: &str| look_at("Sphere(radius: 1)", matte, &format!("{light}]"));
    assert_eq!(
        lit("(light: Point(intensity: (1, 1, 1)), transform: (translation: (0, 0, -9)))"),
        [160, 80, 40]
    );
    // 60 degrees off: cos = 1/2, at any distance.
    for distance in [2.0_f64, 2000.0] {
        let (y, z) = (distance * 0.75_f64.sqrt(), -1.0 - distance * 0.5);
        let light =
            format!("(light: Point(intensity: (1, 0.5, 0)), transform: (translation: (0, {y:?}, {z:?})))");
        assert_eq!(lit(&light), [80, 20, 0], "{distance}");
    }
    // Two lights add up; a light behind the surface adds nothing; a directional light travels along its direction.
    let front = "(light: Directional(intensity: (0.5, 0.5, 0.5)))";
    let behind = "(light: Directional(intensity: (1, 1, 1), direction: (0, 0, -1)))";
    assert_eq!(lit(&format!("{front}, {front}, {behind}")), [160, 80, 40]);
    // A rotation by +90 degrees about y takes z to x: light from the side adds nothing, light from behind adds nothing, and a full turn
    // changes nothing.
    for (degrees, expected) in [(90, [0; 3]), (180, [0; 3]), (360, [80, 40, 20])] {
        let turned = format!(
            "(light: Directional(intensity: (0.5, 0.5, 0.5)), transform: (rotation: Euler(0, {degrees}, 0)))"
        );
        assert_eq!(lit(&turned), expected, "{degrees}");
    }
}

#[test]
fn highlights_are_k_s_times_intensity_times_a_power_of_the_half_cosine() {
    let at = |degrees: f64| {
        let (sine, cosine) = libm::sincos(degrees.to_radians());
        format!("transform: (translation: (0, {:?}, {:?}))", 7.0 * sine, -1.0 - 7.0 * cosine)
    };
    let lit = |material: &str, degrees: f64| {
        let light = format!("(light: Point(intensity: (1, 0.5, 0)), {})]", at(degrees));
        look_at("Sphere(radius: 1)", &format!("({material}, k_a: 0, color: (9, 9, 9))"), &light)
    };
    // Straight ahead, H is N. The material's colour has no effect.
    for shininess in ["0", "1", "32", "1e6"] {
        assert_eq!(lit(&format!("specular: (k_s: 0.4, shininess: {shininess})"), 0.0), [102, 51, 0]);
    }
    // A light 60 degrees off: H is 30 degrees off, (N.H)^2 = 3/4.
    assert_eq!(lit("specular: (k_s: 1, shininess: 2)", 60.0), [191, 96, 0]);
    assert_eq!(lit("specular: (k_s: 1, shininess: 4)", 60.0), [143, 72, 0]);
    assert_eq!(lit("specular: (k_s: 1, shininess: 1e6)", 60.0), [0; 3]);
    // Diffuse light adds 0.6 of 9 times cos 60 degrees, which is 2.7.
    assert_eq!(lit("k_d: 0.6, specular: (k_s: 1, shininess: 2)", 60.0), [194, 97, 0]);
    // Behind the surface there is no highlight, although N.H is cos 50 degrees.
    assert_eq!(lit("specular: (k_s: 1, shininess: 1)", 100.0), [0; 3]);
    // Two lights add up, and an occluder of a light hides its highlight, too.
    let wall = r#"(shape: Box(size: (1, 1, 0.1)), material: "m", transform: (translation: (0, 0, -7)))"#;
    let ahead = "(light: Point(intensity: (1, 1, 1)), transform: (translation: (0, 0, -9)))";
    let material = "(specular: (k_s: 0.2, shininess: 9))";
    assert_eq!(look_at("Sphere(radius: 1)", material, &format!("{ahead}, {ahead}]")), [102; 3]);
    assert_eq!(look_at("Sphere(radius: 1)", material, &format!("{ahead}, {wall}]")), [0; 3]);
}

#[test]
fn highlights_change_over_time() {
    let mut engine = engine(
        r#"timeline: (fps: 1, duration: 3), film: (width: 1, height: 1, transfer: Classic), camera: (position: (0, 0, -5), view: (0, 0, 1)),
        materials: { "m": (specular: (k_s: 1, shininess: 7)) },
        entities: [(name: "ball", shape: Sphere(radius: 1), material: "m"),
            (light: Point(intensity: (1, 1, 1)), transform: (translation: (0, 6.062177826491071, -4.5))) ],
        animate: [(material: "m", channel: Ks, track: Keys([(0, 0), (2, 0.8)])),
            (target: "ball", channel: Shininess, track: Keys([(0, 2, Hold), (2, 4)]))]"#,
    );
    // 60 degrees off, as above.
    for (frame, expected) in [(0, 0.0), (1, 0.4 * 0.75), (2, 0.8 * 0.5625)] {
        let film = engine.render_frame(frame).unwrap();
        assert!((film.pixel(0, 0).x - expected).abs() < 1e-6, "{frame}: {}", film.pixel(0, 0));
    }
}

#[test]
fn mirrored_highlights_are_seen_from_the_mirror() {
    // The mirror turns the view upwards, where it meets the ceiling at (0, 5, 0) head on, as the light does. Seen from the eye itself, the
    // highlight would be 45 degrees off.
    let body = r#"camera: (position: (0, 0, -5), view: (0, 0, 1)),
        materials: { "mirror": (reflective: (k_r: 0.5)), "gloss": (specular: (k_s: 0.8, shininess: 1000)) },
        entities: [
            (shape: Plane(normal: (0, 1, -1)), material: "mirror"),
            (shape: Plane(normal: (0, 1, 0)), material: "gloss", transform: (translation: (0, 5, 0))),
            (light: Point(intensity: (1, 1, 1)), transform: (translation: (0, 1, 0))),
        ]"#;
    assert_eq!(pixel(body), [102; 3]);
}

#[test]
fn shadow_rays_are_cast_only_to_contributing_lights() {
    let asked = |material: &str, light: &str| {
        let mut engine = engine(&format!(
            r#"film: (width: 1, height: 1, transfer: Classic), camera: (position: (0, 0, -5), view: (0, 0, 1)),
            materials: {{ "m": {material} }}, entities: [(shape: Sphere(radius: 1), material: "m"), {light}]"#
        ));
        engine.render_frame(0).unwrap();
        engine.report().rays.shadow
    };
    let light = "(light: Point(intensity: (1, 0, 0)), transform: (translation: (0, 0, -9)))";
    for (material, expected) in [
        ("(k_d: 1)", 1),
        ("(k_d: 1, color: (0, 255, 255))", 0),
        ("(specular: (k_s: 0.5, shininess: 32))", 1),
        ("(specular: (k_s: 0, shininess: 32))", 0),
        ("(k_d: 1, specular: (k_s: 0.5, shininess: 32))", 1),
    ] {
        assert_eq!(asked(material, light), expected, "{material}");
    }
    let everywhere =
        "(light: Point(intensity: (1, 1, 1), casts_shadows: false), transform: (translation: (0, 0, -9)))";
    assert_eq!(asked("(k_d: 1)", everywhere), 0);
    let turned = |degrees: u32| {
        format!(
            "(light: Spot(intensity: (1, 1, 1), angle: 60), transform: (translation: (0, 0, -9), rotation: Euler({degrees}, 0, 0)))"
        )
    };
    assert_eq!(asked("(k_d: 1)", &turned(29)), 1);
    assert_eq!(asked("(k_d: 1)", &turned(31)), 0);
    let side = "(light: Point(intensity: (1, 1, 1)), transform: (translation: (0, 9, -4)))";
    assert_eq!(asked("(specular: (k_s: 0.5, shininess: 1e6))", side), 0, "far from any highlight");
    assert_eq!(asked("(k_d: 1, specular: (k_s: 0.5, shininess: 1e6))", side), 1);
}

#[test]
fn occluders_cast_shadows() {
    let matte = "(k_d: 1, color: (100, 100, 100))";
    let light = "(light: Point(intensity: (1, 1, 1)), transform: (translation: (0, 8, -9)))";
    let wall = |y: f64, z: f64| {
        format!(
            r#"{light}, (shape: Box(size: (9, 0.1, 0.1)), material: "m", transform: (translation: (0, {y}, {z})))]"#
        )
    };
    let cosine = 71; // 100 cos 45 degrees, rounded
    assert_eq!(look_at("Sphere(radius: 1)", matte, &wall(4.0, -5.0)), [0; 3], "half-way");
    assert_eq!(look_at("Sphere(radius: 1)", matte, &wall(9.0, -10.0)), [cosine; 3], "behind the light");
    assert_eq!(look_at("Sphere(radius: 1)", matte, &wall(4.0, -2.0)), [cosine; 3], "beside");
}

#[test]
fn light_without_shadows_reaches_facing_surfaces() {
    let matte = "(k_d: 1, color: (100, 100, 100))";
    let lit = |light: &str, z: f64| {
        let wall = r#"(shape: Box(size: (9, 9, 0.1)), material: "m", transform: (translation: (0, 0, -7)))"#;
        let at = format!("transform: (translation: (0, 0, {z:?}))");
        look_at("Sphere(radius: 1)", matte, &format!("(light: {light}, {at}), {wall}]"))
    };
    let (sun, lamp) = ("Directional(intensity: (1, 1, 1)", "Point(intensity: (1, 1, 1)");
    for light in [sun, lamp] {
        assert_eq!(lit(&format!("{light})"), -9.0), [0; 3]);
        assert_eq!(lit(&format!("{light}, casts_shadows: true)"), -9.0), [0; 3]);
        assert_eq!(lit(&format!("{light}, casts_shadows: false)"), -9.0), [100; 3]);
    }
    assert_eq!(lit(&format!("{lamp}, casts_shadows: false)"), 9.0), [0; 3], "it is behind the surface");
}

/// Checks that nothing occludes such a light: neither its highlights, nor a transparent surface that it lights from behind.
#[test]
fn light_without_shadows_makes_highlights_and_passes_transparent_shapes() {
    let lit = |material: &str, casts: bool, z: f64| {
        let wall = r#"(shape: Box(size: (9, 9, 0.1)), material: "m", transform: (translation: (0, 0, -7)))"#;
        let light = format!("Point(intensity: (1, 1, 1), casts_shadows: {casts})");
        let light = format!("(light: {light}, transform: (translation: (0, 0, {z:?})))");
        look_at("Plane(normal: (0, 0, -1))", material, &format!("{light}, {wall}], quality: (depth: 1)"))[0]
    };
    for shininess in [0, 1, 1000] {
        let glossy = format!("(specular: (k_s: 0.4, shininess: {shininess}))");
        assert_eq!([true, false].map(|casts| lit(&glossy, casts, -9.0)), [0, 102], "{shininess}");
        assert_eq!(lit(&glossy, false, 9.0), 0, "a highlight of what is behind");
    }
    // The surface shows k_d |N.L|, times k_t if its own shadow counts.
    for gloss in ["", "specular: (k_s: 1, shininess: 0)"] {
        let clear = format!("(k_d: 0.6, color: (255, 255, 255), refractive: (k_t: 0.5, ior: 1), {gloss})");
        // The black background is visible through the surface as well.
        assert_eq!([true, false].map(|casts| lit(&clear, casts, 9.0)), [77, 153], "{gloss}");
    }
    assert_eq!([true, false].map(|casts| lit("(k_d: 0.6)", casts, 9.0)), [0, 0], "opaque");
}

#[test]
fn falloff_weakens_a_light_with_distance() {
    let lit = |falloff: &str, distance: f64| {
        let light = format!(
            "(light: Point(intensity: (1, 0.5, 0), falloff: {falloff}), transform: (translation: (0, 0, {:?})))]",
            -1.0 - distance
        );
        look_at("Sphere(radius: 1)", "(k_d: 1, color: (200, 200, 200))", &light)
    };
    assert_eq!(lit("(1, 0, 0)", 4.0), [200, 100, 0]);
    assert_eq!(lit("(2, 0, 0)", 4.0), [100, 50, 0]);
    assert_eq!(lit("(1, 1, 0)", 4.0), [40, 20, 0]);
    assert_eq!(lit("(1, 0, 1)", 3.0), [20, 10, 0]);
    assert_eq!(lit("(2, 3, 0.5)", 4.0), [9, 5, 0]); // 2 + 12 + 8: 200 / 22 = 9.09
    assert_eq!(lit("(1e-60, 0, 1)", 1.0), [200, 100, 0]);
    assert_eq!(lit("(1, 0, 1e60)", 1e30), [0; 3]);
    // Distances are in world units, whatever the scale of the light. Falloff weakens highlights, too.
    let scaled = "(light: Point(intensity: (1, 1, 1), falloff: (1, 1, 0)), transform: (translation: (0, 0, -5), scale: 9))]";
    assert_eq!(look_at("Sphere(radius: 1)", "(k_d: 1, color: (200, 200, 200))", scaled), [40; 3]);
    assert_eq!(look_at("Sphere(radius: 1)", "(specular: (k_s: 1, shininess: 99))", scaled), [51; 3]);
}

#[test]
fn a_spot_shines_into_a_cone_about_its_forward_axis() {
    let lit = |spot: &str, turned: &str| {
        let light = format!(
            "(light: Spot(intensity: (1, 0.5, 0), {spot}), transform: (translation: (0, 0, -9), rotation: {turned}))]"
        );
        look_at("Sphere(radius: 1)", "(k_d: 1, color: (200, 200, 200))", &light)
    };
    for axis in ["(1, 0, 0)", "(0, 1, 0)", "(1, 2, 0)"] {
        let by = |degrees: f64| format!("AxisAngle({axis}, {degrees:?})");
        for (degrees, expected) in [(0.0, 200), (29.9, 200), (30.1, 0), (-29.9, 200), (-30.1, 0), (180.0, 0)]
        {
            assert_eq!(lit("angle: 60", &by(degrees)), [expected, expected / 2, 0], "{degrees} about {axis}");
        }
        // A factor of 1/2 half-way between the cosines of 15 and of 30 degrees, and of 5/32 a quarter of the way.
        let (inner, outer) = (libm::cos(15_f64.to_radians()), libm::cos(30_f64.to_radians()));
        for (way, expected) in [(-0.1, 0), (0.25, 31), (0.5, 100), (0.75, 169), (1.1, 200)] {
            let degrees = libm::acos(outer + way * (inner - outer)).to_degrees();
            assert_eq!(lit("angle: 60, softness: 0.5", &by(degrees))[0], expected, "{way}");
        }
        assert_eq!(lit("angle: 180", &by(89.9))[0], 200);
        assert_eq!(lit("angle: 180", &by(90.1))[0], 0);
        assert_eq!(lit("angle: 180, softness: 1", &by(60.0))[0], 100);
    }
    // At a distance of 8 the value is 200 / 5. A wall in between occludes the light.
    assert_eq!(lit("angle: 60, falloff: (1, 0.5, 0)", "Euler(0, 0, 0)"), [40, 20, 0]);
    let wall = r#"(shape: Box(size: (1, 1, 0.1)), material: "m", transform: (translation: (0, 0, -7)))"#;
    let spot = "(light: Spot(intensity: (1, 1, 1), angle: 9), transform: (translation: (0, 0, -9)))";
    assert_eq!(look_at("Sphere(radius: 1)", "(k_d: 1)", &format!("{spot}, {wall}]")), [0; 3]);
}

#[test]
fn lamp_shape_does_not_occlude_its_light() {
    let matte = "(k_d: 1, color: (100, 100, 100))";
    let lamp = r#"(shape: Sphere(radius: 0.5), material: "m", light: Point(intensity: (1, 1, 1)),
        transform: (translation: (0, 8, -9)))]"#;
    assert_eq!(look_at("Sphere(radius: 1)", matte, lamp), [71; 3]);
}

#[test]
fn planes_have_two_sides_and_shells_are_seen_from_inside() {
    let matte = "(k_d: 1, color: (100, 100, 100))";
    let light = "(light: Point(intensity: (1, 1, 1)), transform: (translation: (0, 0, -4)))]";
    for normal in ["(0, 0, 1)", "(0, 0, -1)"] {
        assert_eq!(look_at(&format!("Plane(normal: {normal})"), matte, light), [100; 3]);
    }
    // The camera and the light are both inside.
    assert_eq!(look_at("Sphere(radius: 20)", matte, light), [100; 3]);
    assert_eq!(look_at("Box(size: (20, 20, 20))", matte, light), [100; 3]);
    // The shell itself occludes a light outside.
    let outside = "(light: Point(intensity: (1, 1, 1)), transform: (translation: (0, 0, -30)))]";
    assert_eq!(look_at("Sphere(radius: 20)", matte, outside), [0; 3]);
    assert_eq!(look_at("Box(size: (20, 20, 20))", matte, outside), [0; 3]);
}

#[test]
fn mirrors_reflect_k_r_until_the_depth_limit() {
    let facing = |depth: u32| {
        pixel(&format!(
            r#"camera: (position: (0, 0, 0), view: (0, 0, 1)), quality: (depth: {depth}), background: (200, 0, 0),
            ambient: (1, 1, 1), materials: {{ "m": (k_a: 1, color: (0, 64, 0), reflective: (k_r: 0.5)) }},
            entities: [
                (shape: Plane(normal: (0, 0, 1)), material: "m", transform: (translation: (0, 0, 5))),
                (shape: Plane(normal: (0, 0, 1)), material: "m", transform: (translation: (0, 0, -5))),
            ]"#
        ))
    };
    assert_eq!(facing(1), [100, 64, 0]); // one surface, then the background untraced
    assert_eq!(facing(2), [50, 96, 0]);
    assert_eq!(facing(3), [25, 112, 0]);
    assert_eq!(look_at("Sphere(radius: 1)", "(reflective: (k_r: 1))", "], background: (7, 8, 9)"), [7, 8, 9]);
}

#[test]
fn first_of_coincident_surfaces_is_seen() {
    let pair = |first: &str, second: &str| {
        pixel(&format!(
            r#"camera: (position: (0, 0, -5), view: (0, 0, 1)), ambient: (1, 1, 1),
            materials: {{ "red": (k_a: 1, color: (255, 0, 0)), "blue": (k_a: 1, color: (0, 0, 255)) }},
            entities: [(shape: {first}, material: "red"), (shape: {second}, material: "blue")]"#
        ))
    };
    let shapes = ["Sphere(radius: 1)", "Box(size: (2, 2, 2))"];
    for first in shapes {
        for second in shapes {
            assert_eq!(pair(first, second), [255, 0, 0], "{first} before {second}");
        }
    }
    assert_eq!(pair("Plane(normal: (0, 0, 1))", "Plane(normal: (0, 0, -1))"), [255, 0, 0]);
}

#[test]
fn parents_turn_scale_and_move_their_children() {
    let mut engine = engine(
        r#"camera: (position: (0, 0, -5), view: (0, 0, 1)), materials: { "m": (k_a: 1) }, entities: [
            (name: "hand", parent: "arm", shape: Sphere(radius: 1), material: "m", transform: (translation: (0, 0, 3))),
            (name: "arm", parent: "body", transform: (rotation: Euler(0, 90, 0), scale: 0.5)),
            (name: "body", transform: (translation: (10, 0, 0))),
            (name: "egg", parent: "body", shape: Sphere(radius: 1), material: "m",
             transform: (translation: (0, 5, 0), scale: (1, 3, 1))),
        ]"#,
    );
    engine.seek(rayreel::Time::ZERO).unwrap();
    // The arm takes z to x and halves distances: the hand is at (11.5, 0, 0) with a radius of 0.5.
    let hit = engine.cast(Ray { origin: DVec3::new(20.0, 0.0, 0.0), direction: DVec3::NEG_X }).unwrap();
    assert_eq!(name(&engine, &hit), "hand");
    assert!((hit.distance - 8.0).abs() < 1e-12 && (hit.normal - DVec3::X).length() < 1e-12, "{hit:?}");
    let hit = engine.cast(Ray { origin: DVec3::new(10.0, 20.0, 0.0), direction: DVec3::NEG_Y }).unwrap();
    assert_eq!(name(&engine, &hit), "egg");
    assert!((hit.distance - 12.0).abs() < 1e-12);
}

#[test]
fn spawned_rays_do_not_hit_their_surface_again() {
    let mut engine = engine(
        r#"camera: (position: (0, 0, -5), view: (0, 0, 1)), materials: { "m": (k_a: 1) }, entities: [
            (name: "shell", shape: Sphere(radius: 1e6), material: "m", transform: (translation: (0, 1e6, 0))),
            (name: "crate", shape: Box(size: (0.1, 0.1, 0.1)), material: "m",
             transform: (translation: (3, 1000, 7), rotation: Euler(10, 20, 30))),
        ]"#,
    );
    engine.seek(rayreel::Time::ZERO).unwrap();
    let mut state = 1_u64;
    let mut random = || {
        state = state.wrapping_mul(6_364_136_223_846_793_005).wrapping_add(1_442_695_040_888_963_407);
        (state >> 11) as f64 / (1_u64 << 53) as f64 - 0.5
    };
    let mut left = 0;
    for _ in 0..20_000 {
        let offset = DVec3::new(random(), random(), random());
        if offset.length() < 0.1 {
            continue; // perhaps inside the crate
        }
        let origin = DVec3::new(3.0, 1000.0, 7.0) + offset;
        let Some(hit) = engine.cast(Ray { origin, direction: DVec3::new(random(), random(), random()) })
        else {
            continue;
        };
        // A direction nearly along the surface. Inside the shell it is a chord of some two hundred units.
        let along = hit.normal.cross(DVec3::new(random(), random(), random())) + hit.normal * 1e-4;
        if let Some(next) = engine.cast(hit.leave_towards(along)) {
            assert!(next.entity != hit.entity || next.distance > 1.0, "{hit:?} {next:?}");
            left += 1;
        }
    }
    assert!(left > 10_000);
}

#[test]
fn distances_are_in_units_of_the_given_direction() {
    let mut engine = engine(
        r#"camera: (position: (0, 2, -8), target: (0, 0, 0)), materials: { "m": () }, entities: [
            (name: "floor", material: "m", shape: Plane(normal: (0, 1, 0))),
            (name: "ceiling", material: "m", shape: Box(size: (8, 0.5, 8)), transform: (translation: (0, 3.25, 0), rotation: Euler(0, 30, 0))),
            (name: "ball", material: "m", shape: Sphere(radius: 0.5), transform: (translation: (0, 1, 0))),
        ]"#,
    );
    engine.seek(rayreel::Time::ZERO).unwrap();
    for length in [5e-324, 1e-308, 1e-300, 3e-7, 0.7, 1.0, 5.0, 1e20, 1e300, 1e308] {
        // Down to the floor next to the ball, up to the ceiling, and towards the ball.
        let down =
            engine.cast(Ray { origin: DVec3::new(1.0, 2.0, 0.0), direction: DVec3::NEG_Y * length }).unwrap();
        let towards = |direction: DVec3| engine.cast(down.leave_towards(direction)).unwrap();
        let (up, aside) = (towards(DVec3::Y * length), towards(DVec3::new(-1.0, 1.0, 0.0) * length));
        for (hit, way) in [(down, 2.0), (up, 3.0), (aside, 2.0_f64.sqrt() - 0.5)] {
            let unit = if way == 2.0 || way == 3.0 { length } else { 2.0_f64.sqrt() * length };
            assert!((hit.distance - way).abs() < 1e-15, "{hit:?}");
            match hit.t {
                Some(t) if length > 1e-300 => {
                    assert!((t * unit - way).abs() < 1e-15 * way, "{length:e}: {hit:?}");
                }
                // Subnormal lengths have few digits.
                Some(t) => assert!((t / (way / unit) - 1.0).abs() < 1e-7, "{length:e}: {hit:?}"),
                None => assert!(way / unit > f64::MAX * 0.999, "{length:e}: {hit:?}"),
            }
        }
    }
    // A hit before t = 1 occludes a light.
    let floor = engine.cast(Ray { origin: DVec3::new(0.0, 0.2, 0.0), direction: DVec3::NEG_Y }).unwrap();
    let light = DVec3::new(0.0, 2.0, 0.0);
    let hit = engine.cast(floor.leave_towards(light - floor.point)).unwrap();
    assert!(hit.t.is_some_and(|t| t < 1.0));
}

#[test]
fn closed_mirror_box_does_not_leak() {
    // Whole columns of pixels lie on edges.
    for (shape, rotation) in [
        ("Box(size: (2, 2, 2))", "Euler(0, 0, 0)"),
        ("Box(size: (2, 2, 2))", "Euler(0, 45, 0)"),
        ("Sphere(radius: 1)", "Euler(0, 0, 0)"),
    ] {
        let mut engine = engine(&format!(
            r#"film: (width: 101, height: 101, transfer: Classic), quality: (depth: 8), background: (255, 0, 0),
            camera: (position: (0, 0, 0), view: (0, 0, 1), screen: (distance: 1, width: 4, height: 4)),
            materials: {{ "m": (reflective: (k_r: 0.5)) }},
            entities: [(shape: {shape}, material: "m", transform: (rotation: {rotation}))]"#
        ));
        let film = engine.render_frame(0).unwrap();
        // After eight bounces, the background has a weight of 0.5^8.
        let leaks = film.pixels().iter().filter(|pixel| pixel.x != 1.0 / 256.0).count();
        assert_eq!(leaks, 0, "{shape} {rotation}");
    }
}

#[test]
fn faces_one_unit_in_the_last_place_apart_do_not_shadow_each_other() {
    // 0.15 + 0.15 is 0.3, and 0.2 + 0.1 is 0.30000000000000004.
    let low = r#"(shape: Box(size: (4, 0.3, 4)), material: "m", transform: (translation: (0, 0.15, 0)))"#;
    let high = r#"(shape: Box(size: (4, 0.2, 4)), material: "m", transform: (translation: (1, 0.2, 0)))"#;
    let plane = r#"(shape: Plane(normal: (0, 1, 0)), material: "m", transform: (translation: (0, 0.3, 0)))"#;
    for shapes in [[low, high], [high, low], [plane, high], [high, plane], [plane, low]] {
        let mut engine = engine(&format!(
            r#"film: (width: 33, height: 33, transfer: Classic), camera: (position: (0.5, 9, 0.3), view: (0, -1, 0), up: (0, 0, 1), fov: 12),
            materials: {{ "m": (k_d: 1, color: (200, 200, 200)) }},
            entities: [{}, (light: Directional(intensity: (1, 1, 1), direction: (0.1, -1, 0.2)))]"#,
            shapes.join(", ")
        ));
        let film = engine.render_frame(0).unwrap();
        assert!(film.pixels().iter().all(|pixel| pixel.x > 0.7), "{shapes:?}");
    }
}

#[test]
fn coincident_shells_act_as_one_shell() {
    let shell = r#"(shape: Sphere(radius: 10), material: "m")"#;
    let picture = |shells: &str| {
        let mut engine = engine(&format!(
            r#"film: (width: 33, height: 33, transfer: Classic), quality: (depth: 6), background: (255, 0, 0), ambient: (1, 1, 1),
            camera: (position: (1, 2, 3), view: (0, 0, 1)),
            materials: {{ "m": (k_a: 0.1, k_d: 0.5, color: (90, 120, 150), reflective: (k_r: 0.5)) }},
            entities: [{shells}, (light: Point(intensity: (1, 1, 1)), transform: (translation: (-4, 5, 0)))]"#
        ));
        engine.render_frame(0).unwrap()
    };
    let one = picture(shell);
    assert!(one == picture(&[shell, shell].join(", ")));
    assert!(one == picture(&[shell; 5].join(", ")));
}
