//! Scene loading: from RON files to worlds, with diagnostics for all errors.
//!
//! ```text
//! files -> texts -> documents (parsed texts) -> validate -> merge -> spawn (hecs world)
//!                       |                          |
//!                       +--------------------------+---- diagnostics with file, line, column, cause and remedy
//! ```
//!
//! A scene may `include` others. Each file is read and validated once, independently of the others; all documents are then merged into one.
//! A scene may also extend another: `extend` composes the texts of both before they are parsed, and `source_text` keeps the positions.
//! A [`Reader`], which loads a scene repeatedly, parses only the edited parts.
//!
//! All syntax errors of a file (a missing bracket, an unknown field) are found at once, and in files without them all semantic errors (an
//! unknown material, a radius of 0), each with its position in the text. `spans` locates the positions afterwards, so that a valid scene
//! costs nothing extra.
//!
//! [`mod@format`] describes the file format as data, and [`assist`] helps while a scene is typed; both query the parser with short texts,
//! and take descriptions from `reference`, the [`manual`] as data.
//!
//! The types in `document` mirror the file format and serve no other purpose; components do not depend on them.

pub mod assist;
mod clouds;
mod data;
mod diagnostic;
mod document;
mod error;
mod escape;
mod extend;
mod files;
pub mod format;
#[doc(hidden)]
pub mod input;
pub mod language;
mod load;
pub mod manual;
mod overrides;
mod owner;
mod parse;
#[cfg(feature = "live")]
mod parts;
mod paths;
mod playback;
mod quote;
mod reader;
mod reference;
mod script_sources;
mod scripts;
mod source_text;
mod sources;
mod spans;
mod spawn;
mod suggest;
mod suggest_file;
mod validate;
mod warning;

pub use diagnostic::{Diagnostic, Source, SourcePosition};
pub use error::{Inclusion, InclusionKind, LoadError, Mistake};
#[doc(hidden)]
pub use escape::{Printable, is_printable};
pub use load::{Scene, TEMPLATE};
#[cfg(feature = "live")]
pub(crate) use overrides::joined;
pub use overrides::{
    KeyChange, Override, OverrideError, ScenePart, TextChange, WriteBackError, WrittenKey, WrittenKind,
    WrittenTrack, WrittenTracks, WrittenValue, written_value,
};
pub use owner::Owner;
#[cfg(feature = "live")]
pub(crate) use parts::{AnimatedChannel, ChangedPart};
pub use reader::Reader;
pub use script_sources::ScriptMistake;
pub(crate) use script_sources::{SceneScripts, ScriptSources};
pub use source_text::SourceLine;
pub use sources::Sources;
#[doc(hidden)]
pub use suggest::nearest;
pub use warning::SceneWarning;
