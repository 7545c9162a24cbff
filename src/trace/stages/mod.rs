//! A tile of the picture: one sample of each of its pixels, ray by ray and generation by generation.

mod buffers;
mod follow;
mod sample;
mod select;

pub(crate) use buffers::{TILE, Tile, TileBuffers};
pub(crate) use sample::render_sample;
