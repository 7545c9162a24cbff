//! Tiles of a picture, and samples of their pixels.

use crate::trace::bvh::PARTS;
use crate::trace::light::RenderContext;
use crate::trace::packet::LANES;

/// Pixels along a tile's side.
pub(crate) const TILE: u32 = 16;

/// A rectangle of pixels.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Tile {
    /// Leftmost column.
    pub(crate) i: u32,
    /// Uppermost row.
    pub(crate) j: u32,
    /// Columns, 1..=TILE.
    pub(crate) width: u32,
    /// Rows, 1..=TILE.
    pub(crate) height: u32,
}

impl Tile {
    /// Column and row of a pixel by its index.
    pub(super) fn pixel(&self, index: u32) -> (u32, u32) {
        (self.i + index % self.width, self.j + index / self.width)
    }

    /// Number of the part that a pixel is in, by its index. A part has the rays of a packet.
    pub(super) fn part(&self, index: u32) -> u8 {
        const SIDE: u32 = 4;
        const { assert!((TILE / SIDE).pow(2) as usize == PARTS && SIDE.pow(2) as usize == LANES) };
        let (column, row) = (index % self.width / SIDE, index / self.width / SIDE);
        // There are sixteen.
        u8::try_from(row * (TILE / SIDE) + column).unwrap_or(0)
    }
}

/// What is the same for all rays of a tile's sample.
pub(super) struct Sample<'a> {
    pub(super) context: &'a RenderContext<'a>,
    pub(super) tile: Tile,
    /// Index of the sample in each of its pixels.
    pub(super) index: u32,
}
