//! Trees: the rays of samples of which one may send on two, a mirrored and a refracted one. The light of a sample's rays is added up in
//! the order of the queue, and what is cut of a generation depends on all its rays.

use super::buffers::TileBuffers;
use super::generation::{Generation, QueuedRay, UntracedRay};
use super::wave::{LONGEST_WAVE, Wave};
use crate::trace::light::{BranchPacket, LARGEST_TREE, RenderContext};
use crate::trace::math::LANES;

/// Keeps those rays of the current generation that are traced: not what could not show, and what is beyond the last generation or the
/// most rays of a sample. `generations` are left for them, 0 if they see the background untraced.
pub(super) fn select_trees(context: &RenderContext<'_>, generations: u32, buffers: &mut TileBuffers<'_>) {
    mark_negligible(context, generations, buffers);
    let TileBuffers { current, beyond, tree_sizes, rays_traced, trees_ended, .. } = buffers;
    let mut queue = std::mem::take(&mut current.queue);
    queue.retain(|queued| {
        let size = &mut tree_sizes[queued.pixel as usize];
        if queued.cut {
            trees_ended.cutoff += 1;
            return false;
        }
        if generations > 0 && *size < LARGEST_TREE {
            *size += 1;
            *(if queued.mirrored { &mut rays_traced.reflection } else { &mut rays_traced.refraction }) += 1;
            return true;
        }
        let BranchPacket { rays, paths } = current.packet(queued.packet);
        beyond.push(UntracedRay {
            direction: rays.directions.get(queued.lane),
            throughput: paths.throughputs.get(queued.lane),
            pixel: queued.pixel,
        });
        false
    });
    current.queue = queue;
}

/// Marks what is cut, pixel by pixel: the queue is in their order.
fn mark_negligible(context: &RenderContext<'_>, generations: u32, buffers: &mut TileBuffers) {
    let TileBuffers { current, budgets, weighed, .. } = buffers;
    let mut queue = std::mem::take(&mut current.queue);
    let most = |queued: &QueuedRay| {
        let throughput = current.packet(queued.packet).paths.throughputs.get(queued.lane);
        context.brightest.most(throughput, generations)
    };
    for rays in queue.chunk_by_mut(|one, other| one.pixel == other.pixel) {
        let budget = &mut budgets[rays[0].pixel as usize];
        if let [ray] = rays {
            ray.cut = budget.cut_one(most(ray));
            continue;
        }
        weighed.clear();
        weighed.extend(rays.iter().enumerate().map(|(index, queued)| (most(queued), index)));
        let count = budget.cut(weighed);
        for (_, index) in &weighed[..count] {
            rays[*index].cut = true;
        }
    }
    current.queue = queue;
}

/// Fills the wave with the next rays of a generation's queue, as many as there is room for, in their order, if there are any left.
pub(super) fn fill_with_trees(wave: &mut Wave, generation: &mut Generation) -> bool {
    let (start, end) = (generation.taken, generation.queue.len().min(generation.taken + LONGEST_WAVE));
    if start == end {
        return false;
    }
    wave.clear();
    for queued in generation.queue[start..end].chunks(LANES) {
        let packet = wave.add_empty();
        for (lane, ray) in queued.iter().enumerate() {
            wave.copy((packet, lane), (generation.packet(ray.packet), ray.lane), ray.pixel);
        }
    }
    generation.taken = end;
    true
}
