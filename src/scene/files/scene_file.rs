//! The loaded files of a scene.

use super::Origin;
use crate::scene::Diagnostic;
use crate::scene::document::SceneDocument;
use crate::scene::input::InputFiles;
use crate::scene::source_text::SourceText;
use crate::scene::validate::Problems;

/// A loaded file of a scene, with its errors.
#[derive(Debug)]
pub(in crate::scene) struct SceneFile {
    pub(in crate::scene) source: SourceText,
    /// The overrides applied to the text, as written on a command line.
    pub(in crate::scene) overridden: Vec<String>,
    /// `None` if the text cannot be parsed as a scene.
    pub(in crate::scene) document: Option<SceneDocument>,
    /// The file index of each include of the document; `None` if the file is not available.
    pub(super) includes: Vec<Option<usize>>,
    /// The include where this file is first included, or the field in which it is extended. `None` for the scene file.
    pub(in crate::scene) from: Option<Origin>,
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
