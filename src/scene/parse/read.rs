//! Parsing of a scene's text.

use std::sync::Arc;

use ron::error::SpannedError;
use serde::Deserialize;

use super::entities::{PART, ParsedEntities};
use super::expectations::Trail;
use super::general_parser::{options, read_general};
use super::recover::find_mistakes;
use crate::scene::Diagnostic;
use crate::scene::document::SceneDocument;
use crate::scene::spans::tokens;

/// Parses a scene's text, given the entities of its previous version or none, which the entities of this one replace. Returns its mistakes
/// if it is invalid.
pub(in crate::scene) fn parse(
    text: &Arc<String>,
    entities: &mut ParsedEntities,
) -> Result<SceneDocument, Vec<Diagnostic>> {
    entities.parse_next(text, PART).map_or_else(|| parse_general(text), Ok)
}

pub(super) fn parse_general(text: &str) -> Result<SceneDocument, Vec<Diagnostic>> {
    read_general(text).map_err(|error| {
        let holds_nothing = tokens(text).next().is_none() && error.code != ron::Error::UnclosedBlockComment;
        if holds_nothing { vec![nothing(text)] } else { find_mistakes(text, error) }
    })
}

fn nothing(text: &str) -> Diagnostic {
    let message =
        if text.trim().is_empty() { "the file is empty" } else { "the file holds nothing but comments" };
    let help = "`rayreel new FILE` writes a small scene to start from".to_owned();
    Diagnostic::new(message, "", Some(help), None)
}

/// Returns the trail of parsing a text that is rejected.
pub(super) fn trail(text: &str) -> Trail {
    let trail = Trail::default();
    // The text is known to be invalid.
    let _ = read_along(&trail, text);
    trail
}

fn read_along(trail: &Trail, text: &str) -> Result<SceneDocument, SpannedError> {
    let mut parser = ron::Deserializer::from_str_with_options(text, &options())?;
    SceneDocument::deserialize(trail.watch(&mut parser))
        .and_then(|document| parser.end().map(|()| document))
        .map_err(|error| parser.span_error(error))
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Checks a scene, all its prefixes up to a token, and the scene without each one of its tokens.
    #[test]
    fn reading_along_an_empty_trail_equals_a_full_read() {
        let text = include_str!("../../../tests/hard_cases/every_number.ron");
        let cut = tokens(text).map(|token| text[..token.start].to_owned());
        let without = tokens(text).map(|token| text[..token.start].to_owned() + &text[token.end..]);
        let texts: Vec<String> = cut.chain(without).chain([text.to_owned()]).collect();
        assert!(texts.len() > 1000);
        for text in texts {
            assert_eq!(read_along(&Trail::default(), &text), read_general(&text), "{text}");
        }
    }
}
