//! Tests of shapes that only rays of some classes see, on scenes in which faces and whole shapes often coincide.

use glam::{DAffine3, DMat3, DVec3};

use rayreel::trace::shapes::{AlignedBox, BoxImage, Plane, Sphere, SphereImage};
use rayreel::trace::{
    Geometry, LightSource, PixelSampling, PreparedScene, PreparedShape, RayVisibility, Refraction, ShapeId,
    SimdLevel, SurfaceMaterial, render_reference,
};
use rayreel::{Film, Rgb};

use crate::coincident::{self, camera, film};
use crate::splitmix::Random;

type Surface = (PreparedShape, SurfaceMaterial, RayVisibility);

const CAMERA: RayVisibility = RayVisibility { camera: true, secondary: false, shadow: false };
const SECONDARY: RayVisibility = RayVisibility { camera: false, secondary: true, shadow: false };
const SHADOW: RayVisibility = RayVisibility { camera: false, secondary: false, shadow: true };
const NONE: RayVisibility = RayVisibility { camera: false, secondary: false, shadow: false };

/// Returns a shape at one of a few positions: all boxes and planes are along the world's axes, or all are turned alike.
fn shape(random: &mut Random, turn: DMat3) -> PreparedShape {
    let mut place = || [-1.0, 0.0, 0.5][random.index(3)];
    let (place, size) = (DVec3::new(place(), place(), place()), [1.0, 1.5][random.index(2)]);
    let map = |matrix3: DMat3, translation: DVec3| DAffine3 { matrix3, translation };
    match random.index(7) {
        0 => {
            let normal = DVec3::AXES[random.index(3)];
            PreparedShape::Plane(Plane::new(turn * place, turn * normal).unwrap())
        }
        1 | 2 => PreparedShape::Sphere(Sphere { center: turn * place, radius: size }),
        3 => {
            let stretched = turn * DMat3::from_diagonal(DVec3::new(size, 0.5, 1.0));
            PreparedShape::SphereImage(SphereImage::new(map(stretched, turn * place), 1.0))
        }
        _ if turn == DMat3::IDENTITY => {
            PreparedShape::AlignedBox(AlignedBox { min: place, max: place + size })
        }
        _ => {
            let middle = turn * (place + 0.5 * size);
            PreparedShape::BoxImage(BoxImage::new(map(turn, middle), DVec3::splat(0.5 * size)).unwrap())
        }
    }
}

fn material(random: &mut Random) -> SurfaceMaterial {
    let mut share = || 0.1 + 0.8 * f32::from(u8::try_from(random.index(256)).unwrap()) / 255.0;
    let color = Rgb::new(share(), share(), share());
    let refraction = Refraction {
        transmitted: share(),
        ior: 1.0 + f64::from(share()),
        absorption: if share() > 0.5 { color } else { Rgb::ZERO },
        fresnel: share() > 0.5,
    };
    SurfaceMaterial {
        ambient: color * 0.2,
        diffuse: color * 0.7,
        reflected: if share() > 0.5 { share() } else { 0.0 },
        refraction: (share() > 0.5).then_some(refraction),
        ..SurfaceMaterial::default()
    }
}

fn surfaces(random: &mut Random, most: usize) -> Vec<Surface> {
    let turned = DMat3::from_rotation_y(0.7) * DMat3::from_rotation_x(0.3);
    let turn = if random.once_in(2) { turned } else { DMat3::IDENTITY };
    let count = 2 + random.index(most);
    (0..count).map(|_| (shape(random, turn), material(random), RayVisibility::ALL)).collect()
}

fn scene(surfaces: &[Surface]) -> PreparedScene {
    let mut geometry = Geometry::default();
    for (shape, _, visibility) in surfaces {
        let id = geometry.push(*shape);
        geometry.set_visibility(id, *visibility);
    }
    let materials: Vec<SurfaceMaterial> = surfaces.iter().map(|(_, material, _)| material.clone()).collect();
    let mut scene = PreparedScene::new(geometry, materials);
    coincident::light(&mut scene, None);
    scene.lights.push(coincident::lamp(LightSource::Point(DVec3::new(0.2, 0.3, 0.1)), None));
    scene
}

#[track_caller]
fn assert_same(found: &Film, expected: &Film, what: &str) {
    let different =
        (0..).zip(found.pixels().iter().zip(expected.pixels())).find(|(_, pair)| pair.0 != pair.1);
    assert!(different.is_none(), "{different:?} {what}");
}

fn flags(random: &mut Random) -> RayVisibility {
    if random.once_in(3) {
        return RayVisibility::ALL;
    }
    let mut flag = || random.once_in(2);
    RayVisibility { camera: flag(), secondary: flag(), shadow: flag() }
}

#[test]
fn the_fast_path_sees_what_the_reference_path_sees() {
    let mut random = Random(11);
    let mut differing = 0;
    for number in 0..600 {
        let mut all = surfaces(&mut random, 9);
        let camera = camera(&mut random);
        let whole = film(&scene(&all), &camera);
        all.iter_mut().for_each(|(.., visibility)| *visibility = flags(&mut random));
        let mut scene = scene(&all);
        let expected = render_reference(&scene, &camera, PixelSampling::default());
        for (name, level) in SimdLevel::all() {
            scene.set_simd(level);
            assert_same(&film(&scene, &camera), &expected, &format!("scene {number}, {name}"));
        }
        differing += u32::from(whole.pixels() != expected.pixels());
    }
    assert!(differing > 400, "the flags change {differing} of 600 pictures");
}

#[test]
fn a_shape_that_no_ray_sees_does_not_exist() {
    let mut random = Random(12);
    for _ in 0..300 {
        let mut all = surfaces(&mut random, 9);
        let camera = camera(&mut random);
        all.iter_mut().for_each(|(.., visibility)| *visibility = flags(&mut random));
        let expected = film(&scene(&all), &camera);
        let ghosts = surfaces(&mut random, 9);
        for (shape, material, _) in ghosts {
            // Often equal to a shape that is there.
            let shape = if random.once_in(2) { all[random.index(all.len())].0 } else { shape };
            all.insert(random.index(all.len() + 1), (shape, material, NONE));
        }
        assert_same(&film(&scene(&all), &camera), &expected, "");
    }
}

/// Replaces each shape by equal shapes that each are seen by other classes of rays. All rays still see the same surfaces, so that a surface
/// found by rays of one class must be left, and its solids entered, by rays of the others in the same way.
fn split(surfaces: &[Surface], parts: &[RayVisibility]) -> Vec<Surface> {
    surfaces
        .iter()
        .flat_map(|(shape, material, _)| parts.iter().map(|part| (*shape, material.clone(), *part)))
        .collect()
}

#[test]
fn a_shape_may_consist_of_a_part_for_each_class_of_rays() {
    let mut random = Random(13);
    for number in 0..600 {
        let mut all = surfaces(&mut random, 7);
        let camera = camera(&mut random);
        let others = RayVisibility { camera: false, ..RayVisibility::ALL };
        let shadowless = RayVisibility { shadow: false, ..RayVisibility::ALL };
        let [direct, indirect] = [[CAMERA, others], [others, CAMERA]][number % 2];
        let expected = film(&scene(&all), &camera);
        let parted = film(&scene(&split(&all, &[direct, indirect])), &camera);
        assert_same(&parted, &expected, &format!("scene {number}: {all:?}"));
        // The order of solids that only partly overlap is lost to shadow rays, if they see others than the rays before them.
        all.iter_mut().for_each(|(_, material, _)| material.refraction = None);
        let expected = film(&scene(&all), &camera);
        for parts in [&[CAMERA, SECONDARY, SHADOW][..], &[SHADOW, SECONDARY, CAMERA], &[SHADOW, shadowless]] {
            let parted = film(&scene(&split(&all, parts)), &camera);
            assert_same(&parted, &expected, &format!("scene {number}: {all:?}, {parts:?}"));
        }
    }
}

#[test]
fn trees_are_updated_for_all_classes() {
    let mut random = Random(14);
    for _ in 0..100 {
        let mut all = surfaces(&mut random, 9);
        all.iter_mut().for_each(|(.., visibility)| *visibility = flags(&mut random));
        let camera = camera(&mut random);
        let mut kept = scene(&all);
        for _ in 0..4 {
            let index = random.index(all.len());
            let other = material(&mut random);
            all[index].1 = other.clone();
            kept.replace_materials([(id(index), other)]);
            let mut order: Vec<usize> = (0..all.len()).collect();
            order.swap(0, random.index(all.len()));
            let ids: Vec<ShapeId> = order.into_iter().map(id).collect();
            kept.renumber(&ids);
            let mut made = scene(&all);
            made.renumber(&ids);
            assert_same(&film(&kept, &camera), &film(&made, &camera), "");
        }
    }
}

fn id(index: usize) -> ShapeId {
    ShapeId(u32::try_from(index).unwrap())
}
