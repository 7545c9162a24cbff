//! The early end of a measurement.

use std::sync::atomic::AtomicBool;

use crate::engine::{Engine, EngineError};
use crate::systems::{RenderRequest, RenderSettings};
use crate::time::Time;
use crate::trace::{Film, Signals};

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

/// Renders one picture of a measurement. `settings` override the engine's.
pub(super) fn render(
    engine: &mut Engine,
    time: Time,
    settings: RenderSettings,
    cancelled: &AtomicBool,
) -> Result<Film, StopReason> {
    let request = RenderRequest {
        settings: Some(settings.or(engine.settings())),
        fingerprint: false,
        signals: Signals::unless(cancelled),
        ..RenderRequest::at(time)
    };
    Ok(engine.render(request)?.ok_or(StopReason::Cancelled)?.film)
}

/// Returns the measurement; `None` if it was cancelled.
pub(super) fn unless_cancelled<T>(measured: Result<T, StopReason>) -> Result<Option<T>, EngineError> {
    match measured {
        Ok(measured) => Ok(Some(measured)),
        Err(StopReason::Cancelled) => Ok(None),
        Err(StopReason::Failed(error)) => Err(error),
    }
}
