//! One sample of each pixel of a tile, through all stages; among them the camera rays, their coverage, the closest hits, and the sums of
//! radiance.

use fearless_simd::{dispatch, f32x16, prelude::*};

use super::buffers::TileBuffers;
use super::cutoff::drop_negligible;
use super::direct_light::direct_light;
use super::empty_tiles::fill_empty_tile;
use super::handover::with_shadow_scene;
use super::next_rays::{fill_wavefront, next_rays, terminate};
use super::slots::{Sample, Slots};
use super::surfaces::surfaces;
use super::tile::{PACKETS, PIXELS, Tile};
use super::tile_sampler::TileSampler;
use super::wavefront::{RayOrigin, Wavefront};
use crate::color::Rgb;
use crate::trace::intersect::{
    HitPacket, SurfacePacket, bundle_hits, closest_hits as packet_hits, lens_hits,
};
use crate::trace::math::{
    Colors, LANES, Numbers, bits, bits16, half_lanes, half_of, lanes, mask, mask16, splat,
};
use crate::trace::rays::RayPacket;
use crate::trace::scene::Precision;
use crate::trace::shading::{Absorbers, PassageLanes, PathPacket, RenderContext, clamped};

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
    buffers.begin(context, slots.count);
    if fill_empty_tile(&sample, buffers) {
        return !buffers.is_cancelled();
    }
    camera_rays(&sample, buffers);
    closest_hits(context, buffers);
    record_coverage(context, buffers);
    shade(&sample, buffers);
    let mut bounces = context.bounces() - 1;
    while context.effects.mirrors() && !buffers.next.is_empty() && !buffers.is_cancelled() {
        drop_negligible(context, bounces, buffers);
        if let Some(recorder) = &mut buffers.recorder {
            recorder.begin_bounce();
        }
        bounces = bounces.saturating_sub(1);
        while !buffers.is_cancelled() && fill_wavefront(buffers) {
            closest_hits(context, buffers);
            shade(&sample, buffers);
        }
    }
    if context.effects.mirrors() {
        terminate(context, buffers);
    }
    !buffers.is_cancelled()
}

/// Runs the other stages on the wavefront and its hits.
fn shade(sample: &Sample<'_>, buffers: &mut TileBuffers<'_>) {
    let context = sample.context;
    surfaces(context, buffers);
    if context.effects.lights() {
        with_shadow_scene(context, buffers, |buffers| direct_light(sample, buffers));
    }
    if buffers.is_cancelled() {
        return;
    }
    record_dependencies(context, buffers);
    add_to_pixels(context, buffers);
    if context.effects.mirrors() {
        next_rays(context, buffers);
    }
}

/// Records the regions that the wavefront's rays and their shadow rays pass through, and the materials that they hit, if recording is enabled.
fn record_dependencies(context: &RenderContext<'_>, buffers: &mut TileBuffers<'_>) {
    let TileBuffers { wavefront, hits, surfaces, recorder: Some(recorder), stage_runs, .. } = buffers else {
        return;
    };
    stage_runs.dependencies += 1;
    let scene = wavefront.scene(context);
    dispatch!(context.scene.simd.level(), simd => recorder.add(simd, scene, wavefront, (hits, surfaces)));
}

/// Generates the wavefront of camera rays. A camera at a non-finite position has no rays: its pixels see the background.
fn camera_rays(sample: &Sample<'_>, buffers: &mut TileBuffers<'_>) {
    buffers.stage_runs.camera_rays += 1;
    let Sample { context, tile, slots } = *sample;
    let TileBuffers { wavefront, tile_sampler, scratch, .. } = &mut *buffers;
    // A single sample passes through the centre of the lens.
    let pinhole = context.sampling.samples <= 1 || !context.camera.has_lens();
    let is_orthographic = context.camera.is_orthographic();
    wavefront.start = match pinhole && !is_orthographic {
        true => RayOrigin::Eye(context.camera.position()),
        false => RayOrigin::Lens,
    };
    if context.sampling.samples > 1 {
        tile_sampler.prepare(context, (tile, slots), &mut scratch.search);
    } else if is_orthographic {
        tile_sampler.find_candidates(context, tile, &mut scratch.search);
    }
    (wavefront.count, *wavefront.slots) = (slots.count, PIXELS);
    dispatch!(context.scene.simd.level(), simd => make_rays(simd, sample, tile_sampler, wavefront));
    for packet in 0..buffers.wavefront.count {
        if buffers.is_cancelled() {
            // The paths of the remaining packets belong to another wavefront: these packets must not be traced.
            buffers.wavefront.count = packet;
            return;
        }
        start(sample, packet, buffers);
    }
    buffers.rays_traced.camera += u64::from(buffers.wavefront.len());
}

/// Generates the rays through pixel centres, or the rays of the slots' samples if there are several per pixel.
#[inline(always)]
fn make_rays<S: Simd>(simd: S, sample: &Sample<'_>, tile_sampler: &TileSampler, wavefront: &mut Wavefront) {
    let Sample { context, tile, slots } = *sample;
    for packet in 0..slots.count {
        let rays = &mut wavefront.rays[packet];
        if context.sampling.samples > 1 {
            context.camera.sample_rays(
                simd,
                context.sampling,
                &tile_sampler.keys[packet],
                &slots.samples[packet],
                rays,
            );
        } else {
            match tile.square(packet) {
                Some(square) => context.pixel_centers.rays(simd, &square, rays),
                None => rays.clear(),
            }
        }
    }
}

/// Initializes the paths of a packet's rays, and sets pixels without a ray to the background.
fn start(sample: &Sample<'_>, packet: usize, buffers: &mut TileBuffers<'_>) {
    let TileBuffers { wavefront, scratch, pixels, .. } = buffers;
    let rays = &wavefront.rays[packet];
    for lane in lanes(sample.slots.lanes[packet] & !rays.lanes) {
        pixels[packet].set(lane, sample.context.unplaced_camera_color());
    }
    let paths = &mut wavefront.paths[packet];
    *paths = PathPacket::AT_CAMERA;
    if sample.context.may_start_inside() {
        for lane in lanes(rays.lanes) {
            paths.media[lane] = sample.context.medium(rays.origins.get(lane), &mut scratch.media);
        }
    }
}

/// Finds the closest hits of the wavefront. Rays that start at one point, on a lens or in the camera's plane are traced together, others
/// packet by packet. Lanes that remain undecided are traced as single rays, with the same result.
fn closest_hits(context: &RenderContext<'_>, buffers: &mut TileBuffers<'_>) {
    buffers.stage_runs.closest_hits += 1;
    let TileBuffers { wavefront, hits, tile_sampler, scratch, packet_scratch, .. } = buffers;
    let (scene, search) = (wavefront.scene(context), &mut scratch.search);
    search.tied_hits.clear();
    // Camera rays use all packets of a tile, though some may be empty.
    let count = if matches!(wavefront.start, RayOrigin::Anywhere) { wavefront.count } else { PACKETS };
    let (rays, hits) = (&wavefront.rays[..count], &mut hits[..count]);
    if scene.precision != Precision::Robust {
        for (rays, hits) in rays.iter().zip(&mut *hits) {
            hits.clear();
            hits.undecided = rays.lanes;
        }
    } else if !match wavefront.start {
        RayOrigin::Eye(eye) => bundle_hits(scene, eye, rays, hits, (search, packet_scratch)),
        RayOrigin::Lens => {
            lens_hits(scene, &tile_sampler.candidates, rays, hits, packet_scratch, search.cancelled)
        }
        RayOrigin::Anywhere => false,
    } {
        for (rays, hits) in rays.iter().zip(&mut *hits) {
            packet_hits(scene, rays, hits, packet_scratch, search.cancelled);
        }
    }
    for (rays, hits) in rays.iter().zip(hits) {
        for lane in lanes(hits.undecided) {
            hits.set(lane, scene.closest(&rays.get(lane), search));
        }
    }
}

/// Records the pixels whose camera rays, the wavefront, hit a shape or lose light on their way, if recording is enabled. All other pixels see
/// the unattenuated background.
fn record_coverage(context: &RenderContext<'_>, buffers: &mut TileBuffers<'_>) {
    let TileBuffers { wavefront, hits, scratch, covered: Some(covered), stage_runs, .. } = buffers else {
        return;
    };
    stage_runs.coverage += 1;
    dispatch!(context.scene.simd.level(), simd => {
        for packet in 0..wavefront.count {
            let active = wavefront.rays[packet].lanes;
            let paths = (&wavefront.paths[packet], &scratch.media);
            let absorbers = Absorbers::of(context.scene, context.effects, paths, active);
            let mut hit = active & hits[packet].ids.lanes(simd);
            if absorbers.lanes & !hit != 0 {
                hit |= absorbers.endless(simd, &context.scene.fog, &wavefront.rays[packet]);
            }
            if let Some(source_packet) = wavefront.source_packet(packet) {
                covered.add(source_packet, hit);
                continue;
            }
            for lane in lanes(hit) {
                let slot = wavefront.slots[packet][lane] as usize;
                covered.add(slot / LANES % PACKETS, 1 << (slot % LANES));
            }
        }
    });
}

/// Adds the radiance of each ray to its pixel, ray by ray in the order of the wavefront. Multiplies the throughput of each ray by the
/// transmittance along it.
fn add_to_pixels(context: &RenderContext<'_>, buffers: &mut TileBuffers<'_>) {
    buffers.stage_runs.add_to_pixels += 1;
    dispatch!(context.scene.simd.level(), simd => {
        for packet in 0..buffers.wavefront.count {
            clamp(simd, buffers.wavefront.rays[packet].lanes & buffers.hits[packet].ids.lanes(simd), &mut buffers.radiance[packet]);
            let passage = pass(simd, context, packet, buffers);
            add(simd, packet, &buffers.wavefront, &buffers.radiance, &mut buffers.pixels);
            if let Some(transmitted) = passage {
                let throughputs = &mut buffers.wavefront.paths[packet].throughputs;
                throughputs.store(product(throughputs.load(simd), transmitted));
            }
        }
    });
}

/// Clamps radiance that overflows, in the lanes `hit`: see [`clamped`].
#[inline(always)]
fn clamp<S: Simd>(simd: S, hit: u32, radiance: &mut Colors) {
    let [red, green, blue] = radiance.load(simd);
    let little = (red + green + blue).simd_lt(f32x16::splat(simd, f32::INFINITY));
    for lane in lanes(hit & !bits16(little)) {
        radiance.set(lane, clamped(radiance.get(lane)));
    }
}

/// Applies the media and the fog along a packet's rays to their radiance. Returns the transmittance; `None` if there are neither.
#[inline(always)]
fn pass<S: Simd>(
    simd: S,
    context: &RenderContext<'_>,
    packet: usize,
    buffers: &mut TileBuffers<'_>,
) -> Option<[f32x16<S>; 3]> {
    let TileBuffers { wavefront, hits, surfaces, radiance, scratch, .. } = buffers;
    let (scene, rays) = (context.scene, &wavefront.rays[packet]);
    let absorbers =
        Absorbers::of(scene, context.effects, (&wavefront.paths[packet], &scratch.media), rays.lanes);
    if absorbers.lanes == 0 {
        return None;
    }
    let lengths = lengths(simd, rays, (&hits[packet], &surfaces[packet]), absorbers.lanes);
    let PassageLanes { transmitted, added } = absorbers.over(simd, &scene.fog, rays, &lengths);
    let (active, one) = (mask16(simd, absorbers.lanes), f32x16::splat(simd, 1.0));
    let (mut light, mut share) = (radiance[packet].load(simd), [one; 3]);
    for channel in 0..3 {
        let passed = transmitted[channel] * light[channel] + added[channel];
        light[channel] = active.select(passed, light[channel]);
        share[channel] = active.select(transmitted[channel], one);
    }
    radiance[packet].store(light);
    Some(share)
}

/// Returns the lengths of rays in some lanes: infinite for rays without a hit.
#[inline(always)]
fn lengths<S: Simd>(
    simd: S,
    rays: &RayPacket,
    (hits, surfaces): (&HitPacket, &SurfacePacket),
    active: u32,
) -> Numbers {
    let mut lengths = Numbers::splat(f64::INFINITY);
    let mut escalated = 0;
    for half in 0..2 {
        let hit = active & surfaces.lanes;
        if half_of(hit, half) == 0 {
            continue;
        }
        let (distance, in_range) = surfaces.distances(simd, rays, half);
        escalated |= hit & half_lanes(half) & !bits(in_range, half);
        let hit = mask(simd, hit, half);
        lengths.store(half, hit.select(distance, splat(simd, f64::INFINITY)));
    }
    for lane in lanes(escalated) {
        if let Some(point) = surfaces.get(lane, hits) {
            lengths.set(lane, point.distance(&rays.get(lane)));
        }
    }
    lengths
}

/// Adds the radiance of a packet, times throughput, to its pixels.
#[inline(always)]
fn add<S: Simd>(
    simd: S,
    packet: usize,
    wavefront: &Wavefront,
    radiance: &[Colors; PACKETS],
    pixels: &mut [Colors; PACKETS],
) {
    let throughputs = wavefront.paths[packet].throughputs.load(simd);
    let light = product(throughputs, radiance[packet].load(simd));
    let rays = wavefront.rays[packet].lanes;
    if let Some(source_packet) = wavefront.source_packet(packet) {
        let active = mask16(simd, rays);
        let [red, green, blue] = pixels[source_packet].load(simd);
        pixels[source_packet].store([
            active.select(red + light[0], red),
            active.select(green + light[1], green),
            active.select(blue + light[2], blue),
        ]);
        return;
    }
    let mut added = Colors::splat(Rgb::ZERO);
    added.store(light);
    for lane in lanes(rays) {
        let slot = wavefront.slots[packet][lane] as usize;
        let (packet, place) = (slot / LANES % PACKETS, slot % LANES);
        pixels[packet].set(place, pixels[packet].get(place) + added.get(lane));
    }
}

#[inline(always)]
fn product<S: Simd>(a: [f32x16<S>; 3], b: [f32x16<S>; 3]) -> [f32x16<S>; 3] {
    [a[0] * b[0], a[1] * b[1], a[2] * b[2]]
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
        let one = StageCounts {
            camera_rays: 1,
            closest_hits: 1,
            surfaces: 1,
            add_to_pixels: 1,
            ..StageCounts::default()
        };
        assert_eq!(stages(Lighting::None, Paths::Straight), one);
        let lit = StageCounts { direct_light: 1, ..one };
        assert_eq!(stages(Lighting::Unshadowed, Paths::Straight), lit);
        assert_eq!(stages(Lighting::Shadows, Paths::Straight), StageCounts { shadows: 1, ..lit });
        let two = StageCounts { closest_hits: 2, surfaces: 2, add_to_pixels: 2, next_rays: 2, ..one };
        assert_eq!(stages(Lighting::None, Paths::Mirrors), two);
        let all = StageCounts { direct_light: 2, shadows: 2, ..two };
        assert_eq!(stages(Lighting::TransparentShadows, Paths::Media), all);
    }
}
