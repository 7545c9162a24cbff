//! A tile of the picture: one sample of each of its pixels, followed generation by generation.
//!
//! Camera rays are followed as they are made; what their surfaces send on is queued, and is the next generation. So a pixel's
//! rays are traced, and their light is added up, breadth first, and nothing recurses. Memory is kept from tile to tile.

mod buffers;
mod follow;

use std::sync::atomic::AtomicBool;

pub(super) use buffers::{TILE, Tile, TileBuffers};

use super::branch::TreeRay;
use super::effects::Effects;
use super::geometry::Leaves;
use super::moment::Moment;
use follow::{Follower, give_up};

/// Follows one sample of every pixel of a tile: what it brings is in the buffers afterwards. Says whether that is all, or
/// `cancelled` became true on the way. Where a single ray may take long, every ray asks.
pub(super) fn render_sample<E: Effects>(
    moment: &Moment<'_>,
    leaves: &impl Leaves,
    (tile, sample): (Tile, u32),
    buffers: &mut TileBuffers,
    cancelled: &AtomicBool,
) -> bool {
    let mut generations = moment.scene.depth - 1;
    let follower = Follower { moment, leaves, tile, sample, cancelled };
    buffers.begin::<E>(tile, moment.lights.len());
    let (columns, rows) = (tile.i..tile.i + tile.width, tile.j..tile.j + tile.height);
    let mut pixel = 0;
    if moment.sampling.samples <= 1 {
        for j in rows {
            if follower.is_ended() {
                return false;
            }
            for ray in moment.pixel_centers.rays(columns.clone(), j) {
                if E::EXTRAS && follower.is_ended() {
                    return false;
                }
                follower.start::<E>(ray, pixel, generations, buffers);
                pixel += 1;
            }
        }
    } else {
        for (j, i) in rows.flat_map(|j| columns.clone().map(move |i| (j, i))) {
            if follower.is_ended() {
                return false;
            }
            let ray = moment.camera.spread_ray(moment.sampling, i, j, sample);
            follower.start_apart::<E>(ray, pixel, generations, buffers);
            pixel += 1;
        }
    }
    if !E::MIRRORS {
        return !follower.is_ended();
    }
    while !buffers.next.is_empty() {
        generations -= 1;
        let mut rays = std::mem::replace(&mut buffers.next, std::mem::take(&mut buffers.spare));
        for mut queued in rays.drain(..) {
            if follower.is_ended() {
                return false;
            }
            let TreeRay { ray, state } = &mut queued.tree;
            follower.follow::<E>(ray, state, queued.pixel, generations, buffers);
        }
        buffers.spare = rays;
    }
    give_up(moment, buffers);
    !follower.is_ended()
}
