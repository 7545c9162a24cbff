//! Stage 2: what every ray of the wave meets first.

use super::buffers::TileBuffers;
use crate::trace::PreparedScene;

pub(super) fn run(scene: &PreparedScene, buffers: &mut TileBuffers) {
    let TileBuffers { rays, hits, stack, .. } = buffers;
    hits.clear();
    hits.extend(rays.iter().map(|queued| scene.closest(&queued.ray, stack)));
}
