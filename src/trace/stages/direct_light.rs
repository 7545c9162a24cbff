//! Direct light, one light after the other: computes the unoccluded contribution of a light at all surface points of the wavefront, traces the
//! shadow rays, and adds the light that is not occluded.

use fearless_simd::{dispatch, f32x16, prelude::*};
use glam::DVec3;

use super::buffers::TileBuffers;
use super::slots::Sample;
use super::transparent_shadows::attenuate_packet;
use crate::trace::intersect::{
    LightBox, LitPoints, Occluders, Occlusion, ShadowPacket, ShadowRays, occluded,
};
use crate::trace::math::{Colors, HALF, PixelSamples, Vectors, lanes, mask, mask16};
use crate::trace::scene::{LightSource, Precision, PreparedLight};
use crate::trace::shading::{LightSamplePacket, SampleId, ShadingPacket, sample_light_lanes, visibility};

/// Adds the light of each source that the wavefront's surface points scatter back along their rays.
pub(super) fn direct_light(sample: &Sample<'_>, buffers: &mut TileBuffers<'_>) {
    buffers.stage_runs.direct_light += 1;
    let lights = &sample.context.lights;
    for (place, (index, light)) in lights.iter().enumerate() {
        if light.sample_count() > 1 {
            buffers.light_sums.fill(Vectors::splat(DVec3::ZERO));
        }
        if sample.context.effects.extras && light.source.is_extended() {
            choose_area_light_samples(sample, *index, light, buffers);
        }
        for light_sample in 0..light.sample_count() {
            // A light may have thousands of samples.
            if buffers.is_cancelled() {
                return;
            }
            sample_lights(sample, (*index, light), light_sample, buffers);
            if let Some(recorder) = &mut buffers.recorder {
                recorder.note_light(*index, &buffers.light_samples[..buffers.wavefront.count]);
            }
            if sample.context.effects.shadows() {
                shadows(sample, (place, light, light_sample), buffers);
            }
            add(sample, light, buffers);
        }
        if light.sample_count() > 1 {
            add_means(sample, light, buffers);
        }
    }
}

/// Chooses the sample points on an area light for each surface point, for all samples of the light.
fn choose_area_light_samples(
    sample: &Sample<'_>,
    index: usize,
    light: &PreparedLight,
    buffers: &mut TileBuffers<'_>,
) {
    let TileBuffers { wavefront, surfaces, area_light_samples, .. } = buffers;
    for packet in 0..wavefront.count {
        let sample_id = |lane: usize| {
            let slot = wavefront.slots[packet][lane];
            let (i, j) = sample.tile.pixel(sample.slots.pixel(slot));
            let samples = PixelSamples::new(sample.context.sampling.seed, i, j);
            (samples, sample.slots.sample(slot), wavefront.paths[packet].places[lane])
        };
        area_light_samples[packet].choose(index, light, surfaces[packet].lanes, sample_id);
    }
}

/// Computes the unoccluded contribution of one sample of a light at each surface point.
fn sample_lights(
    sample: &Sample<'_>,
    light: (usize, &PreparedLight),
    light_sample: u32,
    buffers: &mut TileBuffers<'_>,
) {
    let context = sample.context;
    let TileBuffers { wavefront, hits, surfaces, material_flags, area_light_samples, light_samples, .. } =
        buffers;
    let seed = context.sampling.seed;
    dispatch!(context.scene.simd.level(), simd => {
        for packet in 0..wavefront.count {
            let sample_id = |lane: usize| {
                let slot = wavefront.slots[packet][lane];
                let pixel = sample.tile.pixel(sample.slots.pixel(slot));
                SampleId { seed, pixel, sample: sample.slots.sample(slot) }
            };
            let lit = ShadingPacket {
                rays: &wavefront.rays[packet],
                paths: &wavefront.paths[packet],
                hits: &hits[packet],
                surfaces: &surfaces[packet],
                diffuse: &material_flags[packet].diffuse,
                ambient: &material_flags[packet].ambient,
                places: &area_light_samples[packet],
                shiny: material_flags[packet].shiny,
                transparent: material_flags[packet].transparent,
            };
            let scene = (context.scene, context.effects);
            sample_light_lanes(simd, scene, light, &lit, light_sample, sample_id, &mut light_samples[packet]);
        }
    });
}

/// Adds the contributions that remain after occlusion and attenuation.
fn add(sample: &Sample<'_>, light: &PreparedLight, buffers: &mut TileBuffers<'_>) {
    let TileBuffers { wavefront, light_samples, light_sums, radiance, .. } = buffers;
    let light_samples = &light_samples[..wavefront.count];
    dispatch!(sample.context.scene.simd.level(), simd => {
        if light.sample_count() > 1 {
            for (light_samples, sums) in light_samples.iter().zip(light_sums.iter_mut()) {
                add_to_sums(simd, light_samples, sums);
            }
        } else {
            for (light_samples, radiance) in light_samples.iter().zip(radiance.iter_mut()) {
                add_light(simd, light_samples.lanes, light_samples.colors.load(simd), radiance);
            }
        }
    });
}

/// Adds light in the lanes `lit`.
#[inline(always)]
fn add_light<S: Simd>(simd: S, lit: u32, added: [f32x16<S>; 3], radiance: &mut Colors) {
    let (lit, mut light) = (mask16(simd, lit), radiance.load(simd));
    for (light, added) in light.iter_mut().zip(added) {
        *light = lit.select(*light + added, *light);
    }
    radiance.store(light);
}

/// Adds the contributions of one light sample to the sums of its light.
#[inline(always)]
fn add_to_sums<S: Simd>(simd: S, light_samples: &LightSamplePacket, sums: &mut Vectors) {
    for (axis, channel) in light_samples.colors.load(simd).into_iter().enumerate() {
        let (first, second) = channel.widen();
        for (half, added) in [first, second].into_iter().enumerate() {
            let (sum, lit) = (sums.axis(axis).load(simd, half), mask(simd, light_samples.lanes, half));
            sums.axis_mut(axis).store(half, lit.select(sum + added, sum));
        }
    }
}

/// Adds the mean over an area light's samples.
fn add_means(sample: &Sample<'_>, light: &PreparedLight, buffers: &mut TileBuffers<'_>) {
    let TileBuffers { wavefront, surfaces, light_sums, radiance, .. } = buffers;
    let places = f64::from(light.sample_count());
    dispatch!(sample.context.scene.simd.level(), simd => {
        for packet in 0..wavefront.count {
            let mut means = [f32x16::splat(simd, 0.0); 3];
            for (axis, mean) in means.iter_mut().enumerate() {
                let sum = light_sums[packet].axis(axis);
                *mean = (sum.load(simd, 0) / places).narrow(sum.load(simd, 1) / places);
            }
            add_light(simd, surfaces[packet].lanes, means, &mut radiance[packet]);
        }
    });
}

/// Traces the shadow rays of a light sample. Drops occluded contributions, and attenuates those that pass through transparent shapes. `place`
/// is the index of the light among the enabled lights.
fn shadows(
    sample: &Sample<'_>,
    (place, light, light_sample): (usize, &PreparedLight, u32),
    buffers: &mut TileBuffers<'_>,
) {
    buffers.stage_runs.shadows += 1;
    if light_sample == 0 {
        // A light with too many possible occluders for one wavefront has too many for the next.
        buffers.listed = !buffers.overflowed_lights[place] && find_candidates(sample, light, buffers);
        buffers.overflowed_lights[place] |= buffers.listed && buffers.candidates.all_overflowed();
    }
    let listed = buffers.listed;
    for packet in 0..buffers.wavefront.count {
        let needs_shadow_ray = buffers.light_samples[packet].needs_shadow_ray;
        if needs_shadow_ray == 0 {
            continue;
        }
        buffers.rays_traced.shadow += u64::from(needs_shadow_ray.count_ones());
        let occluded = if listed { needs_shadow_ray & buffers.candidates.occluded(packet) } else { 0 };
        buffers.light_samples[packet].drop_occluded(occluded);
        let needs_shadow_ray = needs_shadow_ray & !occluded;
        if needs_shadow_ray == 0 {
            continue;
        }
        if listed && are_unoccluded(packet, buffers) {
            if sample.context.effects.transparent_shadows() {
                buffers.packet_scratch.crossed.clear();
                attenuate_packet(sample, light, packet, needs_shadow_ray, buffers);
            }
            continue;
        }
        let Occlusion { occluded, undecided } = occlusion(sample, (place, light), (packet, listed), buffers);
        buffers.light_samples[packet].drop_occluded(occluded);
        if sample.context.effects.transparent_shadows() {
            attenuate_packet(sample, light, packet, needs_shadow_ray & !occluded & !undecided, buffers);
        }
        trace_undecided(sample, (place, light), (packet, listed), undecided & !occluded, buffers);
    }
}

/// Returns whether nothing can occlude the remaining shadow rays of a packet.
fn are_unoccluded(packet: usize, buffers: &TileBuffers<'_>) -> bool {
    let TileBuffers { light_samples, candidates, .. } = buffers;
    // A ray that leaves coincident surfaces can still hit the far side of a shape that it enters.
    light_samples[packet].rays.tied == 0 && candidates.is_unoccluded(packet)
}

/// Finds the shadow rays of a packet that are certainly occluded, and those that have to be traced one by one.
fn occlusion(
    sample: &Sample<'_>,
    (place, light): (usize, &PreparedLight),
    (packet, listed): (usize, bool),
    buffers: &mut TileBuffers<'_>,
) -> Occlusion {
    let scene = sample.context.shadow;
    let TileBuffers { light_samples, candidates, last_occluders, scratch, packet_scratch, .. } = buffers;
    let light_samples = &light_samples[packet];
    if scene.precision != Precision::Robust {
        return Occlusion { occluded: 0, undecided: light_samples.needs_shadow_ray };
    }
    let shadow = ShadowPacket {
        rays: &light_samples.rays,
        limits: &light_samples.limits,
        light: light_point(light),
        occluders: occluders(sample, light),
        unbounded: if listed { candidates.unbounded() } else { &scene.unbounded },
        candidates: [0, 1].map(|half| if listed { candidates.of(packet, half) } else { None }),
    };
    let cancelled = scratch.search.cancelled;
    occluded(scene, &shadow, &mut last_occluders[place], packet_scratch, cancelled)
}

/// Traces the shadow rays in the lanes `undecided` of a packet one by one.
fn trace_undecided(
    sample: &Sample<'_>,
    (place, light): (usize, &PreparedLight),
    (packet, listed): (usize, bool),
    undecided: u32,
    buffers: &mut TileBuffers<'_>,
) {
    let (scene, effects) = (sample.context.shadow, sample.context.effects);
    let TileBuffers { wavefront, hits, surfaces, light_samples, candidates, last_occluders, scratch, .. } =
        buffers;
    let light_samples = &mut light_samples[packet];
    for lane in lanes(undecided) {
        let Some(point) = surfaces[packet].get(lane, &hits[packet]) else { continue };
        let shadow_ray = &light_samples.segment(light, lane).ray(&point);
        let seen = (&point, wavefront.paths[packet].media[lane]);
        let candidates = if listed { candidates.of(packet, lane / HALF) } else { None };
        let occluders = (light.own_shape, &mut last_occluders[place], candidates);
        match visibility(effects, scene, shadow_ray, occluders, seen, scratch) {
            Some(share) if effects.transparent_shadows() => {
                light_samples.colors.set(lane, light_samples.colors.get(lane) * share);
            }
            Some(_) => {}
            None => light_samples.lanes &= !(1 << lane),
        }
    }
}

/// Returns the kinds of shapes that can occlude a light.
fn occluders(sample: &Sample<'_>, light: &PreparedLight) -> Occluders {
    Occluders { except: light.own_shape, transparent: sample.context.effects.transparent_shadows() }
}

/// Returns the common end point of all rays to a light, if there is one.
fn light_point(light: &PreparedLight) -> Option<DVec3> {
    match light.source {
        LightSource::Point(place) | LightSource::Spot(place, _) => Some(place),
        LightSource::Directional(_)
        | LightSource::Sphere { .. }
        | LightSource::Rectangle { .. }
        | LightSource::Dome { .. } => None,
    }
}

/// Collects the possible occluders between a light and the surface points: for an area light, those on the way to any point of it. Returns
/// `false` if there are no candidate lists. Directional lights never have any, as their rays form no bundle.
fn find_candidates(sample: &Sample<'_>, light: &PreparedLight, buffers: &mut TileBuffers<'_>) -> bool {
    // Naive shapes accept rays that miss them by more than the tolerance of bundles.
    if sample.context.scene.precision != Precision::Robust {
        return false;
    }
    let TileBuffers { wavefront, surfaces, light_samples, candidates, scratch, .. } = buffers;
    let (scene, search) = (sample.context.shadow, &mut scratch.search);
    let Some(place) = light_point(light) else {
        let Some((middle, reach)) = light.source.extent() else { return false };
        let points = surfaces[..wavefront.count].iter().map(|surfaces| LitPoints {
            points: &surfaces.points,
            left: &surfaces.first_equals,
            lanes: surfaces.lanes,
        });
        let light = (LightBox { middle, reach }, occluders(sample, light));
        return candidates.find_all(scene, light, &points, search);
    };
    let shadow_rays = light_samples[..wavefront.count].iter().map(|light_samples| ShadowRays {
        rays: &light_samples.rays,
        limits: &light_samples.limits,
        lanes: light_samples.needs_shadow_ray,
    });
    candidates.find(scene, (place, occluders(sample, light)), &shadow_rays, search)
}
