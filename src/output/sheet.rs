//! Contact sheets: many frames in one picture.

use std::path::Path;

use super::frame_file::write_pixels;
use super::label;
use super::{FrameFormat, WriteError};
use crate::time::Time;
use crate::trace::EncodedFilm;

/// Width of the gap around tiles, in pixels.
const GAP: u32 = 8;
/// Height of the gap between a tile and its label, in pixels.
const LABEL_GAP: u32 = 5;
/// Columns of a tile per pixel of the width and height of a label's dot.
const COLUMNS_PER_DOT: u32 = 400;

const BACKGROUND: [u8; 3] = [28; 3];
const INK: [u8; 3] = [200; 3];

/// Frames in a grid, row by row, with frame number and time below each frame if there is room.
///
/// A tile has exactly the bytes of the frame's own file.
#[derive(Clone, Debug)]
pub struct Sheet {
    columns: u32,
    tile: (u32, u32),
    /// Width and height in pixels.
    size: (u32, u32),
    /// Pixels, row by row from the top.
    pixels: Vec<[u8; 3]>,
    /// Number of tiles so far.
    count: u32,
}

/// The error of a sheet that exceeds the size limits.
#[derive(Clone, Debug, PartialEq, Eq, thiserror::Error)]
#[error(
    "{columns}x{rows} tiles of {}x{} pixels make a sheet of {width}x{height}: it may have at most {} pixels, and {} on a side",
    tile.0,
    tile.1,
    Sheet::LARGEST_AREA,
    Sheet::LARGEST_SIDE
)]
pub struct SheetTooLarge {
    columns: u32,
    rows: u32,
    tile: (u32, u32),
    width: u64,
    height: u64,
}

impl Sheet {
    /// Maximum number of columns, and of rows, of tiles.
    pub const LARGEST_COUNT: u32 = 100;
    /// Maximum number of pixels on a side.
    pub const LARGEST_SIDE: u32 = 32_768;
    /// Maximum number of pixels: 2^28, which take 805 MB.
    pub const LARGEST_AREA: u64 = 1 << 28;
    /// Maximum width of a sheet with tiles of [`Sheet::fitting_tile`], in pixels.
    pub const FITTING_WIDTH: u32 = 1920;

    /// Creates an empty sheet with the given number of columns and rows of tiles, and the given width and height of a tile in pixels.
    ///
    /// # Errors
    ///
    /// If the sheet would be too large.
    pub fn new(columns: u32, rows: u32, tile: (u32, u32)) -> Result<Self, SheetTooLarge> {
        let pixels =
            |count: u32, side: u32| u64::from(count) * (u64::from(side) + u64::from(GAP)) + u64::from(GAP);
        let (width, height) =
            (pixels(columns, tile.0), pixels(rows, tile.1.saturating_add(label_height(tile))));
        let too_large = SheetTooLarge { columns, rows, tile, width, height };
        let side = |side: u64| u32::try_from(side).ok().filter(|side| *side <= Self::LARGEST_SIDE);
        match (side(width), side(height)) {
            (Some(width), Some(height)) if u64::from(width) * u64::from(height) <= Self::LARGEST_AREA => {
                let pixels = vec![BACKGROUND; width as usize * height as usize];
                Ok(Self { columns: columns.max(1), tile, size: (width, height), pixels, count: 0 })
            }
            _ => Err(too_large),
        }
    }

    /// Returns the tile size with which a sheet of `columns` columns is at most [`Sheet::FITTING_WIDTH`] pixels wide. The tile is never
    /// larger than the film. It has exactly the film's proportions if whole pixels allow this without halving the tile.
    #[must_use]
    pub fn fitting_tile(columns: u32, (width, height): (u32, u32)) -> (u32, u32) {
        let (columns, width, height) = (columns.max(1), width.max(1), height.max(1));
        let room = (Self::FITTING_WIDTH.saturating_sub(GAP) / columns).saturating_sub(GAP).max(1);
        if width <= room {
            return (width, height);
        }
        let step = width / greatest_common_divisor(width, height);
        let exact = room - room % step;
        let fitting = if 2 * exact > room { exact } else { room };
        let rows = (2 * u64::from(fitting) * u64::from(height) + u64::from(width)) / (2 * u64::from(width));
        (fitting, u32::try_from(rows).unwrap_or(u32::MAX).max(1))
    }

    /// Adds a frame as the next tile. Pixels outside the tile or the sheet are cropped.
    pub fn add(&mut self, film: &EncodedFilm, frame: u32, time: Time) {
        let number = format!("#{frame}");
        let label = format!("{number}  {:.3} s", time.seconds());
        self.add_captioned(film, &[&label, &number]);
    }

    /// Adds a picture as the next tile, with the first of these captions that fits below it. Only ASCII characters are drawn. Pixels outside the
    /// tile or the sheet are cropped.
    pub fn add_captioned(&mut self, film: &EncodedFilm, captions: &[&str]) {
        let (left, top) = self.next_corner();
        let columns = self.tile.0.min(film.width()).min(self.width().saturating_sub(left)) as usize;
        let rows = self.tile.1.min(film.height()).min(self.height().saturating_sub(top)) as usize;
        let film_rows = film.pixels().chunks(film.width().max(1) as usize);
        let sheet_rows = self.pixels.chunks_mut(self.size.0 as usize).skip(top as usize);
        for (sheet_row, film_row) in sheet_rows.zip(film_rows).take(rows) {
            sheet_row[left as usize..][..columns].copy_from_slice(&film_row[..columns]);
        }
        self.label(captions, left, top.saturating_add(self.tile.1 + LABEL_GAP));
    }

    /// Returns the width in pixels.
    #[must_use]
    pub fn width(&self) -> u32 {
        self.size.0
    }

    /// Returns the height in pixels.
    #[must_use]
    pub fn height(&self) -> u32 {
        self.size.1
    }

    /// Writes the sheet completely or not at all.
    ///
    /// # Errors
    ///
    /// If the file system or the encoder reports an error. No partial file remains.
    pub fn write(&self, path: &Path, format: FrameFormat) -> Result<(), WriteError> {
        let film = EncodedFilm::from_values(self.width(), self.height(), self.pixels.clone());
        write_pixels(path, &film.into(), format)
    }

    /// Returns the left column and top row of the next tile, and advances by one tile.
    fn next_corner(&mut self) -> (u32, u32) {
        let (column, row) = (self.count % self.columns, self.count / self.columns);
        self.count = self.count.saturating_add(1);
        let (across, down) = (self.tile.0 + GAP, self.tile.1 + label_height(self.tile) + GAP);
        (GAP + column * across, row.saturating_mul(down).saturating_add(GAP))
    }

    /// Draws the first of several labels that fits below a tile, or nothing.
    fn label(&mut self, labels: &[&str], left: u32, top: u32) {
        let (dot, room) = (dot(self.tile), self.tile.0);
        let fitting = labels.iter().find(|text| dot * label::width(text) <= room);
        for (column, row) in label::dots(fitting.copied().unwrap_or_default()) {
            for (x, y) in (0..dot * dot).map(|index| (column * dot + index % dot, row * dot + index / dot)) {
                let (x, y) = (left + x, top.saturating_add(y));
                if x < self.width() && y < self.height() {
                    self.pixels[y as usize * self.size.0 as usize + x as usize] = INK;
                }
            }
        }
    }
}

/// Returns the side of a label's dots in pixels.
fn dot((columns, _): (u32, u32)) -> u32 {
    (columns / COLUMNS_PER_DOT).max(1)
}

/// Returns the number of rows of pixels below a tile for its label.
fn label_height(tile: (u32, u32)) -> u32 {
    LABEL_GAP + dot(tile) * label::HEIGHT
}

fn greatest_common_divisor(mut one: u32, mut other: u32) -> u32 {
    while other != 0 {
        (one, other) = (other, one % other);
    }
    one
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::color::{Rgb, Transfer};
    use crate::trace::Film;

    fn film(size: (u32, u32), color: Rgb) -> EncodedFilm {
        let pixels = std::iter::repeat_n(color, size.0 as usize * size.1 as usize);
        Film::from_pixels(size.0, size.1, pixels).encoded(Transfer::Classic)
    }

    #[test]
    fn tiles_fit_and_keep_their_proportions() {
        for ((columns, film), tile) in [
            ((6, (960, 540)), (304, 171)),
            ((6, (160, 90)), (160, 90)),
            ((1, (1920, 1080)), (1904, 1071)),
            ((1, (1904, 1071)), (1904, 1071)),
            ((4, (641, 359)), (470, 263)),
            ((6, (1000, 562)), (310, 174)),
            ((100, (960, 540)), (11, 6)),
            ((6, (32_768, 1)), (310, 1)),
            ((6, (7, 32_768)), (7, 32_768)),
        ] {
            assert_eq!(Sheet::fitting_tile(columns, film), tile, "{columns} {film:?}");
        }
        for columns in 1..=Sheet::LARGEST_COUNT {
            for film in [(960, 540), (641, 359), (333, 333), (2000, 13)] {
                let (width, height) = Sheet::fitting_tile(columns, film);
                let sheet = Sheet::new(columns, 1, (width, height)).unwrap();
                assert!(sheet.width() <= Sheet::FITTING_WIDTH && width <= film.0 && height <= film.1);
            }
        }
    }

    #[test]
    fn sheets_have_limits() {
        let new = Sheet::new;
        assert_eq!(
            new(1, 1, (32_752, 100)).map(|sheet| (sheet.width(), sheet.height())).ok(),
            Some((32_768, 850))
        );
        assert!(new(1, 1, (32_753, 100)).is_err());
        let error = new(100, 100, (320, 180)).unwrap_err().to_string();
        assert_eq!(
            error,
            "100x100 tiles of 320x180 pixels make a sheet of 32808x20208: it may have at most 268435456 pixels, and 32768 on a side"
        );
        assert!(new(100, 100, (u32::MAX, u32::MAX)).is_err());
    }

    #[test]
    fn tiles_lie_side_by_side_and_nothing_is_written_beyond() {
        let tile = (90, 3);
        let mut sheet = Sheet::new(2, 2, tile).unwrap();
        let colors = [Rgb::X, Rgb::Y, Rgb::Z];
        for (index, color) in (0..).zip(colors) {
            // The second frame is larger than the tile.
            sheet.add(&film((90 + index % 2, 3 + index % 2), color), index, Time::ZERO);
        }
        let count = |sheet: &Sheet, bytes| sheet.pixels.iter().filter(|pixel| **pixel == bytes).count();
        for bytes in [[255, 0, 0], [0, 255, 0], [0, 0, 255]] {
            assert_eq!(count(&sheet, bytes), 270);
        }
        let pixel = |x: u32, y: u32| sheet.pixels[(y * sheet.width() + x) as usize];
        let (right, below) = (GAP + 90 + GAP, GAP + 3 + LABEL_GAP + label::HEIGHT + GAP);
        assert_eq!(
            [pixel(GAP, GAP), pixel(right, GAP), pixel(GAP, below)],
            [[255, 0, 0], [0, 255, 0], [0, 0, 255]]
        );
        assert_eq!(pixel(right, below), BACKGROUND);

        sheet.add(&film(tile, Rgb::ONE), 3, Time::ZERO);
        let full = sheet.clone();
        sheet.add(&film(tile, Rgb::X), 4, Time::ZERO);
        assert!(full.pixels == sheet.pixels);
    }

    #[test]
    fn labels_stay_below_their_tiles_and_narrow_tiles_have_less_of_them() {
        // "#17  0.000 s" has 12 characters.
        for (columns, dots) in [(23, 0), (24, label::dots("#17").count()), (95, label::dots("#17").count())] {
            assert_eq!(inked(columns), dots, "{columns}");
        }
        assert_eq!(inked(96), label::dots("#170.000s").count());
        assert_eq!(inked(800), 4 * inked(96));
    }

    #[test]
    fn first_caption_that_fits_is_drawn() {
        for (columns, caption) in [(80, "no shadows"), (79, "no"), (15, "")] {
            let mut sheet = Sheet::new(1, 1, (columns, 1)).unwrap();
            sheet.add_captioned(&film((columns, 1), Rgb::ONE), &["no shadows", "no"]);
            let inked = sheet.pixels.iter().filter(|pixel| **pixel == INK).count();
            assert_eq!(inked, label::dots(caption).count(), "{columns}");
        }
    }

    /// Returns the number of pixels with ink in a tile's label.
    fn inked(columns: u32) -> usize {
        let mut sheet = Sheet::new(1, 1, (columns, 1)).unwrap();
        sheet.add(&film((columns, 1), Rgb::ONE), 17, Time::ZERO);
        let inked = (0..).zip(&sheet.pixels).filter(|(_, pixel)| **pixel == INK);
        let inked = inked.map(|(index, _): (u32, _)| (index % sheet.width(), index / sheet.width()));
        let is_below = |x, y| (GAP..sheet.width() - GAP).contains(&x) && y >= GAP + 1 + LABEL_GAP;
        inked.inspect(|(x, y)| assert!(is_below(*x, *y))).count()
    }
}
