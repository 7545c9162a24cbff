//! The loaded files of a scene.

use std::sync::Arc;

use crate::scene::Diagnostic;
use crate::scene::document::SceneDocument;
use crate::scene::input::InputFiles;
use crate::scene::validate::Problems;

/// A loaded file of a scene, with its errors.
#[derive(Debug)]
pub(in crate::scene) struct SceneFile {
    /// The name in messages.
    pub(in crate::scene) name: String,
    pub(in crate::scene) text: Arc<String>,
    /// The overrides applied to the text, as written on a command line.
    pub(in crate::scene) overridden: Vec<String>,
    /// `None` if the text cannot be parsed as a scene.
    pub(in crate::scene) document: Option<SceneDocument>,
    /// The file index of each include of the document; `None` if the file is not available.
    pub(super) includes: Vec<Option<usize>>,
    /// The indices of the including file and of its include, where this file is first included. `None` for the scene file.
    pub(in crate::scene) from: Option<(usize, usize)>,
    /// The error in reading or parsing the file, or in applying an override, if any.
    pub(in crate::scene) mistake: Option<Diagnostic>,
    /// The semantic errors in the document.
    pub(in crate::scene) problems: Problems,
}

/// All files of a scene. The scene file is first; each included file follows the first file that includes it.
#[derive(Debug, Default)]
pub(in crate::scene) struct Files {
    pub(in crate::scene) files: Vec<SceneFile>,
    /// File indices in an order in which every file follows its includes.
    pub(super) parts_first: Vec<usize>,
    /// All files that were looked for, including missing ones.
    pub(in crate::scene) inputs: InputFiles,
}
