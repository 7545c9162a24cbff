//! What the wave brings to the tile's pixels.

use super::buffers::TileBuffers;
use crate::trace::light::{RenderContext, held};
use crate::trace::math::lanes;

/// Adds the light at the end of each ray to its pixel, ray by ray in the order of the wave, and what happens to light on the
/// way to the ray's throughput.
pub(super) fn add_to_pixels(context: &RenderContext<'_>, buffers: &mut TileBuffers<'_>) {
    buffers.entered.sums += 1;
    let effects = context.effects;
    let TileBuffers { wave, hits, radiance, lengths, pixels, scratch, .. } = buffers;
    for packet in 0..wave.count {
        for lane in lanes(wave.rays[packet].lanes) {
            let mut light = radiance[packet].get(lane);
            if hits[packet].ids.get(lane).is_some() {
                light = held(light);
            }
            let pixel = &mut pixels[wave.pixels[packet][lane] as usize];
            let state = &mut wave.states[packet][lane];
            if effects.in_media() || effects.extras {
                let length = lengths[packet].get(lane);
                let passage = state.passage(effects, context.scene, &scratch.media, length);
                light = passage.of(light);
                *pixel += state.throughput * light;
                state.throughput *= passage.transmitted;
            } else {
                *pixel += state.throughput * light;
            }
        }
    }
}
