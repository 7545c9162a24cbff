//! Tests with rays and shapes of any magnitude: every reported number is finite, and packets agree with single rays.

use fearless_simd::dispatch;
use glam::{DAffine3, DMat3, DVec3};
use proptest::prelude::*;

use super::tests::scene;
use super::{PacketScratch, closest_hits, refine};
use crate::trace::intersect::{CastRay, HitPacket, Scratch, ShapeHit, SurfacePacket, SurfacePoint};
use crate::trace::math::{SimdLevel, lanes};
use crate::trace::rays::RayPacket;
use crate::trace::scene::{PreparedScene, PreparedShape};
use crate::trace::shapes::{AlignedBox, BoxImage, Plane, Rod, RodImage, Sphere, SphereImage};

/// Numbers of both signs with uniformly distributed decimal exponents, small numbers, and zeros.
fn number(exponents: std::ops::RangeInclusive<i32>) -> impl Strategy<Value = f64> {
    let magnitude = (exponents, 1.0..9.99)
        .prop_map(|(exponent, digits): (i32, f64)| digits * libm::exp10(f64::from(exponent)));
    prop_oneof![
        1 => Just(0.0),
        2 => -9.0..9.0,
        4 => (magnitude, any::<bool>())
            .prop_map(|(magnitude, negative): (f64, bool)| if negative { -magnitude } else { magnitude }),
    ]
}

fn vector(exponents: std::ops::RangeInclusive<i32>) -> impl Strategy<Value = DVec3> {
    let part = || number(exponents.clone());
    (part(), part(), part()).prop_map(DVec3::from)
}

/// A valid size of a shape.
fn size() -> impl Strategy<Value = f64> {
    prop_oneof![1 => 0.1..9.0, 2 => (-149..=148, 1.0..9.99).prop_map(|(exponent, digits): (i32, f64)| digits * libm::exp10(f64::from(exponent)))]
}

fn shape() -> impl Strategy<Value = PreparedShape> {
    (0..7, vector(-149..=148), vector(-300..=300), size(), [0.2..2.0, 0.2..2.0, 0.1..3.0]).prop_filter_map(
        "no shape",
        |(kind, place, normal, size, [wide, high, angle])| {
            let stretch = DMat3::from_diagonal(DVec3::new(wide, high, 1.0) * size);
            let map = DAffine3 { matrix3: DMat3::from_rotation_y(angle) * stretch, translation: place };
            Some(match kind {
                0 => PreparedShape::Sphere(Sphere { center: place, radius: size }),
                1 => PreparedShape::Plane(Plane::new(place, normal)?),
                2 => {
                    let half = DVec3::new(wide, high, 1.0) * size;
                    PreparedShape::AlignedBox(AlignedBox { min: place - half, max: place + half })
                }
                3 => PreparedShape::SphereImage(SphereImage::new(map, 1.0)),
                4 => {
                    let stop = place + DVec3::new(angle, high, wide) * size;
                    let capsule = || Rod::capsule(place, stop, size * wide);
                    let rod = if high > 1.0 { capsule() } else { Rod::cylinder(place, stop, size * wide) };
                    PreparedShape::Rod(rod?)
                }
                5 => {
                    let stop = DVec3::new(angle, high, wide);
                    let capsule = || RodImage::capsule(map, stop, wide);
                    let image = if high > 1.0 { capsule() } else { RodImage::cylinder(map, stop, wide) };
                    PreparedShape::RodImage(image?)
                }
                _ => PreparedShape::BoxImage(BoxImage::new(map, DVec3::ONE)?),
            })
        },
    )
}

/// The point at which a ray is aimed.
fn middle(shape: &PreparedShape) -> DVec3 {
    match shape {
        PreparedShape::Sphere(sphere) => sphere.center,
        PreparedShape::Plane(plane) => plane.point(),
        PreparedShape::AlignedBox(shape) => shape.min * 0.5 + shape.max * 0.5,
        PreparedShape::SphereImage(image) => image.forward().translation,
        PreparedShape::BoxImage(image) => image.forward().translation,
        PreparedShape::Rod(rod) => rod.ends()[0],
        PreparedShape::RodImage(image) => image.forward().translation,
    }
}

/// A ray's origin and direction, and a flag: if true, the ray is aimed at the shape instead.
fn ray() -> impl Strategy<Value = (DVec3, DVec3, bool)> {
    (prop_oneof![vector(-320..=307), vector(-30..=30)], vector(-320..=307), any::<bool>())
}

proptest! {
    #![proptest_config(ProptestConfig::with_cases(10_000))]

    #[test]
    fn every_reported_number_is_finite_and_packets_agree(
        shape in shape(), rays in prop::collection::vec(ray(), 16),
    ) {
        let mut scene = scene(&[shape]);
        let mut packet = RayPacket::EMPTY;
        for (lane, (origin, direction, aimed)) in rays.iter().enumerate() {
            let direction = if *aimed { middle(&shape) - *origin } else { *direction };
            let Some(ray) = CastRay::new(*origin, direction) else { continue };
            let found = scene.cast(&ray);
            // Directions that are not scaled, because of a subnormal component, can be too long for the tree.
            if ray.direction().abs().max_element() < 2.0 {
                packet.set(lane, &ray);
                let reference = scene.closest_of_all(&ray, &mut Scratch::default());
                let [found, reference] = [found.as_ref().map(|found| found.hit), reference.map(|found| found.hit)];
                prop_assert_eq!(found, reference, "{:?}", ray);
            }
            let Some(hit) = found else { continue };
            prop_assert!(hit.point.is_finite() && hit.t.rounded().is_finite(), "{ray:?} {hit:?}");
            prop_assert!(hit.distance(&ray).is_finite(), "{ray:?} {hit:?}");
            prop_assert!(hit.normal.is_finite(), "{ray:?} {hit:?}");
        }
        for (name, level) in SimdLevel::all() {
            scene.simd = level;
            let mut hits = HitPacket::EMPTY;
            let scratch = Scratch::default();
            closest_hits(&scene, &packet, &mut hits, &mut PacketScratch::default(), scratch.cancelled);
            agree(name, &scene, &packet, &hits)?;
        }
    }
}

/// Compares the hits and surface points of a packet with the results of single rays. Error bounds may differ in packets with subnormal
/// directions; the hits that they bound may not.
fn agree(
    name: &str,
    scene: &PreparedScene,
    packet: &RayPacket,
    hits: &HitPacket,
) -> Result<(), TestCaseError> {
    let mut scratch = Scratch::default();
    let mut surfaces = SurfacePacket::EMPTY;
    let decided = packet.lanes & !hits.undecided;
    let with_hit =
        lanes(decided).filter(|lane| hits.get(*lane).is_some()).fold(0, |mask, lane| mask | 1 << lane);
    dispatch!(scene.simd.level(), simd => refine(simd, scene, packet, hits, with_hit, &mut surfaces));
    for lane in lanes(decided) {
        let ray = packet.get(lane);
        scratch.tied_hits.clear();
        let single = scene.closest(&ray, &mut scratch);
        let place = |hit: ShapeHit| (hit.root.t(), hit.id, hit.far);
        prop_assert_eq!(
            hits.get(lane).map(|found| place(found.hit)),
            single.map(|found| place(found.hit)),
            "{} {:?}",
            name,
            ray
        );
        let found = surfaces.get(lane, hits).filter(|_| surfaces.lanes & (1 << lane) != 0);
        if let (Some(closest), Some(found)) = (single, found) {
            let point = scene.surface(&ray, &closest, &mut scratch);
            let place = |point: &SurfacePoint| (point.t, point.point, point.normal, point.from_outside);
            prop_assert_eq!(place(&found), place(&point), "{} {:?}", name, ray);
        }
    }
    Ok(())
}

#[test]
fn a_plane_that_a_ray_nearly_runs_along_is_hit_at_the_right_point_or_not_at_all() {
    let scene = scene(&[PreparedShape::Plane(Plane::new(DVec3::ZERO, DVec3::Y).unwrap())]);
    for exponent in 0..=323 {
        let slope: f64 = format!("1e-{exponent}").parse().unwrap();
        let ray = CastRay::new(DVec3::new(0.0, 3.0, 0.0), DVec3::new(0.0, -slope, 1.0)).unwrap();
        let found = scene.cast(&ray);
        // The largest `f64` is 1.8e308.
        assert_eq!(found.is_some(), exponent <= 307, "1e-{exponent}");
        if let Some(hit) = found {
            let (expected, distance) = (3.0 / slope, 3.0 / slope * (1.0 + slope * slope).sqrt());
            let is_right = |found: f64, expected: f64| (found / expected - 1.0).abs() < 1e-15;
            assert!(is_right(hit.point.z, expected) && hit.point.y.abs() < 1e-15, "1e-{exponent}: {hit:?}");
            assert!(is_right(hit.distance(&ray), distance), "1e-{exponent}: {}", hit.distance(&ray));
        }
    }
}

#[test]
fn planes_are_hit_from_however_far_away() {
    let scene = scene(&[PreparedShape::Plane(Plane::new(DVec3::new(0.0, 1.0, 0.0), DVec3::Y).unwrap())]);
    for exponent in [100, 168, 169, 299, 300, 301, 307, 308] {
        let height: f64 = format!("1e{exponent}").parse().unwrap();
        for across in [0.0, 0.25, 0.7] {
            let ray = CastRay::new(DVec3::new(0.0, height, 0.0), DVec3::new(across, -1.0, 0.0)).unwrap();
            let point = scene.cast(&ray).unwrap().point;
            assert_eq!(point.y, 1.0, "1e{exponent}");
            assert!((point.x - across * height).abs() <= 1e-15 * height, "1e{exponent}: {point}");
        }
    }
}
