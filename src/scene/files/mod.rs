//! Scenes of several files.
//!
//! ```text
//! file -> loader: reads and parses the file and its includes, each once; bases: composes the text of a file that extends others
//!      -> names, scope: collect the names that each file can refer to, for the validation of each file on its own
//!      -> merge: builds one document, with the origin of each of its entities
//! ```
//!
//! A file can refer to names in its includes, but not to names in the files that include it: every file is self-contained.

mod bases;
mod foreign;
mod loader;
mod merge;
mod names;
mod origin;
mod read;
mod scene_file;
mod scope;

pub(super) use loader::Texts;
pub(super) use merge::Merged;
pub(super) use names::{Clash, MOST_INCLUDED};
pub(super) use origin::Origin;
pub(super) use scene_file::{Files, SceneFile};
pub(super) use scope::{KnownEntity, Lookup, Scope};
