//! The reasons for which the systems of a frame stop early.

use super::UnknownComponent;
use crate::components::ScriptId;
use crate::script::ScriptError;

/// A script that failed to return a value.
#[derive(Clone, Debug)]
pub(crate) struct ScriptFailure {
    pub(crate) script: ScriptId,
    /// The value that the script drives, such as `Radius of "ball"`.
    pub(crate) channel: String,
    /// The moment, in seconds.
    pub(crate) seconds: f64,
    pub(crate) error: Box<ScriptError>,
}

/// A cloud without particles at a moment, as when its file cannot be read.
#[derive(Clone, Debug)]
pub(crate) struct CloudFailure {
    /// The place of the cloud in a scene, and its name.
    pub(crate) cloud: String,
    /// The moment, in seconds.
    pub(crate) seconds: f64,
    pub(crate) message: String,
}

/// The reason why the world could not be advanced to a moment.
#[derive(Clone, Debug)]
pub(crate) enum Interrupted {
    /// The world cannot be copied.
    UnknownComponent(UnknownComponent),
    /// A script failed to return a value.
    Script(Box<ScriptFailure>),
    /// A cloud has no particles.
    Cloud(Box<CloudFailure>),
    /// The request was cancelled.
    Cancelled,
}

impl From<UnknownComponent> for Interrupted {
    fn from(unknown: UnknownComponent) -> Self {
        Self::UnknownComponent(unknown)
    }
}

impl From<ScriptFailure> for Interrupted {
    fn from(failure: ScriptFailure) -> Self {
        Self::Script(Box::new(failure))
    }
}
