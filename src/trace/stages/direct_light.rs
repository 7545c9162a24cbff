//! Light from sources, one after the other: what a light could add is proposed at all surface points of the wave, and what of
//! it comes through is added.

use fearless_simd::{dispatch, prelude::*};
use glam::DVec3;

use super::buffers::TileBuffers;
use super::shadows::shadows;
use super::tile::Sample;
use crate::trace::light::{LitPacket, SampleId, propose_lanes};
use crate::trace::math::{LANES, lanes, mask16};
use crate::trace::query::Intersector;
use crate::trace::scene::Light;

/// Adds what each light sends to the surface points of the wave, and on along the rays that found them.
pub(super) fn direct_light(sample: &Sample<'_>, shapes: &impl Intersector, buffers: &mut TileBuffers<'_>) {
    buffers.entered.direct_light += 1;
    let lights = &sample.context.lights;
    for (place, (index, light)) in lights.iter().enumerate() {
        if light.places() > 1 {
            buffers.light_sums.fill([DVec3::ZERO; LANES]);
        }
        for light_sample in 0..light.places() {
            // A light may have thousands of samples.
            if buffers.is_cancelled() {
                return;
            }
            propose_all(sample, (*index, light), light_sample, buffers);
            if sample.context.effects.shadows() {
                shadows(sample, shapes, (place, light), buffers);
            }
            add(sample, light, buffers);
        }
        if light.places() > 1 {
            add_means(light, buffers);
        }
    }
}

/// Proposes what one sample of a light could add at each surface point.
fn propose_all(
    sample: &Sample<'_>,
    light: (usize, &Light),
    light_sample: u32,
    buffers: &mut TileBuffers<'_>,
) {
    let context = sample.context;
    let TileBuffers { wave, hits, surfaces, answers, proposals, .. } = buffers;
    let (seed, of_pixel) = (context.sampling.seed, sample.index);
    dispatch!(context.scene.simd.level(), simd => {
        for packet in 0..wave.count {
            let pixels = &wave.pixels[packet];
            let asker = |lane: usize| SampleId { seed, pixel: sample.tile.pixel(pixels[lane]), sample: of_pixel };
            let lit = LitPacket {
                rays: &wave.rays[packet],
                paths: &wave.paths[packet],
                hits: &hits[packet],
                surfaces: &surfaces[packet],
                diffuse: &answers[packet].diffuse,
                shiny: answers[packet].shiny,
                clear: answers[packet].clear,
            };
            let scene = (context.scene, context.effects);
            propose_lanes(simd, scene, light, &lit, light_sample, asker, &mut proposals[packet]);
        }
    });
}

/// Adds what the shadows left of the proposals.
fn add(sample: &Sample<'_>, light: &Light, buffers: &mut TileBuffers<'_>) {
    let TileBuffers { wave, proposals, light_sums, radiance, .. } = buffers;
    if light.places() > 1 {
        for (proposals, sums) in proposals[..wave.count].iter().zip(light_sums.iter_mut()) {
            for lane in lanes(proposals.lanes) {
                sums[lane] += proposals.colors.get(lane).as_dvec3();
            }
        }
        return;
    }
    dispatch!(sample.context.scene.simd.level(), simd => {
        for (proposals, radiance) in proposals[..wave.count].iter().zip(radiance.iter_mut()) {
            let (mut light, added) = (radiance.load(simd), proposals.colors.load(simd));
            let lit = mask16(simd, proposals.lanes);
            for (light, added) in light.iter_mut().zip(added) {
                *light = lit.select(*light + added, *light);
            }
            radiance.store(light);
        }
    });
}

/// Adds the means over an extended light's samples.
fn add_means(light: &Light, buffers: &mut TileBuffers<'_>) {
    let TileBuffers { wave, surfaces, light_sums, radiance, .. } = buffers;
    for packet in 0..wave.count {
        for lane in lanes(surfaces[packet].lanes) {
            let mean = (light_sums[packet][lane] / f64::from(light.places())).as_vec3();
            let before = radiance[packet].get(lane);
            radiance[packet].set(lane, before + mean);
        }
    }
}
