//! Stage 2: what every ray of the wave meets first.

use super::buffers::TileBuffers;
use crate::trace::PreparedScene;
use crate::trace::geometry::Leaves;

pub(super) fn run(scene: &PreparedScene, leaves: &impl Leaves, buffers: &mut TileBuffers) {
    let TileBuffers { rays, hits, scratch, .. } = buffers;
    hits.clear();
    hits.extend(rays.iter().map(|queued| scene.closest(leaves, &queued.tree.ray, scratch)));
}
