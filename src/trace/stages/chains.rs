//! Chains: the rays of samples of which none sends on more than one, as where nothing is clear, or what is clear mirrors nothing besides.
//! A sample has a single ray in each generation.

use fearless_simd::dispatch;

use super::buffers::TileBuffers;
use crate::trace::light::{BranchPacket, LARGEST_TREE, RenderContext};
use crate::trace::math::WHOLE;

/// Keeps those rays of the current generation that are traced: not what could not show, and what is beyond the last generation or the
/// most rays of a sample. `generations` are left for them, 0 if they see the background untraced.
pub(super) fn select_chains(context: &RenderContext<'_>, generations: u32, buffers: &mut TileBuffers<'_>) {
    let TileBuffers { current, beyond, rays_traced, trees_ended, .. } = buffers;
    let before = context.generations() - generations;
    let traced = generations > 0 && before < LARGEST_TREE;
    for sent in current.packets_mut() {
        let BranchPacket { rays, paths } = &mut sent.branches;
        let cut = dispatch!(context.scene.simd.level(), simd => {
            context.brightest.negligible(simd, &paths.throughputs, generations) & rays.lanes
        });
        trees_ended.cutoff += u64::from(cut.count_ones());
        rays.keep(!cut);
        if traced {
            rays_traced.add_secondary(sent.mirrored, rays.lanes.count_ones());
        } else {
            sent.give_up(WHOLE, beyond);
        }
    }
}
