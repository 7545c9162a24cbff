//! The error target of a picture, and the estimate of its error.

use super::convergence::Convergence;
use crate::color::{ErrorNorm, Transfer};

/// The error target of a picture.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) struct ErrorTarget {
    /// Target error in output values (8-bit levels), greater than 0.
    pub(crate) error: f64,
    pub(crate) norm: ErrorNorm,
    /// Minimum sample count per pixel.
    pub(crate) least: u32,
    /// The transfer function from light to output values.
    pub(crate) transfer: Transfer,
    pub(crate) convergence: Convergence,
}

/// The estimate of a picture's error, in output values.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct EstimatedError {
    /// Error in the norm of the target: RMS over pixels and channels, maximum, or 99th percentile.
    pub value: f64,
    /// Standard deviation of the estimate.
    pub deviation: f64,
    /// Additional RMS error from images of small shapes in mirrors and glass that lie where no sample was taken: the expected value if all
    /// of them are visible. 0 while samples are added.
    pub hidden: f64,
}
