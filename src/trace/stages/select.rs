//! Which of the queued rays are followed.

use super::buffers::{QueuedRay, TileBuffers};
use crate::trace::light::{LARGEST_TREE, RenderContext};

/// Takes those out of the queue that are not: what could not show, and what is beyond the last generation or the most rays of a
/// sample. `generations` are left for the queued rays, 0 if they see the background untraced.
pub(crate) fn select(context: &RenderContext<'_>, generations: u32, buffers: &mut TileBuffers) {
    mark_negligible(context, generations, buffers);
    let TileBuffers { next, spare, beyond, tree_sizes, rays_traced, trees_ended, .. } = buffers;
    spare.clear();
    for queued in next.drain(..) {
        let size = &mut tree_sizes[queued.pixel as usize];
        if queued.cut {
            trees_ended.cutoff += 1;
        } else if generations > 0 && *size < LARGEST_TREE {
            *size += 1;
            *(if queued.mirrored { &mut rays_traced.reflection } else { &mut rays_traced.refraction }) += 1;
            spare.push(queued);
        } else {
            beyond.push(queued);
        }
    }
    std::mem::swap(next, spare);
}

/// Marks what is cut, pixel by pixel: the queue is in their order.
fn mark_negligible(context: &RenderContext<'_>, generations: u32, buffers: &mut TileBuffers) {
    let TileBuffers { next, budgets, weighed, .. } = buffers;
    for rays in next.chunk_by_mut(|one, other| one.pixel == other.pixel) {
        weighed.clear();
        weighed.extend(rays.iter().enumerate().map(|(index, QueuedRay { tree, .. })| {
            (context.brightest.most(tree.state.throughput, generations), index)
        }));
        let count = budgets[rays[0].pixel as usize].cut(weighed);
        for (_, index) in &weighed[..count] {
            rays[*index].cut = true;
        }
    }
}
