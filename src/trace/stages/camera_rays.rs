//! The first stage: a ray from the camera for each pixel.

use fearless_simd::{dispatch, prelude::*};

use super::buffers::TileBuffers;
use super::tile::{PACKETS, Sample, Square};
use super::wave::Wave;
use crate::trace::light::{MediumStack, PathState};
use crate::trace::math::{LANES, lanes};

/// Makes the wave of camera rays, in packets of four by four pixels. A camera that is not in a finite place has none: its pixels see
/// the background.
pub(super) fn camera_rays(sample: &Sample<'_>, buffers: &mut TileBuffers<'_>) {
    buffers.entered.camera_rays += 1;
    let Sample { context, tile, index } = *sample;
    let centers = context.sampling.samples <= 1;
    buffers.wave.count = PACKETS;
    // A single sample passes through the middle of a lens.
    buffers.wave.origin = (centers || !context.camera.has_lens()).then(|| context.camera.position());
    if centers {
        dispatch!(context.scene.simd.level(), simd => center_rays(simd, sample, &mut buffers.wave));
    }
    for packet in 0..PACKETS {
        if buffers.is_cancelled() {
            return;
        }
        let Some(square) = tile.square(packet) else {
            buffers.wave.rays[packet].clear();
            continue;
        };
        if !centers {
            let rays = &mut buffers.wave.rays[packet];
            rays.clear();
            for lane in 0..LANES {
                let Some((i, j)) = square.pixel(lane) else { continue };
                if let Some(ray) = context.camera.spread_ray(context.sampling, i, j, index) {
                    rays.set(lane, &ray);
                }
            }
        }
        start(sample, packet, &square, buffers);
    }
    buffers.rays_traced.camera += u64::from(buffers.wave.len());
}

/// Makes the rays through the centres of pixels.
#[inline(always)]
fn center_rays<S: Simd>(simd: S, sample: &Sample<'_>, wave: &mut Wave) {
    for packet in 0..PACKETS {
        if let Some(Square { first, size }) = sample.tile.square(packet) {
            sample.context.pixel_centers.rays(simd, first, size, &mut wave.rays[packet]);
        }
    }
}

/// Notes for which pixels the rays of a packet are on their way, and what they carry.
fn start(sample: &Sample<'_>, packet: usize, square: &Square, buffers: &mut TileBuffers<'_>) {
    let TileBuffers { wave, scratch, pixels, .. } = buffers;
    let rays = &wave.rays[packet];
    for lane in 0..LANES {
        let Some(place) = square.pixel(lane) else { continue };
        let pixel = sample.tile.index(place);
        wave.pixels[packet][lane] = pixel;
        if rays.lanes & (1 << lane) == 0 {
            pixels[pixel as usize] = sample.context.nowhere();
        }
    }
    let states = &mut wave.states[packet];
    *states = [PathState::at_camera(MediumStack::NONE); LANES];
    if sample.context.effects.in_media() {
        for lane in lanes(rays.lanes) {
            let medium = sample.context.medium(rays.origins.get(lane), &mut scratch.media);
            states[lane] = PathState::at_camera(medium);
        }
    }
}
