//! The first stage: a camera ray for each slot.

use fearless_simd::{dispatch, prelude::*};

use super::buffers::TileBuffers;
use super::slots::Sample;
use super::spread_tile::SpreadTile;
use super::tile::{PACKETS, PIXELS};
use super::wave::{Start, Wave};
use crate::trace::light::PathPacket;
use crate::trace::math::lanes;

/// Makes the wave of camera rays. A camera that is not in a finite place has none: its pixels see
/// the background.
pub(super) fn camera_rays(sample: &Sample<'_>, buffers: &mut TileBuffers<'_>) {
    buffers.entered.camera_rays += 1;
    let Sample { context, tile, slots } = *sample;
    let TileBuffers { wave, spread, scratch, .. } = &mut *buffers;
    // A single sample passes through the middle of a lens.
    let pinhole = context.sampling.samples <= 1 || !context.camera.has_lens();
    wave.start = if pinhole { Start::Eye(context.camera.position()) } else { Start::Lens };
    if context.sampling.samples > 1 {
        spread.find(context, (tile, slots), &mut scratch.search);
    }
    (wave.count, *wave.slots) = (slots.count, PIXELS);
    dispatch!(context.scene.simd.level(), simd => make_rays(simd, sample, spread, wave));
    for packet in 0..buffers.wave.count {
        if buffers.is_cancelled() {
            // What is left of another wave is not to be followed.
            buffers.wave.count = packet;
            return;
        }
        start(sample, packet, buffers);
    }
    buffers.rays_traced.camera += u64::from(buffers.wave.len());
}

/// Makes the rays through the centres of pixels, or those of one of several samples. Packets beyond the wave's have none.
#[inline(always)]
fn make_rays<S: Simd>(simd: S, sample: &Sample<'_>, spread: &SpreadTile, wave: &mut Wave) {
    let Sample { context, tile, slots } = *sample;
    for packet in 0..PACKETS {
        let rays = &mut wave.rays[packet];
        if context.sampling.samples > 1 {
            context.camera.spread_rays(
                simd,
                context.sampling,
                &spread.keys[packet],
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

/// Notes what the rays of a packet carry, and what pixels see that have none.
fn start(sample: &Sample<'_>, packet: usize, buffers: &mut TileBuffers<'_>) {
    let TileBuffers { wave, scratch, pixels, .. } = buffers;
    let rays = &wave.rays[packet];
    for lane in lanes(sample.slots.lanes[packet] & !rays.lanes) {
        pixels[packet].set(lane, sample.context.nowhere());
    }
    let paths = &mut wave.paths[packet];
    *paths = PathPacket::AT_CAMERA;
    if sample.context.may_start_inside() {
        for lane in lanes(rays.lanes) {
            paths.media[lane] = sample.context.medium(rays.origins.get(lane), &mut scratch.media);
        }
    }
}
