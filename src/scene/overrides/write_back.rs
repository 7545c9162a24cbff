//! Changes of the texts of a scene's files by which values are set.

use std::fs;
use std::io;
use std::path::{Path, PathBuf};

use super::Override;
use super::set_value::{Edit, PathError, counts_other_files, edit_for, value_at};

/// A change of the text of a file, from `before` to `after`.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct TextChange {
    /// The file.
    pub file: PathBuf,
    /// The whole text before the change.
    pub before: String,
    /// The whole text after the change. The two differ only where the values stand; comments and layout stay.
    pub after: String,
}

/// An error in setting values in the texts of files.
#[derive(Debug, thiserror::Error)]
pub enum WriteBackError {
    /// A file could not be read.
    #[error("`{}`: {error}", file.display())]
    File {
        /// The file.
        file: PathBuf,
        /// The cause.
        error: io::Error,
    },
    /// No file has a place for a value.
    #[error("`{value}`: {cause}")]
    Path {
        /// The value with its path.
        value: String,
        /// The cause and the remedy.
        cause: String,
    },
}

impl TextChange {
    /// Returns the changes of files by which these have the values, in the order given. A value replaces the one at its path in the first file
    /// that has the path, or becomes a new field of the scene file, which comes first. Files that are not scenes are ignored.
    ///
    /// ```
    /// use rayreel::scene::TextChange;
    ///
    /// # let folder = tempfile::tempdir()?;
    /// let scene = folder.path().join("scene.ron");
    /// std::fs::write(&scene, "(camera: (fov: 50 /* wide */), film: (width: 64))")?;
    /// let values = ["camera.fov=40".parse()?, "film.height=36".parse()?];
    /// let changes = TextChange::setting(&values, &[scene])?;
    /// assert_eq!(changes[0].after, "(camera: (fov: 40 /* wide */), film: (width: 64, height: 36))");
    /// # Ok::<(), Box<dyn std::error::Error>>(())
    /// ```
    ///
    /// # Errors
    ///
    /// If a file cannot be read, or no file has a place for a value.
    pub fn setting(values: &[Override], files: &[PathBuf]) -> Result<Vec<Self>, WriteBackError> {
        let mut texts: Vec<Self> = scene_files(files)
            .map(|file| read(file).map(|text| Self { file: file.clone(), before: text.clone(), after: text }))
            .collect::<Result<_, _>>()?;
        for value in values {
            set(&mut texts, value)?;
        }
        texts.retain(|change| change.before != change.after);
        Ok(texts)
    }
}

/// Returns the text of the value at a path in the first file that has it.
#[must_use]
pub fn written_value(path: &[String], files: &[PathBuf]) -> Option<String> {
    scene_files(files).find_map(|file| {
        let text = read(file).ok()?;
        let span = value_at(&text, path)?;
        Some(text[span].to_owned())
    })
}

/// Returns the files with scenes, among those of a scene and its scripts.
pub(super) fn scene_files(files: &[PathBuf]) -> impl Iterator<Item = &PathBuf> {
    files.iter().filter(|file| file.extension().is_some_and(|ending| ending == "ron"))
}

fn read(file: &Path) -> Result<String, WriteBackError> {
    fs::read_to_string(file).map_err(|error| WriteBackError::File { file: file.to_owned(), error })
}

/// Sets a value in the first text that has a place for it.
fn set(texts: &mut [TextChange], value: &Override) -> Result<(), WriteBackError> {
    let mut error: Option<PathError> = None;
    for (index, change) in texts.iter_mut().enumerate() {
        if index > 0 && !value.is_named() {
            break;
        }
        if counts_other_files(&change.after, value.path()) {
            let cause = "an index counts the entities of all files; give the entity a name".to_owned();
            return Err(WriteBackError::Path { value: value.to_string(), cause });
        }
        match edit_for(&change.after, value) {
            Ok(Some(Edit { range, text })) => {
                change.after.replace_range(range, &text);
                return Ok(());
            }
            Ok(None) => {}
            Err(none) => match &mut error {
                Some(error) => error.or_in(none),
                None => error = Some(none),
            },
        }
    }
    let (message, help) = error.map_or_else(
        || ("the file is not a scene".to_owned(), "name a scene file".to_owned()),
        |error| error.explain(),
    );
    Err(WriteBackError::Path { value: value.to_string(), cause: format!("{message}; {help}") })
}
