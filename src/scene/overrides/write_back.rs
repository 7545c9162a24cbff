//! Values that are written into the files of a scene.

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

/// An error in writing values into files.
#[derive(Debug, thiserror::Error)]
pub enum WriteBackError {
    /// A file could not be read or written.
    #[error("`{}`: {error}", file.display())]
    File {
        /// The file.
        file: PathBuf,
        /// The cause.
        error: io::Error,
    },
    /// A file no longer has the text from which a change was made.
    #[error("`{}` was changed meanwhile: it stays as it is", .0.display())]
    Changed(PathBuf),
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
    /// changes[0].write()?;
    /// changes[0].undo()?;
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

    /// Replaces the text before the change by the one after it. The file is replaced at once: no reader sees a part of it.
    ///
    /// # Errors
    ///
    /// If the file has another text, or cannot be written.
    pub fn write(&self) -> Result<(), WriteBackError> {
        self.replace(&self.before, &self.after)
    }

    /// Replaces the text after the change by the one before it.
    ///
    /// # Errors
    ///
    /// As [`write`](Self::write).
    pub fn undo(&self) -> Result<(), WriteBackError> {
        self.replace(&self.after, &self.before)
    }

    fn replace(&self, old: &str, new: &str) -> Result<(), WriteBackError> {
        if read(&self.file)? != old {
            return Err(WriteBackError::Changed(self.file.clone()));
        }
        let failed = |error| WriteBackError::File { file: self.file.clone(), error };
        // Through a link, the file that it leads to is replaced.
        let file = fs::canonicalize(&self.file).map_err(failed)?;
        let mut name = file.file_name().unwrap_or_default().to_owned();
        name.push(".rayreel");
        let next = file.with_file_name(name);
        let written = fs::write(&next, new)
            .and_then(|()| fs::set_permissions(&next, fs::metadata(&file)?.permissions()))
            .and_then(|()| fs::rename(&next, &file));
        written.map_err(|error| {
            let _ = fs::remove_file(&next);
            failed(error)
        })
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

fn scene_files(files: &[PathBuf]) -> impl Iterator<Item = &PathBuf> {
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
