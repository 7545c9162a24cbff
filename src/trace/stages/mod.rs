//! The stages that every wave of rays in a tile goes through, each over the whole wave.

mod buffers;
mod camera_rays;
mod closest_hits;
mod next_rays;
mod refine;
mod shading;

pub(super) use buffers::{TILE, Tile, TileBuffers};

use super::geometry::Leaves;
use super::{Camera, PreparedScene};

/// Makes one tile of the picture; its pixels are in the buffers afterwards.
pub(super) fn render_tile(
    scene: &PreparedScene,
    leaves: &impl Leaves,
    camera: &Camera,
    tile: Tile,
    buffers: &mut TileBuffers,
) {
    buffers.begin(tile);
    camera_rays::run(scene, camera, tile, buffers);
    for _ in 0..scene.depth {
        if buffers.rays.is_empty() {
            return;
        }
        closest_hits::run(scene, leaves, buffers);
        refine::run(scene, leaves, buffers);
        shading::run(scene, leaves, buffers);
        next_rays::run(scene, buffers);
    }
    next_rays::give_up(scene, buffers);
}
