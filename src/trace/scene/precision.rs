//! Precision of intersection tests.

/// The precision of intersection tests between rays and shapes.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub enum Precision {
    /// Every decision and every digit is correct.
    #[default]
    Guaranteed,
    /// Textbook formulas in `f64`; rays leave surfaces 1e-9 ahead. Shows the cost of the guarantees, and the errors that they avoid.
    TextbookF64,
    /// Textbook formulas in `f32`; rays leave surfaces 1e-4 ahead.
    TextbookF32,
}
