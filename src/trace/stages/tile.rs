//! Tiles of a picture, and sets of their pixels.

use crate::trace::math::{LANES, WHOLE};
use crate::trace::scene::{SIDE, Square};

/// Pixels along a tile's side.
pub(crate) const TILE: u32 = 16;

/// The number of packets of a tile's rays.
pub(crate) use crate::trace::bvh::PACKETS;

const _: () = assert!(
    SIDE.pow(2) as usize == LANES && (TILE / SIDE).pow(2) as usize == PACKETS && TILE.is_multiple_of(SIDE)
);

/// The maximum number of pixels in a tile.
pub(crate) const TILE_PIXELS: usize = PACKETS * LANES;

/// A rectangle of pixels.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
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
    /// Iterates over the tiles of a film, row by row.
    pub(crate) fn all((columns, rows): (u32, u32)) -> impl Iterator<Item = Self> {
        let places = (0..rows)
            .step_by(TILE as usize)
            .flat_map(move |j| (0..columns).step_by(TILE as usize).map(move |i| (i, j)));
        places.map(move |(i, j)| Self { i, j, width: TILE.min(columns - i), height: TILE.min(rows - j) })
    }

    /// Returns the column and row of the pixel with an index. Pixels are counted packet by packet, and lane by lane within a packet.
    pub(crate) fn pixel(&self, index: u32) -> (u32, u32) {
        let (column, row) = Self::place(index / PACKET);
        (self.i + column + index % SIDE, self.j + row + index % PACKET / SIDE)
    }

    /// Returns the packet and the lane of the pixel at a column and a row of a tile.
    pub(crate) fn lane_of(column: usize, row: usize) -> (usize, usize) {
        let (side, packets) = (SIDE as usize, (TILE / SIDE) as usize);
        (row / side * packets + column / side, row % side * side + column % side)
    }

    /// Returns the column and row of a packet's first pixel in its tile.
    #[inline]
    pub(crate) fn place(packet: u32) -> (u32, u32) {
        (packet % (TILE / SIDE) * SIDE, packet / (TILE / SIDE) * SIDE)
    }

    /// Returns the pixels of a packet; `None` if the tile has none there.
    #[inline]
    pub(crate) fn square(&self, packet: usize) -> Option<Square> {
        let (column, row) = Self::place(u32::try_from(packet).ok()?);
        (column < self.width && row < self.height).then(|| Square {
            first: (self.i + column, self.j + row),
            size: ((self.width - column).min(SIDE), (self.height - row).min(SIDE)),
        })
    }
}

/// A set of a tile's slots: for each packet of its camera rays, a bit mask of lanes.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) struct TileLanes([u16; PACKETS]);

impl TileLanes {
    /// The empty set.
    pub(crate) const NONE: Self = Self([0; PACKETS]);

    /// Returns the lanes of a packet, as a bit mask.
    #[inline(always)]
    pub(crate) fn of_packet(&self, packet: usize) -> u32 {
        self.0[packet].into()
    }

    /// Adds lanes of a packet, given as a bit mask.
    #[inline(always)]
    pub(super) fn add(&mut self, packet: usize, lanes: u32) {
        self.0[packet] |= u16::try_from(lanes & WHOLE).unwrap_or(u16::MAX);
    }
}

/// The number of pixels in a packet.
const PACKET: u32 = SIDE * SIDE;

/// The pixels of camera rays that have the slots of their pixels, by packet and lane.
#[expect(clippy::cast_possible_truncation, reason = "a tile's pixels")]
pub(super) const PIXELS: [[u32; LANES]; PACKETS] = {
    let mut pixels = [[0; LANES]; PACKETS];
    let mut index = 0;
    while index < PACKETS * LANES {
        pixels[index / LANES][index % LANES] = index as u32;
        index += 1;
    }
    pixels
};
