//! Chains: the rays of samples of which none sends on more than one, as where nothing is clear. A sample has a single ray in each
//! generation, so that packets may go on in any order, whole ones as they are.

use fearless_simd::dispatch;

use super::buffers::TileBuffers;
use super::generation::{Generation, SentPacket, UntracedRay};
use super::wave::Wave;
use crate::trace::light::{BranchPacket, LARGEST_TREE, RenderContext};
use crate::trace::math::{LANES, lanes};

/// Keeps those rays of the current generation that are traced: not what could not show, and what is beyond the last generation or the
/// most rays of a sample. `generations` are left for them, 0 if they see the background untraced.
pub(super) fn select_chains(context: &RenderContext<'_>, generations: u32, buffers: &mut TileBuffers<'_>) {
    let TileBuffers { current, beyond, rays_traced, trees_ended, .. } = buffers;
    let before = context.generations() - generations;
    let traced = generations > 0 && before < LARGEST_TREE;
    for SentPacket { branches: BranchPacket { rays, paths }, pixels } in current.packets_mut() {
        let cut = dispatch!(context.scene.simd.level(), simd => {
            context.brightest.negligible(simd, &paths.throughputs, generations) & rays.lanes
        });
        trees_ended.cutoff += u64::from(cut.count_ones());
        rays.keep(!cut);
        if traced {
            rays_traced.reflection += u64::from(rays.lanes.count_ones());
            continue;
        }
        beyond.extend(lanes(rays.lanes).map(|lane| UntracedRay {
            direction: rays.directions.get(lane),
            throughput: paths.throughputs.get(lane),
            pixel: pixels[lane],
        }));
        rays.keep(0);
    }
}

/// Fills the wave with the rays of a generation, of which there are no more than there is room for, if there are any left. Packets with
/// few rays are put together.
pub(super) fn fill_with_chains(wave: &mut Wave, generation: &mut Generation) -> bool {
    /// Of fewer rays packets are not worth their way through the stages.
    const FEW: u32 = 12;
    if generation.is_empty() {
        return false;
    }
    wave.clear();
    let (mut shared, mut filled) = (0, LANES);
    for SentPacket { branches, pixels } in generation.packets() {
        let rays = branches.rays.lanes;
        if rays.count_ones() >= FEW {
            wave.add(branches, pixels);
            continue;
        }
        for lane in lanes(rays) {
            if filled == LANES {
                (shared, filled) = (wave.add_empty(), 0);
            }
            wave.copy((shared, filled), (branches, lane), pixels[lane]);
            filled += 1;
        }
    }
    generation.clear();
    wave.count > 0
}
