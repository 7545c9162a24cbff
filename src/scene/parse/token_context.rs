//! The tokens around an error.

use std::ops::Range;

use ron::error::{Position, SpannedError};

use crate::scene::quote::short;
use crate::scene::spans::{is_space, list_items, tokens};

/// The token at a position in a text, with its context.
#[derive(Debug)]
pub(super) struct TokenContext<'t> {
    text: &'t str,
    /// The token; empty at the end of the text.
    pub(super) found: Range<usize>,
    /// The preceding token.
    pub(super) previous: Option<Range<usize>>,
    /// The start offsets of the open brackets, innermost last.
    open: Vec<usize>,
    /// True if the parser stopped within the token, and not before it.
    pub(super) is_within: bool,
    /// The byte offset up to which the parser had read.
    pub(super) stopped: usize,
}

impl<'t> TokenContext<'t> {
    /// Finds the token at which the parser failed.
    pub(super) fn error(text: &'t str, error: &SpannedError) -> Self {
        let (start, end) = (byte_of(text, error.span.start), byte_of(text, error.span.end));
        // The text read last. Leading white space is ignored.
        let last = &text[start.min(end)..start.max(end)];
        let space = last.len() - last.trim_start_matches(is_space).len();
        let took_nothing = space == last.len();
        let context = Self::of(text, if took_nothing { end } else { start.min(end) + space });
        // The parser reads a word before it checks its value.
        let is_value = matches!(error.code, ron::Error::InvalidValueForType { .. });
        match context.previous {
            Some(word) if is_value && took_nothing => Self::of(text, word.start),
            _ => Self { stopped: start.max(end), ..context },
        }
    }

    fn of(text: &'t str, at: usize) -> Self {
        let (mut previous, mut open) = (None, Vec::new());
        for found in tokens(text) {
            if found.end > at {
                let is_within = found.start < at;
                return Self { text, found, previous, open, is_within, stopped: at };
            }
            match &text[found.clone()] {
                "(" | "[" | "{" => open.push(found.start),
                ")" | "]" | "}" => drop(open.pop()),
                _ => {}
            }
            previous = Some(found);
        }
        Self { text, found: text.len()..text.len(), previous, open, is_within: false, stopped: at }
    }

    /// Returns the token.
    pub(super) fn word(&self) -> &'t str {
        &self.text[self.found.clone()]
    }

    /// Returns the preceding token.
    pub(super) fn word_before(&self) -> &'t str {
        self.previous.clone().map_or("", |previous| &self.text[previous])
    }

    /// Returns the following token.
    pub(super) fn next(&self) -> &'t str {
        let rest = &self.text[self.found.end..];
        tokens(rest).next().map_or("", |next| &rest[next])
    }

    /// Returns whether the token directly follows the preceding one.
    pub(super) fn is_adjacent(&self) -> bool {
        self.previous.as_ref().is_some_and(|previous| previous.end == self.found.start)
    }

    pub(super) fn is_end(&self) -> bool {
        self.found.is_empty()
    }

    /// Returns the start of the innermost open bracket.
    pub(super) fn bracket(&self) -> Option<usize> {
        self.open.last().copied()
    }

    /// Returns the span of the innermost open bracket, and the number of values in it.
    pub(super) fn in_bracket(&self) -> Option<(Range<usize>, usize)> {
        self.bracket().map(|start| enclosed(self.text, start))
    }

    /// Returns the span of the token. For a bracket short enough to show as a whole, the span includes its content.
    pub(super) fn value(&self) -> Range<usize> {
        /// Maximum length of such a bracket, in bytes.
        const LONGEST: usize = 60;
        let span = match self.word() {
            "(" | "[" | "{" => enclosed(self.text, self.found.start).0,
            _ => return self.found.clone(),
        };
        let is_short = span.len() <= LONGEST && !self.text[span.clone()].contains('\n');
        if is_short { span } else { self.found.clone() }
    }

    /// Describes the token for messages.
    pub(super) fn describe(&self) -> String {
        let (word, rest) = (self.word(), &self.text[self.found.end..]);
        let first = word.chars().next();
        match first {
            None => "the end of the file".to_owned(),
            Some('(') => {
                let (_, count) = enclosed(self.text, self.found.start);
                let named = tokens(rest).nth(1).is_some_and(|second| &rest[second] == ":");
                match count {
                    0 => "empty brackets".to_owned(),
                    _ if named => "named values in round brackets".to_owned(),
                    1 => "a value in round brackets".to_owned(),
                    _ => format!("{count} values in round brackets"),
                }
            }
            Some('[') => "a list in square brackets".to_owned(),
            Some('{') => "a map in braces".to_owned(),
            Some(')' | ']' | '}' | ',' | ':') => format!("nothing before the `{word}`"),
            Some('"') => format!("the text {}", short(word)),
            Some('\'') => "a text in single quotes".to_owned(),
            Some(_) if word.parse::<f64>().is_ok() => format!("the number `{}`", short(word)),
            Some(first) if is_letter(first) && rest.starts_with('(') => format!("`{}( .. )`", short(word)),
            Some(first) if is_letter(first) && !word.contains('"') => format!("the word `{}`", short(word)),
            Some(_) => format!("`{}`", short(word)),
        }
    }
}

/// Returns the span of a bracket with its content, and the number of values in it.
fn enclosed(text: &str, start: usize) -> (Range<usize>, usize) {
    let mut depth = 0_usize;
    let close = tokens(&text[start..]).find(|token| {
        match &text[start..][token.clone()] {
            "(" | "[" | "{" => depth += 1,
            ")" | "]" | "}" => depth = depth.saturating_sub(1),
            _ => {}
        }
        depth == 0
    });
    let end = close.map_or(text.len(), |close| start + close.end);
    let inside = text[start..end].trim_end_matches([')', ']', '}']);
    (start..end, list_items(&inside[1..], 0).0.len())
}

fn is_letter(character: char) -> bool {
    character.is_alphabetic() || character == '_'
}

/// Returns the byte offset of a line and column of the RON parser, both from 1.
fn byte_of(text: &str, position: Position) -> usize {
    let line_start = match position.line {
        0 | 1 => 0,
        line => text
            .bytes()
            .enumerate()
            .filter(|(_, byte)| *byte == b'\n')
            .nth(line - 2)
            .map_or(text.len(), |(at, _)| at + 1),
    };
    let rest = &text[line_start..];
    rest.char_indices().nth(position.col.saturating_sub(1)).map_or(text.len(), |(at, _)| line_start + at)
}
