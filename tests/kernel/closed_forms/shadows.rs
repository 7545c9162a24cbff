//! Tests of shadows of transparent shapes: k_t at every crossing, exp(-a l) inside, along a straight path.

use glam::DVec3;

use super::{assert_near, seen, triple};

/// Returns the colour at `lit` of a white floor at y = 0 with k_d 1, lit by a light at `light` through these entities.
fn floor(lit: DVec3, light: DVec3, materials: &str, entities: &str) -> [f64; 3] {
    // The camera is close to the floor, so that nothing else is in front of it.
    let from = lit + DVec3::new(0.0, 1e-3, -1e-2);
    seen(
        from,
        lit - from,
        &format!(
            r#"quality: (depth: 1), materials: {{ "floor": (k_d: 1), {materials} }},
            entities: [(shape: Plane(normal: (0, 1, 0)), material: "floor"), {entities},
                (light: Point(intensity: (1, 1, 1)), transform: (translation: {}))]"#,
            triple(light)
        ),
    )
    .to_array()
    .map(f64::from)
}

/// Returns the length of a straight path within a ball.
fn chord(from: DVec3, to: DVec3, center: DVec3, radius: f64) -> f64 {
    let along = (to - from).normalize();
    let distance = (center - from).cross(along).length();
    if distance < radius { 2.0 * (radius * radius - distance * distance).sqrt() } else { 0.0 }
}

const ABSORPTION: [f64; 3] = [0.5, 1.0, 0.0];

#[test]
fn a_ball_dims_by_its_chord() {
    let (light, center) = (DVec3::new(0.5, 6.0, 1.0), DVec3::new(0.2, 2.0, 0.3));
    let glass = r#""glass": (refractive: (k_t: 0.8, ior: 1.5, absorption: (0.5, 1, 0)))"#;
    let ball = format!(
        r#"(shape: Sphere(radius: 1), material: "glass", transform: (translation: {}))"#,
        triple(center)
    );
    let mut through = 0;
    for x in [-2.0, -1.2, -0.7, -0.1, 0.05, 0.6, 1.4, 3.0] {
        let lit = DVec3::new(x, 0.0, 0.1);
        let length = chord(lit, light, center, 1.0);
        through += u32::from(length > 0.0);
        let crossings = if length > 0.0 { 0.64 } else { 1.0 };
        for (found, absorption) in floor(lit, light, glass, &ball).into_iter().zip(ABSORPTION) {
            let cosine = (light - lit).normalize().y;
            assert_near(found, cosine * crossings * libm::exp(-absorption * length), 1e-6);
        }
    }
    assert!((3..8).contains(&through), "{through}");
}

#[test]
fn a_slab_dims_by_its_thickness_over_the_cosine() {
    let light = DVec3::new(1.0, 6.0, 0.0);
    let glass = r#""glass": (refractive: (k_t: 0.8, ior: 1.5, absorption: (0.5, 1, 0)))"#;
    let slab = r#"(shape: Box(size: (90, 0.6, 90)), material: "glass", transform: (translation: (0, 2, 0)))"#;
    for x in [-7.0, -2.0, 1.0, 4.0] {
        let lit = DVec3::new(x, 0.0, 0.0);
        let cosine = (light - lit).normalize().y;
        for (found, absorption) in floor(lit, light, glass, slab).into_iter().zip(ABSORPTION) {
            assert_near(found, cosine * 0.64 * libm::exp(-absorption * 0.6 / cosine), 1e-6);
        }
    }
}

/// Checks that every crossed surface applies its own k_t, and that inside, the solid entered last absorbs.
#[test]
fn nested_balls_absorb_separately() {
    let (light, center) = (DVec3::new(0.5, 6.0, 1.0), DVec3::new(0.2, 2.0, 0.3));
    let materials = r#""outer": (refractive: (k_t: 0.9, ior: 1.33, absorption: (0.5, 0, 0.3))),
        "inner": (refractive: (k_t: 0.7, ior: 1.5, absorption: (0, 2, 0.6)))"#;
    let ball = |radius: f64, material: &str| {
        let place = triple(center);
        format!(
            r#"(shape: Sphere(radius: {radius:?}), material: "{material}", transform: (translation: {place}))"#
        )
    };
    for order in [[ball(1.0, "outer"), ball(0.5, "inner")], [ball(0.5, "inner"), ball(1.0, "outer")]] {
        for x in [-0.9, -0.5, -0.1, 0.05, 0.6] {
            let lit = DVec3::new(x, 0.0, 0.1);
            let inner = chord(lit, light, center, 0.5);
            let outer = chord(lit, light, center, 1.0) - inner;
            let crossings = if inner > 0.0 { 0.81 * 0.49 } else { 0.81 };
            let depths = [0.5 * outer, 2.0 * inner, 0.3 * outer + 0.6 * inner];
            for (found, depth) in floor(lit, light, materials, &order.join(", ")).into_iter().zip(depths) {
                let cosine = (light - lit).normalize().y;
                assert_near(found, cosine * crossings * libm::exp(-depth), 1e-6);
            }
        }
    }
}

/// Checks a light in the centre of a glass ball: its path has one crossing, and the length of the radius in glass.
#[test]
fn a_light_inside_glass_shines_out() {
    let light = DVec3::new(0.0, 3.0, 0.0);
    let glass = r#""glass": (refractive: (k_t: 0.8, ior: 1.5, absorption: (0.5, 1, 0)))"#;
    let ball = r#"(shape: Sphere(radius: 1.5), material: "glass", transform: (translation: (0, 3, 0)))"#;
    for x in [-4.0, 0.0, 1.0] {
        let lit = DVec3::new(x, 0.0, 0.0);
        let cosine = (light - lit).normalize().y;
        for (found, absorption) in floor(lit, light, glass, ball).into_iter().zip(ABSORPTION) {
            assert_near(found, cosine * 0.8 * libm::exp(-absorption * 1.5), 1e-6);
        }
    }
}

#[test]
fn opaque_shapes_occlude_light_behind_and_before_glass() {
    let (lit, light) = (DVec3::ZERO, DVec3::new(0.0, 6.0, 0.0));
    let materials = r#""glass": (refractive: (k_t: 0.8, ior: 1.5)), "opaque": (k_a: 1)"#;
    let at = |y: f64, material: &str| {
        format!(
            r#"(shape: Box(size: (1, 0.1, 1)), material: "{material}", transform: (translation: (0, {y:?}, 0)))"#
        )
    };
    let through = |entities: [String; 2]| floor(lit, light, materials, &entities.join(", "))[0];
    assert_eq!(through([at(2.0, "glass"), at(3.0, "opaque")]), 0.0);
    assert_eq!(through([at(3.0, "glass"), at(2.0, "opaque")]), 0.0);
    assert_eq!(through([at(2.0, "opaque"), at(3.0, "glass")]), 0.0);
    assert_near(through([at(2.0, "glass"), at(7.0, "opaque")]), 0.64, 1e-7);
    assert_near(through([at(2.0, "glass"), at(3.0, "glass")]), 0.64 * 0.64, 1e-7);
}

/// Checks that a light behind a surface adds k_d |N.L|, and that the surface itself counts as crossed, once.
#[test]
fn transparent_surface_is_lit_from_behind() {
    let lit = |material: &str, shape: &str, light: DVec3| {
        seen(
            DVec3::new(0.0, 0.0, -5.0),
            DVec3::Z,
            &format!(
                r#"quality: (depth: 1), materials: {{ "m": (k_d: 0.5, {material}) }},
                entities: [(shape: {shape}, material: "m", transform: (translation: (0, 0, 1))),
                    (light: Point(intensity: (1, 1, 1)), transform: (translation: {}))]"#,
                triple(light)
            ),
        )
        .to_array()
        .map(f64::from)
    };
    let glass = "refractive: (k_t: 0.8, ior: 1.5, absorption: (0.5, 1, 0))";
    for (x, depth) in [(0.0, 1.5), (2.0, 0.5), (-3.0, 4.0)] {
        // The light is in the half-space: one crossing, and all of its path inside.
        let to_light = DVec3::new(x, 0.0, depth);
        let light = to_light + DVec3::Z;
        let (length, cosine) = (to_light.length(), depth / to_light.length());
        let found = lit(glass, "Plane(normal: (0, 0, -1))", light);
        for (found, absorption) in found.iter().zip(ABSORPTION) {
            assert_near(*found, 0.5 * cosine * 0.8 * libm::exp(-absorption * length), 1e-6);
        }
        let glossy = format!("{glass}, specular: (k_s: 1, shininess: 0)");
        assert_eq!(lit(&glossy, "Plane(normal: (0, 0, -1))", light), found, "there is no highlight");
        assert_eq!(lit("", "Plane(normal: (0, 0, -1))", light), [0.0; 3], "opaque");
        // The camera is inside, the light outside: all of the camera's path of 6 absorbs, and none of the light's path.
        let found = lit(glass, "Plane(normal: (0, 0, 1))", light);
        for (found, absorption) in found.into_iter().zip(ABSORPTION) {
            assert_near(found, 0.5 * cosine * 0.8 * libm::exp(-absorption * 6.0), 1e-6);
        }
    }
    // The light is beyond a box: its path crosses the near face and the far face, and absorbs in between.
    let light = DVec3::new(1.0, 0.0, 9.0);
    let cosine = (light - DVec3::ZERO).normalize().z;
    let found = lit(glass, "Box(size: (90, 90, 2))", light);
    for (found, absorption) in found.into_iter().zip(ABSORPTION) {
        assert_near(found, 0.5 * cosine * 0.64 * libm::exp(-absorption * 2.0 / cosine), 1e-6);
    }
}

#[test]
fn lamp_is_not_attenuated_by_its_own_shape() {
    // The lamp's own shape must not absorb, whether the lit point is inside it (radius 2) or outside (radius 0.1).
    for (lamp, seen_from) in
        [("radius: 2", DVec3::new(0.0, 0.5, 0.0)), ("radius: 0.1", DVec3::new(0.0, 0.5, 0.0))]
    {
        let lit = |absorption: f64| {
            let tree = super::tree(
                seen_from,
                DVec3::NEG_Y,
                &format!(
                    r#"materials: {{ "m": (k_d: 1), "glass": (refractive: (k_t: 1, ior: 1, absorption: ({absorption:?}, 2, 0))) }}, entities: [
                    (shape: Plane(normal: (0, 1, 0)), material: "m", transform: (translation: (0, -1, 0))),
                    (shape: Sphere({lamp}), material: "glass", light: Point(intensity: (1, 1, 1)), transform: (translation: (0.5, 0, 0)))]"#
                ),
            );
            tree.last().unwrap().end.light()
        };
        assert_eq!(lit(3.0), lit(0.0), "{lamp}");
        assert!(lit(3.0).max_element() > 0.1);
    }
}
