//! The measurement of a single frame.

use std::sync::atomic::AtomicBool;

use crate::engine::{Engine, EngineError};
use crate::systems::{RenderRequest, RenderSettings};
use crate::time::Time;
use crate::trace::{EstimatedError, Film, RayCounts, Signals};

/// A rendered frame and its cost.
#[derive(Clone, Debug)]
pub struct MeasuredFrame {
    /// The pixels.
    pub film: Film,
    /// The time to animate, prepare and trace the frame, in seconds.
    pub seconds: f64,
    /// The number of rays.
    pub rays: RayCounts,
    /// The number of executed instructions, if they are counted.
    pub instructions: Option<u64>,
    /// The estimated error, if the frame has an error target.
    pub estimated: Option<EstimatedError>,
}

impl MeasuredFrame {
    /// Renders a frame with settings that override the engine's. `instructions` returns the number of instructions executed so far, if they
    /// are counted.
    ///
    /// # Errors
    ///
    /// As [`Engine::render`].
    pub fn render(
        engine: &mut Engine,
        time: Time,
        settings: RenderSettings,
        cancelled: &AtomicBool,
        instructions: &mut dyn FnMut() -> Option<u64>,
    ) -> Result<Self, EngineError> {
        let before = instructions();
        let image = engine.render(RenderRequest {
            settings: Some(settings.or(engine.settings)),
            fingerprint: false,
            signals: Signals::unless(cancelled),
            ..RenderRequest::at(time)
        })?;
        let counted = before.zip(instructions());
        let report = engine.report();
        Ok(Self {
            film: image.film,
            seconds: (report.animate + report.prepare + report.trace).as_secs_f64(),
            rays: report.rays,
            instructions: counted.map(|(before, after)| after.saturating_sub(before)),
            estimated: report.error,
        })
    }
}
