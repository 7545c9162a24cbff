//! Norms of errors.

/// The norm of a picture's error: how the errors of its pixels' channels, in output values, become one number.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub enum ErrorNorm {
    /// The root of their mean square.
    #[default]
    Rms,
    /// The largest one.
    Max,
    /// The 99th percentile: one of a hundred is larger.
    P99,
}
