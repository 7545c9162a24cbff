//! Light, camera and pictures of small scenes in which faces and whole shapes often coincide.

use std::sync::atomic::AtomicBool;

use glam::DVec3;

use rayreel::trace::{
    Effects, LightSource, PixelSampling, PreparedBackground, PreparedCamera, PreparedLight, PreparedScene,
    RenderJob, ShapeId, Signals,
};
use rayreel::{Film, Rgb};

use crate::splitmix::Random;

/// Sets a background, ambient light, and a point and a directional light. One shape may be the own shape of both.
pub(crate) fn light(scene: &mut PreparedScene, own_shape: Option<ShapeId>) {
    scene.depth = 6;
    scene.ambient = Rgb::ONE;
    scene.background = PreparedBackground::Flat(Rgb::new(0.3, 0.4, 0.5));
    let sources =
        [LightSource::Point(DVec3::new(3.0, 5.0, -4.0)), LightSource::Directional(DVec3::new(0.0, 1.0, 0.0))];
    scene.lights = sources.map(|source| lamp(source, own_shape)).into();
}

pub(crate) fn lamp(source: LightSource, own_shape: Option<ShapeId>) -> PreparedLight {
    PreparedLight { source, intensity: Rgb::ONE, falloff: None, samples: 1, casts_shadows: true, own_shape }
}

/// Returns a camera outside of the shapes, or among them.
pub(crate) fn camera(random: &mut Random) -> PreparedCamera {
    let eye = [DVec3::new(2.5, 3.0, -4.0), DVec3::new(0.25, 0.25, 0.25)][random.index(2)];
    PreparedCamera::new(eye, DVec3::new(0.2, 0.1, 0.0) - eye, DVec3::Y, 1.0, (1.0, 1.0), (12, 12))
}

pub(crate) fn film(scene: &PreparedScene, camera: &PreparedCamera) -> Film {
    let never = AtomicBool::new(false);
    let mut job = RenderJob::new(camera.resolution(), 1);
    assert!(job.add(scene, camera, PixelSampling::default(), 0, Effects::ALL, Signals::unless(&never)));
    job.resolve().0
}
