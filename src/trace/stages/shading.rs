//! Stage 4: light by light the shadow rays and what they let through.

use super::buffers::TileBuffers;
use crate::trace::PreparedScene;
use crate::trace::geometry::Leaves;
use crate::trace::shade::incidence;

pub(super) fn run(scene: &PreparedScene, leaves: &impl Leaves, buffers: &mut TileBuffers) {
    let TileBuffers { rays, found, pixels, scratch, counts, .. } = buffers;
    for light in &scene.lights {
        for point in found.iter_mut() {
            let arrived = &rays[point.ray].ray;
            let Some(incidence) = incidence(scene, arrived, &point.surface, light) else {
                continue;
            };
            let mut hidden = || {
                counts.shadow += 1;
                scene.is_hidden(leaves, &incidence.ray, incidence.limit, light.own_shape, scratch)
            };
            if !light.casts_shadows || !hidden() {
                point.local += incidence.color;
            }
        }
    }
    for point in found.iter() {
        let queued = &rays[point.ray];
        pixels[queued.pixel] += queued.throughput * point.local;
    }
}
