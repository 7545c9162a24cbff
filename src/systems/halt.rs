//! The reasons for which the systems of a frame end early.

use super::UnknownComponent;
use crate::components::ScriptId;
use crate::script::ScriptError;

/// A script that gave no value.
#[derive(Clone, Debug)]
pub(crate) struct ScriptFailure {
    /// The script.
    pub(crate) script: ScriptId,
    /// The value that it drives: `Radius of "ball"`.
    pub(crate) channel: String,
    /// The moment, in seconds.
    pub(crate) seconds: f64,
    /// The error.
    pub(crate) error: Box<ScriptError>,
}

/// The reason why a world could not be brought to a moment.
#[derive(Clone, Debug)]
pub(crate) enum Halt {
    /// It cannot be copied.
    UnknownComponent(UnknownComponent),
    /// A script gave no value.
    Script(Box<ScriptFailure>),
    /// The request was cancelled.
    Cancelled,
}

impl From<UnknownComponent> for Halt {
    fn from(unknown: UnknownComponent) -> Self {
        Self::UnknownComponent(unknown)
    }
}

impl From<ScriptFailure> for Halt {
    fn from(failure: ScriptFailure) -> Self {
        Self::Script(Box::new(failure))
    }
}
