//! Pictures of a moment: full frames, and drafts that precede them.

mod draft;
mod frame;

pub use draft::Draft;
