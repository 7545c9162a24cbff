//! Pictures of a moment: whole frames, and drafts to begin with.

mod draft;
mod frame;

pub use draft::Draft;
