//! Limits of the numbers in a scene, written in its file or set by its scripts.

/// The largest magnitude of a coordinate or a length. Products of four such numbers are finite.
pub const LARGEST: f64 = 1e60;
/// The smallest size. It is written out because the inverse of [`LARGEST`] is rounded to a number just above it.
pub const SMALLEST: f64 = 1e-60;
/// The largest light or absorption, well within single precision.
pub const MOST_LIGHT: f64 = 1e30;
