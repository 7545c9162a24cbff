//! Tests of cylinders and capsules against closed forms.

use glam::{DQuat, DVec3, EulerRot};

use rayreel::components::Name;
use rayreel::{Engine, Ray, Time};

use super::{assert_near, engine, film, seen};

/// Returns the engine for a single shape at the start of its timeline.
fn alone(entity: &str) -> Engine {
    let mut engine = engine(&format!(
        "camera: (position: (0, 0, -9), view: (0, 0, 1)), entities: [({entity}, color: (9, 9, 9))]"
    ));
    engine.seek(Time::ZERO).unwrap();
    engine
}

/// Checks distances, points and normals at sides, ends, rims and round ends; from outside and inside.
#[test]
fn rods_are_hit_where_their_equations_say() {
    let (root, half) = (f64::sqrt(0.75), 0.5);
    let cylinder = "shape: Cylinder(radius: 1, from: (0, 0, 0), to: (0, 2, 0))";
    let capsule = "shape: Capsule(radius: 1, from: (0, 0, 0), to: (0, 2, 0))";
    let v = DVec3::new;
    let hits = [
        // The side, straight on, aside, and from inside.
        (cylinder, v(-3.0, 1.0, 0.0), DVec3::X, 2.0, DVec3::NEG_X),
        (cylinder, v(-3.0, 1.0, half), DVec3::X, 3.0 - root, v(-root, 0.0, half)),
        (cylinder, v(0.0, 1.0, half), DVec3::X, root, -v(root, 0.0, half)),
        // The ends, from above, from below and from inside.
        (cylinder, v(0.3, 5.0, 0.2), DVec3::NEG_Y, 3.0, DVec3::Y),
        (cylinder, v(0.3, -5.0, 0.2), DVec3::Y, 5.0, DVec3::NEG_Y),
        (cylinder, v(0.3, 0.5, 0.2), DVec3::Y, 1.5, DVec3::NEG_Y),
        (cylinder, v(-3.0, 4.0, 0.0), v(3.0, -2.0, 0.0), f64::sqrt(13.0), DVec3::Y),
        // Along the side, on it: the end is hit at the rim.
        (cylinder, v(1.0, 5.0, 0.0), DVec3::NEG_Y, 3.0, DVec3::Y),
        (cylinder, v(0.0, -5.0, -1.0), DVec3::Y, 5.0, DVec3::NEG_Y),
        // The side and the round ends of a capsule.
        (capsule, v(-3.0, 1.0, half), DVec3::X, 3.0 - root, v(-root, 0.0, half)),
        (capsule, v(half, 5.0, 0.0), DVec3::NEG_Y, 3.0 - root, v(half, root, 0.0)),
        (capsule, v(-3.0, 2.5, 0.0), DVec3::X, 3.0 - root, v(-root, half, 0.0)),
        (capsule, v(-3.0, -0.5, 0.0), DVec3::X, 3.0 - root, v(-root, -half, 0.0)),
        (capsule, v(0.0, 1.0, 0.0), DVec3::Y, 2.0, DVec3::NEG_Y),
        (capsule, v(0.0, 1.0, 0.0), v(0.0, -3.0, 0.0), 2.0, DVec3::Y),
        (capsule, v(1.0, 5.0, 0.0), DVec3::NEG_Y, 3.0, DVec3::X),
    ];
    for (shape, origin, direction, distance, normal) in hits {
        let found = alone(shape).cast(Ray { origin, direction });
        let found = found.unwrap_or_else(|| panic!("{shape} is missed from {origin} along {direction}"));
        assert_near(found.distance, distance, 1e-15 * distance);
        assert!((found.normal - normal).length() < 1e-15, "{shape} {origin} {direction}: {}", found.normal);
        let point = origin + direction.normalize() * distance;
        assert!((found.point - point).length() < 1e-15, "{shape}: {} instead of {point}", found.point);
    }
    let misses = [
        (cylinder, v(-3.0, 2.1, 0.0), DVec3::X),
        (cylinder, v(-3.0, 1.0, 1.01), DVec3::X),
        (cylinder, v(1.0 + f64::EPSILON, 5.0, 0.0), DVec3::NEG_Y),
        (cylinder, v(0.0, 5.0, 0.0), DVec3::Y),
        (capsule, v(-3.0, 3.1, 0.0), DVec3::X),
        (capsule, v(-3.0, 2.9, 0.9), DVec3::X),
        (capsule, v(1.0 + f64::EPSILON, 5.0, 0.0), DVec3::NEG_Y),
    ];
    for (shape, origin, direction) in misses {
        assert!(alone(shape).cast(Ray { origin, direction }).is_none(), "{shape} {origin} {direction}");
    }
}

/// Checks exp(-a l) over the chords of glass rods that do not bend rays, along and across.
#[test]
fn glass_rods_absorb_along_their_chords() {
    let glass = "color: (0, 0, 0), material: (k_a: 0, k_d: 0, refractive: (k_t: 1, ior: 1, absorption: (0.3, 0.5, 1)))";
    let stretched = "transform: (scale: (1, 1, 2))";
    for (shape, origin, direction, chord) in [
        ("Cylinder(radius: 1, height: 2)", DVec3::new(0.6, 0.1, -5.0), DVec3::Z, 1.6),
        ("Cylinder(radius: 1, height: 2)", DVec3::new(0.6, 5.0, 0.3), DVec3::NEG_Y, 2.0),
        ("Cylinder(radius: 1, height: 2)", DVec3::new(0.0, 4.0, -3.0), DVec3::new(0.0, -4.0, 3.0), 2.5),
        ("Capsule(radius: 1, height: 2)", DVec3::new(0.6, 0.1, -5.0), DVec3::Z, 1.6),
        ("Capsule(radius: 1, height: 2)", DVec3::new(0.6, 9.0, 0.0), DVec3::NEG_Y, 3.6),
        ("Capsule(radius: 1, height: 2)", DVec3::new(0.0, 1.6, -5.0), DVec3::Z, 1.6),
        ("Capsule(radius: 0.5, from: (-2, 0, 0), to: (2, 0, 0))", DVec3::new(-9.0, 0.3, 0.0), DVec3::X, 4.8),
    ] {
        for (transform, times) in [("", 1.0), (stretched, 2.0)] {
            // Stretched along z: rays in the xy-plane cross as much, those along z twice as much, and slanted ones are left out.
            let times = if direction.z == 0.0 { 1.0 } else { times };
            if times > 1.0 && direction.y != 0.0
                || !transform.is_empty() && origin.z != 0.0 && direction.z == 0.0
            {
                continue;
            }
            let body =
                format!("background: (255, 255, 255), entities: [(shape: {shape}, {glass}, {transform})]");
            let found = seen(origin, direction, &body).to_array();
            for (found, absorption) in found.into_iter().zip([0.3, 0.5, 1.0]) {
                assert_near(found.into(), libm::exp(-absorption * chord * times), 1e-6);
            }
        }
    }
}

/// Checks that the notations of a rod give the same picture, and a uniform scale that of a larger rod.
#[test]
fn heights_and_ends_are_two_notations() {
    let picture = |shape: &str, transform: &str| {
        film(&format!(
            "film: (width: 48, height: 36), camera: (position: (1, 2, -5), target: (0, 0, 0), fov: 50), ambient: (0.3, 0.3, 0.3),
            entities: [(shape: {shape}, color: (200, 90, 50), transform: ({transform})),
                (light: Directional(intensity: (1, 1, 1), direction: (1, -2, 3)))]"
        ))
    };
    for kind in ["Cylinder", "Capsule"] {
        let ends = picture(&format!("{kind}(radius: 0.5, from: (0, -1, 0), to: (0, 1, 0))"), "");
        assert!(ends == picture(&format!("{kind}(radius: 0.5, height: 2)"), ""), "{kind}");
        assert!(ends == picture(&format!("{kind}(radius: 0.25, height: 1)"), "scale: 2"), "{kind}");
        let moved = "translation: (0, -1, 0)";
        assert!(
            ends == picture(&format!("{kind}(radius: 0.5, from: (0, 0, 0), to: (0, 2, 0))"), moved),
            "{kind}"
        );
        assert!(ends != picture(&format!("{kind}(radius: 0.5, height: 2.2)"), ""), "{kind}");
    }
}

/// Checks that a cylinder stands flush on a box that is turned with it: from within the box, whichever comes first in the document is seen
/// at the common face.
#[test]
fn cylinders_are_flush_with_boxes_that_are_turned_with_them() {
    let parts = [
        r#"(name: "box", parent: "turned", shape: Box(size: (0.7, 0.5, 0.7)), color: (9, 9, 9), transform: (translation: (0.1, 0.55, 0))),"#,
        r#"(name: "rod", parent: "turned", shape: Cylinder(radius: 0.3, from: (0.1, 0.8, 0), to: (0.1, 1.4, 0)), color: (9, 9, 9)),"#,
    ];
    for step in 1..40 {
        let degrees = [7.3, 11.7, 23.9].map(|degree| degree * f64::from(step));
        let [x, y, z] = degrees;
        for (first, order) in [("box", [parts[0], parts[1]]), ("rod", [parts[1], parts[0]])] {
            let turned = format!(
                r#"(name: "turned", transform: (translation: (0.3, 0.7, -0.4), rotation: Euler({x:?}, {y:?}, {z:?}), scale: 1.7)),"#
            );
            let entities = [turned.as_str(), order[0], order[1]].concat();
            let mut engine =
                engine(&format!("camera: (position: (0, 0, -9), view: (0, 0, 1)), entities: [{entities}]"));
            engine.seek(Time::ZERO).unwrap();
            let [x, y, z] = degrees.map(f64::to_radians);
            let rotation = DQuat::from_euler(EulerRot::ZYX, z, y, x);
            let place = |own: DVec3| DVec3::new(0.3, 0.7, -0.4) + rotation * (own * 1.7);
            let (origin, target) = (place(DVec3::new(0.1, 0.5, 0.05)), place(DVec3::new(0.2, 1.0, 0.1)));
            let hit = engine.cast(Ray { origin, direction: target - origin }).unwrap();
            assert_eq!(engine.world().get::<&Name>(hit.entity).unwrap().0, first, "{degrees:?}");
        }
    }
}
