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
//! What the text says without these parts is not checked further: a name that is missing, for example, can be in one of them.
//!
//! Parts are fields, items of lists and entries of maps. If brackets, commas or values are missing, no part is found, and the first mistake
//! is the last.

use std::ops::Range;

use ron::Error;
use ron::error::SpannedError;

use super::characters::is_known;
use super::explain::explain;
use super::general_parser::{read_general, trail};
use super::token_context::TokenContext;
use crate::scene::Diagnostic;
use crate::scene::spans::{Bracket, BracketMember, after_comma, bracket, first_item, is_one_value, root};

/// A part of a text that can be removed.
struct Part {
    span: Range<usize>,
    /// The value with the bracket around it.
    outer: usize,
}

/// A part that was removed because of a mistake.
struct RemovedPart<'a> {
    /// The value with the bracket around it.
    outer: usize,
    text: &'a str,
    /// The remedy of the mistake.
    help: String,
}

impl RemovedPart<'_> {
    /// Returns whether a field is missing because this part was removed: it is the part, or the remedy names it.
    fn is_about(&self, field: &str) -> bool {
        self.text.starts_with(field) || self.help.contains(&format!("`{field}"))
    }
}

/// Finds the mistakes of a text that the parser rejects with `error`, in the order of the text.
pub(super) fn find_mistakes(text: &str, mut error: SpannedError) -> Vec<Diagnostic> {
    /// Maximum number of mistakes: more are not listed.
    const MOST: usize = 50;
    /// Maximum number of bytes to parse for further mistakes, which takes about a second: some 20 MB are parsed in one. Of a text that is
    /// longer, only the first mistake is found.
    const MOST_BYTES: usize = 1 << 24;
    let (mut rest, mut mistakes, mut removed) = (text.to_owned(), Vec::new(), Vec::new());
    let mut parsed = 0;
    loop {
        let mistake = explain(&rest, &error, &trail(&rest));
        let help = mistake.help.clone().unwrap_or_default();
        mistakes.push(mistake);
        let context = TokenContext::error(&rest, &error);
        let (at, is_readable) = (context.found.start, context.word().chars().next().is_none_or(is_known));
        let mut next = None;
        for Part { span, outer } in parts_around(&rest, at) {
            parsed += rest.len();
            if mistakes.len() == MOST || parsed > MOST_BYTES || !is_readable {
                break;
            }
            let without = blanked(&rest, span.clone());
            removed.push(RemovedPart { outer, text: &text[span], help: help.clone() });
            let Err(after) = read_general(&without) else { return mistakes };
            let next_at = TokenContext::error(&without, &after).found.start;
            let is_consequence = match missing_field(&after.code) {
                Some(field) => removed
                    .iter()
                    .any(|part| part.is_about(field) && is_in_bracket(&without, part.outer, next_at)),
                None => !is_superfluous(&after.code) && is_in_bracket(&without, outer, next_at),
            };
            if next_at > at && !is_consequence {
                next = Some((without, after));
                break;
            }
        }
        let Some(next) = next else { return mistakes };
        (rest, error) = next;
    }
}

/// Returns whether an error is a field that is unknown or repeated.
fn is_superfluous(error: &Error) -> bool {
    match error {
        Error::NoSuchStructField { .. } | Error::DuplicateStructField { .. } => true,
        // Of types that report their fields themselves.
        Error::Message(message) => message.starts_with("unknown field"),
        _ => false,
    }
}

/// Returns the name of a field that an error says is missing.
pub(super) fn missing_field(error: &Error) -> Option<&str> {
    match error {
        Error::MissingStructField { field, .. } => Some(field),
        Error::Message(message) => message.strip_prefix("missing field `")?.split('`').next(),
        _ => None,
    }
}

/// Returns the parts around a byte, the innermost first. There are none in brackets in which a comma or a value is missing: what is written
/// where is then uncertain.
fn parts_around(text: &str, at: usize) -> Vec<Part> {
    let (mut parts, mut outer) = (Vec::new(), root(text));
    let is_followed =
        |member: &BracketMember| text[first_item(text, member.value.end)..].starts_with([',', ')', ']', '}']);
    while let Some(Bracket { opening, members, .. }) = bracket(text, outer) {
        let Some(member) = members.iter().find(|member| span_of(member).contains(&at)) else { break };
        if !members.iter().all(is_followed) || !is_one_value(&text[member.value.clone()]) {
            return Vec::new();
        }
        if member.name.is_some() || opening == b'[' {
            parts.push(Part { span: span_of(member).start..after_comma(text, member.value.end), outer });
        }
        outer = member.value.start;
    }
    parts.reverse();
    parts
}

/// Returns whether a byte is directly in the bracket of a value: in none of its members, but for their names. An error there can be the
/// consequence of a removed member.
fn is_in_bracket(text: &str, value: usize, at: usize) -> bool {
    let Some(within) = bracket(text, value) else { return false };
    at <= within.close(text) && !within.members.iter().any(|member| member.value.contains(&at))
}

/// Returns the span of a member with its name.
fn span_of(member: &BracketMember) -> Range<usize> {
    member.start()..member.value.end
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
        let mistakes = parse_general(text).err().unwrap_or_default();
        mistakes.into_iter().map(|mistake| mistake.message).collect()
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
                "expected a whole number",
                "unknown field `heigth` of `Film`",
                "expected three numbers",
                "field `fov` of `Camera` is written twice",
                "expected a number",
                "missing field `shininess` of `Specular`",
                "unknown shape `Torus`",
                "expected a material",
                "unknown field `position` of `Point`",
                "missing field `intensity` of `Point`",
                "expected a material",
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
