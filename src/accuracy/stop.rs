//! The early end of a measurement.

use crate::engine::EngineError;

/// The reason for the early end of a measurement.
#[derive(Debug)]
pub(super) enum StopReason {
    /// The measurement was cancelled.
    Cancelled,
    /// A frame cannot be rendered.
    Failed(EngineError),
}

impl From<EngineError> for StopReason {
    fn from(error: EngineError) -> Self {
        Self::Failed(error)
    }
}

/// Returns the measurement; `None` if it was cancelled.
pub(super) fn unless_cancelled<T>(measured: Result<T, StopReason>) -> Result<Option<T>, EngineError> {
    match measured {
        Ok(measured) => Ok(Some(measured)),
        Err(StopReason::Cancelled) => Ok(None),
        Err(StopReason::Failed(error)) => Err(error),
    }
}
