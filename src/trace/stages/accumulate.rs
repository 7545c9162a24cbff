//! Accumulation of the wavefront's radiance in the tile's pixels.

use fearless_simd::{dispatch, f32x16, prelude::*};

use super::buffers::TileBuffers;
use super::tile::PACKETS;
use super::wavefront::Wavefront;
use crate::color::Rgb;
use crate::trace::math::{
    Colors, LANES, Numbers, bits, bits16, half_lanes, half_of, lanes, mask, mask16, splat,
};
use crate::trace::query::{HitPacket, SurfacePacket};
use crate::trace::rays::RayPacket;
use crate::trace::shading::{Absorbers, PassageLanes, RenderContext, held};

/// Adds the radiance of each ray to its pixel, ray by ray in the order of the wavefront. Multiplies the throughput of each ray by the
/// transmittance along it.
pub(super) fn add_to_pixels(context: &RenderContext<'_>, buffers: &mut TileBuffers<'_>) {
    buffers.stage_runs.sums += 1;
    dispatch!(context.scene.simd.level(), simd => {
        for packet in 0..buffers.wavefront.count {
            hold(simd, buffers.wavefront.rays[packet].lanes & buffers.hits[packet].ids.lanes(simd), &mut buffers.radiance[packet]);
            let passage = pass(simd, context, packet, buffers);
            add(simd, packet, &buffers.wavefront, &buffers.radiance, &mut buffers.pixels);
            if let Some(transmitted) = passage {
                let throughputs = &mut buffers.wavefront.paths[packet].throughputs;
                throughputs.store(product(throughputs.load(simd), transmitted));
            }
        }
    });
}

/// Clamps radiance that overflows, in the lanes `met`: see [`held`].
#[inline(always)]
fn hold<S: Simd>(simd: S, met: u32, radiance: &mut Colors) {
    let [red, green, blue] = radiance.load(simd);
    let little = (red + green + blue).simd_lt(f32x16::splat(simd, f32::INFINITY));
    for lane in lanes(met & !bits16(little)) {
        radiance.set(lane, held(radiance.get(lane)));
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
    let PassageLanes { transmitted, added } = absorbers.over(simd, &scene.fog, &lengths);
    let (asked, one) = (mask16(simd, absorbers.lanes), f32x16::splat(simd, 1.0));
    let (mut light, mut share) = (radiance[packet].load(simd), [one; 3]);
    for channel in 0..3 {
        let passed = transmitted[channel] * light[channel] + added[channel];
        light[channel] = asked.select(passed, light[channel]);
        share[channel] = asked.select(transmitted[channel], one);
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
    asked: u32,
) -> Numbers {
    let mut lengths = Numbers::splat(f64::INFINITY);
    let mut unusual = 0;
    for half in 0..2 {
        let met = asked & surfaces.lanes;
        if half_of(met, half) == 0 {
            continue;
        }
        let (distance, usual) = surfaces.distances(simd, rays, half);
        unusual |= met & half_lanes(half) & !bits(usual, half);
        let met = mask(simd, met, half);
        lengths.store(half, met.select(distance, splat(simd, f64::INFINITY)));
    }
    for lane in lanes(unusual) {
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
    if let Some(home) = wavefront.home(packet) {
        let asked = mask16(simd, rays);
        let [red, green, blue] = pixels[home].load(simd);
        pixels[home].store([
            asked.select(red + light[0], red),
            asked.select(green + light[1], green),
            asked.select(blue + light[2], blue),
        ]);
        return;
    }
    let mut brought = Colors::splat(Rgb::ZERO);
    brought.store(light);
    for lane in lanes(rays) {
        let slot = wavefront.slots[packet][lane] as usize;
        let (packet, place) = (slot / LANES % PACKETS, slot % LANES);
        pixels[packet].set(place, pixels[packet].get(place) + brought.get(lane));
    }
}

#[inline(always)]
fn product<S: Simd>(a: [f32x16<S>; 3], b: [f32x16<S>; 3]) -> [f32x16<S>; 3] {
    [a[0] * b[0], a[1] * b[1], a[2] * b[2]]
}
