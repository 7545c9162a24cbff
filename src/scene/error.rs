//! The mistakes of a scene, in all its files.

use std::fmt;
use std::path::PathBuf;
use std::sync::Arc;

use super::files::{Files, SceneFile};
use super::quote::short;
use super::spans::{PathStep, locate};
use super::{Diagnostic, SourcePosition};

/// The reason why a scene could not be loaded. Displays as a compiler would, without colours.
#[derive(Clone, Debug)]
pub struct LoadError {
    file: String,
    faulty: Vec<FaultyFile>,
    unlisted: usize,
    /// The number of mistakes that the labels of equal ones count.
    repeated: usize,
    files: Vec<PathBuf>,
}

/// A file with mistakes.
#[derive(Clone, Debug)]
struct FaultyFile {
    name: String,
    text: Arc<String>,
    overridden: Vec<String>,
    included_from: Vec<Inclusion>,
    diagnostics: Vec<Diagnostic>,
}

/// A place at which a file is included.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Inclusion {
    /// The file that includes it.
    pub file: String,
    /// The line, from 1, in which the include starts.
    pub line: usize,
}

/// Locates a mistake: describes it, with the file, the position in it, and the includes that brought the file.
#[derive(Clone, Copy, Debug)]
pub struct Mistake<'a> {
    /// The file, as it was named or as it was included.
    pub file: &'a str,
    /// The position in the file; `None` where there is no text.
    pub position: Option<SourcePosition>,
    /// The include that brought the file, the one that brought the file which that one is in, and so on. Empty for the
    /// scene's own file.
    pub included_from: &'a [Inclusion],
    /// Cause and remedy.
    pub diagnostic: &'a Diagnostic,
}

impl LoadError {
    /// The most mistakes that are listed.
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
        Self { file: file.unwrap_or_default(), faulty, unlisted, repeated, files: files.paths }
    }

    /// Returns the scene's own file, as it was named.
    #[must_use]
    pub fn file(&self) -> &str {
        &self.file
    }

    /// Returns all files that were looked for: the scene's own, and those it includes, also those that do not exist.
    #[must_use]
    pub fn files(&self) -> &[PathBuf] {
        &self.files
    }

    /// Returns the mistakes, file by file and in the order of each; of very many, and of equal ones, only the first.
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

    /// Returns the number of mistakes that are not listed.
    #[must_use]
    pub fn unlisted(&self) -> usize {
        self.unlisted + self.repeated
    }

    /// Renders all mistakes as a compiler would, with colours for a terminal or without.
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

/// Returns the includes that brought a file, from the nearest to the one in the scene's own file. Includes come before what they
/// include.
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
