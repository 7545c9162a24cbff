//! Assignment of overrides to the files of a scene.

use super::Override;
use super::set_value::{Edit, PathError, edit_for};
use crate::scene::Diagnostic;
use crate::scene::quote::short;
use crate::scene::source_text::SourceText;

/// Overrides that have not been applied to any file yet.
#[derive(Debug, Default)]
pub(in crate::scene) struct Unplaced {
    /// Each override with its error in the files read so far; `None` before the first file.
    values: Vec<(Override, Option<PathError>)>,
}

impl Unplaced {
    pub(in crate::scene) fn new(overrides: &[Override]) -> Self {
        Self { values: overrides.iter().map(|value| (value.clone(), None)).collect() }
    }

    /// Applies overrides to the text of a file, and returns the applied ones as written. The scene file comes first. Overrides of named
    /// elements are also tried in included files.
    pub(in crate::scene) fn place(&mut self, source: &mut SourceText) -> Vec<String> {
        let mut placed = Vec::new();
        self.values.retain_mut(|(value, reason)| {
            if reason.is_some() && !value.is_named() {
                return true;
            }
            match edit_for(source.text(), value) {
                Ok(edit) => {
                    if let Some(Edit { range, text }) = edit.map(|edit| edit.on_its_lines(source.text())) {
                        source.replace(range, &text);
                    }
                    placed.push(value.to_string());
                    false
                }
                Err(none) => {
                    match reason {
                        Some(reason) => reason.or_in(none),
                        None => *reason = Some(none),
                    }
                    true
                }
            }
        });
        placed
    }

    /// Returns the error of the first override that could not be applied to any file.
    pub(in crate::scene) fn mistake(&self) -> Option<Diagnostic> {
        let (value, reason) = self.values.first()?;
        let (message, help) = reason.as_ref()?.explain();
        let value = short(&value.to_string());
        Some(Diagnostic::new(format!("`{value}`: {message}"), "", Some(help), None))
    }
}
