//! Locates values of the document in the text.
//!
//! Serde does not keep positions, so they are looked up when they are needed, in one pass over the text. The text has usually been parsed
//! without error before; the scanner reads only its brackets, names and commas.

mod bracket;
#[cfg(test)]
mod tests;

use std::ops::Range;

pub(super) use bracket::{
    Bracket, BracketMember, after_comma, bracket, first_field, is_one_value, literal_text, own_name, root,
};

/// A step from a value to one of its members.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) enum PathStep {
    /// The value of a named field.
    Field(&'static str),
    /// The value at an index of a list, a tuple or a map.
    Index(usize),
    /// The key at an index of a map.
    Key(usize),
}

/// Returns the spans of values, in the order of their paths. For a path that is not in the text, returns the span of the innermost
/// enclosing value, because the error may be a missing field.
pub(super) fn locate(text: &str, paths: &[Vec<PathStep>]) -> Vec<Range<usize>> {
    let mut found = vec![0..0; paths.len()];
    let wanted: Vec<Remaining<'_>> =
        paths.iter().enumerate().map(|(index, path)| Remaining { index, path: path.as_slice() }).collect();
    let mut scanner = Scanner { text, at: 0, found: &mut found };
    scanner.skip_extensions();
    scanner.value(&wanted);
    found
}

/// Converts a span within the content of a string literal to a span of the file. Returns the span of the whole literal if escapes make the
/// two differ.
pub(super) fn inside_text(text: &str, literal: Range<usize>, inside: &Range<usize>) -> Range<usize> {
    let written = &text[literal.clone()];
    let quotes = match written.strip_prefix('r') {
        Some(raw) => raw.len() - raw.trim_start_matches('#').len() + "r\"".len(),
        None if written.starts_with('"') && !written.contains('\\') => "\"".len(),
        None => return literal,
    };
    let place = |byte: usize| (literal.start + quotes + byte).min(literal.end);
    place(inside.start)..place(inside.end)
}

/// Returns the tokens in order: words, numbers, string literals and single characters. The text may be malformed.
pub(super) fn tokens(text: &str) -> impl Iterator<Item = Range<usize>> {
    let mut scanner = Scanner { text, at: 0, found: &mut [] };
    std::iter::from_fn(move || {
        scanner.skip_space();
        scanner.peek()?;
        let start = scanner.at;
        scanner.atom();
        Some(start..scanner.at)
    })
}

/// Returns the start of the last comment after all tokens, which is the unclosed one if there is one.
pub(super) fn open_comment(text: &str) -> Option<usize> {
    let after_all = tokens(text).last().map_or(0, |token| token.end);
    let mut scanner = Scanner { text, at: after_all, found: &mut [] };
    let mut last = None;
    loop {
        scanner.skip_white_space();
        let start = scanner.at;
        if !scanner.skip_comment() {
            return last;
        }
        last = Some(start);
    }
}

/// Returns whether the parser treats a character as white space. The set has fewer spaces than Unicode, and two additional directional
/// marks.
pub(super) fn is_space(character: char) -> bool {
    matches!(character, ' ' | '\t'..='\r' | '\u{85}' | '\u{200e}' | '\u{200f}' | '\u{2028}' | '\u{2029}')
}

/// Returns the start of the content of a list in a field of the scene itself; `None` if there is no such list, or if extensions precede the
/// scene. The text may be malformed.
pub(super) fn list_of(text: &str, field: &str) -> Option<usize> {
    let mut scanner = Scanner { text, at: 0, found: &mut [] };
    scanner.skip_space();
    if !matches!(scanner.peek(), Some(b'(' | b'#')) {
        scanner.atom();
        scanner.skip_space();
    }
    if scanner.peek() != Some(b'(') {
        return None;
    }
    scanner.at += 1;
    loop {
        scanner.skip_space();
        let name = scanner.field_name()?;
        scanner.skip_space();
        if name == field {
            return (scanner.peek() == Some(b'[')).then_some(scanner.at + 1);
        }
        scanner.value(&[]);
        scanner.comma();
    }
}

/// Returns the spans of the values in a list, and the end of its content. `start` is a byte of the content outside any value. The text may
/// be malformed.
pub(super) fn list_items(text: &str, start: usize) -> (Vec<Range<usize>>, usize) {
    let mut scanner = Scanner { text, at: start, found: &mut [] };
    let mut items = Vec::new();
    loop {
        scanner.skip_space();
        let start = scanner.at;
        match scanner.peek() {
            None | Some(b']') => return (items, start),
            Some(b',') => scanner.at += 1,
            Some(_) => {
                scanner.value(&[]);
                items.push(start..scanner.at);
            }
        }
    }
}

/// Returns the end of the value that starts at a byte. The text may be malformed.
pub(super) fn value_end(text: &str, start: usize) -> usize {
    let mut scanner = Scanner { text, at: start, found: &mut [] };
    scanner.value(&[]);
    scanner.at
}

/// Returns the start of the first value of a list whose content starts at a byte, or of the closing bracket.
pub(super) fn first_item(text: &str, content: usize) -> usize {
    let mut scanner = Scanner { text, at: content, found: &mut [] };
    scanner.skip_space();
    scanner.at
}

/// Returns the start of the value after the value of a list that ends at a byte, or of the closing bracket. `None` if neither a comma nor the
/// closing bracket follows the value.
pub(super) fn next_item(text: &str, end: usize) -> Option<usize> {
    let mut scanner = Scanner { text, at: end, found: &mut [] };
    scanner.skip_space();
    match scanner.peek()? {
        b']' => {}
        b',' => {
            scanner.at += 1;
            scanner.skip_space();
        }
        _ => return None,
    }
    Some(scanner.at)
}

/// The remaining steps of a path.
#[derive(Clone, Copy)]
struct Remaining<'a> {
    index: usize,
    path: &'a [PathStep],
}

struct Scanner<'a, 'f> {
    text: &'a str,
    at: usize,
    found: &'f mut [Range<usize>],
}

impl<'a> Scanner<'a, '_> {
    fn peek(&self) -> Option<u8> {
        self.text.as_bytes().get(self.at).copied()
    }

    /// Skips extensions above a scene, such as `#![enable(implicit_some)]`.
    fn skip_extensions(&mut self) {
        self.skip_space();
        while self.peek() == Some(b'#') {
            // `#` and `!`.
            self.atom();
            self.atom();
            self.value(&[]);
            self.skip_space();
        }
    }

    /// Skips white space and comments.
    fn skip_space(&mut self) {
        self.skip_white_space();
        while self.skip_comment() {
            self.skip_white_space();
        }
    }

    fn skip_white_space(&mut self) {
        let rest = &self.text[self.at..];
        self.at += rest.len() - rest.trim_start_matches(is_space).len();
    }

    /// Skips a comment; returns whether there was one.
    fn skip_comment(&mut self) -> bool {
        let rest = &self.text[self.at..];
        if rest.starts_with("//") {
            self.at += rest.find('\n').unwrap_or(rest.len());
        } else if rest.starts_with("/*") {
            self.skip_block_comment();
        } else {
            return false;
        }
        true
    }

    /// Skips a block comment. Block comments nest.
    fn skip_block_comment(&mut self) {
        let bytes = self.text.as_bytes();
        let mut depth = 0_usize;
        while self.at < bytes.len() {
            let pair = &bytes[self.at..bytes.len().min(self.at + 2)];
            if pair == b"/*" {
                depth += 1;
                self.at += 2;
            } else if pair == b"*/" {
                depth -= 1;
                self.at += 2;
            } else {
                self.at += 1;
            }
            if depth == 0 {
                break;
            }
        }
        // Never stop inside a character.
        while !self.text.is_char_boundary(self.at) {
            self.at += 1;
        }
    }

    /// Skips a string literal, a number or a name, or else one character.
    fn atom(&mut self) {
        let rest = &self.text[self.at..];
        let ends_word = |character: char| !(character.is_alphanumeric() || "_.+-".contains(character));
        let word = rest.find(ends_word).unwrap_or(rest.len());
        let prefix = &rest[..word];
        let after = rest[word..].chars().next();
        self.at += match (prefix, after) {
            ("" | "b", Some('"')) => word + quoted(&rest[word..], '"'),
            ("" | "b", Some('\'')) => word + quoted(&rest[word..], '\''),
            ("r" | "br", Some('"')) => word + raw_quoted(&rest[word..]),
            ("r" | "br", Some('#')) if rest[word..].trim_start_matches('#').starts_with('"') => {
                word + raw_quoted(&rest[word..])
            }
            // A raw identifier, such as r#type.
            ("r", Some('#')) => word + 1 + rest[word + 1..].find(ends_word).unwrap_or(rest.len() - word - 1),
            ("", Some(character)) => character.len_utf8(),
            _ => word,
        };
    }

    /// Scans a whole value: an optional name followed by brackets, or an atom.
    fn value(&mut self, wanted: &[Remaining<'_>]) {
        self.skip_space();
        let start = self.at;
        let mut name = "";
        if !matches!(self.peek(), Some(b'(' | b'[' | b'{') | None) {
            self.atom();
            name = &self.text[start..self.at];
            let end = self.at;
            self.skip_space();
            let is_name = name.chars().next().is_some_and(|first| first.is_alphabetic() || first == '_');
            if !(is_name && self.peek() == Some(b'(')) {
                self.at = end;
            }
        }
        let mut end = self.at;
        let opens = end == start || !name.is_empty() && self.peek() == Some(b'(');
        match self.peek() {
            Some(b'(' | b'[' | b'{') if opens && wanted.is_empty() => self.skip_brackets(),
            Some(b'(') if name == "Some" => {
                self.at += 1;
                self.value(wanted);
                self.skip_space();
                self.at += 1;
                end = self.at;
            }
            Some(b'(' | b'[') if opens => {
                self.members(wanted);
                end = self.at;
            }
            Some(b'{') if end == start => {
                self.entries(wanted);
                end = self.at;
            }
            _ => {}
        }
        for wanted in wanted {
            // A path without a deeper match ends here.
            if self.found[wanted.index].is_empty() {
                self.found[wanted.index] = start..end;
            }
        }
    }

    /// Skips a bracket with all its content.
    fn skip_brackets(&mut self) {
        let mut depth = 0_usize;
        loop {
            match self.peek() {
                None => return,
                Some(b'(' | b'[' | b'{') => {
                    depth += 1;
                    self.at += 1;
                }
                Some(b')' | b']' | b'}') => {
                    depth -= 1;
                    self.at += 1;
                    if depth == 0 {
                        return;
                    }
                }
                Some(_) => self.atom(),
            }
            self.skip_space();
        }
    }

    /// Scans the fields or values of a bracket.
    fn members(&mut self, wanted: &[Remaining<'_>]) {
        self.at += 1;
        for index in 0.. {
            self.skip_space();
            match self.peek() {
                None => return,
                Some(b')' | b']') => {
                    self.at += 1;
                    return;
                }
                Some(_) => {}
            }
            let field = self.field_name();
            let deeper = follow(wanted, |step| match (step, field) {
                (PathStep::Field(name), Some(field)) => *name == field,
                (PathStep::Index(place), None) => *place == index,
                _ => false,
            });
            self.value(&deeper);
            self.comma();
        }
    }

    /// Reads `name :` if it is next.
    fn field_name(&mut self) -> Option<&'a str> {
        let start = self.at;
        let first = self.text[start..].chars().next()?;
        if first.is_alphabetic() || first == '_' {
            self.atom();
            let name = &self.text[start..self.at];
            self.skip_space();
            if self.peek() == Some(b':') {
                self.at += 1;
                return Some(name);
            }
        }
        self.at = start;
        None
    }

    /// Scans the keys and values of a map.
    fn entries(&mut self, wanted: &[Remaining<'_>]) {
        self.at += 1;
        for index in 0.. {
            self.skip_space();
            match self.peek() {
                None => return,
                Some(b'}') => {
                    self.at += 1;
                    return;
                }
                Some(_) => {}
            }
            self.value(&follow(wanted, |step| *step == PathStep::Key(index)));
            self.skip_space();
            if self.peek() == Some(b':') {
                self.at += 1;
            }
            self.value(&follow(wanted, |step| *step == PathStep::Index(index)));
            self.comma();
        }
    }

    fn comma(&mut self) {
        self.skip_space();
        if self.peek() == Some(b',') {
            self.at += 1;
        }
    }
}

/// Returns the remaining steps of the paths whose next step matches.
fn follow<'a>(wanted: &[Remaining<'a>], matches: impl Fn(&PathStep) -> bool) -> Vec<Remaining<'a>> {
    let further = |wanted: &Remaining<'a>| {
        let (step, path) = wanted.path.split_first()?;
        matches(step).then_some(Remaining { index: wanted.index, path })
    };
    wanted.iter().filter_map(further).collect()
}

/// Returns the length of a string or character literal, including its quotes.
fn quoted(rest: &str, quote: char) -> usize {
    // A character literal may contain a quote itself.
    let mut escaped = quote == '\'' && !rest.starts_with("'\\");
    for (at, character) in rest.char_indices().skip(1) {
        if escaped {
            escaped = false;
        } else if character == '\\' {
            escaped = true;
        } else if character == quote {
            return at + 1;
        }
    }
    rest.len()
}

/// Returns the length of the rest of a raw string literal, from its first # or quote.
fn raw_quoted(rest: &str) -> usize {
    let hashes = rest.len() - rest.trim_start_matches('#').len();
    let end = format!("\"{}", &rest[..hashes]);
    let content = hashes + 1;
    match rest.get(content..).and_then(|text| text.find(&end)) {
        Some(length) => content + length + end.len(),
        None => rest.len(),
    }
}
