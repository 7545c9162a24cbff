//! How far pictures are from each other: what a saving in time costs in accuracy.
//!
//! Pictures are compared by what is shown, output values from 0 to 255 before they are rounded to bytes: light that is clamped in both
//! makes no difference, and a thousandth of a step does.

mod film_error;
mod output_values;
mod similarity;

pub use film_error::FilmError;
pub use similarity::structural_similarity;
