//! Stage 5: the rays that this wave's surfaces send on.

use super::buffers::{QueuedRay, TileBuffers};
use crate::color::Rgb;
use crate::trace::PreparedScene;
use crate::trace::shade::mirrored;

/// Makes the next wave out of this one's mirrors.
pub(super) fn run(scene: &PreparedScene, buffers: &mut TileBuffers) {
    let TileBuffers { rays, found, next, counts, .. } = buffers;
    next.clear();
    for point in found.iter() {
        let reflected = scene.material(point.surface.hit.slot).reflected;
        if reflected > 0.0 {
            let QueuedRay { ray, pixel, throughput } = &rays[point.ray];
            let throughput = throughput * reflected;
            if throughput != Rgb::ZERO
                && let Some(ray) = mirrored(ray, &point.surface)
            {
                next.push(QueuedRay { ray, pixel: *pixel, throughput });
            }
        }
    }
    counts.reflection += next.len() as u64;
    std::mem::swap(rays, next);
}

/// Beyond the last generation a ray sees the background.
pub(super) fn give_up(scene: &PreparedScene, buffers: &mut TileBuffers) {
    let TileBuffers { rays, pixels, counts, .. } = buffers;
    for queued in rays.iter() {
        pixels[queued.pixel] += queued.throughput * scene.background;
    }
    counts.reflection -= rays.len() as u64;
    rays.clear();
}
