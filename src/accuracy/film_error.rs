//! The largest and the RMS difference of two films.

use rayon::prelude::*;

use super::output_values::{OutputValues, apart, largest};
use crate::color::Transfer;
use crate::trace::{Film, Tile};

/// The largest output value.
const PEAK: f64 = 255.0;

/// The difference of two films, in output values: 8-bit levels, unrounded.
///
/// ```
/// use rayreel::accuracy::FilmError;
/// use rayreel::color::{Rgb, Transfer};
/// use rayreel::trace::Film;
///
/// let film = |red: f32| Film::from_pixels(2, 1, [Rgb::new(red, 0.5, 0.5), Rgb::ONE].into_iter());
/// let error = FilmError::between(&film(0.25), &film(0.75), Transfer::Classic);
/// assert_eq!((error.max, error.share_off), (127.5, 0.5));
/// assert!((error.rms - 127.5 / f64::sqrt(6.0)).abs() < 1e-12);
/// ```
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct FilmError {
    /// The largest difference of any channel, 0 to 255.
    pub max: f64,
    /// The RMS difference of all channels, 0 to 255.
    pub rms: f64,
    /// The fraction of pixels that differ by more than 1 in a channel, 0 to 1.
    pub share_off: f64,
}

/// The sums of a row.
#[derive(Clone, Copy, Default)]
struct RowSums {
    max: f64,
    squares: f64,
    off: u64,
}

impl FilmError {
    /// Compares a film with a reference. The result does not depend on the number of threads, nor on the order of the films.
    ///
    /// # Panics
    ///
    /// If the films have different sizes.
    #[must_use]
    pub fn between(film: &Film, reference: &Film, transfer: Transfer) -> Self {
        Self::of_values(&OutputValues::of_film(film, transfer), &OutputValues::of_film(reference, transfer))
    }

    /// Compares pictures as [`between`](Self::between) does.
    ///
    /// # Panics
    ///
    /// If the pictures have different sizes.
    #[must_use]
    pub fn of_values(picture: &OutputValues, reference: &OutputValues) -> Self {
        let rows: Vec<RowSums> = picture
            .rows_with(reference)
            .map(|(row, reference)| {
                let mut sums = RowSums::default();
                for (pixel, other) in row.iter().zip(reference) {
                    let apart = apart(pixel, other);
                    sums.max = sums.max.max(largest(apart));
                    sums.squares += apart[0] * apart[0] + apart[1] * apart[1] + apart[2] * apart[2];
                    sums.off += u64::from(largest(apart) > 1.0);
                }
                sums
            })
            .collect();
        let count = picture.pixels().len().max(1) as f64;
        let squares: f64 = rows.iter().map(|row| row.squares).sum();
        let off: u64 = rows.iter().map(|row| row.off).sum();
        Self {
            max: rows.iter().map(|row| row.max).fold(0.0, f64::max),
            rms: (squares / (3.0 * count)).sqrt(),
            share_off: off as f64 / count,
        }
    }

    /// Compares several films with as many references. Returns the largest difference and fraction of any pair, and the RMS difference of
    /// all pairs.
    ///
    /// # Panics
    ///
    /// If a film and its reference have different sizes.
    #[must_use]
    pub fn of_sequence(films: &[Film], references: &[Film], transfer: Transfer) -> Self {
        let (mut all, mut count) = (Self::default(), 0.0);
        for (film, reference) in films.iter().zip(references) {
            let error = Self::between(film, reference, transfer);
            all.max = all.max.max(error.max);
            all.share_off = all.share_off.max(error.share_off);
            all.rms += error.rms * error.rms;
            count += 1.0;
        }
        Self { rms: (all.rms / f64::max(count, 1.0)).sqrt(), ..all }
    }

    /// Returns the peak signal-to-noise ratio, 20 log10(255 / RMS), in decibels; infinite for equal films.
    #[must_use]
    pub fn psnr(&self) -> f64 {
        20.0 * libm::log10(PEAK / self.rms)
    }
}

/// Returns the mean squared differences of all channels, tile by tile.
///
/// # Panics
///
/// If the pictures have different sizes.
pub(super) fn tile_squares(picture: &OutputValues, reference: &OutputValues) -> Vec<f64> {
    let pairs: Vec<_> = picture.rows_with(reference).collect();
    let mean = |Tile { i, j, width, height }: Tile| {
        let columns = i as usize..(i + width) as usize;
        let rows = &pairs[j as usize..(j + height) as usize];
        let pixels =
            rows.iter().flat_map(|(row, other)| row[columns.clone()].iter().zip(&other[columns.clone()]));
        let squares =
            pixels.map(|(pixel, other)| apart(pixel, other).map(|apart| apart * apart).iter().sum::<f64>());
        squares.sum::<f64>() / (3.0 * f64::from(width * height))
    };
    let tiles: Vec<Tile> = Tile::all(picture.size()).collect();
    tiles.into_par_iter().map(mean).collect()
}

#[cfg(test)]
mod tests {
    use proptest::prelude::*;

    use super::*;
    use crate::color::Rgb;

    fn film(width: u32, pixels: &[[f32; 3]]) -> Film {
        let height = u32::try_from(pixels.len()).unwrap() / width;
        Film::from_pixels(width, height, pixels.iter().map(|pixel| Rgb::from_array(*pixel)))
    }

    #[test]
    fn equal_and_clamped_pixels_have_no_error() {
        let bright = film(2, &[[1.5, 0.5, 0.0], [7.0, 0.25, 1.0]]);
        let brighter = film(2, &[[2.5, 0.5, 0.0], [1.0, 0.25, 3.0]]);
        for transfer in [Transfer::Srgb, Transfer::Classic] {
            for other in [&bright, &brighter] {
                let error = FilmError::between(&bright, other, transfer);
                assert_eq!(error, FilmError::default());
                assert!(error.psnr() > f64::MAX);
            }
        }
        let empty = Film::new(0, 0);
        assert_eq!(FilmError::between(&empty, &empty, Transfer::Srgb), FilmError::default());
    }

    #[test]
    fn black_and_white_have_the_largest_error() {
        let (black, white) = (film(1, &[[0.0; 3]; 4]), film(1, &[[1.0; 3]; 4]));
        let error = FilmError::between(&black, &white, Transfer::Classic);
        assert_eq!(error, FilmError { max: 255.0, rms: 255.0, share_off: 1.0 });
        assert_eq!(error.psnr(), 0.0);
    }

    #[test]
    fn differences_below_one_level_count() {
        let error = FilmError::between(&film(1, &[[0.5; 3]]), &film(1, &[[0.501; 3]]), Transfer::Classic);
        assert!((error.max - 0.255).abs() < 1e-4 && error.rms > 0.25 && error.share_off == 0.0, "{error:?}");
        assert_eq!(Transfer::Classic.encode(Rgb::splat(0.5)), Transfer::Classic.encode(Rgb::splat(0.501)));
    }

    #[test]
    fn squared_errors_of_tiles_add_up_to_that_of_the_picture() {
        // Twelve tiles; those at the right are 12 pixels wide, those at the bottom 9 high.
        let ramp = |step: f32| {
            let light =
                (0_u16..60 * 41).map(|index| f32::from(index % 97) / 97.0 + step * f32::from(index % 7));
            Film::from_pixels(60, 41, light.map(Rgb::splat))
        };
        let (one, other) = (ramp(0.0), ramp(0.01));
        let values = |film| OutputValues::of_film(film, Transfer::Srgb);
        let squares = tile_squares(&values(&one), &values(&other));
        let pixels = |index: usize| f64::from([16, 16, 16, 12][index % 4] * [16, 16, 9][index / 4]);
        let sum: f64 = squares.iter().enumerate().map(|(index, square)| square * pixels(index)).sum();
        let rms = FilmError::between(&one, &other, Transfer::Srgb).rms;
        assert!(squares.len() == 12 && rms > 1.0, "{rms}");
        assert!(((sum / (60.0 * 41.0)).sqrt() - rms).abs() < 1e-9 * rms, "{sum} {rms}");
        // Only the last tile differs in the last pixel.
        let mut last = one.clone();
        last.store(59, 40, std::iter::once(Rgb::ZERO));
        let squares = tile_squares(&values(&one), &values(&last));
        assert!(squares[..11].iter().all(|square| *square == 0.0) && squares[11] > 0.0, "{squares:?}");
    }

    #[test]
    #[should_panic(expected = "films of different sizes")]
    fn films_of_different_sizes_are_not_compared() {
        let _ = FilmError::between(&Film::new(2, 3), &Film::new(3, 2), Transfer::Srgb);
    }

    proptest! {
        /// Compares with the definitions, one channel after the other.
        #[test]
        fn errors_match_the_definition(
            pixels in prop::collection::vec(prop::array::uniform3(-0.1_f32..1.2), 12),
            others in prop::collection::vec(prop::array::uniform3(-0.1_f32..1.2), 12),
            is_srgb in any::<bool>(),
        ) {
            let transfer = if is_srgb { Transfer::Srgb } else { Transfer::Classic };
            let (one, other) = (film(4, &pixels), film(4, &others));
            let mut apart = Vec::new();
            let mut off = 0;
            for (one, other) in one.pixels().iter().zip(other.pixels()) {
                let (one, other) = (transfer.encode_unrounded(*one), transfer.encode_unrounded(*other));
                let of_pixel: Vec<f64> = one.iter().zip(other).map(|(one, other)| (one - other).abs()).collect();
                off += i32::from(of_pixel.iter().any(|apart| *apart > 1.0));
                apart.extend(of_pixel);
            }
            let error = FilmError::between(&one, &other, transfer);
            prop_assert_eq!(error.max, apart.iter().copied().fold(0.0, f64::max));
            let mean = apart.iter().map(|apart| apart * apart).sum::<f64>() / 36.0;
            prop_assert!((error.rms - mean.sqrt()).abs() < 1e-9);
            prop_assert_eq!(error.share_off, f64::from(off) / 12.0);
            prop_assert_eq!(error, FilmError::between(&other, &one, transfer));
        }
    }
}
