//! Stage 3: from hits to points that lie on their surfaces, where light or a mirror asks for them. Rays that met nothing see
//! the background.

use super::buffers::{Found, TileBuffers};
use crate::color::Rgb;
use crate::trace::PreparedScene;
use crate::trace::geometry::Leaves;
use crate::trace::shade::ambient;

pub(super) fn run(scene: &PreparedScene, leaves: &impl Leaves, buffers: &mut TileBuffers) {
    let TileBuffers { rays, hits, found, pixels, scratch, .. } = buffers;
    let lit = scene.lights.iter().any(|light| light.intensity != Rgb::ZERO);
    found.clear();
    for (index, (queued, hit)) in rays.iter().zip(hits.iter()).enumerate() {
        let Some(closest) = hit else {
            pixels[queued.pixel] += queued.throughput * scene.background;
            continue;
        };
        let material = scene.material(closest.hit.slot);
        let local = ambient(scene, material);
        if (lit && material.scatters()) || material.reflected > 0.0 {
            let surface = scene.surface(leaves, &queued.ray, closest, &mut scratch.guards);
            found.push(Found { ray: index, surface, local });
        } else {
            pixels[queued.pixel] += queued.throughput * local;
        }
    }
}
