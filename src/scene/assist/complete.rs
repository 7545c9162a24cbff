//! Completion.

use std::ops::Range;
use std::path::Path;

use super::names::{KnownName, SymbolKind, asked, known_names};
use super::scan::{BracketScan, names_after};
use crate::scene::document::SceneDocument;
use crate::scene::parse::{Expectation, form_of, owner, pending};
use crate::scene::reference::{ManualSection, about_field, section};

/// The kind of a suggestion.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum SuggestionKind {
    /// The name of a field.
    Field,
    /// A word, or a value.
    Value,
    /// A name in the scene.
    Name,
}

/// A text that can be written at a position.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Suggestion {
    /// The kind.
    pub kind: SuggestionKind,
    /// The word that is completed.
    pub label: String,
    /// The text to write.
    pub text: String,
    /// The description in the reference.
    pub about: String,
}

/// The suggestions at a position.
#[derive(Clone, Debug, Default, PartialEq, Eq)]
pub struct Suggestions {
    /// The bytes to replace.
    pub span: Range<usize>,
    /// The suggestions.
    pub items: Vec<Suggestion>,
}

/// Returns the suggestions at a position of a text: the fields that are still missing, words, or names. Included files are found relative to
/// the folder of `path`.
///
/// ```
/// use std::path::Path;
/// use rayreel::scene::assist::complete;
///
/// let text = "(entities: [(shape: Box(size: (1, 1, 1)), col";
/// let suggestions = complete(text, text.len(), Path::new("scene.ron"));
/// assert_eq!(suggestions.span, 42..45);
/// assert!(suggestions.items.iter().any(|item| item.text == "color: "));
/// assert!(suggestions.items.iter().all(|item| item.label != "shape")); // it is written
/// ```
#[must_use]
pub fn complete(text: &str, at: usize, path: &Path) -> Suggestions {
    let at = text.floor_char_boundary(at);
    let (scan, span) = BracketScan::until(text, at);
    let items = match scan.open.last() {
        _ if scan.is_in_comment(at) => Vec::new(),
        None => root(&text[span.clone()]),
        Some(inner) if inner.bracket == "(" && inner.name.is_none() => {
            let fields = missing_fields(&scan, span.end);
            if fields.is_empty() { values(&scan, &span, path) } else { fields }
        }
        Some(_) => values(&scan, &span, path),
    };
    Suggestions { span, items }
}

fn root(word: &str) -> Vec<Suggestion> {
    let about = section("Scene").map(ManualSection::about).unwrap_or_default();
    let scene = suggestion(SuggestionKind::Value, "Scene", "Scene(".to_owned(), about);
    if "Scene".starts_with(word) { vec![scene] } else { Vec::new() }
}

fn suggestion(kind: SuggestionKind, label: &str, text: String, about: String) -> Suggestion {
    Suggestion { kind, label: label.to_owned(), text, about }
}

/// Suggests the fields of the innermost bracket that are not written. `end` is the end of the word at the cursor.
fn missing_fields(scan: &BracketScan<'_>, end: usize) -> Vec<Suggestion> {
    let Some(owner) = owner(&scan.skeleton(scan.open.len(), true)) else { return Vec::new() };
    let before: Vec<&str> = scan.names_before().collect();
    let rest = &scan.text[end..];
    // The name at the cursor can have its colon already.
    let is_named = rest.trim_start().starts_with(':');
    let after = names_after(scan.text, if is_named { end + rest.find(':').unwrap_or(0) + 1 } else { end });
    let missing = owner.fields.iter().filter(|name| !before.contains(name) && !after.contains(name));
    missing
        .map(|name| {
            let text = if is_named { (*name).to_owned() } else { format!("{name}: ") };
            suggestion(
                SuggestionKind::Field,
                name,
                text,
                about_field(owner.of, owner.variant.as_deref(), name),
            )
        })
        .collect()
}

/// Suggests values, for the innermost field or in a list.
fn values(scan: &BracketScan<'_>, span: &Range<usize>, path: &Path) -> Vec<Suggestion> {
    let written = &scan.text[span.clone()];
    let Some(request) = pending(&scan.skeleton(scan.open.len(), false)).and_then(|mut open| open.pop())
    else {
        return Vec::new();
    };
    let value = |label: &str, text: &str, about: String| {
        suggestion(SuggestionKind::Value, label, text.to_owned(), about)
    };
    match request {
        Expectation::Choice { name, words } if !written.starts_with('"') => {
            let has_bracket = scan.text[span.end..].trim_start().starts_with('(');
            let section = section(name);
            words
                .iter()
                .map(|word| {
                    let form = form_of(name, word).filter(|_| !has_bracket).unwrap_or(word);
                    value(word, form, section.map(|section| section.about_variant(word)).unwrap_or_default())
                })
                .collect()
        }
        Expectation::Flag => ["true", "false"].map(|word| value(word, word, String::new())).into(),
        Expectation::Fields { name, .. } if written.is_empty() => {
            let Some(section) = section(name) else { return Vec::new() };
            let needed = section.fields.iter().filter(|field| field.is_required);
            let needed: Vec<String> =
                needed.map(|field| format!("{}: {}", field.name, field.value)).collect();
            vec![value(name, &format!("({})", needed.join(", ")), section.about())]
        }
        Expectation::Text | Expectation::Any { .. } => names(scan, span, path),
        _ => Vec::new(),
    }
}

/// Suggests names in the scene.
fn names(scan: &BracketScan<'_>, span: &Range<usize>, path: &Path) -> Vec<Suggestion> {
    let asked = asked(scan);
    let name = |name: &str, about: &str| {
        suggestion(SuggestionKind::Name, name, format!("{name:?}"), about.to_owned())
    };
    let mut items = Vec::new();
    if asked == super::names::NamesAsked::default() {
        return items;
    }
    // Without the name that is being typed, whose quote may be open.
    let text = [&scan.text[..span.start], &scan.text[span.end..]].concat();
    for KnownName { kind, name: known, .. } in known_names(&text, path) {
        if asked.includes(kind) {
            let about = match kind {
                SymbolKind::Material => "A material.",
                SymbolKind::Camera => "A camera.",
                SymbolKind::Include => "An included file.",
                SymbolKind::Entity | SymbolKind::Animation => "An entity.",
            };
            items.push(name(&known, about));
        }
    }
    if asked.cameras {
        items.push(name(SceneDocument::CAMERA, "The camera in `camera`."));
        if asked.entities {
            items.push(name(SceneDocument::SCENE, "Settings of the whole scene."));
        }
    }
    items
}
