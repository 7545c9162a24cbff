//! Scenes of several files.
//!
//! ```text
//! file -> loader: it and what it includes, each file read and parsed once
//!      -> names, scope: what each file can refer to, for the validation, which sees every file for itself
//!      -> merge: one document, and where each of its entities came from
//! ```
//!
//! A file knows the names of what it includes, and nothing of who includes it: a part is whole in itself.

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
