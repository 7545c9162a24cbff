//! What the wave brings to the tile's pixels.

use fearless_simd::{dispatch, f32x16, prelude::*};

use super::buffers::TileBuffers;
use super::tile::PACKETS;
use super::wave::Wave;
use crate::color::Rgb;
use crate::trace::light::{RenderContext, held};
use crate::trace::math::{Colors, LANES, bits16, lanes, mask16};

/// Adds the light at the end of each ray to its pixel, ray by ray in the order of the wave, and what happens to light on the
/// way to the ray's throughput.
pub(super) fn add_to_pixels(context: &RenderContext<'_>, buffers: &mut TileBuffers<'_>) {
    buffers.entered.sums += 1;
    dispatch!(context.scene.simd.level(), simd => {
        for packet in 0..buffers.wave.count {
            hold(simd, buffers.wave.rays[packet].lanes & buffers.hits[packet].ids.lanes(simd), &mut buffers.radiance[packet]);
            if context.effects.in_media() || context.effects.extras {
                let transmitted = pass(context, packet, buffers);
                add(simd, packet, &buffers.wave, &buffers.radiance, &mut buffers.pixels);
                let throughputs = &mut buffers.wave.paths[packet].throughputs;
                throughputs.store(product(throughputs.load(simd), transmitted.load(simd)));
            } else {
                add(simd, packet, &buffers.wave, &buffers.radiance, &mut buffers.pixels);
            }
        }
    });
}

/// Holds light that is too much for a number, in some lanes: see [`held`].
#[inline(always)]
fn hold<S: Simd>(simd: S, met: u32, radiance: &mut Colors) {
    let [red, green, blue] = radiance.load(simd);
    let little = (red + green + blue).simd_lt(f32x16::splat(simd, f32::INFINITY));
    for lane in lanes(met & !bits16(little)) {
        radiance.set(lane, held(radiance.get(lane)));
    }
}

/// Lets the light of a packet pass what is on the way. Returns what share of the light beyond comes through.
fn pass(context: &RenderContext<'_>, packet: usize, buffers: &mut TileBuffers<'_>) -> Colors {
    let TileBuffers { wave, radiance, lengths, scratch, .. } = buffers;
    let mut transmitted = Colors::splat(Rgb::ONE);
    for lane in lanes(wave.rays[packet].lanes) {
        let length = lengths[packet].get(lane);
        let state = wave.paths[packet].get(lane);
        let passage = state.passage(context.effects, context.scene, &scratch.media, length);
        radiance[packet].set(lane, passage.of(radiance[packet].get(lane)));
        transmitted.set(lane, passage.transmitted);
    }
    transmitted
}

/// Adds the light of a packet to its pixels.
#[inline(always)]
fn add<S: Simd>(
    simd: S,
    packet: usize,
    wave: &Wave,
    radiance: &[Colors; PACKETS],
    pixels: &mut [Colors; PACKETS],
) {
    let throughputs = wave.paths[packet].throughputs.load(simd);
    let light = product(throughputs, radiance[packet].load(simd));
    let rays = wave.rays[packet].lanes;
    if wave.in_place {
        let asked = mask16(simd, rays);
        let [red, green, blue] = pixels[packet].load(simd);
        pixels[packet].store([
            asked.select(red + light[0], red),
            asked.select(green + light[1], green),
            asked.select(blue + light[2], blue),
        ]);
        return;
    }
    let mut brought = Colors::splat(Rgb::ZERO);
    brought.store(light);
    for lane in lanes(rays) {
        let pixel = wave.pixels[packet][lane] as usize;
        let (packet, place) = (pixel / LANES % PACKETS, pixel % LANES);
        pixels[packet].set(place, pixels[packet].get(place) + brought.get(lane));
    }
}

#[inline(always)]
fn product<S: Simd>(a: [f32x16<S>; 3], b: [f32x16<S>; 3]) -> [f32x16<S>; 3] {
    [a[0] * b[0], a[1] * b[1], a[2] * b[2]]
}
