//! How precisely shapes are asked.

/// How precisely shapes are asked what a ray meets.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub enum Precision {
    /// Every verdict and every digit right.
    #[default]
    Guaranteed,
    /// The schoolbook's formulas in `f64`; rays leave surfaces 1e-9 ahead. What guarantees cost, and what they save from.
    TextbookF64,
    /// The same in `f32`; rays leave surfaces 1e-4 ahead.
    TextbookF32,
}
