//! Tests of Snell's law, Fresnel's equations, total internal reflection, and the focus of a glass ball.

use glam::DVec3;

use rayreel::trace::{RayKind, TracedRay};

use super::{assert_near, film, first, seen, tilted, tree, triple, unit};

/// Angles from the normal, in degrees.
const ANGLES: [f64; 12] = [0.0, 0.1, 5.0, 15.0, 30.0, 41.0, 45.0, 60.0, 75.0, 85.0, 89.0, 89.9];

/// Returns the tree of a ray from z = -1 that meets the face of a half-space of glass at z = 0 at this angle, from outside or from inside.
fn at_the_face(angle: f64, material: &str, inside: bool) -> Vec<TracedRay> {
    let normal = if inside { "(0, 0, 1)" } else { "(0, 0, -1)" };
    tree(
        DVec3::NEG_Z,
        tilted(angle),
        &format!(
            r#"quality: (cutoff: 0), background: (255, 255, 255), materials: {{ "glass": ({material}) }},
            entities: [(shape: Plane(normal: {normal}), material: "glass")]"#
        ),
    )
}

/// Checks Snell's law, n1 sin(i) = n2 sin(t), in the plane of incidence.
#[test]
fn refracted_rays_obey_snell() {
    for ior in [1.0003, 1.33, 1.5, 2.42, 0.75] {
        for (degrees, inside) in ANGLES.into_iter().flat_map(|angle| [(angle, false), (angle, true)]) {
            let angle = degrees.to_radians();
            let ratio = if inside { ior } else { 1.0 / ior };
            let sine = libm::sin(angle) * ratio;
            let tree = at_the_face(angle, &format!("refractive: (k_t: 1, ior: {ior:?})"), inside);
            let refracted = first(&tree, RayKind::Refraction);
            assert_eq!(refracted.is_some(), sine < 1.0, "{degrees} degrees at {ior}");
            let Some(refracted) = refracted else { continue };
            let direction = unit(refracted);
            assert_near(direction.x, sine, 1e-15);
            assert_eq!(direction.y, 0.0);
            // Where the sine is near 1, the angle amplifies its rounding error.
            let bent = libm::asin(sine);
            assert_near(libm::atan2(direction.x, direction.z), bent, 1e-15 / libm::cos(bent));
        }
    }
}

/// Checks Snell's law in all directions of space: with unit vectors, n1 d1 x N = n2 d2 x N.
#[test]
fn refracted_rays_stay_in_the_plane_of_incidence() {
    let ior = 1.5;
    for (normal, towards) in [
        (DVec3::new(0.3, -0.2, -0.9), DVec3::new(0.1, 0.4, 1.0)),
        (DVec3::new(-3.0, 1.0, -1.0), DVec3::new(0.5, -0.5, 1.0)),
        (DVec3::new(0.01, 1.0, -0.02), DVec3::new(0.9, -0.1, 0.3)),
    ] {
        let body = format!(
            r#"quality: (cutoff: 0), background: (255, 255, 255),
            materials: {{ "glass": (refractive: (k_t: 1, ior: {ior:?})) }},
            entities: [(shape: Plane(normal: {}), material: "glass")]"#,
            triple(normal)
        );
        let tree = tree(-2.0 * towards, towards, &body);
        let refracted = first(&tree, RayKind::Refraction).unwrap();
        let normal = normal.normalize();
        let difference = unit(&tree[0]).cross(normal) - ior * unit(refracted).cross(normal);
        assert!(difference.length() < 1e-15, "{difference}");
    }
}

/// Returns the reflectance by Fresnel's equations, from the angles alone (Born and Wolf, "Principles of Optics", section 1.5.2, equation
/// 21): (sin^2(i - t)/sin^2(i + t) + tan^2(i - t)/tan^2(i + t)) / 2.
fn reflectance(angle: f64, ior: f64) -> f64 {
    if angle == 0.0 {
        let share = (ior - 1.0) / (ior + 1.0);
        return share * share;
    }
    let bent = libm::asin(libm::sin(angle) / ior);
    let (less, more) = (angle - bent, angle + bent);
    let across = libm::sin(less) / libm::sin(more);
    let along = libm::tan(less) / libm::tan(more);
    0.5 * (across * across + along * along)
}

#[test]
fn fresnel_splits_light() {
    // Known values for an index of 1.5, in per cent.
    for (degrees, percent) in [(0.0, 4.0), (30.0, 4.15), (45.0, 5.02), (60.0, 8.92), (80.0, 38.8)] {
        assert_near(100.0 * reflectance(f64::to_radians(degrees), 1.5), percent, 0.05);
    }
    let (k_r, k_t) = (0.125, 0.75);
    for ior in [1.33, 1.5, 2.42] {
        for degrees in ANGLES {
            let angle = degrees.to_radians();
            let share = reflectance(angle, ior);
            let material = |fresnel: bool| {
                format!(
                    "reflective: (k_r: {k_r:?}), refractive: (k_t: {k_t:?}, ior: {ior:?}, fresnel: {fresnel})"
                )
            };
            // From outside, and on the same path in the other direction.
            let bent = libm::asin(libm::sin(angle) / ior);
            for (angle, inside) in [(angle, false), (bent, true)] {
                for (fresnel, share) in [(true, share), (false, 0.0)] {
                    let tree = at_the_face(angle, &material(fresnel), inside);
                    let of = |kind| f64::from(first(&tree, kind).unwrap().throughput.x);
                    // From inside, the share amplifies the rounding error of the angle by 1 / cos(angle).
                    let tolerance = if inside { 1e-7 + 1e-15 / libm::cos(angle) } else { 1e-7 };
                    assert_near(of(RayKind::Reflection), k_r + k_t * share, tolerance);
                    assert_near(of(RayKind::Refraction), k_t * (1.0 - share), tolerance);
                }
            }
        }
    }
}

/// Checks Brewster's angle, tan i = n: the reflected and the refracted ray are at right angles, and light polarized in the plane of
/// incidence is not reflected. The reflectance is ((n^2 - 1)/(n^2 + 1))^2 / 2.
#[test]
fn brewsters_angle() {
    for ior in [1.33, 1.5, 2.42] {
        let material = format!("refractive: (k_t: 1, ior: {ior:?}, fresnel: true)");
        let tree = at_the_face(libm::atan(ior), &material, false);
        let (reflected, refracted) =
            (first(&tree, RayKind::Reflection).unwrap(), first(&tree, RayKind::Refraction).unwrap());
        assert_near(unit(reflected).dot(unit(refracted)), 0.0, 1e-15);
        let share = (ior * ior - 1.0) / (ior * ior + 1.0);
        assert_near(f64::from(reflected.throughput.x), 0.5 * share * share, 1e-8);
    }
}

/// Checks a lake under a sky that goes from black, straight down, to white, straight up: (1 + y)/2. At an angle i from the vertical, the
/// picture shows F (1 + cos i)/2 + (1 - F) (1 - cos t)/2.
#[test]
fn lake_shows_reflection_and_refraction() {
    let ior = 1.33;
    for degrees in [10.0, 30.0, 53.0, 70.0, 85.0, 89.0] {
        let angle = f64::to_radians(degrees);
        let (sine, cosine) = libm::sincos(angle);
        let found = seen(
            DVec3::new(0.0, 2.0, 0.0),
            DVec3::new(sine, -cosine, 0.0),
            r#"quality: (cutoff: 0), background: (bottom: (0, 0, 0), top: (255, 255, 255)),
            materials: { "water": (refractive: (k_t: 1, ior: 1.33, fresnel: true)) },
            entities: [(shape: Plane(normal: (0, 1, 0)), material: "water")]"#,
        );
        let share = reflectance(angle, ior);
        let bent = libm::cos(libm::asin(sine / ior));
        let expected = share * 0.5 * (1.0 + cosine) + (1.0 - share) * 0.5 * (1.0 - bent);
        assert_near(f64::from(found.x), expected, 1e-6);
    }
}

/// Checks the critical angle, asin(1/n). A billionth of a radian below it, 1 - n^2 sin^2 is 1 - (cos d - cot c sin d)^2 and light is
/// transmitted; a billionth above it, all light is reflected.
#[test]
fn total_reflection_begins_at_the_critical_angle() {
    const STEP: f64 = 1e-9;
    for ior in [1.33, 1.5, 2.42] {
        let critical = libm::asin(1.0 / ior);
        for fresnel in [false, true] {
            let material = format!("refractive: (k_t: 0.75, ior: {ior:?}, fresnel: {fresnel})");
            let below = at_the_face(critical - STEP, &material, true);
            let refracted = first(&below, RayKind::Refraction).unwrap();
            let cosine = unit(refracted).z;
            let sines = libm::cos(STEP) - (ior * ior - 1.0).sqrt() * libm::sin(STEP);
            assert_near(cosine * cosine, 1.0 - sines * sines, 1e-15 * ior * ior);
            assert_eq!(first(&below, RayKind::Reflection).is_some(), fresnel);
            if !fresnel {
                assert_eq!(refracted.throughput.x, 0.75);
            }

            let above = at_the_face(critical + STEP, &material, true);
            assert!(first(&above, RayKind::Refraction).is_none());
            assert_eq!(first(&above, RayKind::Reflection).unwrap().throughput.x, 0.75);
        }
    }
}

/// Checks total reflection in a box. Light reflected at one face arrives at the next at 90 degrees minus its angle, beyond the critical
/// angle of both, so it is reflected without end.
#[test]
fn glass_box_reflects_totally() {
    let caught = |degrees: f64| {
        tree(
            DVec3::new(0.1, 0.0, 0.0),
            tilted(degrees.to_radians()),
            r#"quality: (depth: 20, cutoff: 0), background: (255, 255, 255),
            materials: { "glass": (refractive: (k_t: 1, ior: 1.5)) },
            entities: [(shape: Box(size: (2, 2, 2)), material: "glass")]"#,
        )
    };
    // asin(1/1.5) is 41.81 degrees. Light is trapped from there to 48.19 degrees.
    for degrees in [42.0, 44.0, 48.0] {
        let tree = caught(degrees);
        assert_eq!(tree.len(), 21);
        assert!(tree.iter().skip(1).all(|traced| traced.kind == RayKind::Reflection));
    }
    for degrees in [41.0, 49.0] {
        assert_eq!(caught(degrees).last().unwrap().kind, RayKind::Refraction, "{degrees}");
    }
}

/// Returns the point at which a ray parallel to the axis of a glass ball, at this distance from it, crosses the axis, in radii from the
/// centre.
fn focus(height: f64) -> f64 {
    let tree = tree(
        DVec3::new(height, 0.0, -3.0),
        DVec3::Z,
        r#"background: (255, 255, 255), materials: { "glass": (refractive: (k_t: 1, ior: 1.5)) },
        entities: [(shape: Sphere(radius: 1), material: "glass")]"#,
    );
    let out = &tree[2];
    assert_eq!((tree.len(), out.kind), (3, RayKind::Refraction));
    let (from, direction) = (out.ray.origin(), out.ray.direction());
    from.z - from.x / direction.x * direction.z
}

/// Checks the focus. A ray at height h enters at i = asin h, continues at t = asin(h/n), and leaves as it entered, turned by 2 (i - t) and
/// again h from the centre: it crosses the axis at h / sin(2 (i - t)). For small h that is n / (2 (n - 1)), 1.5 here, with an error
/// proportional to h^2.
#[test]
fn a_ball_of_glass_focuses() {
    for height in [1e-3, 0.1, 0.3, 0.6, 0.9] {
        let (arriving, inside) = (libm::asin(height), libm::asin(height / 1.5));
        let expected = height / libm::sin(2.0 * (arriving - inside));
        assert_near(focus(height), expected, 1e-14 / height);
    }
    let errors: Vec<(u32, f64)> =
        (2..8).map(|halvings| (1 << halvings, 1.5 - focus(1.0 / f64::from(1 << halvings)))).collect();
    println!("{errors:?}");
    assert!((super::exponent(&errors) + 2.0).abs() < 0.01, "{errors:?}");
}

/// Checks that shapes with the index of the surrounding medium are invisible: the picture is the same, bit for bit.
#[test]
fn glass_of_equal_index_is_invisible() {
    let scene = |entities: &str| {
        film(&format!(
            r#"film: (width: 40, height: 30, transfer: Classic), camera: (position: (0.3, 0.2, -3), view: (0, 0, 1)),
            background: (bottom: (255, 128, 0), top: (0, 64, 255)), ambient: (1, 1, 1), quality: (depth: 12, cutoff: 0),
            materials: {{ "m": (k_a: 1, color: (99, 140, 180)), "empty": (refractive: (k_t: 1, ior: 1, fresnel: true)),
                "glass": (refractive: (k_t: 1, ior: 1.5, absorption: (0.1, 0.2, 0.3))) }},
            entities: [(shape: Box(size: (1, 2, 0.5)), material: "m", transform: (translation: (0, 0, 4))), {entities}]"#
        ))
    };
    let nothing = scene("");
    let empty = r#"(shape: Sphere(radius: 1), material: "empty")"#;
    assert_eq!(scene(empty), nothing);
    assert_eq!(scene(&[empty, empty].join(", ")), nothing);
    let rotated = "transform: (rotation: Euler(10, 20, 30))";
    assert_eq!(scene(&format!(r#"(shape: Box(size: (1, 1, 1)), material: "empty", {rotated})"#)), nothing);
    // A bubble of the same size replaces the glass if it comes first.
    let glass = r#"(shape: Sphere(radius: 1), material: "glass")"#;
    assert_eq!(scene(&[empty, glass].join(", ")), nothing);
    assert_ne!(scene(&[glass, empty].join(", ")), nothing);
}
