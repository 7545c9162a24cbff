//! Pictures in output values.

use rayon::prelude::*;

use crate::color::{Rgb, Transfer};
use crate::trace::Film;

/// The output values of a picture: red, green and blue from 0 to 255, unrounded, row by row from the top.
#[derive(Clone, Debug, PartialEq)]
pub struct OutputValues {
    size: (u32, u32),
    pixels: Vec<[f64; 3]>,
}

impl OutputValues {
    /// Creates a picture of these values.
    ///
    /// # Panics
    ///
    /// If there are not as many as the size has pixels.
    #[must_use]
    pub fn new(size: (u32, u32), pixels: Vec<[f64; 3]>) -> Self {
        let count = u64::from(size.0) * u64::from(size.1);
        assert_eq!(pixels.len() as u64, count, "a picture has values for all of its pixels");
        Self { size, pixels }
    }

    /// Encodes linear light, row by row from the top. Values outside 0..=1 are clamped.
    ///
    /// # Panics
    ///
    /// As [`OutputValues::new`].
    #[must_use]
    pub fn of_light(size: (u32, u32), light: &[Rgb], transfer: Transfer) -> Self {
        Self::new(size, light.par_iter().map(|pixel| transfer.encode_unrounded(*pixel)).collect())
    }

    /// Encodes a film.
    #[must_use]
    pub fn of_film(film: &Film, transfer: Transfer) -> Self {
        Self::of_light((film.width(), film.height()), film.pixels(), transfer)
    }

    /// Returns the number of columns and rows.
    #[must_use]
    pub fn size(&self) -> (u32, u32) {
        self.size
    }

    /// Returns the values of all pixels.
    #[must_use]
    pub fn pixels(&self) -> &[[f64; 3]] {
        &self.pixels
    }

    /// Returns the values of one channel, 0 to 2.
    pub(super) fn channel(&self, channel: usize) -> Vec<f64> {
        self.pixels.par_iter().map(|pixel| pixel[channel % 3]).collect()
    }

    /// Returns the pairs of rows of two pictures.
    ///
    /// # Panics
    ///
    /// If the pictures have different sizes.
    pub(super) fn rows_with<'a>(
        &'a self,
        other: &'a Self,
    ) -> impl IndexedParallelIterator<Item = (&'a [[f64; 3]], &'a [[f64; 3]])> {
        assert_eq!(self.size, other.size, "films of different sizes cannot be compared");
        let width = self.size.0.max(1) as usize;
        self.pixels.par_chunks(width).zip(other.pixels.par_chunks(width))
    }

    /// Returns the largest difference of any channel for each pixel.
    ///
    /// # Panics
    ///
    /// If the pictures have different sizes.
    #[must_use]
    pub fn differences(&self, other: &Self) -> Vec<f64> {
        let of_row = |(one, other): (&[[f64; 3]], &[[f64; 3]])| {
            one.iter().zip(other).map(|(one, other)| largest(apart(one, other))).collect::<Vec<_>>()
        };
        self.rows_with(other).map(of_row).collect::<Vec<_>>().concat()
    }
}

/// Returns the absolute differences of the channels of two pixels.
pub(super) fn apart(one: &[f64; 3], other: &[f64; 3]) -> [f64; 3] {
    std::array::from_fn(|channel| (one[channel] - other[channel]).abs())
}

/// Returns the largest of three channels.
pub(super) fn largest([red, green, blue]: [f64; 3]) -> f64 {
    red.max(green).max(blue)
}
