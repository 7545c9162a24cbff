//! Linear pixels of one frame.

use fearless_simd::{f32x16, prelude::*};
use rayon::prelude::*;

use crate::color::Rgb;
use crate::trace::math::{Colors, bits16};
use crate::trace::scene::SIDE;
use crate::trace::stages::TILE;

/// One frame's pixels in linear light, row by row from the top. Every value is finite and 0 or more.
#[derive(Clone, Debug, PartialEq)]
pub struct Film {
    width: u32,
    height: u32,
    pixels: Vec<Rgb>,
}

impl Film {
    /// A black film.
    #[must_use]
    pub fn new(width: u32, height: u32) -> Self {
        Self { width, height, pixels: vec![Rgb::ZERO; width as usize * height as usize] }
    }

    /// The same, made by the current rayon pool's threads: the system hands out memory page by page, to who touches it first, and that
    /// takes as long as to trace a little.
    pub(crate) fn new_in_pool(width: u32, height: u32) -> Self {
        const TOGETHER: usize = 1 << 14;
        let pixels = rayon::iter::repeat_n(Rgb::ZERO, width as usize * height as usize);
        Self { width, height, pixels: pixels.with_min_len(TOGETHER).collect() }
    }

    /// A film of these pixels, row by row from the top; they must not be more than fit, and where they are fewer the rest is black. Values that are not
    /// finite or are negative are made so.
    ///
    /// # Panics
    ///
    /// With more pixels than fit.
    #[must_use]
    pub fn from_pixels(width: u32, height: u32, pixels: impl ExactSizeIterator<Item = Rgb>) -> Self {
        let mut film = Self::new(width, height);
        film.store(0, 0, pixels);
        film
    }

    /// Columns.
    #[must_use]
    pub fn width(&self) -> u32 {
        self.width
    }

    /// Rows.
    #[must_use]
    pub fn height(&self) -> u32 {
        self.height
    }

    /// All pixels, row by row from the top.
    #[must_use]
    pub fn pixels(&self) -> &[Rgb] {
        &self.pixels
    }

    /// The pixel in column `i` and row `j`.
    ///
    /// # Panics
    ///
    /// Outside the film.
    #[must_use]
    pub fn pixel(&self, i: u32, j: u32) -> Rgb {
        assert!(
            i < self.width && j < self.height,
            "pixel ({i}, {j}) of a {} x {} film",
            self.width,
            self.height
        );
        self.pixels[j as usize * self.width as usize + i as usize]
    }

    /// Stores pixels of row `j` from column `i` on, and says how many had overflowed: those are saturated, so that a film is
    /// always finite.
    #[inline]
    pub(crate) fn store(&mut self, i: u32, j: u32, pixels: impl ExactSizeIterator<Item = Rgb>) -> u64 {
        let start = j as usize * self.width as usize + i as usize;
        let mut overflowed = 0;
        for (stored, pixel) in self.pixels[start..start + pixels.len()].iter_mut().zip(pixels) {
            *stored = Rgb::new(saturated(pixel.x), saturated(pixel.y), saturated(pixel.z));
            overflowed += u64::from(*stored != pixel);
        }
        overflowed
    }

    /// Divides the film into tiles, row by row of tiles; those at the edges may be smaller.
    pub(crate) fn tiles_mut(&mut self) -> Vec<FilmTile<'_>> {
        let (width, side) = ((self.width as usize).max(1), TILE as usize);
        let bands = self.pixels.par_chunks_mut(width * side);
        let tiles = bands.flat_map_iter(|band| {
            let mut tiles: Vec<FilmTile<'_>> =
                (0..width).step_by(side).map(|_| FilmTile::default()).collect();
            for (j, row) in band.chunks_mut(width).enumerate() {
                for (tile, part) in tiles.iter_mut().zip(row.chunks_mut(side)) {
                    tile.rows[j] = part;
                }
            }
            tiles
        });
        tiles.collect()
    }
}

/// A tile of a film: the part of each of its rows.
#[derive(Debug, Default)]
pub(crate) struct FilmTile<'a> {
    rows: [&'a mut [Rgb]; TILE as usize],
}

impl FilmTile<'_> {
    /// Stores the pixels of a packet, so many columns and rows, from column `i` and row `j` of the tile on. Says how many had
    /// overflowed, as [`Film::store`] does.
    #[inline(always)]
    pub(crate) fn store<S: Simd>(
        &mut self,
        simd: S,
        (i, j): (u32, u32),
        (columns, rows): (u32, u32),
        pixels: &Colors,
    ) -> u64 {
        let (black, most) = (f32x16::splat(simd, 0.0), f32x16::splat(simd, f32::MAX));
        let mut saturated = pixels.load(simd);
        let mut whole = black.simd_eq(black);
        for channel in &mut saturated {
            let positive = channel.simd_gt(black).select(*channel, black);
            let finite = positive.simd_lt(most).select(positive, most);
            whole &= finite.simd_eq(*channel);
            *channel = finite;
        }
        let mut colors = Colors::splat(Rgb::ZERO);
        colors.store(saturated);
        let overflowed = !bits16(whole);
        let mut count = 0;
        for (row, stored) in self.rows[j as usize..].iter_mut().enumerate().take(rows as usize) {
            let first = row * SIDE as usize;
            let stored = &mut stored[i as usize..(i + columns) as usize];
            if let Ok(stored) = <&mut [Rgb; SIDE as usize]>::try_from(&mut *stored) {
                *stored = [0, 1, 2, 3].map(|column| colors.get(first + column));
            } else {
                (first..).zip(stored).for_each(|(lane, stored)| *stored = colors.get(lane));
            }
            count += (overflowed >> first & ((1 << columns) - 1)).count_ones();
        }
        count.into()
    }
}

fn saturated(channel: f32) -> f32 {
    let positive = if channel > 0.0 { channel } else { 0.0 };
    if positive < f32::MAX { positive } else { f32::MAX }
}
