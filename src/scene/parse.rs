//! From text to document, and ron's first complaint as a diagnostic.

use std::ops::Range;

use ron::error::{Position, SpannedError};
use ron::extensions::Extensions;

use super::document::SceneDocument;
use super::spans::{is_blank, open_bracket, token};
use super::suggest;
use super::{Diagnostic, Place};

/// Reads a scene's text.
pub(super) fn parse(text: &str) -> Result<SceneDocument, Diagnostic> {
    if is_blank(text) {
        let message =
            if text.trim().is_empty() { "the file is empty" } else { "the file holds nothing but comments" };
        return Err(Diagnostic {
            message: message.to_owned(),
            label: String::new(),
            help: Some("`rayreel new FILE` writes a small scene to start from".to_owned()),
            span: None,
            source: None,
        });
    }
    options().from_str(text).map_err(|error| explain(text, &error))
}

/// How scene files are read: `Some` may be left out.
pub(super) fn options() -> ron::Options {
    ron::Options::default().with_default_extension(Extensions::IMPLICIT_SOME)
}

/// ron's error in our words, with a remedy where there is one.
fn explain(text: &str, error: &SpannedError) -> Diagnostic {
    use ron::error::Error as Ron;

    let span = token_at(text, byte_of(text, error.span.start)..byte_of(text, error.span.end));
    if let Some(diagnostic) = explain_brackets(text, error, span.start) {
        return diagnostic;
    }
    let of =
        |outer: &Option<String>| outer.as_ref().map_or_else(String::new, |outer| format!(" of `{outer}`"));
    let (message, label, help) = match &error.code {
        Ron::NoSuchStructField { expected, found, outer } => (
            format!("unknown field `{found}`{}", of(outer)),
            "no such field".to_owned(),
            Some(suggest::remedy(found, expected, "fields")),
        ),
        Ron::NoSuchEnumVariant { expected, found, outer } => (
            format!("unknown {} `{found}`", outer.as_deref().unwrap_or("word").to_lowercase()),
            "not known here".to_owned(),
            Some(suggest::remedy(found, expected, "possibilities")),
        ),
        Ron::MissingStructField { field, outer } => (
            format!("missing field `{field}`{}", of(outer)),
            format!("`{field}` should have been written by here"),
            Some(format!("add `{field}: ..`; the scene reference says what it takes")),
        ),
        Ron::DuplicateStructField { field, outer } => (
            format!("field `{field}`{} is written twice", of(outer)),
            "again here".to_owned(),
            Some("remove one of the two".to_owned()),
        ),
        Ron::InvalidValueForType { expected, found } => {
            (format!("expected {expected}"), format!("found {}", plainly(found)), None)
        }
        Ron::ExpectedDifferentLength { expected, found } => {
            let found = if *found == 1 { "1 value".to_owned() } else { format!("{found} values") };
            let expected = expected.replace("an array of length 3", "three numbers, as (0, 1, 0)");
            (format!("expected {expected}"), format!("found {found}"), None)
        }
        Ron::ExpectedDifferentStructName { expected, found } => (
            format!("expected `{expected}`, found `{found}`"),
            "wrong name".to_owned(),
            Some(format!("write `{expected}( .. )`, or just `( .. )`")),
        ),
        Ron::ExceededRecursionLimit => (
            "brackets are nested more than 128 deep".to_owned(),
            "here".to_owned(),
            Some("no scene needs this: is a bracket written too often?".to_owned()),
        ),
        Ron::ExpectedComma if is_fraction(text, span.start) => (
            "expected a whole number".to_owned(),
            "this makes it a fraction".to_owned(),
            Some("write a whole number, as 16".to_owned()),
        ),
        Ron::TrailingCharacters => (
            "there is text after the end of the scene".to_owned(),
            "the scene is already complete here".to_owned(),
            Some("a file holds one scene: is a bracket closed too early?".to_owned()),
        ),
        Ron::Message(message) => match message.split_once('\n') {
            Some((message, help)) => (message.to_owned(), "here".to_owned(), Some(help.to_owned())),
            None => (message.clone(), "here".to_owned(), None),
        },
        other => (lower_first(&other.to_string()), "here".to_owned(), punctuation_help(other)),
    };
    Diagnostic { message, label, help, span: Some(span), source: None }
}

/// What was opened and not closed, if that is what is wrong.
fn explain_brackets(text: &str, error: &SpannedError, at: usize) -> Option<Diagnostic> {
    use ron::error::Error as Ron;

    let unclosed = |what: &str, start: usize, length: usize| Diagnostic {
        message: format!("this {what} is never closed"),
        label: "opened here".to_owned(),
        help: Some("close it, or remove this".to_owned()),
        span: Some(start..start + length),
        source: None,
    };
    match &error.code {
        Ron::UnclosedBlockComment => text.rfind("/*").map(|start| unclosed("comment", start, 2)),
        Ron::ExpectedStringEnd => Some(unclosed("text", byte_of(text, error.span.start), 1)),
        _ if at >= text.trim_end().len() || matches!(error.code, Ron::Eof) => {
            let bracket = open_bracket(text, usize::MAX)?;
            Some(unclosed(&format!("`{}`", &text[bracket..=bracket]), bracket, 1))
        }
        _ => {
            let bracket = open_bracket(text, at)?;
            let (open, found) = (text.as_bytes()[bracket], text.as_bytes()[at]);
            let close = match open {
                b'(' => b')',
                b'[' => b']',
                _ => b'}',
            };
            let place = Place::of(text, bracket);
            (b")]}".contains(&found) && found != close).then(|| Diagnostic {
                message: format!("expected `{}`, found `{}`", char::from(close), char::from(found)),
                label: format!("the `{}` of line {} is still open", char::from(open), place.line),
                help: Some(format!("close it with a `{}` first", char::from(close))),
                span: Some(at..at + 1),
                source: None,
            })
        }
    }
}

fn punctuation_help(error: &ron::Error) -> Option<String> {
    use ron::error::Error as Ron;
    let help = match error {
        Ron::ExpectedComma => "values in a list are separated by commas: is one missing before this?",
        Ron::ExpectedMapColon => "a name and its value are separated by a colon, as in `radius: 1`",
        Ron::ExpectedString => "texts stand in double quotes, as in \"clay\"",
        Ron::ExpectedFloat => "write a number, as 1 or 0.25 or 1e-3",
        Ron::ExpectedStructLike | Ron::ExpectedNamedStructLike(_) => {
            "groups of fields stand in round brackets: ( .. )"
        }
        Ron::ExpectedStructLikeEnd => {
            "close the bracket here: is there a value too many, or a comma missing?"
        }
        Ron::ExpectedArray => "lists stand in square brackets: [ .. ]",
        Ron::ExpectedMap => "maps stand in braces: { \"name\": .. }",
        Ron::IntegerOutOfBounds | Ron::ExpectedInteger => "write a whole number, 0 or more",
        _ => return None,
    };
    Some(help.to_owned())
}

/// Does a number go on here, with its point?
fn is_fraction(text: &str, at: usize) -> bool {
    text[..at].ends_with(|character: char| character.is_ascii_digit()) && text[at..].starts_with('.')
}

/// What was found, without the names of number types.
fn plainly(found: &str) -> String {
    found
        .replace("unsigned integer", "number")
        .replace("integer", "number")
        .replace("floating point", "number")
}

fn lower_first(text: &str) -> String {
    let mut characters = text.chars();
    characters.next().map_or_else(String::new, |first| first.to_lowercase().chain(characters).collect())
}

/// The byte of a line and column that ron counted, both from 1.
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

/// The word or sign that a span points at, so that there is always something to mark. ron's spans may take in the white space
/// around.
fn token_at(text: &str, span: Range<usize>) -> Range<usize> {
    let span = span.start..span.end.max(span.start);
    let marked = &text[span.clone()];
    let trimmed = marked.trim();
    if !trimmed.is_empty() && !trimmed.contains('\n') {
        let start = span.start + (marked.len() - marked.trim_start().len());
        return start..start + trimmed.len();
    }
    let start = span.end.min(text.trim_end().len());
    let start = if text.is_char_boundary(start) { start } else { span.start };
    token(text, start)
}
