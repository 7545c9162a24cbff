//! The stages that trace a tile's rays, bounce by bounce.
//!
//! Each stage is a function over the plain arrays of the tile's buffers. [`sample`] runs them in turn:
//!
//! ```text
//! camera_rays -> closest_hits -> surfaces -> direct_light -> add_to_pixels -> next_rays
//!                     ^                                                            |
//!                     +----------------------- the next wavefront -----------------+
//! ```
//!
//! On request, [`dependencies`] records the regions that the rays pass through, for pictures whose tiles are reused.
//!
//! Tiles that are certainly empty skip all stages: see [`empty_tiles`].

mod buffers;
mod compaction;
mod cutoff;
mod dependencies;
mod direct_light;
mod empty_tiles;
mod handover;
mod material_flags;
mod next_rays;
mod ray_hull;
mod ray_queue;
mod sample;
mod slots;
mod surfaces;
mod tile;
mod tile_sampler;
mod transparent_shadows;
mod trees;
mod wavefront;

pub(crate) use buffers::TileBuffers;
#[cfg(test)]
pub(crate) use dependencies::Forgotten;
pub(crate) use dependencies::TileDependencies;
pub(crate) use ray_hull::LightRegion;
pub(crate) use sample::render_sample;
pub(crate) use slots::{Portion, Slots};
pub(crate) use tile::{PACKETS, TILE, TILE_PIXELS, Tile, TileLanes};
