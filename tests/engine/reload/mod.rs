//! Tests that a reloaded scene equals a newly loaded one to the last bit, and that parts unaffected by an edit are kept.
//!
//! `RAYREEL_CASES` sets the number of sequences of random edits.

pub(crate) mod described;
mod edits;
mod kept;
pub(crate) mod model;
pub(crate) mod random;
