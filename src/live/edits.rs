//! Values of a scene that are changed by hand: tried as overrides, then written into the files.

use std::fs;
use std::path::{Path, PathBuf};

use serde::Serialize;

use crate::color::Transfer;
use crate::output;
use crate::scene::{KeyChange, Override, OverrideError, TextChange, joined, written_value};

/// Maximum number of changes that can be taken back.
pub(super) const MAX_UNDO: usize = 1000;

pub(super) const UNSAVED: &str = "some values are not in the file yet: keep or discard them first";

/// The values of a scene that are changed by hand.
#[derive(Debug, Default)]
pub(super) struct Edits {
    /// Overrides that hold as long as the session.
    own: Vec<Override>,
    tried: Vec<TriedValue>,
    /// The changes of the files, each of one or several files, the last one at the end.
    written: Vec<Vec<TextChange>>,
    /// The changes that were taken back since the last new one, the last one at the end.
    undone: Vec<Vec<TextChange>>,
    /// The last change of a file.
    last: Option<LastChange>,
    /// The reason why the view that is looked from is not written; `None` for the view of the camera.
    look: Option<String>,
}

/// The last change of a file by a page.
#[derive(Clone, Debug, PartialEq, Eq, Serialize)]
pub struct LastChange {
    /// The first changed line, as `ball.ron:12`.
    pub place: String,
    /// True if the change was taken back.
    pub is_undone: bool,
}

/// An override that is not written yet.
#[derive(Clone, Debug)]
pub(super) struct TriedValue {
    value: Override,
    /// The text of the value in the files when it was first tried; `None` for a field that the files omit.
    replaced: Option<String>,
}

/// The state of the changes, for pages.
#[derive(Clone, Debug, Default, PartialEq, Eq, Serialize)]
pub struct EditState {
    /// True if there are files to be edited.
    pub possible: bool,
    /// True if an editor can be opened.
    pub opens: bool,
    /// The overrides that are not written yet.
    pub tried: Vec<String>,
    /// Number of changes of the files that can be taken back.
    pub undoable: usize,
    /// Number of changes that were taken back and can be made again.
    pub redoable: usize,
    /// The last change of a file; `None` while values are tried.
    pub last: Option<LastChange>,
    /// The reason why the view that is looked from is not written; `None` for the view of the camera.
    pub look: Option<String>,
    /// The reason why overrides have ended, if they were not ended by a page.
    pub notice: Option<String>,
}

impl Edits {
    pub(super) fn new(own: Vec<Override>) -> Self {
        Self { own, ..Self::default() }
    }

    /// Returns all overrides, in the order in which they apply.
    pub(super) fn overrides(&self) -> Vec<Override> {
        self.own.iter().chain(self.tried.iter().map(|tried| &tried.value)).cloned().collect()
    }

    pub(super) fn state(&self, opens: bool, notice: Option<String>) -> EditState {
        EditState {
            possible: true,
            opens,
            tried: self.tried.iter().map(|tried| tried.value.to_string()).collect(),
            undoable: self.written.len(),
            redoable: self.undone.len(),
            last: self.last.clone().filter(|_| self.tried.is_empty()),
            look: self.look.clone(),
            notice,
        }
    }

    /// Returns the overrides that are not written yet.
    fn tried(&self) -> Vec<Override> {
        self.tried.iter().map(|tried| tried.value.clone()).collect()
    }

    /// Tries values and changes of keys. Returns the former overrides, for [`restore`](Self::restore), or the reason why it is not possible.
    pub(super) fn attempt(
        &mut self,
        values: &[String],
        keys: &[KeyChange],
        files: &[PathBuf],
        transfer: Transfer,
    ) -> Result<Vec<TriedValue>, String> {
        let tried = self.tried();
        let values =
            values.iter().map(|value| value.parse().map_err(|error: OverrideError| error.to_string()));
        let keys = keys.iter().map(|change| change.to_override(files, &tried, transfer));
        self.try_values(values.chain(keys).collect::<Result<_, _>>()?, files)
    }

    /// Adds overrides, each in place of an earlier one of the same path. Returns the former ones. A value
    /// within an overridden one, or around it, is an error: its index may be that of another one, and one of the two would be lost.
    fn try_values(&mut self, values: Vec<Override>, files: &[PathBuf]) -> Result<Vec<TriedValue>, String> {
        let nests = |one: &[String], other: &[String]| one.len() < other.len() && other.starts_with(one);
        let overlap = |one: &Override, other: &Override| {
            nests(one.path(), other.path()) || nests(other.path(), one.path())
        };
        if values.iter().any(|value| self.tried.iter().any(|tried| overlap(value, &tried.value))) {
            return Err(UNSAVED.to_owned());
        }
        let before = self.tried.clone();
        for value in values {
            match self.tried.iter_mut().find(|tried| tried.value.path() == value.path()) {
                Some(tried) => tried.value = value,
                None => {
                    let replaced = written_value(value.path(), files);
                    self.tried.push(TriedValue { value, replaced });
                }
            }
        }
        Ok(before)
    }

    pub(super) fn restore(&mut self, before: Vec<TriedValue>) {
        self.tried = before;
    }

    pub(super) fn drop_tried(&mut self) {
        self.tried.clear();
    }

    /// Ends the overrides at paths, which are written as an [`Override`] has them before its `=`.
    pub(super) fn drop_paths(&mut self, paths: &[String]) {
        self.tried.retain(|tried| !paths.contains(&joined(tried.value.path())));
    }

    pub(super) fn has_tried(&self) -> bool {
        !self.tried.is_empty()
    }

    /// Returns whether the scene is looked at from a view that is not written.
    pub(super) fn is_look(&self) -> bool {
        self.look.is_some()
    }

    /// Begins or ends to look from a view that is not written, for the given reason.
    pub(super) fn set_look(&mut self, reason: Option<String>) {
        self.look = reason;
    }

    /// Ends the overrides if a program has changed one of the values that they replace. Returns whether it has.
    pub(super) fn yield_to(&mut self, files: &[PathBuf]) -> bool {
        let is_changed = |tried: &TriedValue| written_value(tried.value.path(), files) != tried.replaced;
        let yields = self.tried.iter().any(is_changed);
        if yields {
            self.drop_tried();
        }
        yields
    }

    /// Writes the overrides into the files, as one change. The overrides then end.
    pub(super) fn keep(&mut self, files: &[PathBuf]) -> Result<(), String> {
        if let (Some(reason), []) = (&self.look, &self.tried[..]) {
            return Err(reason.clone());
        }
        let changes = TextChange::setting(&self.tried(), files).map_err(|error| error.to_string())?;
        write_all(&changes)?;
        self.tried.clear();
        if !changes.is_empty() {
            self.undone.clear();
        }
        self.add_written(changes);
        Ok(())
    }

    /// Takes back the last change of the files. A change of a file that has been changed since stays, and cannot be taken back later.
    pub(super) fn undo(&mut self) -> Result<(), String> {
        let Some(changes) = self.written.pop() else { return Ok(()) };
        let back = changes.iter().rev().map(reversed).collect::<Vec<_>>();
        back.iter().try_for_each(write)?;
        self.last = last_change(&back, true);
        self.undone.push(changes);
        Ok(())
    }

    /// Makes the change again that was taken back last. A file that has been changed since stays as it is.
    pub(super) fn redo(&mut self) -> Result<(), String> {
        let Some(changes) = self.undone.pop() else { return Ok(()) };
        write_all(&changes)?;
        self.add_written(changes);
        Ok(())
    }

    fn add_written(&mut self, changes: Vec<TextChange>) {
        if changes.is_empty() {
            return;
        }
        self.last = last_change(&changes, false);
        self.written.push(changes);
        if self.written.len() > MAX_UNDO {
            self.written.remove(0);
        }
    }
}

/// Writes changes into all files or none.
fn write_all(changes: &[TextChange]) -> Result<(), String> {
    for (index, change) in changes.iter().enumerate() {
        if let Err(error) = write(change) {
            let _ = changes[..index].iter().try_for_each(|change| write(&reversed(change)));
            return Err(error);
        }
    }
    Ok(())
}

fn reversed(TextChange { file, before, after }: &TextChange) -> TextChange {
    TextChange { file: file.clone(), before: after.clone(), after: before.clone() }
}

/// Describes changes by the first line that differs.
fn last_change(changes: &[TextChange], is_undone: bool) -> Option<LastChange> {
    let TextChange { file, before, after } = changes.first()?;
    let line = 1 + before.lines().zip(after.lines()).take_while(|(before, after)| before == after).count();
    Some(LastChange { place: format!("{}:{line}", file.display()), is_undone })
}

fn write(change: &TextChange) -> Result<(), String> {
    replace(&change.file, &change.before, &change.after)
}

/// Replaces the text of a file, at once and with its permissions. Returns the reason why that failed, such as another text in the file.
fn replace(file: &Path, old: &str, new: &str) -> Result<(), String> {
    let failed = |error| format!("`{}`: {error}", file.display());
    if fs::read_to_string(file).map_err(failed)? != old {
        return Err(format!("`{}` was changed meanwhile: it stays as it is", file.display()));
    }
    // Through a link, the file that it leads to is replaced.
    let target = fs::canonicalize(file).map_err(failed)?;
    let permissions = fs::metadata(&target).map_err(failed)?.permissions();
    output::write_bytes(&target, new.as_bytes()).map_err(|error| error.to_string())?;
    fs::set_permissions(&target, permissions).map_err(failed)
}
