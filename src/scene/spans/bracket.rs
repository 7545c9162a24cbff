//! The direct members of a bracket in the text.

use std::ops::Range;

use super::Scanner;

/// A bracket with its members.
#[derive(Clone, Debug)]
pub(in crate::scene) struct Bracket {
    /// The opening bracket: `(`, `[` or `{`.
    pub(in crate::scene) opening: u8,
    /// The byte offset of its content.
    pub(in crate::scene) start: usize,
    pub(in crate::scene) members: Vec<BracketMember>,
}

/// A field, a value of a list or a tuple, or an entry of a map.
#[derive(Clone, Debug)]
pub(in crate::scene) struct BracketMember {
    /// The span of the field's name or of the entry's key.
    pub(in crate::scene) name: Option<Range<usize>>,
    pub(in crate::scene) value: Range<usize>,
}

/// Returns the byte offset of the scene itself, after extensions.
pub(in crate::scene) fn root(text: &str) -> usize {
    let mut scanner = Scanner { text, at: 0, found: &mut [] };
    scanner.skip_extensions();
    scanner.at
}

/// Returns the bracket of the value that starts at a byte, after the value's name if it has one; for `Some(..)`, the bracket of the inner
/// value. `None` for a value without a bracket, and if the bracket is never closed.
pub(in crate::scene) fn bracket(text: &str, start: usize) -> Option<Bracket> {
    let mut scanner = Scanner { text, at: start, found: &mut [] };
    if !matches!(scanner.peek(), Some(b'(' | b'[' | b'{')) {
        scanner.atom();
        let name = &text[start..scanner.at];
        let is_name = name.chars().next().is_some_and(|first| first.is_alphabetic() || first == '_');
        scanner.skip_space();
        if !is_name || scanner.peek() != Some(b'(') {
            return None;
        }
        if name == "Some" {
            scanner.at += 1;
            scanner.skip_space();
            return bracket(text, scanner.at);
        }
    }
    let opening = scanner.peek()?;
    scanner.at += 1;
    let (start, mut members) = (scanner.at, Vec::new());
    loop {
        scanner.skip_space();
        match scanner.peek()? {
            b')' | b']' | b'}' => return Some(Bracket { opening, start, members }),
            _ => members.push(scanner.member(opening == b'{')),
        }
        scanner.comma();
    }
}

/// Returns whether a text is exactly one value, with all brackets and strings closed.
pub(in crate::scene) fn is_one_value(text: &str) -> bool {
    // An unclosed bracket, string or comment swallows this suffix.
    const END: &str = "\n,";
    let (end, followed) = (text.trim_end().len(), text.to_owned() + END);
    let mut scanner = Scanner { text: &followed, at: 0, found: &mut [] };
    scanner.skip_space();
    if matches!(scanner.peek(), None | Some(b',' | b':' | b')' | b']' | b'}')) {
        return false;
    }
    scanner.value(&[]);
    scanner.at == end
}

impl Scanner<'_, '_> {
    fn member(&mut self, is_entry: bool) -> BracketMember {
        let start = self.at;
        let name = if is_entry {
            self.value(&[]);
            let key = start..self.at;
            self.skip_space();
            if self.peek() == Some(b':') {
                self.at += 1;
            }
            Some(key)
        } else {
            self.field_name().map(|name| start..start + name.len())
        };
        self.skip_space();
        let start = self.at;
        self.value(&[]);
        BracketMember { name, value: start..self.at }
    }
}
