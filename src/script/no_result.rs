//! The reasons for which a script has no result.

use std::ops::Range;

use super::ScriptError;

/// The reason a script has no result.
#[derive(Clone, Debug, PartialEq)]
pub(crate) enum NoResult {
    /// The script failed.
    Error(Box<ScriptError>),
    /// The script reads a value that is not [known](ScriptContext::set_value). It has to be run again once the value is known.
    Needs(Read),
}

/// A value that a script reads, as in `value("ball", "Radius")` or `value("ball", "Radius", t - 0.5)`.
#[derive(Clone, Debug, PartialEq)]
pub(crate) struct Read {
    /// Name of the owner of the channel.
    pub(crate) target: String,
    /// Name of the channel.
    pub(crate) channel: String,
    /// The moment in seconds, as the script computes it.
    pub(crate) seconds: f64,
    /// Byte range of the function name of the call in the script's text.
    pub(crate) span: Range<usize>,
}
