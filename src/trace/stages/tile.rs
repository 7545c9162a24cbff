//! Tiles of a picture, and samples of their pixels.

use crate::trace::light::RenderContext;

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
}

/// Returns the number of the packet that rays of a pixel belong to: those of a square of 4 by 4 pixels are one. `width` is the
/// tile's.
pub(super) fn packet_of(pixel: u32, width: u32) -> usize {
    const SIDE: u32 = 4;
    let (column, row) = (pixel % width / SIDE, pixel / width / SIDE);
    (row * (TILE / SIDE) + column) as usize
}

/// What is the same for all rays of a tile's sample.
pub(super) struct Sample<'a> {
    pub(super) context: &'a RenderContext<'a>,
    pub(super) tile: Tile,
    /// Index of the sample in each of its pixels.
    pub(super) index: u32,
}
