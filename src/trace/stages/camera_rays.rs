//! The first stage: a ray from the camera for each pixel.

use super::buffers::{QueuedRay, TileBuffers};
use super::tile::Sample;
use crate::trace::light::{MediumStack, PathState, TreeRay};
use crate::trace::rays::Ray;

/// Makes the wave of camera rays. A camera that is not in a finite place has none: its pixels see the background.
pub(super) fn camera_rays(sample: &Sample<'_>, buffers: &mut TileBuffers<'_>) {
    buffers.entered.camera_rays += 1;
    let Sample { context, tile, index } = *sample;
    let (columns, rows) = (tile.i..tile.i + tile.width, tile.j..tile.j + tile.height);
    let one_each = context.sampling.samples <= 1;
    let mut pixel = 0;
    for j in rows {
        if buffers.is_cancelled() {
            return;
        }
        if one_each {
            for ray in context.pixel_centers.rays(columns.clone(), j) {
                start(sample, ray, pixel, buffers);
                pixel += 1;
            }
        } else {
            for i in columns.clone() {
                let ray = context.camera.spread_ray(context.sampling, i, j, index);
                start(sample, ray, pixel, buffers);
                pixel += 1;
            }
        }
    }
    buffers.rays_traced.camera += buffers.wave.len() as u64;
}

#[inline(always)]
fn start(sample: &Sample<'_>, ray: Option<Ray>, pixel: u32, buffers: &mut TileBuffers<'_>) {
    let Some(ray) = ray else {
        buffers.pixels[pixel as usize] = sample.context.nowhere();
        return;
    };
    let media = &mut buffers.scratch.media;
    let medium = if sample.context.effects.in_media() {
        sample.context.medium(ray.origin(), media)
    } else {
        MediumStack::NONE
    };
    let tree = TreeRay { ray, state: PathState::at_camera(medium) };
    let part = sample.tile.part(pixel);
    buffers.wave.push(QueuedRay { tree, pixel, part, mirrored: false, cut: false });
}
