//! The errors of a scene, across all its files.

use std::fmt;
use std::path::PathBuf;
use std::sync::Arc;

use super::extend::EXTENDS;
use super::files::{Files, SceneFile};
use super::input::InputFiles;
use super::quote::short;
use super::source_text::{SourceLine, SourceText, TextFile};
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
    /// All files that were looked for.
    looked_for: Vec<PathBuf>,
    is_transient: bool,
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

/// The location of an include, or of the field in which a scene extends another.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Inclusion {
    /// The including or extending file.
    pub file: String,
    /// The line on which the include or the path of the extended scene starts, from 1.
    pub line: usize,
    /// The relation of the files.
    pub kind: InclusionKind,
}

/// The relation of a file to the file that names it.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum InclusionKind {
    /// It is included.
    Included,
    /// It is extended.
    Extended,
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
        let InputFiles { paths: looked_for, is_transient, .. } = files.inputs;
        let mut inclusions = Vec::new();
        for file in &files.files {
            inclusions.push(inclusions_of(file, &files.files, &inclusions));
        }
        let own = files.files.first();
        let (file, mut room) = (own.map(|file| file.source.name().to_owned()), Self::MOST);
        let (mut unlisted, mut repeated) = (0, 0);
        let mut faulty = Vec::new();
        for (file, included_from) in files.files.into_iter().zip(inclusions) {
            let SceneFile { source, overridden, mistake, problems, .. } = file;
            let errors = problems.into_errors();
            repeated += errors.repeated();
            let (located, more) = errors.locate(source.text());
            unlisted += more;
            let mut by_file = vec![Vec::new(); source.files().len()];
            by_file[0].extend(mistake);
            for diagnostic in located {
                let (file, diagnostic) = original(&source, diagnostic);
                by_file[file].push(diagnostic);
            }
            let chains = extensions_of(&source, included_from);
            for ((file, mut diagnostics), included_from) in source.files().iter().zip(by_file).zip(chains) {
                if source.is_composed() {
                    diagnostics.sort_by_key(position);
                }
                unlisted += diagnostics.len().saturating_sub(room);
                diagnostics.truncate(room);
                room -= diagnostics.len();
                if !diagnostics.is_empty() {
                    let TextFile { name, text, .. } = file.clone();
                    let overridden = overridden.clone();
                    faulty.push(FaultyFile { name, text, overridden, included_from, diagnostics });
                }
            }
        }
        Self { file: file.unwrap_or_default(), faulty, unlisted, repeated, looked_for, is_transient }
    }

    /// Returns the scene file, as it was named.
    #[must_use]
    pub fn file(&self) -> &str {
        &self.file
    }

    /// Returns all files that were looked for: the scene file, its includes and its script files, including missing ones.
    #[must_use]
    pub fn files(&self) -> &[PathBuf] {
        &self.looked_for
    }

    /// Returns whether a file exists but could not be read, so that a later attempt may succeed without a change.
    #[must_use]
    pub fn is_transient(&self) -> bool {
        self.is_transient
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
        let included = self.included_from.iter().map(|from| match from.kind {
            InclusionKind::Included => format!("included from {from}"),
            InclusionKind::Extended => format!("extended from {from}"),
        });
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
    let Some(from) = file.from else {
        return Vec::new();
    };
    let kind = if from.list == EXTENDS { InclusionKind::Extended } else { InclusionKind::Included };
    let source = &files[from.file].source;
    let (file, _) = source.original(&locate(source.text(), &[from.path()])[0]);
    let first = Inclusion::new(source.line_of(&from.path()), kind);
    // The place can be in a file that this one extends.
    let chain = extensions_of(source, known[from.file].clone()).swap_remove(file);
    [vec![first], chain].concat()
}

/// Returns the chains that lead to the files of a text, given the chain that leads to the first.
fn extensions_of(source: &SourceText, first: Vec<Inclusion>) -> Vec<Vec<Inclusion>> {
    let mut chains = vec![first];
    for TextFile { name, text, .. } in &source.files()[..source.files().len() - 1] {
        let span = &locate(text, &[vec![PathStep::Field(EXTENDS)]])[0];
        let line = SourceLine { file: name, line: SourcePosition::of(text, span.start).line };
        let before = chains.last().cloned().unwrap_or_default();
        chains.push([vec![Inclusion::new(line, InclusionKind::Extended)], before].concat());
    }
    chains
}

/// Returns the file of a text that contains an error, and the error with its position there.
pub(super) fn original(source: &SourceText, mut diagnostic: Diagnostic) -> (usize, Diagnostic) {
    match &mut diagnostic {
        Diagnostic { span: Some(span), source: None, .. } => {
            let (file, original) = source.original(span);
            *span = original;
            (file, diagnostic)
        }
        // In a script file.
        _ => (0, diagnostic),
    }
}

/// Returns the position of an error in its file. Errors in script files follow all others of a scene that extends another.
fn position(diagnostic: &Diagnostic) -> Option<usize> {
    match diagnostic {
        Diagnostic { source: Some(_), .. } => Some(usize::MAX),
        _ => diagnostic.span.as_ref().map(|span| span.start),
    }
}

impl Inclusion {
    fn new(line: SourceLine<'_>, kind: InclusionKind) -> Self {
        Self { file: line.file.to_owned(), line: line.line, kind }
    }
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
