//! Rendering of a moment: full frames, drafts that precede them, and first-hit passes.

mod draft;
mod fingerprint;
mod frame;
mod passes;

pub use draft::Draft;
