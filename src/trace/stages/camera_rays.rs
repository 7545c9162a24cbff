//! Stage 1: a ray for every pixel of the tile.

use super::buffers::{QueuedRay, Tile, TileBuffers};
use crate::trace::branch::TreeRay;
use crate::trace::effects::Effects;
use crate::trace::media::Inside;
use crate::trace::moment::Moment;

pub(super) fn run<E: Effects>(moment: &Moment<'_>, (tile, sample): (Tile, u32), buffers: &mut TileBuffers) {
    let TileBuffers { rays, pixels, scratch, rays_traced, .. } = buffers;
    let mut pixel = 0;
    for j in tile.j..tile.j + tile.height {
        for i in tile.i..tile.i + tile.width {
            match moment.camera.sample_ray(moment.sampling, i, j, sample) {
                Some(ray) => {
                    let inside = if E::NESTING {
                        moment.inside(ray.origin(), &mut scratch.nesting)
                    } else {
                        Inside::NONE
                    };
                    rays.push(QueuedRay { tree: TreeRay::from_camera(ray, moment.scene, inside), pixel });
                }
                None => pixels[pixel as usize] = moment.nowhere(),
            }
            pixel += 1;
        }
    }
    rays_traced.camera += rays.len() as u64;
}
