//! What bundles find, held against single rays, at every level.

use glam::{DAffine3, DMat3, DVec3};
use proptest::prelude::*;

use super::{Bundle, Candidates};
use crate::trace::math::{SimdLevel, scaled};
use crate::trace::query::Scratch;
use crate::trace::rays::{Limit, Ray};
use crate::trace::scene::{Camera, Geometry, PreparedScene, PreparedShape, SurfaceMaterial};
use crate::trace::shapes::{AlignedBox, BoxImage, Plane, Sphere, SphereImage};

const SIDE: u32 = 16;

/// Often where others are, so that rays graze, start on surfaces and meet several shapes at one point.
fn coordinate() -> impl Strategy<Value = f64> {
    let nudge = prop_oneof![Just(0.0), -1e-15..1e-15, -1e-9..1e-9, -1e-4..1e-4];
    prop_oneof![
        3 => (-4..=4).prop_map(f64::from),
        2 => -4.0..4.0,
        1 => (-4..=4, nudge).prop_map(|(whole, off)| f64::from(whole) + off),
    ]
}

fn point() -> impl Strategy<Value = DVec3> {
    (coordinate(), coordinate(), coordinate()).prop_map(DVec3::from)
}

fn size() -> impl Strategy<Value = f64> {
    prop_oneof![4 => Just(1.0), 2 => 0.1..2.0, 1 => 1e-6..1e-3, 1 => Just(1e6)]
}

fn shape() -> impl Strategy<Value = PreparedShape> {
    let sphere =
        (point(), size()).prop_map(|(center, radius)| PreparedShape::Sphere(Sphere { center, radius }));
    let aligned = (point(), size(), size()).prop_map(|(min, width, height)| {
        PreparedShape::AlignedBox(AlignedBox { min, max: min + DVec3::new(width, height, width) })
    });
    let plane = (point(), point()).prop_filter_map("no direction", |(point, normal)| {
        Some(PreparedShape::Plane(Plane::new(point, normal)?))
    });
    let map = (point(), 0.1..3.0, 0.2..2.0).prop_map(|(translation, angle, stretch)| DAffine3 {
        matrix3: DMat3::from_rotation_y(angle) * DMat3::from_diagonal(DVec3::new(1.0, stretch, 1.0)),
        translation,
    });
    let images = (map, any::<bool>()).prop_filter_map("a map without an inverse", |(map, round)| {
        Some(if round {
            PreparedShape::SphereImage(SphereImage::new(map, 1.0))
        } else {
            PreparedShape::BoxImage(BoxImage::new(map, DVec3::splat(0.5))?)
        })
    });
    prop_oneof![3 => sphere, 3 => aligned, 1 => plane, 1 => images]
}

fn scene(shapes: &[PreparedShape]) -> PreparedScene {
    let mut geometry = Geometry::default();
    for shape in shapes {
        let _ = geometry.push(*shape);
    }
    PreparedScene::new(geometry, vec![SurfaceMaterial::default(); shapes.len()])
}

fn rays(camera: &Camera) -> Vec<(usize, Ray)> {
    let pixels = (0..SIDE).flat_map(|j| (0..SIDE).map(move |i| (i, j)));
    let ray = |(i, j)| Some(((j / 4 * 4 + i / 4) as usize, camera.ray(i, j)?));
    pixels.filter_map(ray).collect()
}

/// Compares what a bundle finds at every level with what single rays find, and returns how many rays it decided itself.
fn decided(scene: &mut PreparedScene, camera: &Camera) -> Result<usize, TestCaseError> {
    let rays = rays(camera);
    let mut least = rays.len();
    let (mut bundle, mut hits, mut scratch) = (Bundle::default(), Vec::new(), Scratch::default());
    for (name, level) in SimdLevel::all() {
        scene.simd = level;
        let Some(open) = bundle.closest_hits(scene, rays.iter().copied(), &mut scratch, &mut hits) else {
            return Ok(0);
        };
        let open = open.to_vec();
        least = least.min(rays.len() - open.len());
        for (index, (_, ray)) in rays.iter().enumerate() {
            if u32::try_from(index).is_ok_and(|index| open.contains(&index)) {
                continue;
            }
            scratch.tied_hits.clear();
            let single = scene.closest(scene.geometry(), ray, &mut scratch);
            let found = hits[index].map(|closest| closest.hit);
            prop_assert_eq!(found, single.map(|closest| closest.hit), "{} {:?}", name, ray);
            prop_assert!(single.is_none_or(|closest| closest.tied.is_empty()), "{} {:?}", name, ray);
        }
    }
    Ok(least)
}

fn camera(eye: DVec3, view: DVec3, wide: f64) -> Camera {
    Camera::new(eye, view, DVec3::Y, 1.0, (wide, wide), (SIDE, SIDE))
}

proptest! {
    #![proptest_config(ProptestConfig::with_cases(6000))]

    #[test]
    fn bundles_find_what_single_rays_find(
        shapes in prop::collection::vec(shape(), 1..14),
        eye in point(),
        view in point(),
        wide in prop_oneof![Just(1.0), Just(0.01), Just(3.0)],
        far in prop_oneof![4 => Just(1.0), 1 => Just(50.0), 1 => Just(1e7)],
    ) {
        let view = if view == DVec3::ZERO { DVec3::Z } else { view };
        decided(&mut scene(&shapes), &camera(eye * far, view, wide))?;
    }
}

proptest! {
    #![proptest_config(ProptestConfig::with_cases(3000))]

    /// From points on shapes and from anywhere, to a light that may be on a shape or within one.
    #[test]
    fn candidates_hide_a_light_where_the_tree_says_so(
        shapes in prop::collection::vec(shape(), 1..14),
        eye in point(),
        view in point(),
        light in point(),
        far in prop_oneof![4 => Just(1.0), 1 => Just(50.0)],
    ) {
        let view = if view == DVec3::ZERO { DVec3::Z } else { view };
        let (mut scene, light) = (scene(&shapes), light * far);
        let mut scratch = Scratch::default();
        let mut shadow_rays: Vec<(Ray, Limit, usize, DVec3)> = Vec::new();
        for (part, ray) in rays(&camera(eye, view, 2.0)) {
            scratch.tied_hits.clear();
            let Some(closest) = scene.closest(scene.geometry(), &ray, &mut scratch) else { continue };
            let surface = scene.surface(scene.geometry(), &ray, &closest, &mut scratch);
            let Some((direction, scale)) = scaled(light - surface.point) else { continue };
            let outward = direction.dot(surface.normal) > 0.0;
            if let Some(ray) = surface.leave(outward, direction) {
                shadow_rays.push((ray, Limit::new(scale.recip(), light), part, direction));
            }
        }
        let mut candidates = Candidates::default();
        for (name, level) in SimdLevel::all() {
            scene.simd = level;
            let rays = shadow_rays.iter().map(|(_, limit, part, direction)| (*part, *direction, *limit));
            if !candidates.find(&scene, rays, &mut scratch) {
                continue;
            }
            for (ray, limit, part, _) in &shadow_rays {
                let hidden = |candidates, scratch: &mut Scratch<'_>| {
                    scene.occluder(scene.geometry(), ray, limit, (None, candidates), scratch).is_some()
                };
                let listed = hidden(candidates.of(*part), &mut scratch);
                prop_assert_eq!(listed, hidden(None, &mut scratch), "{} {:?}", name, ray);
            }
        }
    }
}

/// Few shapes are asked, and those that matter: a test of the test above, which could not fail otherwise.
#[test]
fn candidates_are_few() {
    let mut shapes: Vec<PreparedShape> = (0..400)
        .map(|index| DVec3::new(f64::from(index % 20) - 9.7, 5.0, f64::from(index / 20) - 9.6))
        .map(|center| PreparedShape::Sphere(Sphere { center, radius: 0.4 }))
        .collect();
    shapes.push(PreparedShape::Plane(Plane::new(DVec3::ZERO, DVec3::Y).unwrap()));
    let (scene, light) = (scene(&shapes), DVec3::new(0.0, 20.0, 0.0));
    let mut candidates = Candidates::default();
    let floor =
        (0..256).map(|index| DVec3::new(f64::from(index % 16) * 0.1, 0.0, f64::from(index / 16) * 0.1));
    let rays = floor.zip(0..).map(|(point, index)| {
        let (direction, scale) = scaled(light - point).unwrap();
        (index / 64 * 4 + index % 16 / 4, direction, Limit::new(scale.recip(), light))
    });
    assert!(candidates.find(&scene, rays, &mut Scratch::default()));
    let counts: Vec<usize> = (0..16).map(|part| candidates.of(part).unwrap().len()).collect();
    assert!(counts.iter().any(|count| *count > 0) && counts.iter().all(|count| *count <= 4), "{counts:?}");
}

/// What is not close is decided at once: a test of the test above, which could not fail otherwise.
#[test]
fn nearly_all_rays_are_decided_at_once() {
    let floor = PreparedShape::Plane(Plane::new(DVec3::NEG_Y, DVec3::Y).unwrap());
    let mut shapes = vec![floor];
    for index in 0..200 {
        let place = DVec3::new(f64::from(index % 20) - 9.7, f64::from(index % 3), f64::from(index / 20));
        shapes.push(if index % 2 == 0 {
            PreparedShape::Sphere(Sphere { center: place, radius: 0.4 })
        } else {
            PreparedShape::AlignedBox(AlignedBox { min: place, max: place + 0.5 })
        });
    }
    let camera = camera(DVec3::new(0.3, 2.0, -6.1), DVec3::new(0.01, -0.2, 1.0), 2.0);
    assert_eq!(decided(&mut scene(&shapes), &camera).unwrap(), 256);
}
