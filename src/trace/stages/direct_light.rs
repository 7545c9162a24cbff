//! Light from sources, one after the other: what a light could add is proposed at all surface points of the wave, and what of
//! it comes through is added.

use glam::DVec3;

use super::buffers::{FoundSurface, QueuedRay, TileBuffers};
use super::shadows::shadows;
use super::tile::Sample;
use crate::trace::light::{LitPoint, Proposal, SampleId, propose};
use crate::trace::query::Intersector;
use crate::trace::scene::Light;

/// Adds what each light sends to the surface points of the wave, and on along the rays that found them.
pub(super) fn direct_light(sample: &Sample<'_>, shapes: &impl Intersector, buffers: &mut TileBuffers<'_>) {
    buffers.entered.direct_light += 1;
    let lights = &sample.context.lights;
    for (place, (index, light)) in lights.iter().enumerate() {
        if light.places() > 1 {
            buffers.light_sums.clear();
            buffers.light_sums.resize(buffers.surfaces.len(), DVec3::ZERO);
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
            add(light, buffers);
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
    let effects = sample.context.effects;
    let TileBuffers { wave, surfaces, proposals, .. } = buffers;
    proposals.clear();
    for (at, surface) in (0..).zip(surfaces.iter()) {
        let proposal = propose(effects, light, &lit_point(sample, wave, surface), light_sample);
        proposals.extend(proposal.map(|proposal| (at, proposal)));
    }
}

#[inline(always)]
fn lit_point<'a>(sample: &Sample<'a>, wave: &'a [QueuedRay], surface: &'a FoundSurface) -> LitPoint<'a> {
    let QueuedRay { tree, pixel, .. } = &wave[surface.ray as usize];
    // Only lights with a size ask for it.
    let pixel = if sample.context.effects.extras { sample.tile.pixel(*pixel) } else { (0, 0) };
    LitPoint {
        ray: &tree.ray,
        state: &tree.state,
        surface: &surface.point,
        material: sample.context.scene.material(surface.point.hit.id),
        diffuse: surface.diffuse,
        asker: SampleId { seed: sample.context.sampling.seed, pixel, sample: sample.index },
        normal: surface.point.facing_normal(),
    }
}

/// Adds what the shadows left of the proposals.
fn add(light: &Light, buffers: &mut TileBuffers<'_>) {
    let TileBuffers { surfaces, proposals, light_sums, radiance, .. } = buffers;
    for (at, Proposal { color, .. }) in proposals.iter() {
        if light.places() > 1 {
            light_sums[*at as usize] += color.as_dvec3();
        } else {
            radiance[surfaces[*at as usize].ray as usize] += *color;
        }
    }
}

/// Adds the means over an extended light's samples.
fn add_means(light: &Light, buffers: &mut TileBuffers<'_>) {
    let TileBuffers { surfaces, light_sums, radiance, .. } = buffers;
    for (surface, sum) in surfaces.iter().zip(light_sums.iter()) {
        radiance[surface.ray as usize] += (*sum / f64::from(light.places())).as_vec3();
    }
}
