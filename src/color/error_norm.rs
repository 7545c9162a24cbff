//! Norms of errors.

/// The norm of a picture's error: the reduction of the errors of all channels, in output values, to one number.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub enum ErrorNorm {
    /// The root of the mean square.
    #[default]
    Rms,
    /// The largest error.
    Max,
    /// The 99th percentile: one error in a hundred is larger.
    P99,
}
