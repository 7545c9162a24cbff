//! Positions of the protocol: lines, and columns in UTF-16 units, both from 0; and files as URIs.

use std::ops::Range;
use std::path::{Path, PathBuf};

use serde_json::{Value, json};

use rayreel::scene::SourcePosition;

/// Returns the byte offset of the start of a line, from 0.
fn line_start(text: &str, line: usize) -> usize {
    match line.checked_sub(1) {
        None => 0,
        Some(before) => text.match_indices('\n').nth(before).map_or(text.len(), |(at, _)| at + 1),
    }
}

/// Returns a line that starts at a byte, without its end.
fn line_at(text: &str, start: usize) -> &str {
    let line = text[start..].split('\n').next().unwrap_or_default();
    line.strip_suffix('\r').unwrap_or(line)
}

/// Returns the byte offset of a position. A position beyond the end of its line is at that end.
pub(super) fn offset(text: &str, position: &Value) -> usize {
    let number = |name: &str| position[name].as_u64().and_then(|number| usize::try_from(number).ok());
    let start = line_start(text, number("line").unwrap_or_default());
    let (line, column) = (line_at(text, start), number("character").unwrap_or_default());
    let mut units = 0;
    for (at, character) in line.char_indices() {
        if units >= column {
            return start + at;
        }
        units += character.len_utf16();
    }
    start + line.len()
}

/// Returns the range of a span of bytes.
pub(super) fn range(text: &str, span: &Range<usize>) -> Value {
    LineStarts::new(text).range(span)
}

/// The lines of a text, to convert many positions.
#[derive(Debug)]
pub(super) struct LineStarts<'t> {
    text: &'t str,
    /// The byte offsets of the starts of all lines.
    starts: Vec<usize>,
}

impl<'t> LineStarts<'t> {
    pub(super) fn new(text: &'t str) -> Self {
        let further = text.match_indices('\n').map(|(at, _)| at + 1);
        Self { text, starts: std::iter::once(0).chain(further).collect() }
    }

    fn position(&self, byte: usize) -> Value {
        let byte = self.text.floor_char_boundary(byte);
        let line = self.starts.partition_point(|start| *start <= byte) - 1;
        let before = &self.text[self.starts[line]..byte];
        json!({ "line": line, "character": before.encode_utf16().count() })
    }

    /// Returns the range of a span of bytes.
    pub(super) fn range(&self, span: &Range<usize>) -> Value {
        json!({ "start": self.position(span.start), "end": self.position(span.end) })
    }
}

/// Returns the span of a line, from 1, without spaces around it.
pub(super) fn line_span(text: &str, line: usize) -> Range<usize> {
    let start = line_start(text, line.saturating_sub(1));
    let line = line_at(text, start);
    let indent = line.len() - line.trim_start().len();
    start + indent..(start + line.trim_end().len()).max(start + indent)
}

/// Returns the byte offset of a line and a column in characters, both from 1.
pub(super) fn byte_of(text: &str, SourcePosition { line, column }: SourcePosition) -> usize {
    let start = line_start(text, line.saturating_sub(1));
    let mut characters = line_at(text, start).char_indices();
    let at = characters.nth(column.saturating_sub(1));
    at.map_or(start + line_at(text, start).len(), |(at, _)| start + at)
}

/// Returns the path of a file's URI; for another URI, a file name in the working directory.
pub(super) fn path_of(uri: &str) -> PathBuf {
    let Some(rest) = uri.strip_prefix("file://") else { return PathBuf::from("scene.ron") };
    let path = &rest[rest.find('/').unwrap_or(rest.len())..];
    let (mut bytes, mut left) = (Vec::new(), path.as_bytes());
    while let [first, rest @ ..] = left {
        let code = rest.get(..2).and_then(|digits| std::str::from_utf8(digits).ok());
        let code = code.and_then(|digits| u8::from_str_radix(digits, 16).ok());
        let (byte, after) = match code.filter(|_| *first == b'%') {
            Some(code) => (code, &rest[2..]),
            None => (*first, rest),
        };
        bytes.push(byte);
        left = after;
    }
    PathBuf::from(String::from_utf8_lossy(&bytes).into_owned())
}

/// Returns the URI of a file.
pub(super) fn uri_of(path: &Path) -> String {
    let path = std::path::absolute(path).unwrap_or_else(|_| path.to_owned());
    let mut uri = "file://".to_owned();
    for byte in path.as_os_str().as_encoded_bytes() {
        if byte.is_ascii_alphanumeric() || b"/-._~".contains(byte) {
            uri.push(char::from(*byte));
        } else {
            uri += &format!("%{byte:02X}");
        }
    }
    uri
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn positions_are_counted_in_utf_16() {
        let text = "a\r\nä😀b\n";
        let at = |line: u64, character: u64| offset(text, &json!({ "line": line, "character": character }));
        let found =
            [at(0, 0), at(0, 9), at(1, 0), at(1, 1), at(1, 3), at(1, 4), at(1, 9), at(2, 0), at(7, 7)];
        assert_eq!(found, [0, 1, 3, 5, 9, 10, 10, 11, 11]);
        assert_eq!(LineStarts::new(text).position(9), json!({ "line": 1, "character": 3 }));
        assert_eq!(byte_of(text, SourcePosition { line: 2, column: 3 }), 9);
        assert_eq!(line_span("a\n  b \n", 2), 4..5);
    }

    #[test]
    fn uris_are_paths() {
        let path = Path::new("/a b/ä%.ron");
        assert_eq!(uri_of(path), "file:///a%20b/%C3%A4%25.ron");
        assert_eq!(path_of(&uri_of(path)), path);
        assert_eq!(path_of("file://host/a%2"), Path::new("/a%2"));
        assert_eq!(path_of("untitled:1"), Path::new("scene.ron"));
    }
}
