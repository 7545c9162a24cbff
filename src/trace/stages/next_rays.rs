//! The last stage: spawns the reflected and refracted rays of the next bounce.

use std::ptr;

use fearless_simd::dispatch;

use super::buffers::TileBuffers;
use super::compaction::fill;
use super::ray_queue::UntracedRay;
use crate::trace::math::{LANES, lanes};
use crate::trace::shading::{RenderContext, branch_lanes, secondary_rays};

/// Spawns the secondary rays of the wavefront's surfaces.
pub(super) fn next_rays(context: &RenderContext<'_>, buffers: &mut TileBuffers<'_>) {
    buffers.stage_runs.next_rays += 1;
    let TileBuffers { wavefront, hits, surfaces, material_flags, next, scratch, .. } = buffers;
    let scene = wavefront.scene(context);
    let changes_class = !ptr::eq(scene, context.secondary);
    for packet in 0..wavefront.count {
        let (hits, surfaces) = (&hits[packet], &surfaces[packet]);
        let continues = material_flags[packet].continues & surfaces.lanes;
        if continues == 0 {
            continue;
        }
        let transparent =
            if context.effects.media() { continues & material_flags[packet].transparent } else { 0 };
        let mirrored = next.add(&wavefront.slots[packet], true);
        let refracted = (transparent != 0).then(|| next.add(&wavefront.slots[packet], false));
        let (rays, paths) = (&wavefront.rays[packet], &wavefront.paths[packet]);
        let media = (scene, &mut scratch.media);
        let branches = next.branches_mut(mirrored, refracted);
        // Where rays of another class start, the shapes at the surface are searched one by one.
        let escalated = if changes_class {
            continues
        } else {
            dispatch!(scene.simd.level(), simd => {
                branch_lanes(simd, media, (rays, paths), (hits, surfaces), (continues, transparent), branches)
            })
        };
        for lane in lanes(escalated) {
            // Many solids may be entered at one point.
            if scratch.search.is_cancelled() {
                return;
            }
            let Some(point) = surfaces.get(lane, hits) else { continue };
            let arrived = (scene, &rays.get(lane), &paths.get(lane));
            let spawned = secondary_rays(context, scratch, arrived, &point);
            let (mirrored, refracted) = next.branches_mut(mirrored, refracted);
            if let Some(ray) = spawned.reflected {
                mirrored.set(lane, &ray);
            }
            if let (Some(ray), Some(refracted)) = (spawned.refracted, refracted) {
                refracted.set(lane, &ray);
            }
        }
    }
}

/// Fills the wavefront with rays of the current bounce. Returns `false` if none are left.
pub(super) fn fill_wavefront(buffers: &mut TileBuffers<'_>) -> bool {
    fill(&mut buffers.wavefront, &mut buffers.current)
}

/// Adds the background, as seen by the rays that are not traced.
pub(super) fn terminate(context: &RenderContext<'_>, buffers: &mut TileBuffers<'_>) {
    let TileBuffers { beyond, pixels, trees_ended, .. } = buffers;
    for UntracedRay { direction, throughput, slot } in beyond.iter() {
        let light = *throughput * context.scene.miss_radiance(*direction);
        let (packet, lane) = (*slot as usize / LANES, *slot as usize % LANES);
        pixels[packet].set(lane, pixels[packet].get(lane) + light);
        trees_ended.strong += u64::from(throughput.max_element() >= 0.5);
    }
    trees_ended.depth += beyond.len() as u64;
    beyond.clear();
}
