//! Loads a scene from a file or a text.

use std::path::{Path, PathBuf};

use hecs::World;

use super::files::{Files, Texts};
use super::spawn::spawn;
use super::warning::warnings_of;
use super::{LoadError, Override, SceneScripts, SceneWarning, Sources};
use crate::time::Timeline;

/// A small commented scene as a starting point.
pub const TEMPLATE: &str = include_str!("template.ron");

/// A loaded scene: its entities, its timeline and its scripts.
pub struct Scene {
    /// The entities; [`Order`](crate::components::Order) holds their document order.
    pub world: World,
    /// The frame rate and the duration.
    pub timeline: Timeline,
    /// The files of the scene: the scene file, included files and script files, each once and after a file that refers to it.
    pub files: Vec<PathBuf>,
    /// The warnings about the files.
    pub warnings: Vec<SceneWarning>,
    /// The scripts that drive values.
    pub(crate) scripts: SceneScripts,
}

impl Scene {
    /// Loads a scene file and its includes. The path `-` denotes standard input.
    ///
    /// # Errors
    ///
    /// Returns all errors in the files, including files that cannot be read.
    pub fn load(path: &Path) -> Result<Self, LoadError> {
        Self::of_files(Files::read(path, &[]), |_| ()).map(|(scene, ())| scene)
    }

    /// Loads a scene like [`load`](Scene::load), and returns the sources for looking up locations. Each file is read only once.
    ///
    /// # Errors
    ///
    /// As for [`load`](Scene::load).
    pub fn load_with_sources(path: &Path) -> Result<(Self, Sources), LoadError> {
        Self::load_overridden(path, &[])
    }

    /// Loads a scene like [`load_with_sources`](Scene::load_with_sources), with overridden values. Overrides are applied in the given
    /// order, each to the first file in which its path can be resolved. Line numbers refer to the original files.
    ///
    /// # Errors
    ///
    /// As for [`load`](Scene::load), and if an override cannot be applied to any file.
    pub fn load_overridden(path: &Path, overrides: &[Override]) -> Result<(Self, Sources), LoadError> {
        Self::of_files(Files::read(path, overrides), |sources| sources)
    }

    /// Loads a scene like [`load_overridden`](Scene::load_overridden), for [`Reader`](super::Reader).
    pub(super) fn load_again(
        path: &Path,
        overrides: &[Override],
        before: &mut Texts,
    ) -> Result<(Self, Sources), LoadError> {
        Self::of_files(Files::read_again(path, overrides, before), |sources| sources)
    }

    /// Loads a scene from text; `file` names it in messages. Includes are resolved relative to the directory of `file`, whether that file
    /// exists or not, or to the working directory if `file` is a bare file name.
    ///
    /// # Errors
    ///
    /// Returns all errors in the text and in its includes.
    pub fn from_text(file: &str, text: String) -> Result<Self, LoadError> {
        Self::of_files(Files::from_text(Path::new(file), text), |_| ()).map(|(scene, ())| scene)
    }

    /// Loads a scene like [`from_text`](Scene::from_text), and returns the sources for looking up locations.
    ///
    /// # Errors
    ///
    /// As for [`from_text`](Scene::from_text).
    pub fn from_text_with_sources(file: &str, text: String) -> Result<(Self, Sources), LoadError> {
        Self::of_files(Files::from_text(Path::new(file), text), |sources| sources)
    }

    /// Builds the scene. Texts that `keep` does not return are dropped before the world is built.
    fn of_files<T>(mut files: Files, keep: impl FnOnce(Sources) -> T) -> Result<(Self, T), LoadError> {
        files.validate();
        let compiled = files.compile();
        if !files.are_good() {
            return Err(LoadError::new(files));
        }
        let warnings = warnings_of(&mut files);
        let paths = std::mem::take(&mut files.inputs.paths);
        let (merged, sources) = files.merge();
        let scripts = compiled.link(&merged.uses, &sources);
        let kept = keep(sources);
        let (world, timeline) = spawn(&merged);
        Ok((Self { world, timeline, files: paths, warnings, scripts }, kept))
    }
}
