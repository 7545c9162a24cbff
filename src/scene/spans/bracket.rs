//! The direct members of a bracket in the text.

use std::ops::Range;

use super::{Scanner, first_item};

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

/// Returns the value of the scene's first field if it has this name. The text may be malformed.
pub(in crate::scene) fn first_field(text: &str, name: &str) -> Option<Range<usize>> {
    let mut scanner = Scanner { text, at: root(text), found: &mut [] };
    if scanner.peek() != Some(b'(') {
        scanner.atom();
        scanner.skip_space();
    }
    if scanner.peek() != Some(b'(') {
        return None;
    }
    scanner.at += 1;
    scanner.skip_space();
    (scanner.field_name()? == name).then(|| scanner.member_value())
}

/// Returns the start of the token after a value that ends at a byte, and after its comma, if there is one.
pub(in crate::scene) fn after_comma(text: &str, end: usize) -> usize {
    let next = first_item(text, end);
    if text[next..].starts_with(',') { first_item(text, next + 1) } else { next }
}

/// Returns the content of a string literal, which may be in `Some(..)`.
pub(in crate::scene) fn literal_text(literal: &str) -> Option<String> {
    ron::from_str(literal).ok().or_else(|| ron::from_str::<Option<String>>(literal).ok().flatten())
}

/// Returns the value of an entity's `name` field.
pub(in crate::scene) fn own_name(text: &str, value: &Range<usize>) -> Option<String> {
    literal_text(&text[bracket(text, value.start)?.field(text, "name")?])
}

impl Bracket {
    /// Returns the value of a field.
    pub(in crate::scene) fn field(&self, text: &str, name: &str) -> Option<Range<usize>> {
        let is_named =
            |member: &&BracketMember| member.name.as_ref().is_some_and(|span| &text[span.clone()] == name);
        self.members.iter().find(is_named).map(|member| member.value.clone())
    }

    /// Returns the byte offset of the closing bracket.
    pub(in crate::scene) fn close(&self, text: &str) -> usize {
        self.members.last().map_or(first_item(text, self.start), |last| after_comma(text, last.value.end))
    }
}

impl BracketMember {
    /// Returns the byte offset of the name, or of the value if it has no name.
    pub(in crate::scene) fn start(&self) -> usize {
        self.name.as_ref().map_or(self.value.start, |name| name.start)
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
        BracketMember { name, value: self.member_value() }
    }

    /// Scans the value of a member, after its name and colon.
    fn member_value(&mut self) -> Range<usize> {
        self.skip_space();
        let start = self.at;
        self.value(&[]);
        start..self.at
    }
}
