//! The last stage: which mirrored and refracted rays go on as the next generation.

use fearless_simd::dispatch;

use super::buffers::TileBuffers;
use super::generation::{QueuedRay, UntracedRay};
use crate::trace::light::{BranchPacket, LARGEST_TREE, RenderContext, branch_lanes, secondary_rays};
use crate::trace::math::{LANES, lanes};

/// Queues the rays that the wave's surfaces send on.
pub(super) fn next_rays(context: &RenderContext<'_>, buffers: &mut TileBuffers<'_>) {
    buffers.entered.next_rays += 1;
    let TileBuffers { wave, hits, surfaces, answers, next, scratch, .. } = buffers;
    let scene = context.scene;
    for packet in 0..wave.count {
        let (hits, surfaces) = (&hits[packet], &surfaces[packet]);
        let continues = answers[packet].continues & surfaces.lanes;
        if continues == 0 {
            continue;
        }
        let clear = if context.effects.media() { continues & answers[packet].clear } else { 0 };
        let mirrored = next.add();
        let refracted = (clear != 0).then(|| next.add());
        let (rays, paths) = (&wave.rays[packet], &wave.paths[packet]);
        let media = (scene, &mut scratch.media);
        let branches = next.branches_mut(mirrored, refracted);
        let unusual = dispatch!(scene.simd.level(), simd => {
            branch_lanes(simd, media, (rays, paths), (hits, surfaces), (continues, clear), branches)
        });
        for lane in lanes(unusual) {
            // Many solids may be entered at one point.
            if scratch.search.is_cancelled() {
                return;
            }
            let Some(point) = surfaces.get(lane, hits) else { continue };
            let arrived = (rays.directions.get(lane), &paths.get(lane));
            let sent = secondary_rays(context, scratch, arrived, &point);
            let (mirrored, refracted) = next.branches_mut(mirrored, refracted);
            if let Some(ray) = sent.reflected {
                mirrored.set(lane, &ray);
            }
            if let (Some(ray), Some(refracted)) = (sent.refracted, refracted) {
                refracted.set(lane, &ray);
            }
        }
        for lane in lanes(continues) {
            let pixel = wave.pixels[packet][lane];
            next.queue(mirrored, lane, pixel, true);
            if let Some(refracted) = refracted {
                next.queue(refracted, lane, pixel, false);
            }
        }
    }
}

/// Makes the rays that were sent on the current generation, without what could not show, and what is beyond the last generation or
/// the most rays of a sample. `generations` are left for them, 0 if they see the background untraced.
pub(super) fn select(context: &RenderContext<'_>, generations: u32, buffers: &mut TileBuffers<'_>) {
    std::mem::swap(&mut buffers.current, &mut buffers.next);
    buffers.next.clear();
    mark_negligible(context, generations, buffers);
    let TileBuffers { current, beyond, tree_sizes, rays_traced, trees_ended, scratch, .. } = buffers;
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
        let direction = rays.directions.get(queued.lane);
        beyond.push(UntracedRay {
            direction,
            throughput: paths.throughputs.get(queued.lane),
            pixel: queued.pixel,
        });
        false
    });
    current.queue = queue;
    if !context.effects.media() {
        current.whole_packets_first();
    }
    scratch.search.ties.keep(current.ties_mut());
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

/// Lets rays that are not traced see the background.
pub(super) fn give_up(context: &RenderContext<'_>, buffers: &mut TileBuffers<'_>) {
    let TileBuffers { beyond, pixels, trees_ended, .. } = buffers;
    for UntracedRay { direction, throughput, pixel } in beyond.iter() {
        let light = *throughput * context.scene.background.towards(*direction);
        let (packet, lane) = (*pixel as usize / LANES, *pixel as usize % LANES);
        pixels[packet].set(lane, pixels[packet].get(lane) + light);
    }
    trees_ended.depth += beyond.len() as u64;
    beyond.clear();
}
