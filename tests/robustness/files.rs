//! Scenes as files: the main file, its includes, and its scripts.

use std::fmt;
use std::fs;
use std::path::{Path, PathBuf};

use proptest::test_runner::TestCaseError;

use rayreel::Scene;
use rayreel::scene::TEMPLATE;

/// Name of the main file.
pub(crate) const SCENE: &str = "scene.ron";

/// The files of a scene, by their paths from its folder. The main file comes first.
#[derive(Clone)]
pub(crate) struct Files(pub(crate) Vec<(PathBuf, Vec<u8>)>);

impl Files {
    pub(crate) fn of_text(text: impl Into<Vec<u8>>) -> Self {
        Self(vec![(SCENE.into(), text.into())])
    }

    /// Reads a scene file and all files in its folder that `choose` accepts.
    fn of(scene: &Path, choose: impl Fn(&Path) -> bool) -> Self {
        let folder = scene.parent().unwrap();
        let mut files = Self::of_text(fs::read(scene).unwrap());
        for path in files_below(folder).into_iter().filter(|path| path != scene && choose(path)) {
            files.0.push((path.strip_prefix(folder).unwrap().to_owned(), fs::read(&path).unwrap()));
        }
        files
    }

    /// Writes the files into a folder, and returns the path of the main file.
    pub(crate) fn write(&self, folder: &Path) -> PathBuf {
        for (path, bytes) in &self.0 {
            let path = folder.join(path);
            fs::create_dir_all(path.parent().unwrap()).unwrap();
            fs::write(path, bytes).unwrap();
        }
        folder.join(SCENE)
    }

    /// Runs a check in a folder that contains the files. Keeps them if it fails.
    pub(crate) fn check<T>(
        &self,
        check: impl FnOnce(&Path) -> Result<T, TestCaseError>,
    ) -> Result<T, TestCaseError> {
        let folder = tempfile::tempdir().unwrap();
        self.write(folder.path());
        check(folder.path()).map_err(|error| {
            let TestCaseError::Fail(reason) = error else { return error };
            let kept = Path::new(env!("CARGO_TARGET_TMPDIR")).join("robustness");
            let _ = fs::remove_dir_all(&kept);
            self.write(&kept);
            TestCaseError::fail(format!("{reason}\nthe files are in {}", kept.display()))
        })
    }
}

fn files_below(folder: &Path) -> Vec<PathBuf> {
    let mut files = Vec::new();
    for entry in fs::read_dir(folder).unwrap() {
        let path = entry.unwrap().path();
        if path.is_dir() { files.extend(files_below(&path)) } else { files.push(path) }
    }
    files.sort();
    files
}

fn scenes_in(folder: &Path) -> Vec<PathBuf> {
    let mut paths = files_below(folder);
    paths.retain(|path| path.parent() == Some(folder) && path.extension().is_some_and(|end| end == "ron"));
    paths
}

fn root() -> &'static Path {
    Path::new(env!("CARGO_MANIFEST_DIR"))
}

/// Returns the scenes in a folder, without other files.
fn alone(folder: &str) -> impl Iterator<Item = Files> {
    scenes_in(&root().join(folder)).into_iter().map(|path| Files::of(&path, |_| false))
}

/// Returns the template, the shipped scenes, and scenes that use every field.
pub(crate) fn good_scenes() -> Vec<Files> {
    let mut scenes = vec![Files::of_text(TEMPLATE)];
    for path in ["scenes", "scenes/lesson"].into_iter().flat_map(|folder| scenes_in(&root().join(folder))) {
        let made_of = Scene::load(&path).unwrap().files;
        scenes.push(Files::of(&path, |file| made_of.iter().any(|part| part == file)));
    }
    scenes.extend(["tests/flush_faces", "tests/hard_cases", "tests/probe"].into_iter().flat_map(alone));
    scenes
}

/// Returns scenes that are invalid without edits.
pub(crate) fn refused_scenes() -> Vec<Files> {
    let mut scenes: Vec<Files> =
        ["tests/bad_scenes", "tests/bad_scripts"].into_iter().flat_map(alone).collect();
    let several = fs::read_dir(root().join("tests/bad_includes")).unwrap();
    let mut several: Vec<PathBuf> = several.map(|folder| folder.unwrap().path().join(SCENE)).collect();
    several.sort();
    scenes.extend(several.iter().map(|path| Files::of(path, |_| true)));
    scenes
}

/// Prints the files as text, up to 4000 bytes each.
impl fmt::Debug for Files {
    fn fmt(&self, formatter: &mut fmt::Formatter<'_>) -> fmt::Result {
        for (path, bytes) in &self.0 {
            let text = String::from_utf8_lossy(&bytes[..bytes.len().min(4000)]);
            writeln!(formatter, "--- {}\n{text}", path.display())?;
        }
        Ok(())
    }
}
