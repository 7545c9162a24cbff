//! Comparisons of packets with single rays, at every SIMD level.

use fearless_simd::dispatch;
use glam::{DAffine3, DMat3, DVec3};
use proptest::prelude::*;

use super::{
    Candidates, LightBox, LitPoints, Occluders, PacketScratch, ShadowPacket, ShadowRays, bundle_hits,
    closest_hits, occluded, refine,
};
use crate::color::Rgb;
use crate::trace::bvh::LeafId;
use crate::trace::intersect::{Crossing, HitPacket, Scratch, SurfacePacket};
use crate::trace::math::{HALF, Numbers, SimdLevel, lanes, scaled};
use crate::trace::rays::{PreparedRay, RayPacket, RayView, ShadowLimit, ShapeId, TieLists};
use crate::trace::scene::{
    Geometry, PixelCenters, PreparedCamera, PreparedScene, PreparedShape, Refraction, Square, SurfaceMaterial,
};
use crate::trace::shapes::{AlignedBox, BoxImage, Plane, Rod, RodImage, Sphere, SphereImage};

const SIDE: u32 = 16;

/// Every shape is an opaque occluder.
pub(super) const OPAQUE: Occluders = Occluders { except: None, transparent: false };

/// A coordinate that often coincides with others, so that rays graze shapes, start on surfaces and hit several shapes at one point.
fn coordinate() -> impl Strategy<Value = f64> {
    let nudge = prop_oneof![Just(0.0), -1e-15..1e-15, -1e-9..1e-9, -1e-4..1e-4];
    prop_oneof![
        3 => (-4..=4).prop_map(f64::from),
        2 => -4.0..4.0,
        1 => (-4..=4, nudge).prop_map(|(whole, off)| f64::from(whole) + off),
    ]
}

pub(super) fn point() -> impl Strategy<Value = DVec3> {
    (coordinate(), coordinate(), coordinate()).prop_map(DVec3::from)
}

fn size() -> impl Strategy<Value = f64> {
    prop_oneof![4 => Just(1.0), 2 => 0.1..2.0, 1 => 1e-6..1e-3, 1 => Just(1e6)]
}

pub(super) fn shape() -> impl Strategy<Value = PreparedShape> {
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
    let rods =
        (point(), point(), size(), any::<bool>()).prop_filter_map("no axis", |(from, to, radius, round)| {
            let rod = if round { Rod::capsule(from, to, radius) } else { Rod::cylinder(from, to, radius) };
            rod.map(PreparedShape::Rod)
        });
    let map = (point(), 0.1..3.0, 0.2..2.0).prop_map(|(translation, angle, stretch)| DAffine3 {
        matrix3: DMat3::from_rotation_y(angle) * DMat3::from_diagonal(DVec3::new(1.0, stretch, 1.0)),
        translation,
    });
    let rod_images = (map, point(), any::<bool>()).prop_filter_map("no axis", |(map, stop, round)| {
        let image =
            if round { RodImage::capsule(map, stop, 0.5) } else { RodImage::cylinder(map, stop, 0.5) };
        image.map(PreparedShape::RodImage)
    });
    prop_oneof![3 => sphere, 3 => aligned, 1 => plane, 3 => images, 3 => rods, 2 => rod_images]
}

pub(super) fn scene(shapes: &[PreparedShape]) -> PreparedScene {
    scene_of(shapes, |_| false)
}

pub(super) fn scene_of(shapes: &[PreparedShape], is_transparent: impl Fn(usize) -> bool) -> PreparedScene {
    let mut geometry = Geometry::default();
    for shape in shapes {
        let _ = geometry.push(*shape);
    }
    let glass = Refraction { transmitted: 0.5, ior: 1.5, absorption: Rgb::ZERO, fresnel: false };
    let material = |index| SurfaceMaterial {
        refraction: is_transparent(index).then_some(glass),
        ..SurfaceMaterial::default()
    };
    PreparedScene::new(geometry, (0..shapes.len()).map(material).collect::<Vec<_>>())
}

/// Creates the camera's rays, in packets of four by four pixels.
fn packets(scene: &PreparedScene, camera: &PreparedCamera) -> Vec<RayPacket> {
    let centers = PixelCenters::of(camera);
    let mut packets = vec![RayPacket::EMPTY; 16];
    for (packet, index) in packets.iter_mut().zip(0..) {
        let first = (index % 4 * 4, index / 4 * 4);
        let square = Square { first, size: (4, 4) };
        dispatch!(scene.simd.level(), simd => centers.rays(simd, &square, packet));
        let squares = (0..16).map(|lane| (first.0 + lane % 4, first.1 + lane / 4));
        for (lane, (i, j)) in squares.enumerate().filter(|(lane, _)| packet.lanes & (1 << lane) != 0) {
            assert_eq!(Some(packet.get(lane)), camera.ray(i, j));
        }
    }
    packets
}

/// Compares a packet's hits and surface points with the results of single rays. Returns the number of decided rays.
pub(super) fn compare(
    name: &str,
    scene: &PreparedScene,
    rays: &RayPacket,
    hits: &mut HitPacket,
    ties: &TieLists,
) -> Result<usize, TestCaseError> {
    let mut scratch = Scratch { ties: ties.clone(), ..Scratch::default() };
    let decided = rays.lanes & !hits.undecided;
    let mut surfaces = SurfacePacket::EMPTY;
    let with_hit = decided
        & lanes(0xffff).filter(|lane| hits.get(*lane).is_some()).fold(0, |mask, lane| mask | 1 << lane);
    let special =
        dispatch!(scene.simd.level(), simd => refine(simd, scene, rays, hits, with_hit, &mut surfaces));
    prop_assert_eq!(with_hit & !special, surfaces.lanes);
    for lane in lanes(decided) {
        let ray = rays.get(lane);
        scratch.tied_hits.clear();
        let single = scene.closest(&ray, &mut scratch);
        prop_assert_eq!(hits.get(lane), single, "{} {:?}", name, ray);
        if let (Some(closest), true) = (single, surfaces.lanes & (1 << lane) != 0) {
            let point = scene.surface(&ray, &closest, &mut scratch);
            prop_assert_eq!(surfaces.get(lane, hits), Some(point), "{} {:?}", name, ray);
        }
    }
    Ok(decided.count_ones() as usize)
}

/// Compares a bundle's hits with the hits of single rays, at every SIMD level. Returns the smallest number of rays decided at any level.
fn decided(scene: &mut PreparedScene, camera: &PreparedCamera) -> Result<usize, TestCaseError> {
    let mut least = usize::MAX;
    for (name, level) in SimdLevel::all() {
        scene.simd = level;
        let packets = packets(scene, camera);
        let mut hits = vec![HitPacket::EMPTY; 16];
        let origin = camera.position();
        let scratch = (&mut Scratch::default(), &mut PacketScratch::default());
        if !bundle_hits(scene, origin, &packets, &mut hits, scratch) {
            return Ok(0);
        }
        let mut count = 0;
        for (rays, hits) in packets.iter().zip(&mut hits) {
            count += compare(name, scene, rays, hits, &TieLists::default())?;
        }
        least = least.min(count);
    }
    Ok(least)
}

/// Compares the hits of separate packets with the hits of single rays, at every SIMD level. Returns the smallest number of rays decided at
/// any level.
fn decided_by_packets(
    scene: &mut PreparedScene,
    packets: &[RayPacket],
    ties: &TieLists,
) -> Result<usize, TestCaseError> {
    let mut least = usize::MAX;
    for (name, level) in SimdLevel::all() {
        scene.simd = level;
        let mut count = 0;
        for rays in packets {
            let mut hits = HitPacket::EMPTY;
            let scratch = Scratch::default();
            closest_hits(scene, rays, &mut hits, &mut PacketScratch::default(), scratch.cancelled);
            count += compare(name, scene, rays, &mut hits, ties)?;
        }
        least = least.min(count);
    }
    Ok(least)
}

/// Creates rays that leave the surfaces that the camera sees, reflected or straight through, with their lists of coincident shapes.
fn secondary(scene: &PreparedScene, camera: &PreparedCamera, inwards: bool) -> (Vec<RayPacket>, TieLists) {
    let mut scratch = Scratch::default();
    let mut packets = Vec::new();
    for rays in packets_of(camera) {
        let mut packet = RayPacket::EMPTY;
        for (lane, ray) in rays.iter().enumerate() {
            scratch.tied_hits.clear();
            let Some(closest) = scene.closest(ray, &mut scratch) else { continue };
            let surface = scene.surface(ray, &closest, &mut scratch);
            let direction = ray.direction();
            let mirrored = direction - 2.0 * direction.dot(surface.normal) * surface.normal;
            let left = if inwards {
                surface.leave(!surface.from_outside, direction)
            } else {
                surface.leave(surface.from_outside, mirrored)
            };
            if let Some(ray) = left {
                packet.set(lane, &ray);
            }
        }
        packets.push(packet);
    }
    (packets, scratch.ties)
}

/// Creates the camera's rays, in groups of sixteen.
fn packets_of(camera: &PreparedCamera) -> Vec<Vec<PreparedRay>> {
    let square = |index: u32| {
        let pixels = (0..16).map(move |lane| (index % 4 * 4 + lane % 4, index / 4 * 4 + lane / 4));
        pixels.filter_map(|(i, j)| camera.ray(i, j)).collect()
    };
    (0..16).map(square).collect()
}

pub(super) fn camera(eye: DVec3, view: DVec3, wide: f64) -> PreparedCamera {
    PreparedCamera::new(eye, view, DVec3::Y, 1.0, (wide, wide), (SIDE, SIDE))
}

/// Returns the vector, or Z for the null vector.
pub(super) fn looking(view: DVec3) -> DVec3 {
    if view == DVec3::ZERO { DVec3::Z } else { view }
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
        decided(&mut scene(&shapes), &camera(eye * far, looking(view), wide))?;
    }
}

proptest! {
    #![proptest_config(ProptestConfig::with_cases(2000))]

    /// Tests rays from arbitrary points, and rays that leave surfaces outwards and inwards.
    #[test]
    fn packets_find_what_single_rays_find(
        shapes in prop::collection::vec(shape(), 1..14),
        eye in point(),
        view in point(),
        wide in prop_oneof![Just(1.0), Just(0.01), Just(3.0)],
        far in prop_oneof![4 => Just(1.0), 1 => Just(50.0), 1 => Just(1e7)],
    ) {
        let mut scene = scene(&shapes);
        let camera = camera(eye * far, looking(view), wide);
        let straight = packets(&scene, &camera);
        decided_by_packets(&mut scene, &straight, &TieLists::default())?;
        for inwards in [false, true] {
            let (packets, ties) = secondary(&scene, &camera, inwards);
            decided_by_packets(&mut scene, &packets, &ties)?;
        }
    }

    /// Tests shadow rays that leave shapes outwards and inwards, to a light that may be on a shape or within one, with and without candidate
    /// lists. Some shapes are transparent.
    #[test]
    fn packets_are_hidden_where_single_rays_are(
        shapes in prop::collection::vec((shape(), any::<bool>()), 1..14),
        eye in point(),
        view in point(),
        light in point(),
        far in prop_oneof![4 => Just(1.0), 1 => Just(50.0)],
        transparent in any::<bool>(),
        own in 0..20_u32,
        (reach, off) in (prop::array::uniform3(prop_oneof![Just(0.0), 0.0..0.6]), prop::array::uniform3(-1.0..1.0)),
    ) {
        let (kinds, transparent_kinds): (Vec<PreparedShape>, Vec<bool>) = shapes.into_iter().unzip();
        let (mut scene, light) = (scene_of(&kinds, |index| transparent && transparent_kinds[index]), light * far);
        let except = ((own as usize) < kinds.len()).then_some(ShapeId(own));
        let (shadows, ties) = shadow_rays(&scene, &camera(eye, looking(view), 2.0), light);
        for (name, level) in SimdLevel::all() {
            scene.simd = level;
            let shadow_rays = shadows.iter().map(|(rays, limits)| ShadowRays {
                rays,
                limits,
                lanes: rays.lanes,
            });
            let occluders = Occluders { except, transparent };
            let mut scratch = Scratch { ties: ties.clone(), ..Scratch::default() };
            let mut candidates = Candidates::default();
            let listed = candidates.find(&scene, (light, occluders), &shadow_rays, &mut scratch);
            // The light is one point of an area light.
            let reach = DVec3::from_array(reach);
            let large = LightBox { middle: light + reach * DVec3::from_array(off), reach: reach * (1.0 + 1e-9) };
            let points = shadows.iter().map(|(rays, _)| LitPoints {
                points: &rays.origins,
                left: &rays.left,
                lanes: rays.lanes,
            });
            let mut all_candidates = Candidates::default();
            let all_listed = all_candidates.find_all(&scene, (large, occluders), &points, &mut scratch);
            for (packet, (rays, limits)) in shadows.iter().enumerate() {
                let lists = [0, 1].map(|half| if listed { candidates.of(packet, half) } else { None });
                let all_lists = [0, 1].map(|half| if all_listed { all_candidates.of(packet, half) } else { None });
                let all_unbounded = if all_listed { all_candidates.unbounded() } else { &scene.unbounded };
                let covered = if listed { candidates.occluded(packet) } else { 0 };
                let listed_unbounded = if listed { candidates.unbounded() } else { &scene.unbounded };
                let unoccluded = if listed && candidates.is_unoccluded(packet) { rays.lanes & !rays.tied & !covered } else { 0 };
                let searches = [
                    ([None; 2], None, &*scene.unbounded),
                    ([None; 2], Some(light), &scene.unbounded),
                    (lists, Some(light), listed_unbounded),
                    (all_lists, None, all_unbounded),
                ];
                for (candidates, lit_from, unbounded) in searches {
                    let shadow = ShadowPacket { rays, limits, light: lit_from, occluders, unbounded, candidates };
                    let mut packet_scratch = PacketScratch::default();
                    let found = occluded(&scene, &shadow, &mut None, &mut packet_scratch, scratch.cancelled);
                    for lane in lanes(rays.lanes) {
                        let (ray, limit) = (rays.get(lane), ShadowLimit::new(limits.get(lane), light));
                        let single = occluded_ray(&scene, &ray, &limit, (except, candidates[lane / HALF]), transparent, &mut scratch);
                        let (in_tree, crossed) = occluded_ray(&scene, &ray, &limit, (except, None), transparent, &mut scratch);
                        prop_assert_eq!(single.0, in_tree, "{} {:?}", name, ray);
                        prop_assert!(in_tree || covered & (1 << lane) == 0, "{} {:?}", name, ray);
                        prop_assert!(!in_tree || unoccluded & (1 << lane) == 0, "{} {:?}", name, ray);
                        if found.undecided & (1 << lane) == 0 {
                            let occluded = found.occluded & (1 << lane) != 0;
                            prop_assert_eq!(occluded, in_tree, "{} {:?}", name, ray);
                            if !occluded {
                                let found = sorted(packet_scratch.crossed.iter().flat_map(|crossed| crossed.of(lane)).flatten());
                                prop_assert_eq!(found, crossed, "{} {:?}", name, ray);
                            }
                        }
                    }
                }
            }
        }
    }

    /// Tests small spheres, most of which lie next to the parts of a bundle, or touch their edges.
    #[test]
    fn no_grain_of_many_is_lost(
        centers in prop::collection::vec((-1.0..1.0, -1.0..1.0, 0.0..4.0), 60),
        radius in prop_oneof![1e-4..1e-2, 1e-2..0.2],
        turned in any::<bool>(),
    ) {
        let center = |(x, y, z): (f64, f64, f64)| if turned { DVec3::new(-z, x, y) } else { DVec3::new(x, y, z) };
        let grain = |place| PreparedShape::Sphere(Sphere { center: center(place), radius });
        let grains: Vec<PreparedShape> = centers.into_iter().map(grain).collect();
        let camera = camera(center((0.1, 0.0, -1.0)), center((0.0, 0.1, 1.0)), 1.0);
        prop_assert!(decided(&mut scene(&grains), &camera)? > 200);
    }
}

/// The crossings of a ray: shape, bits of `t`, and true if the ray enters the shape.
type Crossings = Vec<(u32, u64, bool)>;

fn sorted(crossings: impl IntoIterator<Item = Crossing>) -> Crossings {
    let mut all: Crossings = crossings
        .into_iter()
        .map(|crossing| (crossing.id.0, crossing.t.to_bits(), crossing.entering))
        .collect();
    all.sort_unstable();
    all
}

/// Returns whether a ray is occluded and, if not, its crossings with transparent shapes.
fn occluded_ray(
    scene: &PreparedScene,
    ray: &PreparedRay,
    limit: &ShadowLimit,
    occluders: (Option<ShapeId>, Option<&[LeafId]>),
    transparent: bool,
    scratch: &mut Scratch<'_>,
) -> (bool, Crossings) {
    if !transparent {
        return (scene.occluder(ray, limit, occluders, scratch).is_some(), Vec::new());
    }
    if scene.occluder_or_crossed(ray, limit, occluders, scratch).is_some() {
        return (true, Vec::new());
    }
    let Scratch { crossed, crossings, intersector, ties, .. } = scratch;
    crossings.clear();
    let ray = &RayView::new(ray, ties);
    crossed.iter().for_each(|crossed| crossed.cross(scene, (ray, limit), crossings, intersector));
    (false, sorted(crossings.drain(..)))
}

/// Checks that an area light has few possible occluders, and that most lists are short enough. Otherwise the comparison of shadow rays could
/// not fail.
#[test]
fn a_light_with_a_size_has_lists() {
    let scene = crowd();
    let camera = camera(DVec3::new(0.3, 2.0, -6.1), DVec3::new(0.01, -0.2, 1.0), 0.2);
    let middle = DVec3::new(3.0, 30.0, -2.0);
    let (shadows, _) = shadow_rays(&scene, &camera, middle);
    let points = shadows.iter().map(|(rays, _)| LitPoints {
        points: &rays.origins,
        left: &rays.left,
        lanes: rays.lanes,
    });
    let light = (LightBox { middle, reach: DVec3::new(1.0, 0.0, 1.0) }, OPAQUE);
    let mut candidates = Candidates::default();
    assert!(candidates.find_all(&scene, light, &points, &mut Scratch::default()));
    let counts: Vec<Option<usize>> =
        (0..32).map(|part| candidates.of(part / 2, part % 2).map(<[LeafId]>::len)).collect();
    let listed: Vec<usize> = counts.iter().copied().flatten().collect();
    assert!(listed.len() >= 16 && listed.iter().any(|count| *count > 0), "{counts:?}");
    assert!(candidates.unbounded().is_empty(), "the floor is below all points");
}

/// Creates rays from the surfaces that the camera sees to a light, with their `t` at the light, and their lists of coincident shapes.
fn shadow_rays(
    scene: &PreparedScene,
    camera: &PreparedCamera,
    light: DVec3,
) -> (Vec<(RayPacket, Numbers)>, TieLists) {
    let mut scratch = Scratch::default();
    let mut shadows = Vec::new();
    for rays in packets_of(camera) {
        let (mut packet, mut limits) = (RayPacket::EMPTY, Numbers::splat(0.0));
        for (lane, ray) in rays.iter().enumerate() {
            scratch.tied_hits.clear();
            let Some(closest) = scene.closest(ray, &mut scratch) else { continue };
            let surface = scene.surface(ray, &closest, &mut scratch);
            let Some((direction, scale)) = scaled(light - surface.point) else { continue };
            let outward = direction.dot(surface.normal) > 0.0;
            if let Some(ray) = surface.leave(outward, direction) {
                packet.set(lane, &ray);
                limits.set(lane, scale.recip());
            }
        }
        shadows.push((packet, limits));
    }
    (shadows, scratch.ties)
}

/// Creates two hundred spheres and boxes above a floor.
pub(super) fn crowd() -> PreparedScene {
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
    scene(&shapes)
}

/// Checks that packets decide all rays without close comparisons. Otherwise the comparisons above could not fail.
#[test]
fn nearly_all_rays_are_decided_at_once() {
    let mut scene = crowd();
    let camera = camera(DVec3::new(0.3, 2.0, -6.1), DVec3::new(0.01, -0.2, 1.0), 2.0);
    assert_eq!(decided(&mut scene, &camera).unwrap(), 256);
    let straight = packets(&scene, &camera);
    assert_eq!(decided_by_packets(&mut scene, &straight, &TieLists::default()).unwrap(), 256);
    for inwards in [false, true] {
        let (packets, ties) = secondary(&scene, &camera, inwards);
        let count: u32 = packets.iter().map(|packet| packet.lanes.count_ones()).sum();
        let decided = decided_by_packets(&mut scene, &packets, &ties).unwrap();
        assert!(count > 150 && decided + 8 >= count as usize, "{decided} of {count}");
    }
    let light = DVec3::new(3.0, 30.0, -2.0);
    let (shadows, _) = shadow_rays(&scene, &camera, light);
    let (mut shadowed, mut lit) = (0, 0);
    for (rays, limits) in &shadows {
        let shadow = ShadowPacket {
            rays,
            limits,
            light: Some(light),
            occluders: OPAQUE,
            unbounded: &scene.unbounded,
            candidates: [None; 2],
        };
        let cancelled = Scratch::default().cancelled;
        let found = occluded(&scene, &shadow, &mut None, &mut PacketScratch::default(), cancelled);
        shadowed += found.occluded.count_ones();
        lit += (rays.lanes & !found.occluded & !found.undecided).count_ones();
    }
    assert!(shadowed > 10 && lit > 100 && shadowed + lit > 150, "{shadowed} occluded, {lit} lit");
}

/// Tests distances around the limit of `f32`, where origins overflow in the tree's frame, but ray parameters may not.
#[test]
fn from_however_far_the_nearest_is_found() {
    for places in [[0.0, 8.0], [8.0, 0.0]] {
        let sphere = |z| PreparedShape::Sphere(Sphere { center: DVec3::Z * z, radius: 1.0 });
        let mut scene = scene(&places.map(sphere));
        let nearest = ShapeId(u32::from(places[0] > places[1]));
        for far in [1e38, 3e38, 4e38, 6e38, 1e39, 1e45] {
            let origin = DVec3::Z * (-far / scene.tree.scale());
            let ray = PreparedRay::new(origin, DVec3::Z * 1.9).unwrap();
            let found = scene.closest(&ray, &mut Scratch::default());
            assert_eq!(found.map(|closest| closest.hit.id), Some(nearest), "{far:e} {places:?}");
            let mut rays = RayPacket::EMPTY;
            (0..16).for_each(|lane| rays.set(lane, &ray));
            decided_by_packets(&mut scene, &[rays], &TieLists::default()).unwrap();
        }
    }
}
