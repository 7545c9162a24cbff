//! The range of numbers in a scene, whether written in its file or given by its scripts.

/// The largest magnitude of a coordinate or a length: products of four stay finite.
pub const LARGEST: f64 = 1e60;
/// The smallest size. Written out: the inverse of the largest is rounded to a number just above it.
pub const SMALLEST: f64 = 1e-60;
/// The most light or absorption, well within single precision.
pub const MOST_LIGHT: f64 = 1e30;
