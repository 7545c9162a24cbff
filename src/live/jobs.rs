//! The tasks of the worker, the jobs of the renderer, their results, and the rendering of one picture.

use std::ops::ControlFlow;
use std::sync::Arc;
use std::time::{Duration, Instant};

use super::commands::Detail;
use super::progressive::{PreviewLevel, RefreshTimer};
use crate::engine::{Engine, EngineError, RenderRequest, unless_cancelled};
use crate::systems::RenderSettings;
use crate::trace::{Film, RenderJob, ReusablePicture, Signals};

/// A piece of work. All pictures are of the current frame.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) enum PreviewJob {
    /// The finished picture, if it is in the cache.
    Cached(Occasion),
    /// A coarse picture.
    Preview(PreviewLevel, LevelRole),
    /// The requested picture, or the full one.
    Picture {
        detail: Detail,
        /// True if a full picture follows.
        precedes_full: bool,
    },
    /// A measurement of the cost of the effect with this index or, after all effects, of a point of the error curve.
    Measurement(usize),
}

/// The reason why a frame is shown.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) enum Occasion {
    /// The frame or the quality is requested.
    Request,
    /// The first coarse picture is shown.
    AfterCoarse,
    /// Playback has reached the frame.
    Playback,
}

/// The role of a coarse picture among the pictures of its frame.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) enum LevelRole {
    /// The first picture, which cannot wait.
    First,
    /// A picture between the first and the requested one.
    Between,
    /// The only picture of its frame during playback.
    Playback,
}

/// The result of a job.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) enum JobOutcome {
    /// The result is published.
    Done,
    /// The result is published, or could not be, and no job follows.
    Ended,
    /// A command interrupted the job, which can be continued.
    Interrupted,
    /// A coarse picture should come first.
    Needs(PreviewLevel, LevelRole),
    /// The cache has no picture of the frame.
    NotCached(Occasion),
}

/// A picture while it is being rendered.
pub(super) struct RenderInProgress {
    pub(super) frame: u32,
    pub(super) detail: Detail,
    pub(super) job: Option<RenderJob>,
    pub(super) traced: Duration,
    /// True if any part of the picture has been shown.
    pub(super) is_shown: bool,
    pub(super) timer: RefreshTimer,
}

impl RenderInProgress {
    pub(super) fn new(frame: u32, detail: Detail) -> Self {
        Self { frame, detail, job: None, traced: Duration::ZERO, is_shown: false, timer: RefreshTimer::new() }
    }
}

/// Minimum expected time of a picture of which tiles are reused, in milliseconds: copying its film and comparing its scene and its tiles with
/// former ones takes 3 to 6.
pub(super) const REUSE_ABOVE_MS: f64 = 20.0;

/// A finished full picture whose tiles are reused in the next one.
pub(super) type ReuseSlot = Option<Arc<ReusablePicture>>;

/// Renders a frame until it is finished or stopped, with the tiles of the picture in `reuse`; see [`Engine::render`].
pub(super) fn render(
    engine: &mut Engine,
    (frame, detail): (u32, Detail),
    job: &mut Option<RenderJob>,
    reuse: Option<&mut ReuseSlot>,
    signals: Signals<'_>,
    visit: &mut dyn FnMut(&RenderJob) -> ControlFlow<()>,
) -> Result<Option<Film>, EngineError> {
    let time = engine.timeline.time_of(frame);
    let request = RenderRequest {
        settings: settings_of(engine, detail),
        tile_stats: true,
        fingerprint: false,
        signals,
        on_pause: Some(visit),
        resume: Some(job),
        reuse,
        ..RenderRequest::at(time)
    };
    Ok(unless_cancelled(engine.render(request))?.map(|image| image.film))
}

/// Returns the settings of pictures of a quality; `None` for those of the engine.
pub(super) fn settings_of(engine: &Engine, detail: Detail) -> Option<RenderSettings> {
    let draft =
        |divisor| RenderSettings::draft(engine.effective_settings().film, divisor).or(engine.settings);
    match detail {
        Detail::Full => None,
        Detail::Draft => Some(draft(1)),
        Detail::Half => Some(draft(2)),
    }
}

/// The next task of the thread.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) enum Task {
    Idle,
    Run(PreviewJob),
    /// Nothing until the given time, since the next frame of playback may be requested. After that time, a better picture.
    Wait(Instant),
    /// To fill the cache from the given time on.
    Fill(Instant),
}

impl Task {
    pub(super) fn is_measurement(self) -> bool {
        matches!(self, Self::Run(PreviewJob::Measurement(_)))
    }

    /// Returns whether it renders a picture, now or after a wait.
    pub(super) fn is_picture(self) -> bool {
        !matches!(self, Self::Idle | Self::Fill(_)) && !self.is_measurement()
    }
}
