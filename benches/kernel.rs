//! Costs of the kernel's stages, of single rays, and of BVH construction.
//!
//! `cargo bench --bench kernel` measures on one thread. A row of `frame` traces one sample of every pixel of a shipped scene through the
//! stages up to the named one, and accumulates the result. The cost of a stage is the difference from the row above. Only `next_rays` has
//! wavefronts after the first, and it runs all stages for them. `-- frame` measures these rows alone, `-- first_light` one scene;
//! `-- --sample-count 5` is quicker.

use std::fmt;
use std::sync::atomic::AtomicBool;

use divan::Bencher;
use divan::counter::ItemsCount;
use glam::DVec3;

use rayreel::Rgb;
use rayreel::systems::Preparation;
use rayreel::trace::shapes::Sphere;
use rayreel::trace::{
    CastRay, Effects, Geometry, LightSource, Lighting, Paths, PixelSampling, PreparedCamera, PreparedLight,
    PreparedScene, PreparedShape, RenderJob, Signals, SurfaceMaterial,
};

mod shipped;

use shipped::{SCENES, prepared};

fn main() {
    // The measuring thread is the pool's only thread.
    rayon::ThreadPoolBuilder::new()
        .num_threads(1)
        .use_current_thread()
        .build_global()
        .expect("there is none");
    divan::main();
}

/// The stages, in order. Every row includes accumulation.
#[derive(Clone, Copy, Debug)]
enum Stage {
    CameraRays,
    ClosestHits,
    Surfaces,
    DirectLight,
    Shadows,
    NextRays,
}

/// A shipped scene, and the last stage to run.
struct Stages(&'static str, Stage);

impl fmt::Display for Stages {
    fn fmt(&self, formatter: &mut fmt::Formatter<'_>) -> fmt::Result {
        let stage = match self.1 {
            Stage::CameraRays => "camera_rays",
            Stage::ClosestHits => "closest_hits",
            Stage::Surfaces => "surfaces",
            Stage::DirectLight => "direct_light",
            Stage::Shadows => "shadows",
            Stage::NextRays => "next_rays",
        };
        // The number sorts the rows by stage.
        write!(formatter, "{}: {} {stage}", self.0, self.1 as u8 + 1)
    }
}

fn stages() -> impl Iterator<Item = Stages> {
    let all = [
        Stage::CameraRays,
        Stage::ClosestHits,
        Stage::Surfaces,
        Stage::DirectLight,
        Stage::Shadows,
        Stage::NextRays,
    ];
    SCENES.into_iter().flat_map(move |scene| all.map(|stage| Stages(scene, stage)))
}

#[divan::bench(args = stages(), sample_count = 21, sample_size = 1)]
fn frame(bencher: Bencher<'_, '_>, Stages(name, stage): &Stages) {
    let (world, preparation) = prepared(name);
    let planned = preparation.plan(&world).effects();
    let (scene, effects) = up_to(*stage, preparation.scene().clone(), planned);
    let camera = preparation.camera();
    let never = AtomicBool::new(false);
    let dark = || RenderJob::new(camera.resolution(), 1);
    let expose = |job: &mut RenderJob| {
        assert!(job.add(&scene, camera, PixelSampling::default(), 0, effects, Signals::unless(&never)));
    };
    let mut first = dark();
    expose(&mut first);
    let rays = first.resolve().1.rays.total();
    bencher.counter(ItemsCount::new(rays)).with_inputs(dark).bench_local_refs(expose);
}

/// Returns a scene and effects for which a picture runs the stages up to `stage`, and no later one except accumulation.
fn up_to(stage: Stage, scene: PreparedScene, planned: Effects) -> (PreparedScene, Effects) {
    let plain = Effects { lighting: Lighting::None, paths: Paths::Straight, extras: false };
    match stage {
        Stage::CameraRays => (PreparedScene::new(Geometry::default(), Vec::new()), plain),
        Stage::ClosestHits => (scene, plain),
        Stage::Surfaces => (lit_by_nothing(scene), Effects { lighting: Lighting::Unshadowed, ..plain }),
        Stage::DirectLight => {
            let lighting = planned.lighting.min(Lighting::Unshadowed);
            (scene, Effects { lighting, paths: Paths::Straight, ..planned })
        }
        Stage::Shadows => (scene, Effects { paths: Paths::Straight, ..planned }),
        Stage::NextRays => (scene, planned),
    }
}

/// Replaces all lights with one area light. Without extras it proposes no samples, but surface points are still computed for it.
fn lit_by_nothing(mut scene: PreparedScene) -> PreparedScene {
    scene.lights = vec![PreparedLight {
        source: LightSource::Sphere { center: DVec3::ZERO, radius: 1.0 },
        intensity: Rgb::ONE,
        falloff: None,
        samples: 1,
        casts_shadows: false,
        own_shape: None,
    }];
    scene
}

/// Single rays on the renderer's own path: closest hits, and the surface points there.
mod rays {
    use super::*;

    /// Casts camera rays, row by row.
    #[divan::bench(args = SCENES, sample_count = 21, sample_size = 1)]
    fn camera(bencher: Bencher<'_, '_>, name: &str) {
        let (_, preparation) = prepared(name);
        measure(bencher, preparation.scene(), &camera_rays(preparation.camera()));
    }

    /// Casts rays reflected at the hits of camera rays, whatever the material.
    #[divan::bench(args = SCENES, sample_count = 21, sample_size = 1)]
    fn mirrored(bencher: Bencher<'_, '_>, name: &str) {
        let (_, preparation) = prepared(name);
        measure(bencher, preparation.scene(), &mirrored_rays(&preparation));
    }

    fn measure(bencher: Bencher<'_, '_>, scene: &PreparedScene, rays: &[Option<CastRay>]) {
        bencher.counter(ItemsCount::new(rays.len())).bench_local(|| scene.cast_all(rays));
    }

    fn camera_rays(camera: &PreparedCamera) -> Vec<Option<CastRay>> {
        let (columns, rows) = camera.resolution();
        let pixels = (0..rows).flat_map(|j| (0..columns).map(move |i| (i, j)));
        pixels.map(|(i, j)| CastRay::new(camera.position(), camera.towards(i, j))).collect()
    }

    fn mirrored_rays(preparation: &Preparation) -> Vec<Option<CastRay>> {
        let rays = camera_rays(preparation.camera());
        let hits = preparation.scene().cast_all(&rays);
        let hits = rays.iter().flatten().zip(hits).filter_map(|(ray, hit)| Some((ray.direction(), hit?)));
        hits.map(|(direction, hit)| hit.leave_towards(direction.reflect(hit.normal))).collect()
    }
}

/// Construction of the BVH, including the separation of equal shapes and of shapes too large for it.
mod tree {
    use super::*;

    #[divan::bench(args = SCENES)]
    fn shipped(bencher: Bencher<'_, '_>, name: &str) {
        build(bencher, prepared(name).1.scene().geometry());
    }

    #[divan::bench(args = [1000, 10_000, 100_000], sample_count = 11, sample_size = 1)]
    fn balls(bencher: Bencher<'_, '_>, count: u32) {
        let mut geometry = Geometry::default();
        for index in 0..count {
            // Golden ratios spread the centres evenly in a cube.
            let place = |step: f64| 100.0 * (f64::from(index) * step).fract();
            let center = DVec3::new(place(0.819_172_513_4), place(0.671_043_606_7), place(0.549_700_477_9));
            geometry.push(PreparedShape::Sphere(Sphere { center, radius: 0.5 }));
        }
        build(bencher, &geometry);
    }

    fn build(bencher: Bencher<'_, '_>, geometry: &Geometry) {
        let count = geometry.len();
        let parts = || (geometry.clone(), vec![SurfaceMaterial::default(); count]);
        bencher
            .counter(ItemsCount::new(count))
            .with_inputs(parts)
            .bench_local_values(|(geometry, materials)| PreparedScene::new(geometry, materials));
    }
}
