//! Light over the pixels of a film, such as that of letters.

use std::collections::BTreeMap;

use crate::color::Rgb;
use crate::trace::math::{Bytes, Colors, LANES};
use crate::trace::scene::SIDE;

/// The light over a film of a size: for each touched pixel, the light that is added and the share of the film's light that remains.
#[derive(Clone, Debug, Default, PartialEq)]
pub(crate) struct FilmOverlay {
    columns: u32,
    /// The touched pixels of each row of the film, by column.
    rows: Vec<BTreeMap<u32, OverPixel>>,
}

#[derive(Clone, Copy, Debug, PartialEq)]
struct OverPixel {
    light: Rgb,
    remaining: f32,
}

impl FilmOverlay {
    /// Creates an overlay without touched pixels.
    pub(crate) fn new((columns, rows): (u32, u32)) -> Self {
        Self { columns, rows: vec![BTreeMap::new(); rows as usize] }
    }

    /// Returns the numbers of columns and rows.
    pub(crate) fn size(&self) -> (u32, u32) {
        (self.columns, u32::try_from(self.rows.len()).unwrap_or(u32::MAX))
    }

    /// Covers a share of a pixel, from 0 to 1, with a colour, over what is there already. Pixels outside the film are ignored.
    pub(crate) fn cover(&mut self, (column, row): (i64, i64), share: f32, color: Rgb) {
        let share = share.clamp(0.0, 1.0);
        let place = u32::try_from(column).ok().filter(|column| *column < self.columns && share > 0.0);
        let pixels = usize::try_from(row).ok().and_then(|row| self.rows.get_mut(row));
        let (Some(column), Some(pixels)) = (place, pixels) else { return };
        put_over(pixels, column, OverPixel { light: color * share, remaining: 1.0 - share });
    }

    /// Covers the pixels with another overlay of the same size and this opacity, from 0 to 1.
    pub(crate) fn cover_with(&mut self, other: &Self, opacity: f64) {
        #[expect(clippy::cast_possible_truncation, reason = "coverage is rounded")]
        let opacity = opacity as f32;
        for (pixels, others) in self.rows.iter_mut().zip(&other.rows) {
            for (column, OverPixel { light, remaining }) in others {
                let remaining = 1.0 - opacity * (1.0 - remaining);
                put_over(pixels, *column, OverPixel { light: *light * opacity, remaining });
            }
        }
    }

    /// Returns the touched pixels, row by row: column, row, light and remaining share.
    fn pixels(&self) -> impl Iterator<Item = (u32, u32, OverPixel)> {
        let rows = (0..).zip(&self.rows);
        rows.flat_map(|(row, pixels)| pixels.iter().map(move |(column, pixel)| (*column, row, *pixel)))
    }

    /// Writes the touched pixels.
    pub(super) fn write(&self, bytes: &mut Bytes) {
        for (column, row, OverPixel { light, remaining }) in self.pixels() {
            bytes.count(column);
            bytes.count(row);
            bytes.colors([light]);
            bytes.number(remaining.into());
        }
    }

    /// Draws over the pixels of a film, of which there are as many as the overlay has.
    pub(crate) fn draw(&self, pixels: &mut [Rgb]) {
        for (column, row, over) in self.pixels() {
            if let Some(pixel) = pixels.get_mut(row as usize * self.columns as usize + column as usize) {
                *pixel = over.on(*pixel);
            }
        }
    }

    /// Adds the coverage to a film of alpha.
    pub(crate) fn draw_alpha(&self, alpha: &mut [f32]) {
        for (column, row, over) in self.pixels() {
            if let Some(alpha) = alpha.get_mut(row as usize * self.columns as usize + column as usize) {
                *alpha = 1.0 - (1.0 - *alpha) * over.remaining;
            }
        }
    }

    /// Draws over a packet of pixels whose first one is at this column and row of the film. Returns whether any is touched.
    #[inline(never)]
    pub(super) fn draw_packet(&self, (column, row): (u32, u32), colors: &mut Colors) -> bool {
        let mut is_touched = false;
        for (lane, index) in (0..LANES).zip(0_u32..) {
            let (across, down) = (index % SIDE, index / SIDE);
            let pixels = self.rows.get((row + down) as usize);
            if let Some(over) = pixels.and_then(|pixels| pixels.get(&(column + across))) {
                colors.set(lane, over.on(colors.get(lane)));
                is_touched = true;
            }
        }
        is_touched
    }
}

/// Puts a pixel over what is in its row already.
fn put_over(row: &mut BTreeMap<u32, OverPixel>, column: u32, over: OverPixel) {
    let under = row.entry(column).or_insert(OverPixel { light: Rgb::ZERO, remaining: 1.0 });
    *under = OverPixel { light: over.on(under.light), remaining: under.remaining * over.remaining };
}

impl OverPixel {
    fn on(self, beneath: Rgb) -> Rgb {
        beneath * self.remaining + self.light
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn colours_cover_by_their_shares_in_order() {
        let mut overlay = FilmOverlay::new((4, 3));
        overlay.cover((1, 2), 0.5, Rgb::new(1.0, 0.0, 0.0));
        overlay.cover((1, 2), 0.25, Rgb::new(0.0, 1.0, 0.0));
        for outside in [(-1, 0), (4, 0), (0, -1), (0, 3), (i64::MAX, 0)] {
            overlay.cover(outside, 1.0, Rgb::ONE);
        }
        overlay.cover((0, 0), 0.0, Rgb::ONE);
        let mut pixels = [Rgb::splat(8.0); 12];
        overlay.draw(&mut pixels);
        let beneath = 8.0 * 0.5 * 0.75;
        assert_eq!(pixels[9], Rgb::new(beneath + 0.375, beneath + 0.25, beneath));
        assert_eq!(pixels.iter().filter(|pixel| **pixel == Rgb::splat(8.0)).count(), 11);
        let mut alpha = [0.0; 12];
        overlay.draw_alpha(&mut alpha);
        assert_eq!((alpha[9], alpha[8]), (1.0 - 0.375, 0.0));
    }
}
