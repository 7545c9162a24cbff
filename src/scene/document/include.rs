//! Includes of other scene files.

use serde::Deserialize;

use super::TransformDocument;

/// An include of another scene file.
#[derive(Clone, Debug, PartialEq, Deserialize)]
#[serde(deny_unknown_fields, rename = "Include")]
pub(crate) struct IncludeDocument {
    pub(crate) file: String,
    pub(crate) name: Option<String>,
    pub(crate) transform: Option<TransformDocument>,
}
