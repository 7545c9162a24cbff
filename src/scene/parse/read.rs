//! Parsing of a scene's text.

use ron::error::SpannedError;
use serde::Deserialize;

use super::expectations::Trail;
use super::explain::explain;
use super::parallel::read_in_parts;
use super::whole::{options, read_whole};
use crate::scene::Diagnostic;
use crate::scene::document::SceneDocument;
use crate::scene::spans::tokens;

/// Parses a scene's text. Returns a diagnostic if it is invalid.
pub(in crate::scene) fn parse(text: &str) -> Result<SceneDocument, Diagnostic> {
    read(text).map_err(|error| {
        let holds_nothing = tokens(text).next().is_none() && error.code != ron::Error::UnclosedBlockComment;
        if holds_nothing { nothing(text) } else { explain(text, &error, &trail(text)) }
    })
}

fn nothing(text: &str) -> Diagnostic {
    let message =
        if text.trim().is_empty() { "the file is empty" } else { "the file holds nothing but comments" };
    let help = "`rayreel new FILE` writes a small scene to start from".to_owned();
    Diagnostic::new(message, "", Some(help), None)
}

/// Parses a scene's text. Long texts are parsed on all threads, and by the fast path where they are plain.
pub(in crate::scene) fn read(text: &str) -> Result<SceneDocument, SpannedError> {
    /// Minimum length in bytes for parsing in parts. Shorter texts are parsed before it would help.
    const LONG: usize = 1 << 16;
    /// Number of parts per thread. It is large because some parts take longer than others, and because the last part is parsed along with
    /// the rest of the scene.
    const PARTS: usize = 16;
    let parts = rayon::current_num_threads() * PARTS;
    let in_parts = if text.len() < LONG { None } else { read_in_parts(text, parts) };
    in_parts.map_or_else(|| read_whole(text), Ok)
}

/// Returns the trail of parsing a text that is rejected.
fn trail(text: &str) -> Trail {
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
    fn a_text_is_the_same_along_a_trail() {
        let text = include_str!("../../../tests/hard_cases/every_number.ron");
        let cut = tokens(text).map(|token| text[..token.start].to_owned());
        let without = tokens(text).map(|token| text[..token.start].to_owned() + &text[token.end..]);
        let texts: Vec<String> = cut.chain(without).chain([text.to_owned()]).collect();
        assert!(texts.len() > 1000);
        for text in texts {
            assert_eq!(read_along(&Trail::default(), &text), read(&text), "{text}");
        }
    }
}
