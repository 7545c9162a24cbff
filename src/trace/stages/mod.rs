//! The stages that every wave of rays in a tile goes through, each over the whole wave.

mod buffers;
mod camera_rays;
mod closest_hits;
mod next_rays;
mod refine;
mod shading;

pub(super) use buffers::{TILE, Tile, TileBuffers};

use super::geometry::Leaves;
use super::{Camera, PreparedScene, Sampling};

/// Follows one sample of every pixel of a tile, and adds it to the pixels' sums in the buffers.
pub(super) fn render_sample(
    scene: &PreparedScene,
    leaves: &impl Leaves,
    camera: &Camera,
    sampling: Sampling,
    (tile, sample): (Tile, u32),
    buffers: &mut TileBuffers,
) {
    buffers.begin_sample();
    camera_rays::run(scene, camera, sampling, (tile, sample), buffers);
    for _ in 0..scene.depth {
        if buffers.rays.is_empty() {
            break;
        }
        closest_hits::run(scene, leaves, buffers);
        refine::run(scene, leaves, buffers);
        shading::run(scene, leaves, buffers);
        next_rays::run(scene, buffers);
    }
    next_rays::give_up(scene, buffers);
    buffers.end_sample();
}
