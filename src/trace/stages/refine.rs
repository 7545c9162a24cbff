//! Stage 3: from hits to points that lie on their surfaces. Rays that met nothing see the background.

use super::buffers::{Found, TileBuffers};
use crate::color::Rgb;
use crate::trace::PreparedScene;
use crate::trace::geometry::Leaves;

pub(super) fn run(scene: &PreparedScene, leaves: &impl Leaves, buffers: &mut TileBuffers) {
    let TileBuffers { rays, hits, found, pixels, scratch, .. } = buffers;
    found.clear();
    for (index, (queued, hit)) in rays.iter().zip(hits.iter()).enumerate() {
        match hit {
            Some(closest) => {
                let surface = scene.surface(leaves, &queued.ray, closest, &mut scratch.guards);
                found.push(Found { ray: index, surface, local: Rgb::ZERO });
            }
            None => pixels[queued.pixel] += queued.throughput * scene.background,
        }
    }
}
