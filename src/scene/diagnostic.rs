//! Diagnostics for errors in a scene: cause, position and remedy.

use std::fmt;
use std::ops::Range;
use std::sync::Arc;

use annotate_snippets::{AnnotationKind, Group, Level, Origin, Renderer, Snippet};

use super::escape::{Printable, is_printable};
use super::quote::bounded;

/// An error in a scene: its cause, its byte range in the text, and its remedy.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Diagnostic {
    /// The cause.
    pub message: String,
    /// The annotation at the marked bytes.
    pub label: String,
    /// The remedy.
    pub help: Option<String>,
    /// The marked byte range of the text; `None` if there is no text to mark.
    pub span: Option<Range<usize>>,
    /// The file and text that `span` refers to; `None` for the scene file being read.
    pub source: Option<Arc<Source>>,
}

/// A named source text of a scene, such as a script file.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Source {
    /// The name of the file.
    pub file: String,
    /// The text of the file.
    pub text: String,
}

/// A line and column in a text, counted as in editors.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct SourcePosition {
    /// The line, from 1.
    pub line: usize,
    /// The column in characters, from 1.
    pub column: usize,
}

impl SourcePosition {
    /// Returns the position of a byte offset.
    #[must_use]
    pub fn of(text: &str, byte: usize) -> Self {
        let before = &text[..text.floor_char_boundary(byte)];
        let line_start = before.rfind('\n').map_or(0, |newline| newline + 1);
        let line = before.bytes().filter(|byte| *byte == b'\n').count() + 1;
        Self { line, column: before[line_start..].chars().count() + 1 }
    }
}

impl Diagnostic {
    /// Creates a diagnostic. Every error of a scene is created here, which limits the length of its texts.
    pub(super) fn new(
        message: impl Into<String>,
        label: impl Into<String>,
        help: Option<String>,
        span: Option<Range<usize>>,
    ) -> Self {
        let (message, label) = (bounded(message.into()), bounded(label.into()));
        Self { message, label, help: help.map(bounded), span, source: None }
    }

    /// Sets the file and text that the span refers to.
    pub(super) fn within(self, source: Option<Arc<Source>>) -> Self {
        Self { source, ..self }
    }

    /// Renders the error in compiler style: message, file, line and column, the marked line, and help.
    pub(super) fn render(&self, file: &str, text: &str, color: bool) -> String {
        self.render_with_notes(file, text, &[], color)
    }

    pub(super) fn render_with_notes(&self, file: &str, text: &str, notes: &[String], color: bool) -> String {
        let (file, text) = self.source.as_ref().map_or((file, text), |source| (&source.file, &source.text));
        // Quoted file content may contain any character.
        let printable = |text: &str| Printable(text).to_string();
        let (file, label) = (printable(file), printable(&self.label));
        let mut group = Group::with_title(Level::ERROR.primary_title(printable(&self.message)));
        match &self.span {
            Some(span) => {
                let position = SourcePosition::of(text, span.start);
                let excerpt = Excerpt::around(text, span);
                let annotation = AnnotationKind::Primary.span(excerpt.marked).label(label);
                let snippet = Snippet::source(excerpt.line).line_start(position.line).annotation(annotation);
                group = if excerpt.is_cut {
                    group
                        .element(Origin::path(file).line(position.line).char_column(position.column))
                        .element(snippet)
                } else {
                    group.element(snippet.path(file))
                };
            }
            None => group = group.element(Origin::path(file)),
        }
        if let Some(help) = &self.help {
            group = group.element(Level::HELP.message(printable(help)));
        }
        for note in notes {
            group = group.element(Level::NOTE.message(printable(note)));
        }
        let renderer = if color { Renderer::styled() } else { Renderer::plain() };
        renderer.render(&[group])
    }
}

/// The first line of a span, truncated to a readable length.
struct Excerpt {
    line: String,
    marked: Range<usize>,
    /// True if the excerpt starts in the middle of its line.
    is_cut: bool,
}

impl Excerpt {
    /// Maximum number of bytes shown before and after the start of the span. Generated scenes may have a single line of many megabytes.
    const LONGEST: usize = 2000;

    fn around(text: &str, span: &Range<usize>) -> Self {
        let at = text.floor_char_boundary(span.start);
        let line_start = text[..at].rfind('\n').map_or(0, |newline| newline + 1);
        let line_end = text[at..].find('\n').map_or(text.len(), |newline| at + newline);
        let start = text.floor_char_boundary(line_start.max(at.saturating_sub(Self::LONGEST)));
        let end = text.floor_char_boundary(line_end.min(at + Self::LONGEST));
        let marked_end = text.floor_char_boundary(span.end).clamp(at, end);
        let [before, marked, after] =
            [start..at, at..marked_end, marked_end..end].map(|range| Self::shown(&text[range]));
        let marked_range = before.len()..before.len() + marked.len();
        Self { line: format!("{before}{marked}{after}"), marked: marked_range, is_cut: start > line_start }
    }

    /// Replaces unprintable characters, so that marks stay aligned with the marked text.
    fn shown(text: &str) -> String {
        let shown = |character| match character {
            // The renderer replaces ASCII control characters with symbols.
            '\0'..='\u{7f}' => character,
            _ if is_printable(character) => character,
            _ => char::REPLACEMENT_CHARACTER,
        };
        text.chars().map(shown).collect()
    }
}

impl fmt::Display for SourcePosition {
    fn fmt(&self, formatter: &mut fmt::Formatter<'_>) -> fmt::Result {
        write!(formatter, "{}:{}", self.line, self.column)
    }
}
