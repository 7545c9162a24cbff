//! Tests of absorption in media, and of nested and overlapping media.

use glam::DVec3;

use rayreel::trace::{RayKind, TracedRay};

use super::{assert_near, seen, tilted, tree, unit};

/// Returns plates across z, each between two values of z and of one material, in front of a white background.
fn plates(plates: &[(f64, f64, &str)]) -> String {
    let (mut materials, mut entities) = (String::new(), String::new());
    for (index, (from, to, refractive)) in plates.iter().enumerate() {
        let (thickness, middle) = (to - from, 0.5 * (from + to));
        materials += &format!(r#""{index}": (refractive: {refractive}), "#);
        entities += &format!(
            r#"(shape: Box(size: (1e4, 1e4, {thickness:?})), material: "{index}", transform: (translation: (0, 0, {middle:?}))), "#
        );
    }
    format!(
        "quality: (depth: 12, cutoff: 0), background: (255, 255, 255), materials: {{ {materials} }}, entities: [{entities}]"
    )
}

fn transmitted(angle: f64, body: &str) -> [f64; 3] {
    seen(DVec3::new(0.0, 0.0, -3.0), tilted(angle), body).to_array().map(f64::from)
}

/// Returns the cosine of the angle in a medium, for light that arrives from outside at `angle`.
fn cosine(angle: f64, ior: f64) -> f64 {
    libm::cos(libm::asin(libm::sin(angle) / ior))
}

/// Checks the Beer-Lambert law, exp(-a l) over a path of l = d / cos t, and k_t at each face.
#[test]
fn a_plate_absorbs_along_the_refracted_way() {
    let absorption = [0.25, 1.0, 3.0];
    let plate = plates(&[(0.0, 0.7, "(k_t: 0.9, ior: 1.5, absorption: (0.25, 1, 3))")]);
    for degrees in [0.0, 20.0, 45.0, 70.0, 88.0] {
        let angle = f64::to_radians(degrees);
        let length = 0.7 / cosine(angle, 1.5);
        let found = transmitted(angle, &plate);
        for (found, absorption) in found.into_iter().zip(absorption) {
            assert_near(found, 0.81 * libm::exp(-absorption * length), 1e-6);
        }
    }
}

/// Checks glass in water: the medium entered last counts, and after it is left, the medium around it.
#[test]
fn innermost_nested_medium_applies() {
    let water = (0.0, 2.0, "(k_t: 0.9, ior: 1.33, absorption: (0.5, 0.1, 0))");
    let glass = (0.4, 1.0, "(k_t: 0.8, ior: 1.5, absorption: (0, 0.7, 0.2))");
    for order in [[water, glass], [glass, water]] {
        for degrees in [0.0, 30.0, 60.0] {
            let angle = f64::to_radians(degrees);
            let (in_water, in_glass) = (1.4 / cosine(angle, 1.33), 0.6 / cosine(angle, 1.5));
            let found = transmitted(angle, &plates(&order));
            for (found, (water, glass)) in found.into_iter().zip([(0.5, 0.0), (0.1, 0.7), (0.0, 0.2)]) {
                let expected = 0.81 * 0.64 * libm::exp(-water * in_water - glass * in_glass);
                assert_near(found, expected, 1e-6);
            }
        }
    }
}

/// Checks overlapping media: in the overlap, the medium entered last counts, also after the other one is left.
#[test]
fn last_entered_overlapping_medium_applies() {
    let first = (0.0, 1.0, "(k_t: 1, ior: 1.33, absorption: (0.5, 0, 0.1))");
    let second = (0.6, 2.0, "(k_t: 1, ior: 1.5, absorption: (0, 0.5, 0.2))");
    for order in [[first, second], [second, first]] {
        let angle = f64::to_radians(50.0);
        let (in_first, in_second) = (0.6 / cosine(angle, 1.33), 1.4 / cosine(angle, 1.5));
        let found = transmitted(angle, &plates(&order));
        let expected = [0.5 * in_first, 0.5 * in_second, 0.1 * in_first + 0.2 * in_second];
        for (found, depth) in found.into_iter().zip(expected) {
            assert_near(found, libm::exp(-depth), 1e-6);
        }
    }
}

/// Checks a camera inside media: in a half-space, and in the plate in it.
#[test]
fn camera_starts_inside_media() {
    for normal in ["(0, 0, 1)", "(0, 0, 2)"] {
        let body = format!(
            r#"background: (255, 255, 255), materials: {{ "glass": (refractive: (k_t: 0.5, ior: 1.5, absorption: (1, 0, 0.25))),
                "water": (refractive: (k_t: 1, ior: 1.33, absorption: (0, 1, 0.5))) }},
            entities: [(shape: Plane(normal: {normal}), material: "glass", transform: (translation: (0, 0, 2))),
                (shape: Box(size: (4, 4, 2)), material: "water")]"#
        );
        let angle = 0.2;
        // The path leads through 1 of water, from its middle to its face, and then 1 of glass. Sines are proportional to 1/n.
        let in_glass = libm::asin(libm::sin(angle) * 1.33 / 1.5);
        let (water, glass) = (1.0 / libm::cos(angle), 1.0 / libm::cos(in_glass));
        let found = seen(DVec3::ZERO, tilted(angle), &body).to_array().map(f64::from);
        for (found, depth) in found.into_iter().zip([glass, water, 0.25 * glass + 0.5 * water]) {
            assert_near(found, 0.5 * libm::exp(-depth), 1e-6);
        }
    }
}

fn refracted(tree: &[TracedRay]) -> Vec<&TracedRay> {
    assert!(tree[1..].iter().all(|traced| traced.kind == RayKind::Refraction));
    tree[1..].iter().collect()
}

/// Checks a bubble of empty space in glass, with parallel faces: in it, light has its direction from before the glass.
#[test]
fn bubble_cancels_the_glass_around_it() {
    let glass = (0.0, 2.0, "(k_t: 1, ior: 1.5, absorption: (1, 2, 3))");
    let bubble = (0.5, 1.5, "(k_t: 1, ior: 1, fresnel: false)");
    for degrees in [0.0, 25.0, 50.0, 80.0] {
        let angle = f64::to_radians(degrees);
        let body = plates(&[glass, bubble]);
        let tree = tree(DVec3::new(0.0, 0.0, -3.0), tilted(angle), &body);
        let rays = refracted(&tree);
        assert_eq!(rays.len(), 4);
        for (ray, sine) in rays.iter().zip([1.0 / 1.5, 1.0, 1.0 / 1.5, 1.0]) {
            assert_near(unit(ray).x, libm::sin(angle) * sine, 1e-15);
        }
        let length = 1.0 / cosine(angle, 1.5);
        for (found, absorption) in transmitted(angle, &body).into_iter().zip([1.0, 2.0, 3.0]) {
            assert_near(found, libm::exp(-absorption * length), 1e-6);
        }
    }
}

/// Checks touching plates of the same index: between them is one surface without a gap, which applies k_t once and refracts nothing.
#[test]
fn plates_that_touch_have_one_surface_between_them() {
    let first = (0.0, 1.0, "(k_t: 0.5, ior: 1.5, absorption: (1, 0, 0), fresnel: true)");
    let second = (1.0, 3.0, "(k_t: 0.5, ior: 1.5, absorption: (0, 1, 0), fresnel: true)");
    for order in [[first, second], [second, first]] {
        for degrees in [0.0, 33.0, 80.0] {
            let angle = f64::to_radians(degrees);
            let tree = tree(DVec3::new(0.0, 0.0, -3.0), tilted(angle), &plates(&order));
            let way: Vec<&TracedRay> = std::iter::successors(Some(&tree[0]), |ray| {
                let parent = tree.iter().position(|other| std::ptr::eq(other, *ray)).unwrap();
                tree.iter().find(|other| other.parent == Some(parent) && other.kind == RayKind::Refraction)
            })
            .collect();
            assert_eq!(way.len(), 4, "in, across and out");
            assert_eq!(way[1].ray.direction(), way[2].ray.direction());
            assert_eq!(way[1].inside.len(), 1);
            assert_eq!(way[2].inside.len(), 1);
            assert_ne!(way[1].inside, way[2].inside);
            assert_eq!(way[2].ray.origin().z, 1.0);
            // A surface that does not refract does not reflect.
            let across = tree.iter().position(|other| std::ptr::eq(other, way[1])).unwrap();
            let sent_on = tree.iter().filter(|other| other.parent == Some(across)).count();
            assert_eq!(sent_on, 1);
            assert_eq!(way[2].throughput.y, way[1].throughput.y * 0.5);
            let length = 1.0 / cosine(angle, 1.5);
            let left = f64::from(
                way[3].throughput.x / way[2].throughput.x / way[3].throughput.z * way[2].throughput.z,
            );
            assert_near(left, 1.0, 1e-6);
            let left = f64::from(way[2].throughput.x / way[2].throughput.z);
            assert_near(left, libm::exp(-length), 1e-6);
            let left = f64::from(way[3].throughput.y / way[3].throughput.z);
            assert_near(left, libm::exp(-2.0 * length), 1e-6);
        }
    }
}
