//! Comparison of features with the surfaces that many samples of every pixel hit.

use glam::{DAffine3, DQuat};
use proptest::prelude::*;
use proptest::strategy::ValueTree;
use proptest::test_runner::TestRunner;

use super::images::seen_area;
use super::mirror::Ball;
use super::*;
use crate::color::Rgb;
use crate::trace::Effects;
use crate::trace::math::PixelSampling;
use crate::trace::rays::PreparedRay;
use crate::trace::scene::{LightSource, PatternedSurface, PreparedLight, PreparedPattern, ShapeRef};
use crate::trace::shading::RenderContext;
use crate::trace::shapes::{AlignedBox, BoxImage, Plane, Rod, RodImage, Sphere, SphereImage};
use crate::trace::{Geometry, PatternFunction, PreparedShape, SurfaceMaterial};

const SIDE_PIXELS: u32 = 20;

/// The shape that a ray hits, for boxes the axis and side of the face, and whether it has the pattern's second colour there.
type Surface = Option<(ShapeId, [i8; 3], bool)>;

fn surface(scene: &PreparedScene, ray: &PreparedRay, search: &mut Scratch<'_>) -> Surface {
    let hit = scene.closest_of_all(ray, search)?;
    let point = scene.surface(ray, &hit, search);
    let is_box = matches!(scene.geometry().shape(point.hit.id), ShapeRef::AlignedBox(_));
    #[expect(clippy::cast_possible_truncation, reason = "-1, 0 or 1")]
    let face = if is_box { point.normal.to_array().map(|part| part.round() as i8) } else { [0; 3] };
    let flat_end = match scene.geometry().shape(point.hit.id) {
        ShapeRef::Rod(rod) => rod.slab().map(|(row, _)| row.normalize()),
        _ => None,
    };
    let is_flat = flat_end.is_some_and(|axis| axis.dot(point.normal).abs() > 0.999_999);
    let face = if is_flat { [2; 3] } else { face };
    let is_second = scene.material(point.hit.id).pattern_share(point.point, point.normal) > 0.5;
    Some((point.hit.id, face, is_second))
}

/// Returns the pixels without a feature whose samples hit more than one surface, and the total number of pixels without a feature.
fn missed(scene: &PreparedScene, camera: &PreparedCamera, samples: u32) -> (Vec<(u32, u32)>, usize) {
    let (columns, rows) = camera.resolution();
    let (mut missed, mut plain) = (Vec::new(), 0);
    let mut search = Scratch::default();
    for j in (0..rows).step_by(TILE as usize) {
        for i in (0..columns).step_by(TILE as usize) {
            let tile = Tile { i, j, width: TILE.min(columns - i), height: TILE.min(rows - j) };
            let (mut found, mut expected) = (FeatureScratch::default(), FeatureScratch::default());
            let scratch = (&mut found, &mut search);
            let of_instant = FeatureSearch::new(scene, camera, false);
            let found = of_instant.features((&tile, &KnownFeatures::NONE), scratch).unwrap();
            let expected =
                of_instant.reference_features((&tile, &KnownFeatures::NONE), &mut expected).unwrap();
            let differing: Vec<_> =
                found.features.iter().zip(&expected.features).filter(|(one, other)| one != other).collect();
            assert!(
                differing.is_empty(),
                "the tree and a linear scan differ: {:?}",
                &differing[..differing.len().min(3)]
            );
            for row in 0..tile.height {
                for column in 0..tile.width {
                    let (packet, lane) = Tile::lane_of(column as usize, row as usize);
                    if found.of(packet).0[lane].area > 0.0 {
                        continue;
                    }
                    plain += 1;
                    let (column, row) = (i + column, j + row);
                    let sampling = PixelSampling { samples, seed: 1 };
                    let mut surfaces = (0..samples).map(|sample| {
                        let ray = camera.sample_ray(sampling, column, row, sample).unwrap();
                        surface(scene, &ray, &mut search)
                    });
                    let first = surfaces.next().unwrap();
                    if surfaces.any(|other| other != first) {
                        missed.push((column, row));
                    }
                }
            }
        }
    }
    (missed, plain)
}

fn scene_of(shapes: &[PreparedShape]) -> PreparedScene {
    scene_with(shapes, |_| SurfaceMaterial::default())
}

fn scene_with(
    shapes: &[PreparedShape],
    material: impl FnMut(&PreparedShape) -> SurfaceMaterial,
) -> PreparedScene {
    let mut geometry = Geometry::default();
    shapes.iter().for_each(|shape| _ = geometry.push(*shape));
    PreparedScene::new(geometry, shapes.iter().map(material).collect::<Vec<_>>())
}

/// Creates a scene whose spheres, planes and boxes have a pattern.
fn patterned_scene_of(shapes: &[PreparedShape], function: PatternFunction) -> PreparedScene {
    scene_with(shapes, |shape| {
        let (map, surface) = match shape {
            PreparedShape::Sphere(Sphere { center, radius }) => {
                let map = DAffine3::from_translation(*center) * DAffine3::from_scale(DVec3::splat(*radius));
                (map, PatternedSurface::Sphere)
            }
            PreparedShape::Plane(plane) => {
                (DAffine3::from_translation(plane.point()), PatternedSurface::plane(plane.unit_normal()))
            }
            PreparedShape::AlignedBox(AlignedBox { min, max }) => {
                (DAffine3::from_translation(min.midpoint(*max)), PatternedSurface::Box((*max - *min) / 2.0))
            }
            PreparedShape::BoxImage(image) => (*image.forward(), PatternedSurface::Box(image.half())),
            _ => return SurfaceMaterial::default(),
        };
        let pattern = PatternLayout::new(map, surface, function)
            .map(|layout| Box::new(PreparedPattern { ambient: Rgb::ZERO, diffuse: Rgb::ZERO, layout }));
        SurfaceMaterial { pattern, ..SurfaceMaterial::default() }
    })
}

fn pattern() -> impl Strategy<Value = PatternFunction> {
    let size = || 0.1..20.0;
    prop_oneof![
        size().prop_map(|size| PatternFunction::Checker { size }),
        (size(), 0.1..0.9, point(1.0), -1.0..1.0).prop_map(|(size, ratio, direction, offset)| {
            PatternFunction::Stripes { size, ratio, direction, offset }
        }),
        (size(), size(), size(), 0.01..0.1)
            .prop_map(|(x, y, z, mortar)| PatternFunction::Bricks { size: DVec3::new(x, y, z), mortar }),
    ]
}

fn point(range: f64) -> impl Strategy<Value = DVec3> {
    prop::array::uniform3(-range..range).prop_map(DVec3::from_array)
}

fn size() -> impl Strategy<Value = f64> {
    prop_oneof![0.002..0.05, 0.05..0.5, 0.5..3.0]
}

fn placed() -> impl Strategy<Value = (DAffine3, DVec3)> {
    let sizes = (size(), size(), size()).prop_map(|(x, y, z)| DVec3::new(x, y, z));
    (point(4.0), point(1.0), 0.0..6.3, sizes).prop_map(|(at, axis, angle, half)| {
        let turn = DQuat::from_axis_angle(axis.normalize_or(DVec3::X), angle);
        (DAffine3::from_scale_rotation_translation(DVec3::ONE, turn, at), half)
    })
}

fn shape() -> impl Strategy<Value = PreparedShape> {
    prop_oneof![
        4 => (point(4.0), size()).prop_map(|(center, radius)| PreparedShape::Sphere(Sphere { center, radius })),
        3 => placed().prop_map(|(map, half)| {
            PreparedShape::AlignedBox(AlignedBox { min: map.translation - half, max: map.translation + half })
        }),
        2 => placed().prop_map(|(map, half)| PreparedShape::BoxImage(BoxImage::new(map, half).unwrap())),
        2 => placed().prop_map(|(map, half)| {
            PreparedShape::SphereImage(SphereImage::new(map * DAffine3::from_scale(half), 1.0))
        }),
        3 => (point(4.0), point(3.0), size(), any::<bool>()).prop_map(|(from, way, radius, is_round)| {
            let to = from + way;
            let rod = if is_round { Rod::capsule(from, to, radius) } else { Rod::cylinder(from, to, radius) };
            PreparedShape::Rod(rod.unwrap())
        }),
        1 => (placed(), any::<bool>()).prop_map(|((map, half), is_round)| {
            let (map, stop) = (map * DAffine3::from_scale(half), DVec3::new(0.3, 2.0, 0.1));
            let capsule = || RodImage::capsule(map, stop, 1.0);
            PreparedShape::RodImage(if is_round { capsule() } else { RodImage::cylinder(map, stop, 1.0) }.unwrap())
        }),
        1 => (point(4.0), point(1.0)).prop_map(|(at, normal)| {
            PreparedShape::Plane(Plane::new(at, normal.try_normalize().unwrap_or(DVec3::Y)).unwrap())
        }),
    ]
}

proptest! {
    #![proptest_config(ProptestConfig { cases: 300, failure_persistence: None, ..ProptestConfig::default() })]

    #[test]
    fn pixels_without_a_feature_show_one_surface(
        shapes in prop::collection::vec(shape(), 1..14),
        eye in point(8.0),
        view in point(1.0),
        wide in prop_oneof![Just(0.3), Just(1.0), Just(3.0)],
        lens in prop_oneof![3 => Just(0.0), 1 => 0.05..1.0],
    ) {
        let camera = PreparedCamera::new(eye, view - eye, DVec3::Y, 1.0, (wide, wide), (SIDE_PIXELS, SIDE_PIXELS)).with_lens(lens, 5.0);
        let (missed, _) = missed(&scene_of(&shapes), &camera, 64);
        prop_assert!(missed.is_empty(), "{:?}", missed);
    }

    #[test]
    fn pixels_without_a_feature_show_one_colour_of_a_pattern(
        shapes in prop::collection::vec(shape(), 1..4),
        function in pattern(),
        eye in point(8.0),
        view in point(1.0),
        wide in prop_oneof![Just(0.3), Just(1.0), Just(3.0)],
    ) {
        let camera = PreparedCamera::new(eye, view - eye, DVec3::Y, 1.0, (wide, wide), (SIDE_PIXELS, SIDE_PIXELS));
        let (missed, _) = missed(&patterned_scene_of(&shapes, function), &camera, 64);
        prop_assert!(missed.is_empty(), "{:?}", missed);
    }
}

/// Checks the test itself: most pixels of a simple scene have no feature, and shapes of a tenth of a pixel have one.
#[test]
fn plain_pixels_have_no_feature_and_tiny_shapes_have() {
    let sphere = |x: f64, radius| PreparedShape::Sphere(Sphere { center: DVec3::new(x, 0.0, 0.0), radius });
    let floor = PreparedShape::Plane(Plane::new(DVec3::new(0.0, -1.0, 0.0), DVec3::Y).unwrap());
    let camera =
        PreparedCamera::new(DVec3::new(0.0, 0.0, -5.0), DVec3::Z, DVec3::Y, 1.0, (1.0, 1.0), (80, 80));
    let (missed_few, plain) = missed(&scene_of(&[sphere(-0.5, 1.0), floor]), &camera, 256);
    assert!(missed_few.is_empty() && plain > 80 * 80 * 9 / 10, "{missed_few:?}, {plain}");
    let tile = Tile { i: 32, j: 32, width: 16, height: 16 };
    let (scene, mut scratch) = (scene_of(&[sphere(0.01, 0.003)]), FeatureScratch::default());
    let search = FeatureSearch::new(&scene, &camera, false);
    let found = search.reference_features((&tile, &KnownFeatures::NONE), &mut scratch).unwrap();
    let small: Vec<f32> =
        found.features.iter().map(|feature| feature.area).filter(|area| *area > 0.0).collect();
    assert!(
        !small.is_empty() && small.len() <= 4 && small.iter().all(|area| (0.005..0.02).contains(area)),
        "{small:?}"
    );
}

/// Checks that features are not found again while nothing changes, and that any change is noticed.
#[test]
fn features_of_the_same_view_are_found_once() {
    let tile = Tile { i: 32, j: 32, width: 16, height: 16 };
    let find = |ball: f64, eye: f64, ambient: f32, before: Option<u64>| {
        let sphere = Sphere { center: DVec3::new(ball, 0.0, 0.0), radius: 0.2 };
        let mut scene = scene_of(&[PreparedShape::Sphere(sphere)]);
        scene.ambient = Rgb::splat(ambient);
        let eye = DVec3::new(eye, 0.0, -5.0);
        let camera = PreparedCamera::new(eye, DVec3::Z, DVec3::Y, 1.0, (1.0, 1.0), (80, 80));
        let scratch = (&mut FeatureScratch::default(), &mut Scratch::default());
        let known = KnownFeatures { digest: before.unwrap_or_default(), ..KnownFeatures::NONE };
        let search = FeatureSearch::new(&scene, &camera, before.is_some());
        search.features((&tile, &known), scratch).map(|found| found.digest)
    };
    assert_eq!(find(0.0, 0.0, 0.0, None), Some(0));
    let digest = find(0.0, 0.0, 0.0, Some(0)).unwrap();
    assert!(digest != 0 && find(0.0, 0.0, 0.0, Some(digest)).is_none());
    for (ball, eye, ambient) in [(1e-9, 0.0, 0.0), (0.0, 1e-9, 0.0), (0.0, 0.0, 0.1)] {
        let changed = find(ball, eye, ambient, Some(digest)).unwrap();
        assert_ne!(changed, digest, "{ball}, {eye}, {ambient}");
    }
}

fn mirror() -> impl Strategy<Value = PreparedShape> {
    prop_oneof![
        2 => (point(3.0), 0.2..2.0).prop_map(|(center, radius)| PreparedShape::Sphere(Sphere { center, radius })),
        1 => placed().prop_map(|(map, half)| {
            PreparedShape::AlignedBox(AlignedBox { min: map.translation - half, max: map.translation + half })
        }),
        1 => placed().prop_map(|(map, half)| PreparedShape::BoxImage(BoxImage::new(map, half).unwrap())),
    ]
}

/// Returns whether a ray shows a tiny ball in a mirror, or a highlight.
fn shows_detail(context: &RenderContext<'_>, ray: &PreparedRay, search: &mut Scratch<'_>) -> bool {
    let scene = context.scene;
    let Some(hit) = scene.closest(ray, search) else { return false };
    let surface = scene.surface(ray, &hit, search);
    let material = scene.material(surface.hit.id);
    if !material.continues() {
        return false;
    }
    let (normal, direction) = (surface.normal, ray.direction());
    // The shape and the distance of what is seen from the surface.
    let mut above = |direction: DVec3| {
        let away = PreparedRay::new(surface.point + 1e-9 * normal, direction).unwrap();
        let hit = scene.closest(&away, search)?.hit;
        Some((hit.id, away.at(hit.root.t()).distance(surface.point)))
    };
    let reflected = above(direction - 2.0 * direction.dot(normal) * normal);
    if reflected.is_some_and(|(id, _)| !scene.material(id).continues()) {
        return true;
    }
    // All pixels of a small shape have a feature.
    let bounds = scene.geometry().bounds(surface.hit.id);
    if bounds.is_some_and(|bounds| seen_area(context.camera, &Ball::around(&bounds)) < LARGE) {
        return false;
    }
    let LightSource::Point(lamp) = scene.lights[0].source else { panic!("another light") };
    let to_light = lamp - surface.point;
    let half = (to_light.normalize() - direction.normalize()).normalize();
    let is_lit = normal.dot(to_light) > 0.0
        && above(to_light).is_none_or(|(_, distance)| distance > to_light.length());
    is_lit && libm::pow(normal.dot(half), material.shininess.into()) > 0.5
}

/// Returns a scene of mirrors, some tiny balls and a lamp.
fn mirrored() -> impl Strategy<Value = PreparedScene> {
    let shapes = (
        prop::collection::vec(mirror(), 1..4),
        prop::option::of(point(1.0)),
        prop::collection::vec((point(5.0), 0.01..0.06), 4..10),
        point(8.0),
    );
    shapes.prop_map(|(mut mirrors, floor, balls, lamp)| {
        let floor = floor.and_then(|normal| Plane::new(DVec3::new(0.0, -3.0, 0.0), normal));
        mirrors.extend(floor.map(PreparedShape::Plane));
        let ball = |(center, radius)| PreparedShape::Sphere(Sphere { center, radius });
        let mut geometry = Geometry::default();
        let mirror = SurfaceMaterial {
            reflected: 0.5,
            specular: 0.5,
            shininess: 20_000.0,
            ..SurfaceMaterial::default()
        };
        let mut materials = vec![mirror; mirrors.len()];
        materials.resize(mirrors.len() + balls.len(), SurfaceMaterial::default());
        mirrors.into_iter().chain(balls.into_iter().map(ball)).for_each(|shape| _ = geometry.push(shape));
        let mut scene = PreparedScene::new(geometry, materials);
        scene.lights.push(light(LightSource::Point(lamp), 1.0));
        scene
    })
}

fn light(source: LightSource, intensity: f32) -> PreparedLight {
    let intensity = Rgb::splat(intensity);
    PreparedLight { source, intensity, falloff: None, samples: 1, casts_shadows: true, own_shape: None }
}

/// Checks that pixels with tiny images or highlights have a feature, but for the few in which an edge hides most of one.
#[test]
fn tiny_images_in_mirrors_and_highlights_have_a_feature() {
    let (mut runner, mut search) = (TestRunner::deterministic(), Scratch::default());
    let (mut shown, mut missed, mut hidden) = (0, Vec::new(), 0);
    for case in 0..1500 {
        let (scene, eye) = (mirrored(), point(8.0)).new_tree(&mut runner).unwrap().current();
        let wide = if case % 2 == 0 { 1.0 } else { 3.0 };
        let size = (SIDE_PIXELS, SIDE_PIXELS);
        let camera = PreparedCamera::new(eye, -eye, DVec3::Y, 1.0, (wide, wide), size);
        let sampling = PixelSampling { samples: 64, seed: 1 };
        let context = RenderContext::new(&scene, &camera, sampling, Effects::ALL);
        let found = images(&context, false);
        if !found.hidden.is_empty() {
            hidden += 1;
            continue;
        }
        for (column, row) in
            (0..SIDE_PIXELS).flat_map(|row| (0..SIDE_PIXELS).map(move |column| (column, row)))
        {
            let mut rays = (0..64).map(|sample| camera.sample_ray(sampling, column, row, sample).unwrap());
            if rays.any(|ray| shows_detail(&context, &ray, &mut search)) {
                shown += 1;
                if !found.placed.iter().any(|(pixel, _)| *pixel == (column, row)) {
                    missed.push((case, column, row));
                }
            }
        }
    }
    assert!(shown > 200 && hidden < 500, "the test shows too little: {shown}, {hidden}");
    assert!(200 * missed.len() <= shown, "{} of {shown}: {missed:?}", missed.len());
}

/// Checks the pixel, size and radiance of an image and a highlight, and which images are hidden.
#[test]
fn images_and_highlights_are_where_the_law_of_reflection_puts_them() {
    let sphere = |center: [f64; 3], radius| {
        PreparedShape::Sphere(Sphere { center: DVec3::from_array(center), radius })
    };
    let camera =
        PreparedCamera::new(DVec3::new(0.0, 0.0, -10.0), DVec3::Z, DVec3::Y, 10.0, (4.0, 4.0), (41, 41));
    let mirror =
        SurfaceMaterial { reflected: 0.5, specular: 0.5, shininess: 1e6, ..SurfaceMaterial::default() };
    let glowing = SurfaceMaterial { emission: Rgb::splat(3.0), ..SurfaceMaterial::default() };
    let found = |ball: PreparedShape, lamp: DVec3| {
        let mut geometry = Geometry::default();
        [sphere([0.0; 3], 1.0), ball].into_iter().for_each(|shape| _ = geometry.push(shape));
        let mut scene = PreparedScene::new(geometry, vec![mirror.clone(), glowing.clone()]);
        scene.lights.push(light(LightSource::Directional(lamp), 2.0));
        let sampling = PixelSampling { samples: 1, seed: 1 };
        images(&RenderContext::new(&scene, &camera, sampling, Effects::ALL), false)
    };
    let (away, at_right_angles) = (DVec3::Z, DVec3::Y);
    // The eye and the ball are equally far, 60 degrees apart: the mirror's point is 30 degrees from both, at height 1/2. Its distance and
    // 10 pixels per unit at 10 units put it 5.47 pixels above the middle.
    let beyond = sphere([0.0, 10.0 * 0.75_f64.sqrt(), -5.0], 0.01);
    let seen = found(beyond, away);
    let pixels: Vec<(u32, u32)> = seen.placed.iter().map(|(pixel, _)| *pixel).collect();
    assert_eq!((pixels.as_slice(), seen.hidden.len()), ([(20, 15)].as_slice(), 0));
    let Feature { area, radiance } = seen.placed[0].1;
    // A mirror of radius 1 at this distance shows the ball smaller by about 20.
    let expected = std::f32::consts::PI * (0.1_f32 / 20.0).powi(2);
    assert!(
        area > 0.8 * expected && area < 1.3 * expected && radiance == 1.5,
        "{area} {expected} {radiance}"
    );
    // Light from above is reflected where the normal is 43 degrees high, at height 0.68: 7.36 pixels above the middle.
    let lit = found(sphere([0.0, 0.0, 50.0], 0.01), at_right_angles);
    let pixels: Vec<((u32, u32), f32)> =
        lit.placed.iter().map(|(pixel, feature)| (*pixel, (feature.radiance * 1000.0).round())).collect();
    assert_eq!(pixels, [((20, 13), 1000.0)]);
    // A ball that is half in the mirror is hidden; one behind it is not shown at all.
    assert_eq!(found(sphere([0.0, 0.999, 0.0], 0.01), away).hidden.len(), 1);
    assert_eq!(found(sphere([0.0, 0.0, 5.0], 0.01), away).hidden.len(), 0);
}

/// Creates a scene of one shape of one of three kinds.
fn scene_of_one(kind: u8, map: DAffine3, half: DVec3) -> PreparedScene {
    let middle = map.translation;
    scene_of(&[match kind {
        0 => PreparedShape::Sphere(Sphere { center: middle, radius: half.x }),
        1 => PreparedShape::AlignedBox(AlignedBox { min: middle - half, max: middle + half }),
        _ => PreparedShape::BoxImage(BoxImage::new(map, half).unwrap()),
    }])
}

/// Returns which pixels have a feature or a cover in one of a tile's scenes.
fn noticed<S: Iterator<Item = PreparedScene>>(
    scenes: impl Fn(usize) -> S,
    camera: &PreparedCamera,
) -> Vec<bool> {
    let mut noticed = vec![false; (SIDE_PIXELS * SIDE_PIXELS) as usize];
    let mut scratch = FeatureScratch::default();
    for (index, tile) in Tile::all(camera.resolution()).enumerate() {
        for scene in scenes(index) {
            let search = FeatureSearch::new(&scene, camera, true);
            let found = search.reference_features((&tile, &KnownFeatures::NONE), &mut scratch).unwrap();
            for (column, row) in (0..tile.height).flat_map(|row| (0..tile.width).map(move |i| (i, row))) {
                let (packet, lane) = Tile::lane_of(column as usize, row as usize);
                let (features, cover) = found.of(packet);
                let is_noticed = features[lane] != Feature::NONE || cover.ids[lane] != UNCOVERED;
                noticed[((tile.j + row) * SIDE_PIXELS + tile.i + column) as usize] |= is_noticed;
            }
        }
    }
    noticed
}

/// Checks that shapes skip hardly any pixel between the steps that were found to be necessary, and many without them. The corner of a pixel can
/// be crossed faster than in any step.
#[test]
fn fast_shapes_skip_hardly_any_pixel_between_steps() {
    const INSTANTS: u32 = 16;
    const MOMENTS: u32 = 64;
    const THIRD: f64 = 1.0 / 3.0;
    let (position, pixels) = (DVec3::new(0.0, 0.0, -10.0), (SIDE_PIXELS, SIDE_PIXELS));
    let camera = PreparedCamera::new(position, DVec3::Z, DVec3::Y, 10.0, (4.0, 4.0), pixels);
    let mut runner = TestRunner::deterministic();
    let (mut search, mut shown, mut skipped) = (Scratch::default(), 0, [0; 2]);
    for _ in 0..100 {
        // Up to five times the width of the film.
        let movers = (placed(), 0_u8..3, point(20.0));
        let ((map, half), kind, displacement) = movers.new_tree(&mut runner).unwrap().current();
        let scene = |moment: f64| {
            let offset = displacement * DVec3::new(1.0, 1.0, 0.05) * (moment - 0.5);
            scene_of_one(kind, DAffine3::from_translation(offset) * map, 0.5 * half)
        };
        let instants = |count: u32| {
            (0..count).map(move |instant| scene((f64::from(instant) + THIRD) / f64::from(count)))
        };
        let mut motion = MotionTracker::new(pixels);
        instants(INSTANTS).for_each(|scene| motion.add(&scene, &camera));
        let with_steps = noticed(|tile| instants(INSTANTS * motion.steps()[tile]), &camera);
        let noticed = [with_steps, noticed(|_| instants(INSTANTS), &camera)];
        let sampling = PixelSampling { samples: MOMENTS, seed: 1 };
        for sample in 0..MOMENTS {
            let scene = scene((f64::from(sample) + 0.5) / f64::from(MOMENTS));
            for pixel in 0..SIDE_PIXELS * SIDE_PIXELS {
                let ray = camera.sample_ray(sampling, pixel % SIDE_PIXELS, pixel / SIDE_PIXELS, sample);
                if scene.closest(&ray.unwrap(), &mut search).is_some() {
                    shown += 1;
                    for (count, noticed) in skipped.iter_mut().zip(&noticed) {
                        *count += i32::from(!noticed[pixel as usize]);
                    }
                }
            }
        }
    }
    assert!(shown > 5000 && 1000 * skipped[0] < shown && 20 * skipped[1] > shown, "{skipped:?} of {shown}");
}

/// Checks that a ball that flies across the film divides the intervals in its path, up to the borders of the film, and nowhere else.
#[test]
fn intervals_are_divided_only_where_shapes_are_fast() {
    let position = DVec3::new(0.0, 0.0, -100.0);
    let camera = PreparedCamera::new(position, DVec3::Z, DVec3::Y, 100.0, (80.0, 80.0), (80, 80));
    let mut motion = MotionTracker::new((80, 80));
    // From just inside of the left border to just inside of the right one. The front of the ball moves by 18.4 pixels from instant to instant.
    for x in [-36.0, -18.0, 0.0, 18.0, 36.0] {
        let ball = Sphere { center: DVec3::new(x, 0.0, 0.0), radius: 2.0 };
        motion.add(&scene_of(&[PreparedShape::Sphere(ball)]), &camera);
    }
    let rows: Vec<&[u32]> = motion.steps().chunks(5).collect();
    assert_eq!(rows, [[1; 5], [1; 5], [10; 5], [1; 5], [1; 5]]);
}
