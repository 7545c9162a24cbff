//! Tests of the input that a fingerprint depends on.

use glam::DVec3;

use super::*;
use crate::color::{ColorRamp, Rgb};
use crate::trace::scene::{
    FogLayer, Geometry, LightSource, Precision, PreparedAmbientOcclusion, PreparedBackground, PreparedLight,
    PreparedShape, PreparedStars, PreparedSun, SurfaceMaterial,
};
use crate::trace::shapes::Sphere;

fn sphere(x: f64, radius: f64) -> PreparedShape {
    PreparedShape::Sphere(Sphere { center: DVec3::new(x, 0.0, 0.0), radius })
}

fn scene(shapes: &[PreparedShape]) -> PreparedScene {
    let mut geometry = Geometry::default();
    let materials = vec![SurfaceMaterial::default(); shapes.len()];
    shapes.iter().for_each(|shape| {
        geometry.push(*shape);
    });
    PreparedScene::new(geometry, materials)
}

fn camera() -> PreparedCamera {
    PreparedCamera::new(DVec3::ZERO, DVec3::Z, DVec3::Y, 1.0, (1.6, 0.9), (16, 9))
}

const ONE: FrameConstants = FrameConstants {
    transfer: Transfer::Srgb,
    sampling: PixelSampling { samples: 1, seed: 7 },
    target: None,
    lighting: Lighting::TransparentShadows,
    instants: 1,
};

fn fingerprint(
    constants: &FrameConstants,
    scene: &PreparedScene,
    camera: &PreparedCamera,
) -> FrameFingerprint {
    let mut hasher = FrameHasher::new(constants);
    hasher.add(scene, camera, constants.sampling);
    hasher.finish()
}

#[test]
fn all_that_reaches_a_picture_changes_it() {
    let light = |own_shape| PreparedLight {
        source: LightSource::Point(DVec3::Y),
        intensity: Rgb::ONE,
        falloff: None,
        samples: 1,
        casts_shadows: true,
        own_shape,
    };
    let gradient = |horizon| PreparedBackground::Gradient { bottom: Rgb::ZERO, horizon, top: Rgb::ONE };
    let stops =
        |height| PreparedBackground::Stops(ColorRamp::new(&[(-1.0, Rgb::ZERO), (height, Rgb::ONE)]).unwrap());
    let (direction, intensity) = (DVec3::Y, Rgb::ONE);
    let sun = PreparedSun { direction, intensity, radius: 0.1, glow: 0.0, glow_size: 1.0 };
    let plain = scene(&[sphere(0.0, 1.0), sphere(3.0, 1.0)]);
    let changed = |change: &dyn Fn(&mut PreparedScene)| {
        let mut scene = plain.clone();
        // It must not be kept of what was before.
        scene.shapes_digest();
        change(&mut scene);
        fingerprint(&ONE, &scene, &camera())
    };
    let occlusion = PreparedAmbientOcclusion { samples: 8, distance: 1.0 };
    let red = SurfaceMaterial { diffuse: Rgb::X, ..SurfaceMaterial::default() };
    let ids: Vec<_> = plain.geometry().ids().collect();
    let mut all = vec![
        fingerprint(&ONE, &plain, &camera()),
        fingerprint(&FrameConstants { transfer: Transfer::Classic, ..ONE }, &plain, &camera()),
        fingerprint(&FrameConstants { instants: 2, ..ONE }, &plain, &camera()),
        fingerprint(&FrameConstants { lighting: Lighting::Shadows, ..ONE }, &plain, &camera()),
        fingerprint(&ONE, &plain, &camera().rolled(0.1)),
        fingerprint(&ONE, &plain, &camera().with_lens(0.1, 2.0)),
        fingerprint(&ONE, &scene(&[sphere(3.0, 1.0), sphere(0.0, 1.0)]), &camera()),
        fingerprint(&ONE, &scene(&[sphere(0.0, 1.0)]), &camera()),
        changed(&|scene| scene.renumber(&[ids[1], ids[0]])),
        changed(&|scene| {
            assert!(scene.replace_shape(ids[1], sphere(3.0, 1.0 + f64::EPSILON), &mut Vec::new()).is_some());
        }),
        changed(&|scene| {
            scene.replace_materials([(ids[0], red.clone())]);
        }),
        changed(&|scene| {
            scene.replace_materials([(ids[1], red.clone())]);
        }),
        changed(&|scene| {
            let emission = Rgb::X;
            scene.replace_materials([(ids[0], SurfaceMaterial { emission, ..SurfaceMaterial::default() })]);
        }),
        changed(&|scene| {
            let tint = Some(Rgb::X);
            scene.replace_materials([(ids[0], SurfaceMaterial { tint, ..SurfaceMaterial::default() })]);
        }),
        changed(&|scene| {
            let tint = Some(Rgb::Y);
            scene.replace_materials([(ids[0], SurfaceMaterial { tint, ..SurfaceMaterial::default() })]);
        }),
        changed(&|scene| scene.ambient = Rgb::splat(0.1)),
        changed(&|scene| scene.ambient_occlusion = Some(occlusion)),
        changed(&|scene| {
            scene.ambient_occlusion = Some(PreparedAmbientOcclusion { samples: 9, ..occlusion });
        }),
        changed(&|scene| {
            scene.ambient_occlusion = Some(PreparedAmbientOcclusion { distance: 2.0, ..occlusion });
        }),
        changed(&|scene| scene.fog.density = 0.1),
        changed(&|scene| scene.fog.hides_background = false),
        changed(&|scene| scene.sky.sun = Some(sun)),
        changed(&|scene| scene.sky.sun = Some(PreparedSun { glow: 0.5, ..sun })),
        changed(&|scene| scene.sky.sun = Some(PreparedSun { direction: DVec3::X, ..sun })),
        changed(&|scene| scene.sky.stars = Some(PreparedStars::new(Rgb::ONE, 0.1, 9, 0))),
        changed(&|scene| scene.sky.stars = Some(PreparedStars::new(Rgb::ONE, 0.1, 9, 1))),
        changed(&|scene| scene.sky.stars = Some(PreparedStars::new(Rgb::ONE, 0.1, 8, 0))),
        changed(&|scene| scene.fog.layer = Some(FogLayer { level: 0.0, height: 1.0 })),
        changed(&|scene| scene.fog.layer = Some(FogLayer { level: 1.0, height: 1.0 })),
        changed(&|scene| scene.fog.layer = Some(FogLayer { level: 0.0, height: 2.0 })),
        changed(&|scene| scene.background = gradient(None)),
        changed(&|scene| scene.background = gradient(Some(Rgb::ZERO))),
        changed(&|scene| scene.background = gradient(Some(Rgb::X))),
        changed(&|scene| scene.background = stops(0.5)),
        changed(&|scene| scene.background = stops(0.25)),
        changed(&|scene| scene.depth = 3),
        changed(&|scene| scene.cutoff = 0.1),
        changed(&|scene| scene.precision = Precision::NaiveF32),
        changed(&|scene| scene.lights = vec![light(None)]),
        changed(&|scene| scene.lights = vec![light(Some(ids[0]))]),
        changed(&|scene| scene.lights = vec![PreparedLight { casts_shadows: false, ..light(None) }]),
    ];
    // The same shapes in the same order: one by being written so, one by being put so.
    assert_eq!(all.remove(8), all[6]);
    let count = all.len();
    all.sort_by_key(ToString::to_string);
    all.dedup();
    assert_eq!(all.len(), count);
}

#[test]
fn seeds_count_where_something_is_sampled() {
    let scene = scene(&[sphere(0.0, 1.0)]);
    let of = |samples, seed| {
        fingerprint(&FrameConstants { sampling: PixelSampling { samples, seed }, ..ONE }, &scene, &camera())
    };
    assert_eq!(of(1, 1), of(1, 2));
    assert_ne!(of(4, 1), of(4, 2));
    assert_ne!(of(4, 1), of(5, 1));
}

#[test]
fn vectors_and_threads_do_not_count() {
    let shapes: Vec<_> = (0..10_000_u16).map(|index| sphere(f64::from(index), 0.4)).collect();
    let of = |threads| {
        let pool = rayon::ThreadPoolBuilder::new().num_threads(threads).build().unwrap();
        pool.install(|| fingerprint(&ONE, &scene(&shapes), &camera()))
    };
    assert_eq!(of(1), of(3));
    let mut plain = scene(&shapes);
    plain.simd = crate::trace::SimdLevel::all()[0].1;
    assert_eq!(fingerprint(&ONE, &plain, &camera()), of(1));
}
