//! The stages that every wave of rays in a tile goes through, each over the whole wave.

mod buffers;
mod camera_rays;
mod closest_hits;
mod collect;
mod next_rays;
mod refine;
mod shading;

pub(super) use buffers::{TILE, Tile, TileBuffers};

use super::effects::Effects;
use super::geometry::Leaves;
use super::moment::Moment;

/// Follows one sample of every pixel of a tile: what it brings is in the buffers afterwards.
pub(super) fn render_sample<E: Effects>(
    moment: &Moment<'_>,
    leaves: &impl Leaves,
    (tile, sample): (Tile, u32),
    buffers: &mut TileBuffers,
) {
    buffers.begin(tile);
    camera_rays::run::<E>(moment, (tile, sample), buffers);
    for generations in (0..moment.scene.depth).rev() {
        closest_hits::run(moment.scene, leaves, buffers);
        refine::run::<E>(moment, leaves, buffers);
        if E::LIGHTS {
            shading::run::<E>(moment, leaves, (tile, sample), buffers);
        }
        collect::run::<E>(buffers);
        if !E::MIRRORS {
            return;
        }
        next_rays::run::<E>(moment, generations, buffers);
        if buffers.rays.is_empty() {
            break;
        }
    }
    next_rays::give_up(moment, buffers);
}
