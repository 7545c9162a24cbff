//! Pictures of a moment: full frames, and drafts that precede them.

mod draft;
mod fingerprint;
mod frame;

pub use draft::Draft;
