//! Stage 5: what the wave's rays bring is added to their pixels, ray by ray.

use super::buffers::TileBuffers;
use crate::trace::effects::Effects;

pub(super) fn run<E: Effects>(buffers: &mut TileBuffers) {
    let TileBuffers { rays, light, passages, pixels, .. } = buffers;
    if E::NESTING || E::RARE {
        for ((queued, light), passage) in rays.iter_mut().zip(light.iter()).zip(passages.iter()) {
            let tree = &mut queued.tree;
            pixels[queued.pixel as usize] += tree.throughput * passage.of(*light);
            tree.throughput *= passage.transmitted;
        }
    } else {
        for (queued, light) in rays.iter().zip(light.iter()) {
            pixels[queued.pixel as usize] += queued.tree.throughput * *light;
        }
    }
}
