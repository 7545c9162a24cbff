//! Rendering of a session's pictures: coarse ones, the requested one, and the full one due after an edit.

use std::ops::ControlFlow::Break;
use std::sync::atomic::Ordering;
use std::time::{Duration, Instant};

use super::begun::{Aside, Begun};
use super::director::{Director, Next, StepRole};
use super::easel::{Made, PictureKind};
use super::event::Event;
use super::ladder::{self, Care, LadderStep, Target};
use super::mailbox::Detail;
use super::onlooker::{Onlooker, rays, share_of_unfinished};
use super::state::{State, Times};
use crate::engine::{EngineError, FrameReport};
use crate::systems::Effect;
use crate::trace::{Exposure, Film, Signals};

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
    target: Target,
}

impl Director {
    pub(super) fn make_next(&mut self) {
        match self.next {
            Next::Nothing => {}
            Next::Step(step, role) => self.climb(step, role),
            Next::Picture(detail) => self.finish(detail),
            Next::Rest(until) => self.rest(until),
            Next::Cost(index) => self.measure(index),
            Next::Curve(index) => self.measure_samples(index),
        }
    }

    /// Renders and publishes a coarse picture. A first picture that takes too long is replaced by a cheaper one. A picture between the
    /// first and the requested one is skipped permanently if a command interrupts it: no part of it can be kept, so frequent commands
    /// would otherwise delay the requested picture forever.
    fn climb(&mut self, step: LadderStep, role: StepRole) {
        let state = self.handle.board.state();
        let Some(stage) = &mut self.stage else {
            self.next = Next::Nothing;
            return;
        };
        let mailbox = &self.handle.mailbox;
        let deadline = if role == StepRole::Between { None } else { step.deadline() };
        let (film, is_late) = mailbox
            .within(deadline, |begin| stage.draft(state.frame, step.draft(), mailbox.waiting(), begin));
        let report = *stage.report();
        let took = Times::milliseconds(report.trace);
        let film = match film {
            Ok(Some(film)) => film,
            Ok(None) => {
                if is_late {
                    self.timings.note_failure(step, took, state.film);
                    self.next = Next::Step(step.lesser(state.film), role);
                } else if role == StepRole::Between {
                    self.last_step = None;
                    self.next = Next::Picture(self.detail);
                }
                return;
            }
            Err(error) => return self.fail(error),
        };
        let is_pilot = self.timings.is_unknown();
        self.timings.moment = Times::milliseconds(report.animate + report.prepare);
        self.timings.note(step.care(), took, report.rays.camera);
        if role == StepRole::First && is_pilot {
            let better = self.timings.first(state.film, ladder::FIRST, 2);
            if step.is_surpassed_by(better, took) {
                self.next = Next::Step(better, role);
                return;
            }
        }
        self.last_step = Some((step, took));
        self.next = match role {
            StepRole::InARow => Next::Rest(self.end_of_row()),
            StepRole::First | StepRole::Between => self.after_step(),
        };
        self.put_up(&state, PictureKind::Coarse(self.progress()), film, report.trace);
    }

    /// Returns a finer step, or the requested picture if there is none.
    fn after_step(&self) -> Next {
        let finer = self
            .stage
            .as_ref()
            .zip(self.last_step)
            .and_then(|(stage, (step, took))| self.timings.finer(step, took, stage.target(self.detail)));
        finer.map_or(Next::Picture(self.detail), |step| Next::Step(step, StepRole::Between))
    }

    /// Returns the finished fraction of the requested picture, 0 to 1.
    fn progress(&self) -> f64 {
        let exposure = self.begun.as_ref().and_then(|begun| begun.exposure.as_ref());
        exposure.map_or(0.0, share_of_unfinished)
    }

    /// Renders the requested picture and shows it while unfinished. An interrupting command discards nothing of it unless it requests
    /// another picture. If nothing of the frame is shown yet and rendering takes too long, a coarse picture comes first.
    fn finish(&mut self, detail: Detail) {
        let state = self.handle.board.state();
        let kept = self.begun.take().filter(|begun| (begun.frame, begun.detail) == (state.frame, detail));
        let mut begun = kept.unwrap_or_else(|| Begun::new(state.frame, detail));
        let is_first = self.easel.latest().is_none();
        let Some(Traced { film, is_late, target }) = self.trace(&state, &mut begun, is_first) else {
            self.next = Next::Nothing;
            return;
        };
        match film {
            Ok(Some(film)) => self.finished(&state, &begun, film),
            Ok(None) => self.unfinished(begun, (is_late && is_first).then_some(target)),
            Err(error) => self.fail(error),
        }
    }

    /// Traces the requested picture until it is finished or interrupted. Returns `None` if there is no scene.
    fn trace(&mut self, state: &State, begun: &mut Begun, is_first: bool) -> Option<Traced> {
        let Self { stage: Some(stage), timings, easel, handle, last_step, next, .. } = self else {
            return None;
        };
        let (target, mailbox) = (stage.target(begun.detail), &handle.mailbox);
        let expected = Duration::try_from_secs_f64(2e-3 * timings.expected(target).unwrap_or(0.0));
        let deadline = expected.unwrap_or(Duration::MAX).max(SOON);
        let visits = &begun.visits;
        let mut onlooker = Onlooker {
            state,
            target,
            transfer: stage.film_settings().transfer,
            traced_before: Times::milliseconds(begun.traced) - visits.traced(),
            visits,
            is_shown: &mut begun.is_shown,
            timings,
            easel,
            board: &handle.board,
            last_step: *last_step,
            next,
        };
        let (frame, exposure) = ((begun.frame, begun.detail), &mut begun.exposure);
        let (film, is_late) = mailbox.within(is_first.then_some(deadline), |begin| {
            let pause = || {
                begin();
                visits.are_due()
            };
            let signals = Signals { cancelled: mailbox.waiting(), pause: &pause };
            stage.render_on(frame, exposure, signals, &mut |exposure| onlooker.visit(exposure))
        });
        begun.traced += stage.report().trace;
        Some(Traced { film, is_late, target })
    }

    /// Publishes the requested picture.
    fn finished(&mut self, state: &State, begun: &Begun, film: Film) {
        let is_full = begun.detail == Detail::Full;
        if let Some(stage) = &self.stage {
            let report = stage.report();
            self.timings.moment = Times::milliseconds(report.animate + report.prepare);
            self.timings.note(Care::Whole, Times::milliseconds(begun.traced), report.rays.camera);
        }
        if is_full {
            self.full_of = state.reloads;
        }
        self.next = self.after_picture();
        let kind = if is_full { PictureKind::Full } else { PictureKind::Draft };
        self.put_up(state, kind, film, begun.traced);
    }

    /// Keeps the unfinished requested picture. If it is a late first picture, a coarse one comes first.
    fn unfinished(&mut self, begun: Begun, late: Option<Target>) {
        if let Some(target) = late {
            let share = begun.exposure.as_ref().map_or(0.0, Exposure::share);
            self.timings.note(Care::Whole, Times::milliseconds(begun.traced), rays(share, target));
            self.next = self.first_step();
        }
        self.begun = Some(begun);
        let progress = self.progress();
        self.handle.board.change(|state| state.progress = progress);
    }

    /// Returns the task after the requested picture: the full picture if it is due.
    fn after_picture(&self) -> Next {
        match (self.owes(), self.is_playing) {
            (false, _) => Next::Nothing,
            (true, false) => Next::Picture(Detail::Full),
            (true, true) => Next::Rest(self.end_of_row()),
        }
    }

    /// Returns whether the full picture due after the last edit is still missing.
    pub(super) fn owes(&self) -> bool {
        let is_wanted = self.settings.finish || self.detail == Detail::Full;
        is_wanted && self.full_of < self.handle.board.state().reloads
    }

    /// Waits for the next frame of playback, and renders the full picture that is due in the meantime. If no further frame is requested,
    /// the last picture is improved.
    fn rest(&mut self, until: Instant) {
        if Instant::now() < until {
            if self.owes() {
                self.work_aside(until);
            }
            return;
        }
        self.is_playing = false;
        let is_coarse = self.easel.latest().is_none_or(|(info, _)| info.coarse);
        self.next = if is_coarse { self.after_step() } else { self.after_picture() };
        let is_over = self.next == Next::Nothing;
        self.handle.board.change(|state| state.rendering = !is_over);
    }

    /// Continues the full picture due after the last edit. Its frame is the one displayed when there was first time for it.
    fn work_aside(&mut self, until: Instant) {
        let state = self.handle.board.state();
        let Some(stage) = &mut self.stage else { return };
        let mut aside =
            self.aside.take().unwrap_or(Aside { frame: state.frame, exposure: None, traced: Duration::ZERO });
        let (mailbox, start) = (&self.handle.mailbox, Instant::now());
        let pause = || {
            let is_asked = mailbox.waiting().load(Ordering::Relaxed) && start.elapsed() >= SLICE;
            is_asked || Instant::now() >= until
        };
        let signals = Signals { cancelled: mailbox.pressing(), pause: &pause };
        let frame = (aside.frame, Detail::Full);
        let film = stage.render_on(frame, &mut aside.exposure, signals, &mut |_| Break(()));
        aside.traced += stage.report().trace;
        match film {
            Ok(None) => self.aside = Some(aside),
            Ok(Some(film)) => {
                self.full_of = state.reloads;
                let state = State { frame: aside.frame, ..state };
                if let Some(made) = self.made(&state, PictureKind::Full, film, aside.traced) {
                    self.easel.hand_over(&state, made);
                }
            }
            Err(error) => {
                // This frame cannot be rendered.
                self.full_of = state.reloads;
                self.easel.tell(Event::Failed(error));
            }
        }
    }

    fn put_up(&mut self, state: &State, kind: PictureKind, film: Film, traced: Duration) {
        if let Some(made) = self.made(state, kind, film, traced)
            && !self.easel.put_up(state, made)
        {
            self.next = Next::Nothing;
        }
    }

    fn made(&mut self, state: &State, kind: PictureKind, film: Film, traced: Duration) -> Option<Made> {
        let rendering = self.next != Next::Nothing;
        let stage = self.stage.as_mut()?;
        let (report, transfer) = (*stage.report(), stage.film_settings().transfer);
        let mut times = state.times;
        times.set_frame(&FrameReport { trace: traced, ..report });
        let plan = match kind {
            PictureKind::Coarse(_) => None,
            PictureKind::Draft | PictureKind::Full => {
                stage.planned(state.frame, kind == PictureKind::Full).ok()
            }
        };
        let warnings = if kind == PictureKind::Full { stage.warnings() } else { Vec::new() };
        let rays = report.rays.total();
        Some(Made { film, transfer, kind, times, rays, plan, warnings, rendering })
    }

    /// Measures the cost of an effect, and schedules the next effect. Any command stops the measurement.
    fn measure(&mut self, index: usize) {
        let state = self.handle.board.state();
        let Some(stage) = &mut self.stage else { return };
        self.next = Next::Nothing;
        let plan = if index == 0 { stage.planned(state.frame, false) } else { Ok(state.plan) };
        if index == 0 {
            self.handle.board.change(|state| state.curve.clear());
        }
        let cost = stage.cost(state.frame, index, self.handle.mailbox.waiting());
        match plan.and_then(|plan| Ok((plan, cost?))) {
            Ok((mut plan, Some(cost))) => {
                self.next = Next::Cost(index + 1);
                if let Some(planned) = plan.get_mut(index) {
                    planned.cost = cost;
                }
                self.handle.board.change(|state| state.plan = plan);
            }
            Ok((_, None)) if index >= Effect::ALL.len() => self.next = Next::Curve(0),
            Ok((_, None)) => self.handle.board.change(|state| state.rendering = false),
            Err(error) => self.fail(error),
        }
    }

    /// Measures the error of the frame with the scene's own samples, and then with increasing numbers of samples. Any command stops the
    /// measurement.
    fn measure_samples(&mut self, index: usize) {
        /// Maximum time of a curve point other than the scene's own, in milliseconds.
        const LONGEST: f64 = 2000.0;
        let state = self.handle.board.state();
        let Some(stage) = &mut self.stage else { return };
        self.next = Next::Nothing;
        let place = stage.place_of_curve(state.frame, index, self.handle.mailbox.waiting());
        let is_last = match &place {
            // The next point renders two pictures with twice as many samples.
            Ok(Some(place)) => index > 0 && 4.0 * place.milliseconds > LONGEST,
            Ok(None) | Err(_) => true,
        };
        match place {
            Ok(place) => {
                if !is_last {
                    self.next = Next::Curve(index + 1);
                }
                self.handle.board.change(|state| {
                    state.curve.extend(place);
                    state.rendering = !is_last;
                });
            }
            Err(error) => self.fail(error),
        }
    }
}
