//! The files of a scene, as far as they could be read.

use std::path::PathBuf;
use std::sync::Arc;

use crate::scene::Diagnostic;
use crate::scene::document::SceneDocument;
use crate::scene::validate::Problems;

/// One file of a scene, as far as it could be read.
#[derive(Debug)]
pub(in crate::scene) struct SceneFile {
    /// The name in messages.
    pub(in crate::scene) name: String,
    pub(in crate::scene) text: Arc<String>,
    /// The values that were put into the text, as they are written on a command line.
    pub(in crate::scene) overridden: Vec<String>,
    /// `None` if the text is not a scene's.
    pub(in crate::scene) document: Option<SceneDocument>,
    /// The file of each of the document's includes; `None` for one that cannot be had.
    pub(super) includes: Vec<Option<usize>>,
    /// The file and the include through which it was met first. `None` for the scene's own file.
    pub(in crate::scene) from: Option<(usize, usize)>,
    /// The mistake of form in the text, if any.
    pub(in crate::scene) mistake: Option<Diagnostic>,
    /// The mistakes of meaning in the document.
    pub(in crate::scene) problems: Problems,
}

/// All files of a scene. The first is the scene's own; each include follows the file that it is met in first.
#[derive(Debug, Default)]
pub(in crate::scene) struct Files {
    pub(in crate::scene) files: Vec<SceneFile>,
    /// The files in such an order that every file follows those it includes.
    pub(super) parts_first: Vec<usize>,
    /// The paths of all files, also of those that are not there.
    pub(in crate::scene) paths: Vec<PathBuf>,
}
