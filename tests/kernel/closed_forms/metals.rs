//! Tests of metals, whose highlights and reflected light have the colour of the material.

use glam::DVec3;

use rayreel::Rgb;

use super::seen;

const GOLD: Rgb = Rgb::new(0.8, 0.6, 0.2);
const LIGHT: Rgb = Rgb::new(4.0, 3.5, 0.25);
/// A lamp behind the origin.
const LAMP: &str =
    r#"(shape: Plane(normal: (0, 0, 1)), material: "lamp", transform: (translation: (0, 0, -1)))"#;

/// Returns the light along a ray from the origin along z, towards a shape of a metal of the colour [`GOLD`].
fn ahead(shape: &str, fields: &str, others: &str) -> Rgb {
    let body = format!(
        r#"materials: {{ "gold": (color: (204, 153, 51), metallic: true, {fields}), "lamp": (emission: (4, 3.5, 0.25)) }},
        entities: [(shape: {shape}, material: "gold", transform: (translation: (0, 0, 2))), {others}], quality: (cutoff: 0)"#
    );
    seen(DVec3::ZERO, DVec3::Z, &body)
}

#[test]
fn reflected_light_has_the_colour_of_the_metal_and_refracted_light_has_not() {
    let wall = "Plane(normal: (0, 0, -1))";
    assert_eq!(ahead(wall, "reflective: (k_r: 0.5)", LAMP), LIGHT * (GOLD * 0.5));
    let behind = LAMP.replace("(0, 0, -1)", "(0, 0, 4)").replace("(0, 0, 1)", "(0, 0, -1)");
    let pane = "specular: (k_s: 1, shininess: 9), refractive: (k_t: 0.5, ior: 1)";
    assert_eq!(ahead("Box(size: (9, 9, 1))", pane, &behind), LIGHT * 0.25);
}

#[test]
fn highlights_have_the_colour_of_the_metal() {
    let (wall, light) =
        ("Plane(normal: (0, 0, -1))", "(light: Directional(intensity: (0.5, 1, 2), direction: (0, 0, 1)))");
    let highlight = Rgb::new(0.25, 0.5, 1.0) * GOLD;
    assert_eq!(ahead(wall, "specular: (k_s: 0.5, shininess: 9)", light), highlight);
    // Diffuse light is there only if it is written.
    let diffuse = GOLD * 0.5 * Rgb::new(0.5, 1.0, 2.0);
    assert_eq!(ahead(wall, "k_d: 0.5, specular: (k_s: 0.5, shininess: 9)", light), diffuse + highlight);
}
