//! Parsing of a scene's text.

use std::sync::Arc;

use ron::error::SpannedError;
use serde::de::IgnoredAny;

use super::entities::{PART, ParsedEntities};
use super::expectations::Trail;
use super::explain::explain;
use super::general_parser::{options, read_general};
use super::recover::find_mistakes;
use crate::scene::Diagnostic;
use crate::scene::document::SceneDocument;
use crate::scene::extend::is_scene;
use crate::scene::spans::tokens;

/// Parses a scene's text, given the entities of its previous version or none, which the entities of this one replace. Returns its mistakes
/// if it is invalid.
pub(in crate::scene) fn parse(
    text: &Arc<String>,
    entities: &mut ParsedEntities,
) -> Result<SceneDocument, Vec<Diagnostic>> {
    match entities.parse_next(text, PART) {
        Some(document) => Ok(document),
        None => entities.parse_whole(text).map_err(|error| mistakes(text, error)),
    }
}

pub(super) fn parse_general(text: &str) -> Result<SceneDocument, Vec<Diagnostic>> {
    read_general(text).map_err(|error| mistakes(text, error))
}

/// Returns the mistakes of a text, given the first one.
fn mistakes(text: &str, error: SpannedError) -> Vec<Diagnostic> {
    let holds_nothing = tokens(text).next().is_none() && error.code != ron::Error::UnclosedBlockComment;
    if holds_nothing { vec![nothing(text)] } else { find_mistakes(text, error) }
}

/// Checks the notation of a text that may lack what a scene requires, because another scene has it. Otherwise returns its mistakes.
pub(in crate::scene) fn check_notation(text: &Arc<String>) -> Result<(), Vec<Diagnostic>> {
    // Most texts are scenes, which are parsed faster.
    if ParsedEntities::default().parse_next(text, PART).is_some() {
        return Ok(());
    }
    let Err(error) = options().from_str::<IgnoredAny>(text) else {
        return if is_scene(text) { Ok(()) } else { parse_general(text).map(|_| ()) };
    };
    let mut mistakes = parse_general(text).err().unwrap_or_default();
    if mistakes.iter().any(|mistake| mistake.span.is_none()) {
        return Err(mistakes);
    }
    // The mistakes before this one can be those of an incomplete scene.
    let mistake = explain(text, &error, &Trail::default());
    mistakes.retain(|other| other.span == mistake.span);
    Err(if mistakes.is_empty() { vec![mistake] } else { mistakes })
}

fn nothing(text: &str) -> Diagnostic {
    let message =
        if text.trim().is_empty() { "the file is empty" } else { "the file holds nothing but comments" };
    let help = "`rayreel new FILE` writes a small scene to start from".to_owned();
    Diagnostic::new(message, "", Some(help), None)
}
