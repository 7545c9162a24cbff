//! Values of a scene that are changed by hand: tried as overrides, then written into the files.

use std::path::PathBuf;

use serde::Serialize;

use crate::scene::{Override, TextChange, WriteBackError, written_value};

/// Maximum number of changes that can be taken back.
const MAX_UNDO: usize = 1000;

/// The values of a scene that are changed by hand.
#[derive(Debug, Default)]
pub(super) struct Edits {
    /// Overrides that hold as long as the session.
    own: Vec<Override>,
    /// Overrides that are not written yet, with the text that they replace in the files.
    tried: Vec<(Override, Option<String>)>,
    /// The changes of the files, each of one or several files, the last one at the end.
    written: Vec<Vec<TextChange>>,
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
    /// The reason why overrides have ended, if they were not ended by a page.
    pub notice: Option<String>,
}

impl Edits {
    pub(super) fn new(own: Vec<Override>) -> Self {
        Self { own, ..Self::default() }
    }

    /// Returns all overrides, in the order in which they apply.
    pub(super) fn overrides(&self) -> Vec<Override> {
        self.own.iter().chain(self.tried.iter().map(|(value, _)| value)).cloned().collect()
    }

    pub(super) fn state(&self, notice: Option<String>) -> EditState {
        EditState {
            possible: true,
            opens: false,
            tried: self.tried.iter().map(|(value, _)| value.to_string()).collect(),
            undoable: self.written.len(),
            notice,
        }
    }

    /// Adds overrides, each in place of an earlier one of the same path. Returns the former ones, for [`restore`](Self::restore).
    pub(super) fn try_values(&mut self, values: Vec<Override>, files: &[PathBuf]) -> Tried {
        let before = self.tried.clone();
        for value in values {
            match self.tried.iter_mut().find(|(tried, _)| tried.path() == value.path()) {
                Some((tried, _)) => *tried = value,
                None => {
                    let text = written_value(value.path(), files);
                    self.tried.push((value, text));
                }
            }
        }
        Tried(before)
    }

    pub(super) fn restore(&mut self, Tried(before): Tried) {
        self.tried = before;
    }

    pub(super) fn drop_tried(&mut self) -> bool {
        !std::mem::take(&mut self.tried).is_empty()
    }

    /// Ends the overrides if a program has changed one of the values that they replace. Returns whether it has.
    pub(super) fn yield_to(&mut self, files: &[PathBuf]) -> bool {
        let is_changed =
            |(value, before): &(Override, Option<String>)| written_value(value.path(), files) != *before;
        self.tried.iter().any(is_changed) && self.drop_tried()
    }

    /// Writes the overrides into the files, as one change. The overrides then end.
    pub(super) fn keep(&mut self, files: &[PathBuf]) -> Result<(), WriteBackError> {
        let values: Vec<Override> = self.tried.iter().map(|(value, _)| value.clone()).collect();
        let changes = TextChange::setting(&values, files)?;
        for (index, change) in changes.iter().enumerate() {
            if let Err(error) = change.write() {
                // All files or none.
                let _ = changes[..index].iter().try_for_each(TextChange::undo);
                return Err(error);
            }
        }
        self.tried.clear();
        if !changes.is_empty() {
            self.written.push(changes);
        }
        if self.written.len() > MAX_UNDO {
            self.written.remove(0);
        }
        Ok(())
    }

    /// Takes back the last change of the files. A change of a file that has been changed since stays, and cannot be taken back later.
    pub(super) fn undo(&mut self) -> Result<(), WriteBackError> {
        let changes = self.written.pop().unwrap_or_default();
        changes.iter().rev().try_for_each(TextChange::undo)
    }
}

/// The overrides before a change of them.
#[derive(Debug)]
pub(super) struct Tried(Vec<(Override, Option<String>)>);
