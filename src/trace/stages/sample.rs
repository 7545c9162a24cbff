//! One sample of each pixel of a tile, through all stages.

use super::accumulate::add_to_pixels;
use super::buffers::TileBuffers;
use super::camera_rays::camera_rays;
use super::closest_hits::closest_hits;
use super::coverage::note_coverage;
use super::cutoff::select;
use super::direct_light::direct_light;
use super::empty_tiles::fill_empty_tile;
use super::next_rays::{fill_wave, give_up, next_rays};
use super::slots::{Sample, Slots};
use super::surfaces::surfaces;
use super::tile::Tile;
use crate::trace::shading::RenderContext;

/// Traces the samples in a tile's slots into `buffers`. Returns `false` if cancelled; the buffers are then incomplete. All searches and long
/// stages check for cancellation.
///
/// The rays of all slots are traced, and their light is summed, bounce by bounce, without recursion. Stages that no effect needs are skipped.
pub(crate) fn render_sample(
    context: &RenderContext<'_>,
    (tile, slots): (Tile, &Slots),
    buffers: &mut TileBuffers<'_>,
) -> bool {
    let sample = Sample { context, tile, slots };
    buffers.begin(context);
    if fill_empty_tile(&sample, buffers) {
        return !buffers.is_cancelled();
    }
    camera_rays(&sample, buffers);
    closest_hits(context, buffers);
    note_coverage(context, buffers);
    shade_wave(&sample, buffers);
    let mut generations = context.generations() - 1;
    while context.effects.mirrors() && !buffers.next.is_empty() && !buffers.is_cancelled() {
        select(context, generations, buffers);
        generations = generations.saturating_sub(1);
        while !buffers.is_cancelled() && fill_wave(buffers) {
            closest_hits(context, buffers);
            shade_wave(&sample, buffers);
        }
    }
    if context.effects.mirrors() {
        give_up(context, buffers);
    }
    !buffers.is_cancelled()
}

/// Runs the other stages on the wavefront and its hits.
fn shade_wave(sample: &Sample<'_>, buffers: &mut TileBuffers<'_>) {
    let context = sample.context;
    surfaces(context, buffers);
    if context.effects.lights() {
        direct_light(sample, buffers);
    }
    if buffers.is_cancelled() {
        return;
    }
    add_to_pixels(context, buffers);
    if context.effects.mirrors() {
        next_rays(context, buffers);
    }
}

#[cfg(test)]
mod tests {
    use std::sync::atomic::{AtomicBool, Ordering};

    use glam::DVec3;

    use super::*;
    use crate::color::Rgb;
    use crate::trace::render_stats::StageCounts;
    use crate::trace::shapes::Sphere;
    use crate::trace::{
        Effects, Geometry, LightSource, Lighting, Paths, PixelSampling, PreparedCamera, PreparedLight,
        PreparedScene, PreparedShape, RenderJob, Signals, SurfaceMaterial,
    };

    /// Returns a lit sphere in front of the camera, with a film of one tile. The sphere reflects only the background.
    fn example() -> (PreparedScene, PreparedCamera) {
        let mut geometry = Geometry::default();
        geometry.push(PreparedShape::Sphere(Sphere { center: DVec3::ZERO, radius: 1.0 }));
        let material = SurfaceMaterial { diffuse: Rgb::ONE, reflected: 0.5, ..SurfaceMaterial::default() };
        let mut scene = PreparedScene::new(geometry, vec![material]);
        scene.depth = 2;
        scene.lights.push(PreparedLight {
            source: LightSource::Directional(DVec3::NEG_Z),
            intensity: Rgb::ONE,
            falloff: None,
            samples: 1,
            casts_shadows: true,
            own_shape: None,
        });
        let camera =
            PreparedCamera::new(DVec3::new(0.0, 0.0, -5.0), DVec3::Z, DVec3::Y, 1.0, (0.2, 0.2), (8, 8));
        (scene, camera)
    }

    /// Returns the number of runs of each stage for the example.
    fn stages(lighting: Lighting, paths: Paths) -> StageCounts {
        let (scene, camera) = example();
        let mut job = RenderJob::new((8, 8), 1);
        let effects = Effects { lighting, paths, extras: false };
        let never = AtomicBool::new(false);
        assert!(job.add(&scene, &camera, PixelSampling::default(), 0, effects, Signals::unless(&never)));
        job.resolve().1.stages
    }

    #[test]
    fn a_cancelled_sample_follows_no_rays_of_the_one_before() {
        let (scene, camera) = example();
        let effects = Effects { lighting: Lighting::Shadows, paths: Paths::Straight, extras: false };
        let context = RenderContext::new(&scene, &camera, PixelSampling::default(), effects);
        let cancelled = AtomicBool::new(false);
        let mut buffers = TileBuffers::new(&cancelled, None);
        let tile = Tile { i: 0, j: 0, width: 8, height: 8 };
        let mut slots = Slots::default();
        slots.set_everywhere(&tile, 0);
        assert!(render_sample(&context, (tile, &slots), &mut buffers));
        assert!(buffers.wavefront.count > 0);
        cancelled.store(true, Ordering::Relaxed);
        assert!(!render_sample(&context, (tile, &slots), &mut buffers));
        assert_eq!(buffers.wavefront.count, 0);
    }

    #[test]
    fn stages_that_no_effect_needs_are_not_entered() {
        let one =
            StageCounts { camera_rays: 1, closest_hits: 1, surfaces: 1, sums: 1, ..StageCounts::default() };
        assert_eq!(stages(Lighting::None, Paths::Straight), one);
        let lit = StageCounts { direct_light: 1, ..one };
        assert_eq!(stages(Lighting::Unshadowed, Paths::Straight), lit);
        assert_eq!(stages(Lighting::Shadows, Paths::Straight), StageCounts { shadows: 1, ..lit });
        let two = StageCounts { closest_hits: 2, surfaces: 2, sums: 2, next_rays: 2, ..one };
        assert_eq!(stages(Lighting::None, Paths::Mirrors), two);
        let all = StageCounts { direct_light: 2, shadows: 2, ..two };
        assert_eq!(stages(Lighting::ClearShadows, Paths::Media), all);
    }
}
