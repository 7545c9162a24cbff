//! Attenuation of light by transparent shapes, packet by packet: computes [`filtered_along`] for each shadow ray.
//!
//! Without absorption, the attenuation is a product over all crossings and does not depend on their positions. With absorption, path lengths
//! inside solids matter. They follow from the crossings if a ray passes through solids one after the other, entering and leaving each of them,
//! or through a solid that contains one other solid, such as a bubble. Rays that start or end inside a solid, or that pass through several
//! solids inside another one, are computed one by one.

use fearless_simd::{dispatch, f32x16, prelude::*};

use super::buffers::TileBuffers;
use super::slots::Sample;
use crate::color::Rgb;
use crate::trace::intersect::{CrossedPacket, HitPacket};
use crate::trace::math::{lanes, mask16};
use crate::trace::scene::{PreparedLight, PreparedScene};
use crate::trace::shading::{LightSamplePacket, MediumStack, PathPacket, filtered_along, transmittances};

/// Attenuates the light along the shadow rays `lit` of a packet by the transparent shapes in `packet_scratch.crossed`.
pub(super) fn attenuate_packet(
    sample: &Sample<'_>,
    light: &PreparedLight,
    packet: usize,
    lit: u32,
    buffers: &mut TileBuffers<'_>,
) {
    let TileBuffers { wavefront, hits, surfaces, light_samples, scratch, packet_scratch, .. } = buffers;
    let scene = sample.context.shadow;
    let (hits, light_samples, paths) = (&hits[packet], &mut light_samples[packet], &wavefront.paths[packet]);
    let crossed = &mut packet_scratch.crossed;
    let (behind, absorbs) = (light_samples.from_behind & lit, scene.surfaces().absorbs);
    let inside = if absorbs { inside(paths, lit) } else { 0 };
    if crossed.is_empty() && behind | inside == 0 {
        return;
    }
    let escalated = dispatch!(scene.simd.level(), simd => {
        let escalated = if absorbs {
            find_gaps(simd, scene, crossed, behind | inside, lit)
        } else {
            cross_surfaces(simd, hits, (light, behind), crossed);
            0
        };
        // Light is multiplied in document order.
        crossed.sort_unstable_by_key(|crossed| scene.order().rank(crossed.id));
        multiply(simd, scene, crossed, lit & !escalated, light_samples);
        escalated
    });
    for lane in lanes(escalated) {
        let Some(point) = surfaces[packet].get(lane, hits) else { continue };
        let crossings = &mut scratch.search.crossings;
        crossings.clear();
        crossings.extend(crossed.iter().flat_map(|crossed| crossed.of(lane)).flatten());
        let (segment, seen) = (light_samples.segment(light, lane), (&point, paths.media[lane]));
        let share = filtered_along(scene, &segment, light.own_shape, seen, scratch);
        light_samples.colors.set(lane, light_samples.colors.get(lane) * share);
    }
}

/// Returns the lanes of points that are seen from inside transparent solids.
fn inside(paths: &PathPacket, needs_shadow_ray: u32) -> u32 {
    let inside = |lane: &usize| paths.media[*lane] != MediumStack::NONE;
    lanes(needs_shadow_ray).filter(inside).fold(0, |mask, lane| mask | 1 << lane)
}

/// Adds a crossing of the surfaces that light passes from behind, in the lanes `behind`, except for the light's own shape.
#[inline(always)]
fn cross_surfaces<S: Simd>(
    simd: S,
    hits: &HitPacket,
    (light, mut behind): (&PreparedLight, u32),
    crossed: &mut Vec<CrossedPacket>,
) {
    while let Some(id) = hits.ids.get(behind.trailing_zeros() as usize).filter(|_| behind != 0) {
        let surface = hits.ids.lanes_of(simd, id) & behind;
        behind &= !surface;
        if Some(id) != light.own_shape {
            crossed.push(CrossedPacket::once(id, surface));
        }
    }
}

/// Finds the gaps that nested solids leave in the paths through others. Returns the lanes of `lit` that have to be computed one by one: the
/// lanes `inside`, and rays that cross an absorbing solid and either start or end inside a solid, or do not pass through solids one after the
/// other with at most one gap each.
#[inline(always)]
fn find_gaps<S: Simd>(
    simd: S,
    scene: &PreparedScene,
    crossed: &mut [CrossedPacket],
    inside: u32,
    lit: u32,
) -> u32 {
    let absorbs = |crossed: &&CrossedPacket| {
        scene.material(crossed.id).refraction.is_some_and(|refraction| refraction.absorption != Rgb::ZERO)
    };
    let absorbed = crossed.iter().filter(absorbs).fold(0, |mask, crossed| mask | crossed.lanes);
    let mut beyond = crossed.iter().fold(0, |mask, crossed| mask | crossed.lanes & !crossed.leaving);
    for first in 1..crossed.len() {
        let (before, rest) = crossed.split_at_mut(first);
        let (one, others) = (&mut before[first - 1], rest);
        for other in others {
            let mut both = one.lanes & other.lanes & absorbed & !beyond;
            if both != 0 {
                both &= !one.apart(simd, other);
                both &= !one.leave_gaps(simd, other, both);
                beyond |= both & !other.leave_gaps(simd, one, both);
            }
        }
    }
    (absorbed & beyond | inside) & lit
}

/// Multiplies the light in the lanes `lit` by the attenuation of shapes, which are given in document order.
#[inline(always)]
fn multiply<S: Simd>(
    simd: S,
    scene: &PreparedScene,
    crossed: &[CrossedPacket],
    lit: u32,
    light_samples: &mut LightSamplePacket,
) {
    let mut share = [f32x16::splat(simd, 1.0); 3];
    for crossed in crossed.iter().filter(|crossed| crossed.lanes & lit != 0) {
        let Some(refraction) = scene.material(crossed.id).refraction else { continue };
        let (once, twice) = (mask16(simd, crossed.lanes & lit), mask16(simd, crossed.leaving & lit));
        for channel in &mut share {
            *channel = once.select(*channel * refraction.transmitted, *channel);
            *channel = twice.select(*channel * refraction.transmitted, *channel);
        }
        if refraction.absorption != Rgb::ZERO {
            let lengths = crossed.lengths(simd, &light_samples.rays.directions);
            let absorbed = transmittances(simd, refraction.absorption, &lengths);
            for (channel, absorbed) in share.iter_mut().zip(absorbed) {
                *channel = once.select(*channel * absorbed, *channel);
            }
        }
    }
    let [red, green, blue] = light_samples.colors.load(simd);
    light_samples.colors.store([red * share[0], green * share[1], blue * share[2]]);
}
