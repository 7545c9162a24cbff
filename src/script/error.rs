//! Script errors and their positions.

use std::ops::Range;

/// A compile-time or run-time error of a script.
#[derive(Clone, Debug, PartialEq, Eq)]
pub(crate) struct ScriptError {
    /// The error message.
    pub(crate) message: String,
    /// Annotation of the marked span.
    pub(crate) label: String,
    /// The remedy, if there is one.
    pub(crate) help: Option<String>,
    /// The unknown name and the known ones, if the error is an unknown name.
    pub(crate) unknown: Option<Box<UnknownName>>,
    /// The marked byte range of the script's text.
    pub(crate) span: Range<usize>,
}

/// An unknown name.
#[derive(Clone, Debug, PartialEq, Eq)]
pub(crate) struct UnknownName {
    /// The name.
    pub(crate) name: String,
    /// The kind of item that the name should refer to, in the plural.
    pub(crate) kind: &'static str,
    /// The known names.
    pub(crate) known: Vec<String>,
}

impl ScriptError {
    /// Creates an error that marks the whole text.
    #[must_use]
    pub(crate) fn new(
        text: &str,
        message: impl Into<String>,
        label: impl Into<String>,
        help: Option<String>,
    ) -> Self {
        let span = text_span(text);
        Self { message: message.into(), label: label.into(), help, unknown: None, span }
    }
}

/// Returns the byte range of a text except surrounding whitespace.
pub(super) fn text_span(text: &str) -> Range<usize> {
    text.len() - text.trim_start().len()..text.trim_end().len()
}
