//! Scenes as text: from RON files to worlds, with diagnostics of all mistakes.
//!
//! ```text
//! files -> texts -> documents (what the texts say) -> validate (do they make sense) -> merge -> spawn (hecs world)
//!                       |                                 |
//!                       +---- diagnostics with file, line, column, cause and remedy
//! ```
//!
//! A scene may `include` others: each is read and validated once and for itself, then all become one document. Of a scene that is
//! read again, by a [`Reader`], only what was edited is parsed.
//!
//! Mistakes of form (a missing bracket, an unknown field) stop the reading of a file at the first one. Mistakes of meaning
//! (an unknown material, a radius of 0) are all found at once, each with its place in the text: `spans` looks the places up
//! afterwards, so that a scene without mistakes pays nothing for it.
//!
//! The types in `document` mirror the file format and are used for nothing else; components do not know of it.

mod data;
mod diagnostic;
mod document;
mod error;
mod files;
#[doc(hidden)]
pub mod input;
pub mod language;
mod load;
pub mod manual;
mod nearby;
mod overrides;
mod parse;
mod paths;
mod playback;
mod printable;
mod quote;
mod reader;
mod reparse;
mod script_sources;
mod scripts;
mod sources;
mod spans;
mod spawn;
mod suggest;
mod validate;

pub use diagnostic::{Diagnostic, Source, SourcePosition};
pub use error::{Inclusion, LoadError, Mistake};
pub use load::{Scene, TEMPLATE};
pub use overrides::{Override, OverrideError};
#[doc(hidden)]
pub use printable::{Printable, is_printable};
pub use reader::Reader;
pub use script_sources::ScriptMistake;
pub(crate) use script_sources::{SceneScripts, ScriptSources};
pub use sources::{SourceLine, Sources};
