//! The parser, as it is set up for scenes.

use ron::error::SpannedError;
use ron::extensions::Extensions;

use crate::scene::document::SceneDocument;

/// Reads a scene's text from its start to its end.
pub(super) fn read_whole(text: &str) -> Result<SceneDocument, SpannedError> {
    options().from_str(text)
}

/// Returns the options with which scene files are read: `Some` may be left out.
pub(in crate::scene) fn options() -> ron::Options {
    ron::Options::default().with_default_extension(Extensions::IMPLICIT_SOME)
}
