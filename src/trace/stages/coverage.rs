//! Pixel coverage, for pictures with alpha.

use fearless_simd::dispatch;

use super::buffers::TileBuffers;
use super::tile::PACKETS;
use crate::trace::math::{LANES, lanes};
use crate::trace::shading::{Absorbers, RenderContext};

/// Records the pixels whose camera rays, the wavefront, hit a shape or lose light on their way, if recording is enabled. All other pixels see
/// the unattenuated background.
pub(super) fn note_coverage(context: &RenderContext<'_>, buffers: &mut TileBuffers<'_>) {
    let TileBuffers { wavefront, hits, scratch, covered: Some(covered), stage_runs, .. } = buffers else {
        return;
    };
    stage_runs.coverage += 1;
    dispatch!(context.scene.simd.level(), simd => {
        for packet in 0..wavefront.count {
            let asked = wavefront.rays[packet].lanes;
            let paths = (&wavefront.paths[packet], &scratch.media);
            let absorbers = Absorbers::of(context.scene, context.effects, paths, asked);
            let met = asked & (hits[packet].ids.lanes(simd) | absorbers.lanes);
            if let Some(home) = wavefront.home(packet) {
                covered.add(home, met);
                continue;
            }
            for lane in lanes(met) {
                let slot = wavefront.slots[packet][lane] as usize;
                covered.add(slot / LANES % PACKETS, 1 << (slot % LANES));
            }
        }
    });
}
