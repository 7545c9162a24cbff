//! The general parser, configured for scenes.

use ron::error::SpannedError;
use ron::extensions::Extensions;

use crate::scene::document::SceneDocument;

/// Parses a whole scene's text.
pub(super) fn read_general(text: &str) -> Result<SceneDocument, SpannedError> {
    options().from_str(text)
}

/// Returns the parser options for scene files: `Some` is optional.
pub(in crate::scene) fn options() -> ron::Options {
    ron::Options::default().with_default_extension(Extensions::IMPLICIT_SOME)
}
