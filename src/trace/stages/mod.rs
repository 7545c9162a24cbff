//! The stages of a tile.

mod buffers;
mod follow;
mod sample;
mod select;

pub(crate) use buffers::{TILE, Tile, TileBuffers};
pub(crate) use sample::render_sample;
