//! Parsing of a scene's text.

use std::sync::Arc;

use super::entities::{PART, ParsedEntities};
use super::general_parser::read_general;
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
