//! A tile of the picture: one sample of each of its pixels, followed generation by generation.
//!
//! Camera rays are followed as they are made; what their surfaces send on is queued, and is the next generation. So a pixel's
//! rays are traced, and their light is added up, breadth first, and nothing recurses. Memory is kept from tile to tile.

use super::buffers::{Tile, TileBuffers};

use super::follow::{Follower, give_up};
use super::select::select;
use crate::trace::effects::Effects;
use crate::trace::light::{RenderContext, TreeRay};
use crate::trace::query::Intersector;

/// Follows one sample of every pixel of a tile: what it brings is in the buffers afterwards. Says whether that is all: once nobody
/// waits for it any more, it is left as it is. Every search looks for that, and so do pixels and rays that may take long.
pub(crate) fn render_sample<E: Effects>(
    context: &RenderContext<'_>,
    shapes: &impl Intersector,
    (tile, sample): (Tile, u32),
    buffers: &mut TileBuffers<'_>,
) -> bool {
    let mut generations = context.generations() - 1;
    let follower = Follower { context, shapes, tile, sample };
    buffers.begin::<E>(tile, context);
    let (columns, rows) = (tile.i..tile.i + tile.width, tile.j..tile.j + tile.height);
    let mut pixel = 0;
    if context.sampling.samples <= 1 {
        for j in rows {
            if buffers.scratch.search.is_cancelled() {
                return false;
            }
            for ray in context.pixel_centers.rays(columns.clone(), j) {
                if E::EXTRAS && buffers.scratch.search.is_cancelled() {
                    return false;
                }
                follower.start::<E>(ray, pixel, buffers);
                pixel += 1;
            }
        }
    } else {
        for (j, i) in rows.flat_map(|j| columns.clone().map(move |i| (j, i))) {
            if buffers.scratch.search.is_cancelled() {
                return false;
            }
            let ray = context.camera.spread_ray(context.sampling, i, j, sample);
            follower.start_apart::<E>(ray, pixel, buffers);
            pixel += 1;
        }
    }
    if !E::MIRRORS {
        return !buffers.scratch.search.is_cancelled();
    }
    while !buffers.next.is_empty() {
        select(context, generations, buffers);
        generations = generations.saturating_sub(1);
        let mut rays = std::mem::replace(&mut buffers.next, std::mem::take(&mut buffers.spare));
        for mut queued in rays.drain(..) {
            if buffers.scratch.search.is_cancelled() {
                return false;
            }
            let TreeRay { ray, state } = &mut queued.tree;
            follower.follow::<E>(ray, state, queued.pixel, buffers);
        }
        buffers.spare = rays;
    }
    give_up(context, buffers);
    !buffers.scratch.search.is_cancelled()
}
