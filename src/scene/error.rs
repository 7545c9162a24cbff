//! The errors of a scene, across all its files.

use std::fmt;
use std::path::PathBuf;
use std::sync::Arc;

use super::files::{Files, SceneFile};
use super::input::InputFiles;
use super::quote::short;
use super::spans::{PathStep, locate};
use super::{Diagnostic, SourcePosition};

/// The errors that prevent a scene from loading. `Display` renders them in compiler style, without colours.
#[derive(Clone)]
pub struct LoadError {
    file: String,
    faulty: Vec<FaultyFile>,
    unlisted: usize,
    /// The number of errors counted in the labels of equal errors.
    repeated: usize,
    inputs: InputFiles,
}

debug_as_message!(LoadError);

/// A file with errors.
#[derive(Clone, Debug)]
struct FaultyFile {
    name: String,
    text: Arc<String>,
    overridden: Vec<String>,
    included_from: Vec<Inclusion>,
    diagnostics: Vec<Diagnostic>,
}

/// The location of an include.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Inclusion {
    /// The including file.
    pub file: String,
    /// The line on which the include starts, from 1.
    pub line: usize,
}

/// An error with its file, its position in the file, and the chain of includes that leads to the file.
#[derive(Clone, Copy, Debug)]
pub struct Mistake<'a> {
    /// The file, as named by the caller or by the include.
    pub file: &'a str,
    /// The position in the file; `None` if there is no text to mark.
    pub position: Option<SourcePosition>,
    /// The chain of includes that leads to the file, innermost first. Empty for the scene file itself.
    pub included_from: &'a [Inclusion],
    /// The cause and the remedy.
    pub diagnostic: &'a Diagnostic,
}

impl LoadError {
    /// Maximum number of listed errors.
    const MOST: usize = 50;

    pub(super) fn new(files: Files) -> Self {
        let mut inclusions = Vec::new();
        for file in &files.files {
            inclusions.push(inclusions_of(file, &files.files, &inclusions));
        }
        let own = files.files.first();
        let (file, mut room) = (own.map(|file| file.name.clone()), Self::MOST);
        let (mut unlisted, mut repeated) = (0, 0);
        let mut faulty = Vec::new();
        for (file, included_from) in files.files.into_iter().zip(inclusions) {
            let SceneFile { name, text, overridden, mistake, problems, .. } = file;
            repeated += problems.repeated();
            let (located, more) = problems.locate(&text);
            let mut diagnostics: Vec<Diagnostic> = mistake.into_iter().chain(located).collect();
            unlisted += more + diagnostics.len().saturating_sub(room);
            diagnostics.truncate(room);
            room -= diagnostics.len();
            if !diagnostics.is_empty() {
                faulty.push(FaultyFile { name, text, overridden, included_from, diagnostics });
            }
        }
        Self { file: file.unwrap_or_default(), faulty, unlisted, repeated, inputs: files.inputs }
    }

    /// Returns the scene file, as it was named.
    #[must_use]
    pub fn file(&self) -> &str {
        &self.file
    }

    /// Returns all files that were looked for: the scene file, its includes and its script files, including missing ones.
    #[must_use]
    pub fn files(&self) -> &[PathBuf] {
        &self.inputs.paths
    }

    /// Returns whether a file exists but could not be read, so that a later attempt may succeed without a change.
    #[must_use]
    pub fn is_transient(&self) -> bool {
        self.inputs.is_transient
    }

    /// Returns the errors, grouped by file and sorted by position. If there are very many errors, or several equal ones, only the first are
    /// returned.
    pub fn mistakes(&self) -> impl Iterator<Item = Mistake<'_>> {
        self.faulty.iter().flat_map(|file| {
            file.diagnostics.iter().map(|diagnostic| {
                let source = diagnostic.source.as_deref();
                let (name, text) =
                    source.map_or((&file.name, &*file.text), |source| (&source.file, &source.text));
                Mistake {
                    file: name,
                    position: diagnostic.span.as_ref().map(|span| SourcePosition::of(text, span.start)),
                    included_from: &file.included_from,
                    diagnostic,
                }
            })
        })
    }

    /// Returns the number of errors that are not listed.
    #[must_use]
    pub fn unlisted(&self) -> usize {
        self.unlisted + self.repeated
    }

    /// Renders all errors in compiler style, optionally with terminal colours.
    #[must_use]
    pub fn render(&self, color: bool) -> String {
        let mut parts: Vec<String> = self.faulty.iter().flat_map(|file| file.render(color)).collect();
        match self.unlisted {
            0 => {}
            1 => parts.push("and 1 more mistake".to_owned()),
            more => parts.push(format!("and {more} more mistakes")),
        }
        parts.join("\n\n")
    }
}

impl FaultyFile {
    fn render(&self, color: bool) -> impl Iterator<Item = String> {
        let included = self.included_from.iter().map(|from| format!("included from {from}"));
        let overridden = self.overridden.iter().map(|value| format!("read with {}", short(value)));
        let notes: Vec<String> = included.chain(overridden).collect();
        self.diagnostics
            .iter()
            .map(move |diagnostic| diagnostic.render_with_notes(&self.name, &self.text, &notes, color))
    }
}

/// Returns the chain of includes that leads to a file, innermost first. `known` holds the chains of all preceding files, among them the
/// including file.
fn inclusions_of(file: &SceneFile, files: &[SceneFile], known: &[Vec<Inclusion>]) -> Vec<Inclusion> {
    let Some((including, index)) = file.from else {
        return Vec::new();
    };
    let text = &files[including].text;
    let span = &locate(text, &[vec![PathStep::Field("include"), PathStep::Index(index)]])[0];
    let line = SourcePosition::of(text, span.start).line;
    let mut inclusions = vec![Inclusion { file: files[including].name.clone(), line }];
    inclusions.extend(known[including].iter().cloned());
    inclusions
}

impl fmt::Display for Inclusion {
    fn fmt(&self, formatter: &mut fmt::Formatter<'_>) -> fmt::Result {
        write!(formatter, "{}:{}", self.file, self.line)
    }
}

impl fmt::Display for LoadError {
    fn fmt(&self, formatter: &mut fmt::Formatter<'_>) -> fmt::Result {
        formatter.write_str(&self.render(false))
    }
}

impl std::error::Error for LoadError {}
