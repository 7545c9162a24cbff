//! What ends the systems of a frame before they are through.

use super::UnknownComponent;
use crate::components::ScriptId;
use crate::script::ScriptError;

/// A program that gave no value.
#[derive(Clone, Debug)]
pub struct ScriptFailure {
    /// Which program.
    pub script: ScriptId,
    /// What it drives: `Radius of "ball"`.
    pub channel: String,
    /// When, in seconds.
    pub seconds: f64,
    /// What is wrong.
    pub error: Box<ScriptError>,
}

/// Why a world could not be brought to a moment.
#[derive(Clone, Debug)]
pub enum Halt {
    /// It cannot be copied.
    UnknownComponent(UnknownComponent),
    /// A program gave no value.
    Script(Box<ScriptFailure>),
    /// Nobody waits for it any more.
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
