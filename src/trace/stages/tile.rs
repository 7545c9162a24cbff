//! Tiles of a picture, and samples of their pixels.

use crate::trace::bvh::PARTS;
use crate::trace::light::RenderContext;
use crate::trace::math::LANES;
use crate::trace::scene::SIDE;

/// Pixels along a tile's side.
pub(crate) const TILE: u32 = 16;

/// How many packets a tile's rays are. A shaft has a part for each half.
pub(super) const PACKETS: usize = PARTS / 2;

const _: () = assert!(
    SIDE.pow(2) as usize == LANES && (TILE / SIDE).pow(2) as usize == PACKETS && TILE.is_multiple_of(SIDE)
);

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

/// The pixels of a packet's camera rays, four by four, or as many as the tile has there.
#[derive(Clone, Copy, Debug)]
pub(super) struct Square {
    /// Column and row of the first, in the picture.
    pub(super) first: (u32, u32),
    /// Columns and rows.
    pub(super) size: (u32, u32),
}

impl Tile {
    /// Returns column and row of a pixel by its index.
    pub(super) fn pixel(&self, index: u32) -> (u32, u32) {
        (self.i + index % self.width, self.j + index / self.width)
    }

    /// Returns the index of a pixel by its column and row.
    pub(super) fn index(&self, (i, j): (u32, u32)) -> u32 {
        (j - self.j) * self.width + (i - self.i)
    }

    /// Returns the pixels of a packet; `None` where the tile has none.
    pub(super) fn square(&self, packet: usize) -> Option<Square> {
        let packet = u32::try_from(packet).ok()?;
        let (column, row) = (packet % (TILE / SIDE) * SIDE, packet / (TILE / SIDE) * SIDE);
        (column < self.width && row < self.height).then(|| Square {
            first: (self.i + column, self.j + row),
            size: ((self.width - column).min(SIDE), (self.height - row).min(SIDE)),
        })
    }
}

impl Square {
    /// Returns column and row of the pixel in a lane, if there is one.
    pub(super) fn pixel(&self, lane: usize) -> Option<(u32, u32)> {
        let lane = u32::try_from(lane).ok()?;
        let (column, row) = (lane % SIDE, lane / SIDE);
        (column < self.size.0 && row < self.size.1).then_some((self.first.0 + column, self.first.1 + row))
    }
}

/// What is the same for all rays of a tile's sample.
pub(super) struct Sample<'a> {
    pub(super) context: &'a RenderContext<'a>,
    pub(super) tile: Tile,
    /// Index of the sample in each of its pixels.
    pub(super) index: u32,
}
