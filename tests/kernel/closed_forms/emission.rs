//! Tests of surfaces that give off light.

use glam::DVec3;

use rayreel::Rgb;

use super::{assert_near, film, seen};

const LIGHT: Rgb = Rgb::new(4.0, 3.5, 0.25);

/// Returns the fields of a scene with a lamp and with these materials and entities.
fn with_lamp(materials: &str, entities: &str) -> String {
    format!(
        r#"materials: {{ "lamp": (emission: (4, 3.5, 0.25)), {materials} }}, entities: [{entities}], quality: (cutoff: 0)"#
    )
}

/// Returns the light along a ray from the origin along z.
fn ahead(materials: &str, entities: &str) -> Rgb {
    seen(DVec3::ZERO, DVec3::Z, &with_lamp(materials, entities))
}

/// A plane across the z axis.
fn wall(material: &str, z: f64) -> String {
    format!(
        r#"(shape: Plane(normal: (0, 0, -1)), material: "{material}", transform: (translation: (0, 0, {z:?}))), "#
    )
}

#[test]
fn an_emissive_sphere_on_black_shows_its_emission_everywhere() {
    let sphere = with_lamp("", r#"(shape: Sphere(radius: 1), material: "lamp")"#);
    let film = film(&format!(
        "film: (width: 32, height: 32), camera: (position: (0, 0, -5), view: (0, 0, 1), fov: 40), {sphere}"
    ));
    let lit = film.pixels().iter().filter(|pixel| **pixel == LIGHT).count();
    let dark = film.pixels().iter().filter(|pixel| **pixel == Rgb::ZERO).count();
    assert!(lit > 200 && dark > 200 && lit + dark == 32 * 32, "{lit} {dark}");
}

#[test]
fn emission_is_on_both_sides_and_adds_to_other_light() {
    assert_eq!(ahead("", &wall("lamp", 2.0)), LIGHT);
    assert_eq!(seen(DVec3::ZERO, DVec3::NEG_Z, &with_lamp("", &wall("lamp", -2.0))), LIGHT);
    for shape in ["Sphere(radius: 1)", "Box(size: (2, 2, 2))"] {
        assert_eq!(ahead("", &format!(r#"(shape: {shape}, material: "lamp")"#)), LIGHT, "{shape}");
    }
    let lights = ", ambient: (0.5, 0.5, 0.5)";
    let board = "k_a: 0.5, k_d: 0.5, pattern: Checker(color: (0, 0, 0), size: 9)";
    for (material, ambient) in [("k_a: 0.5, k_d: 0.5", 0.25), (board, 0.25)] {
        let body = with_lamp(
            &format!(r#""m": ({material}, emission: (1, 2, 3))"#),
            &(wall("m", 2.0) + "(light: Directional(intensity: (0.5, 0.5, 0.5)))"),
        );
        let found = seen(DVec3::new(1.0, 1.0, 0.0), DVec3::Z, &(body + lights));
        assert_eq!(found, Rgb::new(1.0, 2.0, 3.0) + Rgb::splat(ambient + 0.25), "{material}");
    }
}

#[test]
fn emission_is_seen_in_mirrors_and_through_glass() {
    let mirror = r#""mirror": (reflective: (k_r: 0.5))"#;
    assert_eq!(ahead(mirror, &format!("{}{}", wall("mirror", 2.0), wall("lamp", -1.0))), LIGHT * 0.5);
    let glass = r#""glass": (refractive: (k_t: 0.5, ior: 1.5))"#;
    let pane = r#"(shape: Box(size: (9, 9, 1)), material: "glass", transform: (translation: (0, 0, 2))), "#;
    assert_eq!(ahead(glass, &format!("{pane}{}", wall("lamp", 4.0))), LIGHT * 0.25);
}

#[test]
fn fog_dims_emission() {
    let body = with_lamp("", &wall("lamp", 2.0)) + ", fog: (color: (51, 102, 204), density: 0.3)";
    let share = libm::exp(-0.6);
    let found = seen(DVec3::ZERO, DVec3::Z, &body);
    for (channel, fog) in [0.2, 0.4, 0.8].into_iter().enumerate() {
        let expected = share * f64::from(LIGHT[channel]) + (1.0 - share) * fog;
        assert_near(f64::from(found[channel]), expected, 1e-6);
    }
}

#[test]
fn emission_lights_nothing_else() {
    let clay = r#""clay": (k_a: 1, k_d: 1)"#;
    assert_eq!(ahead(clay, &format!("{}{}", wall("clay", 2.0), wall("lamp", -0.5))), Rgb::ZERO);
}

/// Checks that the cutoff takes the lamp's light into account: a mirror too faint for light of 1 shows a lamp of 1000.
#[test]
fn faint_mirrors_show_bright_lamps() {
    let shown = |emission: &str| {
        let body = format!(
            r#"materials: {{ "lamp": (emission: {emission}), "mirror": (reflective: (k_r: 0.00002)) }},
            entities: [{}{}]"#,
            wall("mirror", 2.0),
            wall("lamp", -1.0)
        );
        seen(DVec3::ZERO, DVec3::Z, &body)
    };
    assert_eq!(shown("(1, 1, 1)"), Rgb::ZERO);
    assert_eq!(shown("(1000, 1000, 1000)"), Rgb::splat(1000.0 * 0.000_02));
}
