//! A scene that is reloaded is the scene that one would have started with, to the last bit, and what an edit does not touch is
//! kept.
//!
//! `RAYREEL_CASES` asks for more than the usual sequences of random edits.

mod described;
mod edits;
mod kept;
mod model;
mod random;
