//! Tests of hard cases with exact results: one ray against one shape each, computed to 25 digits (`tests/kernel/numerics/cases.jsonl`).
//!
//! `distances` lists every root for a direction of length 1; the first that is not negative counts. If `verdict_is_free`, hit and miss are
//! both right, but a hit must be at the right point.

use glam::{DAffine3, DMat3, DQuat, DVec3};
use serde_json::Value;

use rayreel::trace::shapes::{AlignedBox, BoxImage, Plane, Sphere};
use rayreel::trace::{CastRay, Geometry, PreparedScene, PreparedShape, SurfaceMaterial};

fn vector(value: &Value) -> DVec3 {
    DVec3::from_slice(&value.as_array().unwrap().iter().map(number).collect::<Vec<_>>())
}

/// Returns a number, or a text with more digits than a number, rounded once.
fn number(value: &Value) -> f64 {
    value.as_f64().unwrap_or_else(|| value.as_str().unwrap().parse().unwrap())
}

fn shape(value: &Value) -> PreparedShape {
    match value["type"].as_str().unwrap() {
        "sphere" => {
            PreparedShape::Sphere(Sphere { center: vector(&value["c"]), radius: number(&value["r"]) })
        }
        "plane" => PreparedShape::Plane(Plane::new(vector(&value["q"]), vector(&value["n"])).unwrap()),
        "aabb" => {
            PreparedShape::AlignedBox(AlignedBox { min: vector(&value["min"]), max: vector(&value["max"]) })
        }
        "obb" => {
            let [w, x, y, z] = value["q"].as_array().unwrap().iter().map(number).collect::<Vec<_>>()[..]
            else {
                panic!("{value}")
            };
            let matrix3 = DMat3::from_quat(DQuat::from_xyzw(x, y, z, w).normalize());
            let forward = DAffine3 { matrix3, translation: vector(&value["c"]) };
            PreparedShape::BoxImage(BoxImage::new(forward, vector(&value["h"])).unwrap())
        }
        other => panic!("{other}"),
    }
}

/// Returns the number of `f64` steps between two numbers of the same sign.
fn steps(found: f64, expected: f64) -> u64 {
    found.to_bits().abs_diff(expected.to_bits())
}

#[test]
fn every_hard_case_is_right() {
    let mut wrong = Vec::new();
    let mut count = 0;
    for line in include_str!("numerics/cases.jsonl").lines() {
        let case: Value = serde_json::from_str(line).unwrap();
        let name = case["name"].as_str().unwrap();
        let mut geometry = Geometry::default();
        geometry.push(shape(&case["shape"]));
        let scene = PreparedScene::new(geometry, vec![SurfaceMaterial::default()]);
        let ray = CastRay::new(vector(&case["origin"]), vector(&case["direction"])).unwrap();
        let expected =
            case["distances"].as_array().unwrap().iter().map(number).find(|distance| *distance >= 0.0);
        count += 1;
        let Some(surface) = scene.cast(&ray) else {
            if case["hit"] == true && case["verdict_is_free"] != true {
                wrong.push(format!("{name}: missed"));
            }
            continue;
        };
        let Some(expected) = expected else {
            wrong.push(format!("{name}: hit"));
            continue;
        };
        let distance = surface.distance(&ray);
        if steps(distance, expected) > 2 {
            wrong.push(format!(
                "{name}: {distance:?} instead of {expected:?}, {} steps off",
                steps(distance, expected)
            ));
        }
        let point = vector(&case["first_point"]);
        if (surface.point - point).length() > 1e-14 * (1.0 + point.length()) {
            wrong.push(format!("{name}: at {} instead of {point}", surface.point));
        }
        let normals = case["normals"].as_array().unwrap();
        if !normals
            .iter()
            .any(|normal| (vector(normal).normalize() - surface.facing_normal()).length() < 1e-9)
            && !normals.iter().any(|normal| (vector(normal).normalize() - surface.normal).length() < 1e-9)
        {
            wrong.push(format!("{name}: normal {} is none of {normals:?}", surface.normal));
        }
    }
    assert!(count >= 20);
    assert!(wrong.is_empty(), "\n{}", wrong.join("\n"));
}

/// Checks that a ball on a floor has a shadow up to the contact: a ray straight up from the floor, at a distance `way` from the contact,
/// hits the ball at 1 - sqrt(1 - way^2).
#[test]
fn contact_shadows_reach_the_contact() {
    let mut geometry = Geometry::default();
    geometry.push(PreparedShape::Plane(Plane::new(DVec3::ZERO, DVec3::Y).unwrap()));
    geometry.push(PreparedShape::Sphere(Sphere { center: DVec3::Y, radius: 1.0 }));
    let scene = PreparedScene::new(geometry, vec![SurfaceMaterial::default(); 2]);
    for (way, expected) in [
        (0.1, 0.005_012_562_893_380_046),
        (0.01, 0.000_050_001_250_062_503_91),
        (0.005, 0.000_012_500_078_125_976_578),
        (1e-5, 0.000_000_000_050_000_000_001_25),
    ] {
        // The ray comes from below, so that only the floor is in its path.
        let arrived = CastRay::new(DVec3::new(way, -1.0, 0.0), DVec3::Y).unwrap();
        let floor = scene.cast(&arrived).unwrap();
        assert_eq!(floor.point, DVec3::new(way, 0.0, 0.0));
        let shadow = floor.leave_towards(DVec3::Y).unwrap();
        let ball = scene.cast(&shadow).unwrap();
        assert_eq!(ball.hit.id.index(), 1);
        assert!(steps(ball.distance(&shadow), expected) <= 2, "{way}");
    }
    // At the contact itself, a ray leaves both shapes at once.
    let arrived = CastRay::new(DVec3::NEG_Y, DVec3::Y).unwrap();
    let contact = scene.cast(&arrived).unwrap();
    let inside = scene.cast(&contact.leave_towards(DVec3::Y).unwrap()).unwrap();
    assert_eq!((inside.hit.id.index(), inside.point), (1, DVec3::new(0.0, 2.0, 0.0)), "up through the ball");
    assert!(scene.cast(&contact.leave_towards(DVec3::NEG_Y).unwrap()).is_none());
}
