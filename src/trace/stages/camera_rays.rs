//! Stage 1: a ray for every pixel of the tile.

use super::buffers::{QueuedRay, Tile, TileBuffers};
use crate::color::Rgb;
use crate::trace::{Camera, PreparedScene, Sampling};

pub(super) fn run(
    scene: &PreparedScene,
    camera: &Camera,
    sampling: Sampling,
    (tile, sample): (Tile, u32),
    buffers: &mut TileBuffers,
) {
    let mut pixel = 0;
    for j in tile.j..tile.j + tile.height {
        for i in tile.i..tile.i + tile.width {
            match camera.sample_ray(sampling, i, j, sample) {
                Some(ray) => buffers.rays.push(QueuedRay { ray, pixel, throughput: Rgb::ONE }),
                None => buffers.pixels[pixel] = scene.background,
            }
            pixel += 1;
        }
    }
    buffers.counts.camera += buffers.rays.len() as u64;
}
