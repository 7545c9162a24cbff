//! Rendering of a session's pictures: coarse ones, the requested one, and the full one due after an edit.

use std::ops::ControlFlow::Break;
use std::sync::atomic::Ordering;
use std::time::{Duration, Instant};

use super::commands::Detail;
use super::event::Event;
use super::in_progress::{BackgroundRender, RenderInProgress};
use super::presenter::{FinishedRender, PictureKind};
use super::preview_level::{self, Effort, PreviewLevel, RequestedPicture};
use super::progress_observer::{ProgressObserver, rays, share_of_unfinished};
use super::state::{State, Times};
use super::worker::{LevelRole, NextTask, Worker};
use crate::engine::{EngineError, FrameReport};
use crate::systems::Effect;
use crate::trace::{Film, RenderJob, Signals};

/// Minimum time for a picture before a coarse one replaces it while nothing of its frame is shown. Twice its expected time applies if
/// that is longer.
const SOON: Duration = Duration::from_millis(50);
/// Minimum time slice of the full picture due after an edit, even when another picture is requested.
const SLICE: Duration = Duration::from_millis(20);

/// The requested picture after some tracing.
struct Traced {
    /// The film, or `None` if it is unfinished.
    film: Result<Option<Film>, EngineError>,
    /// True if tracing takes longer than a first picture should.
    is_late: bool,
    target: RequestedPicture,
}

impl Worker {
    pub(super) fn make_next(&mut self) {
        match self.next {
            NextTask::Nothing => {}
            NextTask::Step(step, role) => self.render_preview(step, role),
            NextTask::Picture(detail) => self.render_requested(detail),
            NextTask::Rest(until) => self.wait_idle(until),
            NextTask::Cost(index) => self.measure(index),
            NextTask::Curve(index) => self.measure_samples(index),
        }
    }

    /// Renders and publishes a coarse picture. A first picture that takes too long is replaced by a cheaper one. A picture between the
    /// first and the requested one is skipped permanently if a command interrupts it: no part of it can be kept, so frequent commands
    /// would otherwise delay the requested picture forever.
    fn render_preview(&mut self, step: PreviewLevel, role: LevelRole) {
        let state = self.handle.published.state();
        let Some(scene) = &mut self.scene else {
            self.next = NextTask::Nothing;
            return;
        };
        let commands = &self.handle.commands;
        let deadline = if role == LevelRole::Between { None } else { step.deadline() };
        let (film, is_late) = commands
            .with_deadline(deadline, |begin| scene.draft(state.frame, step, commands.interrupt(), begin));
        let report = scene.report().clone();
        let took = Times::milliseconds(report.trace);
        let film = match film {
            Ok(Some(film)) => film,
            Ok(None) => {
                if is_late {
                    self.timings.note_failure(step, took, state.film);
                    self.next = NextTask::Step(step.lesser(state.film), role);
                } else if role == LevelRole::Between {
                    self.last_step = None;
                    self.next = NextTask::Picture(self.detail);
                }
                return;
            }
            Err(error) => return self.fail(error),
        };
        let is_pilot = self.timings.is_unknown();
        self.timings.moment = Times::milliseconds(report.animate + report.prepare);
        self.timings.note(step.effort(), took, report.rays.camera);
        if role == LevelRole::First && is_pilot {
            let better = self.timings.first(state.film, preview_level::FIRST, 2);
            if step.is_surpassed_by(better, took) {
                self.next = NextTask::Step(better, role);
                return;
            }
        }
        self.last_step = Some((step, took));
        self.next = match role {
            LevelRole::InARow => NextTask::Rest(self.end_of_row()),
            LevelRole::First | LevelRole::Between => self.after_step(),
        };
        self.present(&state, PictureKind::Coarse(self.progress()), film, report.trace);
    }

    /// Returns a finer step, or the requested picture if there is none.
    fn after_step(&self) -> NextTask {
        let finer = self
            .scene
            .as_ref()
            .zip(self.last_step)
            .and_then(|(scene, (step, took))| self.timings.finer(step, took, scene.target(self.detail)));
        finer.map_or(NextTask::Picture(self.detail), |step| NextTask::Step(step, LevelRole::Between))
    }

    /// Returns the finished fraction of the requested picture, 0 to 1.
    fn progress(&self) -> f64 {
        let job = self.in_progress.as_ref().and_then(|in_progress| in_progress.job.as_ref());
        job.map_or(0.0, share_of_unfinished)
    }

    /// Renders the requested picture and shows it while unfinished. An interrupting command discards nothing of it unless it requests
    /// another picture. If nothing of the frame is shown yet and rendering takes too long, a coarse picture comes first.
    fn render_requested(&mut self, detail: Detail) {
        let state = self.handle.published.state();
        let kept = self
            .in_progress
            .take()
            .filter(|in_progress| (in_progress.frame, in_progress.detail) == (state.frame, detail));
        let mut in_progress = kept.unwrap_or_else(|| RenderInProgress::new(state.frame, detail));
        let is_first = self.presenter.latest().is_none();
        let Some(Traced { film, is_late, target }) = self.trace(&state, &mut in_progress, is_first) else {
            self.next = NextTask::Nothing;
            return;
        };
        match film {
            Ok(Some(film)) => self.finished(&state, &in_progress, film),
            Ok(None) => self.unfinished(in_progress, (is_late && is_first).then_some(target)),
            Err(error) => self.fail(error),
        }
    }

    /// Traces the requested picture until it is finished or interrupted. Returns `None` if there is no scene.
    fn trace(&mut self, state: &State, in_progress: &mut RenderInProgress, is_first: bool) -> Option<Traced> {
        let Self { scene: Some(scene), timings, presenter, handle, last_step, next, .. } = self else {
            return None;
        };
        let (target, commands) = (scene.target(in_progress.detail), &handle.commands);
        let expected = Duration::try_from_secs_f64(2e-3 * timings.expected(target).unwrap_or(0.0));
        let deadline = expected.unwrap_or(Duration::MAX).max(SOON);
        let visits = &in_progress.visits;
        let mut observer = ProgressObserver {
            state,
            target,
            transfer: scene.film_settings().transfer,
            traced_before: Times::milliseconds(in_progress.traced) - visits.traced(),
            visits,
            is_shown: &mut in_progress.is_shown,
            timings,
            presenter,
            published: &handle.published,
            last_step: *last_step,
            next,
        };
        let (frame, job) = ((in_progress.frame, in_progress.detail), &mut in_progress.job);
        let (film, is_late) = commands.with_deadline(is_first.then_some(deadline), |begin| {
            let pause = || {
                begin();
                visits.are_due()
            };
            let signals = Signals { cancelled: commands.interrupt(), pause: &pause };
            scene.render_on(frame, job, signals, &mut |job| observer.on_progress(job))
        });
        in_progress.traced += scene.report().trace;
        Some(Traced { film, is_late, target })
    }

    /// Publishes the requested picture.
    fn finished(&mut self, state: &State, in_progress: &RenderInProgress, film: Film) {
        let is_full = in_progress.detail == Detail::Full;
        if let Some(scene) = &self.scene {
            let report = scene.report();
            self.timings.moment = Times::milliseconds(report.animate + report.prepare);
            self.timings.note(Effort::Whole, Times::milliseconds(in_progress.traced), report.rays.camera);
        }
        if is_full {
            self.full_of = state.reloads;
        }
        self.next = self.after_picture();
        let kind = if is_full { PictureKind::Full } else { PictureKind::Draft };
        self.present(state, kind, film, in_progress.traced);
    }

    /// Keeps the unfinished requested picture. If it is a late first picture, a coarse one comes first.
    fn unfinished(&mut self, in_progress: RenderInProgress, late: Option<RequestedPicture>) {
        if let Some(target) = late {
            let share = in_progress.job.as_ref().map_or(0.0, RenderJob::share);
            self.timings.note(Effort::Whole, Times::milliseconds(in_progress.traced), rays(share, target));
            self.next = self.first_step();
        }
        self.in_progress = Some(in_progress);
        let progress = self.progress();
        self.handle.published.update(|state| state.progress = progress);
    }

    /// Returns the task after the requested picture: the full picture if it is due.
    fn after_picture(&self) -> NextTask {
        match (self.full_render_pending(), self.is_playing) {
            (false, _) => NextTask::Nothing,
            (true, false) => NextTask::Picture(Detail::Full),
            (true, true) => NextTask::Rest(self.end_of_row()),
        }
    }

    /// Returns whether the full picture due after the last edit is still missing.
    pub(super) fn full_render_pending(&self) -> bool {
        let is_wanted = self.settings.finish || self.detail == Detail::Full;
        is_wanted && self.full_of < self.handle.published.state().reloads
    }

    /// Waits for the next frame of playback, and renders the full picture that is due in the meantime. If no further frame is requested,
    /// the last picture is improved.
    fn wait_idle(&mut self, until: Instant) {
        if Instant::now() < until {
            if self.full_render_pending() {
                self.render_in_background(until);
            }
            return;
        }
        self.is_playing = false;
        let is_coarse = self.presenter.latest().is_none_or(|(info, _)| info.coarse);
        self.next = if is_coarse { self.after_step() } else { self.after_picture() };
        let is_over = self.next == NextTask::Nothing;
        self.handle.published.update(|state| state.rendering = !is_over);
    }

    /// Continues the full picture due after the last edit. Its frame is the one displayed when there was first time for it.
    fn render_in_background(&mut self, until: Instant) {
        let state = self.handle.published.state();
        let Some(scene) = &mut self.scene else { return };
        let mut background = self.background.take().unwrap_or(BackgroundRender {
            frame: state.frame,
            job: None,
            traced: Duration::ZERO,
        });
        let (commands, start) = (&self.handle.commands, Instant::now());
        let pause = || {
            let is_asked = commands.interrupt().load(Ordering::Relaxed) && start.elapsed() >= SLICE;
            is_asked || Instant::now() >= until
        };
        let signals = Signals { cancelled: commands.urgent(), pause: &pause };
        let frame = (background.frame, Detail::Full);
        let film = scene.render_on(frame, &mut background.job, signals, &mut |_| Break(()));
        background.traced += scene.report().trace;
        match film {
            Ok(None) => self.background = Some(background),
            Ok(Some(film)) => {
                self.full_of = state.reloads;
                let state = State { frame: background.frame, ..state };
                if let Some(made) = self.made(&state, PictureKind::Full, film, background.traced) {
                    self.presenter.report_only(&state, made);
                }
            }
            Err(error) => {
                // This frame cannot be rendered.
                self.full_of = state.reloads;
                self.presenter.emit(Event::Failed(error));
            }
        }
    }

    fn present(&mut self, state: &State, kind: PictureKind, film: Film, traced: Duration) {
        if let Some(made) = self.made(state, kind, film, traced)
            && !self.presenter.present(state, made)
        {
            self.next = NextTask::Nothing;
        }
    }

    fn made(
        &mut self,
        state: &State,
        kind: PictureKind,
        film: Film,
        traced: Duration,
    ) -> Option<FinishedRender> {
        let rendering = self.next != NextTask::Nothing;
        let scene = self.scene.as_mut()?;
        let (report, transfer) = (scene.report().clone(), scene.film_settings().transfer);
        let mut times = state.times;
        let rays = report.rays.total();
        times.set_frame(&FrameReport { trace: traced, ..report });
        let plan = match kind {
            PictureKind::Coarse(_) => None,
            PictureKind::Draft | PictureKind::Full => {
                scene.planned(state.frame, kind == PictureKind::Full).ok()
            }
        };
        let warnings = if kind == PictureKind::Full { scene.warnings() } else { Vec::new() };
        Some(FinishedRender { film, transfer, kind, times, rays, plan, warnings, rendering })
    }

    /// Measures the cost of an effect, and schedules the next effect. Any command stops the measurement.
    fn measure(&mut self, index: usize) {
        let state = self.handle.published.state();
        let Some(scene) = &mut self.scene else { return };
        self.next = NextTask::Nothing;
        let plan = if index == 0 { scene.planned(state.frame, false) } else { Ok(state.plan) };
        if index == 0 {
            self.handle.published.update(|state| state.curve.clear());
        }
        let cost = scene.cost(state.frame, index, self.handle.commands.interrupt());
        match plan.and_then(|plan| Ok((plan, cost?))) {
            Ok((mut plan, Some(cost))) => {
                self.next = NextTask::Cost(index + 1);
                if let Some(planned) = plan.get_mut(index) {
                    planned.cost = cost;
                }
                self.handle.published.update(|state| state.plan = plan);
            }
            Ok((_, None)) if index >= Effect::ALL.len() => self.next = NextTask::Curve(0),
            Ok((_, None)) => self.handle.published.update(|state| state.rendering = false),
            Err(error) => self.fail(error),
        }
    }

    /// Measures the error of the frame with the scene's own samples, and then with increasing numbers of samples. Any command stops the
    /// measurement.
    fn measure_samples(&mut self, index: usize) {
        /// Maximum time of a curve point other than the scene's own, in milliseconds.
        const LONGEST: f64 = 2000.0;
        let state = self.handle.published.state();
        let Some(scene) = &mut self.scene else { return };
        self.next = NextTask::Nothing;
        let place = scene.curve_point(state.frame, index, self.handle.commands.interrupt());
        let is_last = match &place {
            // The next point renders two pictures with twice as many samples.
            Ok(Some(place)) => index > 0 && 4.0 * place.milliseconds > LONGEST,
            Ok(None) | Err(_) => true,
        };
        match place {
            Ok(place) => {
                if !is_last {
                    self.next = NextTask::Curve(index + 1);
                }
                self.handle.published.update(|state| {
                    state.curve.extend(place);
                    state.rendering = !is_last;
                });
            }
            Err(error) => self.fail(error),
        }
    }
}
