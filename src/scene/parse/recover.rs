//! All mistakes of a text, where the parser stops at the first one.
//!
//! After a mistake, the smallest part of the text around it without which the parser goes on is replaced by spaces, so that positions stay,
//! and the text is parsed again:
//!
//! ```text
//! (shape: Torus(size: 1), colour: "red")           unknown shape `Torus`
//! (                       colour: "red")           unknown field `colour`
//! (                                    )           no mistake
//! ```
//!
//! Parts are fields, items of lists and entries of maps. If the brackets do not match, no part is found, and the first mistake is the last.

use std::ops::Range;

use ron::Error;
use ron::error::SpannedError;

use super::explain::explain;
use super::general_parser::read_general;
use super::read::trail;
use super::token_context::TokenContext;
use crate::scene::Diagnostic;
use crate::scene::document::SceneDocument;
use crate::scene::spans::{BracketMember, bracket, first_item, root};

/// The mistakes of an invalid text.
#[derive(Clone, Debug, PartialEq)]
pub(in crate::scene) struct Mistakes {
    /// In the order of the text.
    pub(in crate::scene) diagnostics: Vec<Diagnostic>,
    /// The document without the removed parts, if these were fields that no scene has: everything else that it says can be checked.
    pub(in crate::scene) document: Option<Box<SceneDocument>>,
}

/// A part of a text that can be removed.
struct Part {
    span: Range<usize>,
    /// The closing bracket around it.
    close: usize,
}

/// Finds the mistakes of a text that the parser rejects with `error`.
pub(super) fn find_mistakes(text: &str, mut error: SpannedError) -> Mistakes {
    /// Maximum number of mistakes: more are not listed.
    const MOST: usize = 50;
    /// Maximum number of bytes to parse, which takes about a second. A scene of a million entities thus shows its first mistakes.
    const MOST_BYTES: usize = 1 << 26;
    let (mut rest, mut diagnostics) = (text.to_owned(), Vec::new());
    let (mut are_unknown_fields, mut parsed) = (true, 0);
    loop {
        diagnostics.push(explain(&rest, &error, &trail(&rest)));
        are_unknown_fields &= is_superfluous(&error.code);
        let at = TokenContext::error(&rest, &error).found.start;
        let mut removed = None;
        for part in parts_around(&rest, at) {
            parsed += rest.len();
            if diagnostics.len() == MOST || parsed > MOST_BYTES {
                break;
            }
            let without = blanked(&rest, part.span.clone());
            match read_general(&without) {
                Ok(document) => {
                    let document = are_unknown_fields.then(|| Box::new(document));
                    return Mistakes { diagnostics, document };
                }
                Err(next) => {
                    // An error in the same bracket can be a consequence: a missing field, or too few values.
                    let next_at = TokenContext::error(&without, &next).found.start;
                    let is_consequence = next_at <= part.close && !is_superfluous(&next.code);
                    if next_at > part.span.start && !is_consequence {
                        removed = Some((without, next));
                        break;
                    }
                }
            }
        }
        let Some(next) = removed else { return Mistakes { diagnostics, document: None } };
        (rest, error) = next;
    }
}

/// Returns whether an error is a field that is unknown or repeated. What remains without it is what the scene says.
fn is_superfluous(error: &Error) -> bool {
    matches!(error, Error::NoSuchStructField { .. } | Error::DuplicateStructField { .. })
}

/// Returns the parts around a byte, the innermost first.
fn parts_around(text: &str, at: usize) -> Vec<Part> {
    let (mut parts, mut value) = (Vec::new(), root(text));
    while let Some(outer) = bracket(text, value) {
        let start_of =
            |member: &BracketMember| member.name.as_ref().map_or(member.value.start, |name| name.start);
        let around = |member: &&BracketMember| (start_of(member)..member.value.end).contains(&at);
        let Some(member) = outer.members.iter().find(around) else { break };
        if member.name.is_some() || outer.opening == b'[' {
            let close = outer.members.last().map_or(at, |last| after_comma(text, last.value.end));
            parts.push(Part { span: start_of(member)..after_comma(text, member.value.end), close });
        }
        value = member.value.start;
    }
    parts.reverse();
    parts
}

/// Returns the start of the token after a value that ends at a byte, and after its comma, if there is one.
fn after_comma(text: &str, end: usize) -> usize {
    let next = first_item(text, end);
    if text[next..].starts_with(',') { first_item(text, next + 1) } else { next }
}

/// Replaces a part of a text by spaces, except for the ends of lines.
fn blanked(text: &str, part: Range<usize>) -> String {
    let blank = text[part.clone()].bytes().map(|byte| if byte == b'\n' { '\n' } else { ' ' });
    let mut blanked = text[..part.start].to_owned();
    blanked.extend(blank);
    blanked + &text[part.end..]
}

#[cfg(test)]
mod tests {
    use std::collections::BTreeSet;

    use proptest::prelude::*;

    use super::*;
    use crate::scene::parse::read::parse_general;
    use crate::scene::spans::{tokens, value_end};

    const SCENE: &str = include_str!("../../../tests/hard_cases/every_number.ron");

    /// Returns the spans of all fields' names in a text, each with the end of its value.
    fn fields(text: &str) -> Vec<(Range<usize>, usize)> {
        let tokens: Vec<Range<usize>> = tokens(text).collect();
        let is_field = |pair: &&[Range<usize>]| {
            text[pair[0].clone()].starts_with(|first: char| first.is_alphabetic())
                && &text[pair[1].clone()] == ":"
        };
        let field = |pair: &[Range<usize>]| (pair[0].clone(), value_end(text, first_item(text, pair[1].end)));
        tokens.windows(2).filter(is_field).map(field).collect()
    }

    fn messages(text: &str) -> Vec<String> {
        let Err(Mistakes { diagnostics, .. }) = parse_general(text) else { return Vec::new() };
        diagnostics.into_iter().map(|diagnostic| diagnostic.message).collect()
    }

    proptest! {
        #[test]
        fn all_misspelt_fields_are_found(chosen in prop::collection::vec(any::<prop::sample::Index>(), 1..20)) {
            let all = fields(SCENE);
            let chosen: BTreeSet<usize> = chosen.iter().map(|index| index.index(all.len())).collect();
            let (mut text, mut from, mut end, mut count) = (String::new(), 0, 0, 0);
            for (name, value_end) in chosen.iter().map(|index| &all[*index]) {
                // A field within a misspelt field goes with it.
                if name.start < end {
                    continue;
                }
                text += &SCENE[from..name.end];
                text += "_zz";
                (from, end, count) = (name.end, *value_end, count + 1);
            }
            text += &SCENE[from..];
            let found = messages(&text);
            prop_assert!(found.iter().all(|message| message.starts_with("unknown field")), "{found:?}\n{text}");
            prop_assert_eq!(found.len(), count, "{:?}\n{}", found, text);
        }
    }

    #[test]
    fn mistakes_of_all_kinds_are_found() {
        let text = r#"(
            film: (width: "wide", height: 10, heigth: 20),
            camera: (position: (0, 1), target: (0, 0, 0), fov: 40, fov: 50),
            materials: { "red": (k_d: yes), "blue": (specular: (k_s: 1)) },
            entities: [
                (shape: Torus(radius: 1), material: red),
                (light: Point(position: (0, 1, 0))),
                (shape: Sphere(radius: 1), material: 5),
            ],
        )"#;
        let found = messages(text);
        assert_eq!(
            found,
            [
                "expected a number",
                "unknown field `heigth` of `Film`",
                "expected three numbers",
                "field `fov` of `Camera` is written twice",
                "expected true or false",
                "missing field `shininess` of `Specular`",
                "unknown shape `Torus`",
                "expected a text",
                "unknown field `position` of `Point`",
                "missing field `intensity` of `Point`",
                "expected a text",
            ],
            "{found:#?}"
        );
    }

    /// Checks that a text whose brackets do not match has one mistake, and that of very many mistakes only the first are looked for.
    #[test]
    fn the_search_ends() {
        assert_eq!(messages("(entities: [(shape: Torus(radius: 1), (colour: 2)])").len(), 1);
        let many = format!("(entities: [{}])", "(shape: Torus(radius: 1)),".repeat(200));
        assert_eq!(messages(&many).len(), 50);
    }
}
