//! Precision of intersection tests.

/// The precision of intersection tests between rays and shapes.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub enum Precision {
    /// Every decision and every digit is correct.
    #[default]
    Robust,
    /// Naive formulas in `f64`; rays leave surfaces 1e-9 ahead. Shows the cost of robustness, and the errors that it avoids.
    NaiveF64,
    /// Naive formulas in `f32`; rays leave surfaces 1e-4 ahead.
    NaiveF32,
}
