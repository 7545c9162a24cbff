//! The first stage: a ray from the camera for each pixel.

use fearless_simd::{dispatch, prelude::*};

use super::buffers::TileBuffers;
use super::spread_tile::SpreadTile;
use super::tile::{PACKETS, PIXELS, Sample};
use super::wave::{Start, Wave};
use crate::trace::light::PathPacket;
use crate::trace::math::lanes;
use crate::trace::scene::Square;

/// Makes the wave of camera rays, in packets of four by four pixels. A camera that is not in a finite place has none: its pixels see
/// the background.
pub(super) fn camera_rays(sample: &Sample<'_>, buffers: &mut TileBuffers<'_>) {
    buffers.entered.camera_rays += 1;
    let Sample { context, tile, .. } = *sample;
    buffers.wave.count = PACKETS;
    // A single sample passes through the middle of a lens.
    let pinhole = context.sampling.samples <= 1 || !context.camera.has_lens();
    buffers.wave.start = if pinhole { Start::Eye(context.camera.position()) } else { Start::Lens };
    if context.sampling.samples > 1 {
        buffers.spread.find(context, tile, &mut buffers.scratch.search);
    }
    dispatch!(context.scene.simd.level(), simd => make_rays(simd, sample, &buffers.spread, &mut buffers.wave));
    for packet in 0..PACKETS {
        if buffers.is_cancelled() {
            // What is left of another wave is not to be followed.
            buffers.wave.count = packet;
            return;
        }
        if let Some(square) = tile.square(packet) {
            start(sample, packet, &square, buffers);
        }
    }
    buffers.rays_traced.camera += u64::from(buffers.wave.len());
}

/// Makes the rays through the centres of pixels, or those of one of several samples.
#[inline(always)]
fn make_rays<S: Simd>(simd: S, sample: &Sample<'_>, spread: &SpreadTile, wave: &mut Wave) {
    let Sample { context, tile, active, index } = *sample;
    for packet in 0..PACKETS {
        let rays = &mut wave.rays[packet];
        match tile.square(packet) {
            None => rays.clear(),
            Some(square) if context.sampling.samples <= 1 => context.pixel_centers.rays(simd, &square, rays),
            Some(square) => {
                let pixels = (&square, &spread.keys[packet]);
                context.camera.spread_rays(simd, context.sampling, pixels, index, rays);
            }
        }
        rays.lanes &= active.of_packet(packet);
    }
}

/// Notes for which pixels the rays of a packet are on their way, and what they carry.
fn start(sample: &Sample<'_>, packet: usize, square: &Square, buffers: &mut TileBuffers<'_>) {
    let TileBuffers { wave, scratch, pixels, .. } = buffers;
    let rays = &wave.rays[packet];
    wave.pixels[packet] = PIXELS[packet];
    for lane in lanes(square.lanes() & sample.active.of_packet(packet) & !rays.lanes) {
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
