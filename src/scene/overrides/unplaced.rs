//! Finds the file of a scene that a value belongs to.

use super::Override;
use super::put::{NoPlace, put};
use crate::scene::Diagnostic;
use crate::scene::quote::short;

/// Values that no file has had a place for yet.
#[derive(Debug, Default)]
pub(in crate::scene) struct Unplaced {
    /// Each with the reason why the scene's own file has none, once that has been read.
    values: Vec<(Override, Option<NoPlace>)>,
}

impl Unplaced {
    pub(in crate::scene) fn new(overrides: &[Override]) -> Self {
        Self { values: overrides.iter().map(|value| (value.clone(), None)).collect() }
    }

    /// Puts values into the text of a file, the scene's own first. What has a name is looked for in what is included, too. Returns the
    /// values that have found their place, as they are written.
    pub(in crate::scene) fn place(&mut self, text: &mut String) -> Vec<String> {
        let mut placed = Vec::new();
        self.values.retain_mut(|(value, reason)| {
            if reason.is_some() && !value.is_named() {
                return true;
            }
            match put(text, value) {
                Ok(changed) => {
                    *text = changed;
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

    /// Returns the mistake of the first value that has found no place at all.
    pub(in crate::scene) fn mistake(&self) -> Option<Diagnostic> {
        let (value, reason) = self.values.first()?;
        let (message, help) = reason.as_ref()?.tell();
        let value = short(&value.to_string());
        Some(Diagnostic::new(format!("`{value}`: {message}"), "", Some(help), None))
    }
}
