//! The last stage: which mirrored and refracted rays go on as the next generation.

use super::buffers::TileBuffers;
use super::wave::QueuedRay;
use crate::trace::light::{LARGEST_TREE, RenderContext, SecondaryRays, secondary_rays};
use crate::trace::math::lanes;

/// Queues the rays that the wave's surfaces send on.
pub(super) fn next_rays(context: &RenderContext<'_>, buffers: &mut TileBuffers<'_>) {
    buffers.entered.next_rays += 1;
    let TileBuffers { wave, hits, surfaces, answers, next, scratch, .. } = buffers;
    for packet in 0..wave.count {
        let surfaces = &surfaces[packet];
        for lane in lanes(answers[packet].continues & surfaces.lanes) {
            // Many solids may be entered at one point.
            if scratch.search.is_cancelled() {
                return;
            }
            let Some(point) = surfaces.get(lane, &hits[packet]) else { continue };
            let arrived = (wave.rays[packet].directions.get(lane), &wave.states[packet][lane]);
            let SecondaryRays { reflected, refracted } = secondary_rays(context, scratch, arrived, &point);
            let pixel = wave.pixels[packet][lane];
            for (tree, mirrored) in [(reflected, true), (refracted, false)] {
                next.extend(tree.map(|tree| QueuedRay { tree, pixel, mirrored, cut: false }));
            }
        }
    }
}

/// Selects the queued rays that go on, without what could not show, and what is beyond the last generation or the most rays of a
/// sample. `generations` are left for the queued rays, 0 if they see the background untraced.
pub(super) fn select(
    context: &RenderContext<'_>,
    generations: u32,
    selected: &mut Vec<QueuedRay>,
    buffers: &mut TileBuffers<'_>,
) {
    mark_negligible(context, generations, buffers);
    let TileBuffers { next, beyond, tree_sizes, rays_traced, trees_ended, scratch, .. } = buffers;
    for queued in next.drain(..) {
        let size = &mut tree_sizes[queued.pixel as usize];
        if queued.cut {
            trees_ended.cutoff += 1;
        } else if generations > 0 && *size < LARGEST_TREE {
            *size += 1;
            *(if queued.mirrored { &mut rays_traced.reflection } else { &mut rays_traced.refraction }) += 1;
            selected.push(queued);
        } else {
            beyond.push(queued);
        }
    }
    let left = selected.iter_mut().filter_map(|queued| queued.tree.ray.ties_mut());
    scratch.search.ties.keep(left);
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

/// Lets rays that are not traced see the background.
pub(super) fn give_up(context: &RenderContext<'_>, buffers: &mut TileBuffers<'_>) {
    let TileBuffers { beyond, pixels, trees_ended, .. } = buffers;
    for QueuedRay { tree, pixel, .. } in beyond.iter() {
        let background = context.scene.background.towards(tree.ray.direction());
        pixels[*pixel as usize] += tree.state.throughput * background;
    }
    trees_ended.depth += beyond.len() as u64;
    beyond.clear();
}
