//! The first stage: generates a camera ray for each slot.

use fearless_simd::{dispatch, prelude::*};

use super::buffers::TileBuffers;
use super::slots::Sample;
use super::tile::{PACKETS, PIXELS};
use super::tile_sampler::TileSampler;
use super::wavefront::{RayOrigin, Wavefront};
use crate::trace::math::lanes;
use crate::trace::shading::PathPacket;

/// Generates the wavefront of camera rays. A camera at a non-finite position has no rays: its pixels see the background.
pub(super) fn camera_rays(sample: &Sample<'_>, buffers: &mut TileBuffers<'_>) {
    buffers.stage_runs.camera_rays += 1;
    let Sample { context, tile, slots } = *sample;
    let TileBuffers { wavefront, spread, scratch, .. } = &mut *buffers;
    // A single sample passes through the centre of the lens.
    let pinhole = context.sampling.samples <= 1 || !context.camera.has_lens();
    wavefront.start = if pinhole { RayOrigin::Eye(context.camera.position()) } else { RayOrigin::Lens };
    if context.sampling.samples > 1 {
        spread.find(context, (tile, slots), &mut scratch.search);
    }
    (wavefront.count, *wavefront.slots) = (slots.count, PIXELS);
    dispatch!(context.scene.simd.level(), simd => make_rays(simd, sample, spread, wavefront));
    for packet in 0..buffers.wavefront.count {
        if buffers.is_cancelled() {
            // The paths of the remaining packets belong to another wavefront: these packets must not be traced.
            buffers.wavefront.count = packet;
            return;
        }
        start(sample, packet, buffers);
    }
    buffers.rays_traced.camera += u64::from(buffers.wavefront.len());
}

/// Generates the rays through pixel centres, or the rays of the slots' samples if there are several per pixel. Packets beyond the wavefront's
/// count get no rays.
#[inline(always)]
fn make_rays<S: Simd>(simd: S, sample: &Sample<'_>, spread: &TileSampler, wavefront: &mut Wavefront) {
    let Sample { context, tile, slots } = *sample;
    for packet in 0..PACKETS {
        let rays = &mut wavefront.rays[packet];
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

/// Initializes the paths of a packet's rays, and sets pixels without a ray to the background.
fn start(sample: &Sample<'_>, packet: usize, buffers: &mut TileBuffers<'_>) {
    let TileBuffers { wavefront, scratch, pixels, .. } = buffers;
    let rays = &wavefront.rays[packet];
    for lane in lanes(sample.slots.lanes[packet] & !rays.lanes) {
        pixels[packet].set(lane, sample.context.nowhere());
    }
    let paths = &mut wavefront.paths[packet];
    *paths = PathPacket::AT_CAMERA;
    if sample.context.may_start_inside() {
        for lane in lanes(rays.lanes) {
            paths.media[lane] = sample.context.medium(rays.origins.get(lane), &mut scratch.media);
        }
    }
}
