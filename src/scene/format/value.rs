//! Values in the text of a scene.

use crate::scene::reference::section;
use crate::scene::spans::{Bracket, bracket, literal_text, root};

/// A value as it is written in a scene.
#[derive(Clone, Debug, PartialEq)]
pub enum RonValue {
    /// `None`.
    Empty,
    /// `true` or `false`.
    Flag(bool),
    /// A number.
    Number(f64),
    /// A string.
    Text(String),
    /// A word alone.
    Word(String),
    /// A list, or unnamed values in parentheses.
    Values(Vec<RonValue>),
    /// Named values in parentheses, or a map.
    Named(Vec<(String, RonValue)>),
    /// A word with content in parentheses: one value, several, or named ones.
    Variant(String, Box<RonValue>),
}

impl RonValue {
    /// Reads the text of a scene or of a value. The name of a type before its fields is omitted. `None` if the text is malformed.
    #[must_use]
    pub fn parse(text: &str) -> Option<Self> {
        Self::at(text, root(text)..text.trim_end().len())
    }

    fn at(text: &str, span: std::ops::Range<usize>) -> Option<Self> {
        let written = text.get(span.clone())?;
        if let Some(inner) = written.strip_prefix("Some(").and_then(|rest| rest.strip_suffix(')')) {
            return Self::parse(inner);
        }
        let Some(found) = bracket(text, span.start) else {
            return match written {
                "None" => Some(Self::Empty),
                "true" | "false" => Some(Self::Flag(written == "true")),
                _ => literal_text(written).map(Self::Text).or_else(|| {
                    let number = ron::from_str(written).ok().map(Self::Number);
                    let is_word = written.chars().all(|letter| letter.is_alphanumeric() || letter == '_');
                    let is_word = is_word && !written.is_empty();
                    number.or_else(|| is_word.then(|| Self::Word(written.to_owned())))
                }),
            };
        };
        let word = written.split(['(', '[', '{']).next().unwrap_or_default().trim_end();
        let is_type =
            section(word).is_some_and(|section| section.variant(word).is_none() && is_fields(&found));
        let is_pattern = section("Pattern").is_some_and(|section| section.variant(word).is_some());
        let Bracket { opening, members, .. } = found;
        let content = if members.iter().any(|member| member.name.is_some()) {
            let named = members.into_iter().map(|member| {
                let name = &text[member.name?];
                let name = if opening == b'{' { literal_text(name)? } else { name.to_owned() };
                Some((name, Self::at(text, member.value)?))
            });
            Self::Named(named.collect::<Option<_>>()?)
        } else if members.is_empty() && opening != b'[' {
            Self::Named(Vec::new())
        } else {
            let values = members.into_iter().map(|member| Self::at(text, member.value));
            let mut values: Vec<Self> = values.collect::<Option<_>>()?;
            let is_single = !word.is_empty() && values.len() == 1;
            if is_single { values.pop()? } else { Self::Values(values) }
        };
        let is_group = word.is_empty() || is_type && !is_pattern;
        Some(if is_group { content } else { Self::Variant(word.to_owned(), Box::new(content)) })
    }
}

/// Returns whether a bracket has named values, or none.
fn is_fields(bracket: &Bracket) -> bool {
    bracket.members.iter().all(|member| member.name.is_some())
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn values_are_read() {
        use RonValue::{Empty, Flag, Named, Number, Text, Values, Variant, Word};
        let named = |name: &str, value| (name.to_owned(), value);
        let read = |text: &str| RonValue::parse(text).unwrap();
        let point = Values(vec![Number(1.0), Number(-2.0), Number(0.5)]);
        assert_eq!(read("(1, -2, .5)"), point);
        assert_eq!(
            read("Film(width: 8, transfer: Srgb)"),
            Named(vec![named("width", Number(8.0)), named("transfer", Word("Srgb".to_owned())),])
        );
        assert_eq!(
            read("{ \"a/b\": Some(true), \"c\": None, }"),
            Named(vec![named("a/b", Flag(true)), named("c", Empty),])
        );
        let variant = |word: &str, content| Variant(word.to_owned(), Box::new(content));
        assert_eq!(read("Steps(8)"), variant("Steps", Number(8.0)));
        assert_eq!(
            read("Keys([(0, (1, -2, 0.5))])"),
            variant("Keys", Values(vec![Values(vec![Number(0.0), point])]))
        );
        assert_eq!(read("Gradient(size: 2)"), variant("Gradient", Named(vec![named("size", Number(2.0))])));
        assert_eq!(read("\"#ff\""), Text("#ff".to_owned()));
        assert_eq!((RonValue::parse("(a: [1, 2"), RonValue::parse("")), (None, None));
    }
}
