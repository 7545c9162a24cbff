//! Errors of clouds.

use std::fmt;
use std::ops::Range;

/// The reason why a cloud has no particles at a moment.
#[derive(Clone, PartialEq, Eq)]
pub struct CloudError {
    /// The setting that is at fault.
    pub part: CloudPart,
    /// The cause.
    pub message: String,
    /// The remedy.
    pub help: String,
}

/// A setting of a cloud.
#[derive(Clone, Debug, PartialEq, Eq)]
pub enum CloudPart {
    /// The data file.
    Source,
    /// The times of the frames.
    Frames,
    /// A part of the filter's text.
    Filter(Range<usize>),
    /// The sizes.
    ScaleBy,
    /// The colours.
    ColorBy,
    /// The bonds.
    Bonds,
    /// The copies of the cell.
    Images,
    /// The style.
    Style,
}

impl CloudError {
    pub(super) fn new(part: CloudPart, message: impl Into<String>, help: impl Into<String>) -> Self {
        Self { part, message: message.into(), help: help.into() }
    }
}

impl fmt::Display for CloudError {
    fn fmt(&self, formatter: &mut fmt::Formatter<'_>) -> fmt::Result {
        write!(formatter, "{}: {}", self.message, self.help)
    }
}

impl std::error::Error for CloudError {}

debug_as_message!(CloudError);
