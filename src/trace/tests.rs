//! The stages with all effects at once, at every level, held against the reference path.

use std::sync::atomic::AtomicBool;

use glam::{DAffine3, DMat3, DVec3};

use crate::color::Rgb;
use crate::trace::math::SimdLevel;
use crate::trace::scene::{Cone, Falloff, Fog};
use crate::trace::shapes::{AlignedBox, BoxImage, Plane, Sphere, SphereImage};
use crate::trace::{
    Camera, Effects, Exposure, Geometry, Light, LightSource, PreparedScene, PreparedShape, Refraction,
    Sampling, ShapeId, Signals, SurfaceMaterial, reference,
};

fn clay(color: Rgb) -> SurfaceMaterial {
    SurfaceMaterial { ambient: color * 0.2, diffuse: color, ..SurfaceMaterial::default() }
}

fn glass(ior: f64, absorption: Rgb, fresnel: bool) -> SurfaceMaterial {
    let refraction = Some(Refraction { transmitted: 0.9, ior, absorption, fresnel });
    SurfaceMaterial { refraction, specular: 0.3, shininess: 40.0, reflected: 0.05, ..clay(Rgb::splat(0.1)) }
}

/// Glass with a ball and a bubble in it, shapes of all kinds, mirrors and highlights.
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
    ]
}

fn lights(bulb: ShapeId) -> Vec<Light> {
    let light = |source: LightSource, intensity: f32| Light {
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
        Light {
            samples: 3,
            own_shape: Some(bulb),
            ..light(LightSource::Sphere { center: DVec3::new(-2.5, 3.5, -2.0), radius: 0.2 }, 0.5)
        },
        light(LightSource::Rectangle { center: above, halves }, 0.3),
        Light {
            falloff: Some(Falloff { constant: 0.5, linear: 0.1, quadratic: 0.02 }),
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
    scene.fog = Fog { color: Rgb::new(0.5, 0.6, 0.7), density: 0.03 };
    let resolution = (27, 18);
    let (eye, view) = (DVec3::new(0.3, 1.6, -6.0), DVec3::new(0.0, -0.1, 1.0));
    let camera = Camera::new(eye, view, DVec3::Y, 1.0, (0.9, 0.6), resolution);
    for (camera, samples) in [(camera, 1), (camera.with_lens(0.2, 6.0), 3)] {
        let sampling = Sampling { samples, seed: 9 };
        let expected = reference::render(&scene, &camera, sampling);
        for (name, level) in SimdLevel::all() {
            scene.simd = level;
            let mut exposure = Exposure::new(resolution, samples);
            let never = AtomicBool::new(false);
            let signals = Signals::unless(&never);
            assert!(exposure.add(&scene, &camera, sampling, (0, samples), Effects::ALL, signals));
            assert!(exposure.develop().0 == expected, "{name}, {samples} samples");
        }
    }
}
