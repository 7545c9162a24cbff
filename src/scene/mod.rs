//! Scenes as text: RON files to worlds, and what is wrong with them.
//!
//! ```text
//! file -> text -> document (what the text says) -> validate (does it make sense) -> spawn (hecs world)
//!                     |                                |
//!                     +---- diagnostics with line, column, cause and remedy
//! ```
//!
//! Mistakes of form (a missing bracket, an unknown field) stop the reading at the first one. Mistakes of meaning (an unknown
//! material, a radius of 0) are all found at once, each with its place in the text: `spans` looks the places up
//! afterwards, so that a scene without mistakes pays nothing for it.
//!
//! The types in `document` mirror the file format and are used for nothing else; components do not know of it.

mod diagnostic;
mod document;
mod lines;
mod load;
mod parse;
mod playback;
pub mod reference;
mod spans;
mod spawn;
mod suggest;
mod validate;

pub use diagnostic::{Diagnostic, Place};
pub use lines::{camera_line, entity_lines};
pub use load::{LoadError, Scene, TEMPLATE};
