//! Direct light, one light after the other: computes the unoccluded contribution of a light at all surface points of the wavefront, and adds
//! the part that is not occluded.

use fearless_simd::{dispatch, f32x16, prelude::*};
use glam::DVec3;

use super::buffers::TileBuffers;
use super::shadows::shadows;
use super::slots::Sample;
use crate::trace::light::{LitPacket, ProposalPacket, SampleId, propose_lanes};
use crate::trace::math::{Colors, PixelSamples, Vectors, mask, mask16};
use crate::trace::query::Intersector;
use crate::trace::scene::Light;

/// Adds the light of each source that the wavefront's surface points scatter back along their rays.
pub(super) fn direct_light(sample: &Sample<'_>, shapes: &impl Intersector, buffers: &mut TileBuffers<'_>) {
    buffers.entered.direct_light += 1;
    let lights = &sample.context.lights;
    for (place, (index, light)) in lights.iter().enumerate() {
        if light.places() > 1 {
            buffers.light_sums.fill(Vectors::splat(DVec3::ZERO));
        }
        if sample.context.effects.extras && light.source.is_extended() {
            choose_places(sample, (*index, light), buffers);
        }
        for light_sample in 0..light.places() {
            // A light may have thousands of samples.
            if buffers.is_cancelled() {
                return;
            }
            propose_all(sample, (*index, light), light_sample, buffers);
            if sample.context.effects.shadows() {
                shadows(sample, shapes, (place, light, light_sample), buffers);
            }
            add(sample, light, buffers);
        }
        if light.places() > 1 {
            add_means(sample, light, buffers);
        }
    }
}

/// Chooses the sample points on an area light for each surface point, for all samples of the light.
fn choose_places(sample: &Sample<'_>, light: (usize, &Light), buffers: &mut TileBuffers<'_>) {
    let TileBuffers { wave, surfaces, light_places, .. } = buffers;
    for packet in 0..wave.count {
        let asker = |lane: usize| {
            let slot = wave.slots[packet][lane];
            let (i, j) = sample.tile.pixel(sample.slots.pixel(slot));
            let samples = PixelSamples::new(sample.context.sampling.seed, i, j);
            (samples, sample.slots.sample(slot), wave.paths[packet].places[lane])
        };
        light_places[packet].choose(light, surfaces[packet].lanes, asker);
    }
}

/// Computes the unoccluded contribution of one sample of a light at each surface point.
fn propose_all(
    sample: &Sample<'_>,
    light: (usize, &Light),
    light_sample: u32,
    buffers: &mut TileBuffers<'_>,
) {
    let context = sample.context;
    let TileBuffers { wave, hits, surfaces, answers, light_places, proposals, .. } = buffers;
    let seed = context.sampling.seed;
    dispatch!(context.scene.simd.level(), simd => {
        for packet in 0..wave.count {
            let asker = |lane: usize| {
                let slot = wave.slots[packet][lane];
                let pixel = sample.tile.pixel(sample.slots.pixel(slot));
                SampleId { seed, pixel, sample: sample.slots.sample(slot) }
            };
            let lit = LitPacket {
                rays: &wave.rays[packet],
                paths: &wave.paths[packet],
                hits: &hits[packet],
                surfaces: &surfaces[packet],
                diffuse: &answers[packet].diffuse,
                places: &light_places[packet],
                shiny: answers[packet].shiny,
                clear: answers[packet].clear,
            };
            let scene = (context.scene, context.effects);
            propose_lanes(simd, scene, light, &lit, light_sample, asker, &mut proposals[packet]);
        }
    });
}

/// Adds the contributions that remain after occlusion and attenuation.
fn add(sample: &Sample<'_>, light: &Light, buffers: &mut TileBuffers<'_>) {
    let TileBuffers { wave, proposals, light_sums, radiance, .. } = buffers;
    let proposals = &proposals[..wave.count];
    dispatch!(sample.context.scene.simd.level(), simd => {
        if light.places() > 1 {
            for (proposals, sums) in proposals.iter().zip(light_sums.iter_mut()) {
                add_to_sums(simd, proposals, sums);
            }
        } else {
            for (proposals, radiance) in proposals.iter().zip(radiance.iter_mut()) {
                add_light(simd, proposals.lanes, proposals.colors.load(simd), radiance);
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
fn add_to_sums<S: Simd>(simd: S, proposals: &ProposalPacket, sums: &mut Vectors) {
    for (axis, channel) in proposals.colors.load(simd).into_iter().enumerate() {
        let (first, second) = channel.widen();
        for (half, added) in [first, second].into_iter().enumerate() {
            let (sum, lit) = (sums.axis(axis).load(simd, half), mask(simd, proposals.lanes, half));
            sums.axis_mut(axis).store(half, lit.select(sum + added, sum));
        }
    }
}

/// Adds the mean over an area light's samples.
fn add_means(sample: &Sample<'_>, light: &Light, buffers: &mut TileBuffers<'_>) {
    let TileBuffers { wave, surfaces, light_sums, radiance, .. } = buffers;
    let places = f64::from(light.places());
    dispatch!(sample.context.scene.simd.level(), simd => {
        for packet in 0..wave.count {
            let mut means = [f32x16::splat(simd, 0.0); 3];
            for (axis, mean) in means.iter_mut().enumerate() {
                let sum = light_sums[packet].axis(axis);
                *mean = (sum.load(simd, 0) / places).narrow(sum.load(simd, 1) / places);
            }
            add_light(simd, surfaces[packet].lanes, means, &mut radiance[packet]);
        }
    });
}
