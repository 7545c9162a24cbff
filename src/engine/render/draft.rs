//! Drafts: quick, reduced images that precede the full frames.

use std::ops::ControlFlow::{self, Continue};
use std::sync::atomic::{AtomicBool, Ordering};
use std::time::{Duration, Instant};

use crate::color::Encoding;
use crate::components::{FilmSettings, Sampling};
use crate::engine::engine::{Engine, EngineError};
use crate::engine::report::FrameReport;
use crate::systems::FrameSettings;
use crate::time::Time;
use crate::trace::{Developed, Film, Lighting, RenderJob, Signals};

/// The reductions of a draft. A draft also has one sample per pixel and is rendered at the frame's own moment.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Draft {
    /// The divisor of the film's width and height; at least one pixel remains.
    pub divisor: u32,
    /// The maximum number of samples of each area light, 1 or more.
    pub light_samples: u32,
    /// The maximum ray depth, 1 or more.
    pub depth: u32,
    /// True if objects occlude lights.
    pub shadows: bool,
}

impl Draft {
    /// Creates a draft that is reduced in size only.
    #[must_use]
    pub const fn sized(divisor: u32) -> Self {
        Self { divisor, light_samples: u32::MAX, depth: u32::MAX, shadows: true }
    }
}

impl Engine {
    /// Renders a draft of a moment. Returns `None` if `cancelled` becomes true during rendering. Afterwards [`report`](Engine::report)
    /// describes the draft; [`plan`](Engine::plan) still describes the last frame.
    ///
    /// # Errors
    ///
    /// As [`Engine::render_frame`].
    pub fn render_draft_unless(
        &mut self,
        time: Time,
        draft: Draft,
        cancelled: &AtomicBool,
    ) -> Result<Option<Film>, EngineError> {
        self.render_draft_on(time, draft, &mut None, Signals::unless(cancelled), &mut |_| Continue(()))
    }

    /// Renders a draft incrementally, like [`render_on`](Engine::render_on).
    ///
    /// # Errors
    ///
    /// As [`Engine::render_frame`].
    pub fn render_draft_on(
        &mut self,
        time: Time,
        draft: Draft,
        begun: &mut Option<RenderJob>,
        signals: Signals<'_>,
        visit: &mut dyn FnMut(&RenderJob) -> ControlFlow<()>,
    ) -> Result<Option<Film>, EngineError> {
        if !self.seek_unless(time, signals.cancelled)? {
            return Ok(None);
        }
        let Some(preparation) = &mut self.preparation else { return Ok(None) };
        let settings = draft.frame_settings(preparation.frame_settings());
        let own = preparation.replace_frame_settings(&settings, &self.world);
        let Some(shown) = self.shown() else { return Ok(None) };
        let (scene, camera, sampling) = (shown.scene(), shown.camera(), shown.sampling(time));
        let mut effects = shown.plan(&self.world).effects();
        effects.lighting = effects.lighting.min(self.effects_left().lighting);
        if !draft.shadows {
            effects.lighting = effects.lighting.min(Lighting::Unshadowed);
        }
        let job = begun.get_or_insert_with(|| RenderJob::new(camera.resolution(), sampling.samples));
        let mut traced = Duration::ZERO;
        let whole = add_all(signals, visit, job, |job| {
            let start = Instant::now();
            let whole = job.add(scene, camera, sampling, 0, effects, signals);
            traced += start.elapsed();
            whole
        });
        if let Some(preparation) = &mut self.preparation {
            preparation.replace_frame_settings(&own, &self.world);
        }
        self.report.trace = traced;
        if !whole {
            return Ok(None);
        }
        Ok(begun.take().map(|job| self.resolve(job).film))
    }

    /// Finishes a job, including its alpha channel, if any, and updates the report.
    pub(in crate::engine) fn resolve<E: Encoding>(&mut self, job: RenderJob<E>) -> Developed<E::Pixel> {
        let start = Instant::now();
        let error = job.estimated_error();
        let (developed, effort, memory) = job.finish();
        self.report = FrameReport {
            trace: self.report.trace + start.elapsed(),
            rays: effort.rays,
            error,
            ends: effort.ends,
            escalations: effort.escalations,
            ..self.report
        };
        self.sample_memory = memory;
        developed
    }
}

/// Adds samples to a job until it is complete, and calls `visit` at every pause. Returns `false` if cancelled or stopped by `visit`.
pub(in crate::engine) fn add_all<E: Encoding>(
    signals: Signals<'_>,
    visit: &mut dyn FnMut(&RenderJob<E>) -> ControlFlow<()>,
    job: &mut RenderJob<E>,
    mut add: impl FnMut(&mut RenderJob<E>) -> bool,
) -> bool {
    while !add(job) {
        if signals.cancelled.load(Ordering::Relaxed) || visit(job).is_break() {
            return false;
        }
    }
    true
}

impl Draft {
    fn frame_settings(self, whole: FrameSettings) -> FrameSettings {
        let FrameSettings { film, sampling, depth, cutoff, light_samples } = whole;
        let side = |pixels: u32| (pixels / self.divisor.max(1)).max(1);
        FrameSettings {
            film: FilmSettings { width: side(film.width), height: side(film.height), ..film },
            sampling: Sampling { samples: 1, ..sampling },
            depth: depth.min(self.depth).max(1),
            cutoff,
            light_samples: light_samples
                .into_iter()
                .map(|samples| samples.min(self.light_samples).max(1))
                .collect(),
        }
    }
}
