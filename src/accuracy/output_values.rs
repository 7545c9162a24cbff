//! A film as it is shown.

use rayon::prelude::*;

use crate::color::Transfer;
use crate::trace::Film;

/// One channel of a film: output values from 0 to 255, unrounded, row by row.
pub(super) struct OutputValues {
    pub(super) width: usize,
    pub(super) values: Vec<f64>,
}

impl OutputValues {
    /// Returns a channel, 0 to 2.
    pub(super) fn of(film: &Film, transfer: Transfer, channel: usize) -> Self {
        let values = film.pixels().par_iter().map(|pixel| transfer.encode_unrounded(*pixel)[channel % 3]);
        Self { width: film.width() as usize, values: values.collect() }
    }
}

/// Panics unless two films have the same size.
pub(super) fn require_same_size(film: &Film, other: &Film) {
    let size = |film: &Film| (film.width(), film.height());
    assert_eq!(size(film), size(other), "films of different sizes cannot be compared");
}
