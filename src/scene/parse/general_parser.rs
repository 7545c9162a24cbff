//! The general parser, configured for scenes.

use ron::error::SpannedError;
use ron::extensions::Extensions;
use serde::Deserialize;

use super::expectations::Trail;
use crate::scene::document::SceneDocument;

/// Parses a whole scene's text. The requests are recorded even if they are not needed: instances of the parser for each type of a scene, with and
/// without records, would double its code.
pub(super) fn read_general(text: &str) -> Result<SceneDocument, SpannedError> {
    read_along(&Trail::default(), text)
}

/// Returns the parser options for scene files: `Some` is optional.
pub(in crate::scene) fn options() -> ron::Options {
    ron::Options::default().with_default_extension(Extensions::IMPLICIT_SOME)
}

/// Returns the trail of parsing a text that is rejected.
pub(super) fn trail(text: &str) -> Trail {
    let trail = Trail::default();
    // The text is known to be invalid.
    let _ = read_along(&trail, text);
    trail
}

pub(super) fn read_along(trail: &Trail, text: &str) -> Result<SceneDocument, SpannedError> {
    let mut parser = ron::Deserializer::from_str_with_options(text, &options())?;
    SceneDocument::deserialize(trail.watch(&mut parser))
        .and_then(|document| parser.end().map(|()| document))
        .map_err(|error| parser.span_error(error))
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::scene::spans::tokens;

    /// Checks a scene, all its prefixes up to a token, and the scene without each one of its tokens.
    #[test]
    fn recording_does_not_change_what_is_read() {
        let text = include_str!("../../../tests/hard_cases/every_number.ron");
        let cut = tokens(text).map(|token| text[..token.start].to_owned());
        let without = tokens(text).map(|token| text[..token.start].to_owned() + &text[token.end..]);
        let texts: Vec<String> = cut.chain(without).chain([text.to_owned()]).collect();
        assert!(texts.len() > 1000);
        for text in texts {
            assert_eq!(read_general(&text), options().from_str(&text), "{text}");
        }
    }
}
