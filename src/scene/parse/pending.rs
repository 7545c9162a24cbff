//! The values that are expected where a text ends.
//!
//! A scene that is cut off is rejected at its end, and the requests that are then pending describe the value that should follow:
//!
//! ```text
//! (camera: (fov:                 a number
//! (entities: [(shape:            one of the words Sphere, Plane, Box, .., of the type Shape
//! (entities: [(shape: Box(       the name of a field: size
//! ```

use ron::Error;

use super::expectations::{Expectation, Trail, VariantContent};
use super::general_parser::{read_along, read_general};
use super::recover::missing_field;
use super::token_context::TokenContext;
use crate::scene::document::BackgroundDocument;
use crate::scene::reference;

/// The type, or the variant of a type, whose fields stand in a bracket.
#[derive(Clone, Debug, PartialEq, Eq)]
pub(in crate::scene) struct FieldOwner {
    /// The name of the type.
    pub(in crate::scene) of: &'static str,
    /// The word before the bracket, if the type has several forms.
    pub(in crate::scene) variant: Option<String>,
    pub(in crate::scene) fields: &'static [&'static str],
}

/// Returns the requests that are pending at the end of a text, innermost last. `None` if the text is rejected before its end.
pub(in crate::scene) fn pending(text: &str) -> Option<Vec<Expectation>> {
    let trail = Trail::default();
    let error = read_along(&trail, text).err()?;
    let stopped = TokenContext::error(text, &error).stopped;
    (stopped >= text.trim_end().len()).then(|| trail.open())
}

/// Returns the number of requests that are pending where the parser stops.
pub(in crate::scene) fn depth_of(text: &str) -> usize {
    let trail = Trail::default();
    // Texts that are cut off are rejected.
    let _ = read_along(&trail, text);
    trail.open().len()
}

/// Returns whether the notation of a whole scene is valid.
pub(in crate::scene) fn reads(text: &str) -> bool {
    read_general(text).is_ok()
}

/// Returns the field whose absence is the first mistake of a text.
pub(in crate::scene) fn missing(text: &str) -> Option<String> {
    missing_field(&read_general(text).err()?.code).map(str::to_owned)
}

/// Returns the owner of the fields in the bracket that a text ends with; `None` for a bracket without fields.
pub(in crate::scene) fn owner(text: &str) -> Option<FieldOwner> {
    let open = pending(text).unwrap_or_default();
    match open.iter().rev().find(|request| **request != Expectation::FieldName) {
        Some(Expectation::Fields { name, fields }) if open.last() == Some(&Expectation::FieldName) => {
            Some(FieldOwner { of: name, variant: None, fields })
        }
        Some(Expectation::VariantContent { of, word, content: VariantContent::Fields(fields) }) => {
            Some(FieldOwner { of, variant: Some(word.clone()), fields })
        }
        _ => owner_by_error(text),
    }
}

/// Returns the owner of fields that are requested without their type, because the value has several notations: it is known from the error
/// for an unknown field.
fn owner_by_error(text: &str) -> Option<FieldOwner> {
    let fields = match read_general(&format!("{text}nobody_knows: 0")).err()?.code {
        Error::NoSuchStructField { expected, .. } => expected,
        Error::Message(message) if message.starts_with("unknown field") => BackgroundDocument::FIELDS,
        _ => return None,
    };
    let is_own = |section: &&reference::ManualSection| {
        section.fields.iter().map(|field| field.name).eq(fields.iter().copied())
    };
    let section = reference::sections().iter().find(is_own)?;
    Some(FieldOwner { of: section.name, variant: None, fields })
}
