//! Pictures of a moment: full frames, drafts that precede them, and what pixels meet first.

mod draft;
mod fingerprint;
mod frame;
mod passes;

pub use draft::Draft;
