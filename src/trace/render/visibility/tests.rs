//! Comparison of features with the surfaces that many samples of every pixel hit.

use glam::{DAffine3, DQuat};
use proptest::prelude::*;

use super::*;
use crate::trace::math::PixelSampling;
use crate::trace::rays::PreparedRay;
use crate::trace::scene::ShapeRef;
use crate::trace::shapes::{AlignedBox, BoxImage, Plane, Rod, RodImage, Sphere, SphereImage};
use crate::trace::{Geometry, PreparedShape, SurfaceMaterial};

const SIDE_PIXELS: u32 = 20;

/// The shape that a ray hits, and for boxes the axis and side of the face.
type Surface = Option<(ShapeId, [i8; 3])>;

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
    Some((point.hit.id, face))
}

/// Returns the pixels without a feature whose samples hit more than one surface, and the total number of pixels without a feature.
fn missed(scene: &PreparedScene, camera: &PreparedCamera, samples: u32) -> (Vec<(u32, u32)>, usize) {
    let (columns, rows) = camera.resolution();
    let (mut missed, mut plain) = (Vec::new(), 0);
    let mut search = Scratch::default();
    for j in (0..rows).step_by(TILE as usize) {
        for i in (0..columns).step_by(TILE as usize) {
            let tile = Tile { i, j, width: TILE.min(columns - i), height: TILE.min(rows - j) };
            let found =
                features(scene, camera, (&tile, false), (&mut FeatureScratch::default(), &mut search));
            let expected = reference_features(scene, camera, &tile, false);
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
    let mut geometry = Geometry::default();
    shapes.iter().for_each(|shape| _ = geometry.push(*shape));
    PreparedScene::new(geometry, vec![SurfaceMaterial::default(); shapes.len()])
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
    let found = reference_features(&scene_of(&[sphere(0.01, 0.003)]), &camera, &tile, false);
    let small: Vec<f32> =
        found.features.iter().map(|feature| feature.area).filter(|area| *area > 0.0).collect();
    assert!(
        !small.is_empty() && small.len() <= 4 && small.iter().all(|area| (0.005..0.02).contains(area)),
        "{small:?}"
    );
}
