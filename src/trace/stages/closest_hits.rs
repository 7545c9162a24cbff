//! What each ray of the wave meets first.

use super::buffers::TileBuffers;
use crate::trace::light::RenderContext;
use crate::trace::query::Intersector;

/// Finds the closest hits of the wave.
pub(super) fn closest_hits(
    context: &RenderContext<'_>,
    shapes: &impl Intersector,
    buffers: &mut TileBuffers<'_>,
) {
    buffers.entered.closest_hits += 1;
    let TileBuffers { wave, hits, scratch, .. } = buffers;
    hits.clear();
    scratch.search.tied_hits.clear();
    hits.extend(
        wave.iter().map(|queued| context.scene.closest(shapes, &queued.tree.ray, &mut scratch.search)),
    );
}
