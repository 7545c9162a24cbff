//! Reusable memory of pixels, which also holds the sample counts of the last picture.

use super::evidence::PixelPacket;
use crate::trace::math::LANES;
use crate::trace::render::film::Film;
use crate::trace::stages::{PACKETS, TILE, Tile};

/// Reusable memory for the pixels of a picture.
#[derive(Clone, Debug, Default)]
pub(crate) struct PixelMemory {
    pub(super) packets: Vec<PixelPacket>,
    /// Estimates of squared errors, before scaling.
    pub(super) errors: Vec<[f32; LANES]>,
}

impl PixelMemory {
    /// Returns the sample count of each pixel of the last picture. `None` if no picture of this size was rendered.
    pub(crate) fn counts(&self, (columns, rows): (u32, u32)) -> Option<Film<u32>> {
        let across = columns.div_ceil(TILE);
        if self.packets.len() != (across * rows.div_ceil(TILE)) as usize * PACKETS {
            return None;
        }
        let taken = |column: u32, row: u32| {
            let (packet, lane) = Tile::lane_of((column % TILE) as usize, (row % TILE) as usize);
            let tile = (row / TILE * across + column / TILE) as usize;
            self.packets[tile * PACKETS + packet].taken[lane]
        };
        let counts = (0..rows).flat_map(|row| (0..columns).map(move |column| taken(column, row)));
        Some(Film::from_values(columns, rows, counts.collect()))
    }
}
