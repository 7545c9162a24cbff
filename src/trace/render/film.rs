//! The pixels of a frame.

use fearless_simd::{f32x16, prelude::*};
use rayon::prelude::*;

use super::film_overlay::FilmOverlay;
use crate::color::{Encoding, Linear, Rgb};
use crate::trace::math::{Colors, LANES, bits16};
use crate::trace::scene::SIDE;
use crate::trace::stages::{TILE, Tile};

/// The pixels of a frame, row by row from the top: in linear light, unless they are [encoded](EncodedFilm). Every value of linear light is
/// finite and 0 or more.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Film<Pixel = Rgb> {
    width: u32,
    height: u32,
    pixels: Vec<Pixel>,
}

/// The pixels of a frame as output bytes, encoded by a [`Transfer`](crate::color::Transfer).
pub type EncodedFilm = Film<[u8; 3]>;

impl Film {
    /// Creates a black film.
    #[must_use]
    pub fn new(width: u32, height: u32) -> Self {
        Self::black(Linear, width, height)
    }

    /// Creates a film from pixels, row by row from the top. There must not be more pixels than fit; if there are fewer, the rest is black.
    /// Values that are not finite or are negative are clamped.
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

    /// Returns all pixels with this encoding, such as output bytes by a [`Transfer`](crate::color::Transfer). They are encoded on the
    /// current rayon pool's threads.
    #[must_use]
    pub fn encoded<E: Encoding>(&self, encoding: E) -> Film<E::Pixel> {
        let mut encoded = Film::black(encoding, self.width, self.height);
        let linear = self.pixels.par_chunks(TOGETHER);
        let chunks = encoded.pixels.par_chunks_mut(TOGETHER).zip(linear);
        chunks.for_each(|(encoded, linear)| {
            let (encoded, last) = encoded.as_chunks_mut::<LANES>();
            let (linear, last_linear) = linear.as_chunks::<LANES>();
            encoded
                .iter_mut()
                .zip(linear)
                .for_each(|(encoded, linear)| *encoded = encoding.encode_all(*linear));
            last.iter_mut()
                .zip(last_linear)
                .for_each(|(last, linear)| [*last] = encoding.encode_all([*linear]));
        });
        encoded
    }

    /// Draws over the pixels.
    pub(crate) fn draw_over(&mut self, overlay: &FilmOverlay) {
        overlay.draw(&mut self.pixels);
    }

    /// Stores pixels of row `j` from column `i` on, and returns the number of pixels that overflowed. These are saturated, so that a film is
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
}

impl EncodedFilm {
    /// Creates a film from bytes: red, green and blue of each pixel, row by row from the top. `None` unless the number of bytes matches the
    /// size.
    #[must_use]
    pub fn from_bytes(width: u32, height: u32, bytes: &[u8]) -> Option<Self> {
        let (pixels, rest) = bytes.as_chunks::<3>();
        let is_full = rest.is_empty() && pixels.len() as u64 == u64::from(width) * u64::from(height);
        is_full.then(|| Self { width, height, pixels: pixels.to_vec() })
    }

    /// Returns all bytes: red, green and blue of each pixel.
    #[must_use]
    pub fn bytes(&self) -> &[u8] {
        self.pixels.as_flattened()
    }
}

/// Returns the share of covered samples.
#[expect(clippy::cast_possible_truncation, reason = "rounding to f32 is the point")]
pub(crate) fn alpha(covered: f64, samples: f64) -> f32 {
    (covered / samples) as f32
}

impl Film<f32> {
    /// Creates a film filled with zeros.
    pub(crate) fn zeros(width: u32, height: u32) -> Self {
        Self { width, height, pixels: vec![0.0; width as usize * height as usize] }
    }

    /// Adds the coverage of an overlay to alpha.
    pub(crate) fn draw_over(&mut self, overlay: &FilmOverlay) {
        overlay.draw_alpha(&mut self.pixels);
    }

    /// Splits the film into rows of tiles.
    pub(crate) fn bands_mut(&mut self) -> impl IndexedParallelIterator<Item = &mut [f32]> {
        self.pixels.par_chunks_mut((self.width * TILE).max(1) as usize)
    }
}

impl<Pixel: Copy> Film<Pixel> {
    /// Copies a tile of a film of the same size.
    pub(super) fn copy_tile(&mut self, from: &Self, tile: &Tile) {
        for row in tile.j..tile.j + tile.height {
            let start = row as usize * self.width as usize + tile.i as usize;
            let pixels = start..start + tile.width as usize;
            self.pixels[pixels.clone()].copy_from_slice(&from.pixels[pixels]);
        }
    }
}

impl<Pixel> Film<Pixel> {
    /// Creates a film from one value per pixel, row by row from the top.
    pub(crate) fn from_values(width: u32, height: u32, pixels: Vec<Pixel>) -> Self {
        Self { width, height, pixels }
    }

    /// Returns the number of columns and rows.
    pub(crate) fn size(&self) -> (u32, u32) {
        (self.width, self.height)
    }

    /// Returns the number of columns.
    #[must_use]
    pub fn width(&self) -> u32 {
        self.width
    }

    /// Returns the number of rows.
    #[must_use]
    pub fn height(&self) -> u32 {
        self.height
    }

    /// Returns all pixels, row by row from the top.
    #[must_use]
    pub fn pixels(&self) -> &[Pixel] {
        &self.pixels
    }
}

impl<Pixel: Copy + Send + Sync> Film<Pixel> {
    /// Creates a black film.
    pub(crate) fn black<E: Encoding<Pixel = Pixel>>(encoding: E, width: u32, height: u32) -> Self {
        Self { width, height, pixels: encoding.black(width as usize * height as usize) }
    }

    /// Returns the pixel in column `i` and row `j`.
    ///
    /// # Panics
    ///
    /// Outside the film.
    #[must_use]
    pub fn pixel(&self, i: u32, j: u32) -> Pixel {
        assert!(
            i < self.width && j < self.height,
            "pixel ({i}, {j}) of a {} x {} film",
            self.width,
            self.height
        );
        self.pixels[j as usize * self.width as usize + i as usize]
    }

    /// Splits the film into tiles, row by row of tiles; tiles at the edges may be smaller. Light is drawn over and encoded when it is stored.
    /// Tiles are created one row at a time, as they are large.
    pub(crate) fn tiles_mut<'a, E: Encoding<Pixel = Pixel> + 'a>(
        &'a mut self,
        encoding: E,
        overlay: Option<&'a FilmOverlay>,
    ) -> impl Iterator<Item = FilmTile<'a, E>> + Send {
        let (columns, side) = (self.width.max(1), TILE as usize);
        let width = columns as usize;
        let bands = self.pixels.chunks_mut(width * side).zip((0..).step_by(side));
        bands.flat_map(move |(band, row)| {
            let tile =
                |column| FilmTile { encoding, overlay, first: (column, row), rows: Default::default() };
            let tiles = (0..columns).step_by(side).map(tile);
            let mut tiles: Vec<FilmTile<'_, E>> = tiles.collect();
            for (j, row) in band.chunks_mut(width).enumerate() {
                for (tile, part) in tiles.iter_mut().zip(row.chunks_mut(side)) {
                    tile.rows[j] = part;
                }
            }
            tiles
        })
    }
}

/// The number of pixels per parallel chunk.
const TOGETHER: usize = 1 << 14;

/// A tile of a film: the part of each row inside the tile.
pub(crate) struct FilmTile<'a, E: Encoding> {
    encoding: E,
    overlay: Option<&'a FilmOverlay>,
    /// The column and row of the first pixel in the film.
    first: (u32, u32),
    rows: [&'a mut [E::Pixel]; TILE as usize],
}

impl<E: Encoding> FilmTile<'_, E> {
    /// Stores the pixels of a packet, `columns` by `rows` of them, at column `i` and row `j` of the tile. Returns the number of pixels that
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
        let (mut whole, mut same) = (black.simd_eq(black), black.simd_eq(black));
        for channel in &mut saturated {
            let positive = channel.simd_gt(black).select(*channel, black);
            let finite = positive.simd_lt(most).select(positive, most);
            whole &= finite.simd_eq(*channel);
            same &= finite.simd_eq(f32x16::splat(simd, finite.as_array()[0]));
            *channel = finite;
        }
        let mut colors = Colors::splat(Rgb::ZERO);
        colors.store(saturated);
        let mut same = bits16(same) == u32::from(u16::MAX);
        if let Some(overlay) = self.overlay {
            same &= !overlay.draw_packet((self.first.0 + i, self.first.1 + j), &mut colors);
        }
        let encoded = self.encode(&colors, same);
        let overflowed = !bits16(whole);
        let mut count = 0;
        let (encoded, _) = encoded.as_chunks::<{ SIDE as usize }>();
        let stored = self.rows[j as usize..].iter_mut().zip(encoded);
        for (row, (stored, encoded)) in stored.enumerate().take(rows as usize) {
            let stored = &mut stored[i as usize..(i + columns) as usize];
            match <&mut [E::Pixel; SIDE as usize]>::try_from(&mut *stored) {
                Ok(stored) => *stored = *encoded,
                Err(_) => stored.copy_from_slice(&encoded[..columns as usize]),
            }
            count += (overflowed >> (row * SIDE as usize) & ((1 << columns) - 1)).count_ones();
        }
        count.into()
    }

    /// Encodes a packet's pixels, row by row. If all are the same, only one is encoded.
    #[inline(always)]
    fn encode(&self, colors: &Colors, same: bool) -> [E::Pixel; LANES] {
        if same {
            let [pixel] = self.encoding.encode_all([colors.get(0)]);
            return [pixel; LANES];
        }
        let mut linear = [Rgb::ZERO; LANES];
        for (lane, linear) in linear.iter_mut().enumerate() {
            *linear = colors.get(lane);
        }
        self.encoding.encode_all(linear)
    }
}

fn saturated(channel: f32) -> f32 {
    let positive = if channel > 0.0 { channel } else { 0.0 };
    if positive < f32::MAX { positive } else { f32::MAX }
}
