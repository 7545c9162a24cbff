//! Direct light, one light after the other: computes the unoccluded contribution of a light at all surface points of the wavefront, and adds
//! the part that is not occluded.

use fearless_simd::{dispatch, f32x16, prelude::*};
use glam::DVec3;

use super::buffers::TileBuffers;
use super::shadows::shadows;
use super::slots::Sample;
use crate::trace::math::{Colors, PixelSamples, Vectors, mask, mask16};
use crate::trace::scene::PreparedLight;
use crate::trace::shading::{LightSamplePacket, SampleId, ShadingPacket, sample_light_lanes};

/// Adds the light of each source that the wavefront's surface points scatter back along their rays.
pub(super) fn direct_light(sample: &Sample<'_>, buffers: &mut TileBuffers<'_>) {
    buffers.stage_runs.direct_light += 1;
    let lights = &sample.context.lights;
    for (place, (index, light)) in lights.iter().enumerate() {
        if light.places() > 1 {
            buffers.light_sums.fill(Vectors::splat(DVec3::ZERO));
        }
        if sample.context.effects.extras && light.source.is_extended() {
            choose_area_light_samples(sample, *index, light, buffers);
        }
        for light_sample in 0..light.places() {
            // A light may have thousands of samples.
            if buffers.is_cancelled() {
                return;
            }
            sample_lights(sample, (*index, light), light_sample, buffers);
            if sample.context.effects.shadows() {
                shadows(sample, (place, light, light_sample), buffers);
            }
            add(sample, light, buffers);
        }
        if light.places() > 1 {
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
        let asker = |lane: usize| {
            let slot = wavefront.slots[packet][lane];
            let (i, j) = sample.tile.pixel(sample.slots.pixel(slot));
            let samples = PixelSamples::new(sample.context.sampling.seed, i, j);
            (samples, sample.slots.sample(slot), wavefront.paths[packet].places[lane])
        };
        area_light_samples[packet].choose(index, light, surfaces[packet].lanes, asker);
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
    let TileBuffers { wavefront, hits, surfaces, answers, area_light_samples, light_samples, .. } = buffers;
    let seed = context.sampling.seed;
    dispatch!(context.scene.simd.level(), simd => {
        for packet in 0..wavefront.count {
            let asker = |lane: usize| {
                let slot = wavefront.slots[packet][lane];
                let pixel = sample.tile.pixel(sample.slots.pixel(slot));
                SampleId { seed, pixel, sample: sample.slots.sample(slot) }
            };
            let lit = ShadingPacket {
                rays: &wavefront.rays[packet],
                paths: &wavefront.paths[packet],
                hits: &hits[packet],
                surfaces: &surfaces[packet],
                diffuse: &answers[packet].diffuse,
                places: &area_light_samples[packet],
                shiny: answers[packet].shiny,
                clear: answers[packet].clear,
            };
            let scene = (context.scene, context.effects);
            sample_light_lanes(simd, scene, light, &lit, light_sample, asker, &mut light_samples[packet]);
        }
    });
}

/// Adds the contributions that remain after occlusion and attenuation.
fn add(sample: &Sample<'_>, light: &PreparedLight, buffers: &mut TileBuffers<'_>) {
    let TileBuffers { wavefront, light_samples, light_sums, radiance, .. } = buffers;
    let light_samples = &light_samples[..wavefront.count];
    dispatch!(sample.context.scene.simd.level(), simd => {
        if light.places() > 1 {
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
    let places = f64::from(light.places());
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
