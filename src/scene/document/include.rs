//! Parts in files of their own.

use serde::Deserialize;

use super::TransformDocument;

/// Another file, in this place.
#[derive(Clone, Debug, PartialEq, Deserialize)]
#[serde(deny_unknown_fields, rename = "Include")]
pub(crate) struct IncludeDocument {
    pub(crate) file: String,
    pub(crate) name: Option<String>,
    pub(crate) transform: Option<TransformDocument>,
}
