//! Byte offsets in a script's text, from Rhai's lines and columns.

use std::ops::Range;

use rhai::Position;

use super::text_span;

/// Returns the byte range of the token at a position. Without a position, returns the whole text except surrounding whitespace.
pub(super) fn span_of(text: &str, position: Position) -> Range<usize> {
    match byte_of(text, position) {
        Some(start) => start..token_end(text, start),
        None => text_span(text),
    }
}

/// Returns the byte offset of a position. Lines and columns count from 1, columns in characters.
fn byte_of(text: &str, position: Position) -> Option<usize> {
    let line_start = match position.line()? {
        0 | 1 => 0,
        line => text.match_indices('\n').nth(line - 2)?.0 + 1,
    };
    let column = position.position().unwrap_or(1);
    let line = &text[line_start..];
    let offset = line.char_indices().nth(column - 1).map_or(line.len(), |(offset, _)| offset);
    Some((line_start + offset).min(text.len()))
}

/// Returns the end of the name, number or single character that starts at byte `start`.
fn token_end(text: &str, start: usize) -> usize {
    let rest = &text[start..];
    let is_word = |character: char| character.is_alphanumeric() || character == '_';
    let word_end = |rest: &str| rest.find(|character| !is_word(character)).unwrap_or(rest.len());
    let length = match rest.chars().next() {
        Some(first) if first.is_ascii_digit() => {
            let whole = word_end(rest);
            match rest[whole..].strip_prefix('.') {
                Some(fraction) if fraction.starts_with(|next: char| next.is_ascii_digit()) => {
                    whole + 1 + word_end(fraction)
                }
                _ => whole,
            }
        }
        Some(first) if is_word(first) => word_end(rest),
        Some(first) => first.len_utf8(),
        None => 0,
    };
    start + length
}
