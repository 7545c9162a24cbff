//! The text of a scene, and the files that it comes from.
//!
//! The text of a scene that extends another is composed of parts of both files. Whatever reads it works on the composed text; positions
//! are converted to positions in the files only for messages:
//!
//! ```text
//! base.ron      (film: (width: 640, height: 360), ambient: (1, 1, 1))
//! scene.ron     (extends: "base.ron", film: (width: 64))
//! composed      (film: (width: 64, height: 360), ambient: (1, 1, 1), extends: "base.ron")
//! ```

use std::fmt;
use std::ops::Range;
use std::path::{Path, PathBuf};
use std::sync::Arc;

use super::SourcePosition;
use super::escape::Printable;
use super::spans::{PathStep, locate};

/// The text of a scene, with its files.
#[derive(Clone, Debug)]
pub(super) struct SourceText {
    text: Arc<String>,
    /// The files: the scene file, the file that it extends, the file that this one extends, and so on.
    files: Vec<TextFile>,
    /// The origins of the text, in its order, without gaps. Empty for the text of a single file.
    pieces: Vec<Piece>,
}

/// A file with its text.
#[derive(Clone, Debug)]
pub(super) struct TextFile {
    /// The name in messages.
    pub(super) name: String,
    /// The folder that paths in the file are relative to.
    pub(super) folder: PathBuf,
    pub(super) text: Arc<String>,
}

/// A part of a composed text that is copied from a file.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) struct Piece {
    /// The byte offset in the composed text.
    pub(super) start: usize,
    /// The index of the file.
    pub(super) file: usize,
    /// The byte offset in the file.
    pub(super) at: usize,
    /// The number of copied bytes. The bytes from there to the next piece are separators that no file contains.
    pub(super) length: usize,
}

/// A line of a file.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct SourceLine<'a> {
    /// The file, as named by the caller or by the include.
    pub file: &'a str,
    /// The line, from 1.
    pub line: usize,
}

impl Piece {
    /// Returns the byte offset in the file for one in the composed text.
    fn original(&self, byte: usize) -> usize {
        self.at + byte.saturating_sub(self.start).min(self.length)
    }
}

impl SourceText {
    /// Creates the text of a single file.
    pub(super) fn new(path: &Path, text: String) -> Self {
        let folder = path.parent().unwrap_or(Path::new("")).to_owned();
        let text = Arc::new(text);
        let file = TextFile { name: path.display().to_string(), folder, text: Arc::clone(&text) };
        Self { text, files: vec![file], pieces: Vec::new() }
    }

    /// Creates a text that is composed of files.
    pub(super) fn composed(text: String, files: Vec<TextFile>, pieces: Vec<Piece>) -> Self {
        Self { text: Arc::new(text), files, pieces }
    }

    pub(super) fn text(&self) -> &Arc<String> {
        &self.text
    }

    /// Returns the name of the scene file.
    pub(super) fn name(&self) -> &str {
        &self.files[0].name
    }

    pub(super) fn files(&self) -> &[TextFile] {
        &self.files
    }

    /// Returns whether the text is composed of several files.
    pub(super) fn is_composed(&self) -> bool {
        self.files.len() > 1
    }

    /// Returns the folders that the paths at these values are relative to.
    pub(super) fn folders(&self, values: &[Vec<PathStep>]) -> Vec<&Path> {
        if !self.is_composed() {
            return vec![&self.files[0].folder; values.len()];
        }
        let spans = locate(&self.text, values).into_iter();
        spans.map(|span| self.files[self.original(&span).0].folder.as_path()).collect()
    }

    /// Returns the file and the line on which a span starts.
    pub(super) fn line(&self, span: &Range<usize>) -> SourceLine<'_> {
        let (file, span) = self.original(span);
        let TextFile { name, text, .. } = &self.files[file];
        SourceLine { file: name, line: SourcePosition::of(text, span.start).line }
    }

    /// Returns the file and the line on which a value starts.
    pub(super) fn line_of(&self, value: &[PathStep]) -> SourceLine<'_> {
        self.line(&locate(&self.text, &[value.to_vec()])[0])
    }

    /// Returns the index of the file that contains the last byte of a span, or the byte before an empty span; and the part of the span in
    /// this file. A value is written where its bracket is closed: its members can come from other files.
    pub(super) fn original(&self, span: &Range<usize>) -> (usize, Range<usize>) {
        if self.pieces.is_empty() {
            return (0, span.clone());
        }
        let last = self.piece_at(span.end.saturating_sub(1));
        let Piece { file, .. } = self.pieces[last];
        let end = self.pieces[last].original(span.end);
        let first = (self.piece_at(span.start)..=last).find(|index| self.pieces[*index].file == file);
        let start = first.map_or(end, |first| self.pieces[first].original(span.start));
        (file, start.min(end)..end)
    }

    /// Returns the index of the piece at a byte.
    fn piece_at(&self, byte: usize) -> usize {
        self.pieces.partition_point(|piece| piece.start <= byte).saturating_sub(1)
    }

    /// Returns the pieces of a part of the text.
    pub(super) fn pieces(&self, range: &Range<usize>) -> Vec<Piece> {
        if self.pieces.is_empty() {
            return vec![Piece { start: range.start, file: 0, at: range.start, length: range.len() }];
        }
        let of_part = |piece: &Piece| {
            let start = piece.start.max(range.start);
            let (at, end) = (piece.original(start), piece.original(range.end));
            Piece { start, at, length: end - at, ..*piece }
        };
        let from = self.piece_at(range.start);
        self.pieces[from..].iter().take_while(|piece| piece.start < range.end).map(of_part).collect()
    }

    /// Replaces a value or inserts a text, in the text and in the file that it comes from.
    pub(super) fn replace(&mut self, range: Range<usize>, with: &str) {
        let (file, original) = self.original(&range);
        if self.pieces.is_empty() {
            self.files[0].text = Arc::default();
            Arc::make_mut(&mut self.text).replace_range(range, with);
            self.files[0].text = Arc::clone(&self.text);
            return;
        }
        let before = self.pieces(&(0..range.start));
        let after = self.pieces(&(range.end..self.text.len()));
        let shifted = |piece: Piece| match piece.at {
            at if piece.file == file && at >= original.end => {
                Piece { at: at - original.len() + with.len(), ..piece }
            }
            _ => piece,
        };
        let new = Piece { start: range.start, file, at: original.start, length: with.len() };
        let moved = |piece: Piece| Piece { start: piece.start - range.len() + with.len(), ..piece };
        self.pieces = before.into_iter().map(shifted).collect();
        self.pieces.push(new);
        self.pieces.extend(after.into_iter().map(|piece| moved(shifted(piece))));
        Arc::make_mut(&mut self.files[file].text).replace_range(original, with);
        Arc::make_mut(&mut self.text).replace_range(range, with);
    }
}

impl fmt::Display for SourceLine<'_> {
    fn fmt(&self, formatter: &mut fmt::Formatter<'_>) -> fmt::Result {
        write!(formatter, "{}:{}", Printable(self.file), self.line)
    }
}
