//! Loads a scene from a file or a text.

use std::path::{Path, PathBuf};

use hecs::World;

use super::files::{Files, Texts};
use super::spawn::spawn;
use super::{LoadError, Override, SceneScripts, Sources};
use crate::time::Timeline;

/// A small commented scene to start from.
pub const TEMPLATE: &str = include_str!("template.ron");

/// A scene that has been read: its entities, its timeline and its scripts.
pub struct Scene {
    /// The entities, in document order by [`Order`](crate::components::Order).
    pub world: World,
    /// The frame rate and the duration.
    pub timeline: Timeline,
    /// The files it was made of: its own, then what it includes and the scripts that are files, each once and after a file that
    /// names it.
    pub files: Vec<PathBuf>,
    /// The scripts that drive values.
    pub(crate) scripts: SceneScripts,
}

impl Scene {
    /// Reads a scene file, or standard input by the name of `-`, and what it includes.
    ///
    /// # Errors
    ///
    /// If a file cannot be read, or with everything that is wrong in any of them.
    pub fn load(path: &Path) -> Result<Self, LoadError> {
        Self::of_files(Files::read(path, &[]), |_| ()).map(|(scene, ())| scene)
    }

    /// Loads a scene like [`load`](Scene::load), and keeps the texts, in which places can be looked up. Each file is read only
    /// once.
    ///
    /// # Errors
    ///
    /// As [`load`](Scene::load).
    pub fn load_with_sources(path: &Path) -> Result<(Self, Sources), LoadError> {
        Self::load_overridden(path, &[])
    }

    /// Loads a scene like [`load_with_sources`](Scene::load_with_sources), with other values in the place of some in its files: in
    /// the order in which they are given, each in the first file that has a place for it. Lines are those of the files.
    ///
    /// # Errors
    ///
    /// As [`load`](Scene::load), and if a value has no place.
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

    /// Reads a scene from text; `file` names it in messages. Includes are looked for from the folder of `file`, whether that file
    /// exists or not: from the working directory if it is a mere name.
    ///
    /// # Errors
    ///
    /// With everything that is wrong in the text, or in what it includes.
    pub fn from_text(file: &str, text: String) -> Result<Self, LoadError> {
        Self::of_files(Files::from_text(Path::new(file), text), |_| ()).map(|(scene, ())| scene)
    }

    /// Reads a scene like [`from_text`](Scene::from_text), and keeps the texts, in which places can be looked up.
    ///
    /// # Errors
    ///
    /// As [`from_text`](Scene::from_text).
    pub fn from_text_with_sources(file: &str, text: String) -> Result<(Self, Sources), LoadError> {
        Self::of_files(Files::from_text(Path::new(file), text), |sources| sources)
    }

    /// Builds the scene. Texts that are not kept are dropped before the world is built.
    fn of_files<T>(mut files: Files, keep: impl FnOnce(Sources) -> T) -> Result<(Self, T), LoadError> {
        files.validate();
        let compiled = files.compile();
        if !files.are_good() {
            return Err(LoadError::new(files));
        }
        let paths = std::mem::take(&mut files.paths);
        let (merged, sources) = files.merge();
        let scripts = compiled.link(&merged.uses, &sources);
        let kept = keep(sources);
        let (world, timeline) = spawn(&merged);
        Ok((Self { world, timeline, files: paths, scripts }, kept))
    }
}
