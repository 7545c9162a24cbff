//! Why a measurement ends before it is done.

use std::sync::atomic::AtomicBool;

use crate::engine::{Engine, EngineError};
use crate::time::Time;
use crate::trace::Film;

/// Why a measurement ends before it is done.
#[derive(Debug)]
pub(super) enum Stop {
    /// It was cancelled.
    Cancelled,
    /// A frame cannot be rendered.
    Failed(EngineError),
}

impl From<EngineError> for Stop {
    fn from(error: EngineError) -> Self {
        Self::Failed(error)
    }
}

/// Renders a picture that is measured.
pub(super) fn render(engine: &mut Engine, time: Time, cancelled: &AtomicBool) -> Result<Film, Stop> {
    engine.render_unless(time, cancelled)?.ok_or(Stop::Cancelled)
}

/// Returns what was measured; `None` if it was cancelled.
pub(super) fn unless_cancelled<T>(measured: Result<T, Stop>) -> Result<Option<T>, EngineError> {
    match measured {
        Ok(measured) => Ok(Some(measured)),
        Err(Stop::Cancelled) => Ok(None),
        Err(Stop::Failed(error)) => Err(error),
    }
}
