//! What the wave brings to the tile's pixels.

use super::buffers::TileBuffers;
use crate::trace::light::{RenderContext, held};

/// Adds the light at the end of each ray to its pixel, ray by ray in the order of the wave, and what happens to light on the
/// way to the ray's throughput.
pub(super) fn add_to_pixels(context: &RenderContext<'_>, buffers: &mut TileBuffers<'_>) {
    buffers.entered.sums += 1;
    let effects = context.effects;
    let TileBuffers { wave, hits, radiance, lengths, pixels, scratch, .. } = buffers;
    for (index, queued) in wave.iter_mut().enumerate() {
        let mut light = radiance[index];
        if hits[index].is_some() {
            light = held(light);
        }
        let pixel = &mut pixels[queued.pixel as usize];
        let state = &mut queued.tree.state;
        if effects.in_media() || effects.extras {
            let passage = state.passage(effects, context.scene, &scratch.media, lengths[index]);
            light = passage.of(light);
            *pixel += state.throughput * light;
            state.throughput *= passage.transmitted;
        } else {
            *pixel += state.throughput * light;
        }
    }
}
