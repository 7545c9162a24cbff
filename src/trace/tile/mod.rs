//! A tile of the picture: one sample of each of its pixels, followed generation by generation.
//!
//! Camera rays are followed as they are made; what their surfaces send on is queued, and is the next generation. So a pixel's
//! rays are traced, and their light is added up, breadth first, and nothing recurses. Memory is kept from tile to tile.

mod buffers;
mod follow;

pub(super) use buffers::{TILE, Tile, TileBuffers};

use super::branch::TreeRay;
use super::effects::Effects;
use super::geometry::Leaves;
use super::media::Inside;
use super::moment::Moment;
use follow::{Follower, give_up};

/// Follows one sample of every pixel of a tile: what it brings is in the buffers afterwards.
pub(super) fn render_sample<E: Effects>(
    moment: &Moment<'_>,
    leaves: &impl Leaves,
    (tile, sample): (Tile, u32),
    buffers: &mut TileBuffers,
) {
    let mut generations = moment.scene.depth - 1;
    let mut missing = 0;
    let follower = Follower { moment, leaves, tile, sample };
    buffers.begin::<E>(tile);
    let mut pixel = 0;
    let single = moment.sampling.samples <= 1;
    for j in tile.j..tile.j + tile.height {
        let row = moment.camera.row(j);
        for i in tile.i..tile.i + tile.width {
            let ray =
                if single { row.ray(i) } else { moment.camera.spread_ray(moment.sampling, i, j, sample) };
            if let Some(ray) = ray {
                let nesting = &mut buffers.scratch.nesting;
                let inside = if E::NESTING { moment.inside(ray.origin(), nesting) } else { Inside::NONE };
                let mut tree = TreeRay::from_camera(ray, moment.scene, inside);
                follower.follow::<E>(&mut tree, pixel, generations, buffers);
            } else {
                buffers.pixels[pixel as usize] = moment.nowhere();
                missing += 1;
            }
            pixel += 1;
        }
    }
    buffers.rays_traced.camera += buffers.pixels.len() as u64 - missing;
    if !E::MIRRORS {
        return;
    }
    while !buffers.next.is_empty() {
        generations -= 1;
        let mut rays = std::mem::replace(&mut buffers.next, std::mem::take(&mut buffers.spare));
        for mut queued in rays.drain(..) {
            follower.follow::<E>(&mut queued.tree, queued.pixel, generations, buffers);
        }
        buffers.spare = rays;
    }
    give_up(moment, buffers);
}
