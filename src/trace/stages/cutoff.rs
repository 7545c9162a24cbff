//! Selection of the rays of a bounce that are traced.

use fearless_simd::dispatch;

use super::buffers::TileBuffers;
use super::tile::TILE_PIXELS;
use crate::trace::math::{WHOLE, lanes};
use crate::trace::shading::{BranchPacket, LARGEST_TREE, RenderContext};

/// Makes the spawned rays the current bounce, without the rays that are not traced: those whose contribution is negligible, and those beyond
/// the last bounce or the maximum number of rays per sample. `bounces` is the number of bounces left, including this one; it is 0 if these
/// rays see the background untraced.
pub(super) fn drop_negligible(context: &RenderContext<'_>, bounces: u32, buffers: &mut TileBuffers<'_>) {
    std::mem::swap(&mut buffers.current, &mut buffers.next);
    buffers.next.clear();
    if context.branches() {
        select_trees(context, bounces, buffers);
    } else {
        select_chains(context, bounces, buffers);
    }
    buffers.scratch.search.ties.keep(buffers.current.ties_mut());
}

/// Selects the rays of samples whose paths do not branch: nothing is transparent, or transparent surfaces do not reflect as well. A sample has
/// a single ray per bounce.
fn select_chains(context: &RenderContext<'_>, bounces: u32, buffers: &mut TileBuffers<'_>) {
    let TileBuffers { current, beyond, rays_traced, trees_ended, .. } = buffers;
    let before = context.bounces() - bounces;
    let traced = bounces > 0 && before < LARGEST_TREE;
    for queued in current.packets_mut() {
        let BranchPacket { rays, paths } = &mut queued.branches;
        let cut = dispatch!(context.scene.simd.level(), simd => {
            context.radiance_bound.negligible(simd, &paths.throughputs, bounces) & rays.lanes
        });
        trees_ended.cutoff += u64::from(cut.count_ones());
        rays.keep(!cut);
        if traced {
            rays_traced.add_secondary(queued.mirrored, rays.lanes.count_ones());
        } else {
            queued.terminate(WHOLE, beyond);
        }
    }
}

/// Selects the rays of samples whose paths can branch into a reflected and a refracted ray.
fn select_trees(context: &RenderContext<'_>, bounces: u32, buffers: &mut TileBuffers<'_>) {
    let TileBuffers { current, beyond, trees, rays_traced, trees_ended, .. } = buffers;
    trees.weigh(context.scene.simd, &context.radiance_bound, current.packets(), bounces);
    trees.find_cut(current.packets());
    for (queued, cut) in current.packets_mut().iter_mut().zip(&trees.cut) {
        trees_ended.cutoff += u64::from(cut.count_ones());
        queued.branches.rays.keep(!cut);
        let mut traced = 0_u32;
        if bounces > 0 {
            for lane in lanes(queued.branches.rays.lanes) {
                let size = &mut trees.sizes[queued.slots[lane] as usize % TILE_PIXELS];
                if *size < LARGEST_TREE {
                    *size += 1;
                    traced |= 1 << lane;
                }
            }
        }
        rays_traced.add_secondary(queued.mirrored, traced.count_ones());
        queued.terminate(!traced, beyond);
    }
}
