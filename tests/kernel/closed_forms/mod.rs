//! Tests of light against closed forms, with whole pictures and with ray trees. Sampled effects are also tested for their rate of
//! convergence.

mod ambient_occlusion;
mod area_lights;
mod emission;
mod media;
mod metals;
mod motion;
mod patterns;
mod refraction;
mod rods;
mod shadows;
mod surroundings;
mod visibility;

use glam::DVec3;

use rayreel::trace::{RayKind, TracedRay};
use rayreel::{Engine, Film, Rgb, Time};

fn engine(body: &str) -> Engine {
    crate::engine(&format!("Scene({body})"))
}

fn film(body: &str) -> Film {
    engine(body).render_frame(0).unwrap()
}

/// Returns the light along a single ray.
fn seen(from: DVec3, towards: DVec3, body: &str) -> Rgb {
    film(&format!("{}, {body}", single_ray(from, towards))).pixel(0, 0)
}

/// Returns the ray tree of a single ray.
fn tree(from: DVec3, towards: DVec3, body: &str) -> Vec<TracedRay> {
    let mut engine = engine(&format!("{}, {body}", single_ray(from, towards)));
    engine.render_frame(0).unwrap();
    engine.probe(Time::ZERO, (0, 0), 0).unwrap().unwrap().rays
}

/// Returns a film of one pixel and a camera with this single ray.
fn single_ray(from: DVec3, towards: DVec3) -> String {
    let up = if towards.x == 0.0 && towards.z == 0.0 { "(0, 0, 1)" } else { "(0, 1, 0)" };
    let (from, towards) = (triple(from), triple(towards));
    format!(
        "film: (width: 1, height: 1, transfer: Classic), camera: (position: {from}, view: {towards}, up: {up})"
    )
}

fn triple(vector: DVec3) -> String {
    format!("({:?}, {:?}, {:?})", vector.x, vector.y, vector.z)
}

/// Returns a direction in the xz-plane at an angle from z towards x, in radians.
fn tilted(angle: f64) -> DVec3 {
    let (sine, cosine) = libm::sincos(angle);
    DVec3::new(sine, 0.0, cosine)
}

/// Returns the first ray of a kind in a tree.
fn first(tree: &[TracedRay], kind: RayKind) -> Option<&TracedRay> {
    tree.iter().find(|traced| traced.kind == kind)
}

fn unit(traced: &TracedRay) -> DVec3 {
    traced.ray.direction().normalize()
}

#[track_caller]
fn assert_near(found: f64, expected: f64, tolerance: f64) {
    assert!((found - expected).abs() <= tolerance, "{found:?} is not {expected:?} within {tolerance:e}");
}

/// Returns the exponent e of an error that falls as n^e, by least squares.
fn exponent(errors: &[(u32, f64)]) -> f64 {
    let points: Vec<(f64, f64)> =
        errors.iter().map(|(count, error)| (libm::log(f64::from(*count)), libm::log(*error))).collect();
    let count = points.len() as f64;
    let middle = points.iter().map(|point| point.0).sum::<f64>() / count;
    let rise: f64 = points.iter().map(|(x, y)| (x - middle) * y).sum();
    rise / points.iter().map(|(x, _)| (x - middle) * (x - middle)).sum::<f64>()
}

fn root_mean_square(errors: &[f64]) -> f64 {
    (errors.iter().map(|error| error * error).sum::<f64>() / errors.len() as f64).sqrt()
}
