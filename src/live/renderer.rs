//! Rendering of a session's pictures: coarse ones, the requested one, and the full one due after an edit.

mod describing;
mod filling;

use std::ops::ControlFlow::{Break, Continue};
use std::sync::Arc;
use std::sync::atomic::Ordering;
use std::time::{Duration, Instant};

use hecs::World;

use super::cache::FrameKey;
use super::cache_folder::CacheFolder;
use super::commands::{CommandQueue, Detail};
use super::jobs::{
    JobOutcome, LevelRole, Occasion, PreviewJob, REUSE_ABOVE_MS, RenderInProgress, ReuseSlot, render,
};
use super::measure;
use super::outline::part_of;
use super::progressive::{
    Effort, FIRST_DIVISOR, FIRST_MS, PreviewLevel, RequestedPicture, Timings, is_representative,
    share_of_unfinished, with_deadline,
};
use super::publish::{Event, PictureKind, Publisher, RenderedPicture, Unwritten};
use super::state::{EditedPart, Planned, State, Times};
use super::warnings::PictureWarnings;
use crate::color::Transfer;
use crate::engine::{Engine, EngineError, RenderRequest, unless_cancelled};
use crate::scene::{Scene, Sources};
use crate::systems::{Effect, EffectSet, EffectiveSettings, RenderSettings, Viewpoint};
use crate::trace::{Film, RenderJob, RenderedImage, Signals};

/// Minimum time for a picture before a coarse one is rendered first, if nothing of its frame is shown yet. Most pictures of simple scenes
/// are finished by then. Twice the expected time applies if that is longer.
const PREVIEW_DELAY: Duration = Duration::from_millis(50);
/// Minimum time slice of the full picture due after an edit, even when another picture is requested: half a frame interval at 25 frames
/// per second, so that the picture progresses during playback, which stays smooth.
const MIN_SLICE: Duration = Duration::from_millis(20);
/// Maximum time of a curve point other than the scene's own, in milliseconds, so that the curve of a slow frame ends.
const LONGEST_POINT: f64 = 2000.0;

/// The engine of the displayed scene, and the pictures of its current frame.
pub(super) struct Renderer {
    engine: Engine,
    sources: Sources,
    without: EffectSet,
    allowed: Vec<&'static str>,
    commands: Arc<CommandQueue>,
    publisher: Publisher,
    timings: Timings,
    /// The last coarse picture of the displayed frame, and its time in milliseconds.
    last_level: Option<(PreviewLevel, f64)>,
    /// The requested picture, with the samples traced so far.
    in_progress: Option<RenderInProgress>,
    /// The full picture that is due after an edit and is rendered while other pictures are shown.
    background: Option<RenderInProgress>,
    unwritten: Unwritten,
    /// The picture that is rendered for the cache.
    filling: Option<RenderInProgress>,
    /// The last full picture that was requested, of any frame, and the last one for the cache. Their tiles are reused.
    displayed: ReuseSlot,
    filled: ReuseSlot,
    cache_reported: Instant,
    folder: Option<CacheFolder>,
}

impl Renderer {
    pub(super) fn new(
        engine: Engine,
        without: EffectSet,
        allowed: Vec<&'static str>,
        commands: Arc<CommandQueue>,
        publisher: Publisher,
    ) -> Self {
        Self {
            engine,
            sources: Sources::default(),
            without,
            allowed,
            commands,
            publisher,
            timings: Timings::default(),
            last_level: None,
            in_progress: None,
            background: None,
            unwritten: Unwritten::default(),
            filling: None,
            displayed: None,
            filled: None,
            cache_reported: Instant::now(),
            folder: None,
        }
    }

    /// Replaces the displayed scene. Parts that both scenes share are kept. Publishes the new state, with `wanted_frame` or, if the
    /// timeline is shorter, its last frame, and with the part that was edited if `is_edited` is set. `read` is the time of reading in
    /// milliseconds.
    pub(super) fn load(
        &mut self,
        scene: Scene,
        sources: Sources,
        read: f64,
        wanted_frame: u32,
        is_edited: bool,
    ) {
        let start = Instant::now();
        if self.publisher.published().state().reloads == 0 {
            self.engine = Engine::from_scene(scene);
            self.engine.settings = RenderSettings { without: self.without, ..RenderSettings::default() };
        } else {
            self.engine.reload(scene);
        }
        let changed = is_edited.then(|| sources.changed_since(&self.sources)).flatten();
        self.sources = sources;
        if let Some(part) = changed.and_then(|changed| part_of(self.engine.world(), changed)) {
            self.publisher.published().update_without_notify(|state| {
                state.edited = Some(EditedPart { part, reloads: state.reloads + 1 });
            });
        }
        if is_edited {
            // It is an edit of its own, whatever is tried on the page.
            self.unwritten = Unwritten::default();
        }
        let times = Times { read, build: Times::milliseconds(start.elapsed()), ..Times::default() };
        self.begin(times, wanted_frame);
    }

    /// Begins to display the engine's scene. Publishes the new state, as [`load`](Self::load) does.
    pub(super) fn begin(&mut self, times: Times, wanted_frame: u32) {
        self.discard_unfinished();
        self.background = None;
        self.begin_cache();
        let (timeline, film) = (self.engine.timeline, self.engine.effective_settings().film);
        let published = self.publisher.published();
        // The steps of a drag are one edit: its pictures are compared with the last one before it.
        let unwritten = published.unwritten();
        let before = match self.unwritten.continues_in(unwritten) {
            true => published.state().before,
            false => published.keep_for_comparison(),
        };
        self.unwritten = unwritten;
        // Pages are notified together with the first picture, so that they do not keep the machine busy before it.
        published.update_without_notify(|state| {
            *state = State {
                reloads: state.reloads + 1,
                frame: wanted_frame.min(timeline.frame_count() - 1),
                frames: timeline.frame_count(),
                rate: timeline.rate.per_second(),
                film: (film.width, film.height),
                before,
                rendering: true,
                progress: 0.0,
                mistakes: None,
                frame_mistakes: None,
                times,
                ..std::mem::take(state)
            };
        });
        if !self.publisher.published().shows_tried_values() {
            self.publisher.emit(Event::Reloaded(times));
        }
    }

    /// Discards the unfinished pictures of a frame that is no longer displayed.
    pub(super) fn discard_unfinished(&mut self) {
        (self.in_progress, self.last_level) = (None, None);
    }

    /// Returns the effects that are disabled.
    pub(super) fn without(&self) -> EffectSet {
        self.without
    }

    /// Returns the conversion of the scene's colours.
    pub(super) fn transfer(&self) -> Transfer {
        self.engine.effective_settings().film.transfer
    }

    /// Returns the level of the first coarse picture of a frame.
    pub(super) fn first_level(&self) -> PreviewLevel {
        self.timings.first(self.publisher.published().state().film, FIRST_MS, FIRST_DIVISOR)
    }

    /// Returns the best level that takes at most `milliseconds`.
    pub(super) fn level_within(&self, milliseconds: f64) -> PreviewLevel {
        self.timings.first(self.publisher.published().state().film, milliseconds, 1)
    }

    /// Returns a finer level than the last one, or `None` if the requested picture should follow.
    pub(super) fn finer_level(&mut self, detail: Detail) -> Option<PreviewLevel> {
        let (level, took) = self.last_level?;
        let target = RequestedPicture { share: 1.0 - self.reusable_share(detail), ..self.target(detail) };
        self.timings.finer(level, took, target)
    }

    /// Returns whether a picture is expected to take at most `milliseconds`.
    pub(super) fn is_expected_within(&self, milliseconds: f64, detail: Detail) -> bool {
        self.timings.expected(self.target(detail)).is_some_and(|expected| expected <= milliseconds)
    }

    /// Returns whether the current frame has only a coarse picture, or none.
    pub(super) fn shows_coarse_picture(&self) -> bool {
        self.publisher.latest().is_none_or(|(info, _)| info.coarse)
    }

    pub(super) fn emit(&mut self, event: Event) {
        self.publisher.emit(event);
    }

    /// Reports that the frame cannot be rendered.
    pub(super) fn fail(&mut self, error: EngineError) {
        self.publisher.fail(error);
    }

    /// Returns whether the current frame is shown by a finished picture from the cache, which has no film.
    pub(super) fn shows_cached_picture(&self) -> bool {
        self.publisher.latest().is_some_and(|(_, film)| film.is_none())
    }

    /// Returns the world at the start of the timeline, for changes.
    pub(super) fn world_mut(&mut self) -> &mut World {
        self.engine.world_mut()
    }

    /// Sets the view in place of that of the camera.
    pub(super) fn set_view(&mut self, view: Option<Viewpoint>) {
        self.engine.settings.view = view;
    }

    /// Runs a job until it is finished or a command interrupts it.
    pub(super) fn run(&mut self, job: PreviewJob) -> Result<JobOutcome, EngineError> {
        match job {
            PreviewJob::Cached(occasion) => Ok(self.show_cached(occasion)),
            PreviewJob::Preview(level, role) => self.render_preview(level, role),
            PreviewJob::Picture { detail, precedes_full } => self.render_requested(detail, precedes_full),
            PreviewJob::Measurement(index) => self.measure(index),
        }
    }

    /// Publishes the finished picture of the current frame, if it is in the cache. The fingerprint of the frame, which may need as much time
    /// as several coarse pictures, is found only after one.
    fn show_cached(&mut self, occasion: Occasion) -> JobOutcome {
        let published = self.publisher.published();
        let state = published.state();
        let (is_empty, key) = {
            let cache = published.cache();
            (cache.is_empty(), cache.key(state.frame))
        };
        let is_unlikely = is_empty || key == FrameKey::Unknown && occasion != Occasion::AfterCoarse;
        if is_unlikely && !self.may_be_stored() {
            return JobOutcome::NotCached(occasion);
        }
        let commands = Arc::clone(&self.commands);
        self.find_key(state.frame, Signals { cancelled: commands.interrupt(), ..Signals::none() });
        let mut cache = self.publisher.published().cache();
        let is_unknown = cache.key(state.frame) == FrameKey::Unknown;
        let picture = cache.picture(state.frame).cloned();
        drop(cache);
        match picture.or_else(|| self.load_stored(state.frame)) {
            Some(picture) => {
                self.publisher.publish_cached(&state, picture);
                JobOutcome::Done
            }
            None if is_unknown => JobOutcome::Interrupted,
            None => JobOutcome::NotCached(occasion),
        }
    }

    /// Renders and publishes a coarse picture. A first picture that takes too long is replaced by a cheaper one. A picture between the
    /// first and the requested one has no successors if a command interrupts it: no part of it can be kept, so frequent commands would
    /// otherwise delay the requested picture forever.
    fn render_preview(&mut self, level: PreviewLevel, role: LevelRole) -> Result<JobOutcome, EngineError> {
        let state = self.publisher.published().state();
        let time = self.engine.timeline.time_of(state.frame);
        let (engine, interrupt) = (&mut self.engine, self.commands.interrupt());
        let deadline = if role == LevelRole::First { level.deadline() } else { None };
        let (image, is_late) = with_deadline(interrupt, deadline, |begin| {
            let pause = || {
                begin();
                false
            };
            let signals = Signals { cancelled: interrupt, pause: &pause };
            let EffectiveSettings { film, quality, .. } = engine.effective_settings();
            let settings = level.settings(film, quality).or(engine.settings);
            engine.render(RenderRequest {
                settings: Some(settings),
                fingerprint: false,
                signals,
                ..RenderRequest::at(time)
            })
        });
        let (image, traced) = (unless_cancelled(image)?, self.engine.report().trace);
        let took = Times::milliseconds(traced);
        let Some(RenderedImage { film, .. }) = image else {
            if is_late {
                self.timings.note_failure(level, took, state.film);
                return Ok(JobOutcome::Needs(level.cheaper(state.film), role));
            }
            if role == LevelRole::Between {
                self.last_level = None;
            }
            return Ok(JobOutcome::Interrupted);
        };
        let is_pilot = role == LevelRole::First && self.timings.is_unknown();
        self.note(level.effort(), traced);
        let better = self.first_level();
        if is_pilot && level.is_replaced_by(better, took) {
            return Ok(JobOutcome::Needs(better, role));
        }
        self.last_level = Some((level, took));
        let unfinished = self.in_progress.as_ref().and_then(|unfinished| unfinished.job.as_ref());
        let progress = unfinished.map_or(0.0, share_of_unfinished);
        Ok(self.publish(&state, PictureKind::Coarse(progress), film, traced))
    }

    /// Renders the requested picture and shows it while unfinished. An interrupting command discards nothing of it unless it requests
    /// another picture. If nothing of the frame is shown yet and rendering takes too long, a coarse picture comes first.
    fn render_requested(&mut self, detail: Detail, precedes_full: bool) -> Result<JobOutcome, EngineError> {
        let state = self.publisher.published().state();
        let previous = self.in_progress.take();
        let previous = previous.filter(|previous| (previous.frame, previous.detail) == (state.frame, detail));
        let mut in_progress = previous.unwrap_or_else(|| RenderInProgress::new(state.frame, detail));
        let (film, outcome) = self.trace(&state, &mut in_progress)?;
        let Some(film) = film else {
            let progress = in_progress.job.as_ref().map_or(0.0, share_of_unfinished);
            self.publisher.published().update(|state| state.progress = progress);
            self.in_progress = Some(in_progress);
            return Ok(outcome);
        };
        self.note(Effort::Full, in_progress.traced);
        let is_full = detail == Detail::Full;
        let kind = if is_full { PictureKind::Full } else { PictureKind::Draft { precedes_full } };
        Ok(self.publish(&state, kind, film, in_progress.traced))
    }

    /// Traces the requested picture until it is finished or interrupted. Visits it from time to time, to record its speed and show it
    /// unfinished. Returns the film, or the outcome without one.
    fn trace(
        &mut self,
        state: &State,
        in_progress: &mut RenderInProgress,
    ) -> Result<(Option<Film>, JobOutcome), EngineError> {
        let target = self.target(in_progress.detail);
        let deadline = self.publisher.latest().is_none().then(|| self.preview_delay(target));
        let reuses = self.reuses(in_progress.detail);
        let Self { engine, publisher, timings, last_level, commands, displayed, .. } = self;
        let RenderInProgress { frame, detail, job, traced, is_shown, timer } = in_progress;
        let (interrupt, transfer) = (commands.interrupt(), engine.effective_settings().film.transfer);
        let traced_before = Times::milliseconds(*traced) - timer.traced();
        let mut outcome = JobOutcome::Interrupted;
        let mut visit = |job: &RenderJob| {
            timer.reschedule();
            let target = target.traced_by(job);
            let (traced, progress) = (traced_before + timer.traced(), share_of_unfinished(job));
            if is_representative(job.reused_share()) {
                timings.note(Effort::Full, traced, target.rays_so_far(job));
            }
            // The speed now known may leave time for another coarse picture, which would be worse than an unfinished one that is already
            // shown.
            let level = last_level.filter(|_| !*is_shown);
            if let Some(finer) = level.and_then(|(level, took)| timings.finer(level, took, target)) {
                outcome = JobOutcome::Needs(finer, LevelRole::Between);
                return Break(());
            }
            publisher.published().update(|state| state.progress = progress);
            let Some(beneath) = publisher.latest().and_then(|(_, film)| film.cloned()) else {
                return Continue(());
            };
            let show = || {
                let film = job.resolve_over(&beneath);
                publisher.publish(state, RenderedPicture::unfinished(film, transfer, progress, traced, state))
            };
            match timer.show_if_due(show) {
                Some(false) => {
                    outcome = JobOutcome::Ended;
                    return Break(());
                }
                Some(true) => *is_shown = true,
                None => {}
            }
            Continue(())
        };
        let (film, is_late) = with_deadline(interrupt, deadline, |begin| {
            let pause = || {
                begin();
                timer.is_due()
            };
            let signals = Signals { cancelled: interrupt, pause: &pause };
            let reuse = reuses.then_some(displayed);
            render(engine, (*frame, *detail), job, reuse, signals, &mut visit)
        });
        *traced += engine.report().trace;
        let film = film?;
        if film.is_none() && is_late {
            if let Some(job) = job {
                let target = target.traced_by(job);
                if is_representative(job.reused_share()) {
                    timings.note(Effort::Full, Times::milliseconds(*traced), target.rays_so_far(job));
                }
            }
            outcome = JobOutcome::Needs(timings.first(state.film, FIRST_MS, FIRST_DIVISOR), LevelRole::First);
        }
        Ok((film, outcome))
    }

    /// Returns the time after which a coarse picture should precede a picture.
    fn preview_delay(&self, target: RequestedPicture) -> Duration {
        let expected = Duration::try_from_secs_f64(2e-3 * self.timings.expected(target).unwrap_or(0.0));
        expected.unwrap_or(Duration::MAX).max(PREVIEW_DELAY)
    }

    /// Continues the full picture due after the last edit until it is finished, another picture is requested, or `until`. Its frame is the
    /// one displayed at its start. Returns whether it is finished or has failed.
    pub(super) fn render_in_background(&mut self, until: Instant) -> bool {
        let state = self.publisher.published().state();
        let background = self.background.take();
        let mut background = background.unwrap_or_else(|| RenderInProgress::new(state.frame, Detail::Full));
        match self.continue_in_background(&mut background, MIN_SLICE, Some(until)) {
            Ok(None) => {
                self.background = Some(background);
                return false;
            }
            Ok(Some(film)) => {
                let state = State { frame: background.frame, ..state };
                let picture = self.rendered(&state, PictureKind::Full, film, background.traced);
                self.publisher.report(&state, picture);
            }
            // This frame cannot be rendered.
            Err(error) => self.publisher.emit(Event::Failed(error)),
        }
        true
    }

    /// Continues a picture until it is finished, another picture is requested after at least `slice`, or `until`.
    fn continue_in_background(
        &mut self,
        picture: &mut RenderInProgress,
        slice: Duration,
        until: Option<Instant>,
    ) -> Result<Option<Film>, EngineError> {
        let start = Instant::now();
        let pause = || {
            let is_interrupted = self.commands.interrupt().load(Ordering::Relaxed);
            is_interrupted && start.elapsed() >= slice || until.is_some_and(|until| Instant::now() >= until)
        };
        let signals = Signals { cancelled: self.commands.urgent(), pause: &pause };
        let RenderInProgress { frame, detail, job, .. } = picture;
        let reuse = self.reuses(*detail).then_some(&mut self.displayed);
        let film = render(&mut self.engine, (*frame, *detail), job, reuse, signals, &mut |_| Break(()));
        picture.traced += self.engine.report().trace;
        film
    }

    /// Measures the cost of an effect or a point of the error curve.
    fn measure(&mut self, index: usize) -> Result<JobOutcome, EngineError> {
        let state = self.publisher.published().state();
        let Some(effect) = Effect::ALL.get(index) else {
            return self.measure_curve(state.frame, index - Effect::ALL.len());
        };
        let plan = if index == 0 { self.planned(state.frame, false)? } else { state.plan };
        if index == 0 {
            self.publisher.published().update(|state| state.curve.clear());
        }
        let time = self.engine.timeline.time_of(state.frame);
        let cost = measure::cost(&mut self.engine, time, *effect, self.commands.interrupt())?;
        let Some(cost) = cost else { return Ok(JobOutcome::Interrupted) };
        self.publisher.published().update(|state| {
            (state.rendering, state.progress) = (true, measure::share(index + 1));
            state.plan = plan;
            if let Some(planned) = state.plan.get_mut(index) {
                planned.cost = cost;
            }
        });
        Ok(JobOutcome::Done)
    }

    /// Measures the error of the frame with the scene's own samples, and then with increasing numbers of samples.
    fn measure_curve(&mut self, frame: u32, index: usize) -> Result<JobOutcome, EngineError> {
        let time = self.engine.timeline.time_of(frame);
        let measured = measure::curve_point(&mut self.engine, time, index, self.commands.interrupt())?;
        if measured.is_none() && self.commands.interrupt().load(Ordering::Relaxed) {
            return Ok(JobOutcome::Interrupted);
        }
        let (point, tile_errors) = measured.map(|measured| (measured.point, measured.tile_errors)).unzip();
        // The next point renders two pictures with twice as many samples.
        let is_last = point.is_none_or(|point| index > 0 && 4.0 * point.milliseconds > LONGEST_POINT);
        let published = self.publisher.published();
        // The first point has the scene's own samples.
        if let Some(errors) = tile_errors.filter(|_| index == 0) {
            published.add_measured_errors(frame, errors);
        }
        published.update(|state| {
            state.curve.extend(point);
            (state.rendering, state.progress) = (!is_last, measure::share(Effect::ALL.len() + index + 1));
        });
        Ok(if is_last { JobOutcome::Ended } else { JobOutcome::Done })
    }

    /// Returns whether tiles of pictures of a quality are reused.
    fn reuses(&self, detail: Detail) -> bool {
        detail == Detail::Full && !self.is_expected_within(REUSE_ABOVE_MS, detail)
    }

    /// Returns the share of the requested picture of the current frame that can be reused.
    fn reusable_share(&mut self, detail: Detail) -> f64 {
        if !self.reuses(detail) || self.displayed.is_none() {
            return 0.0;
        }
        let time = self.engine.timeline.time_of(self.publisher.published().state().frame);
        let commands = Arc::clone(&self.commands);
        let signals = Signals { cancelled: commands.interrupt(), ..Signals::none() };
        let reuse = Some(&mut self.displayed);
        let request = RenderRequest { fingerprint: false, signals, reuse, ..RenderRequest::at(time) };
        self.engine.plan(request).map_or(0.0, |report| report.reused)
    }

    /// Returns the size and sample count of a picture of this quality.
    fn target(&self, detail: Detail) -> RequestedPicture {
        let EffectiveSettings { film, sampling, .. } = self.engine.effective_settings();
        let (divisor, samples) = match detail {
            // Adaptive sampling takes one sample at least.
            Detail::Full if sampling.is_adaptive() => (1, 1),
            Detail::Full => (1, sampling.samples),
            Detail::Draft => (1, 1),
            Detail::Half => (2, 1),
        };
        RequestedPicture { film: (film.width, film.height), divisor, samples, share: 1.0 }
    }

    /// Records the speed of the last picture.
    fn note(&mut self, effort: Effort, traced: Duration) {
        let report = self.engine.report();
        self.timings.note_moment(Times::milliseconds(report.animate + report.prepare));
        if is_representative(report.reused) {
            let whole = Times::milliseconds(traced) / (1.0 - report.reused);
            self.timings.note(effort, whole, report.rays.camera);
        }
    }

    fn publish(&mut self, state: &State, kind: PictureKind, film: Film, traced: Duration) -> JobOutcome {
        let picture = self.rendered(state, kind, film, traced);
        if !self.publisher.publish(state, picture) {
            return JobOutcome::Ended;
        }
        if !matches!(kind, PictureKind::Coarse(_)) {
            let commands = Arc::clone(&self.commands);
            self.find_key(state.frame, Signals { cancelled: commands.interrupt(), ..Signals::none() });
            self.publisher.keep_latest();
            self.store(state.frame);
        }
        JobOutcome::Done
    }

    /// Returns the last picture with its description.
    fn rendered(
        &mut self,
        state: &State,
        kind: PictureKind,
        film: Film,
        traced: Duration,
    ) -> RenderedPicture {
        let (report, transfer) = (self.engine.report(), self.engine.effective_settings().film.transfer);
        let (mut times, rays) = (state.times, report.rays.total());
        let tile_stats = Arc::clone(&report.tile_stats);
        times.set_frame(report, traced);
        let is_full = kind == PictureKind::Full;
        let plan = match kind {
            PictureKind::Coarse(_) => None,
            PictureKind::Draft { .. } | PictureKind::Full => self.planned(state.frame, is_full).ok(),
        };
        let warnings = match is_full {
            true => PictureWarnings::of(&self.engine, &self.sources, &self.allowed),
            false => PictureWarnings::default(),
        };
        RenderedPicture { film, transfer, kind, times, rays, tile_stats, plan, warnings }
    }

    /// Returns the effects of a frame. `is_last` is true if the frame is the last full picture.
    fn planned(&mut self, frame: u32, is_last: bool) -> Result<Vec<Planned>, EngineError> {
        let time = self.engine.timeline.time_of(frame);
        let request = RenderRequest { fingerprint: false, ..RenderRequest::at(time) };
        let report = if is_last { self.engine.report() } else { self.engine.plan(request)? };
        Ok(report.plan.as_ref().map(Planned::all).unwrap_or_default())
    }
}
