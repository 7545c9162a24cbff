//! Descriptions of expected values.

use super::examples::{self, Example};
use super::expectations::{Expectation, VariantContent};
use super::token_context::TokenContext;
use crate::scene::quote::short;
use crate::scene::suggest::nearest;

/// The description of an expected value, and of its notation.
pub(super) struct Expected {
    pub(super) message: String,
    pub(super) help: String,
}

impl Expected {
    /// Describes the value requested by `expectation`. `open` holds the pending requests.
    pub(super) fn of(expectation: &Expectation, open: &[Expectation], context: &TokenContext<'_>) -> Self {
        let found = context.word();
        match expectation {
            Expectation::Number if is_named(context) => match outer(open) {
                // Named coordinates.
                Some(values @ Expectation::Values { .. }) => Self::of(values, &[], context),
                _ => Self::new("a number", "write a number, as 1 or 0.25 or 1e-3"),
            },
            Expectation::Number => Self::new("a number", "write a number, as 1 or 0.25 or 1e-3"),
            Expectation::Flag => {
                Self::new("true or false", "write true or false, in small letters and without quotes")
            }
            Expectation::Text if is_word(found) && !found.contains('"') || found.starts_with('\'') => {
                let text = found.trim_matches('\'');
                Self::new("a text", format!("texts stand in double quotes: \"{}\"", short(text)))
            }
            Expectation::Text => Self::new("a text", "texts stand in double quotes, as in \"clay\""),
            Expectation::List => {
                Self::new("a list", "lists stand in square brackets, with commas: [ .. , .. ]")
            }
            Expectation::Map => {
                Self::new("a map", "write it in braces, each value after its name: { \"name\": ( .. ), }")
            }
            Expectation::Fields { name, fields } => {
                let help = format!("write them in round brackets, as {}", bracketed(fields));
                Self::new(format!("the fields of `{name}`"), help)
            }
            Expectation::FieldName => field_name(outer(open), found),
            Expectation::Values { reader, .. } if reader == "an array of length 3" => {
                Self::new("three numbers", "write them in round brackets, as (0, 1, 0)")
            }
            Expectation::Values { reader, .. } | Expectation::Any { reader } => match reader.split_once(": ")
            {
                Some((what, how)) => Self::new(what, format!("write {how}")),
                None => Self::new(reader.as_str(), "the scene reference says how it is written"),
            },
            Expectation::Choice { name, words } => choice(examples::of(name), words.len(), found),
            Expectation::VariantContent { of, word, content } => {
                self::content(examples::of(of), word, content)
            }
        }
    }

    fn new(what: impl AsRef<str>, help: impl Into<String>) -> Self {
        Self { message: format!("expected {}", what.as_ref()), help: help.into() }
    }
}

/// Formats a count with its noun, for example `1 value` or `2 values`.
pub(super) fn counted(count: usize, what: &str) -> String {
    if count == 1 { format!("1 {what}") } else { format!("{count} {what}s") }
}

/// Returns the request that contains the innermost one.
fn outer(open: &[Expectation]) -> Option<&Expectation> {
    open.len().checked_sub(2).map(|outer| &open[outer])
}

fn choice(example: Example, count: usize, found: &str) -> Expected {
    let forms = example.listed();
    let all = if example.forms.len() == count { String::new() } else { format!("one of {count} words, as ") };
    let quotes = if found.starts_with('"') { ", without quotes around it" } else { "" };
    Expected::new(example.noun, format!("write {all}{forms}{quotes}"))
}

fn content(example: Example, word: &str, content: &VariantContent) -> Expected {
    let what = match content {
        VariantContent::One => "1 value".to_owned(),
        VariantContent::Several(count) => counted(*count, "value"),
        VariantContent::Fields(_) => "its values by name".to_owned(),
    };
    let help = match example.form(word) {
        Some(form) => format!("write it as {form}"),
        None => "write its values in round brackets".to_owned(),
    };
    Expected { message: format!("`{}` takes {what}, in round brackets", short(word)), help }
}

/// Describes the name of a field if the name or its colon is missing.
fn field_name(of: Option<&Expectation>, found: &str) -> Expected {
    let (fields, help) = match of {
        Some(Expectation::Fields { fields, .. }) => {
            (*fields, format!("write each value after its name, as {}", bracketed(fields)))
        }
        Some(Expectation::VariantContent { of, word, content: VariantContent::Fields(fields) }) => {
            let form = examples::of(of).form(word);
            (*fields, form.map_or_else(|| bracketed(fields), |form| format!("write it as {form}")))
        }
        _ => (&[][..], "write each value after its name and a colon".to_owned()),
    };
    let help = match nearest(found, fields.iter().copied()) {
        Some(name) => format!("did you mean `{name}`?"),
        None if "([{".contains(found) => format!("{help}; is the bracket before this still open?"),
        None => help,
    };
    Expected::new("a field's name", help)
}

/// Formats fields for example as `(width: .., height: .., transfer: ..)`.
fn bracketed(fields: &[&str]) -> String {
    /// Maximum number of listed fields; more are of no help.
    const MOST: usize = 4;
    let named: Vec<String> = fields.iter().take(MOST).map(|field| format!("{field}: ..")).collect();
    let more = if fields.len() > MOST { ", .." } else { "" };
    format!("({}{more})", named.join(", "))
}

/// Returns whether a token is a word, as opposed to a number, a string or punctuation.
pub(super) fn is_word(found: &str) -> bool {
    found.starts_with(|first: char| first.is_alphabetic() || first == '_')
}

/// Returns whether the token is a word followed by a colon.
fn is_named(context: &TokenContext<'_>) -> bool {
    is_word(context.word()) && context.next() == ":"
}
