//! Compares the stages with all effects at every SIMD level with the reference path.

use std::sync::atomic::AtomicBool;

use glam::{DAffine3, DMat3, DVec3};
use proptest::prelude::*;

use crate::color::Rgb;
use crate::trace::math::SimdLevel;
use crate::trace::scene::{Cone, FogLayer, PreparedFalloff, PreparedFog, PreparedStars, PreparedSun};
use crate::trace::shapes::{AlignedBox, BoxImage, Plane, Rod, RodImage, Sphere, SphereImage};
use crate::trace::{
    Effects, Film, Geometry, LightSource, PixelSampling, PreparedAmbientOcclusion, PreparedCamera,
    PreparedLight, PreparedScene, PreparedShape, Refraction, RenderJob, ShapeId, Signals, SurfaceMaterial,
    reference,
};

fn clay(color: Rgb) -> SurfaceMaterial {
    SurfaceMaterial { ambient: color * 0.2, diffuse: color, ..SurfaceMaterial::default() }
}

fn glass(ior: f64, absorption: Rgb, fresnel: bool) -> SurfaceMaterial {
    let refraction = Some(Refraction { transmitted: 0.9, ior, absorption, fresnel });
    SurfaceMaterial { refraction, specular: 0.3, shininess: 40.0, reflected: 0.05, ..clay(Rgb::splat(0.1)) }
}

/// Returns shapes of all kinds with mirrors and highlights, and glass that contains a ball and a bubble.
fn shapes() -> Vec<(PreparedShape, SurfaceMaterial)> {
    let sphere = |x: f64, y: f64, z: f64, radius: f64| {
        PreparedShape::Sphere(Sphere { center: DVec3::new(x, y, z), radius })
    };
    let map = |x: f64| DAffine3 {
        matrix3: DMat3::from_rotation_y(0.7)
            * DMat3::from_rotation_x(0.4)
            * DMat3::from_diagonal(DVec3::new(0.5, 0.9, 0.4)),
        translation: DVec3::new(x, 0.8, 1.5),
    };
    let shiny =
        SurfaceMaterial { specular: 0.5, shininess: 25.0, reflected: 0.4, ..clay(Rgb::new(0.3, 0.5, 0.7)) };
    vec![
        (PreparedShape::Plane(Plane::new(DVec3::ZERO, DVec3::Y).unwrap()), clay(Rgb::new(0.7, 0.6, 0.5))),
        (sphere(0.0, 1.0, -0.5, 1.0), glass(1.5, Rgb::new(0.1, 0.4, 0.8), true)),
        (sphere(0.2, 1.1, -0.6, 0.4), clay(Rgb::new(0.9, 0.2, 0.2))),
        (sphere(-0.4, 0.9, -0.5, 0.3), glass(1.0, Rgb::ZERO, false)),
        (PreparedShape::SphereImage(SphereImage::new(map(1.8), 1.0)), shiny.clone()),
        (
            PreparedShape::BoxImage(BoxImage::new(map(-1.9), DVec3::ONE).unwrap()),
            glass(1.3, Rgb::new(0.6, 0.1, 0.3), true),
        ),
        (
            PreparedShape::AlignedBox(AlignedBox {
                min: DVec3::new(0.9, 0.0, -2.2),
                max: DVec3::new(1.6, 0.6, -1.6),
            }),
            shiny,
        ),
        (sphere(-2.5, 3.5, -2.0, 0.2), clay(Rgb::ONE)),
        (
            PreparedShape::Rod(
                Rod::cylinder(DVec3::new(-1.2, 0.0, -1.6), DVec3::new(-0.8, 1.1, -1.4), 0.3).unwrap(),
            ),
            glass(1.4, Rgb::new(0.5, 0.3, 0.1), true),
        ),
        (
            PreparedShape::Rod(
                Rod::capsule(DVec3::new(-0.4, 2.2, 0.5), DVec3::new(1.4, 2.4, 0.2), 0.15).unwrap(),
            ),
            clay(Rgb::new(0.4, 0.7, 0.4)),
        ),
        (
            PreparedShape::RodImage(RodImage::capsule(map(0.3), DVec3::new(0.3, 1.0, 0.2), 0.5).unwrap()),
            glass(1.2, Rgb::new(0.2, 0.3, 0.1), false),
        ),
    ]
}

fn lights(bulb: ShapeId) -> Vec<PreparedLight> {
    let light = |source: LightSource, intensity: f32| PreparedLight {
        source,
        intensity: Rgb::new(intensity, 0.9 * intensity, 0.8 * intensity),
        falloff: None,
        samples: 1,
        casts_shadows: true,
        own_shape: None,
    };
    let down = DVec3::new(-0.5, -1.0, 0.4).normalize();
    let (above, halves) = (DVec3::new(1.0, 5.0, -1.0), [DVec3::X * 0.5, DVec3::Z * 0.7]);
    vec![
        PreparedLight {
            samples: 3,
            own_shape: Some(bulb),
            ..light(LightSource::Sphere { center: DVec3::new(-2.5, 3.5, -2.0), radius: 0.2 }, 0.5)
        },
        light(LightSource::Rectangle { center: above, halves }, 0.3),
        PreparedLight {
            falloff: Some(PreparedFalloff { constant: 0.5, linear: 0.1, quadratic: 0.02 }),
            ..light(
                LightSource::Spot(DVec3::new(2.5, 4.0, -2.0), Cone { axis: down, inner: 0.9, outer: 0.6 }),
                0.8,
            )
        },
        light(LightSource::Directional(DVec3::new(0.3, 1.0, -0.5)), 0.2),
    ]
}

#[test]
fn all_effects_have_the_reference_s_bits_at_every_level() {
    let (kinds, materials): (Vec<_>, Vec<_>) = shapes().into_iter().unzip();
    let mut geometry = Geometry::default();
    let ids: Vec<ShapeId> = kinds.into_iter().map(|kind| geometry.push(kind)).collect();
    let mut scene = PreparedScene::new(geometry, materials);
    scene.lights = lights(ids[7]);
    (scene.ambient, scene.depth) = (Rgb::splat(0.8), 6);
    scene.ambient_occlusion = Some(PreparedAmbientOcclusion { samples: 2, distance: 3.0 });
    let fog = PreparedFog { color: Rgb::new(0.5, 0.6, 0.7), density: 0.03, ..PreparedFog::default() };
    let resolution = (27, 18);
    let (eye, view) = (DVec3::new(0.3, 1.6, -6.0), DVec3::new(0.0, -0.1, 1.0));
    let camera = PreparedCamera::new(eye, view, DVec3::Y, 1.0, (0.9, 0.6), resolution);
    let parallel = PreparedCamera::new(eye, view, DVec3::Y, 1.0, (9.0, 6.0), resolution).orthographic();
    let layer = Some(FogLayer { level: 1.0, height: 2.0 });
    let layered = PreparedFog { layer, ..fog };
    for (camera, samples, fog) in [
        (camera, 1, fog),
        (camera.with_lens(0.2, 6.0), 3, fog),
        (parallel, 1, fog),
        (parallel, 3, layered),
        (parallel.with_lens(0.2, 6.0), 3, fog),
        (camera, 1, layered),
        (camera, 2, PreparedFog { hides_background: false, ..layered }),
    ] {
        scene.fog = fog;
        if !fog.hides_background {
            let (direction, intensity) = (DVec3::new(0.0, 0.6, 0.8), Rgb::new(9.0, 8.0, 7.0));
            scene.sky.sun =
                Some(PreparedSun { direction, intensity, radius: 0.1, glow: 0.2, glow_size: 0.5 });
            scene.sky.stars = Some(PreparedStars::new(Rgb::ONE, 0.05, 400, 1));
        }
        let sampling = PixelSampling { samples, seed: 9 };
        let expected = reference::render(&scene, &camera, sampling);
        for (name, level) in SimdLevel::all() {
            scene.set_simd(level);
            assert!(film(&scene, &camera, sampling) == expected, "{name}, {samples} samples");
        }
    }
}

/// Renders with all effects.
fn film(scene: &PreparedScene, camera: &PreparedCamera, sampling: PixelSampling) -> Film {
    let mut job = RenderJob::new(camera.resolution(), sampling.samples);
    let never = AtomicBool::new(false);
    assert!(job.add(scene, camera, sampling, 0, Effects::ALL, Signals::unless(&never)));
    job.resolve().0
}

/// The properties of transparent materials: absorption, refraction, and whether rays branch in two.
#[derive(Clone, Copy, Debug)]
struct Glass {
    absorbs: bool,
    bends: bool,
    branches: bool,
}

/// Returns a scene with shapes of all kinds above a floor and in front of a wall. Most are transparent. They may be separate, nested, or
/// around the lights.
fn glass_scene(places: &[(u8, [f64; 3], f64)], glass: Glass) -> PreparedScene {
    let floor = PreparedShape::Plane(Plane::new(DVec3::ZERO, DVec3::Y).unwrap());
    let wall = PreparedShape::Plane(Plane::new(DVec3::Z * 4.0, DVec3::NEG_Z).unwrap());
    let mut geometry = Geometry::default();
    let mut materials = vec![clay(Rgb::new(0.7, 0.6, 0.5)); 2];
    let _ = (geometry.push(floor), geometry.push(wall));
    for (index, (kind, place, size)) in places.iter().enumerate() {
        let (center, half) = (DVec3::from_array(*place), DVec3::new(*size, 0.7 * size, *size));
        let map = DAffine3 {
            matrix3: DMat3::from_rotation_y(0.7) * DMat3::from_diagonal(half),
            translation: center,
        };
        let _ = geometry.push(match kind % 7 {
            0 => PreparedShape::Sphere(Sphere { center, radius: *size }),
            1 => PreparedShape::AlignedBox(AlignedBox { min: center - half, max: center + half }),
            2 => PreparedShape::SphereImage(SphereImage::new(map, 1.0)),
            3 => PreparedShape::BoxImage(BoxImage::new(map, DVec3::ONE).unwrap()),
            4 => PreparedShape::Rod(Rod::cylinder(center - half, center + half, *size).unwrap()),
            5 => PreparedShape::Rod(Rod::capsule(center, center + half, *size).unwrap()),
            _ => PreparedShape::RodImage(RodImage::cylinder(map, DVec3::ONE, 0.7).unwrap()),
        });
        let absorption = if glass.absorbs && kind % 3 != 0 { Rgb::new(0.2, 0.0, 0.9) } else { Rgb::ZERO };
        let ior = if glass.bends { 1.4 } else { 1.0 };
        let refraction = Refraction { transmitted: 0.7, ior, absorption, fresnel: glass.branches };
        let reflected = if glass.branches { 0.1 } else { 0.0 };
        materials.push(SurfaceMaterial {
            refraction: (index % 5 != 4).then_some(refraction),
            reflected,
            specular: 0.2,
            shininess: 30.0,
            ..clay(Rgb::new(0.3, 0.2, 0.4))
        });
    }
    let mut scene = PreparedScene::new(geometry, materials);
    scene.lights = lights(ShapeId(2));
    (scene.ambient, scene.depth) = (Rgb::splat(0.8), 5);
    scene
}

proptest! {
    #![proptest_config(ProptestConfig::with_cases(60))]

    #[test]
    fn transparent_scenes_equal_the_reference_at_every_simd_level(
        places in prop::collection::vec(
            (0..12_u8, [-2.0..2.0, 0.2..3.0, -2.0..2.0], prop_oneof![0.1..0.4, 0.4..1.2]),
            1..12,
        ),
        (absorbs, bends, branches) in any::<(bool, bool, bool)>(),
        cutoff in prop_oneof![Just(0.0_f32), Just(4e-3), Just(0.1)],
        samples in 1..3_u32,
        occlusion in prop::option::of(prop_oneof![Just(1.0), 0.1..8.0, Just(1e6)]),
    ) {
        let mut scene = glass_scene(&places, Glass { absorbs, bends, branches });
        scene.ambient_occlusion = occlusion.map(|distance| PreparedAmbientOcclusion { samples, distance });
        scene.cutoff = cutoff;
        let resolution = (19, 17);
        let eye = DVec3::new(0.3, 1.6, -6.0);
        let camera = PreparedCamera::new(eye, DVec3::new(0.0, -0.1, 1.0), DVec3::Y, 1.0, (0.9, 0.8), resolution);
        let sampling = PixelSampling { samples, seed: 3 };
        let expected = reference::render(&scene, &camera, sampling);
        for (name, level) in SimdLevel::all() {
            scene.set_simd(level);
            prop_assert!(film(&scene, &camera, sampling) == expected, "{}", name);
        }
    }
}
