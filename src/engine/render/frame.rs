//! Renders frames, instant by instant while the shutter is open.

use std::collections::VecDeque;
use std::ops::ControlFlow::{self, Continue};
use std::sync::atomic::AtomicBool;
use std::time::{Duration, Instant};

use super::draft::add_all;
use super::fingerprint::HashedInstants;
use crate::color::{Encoding, Linear, Transfer};
use crate::components::{Animated, FilmSettings, Sampling};
use crate::engine::engine::{Engine, EngineError};
use crate::engine::report::FrameReport;
use crate::systems::{
    Effect, FrameSettings, Need, Plan, Preparation, Shutter, Shutters, order_newcomers, propagate,
    sampling_settings,
};
use crate::time::Time;
use crate::trace::reference::{Reference, ReferenceSums};
use crate::trace::{
    AlphaFilm, BvhUpdate, Developed, Effects, EncodedFilm, Film, FrameFingerprint, InstantOrder, RenderJob,
    SampleMemory, SamplePlan, SceneChanges, Signals, block, round_policy,
};

/// A signal that is never set.
static NEVER: AtomicBool = AtomicBool::new(false);

impl Engine {
    /// Renders frame `index` of the timeline, which may be beyond its end. The result does not depend on previously rendered frames.
    ///
    /// # Errors
    ///
    /// If custom systems need the world copied and it holds components that were not registered, or if a script gives no value.
    pub fn render_frame(&mut self, index: u32) -> Result<Film, EngineError> {
        self.render_at(self.timeline.time_of(index))
    }

    /// Renders a moment.
    ///
    /// # Errors
    ///
    /// As [`Engine::render_frame`].
    pub fn render_at(&mut self, time: Time) -> Result<Film, EngineError> {
        let film = self.render_unless(time, &NEVER)?;
        Ok(film.unwrap_or_else(|| Film::new(0, 0)))
    }

    /// Renders a moment. Returns `None` if `cancelled` becomes true during rendering.
    ///
    /// # Errors
    ///
    /// As [`Engine::render_frame`].
    pub fn render_unless(&mut self, time: Time, cancelled: &AtomicBool) -> Result<Option<Film>, EngineError> {
        self.render_on(time, &mut None, Signals::unless(cancelled), &mut |_| Continue(()))
    }

    /// Renders a moment incrementally. At every pause that `signals` requests, `visit` is called and decides whether to continue. If it
    /// stops, `begun` keeps the samples traced so far. A later call with `begun` continues and gives the same bits, provided that neither
    /// the moment nor the world has changed.
    ///
    /// ```
    /// use std::ops::ControlFlow;
    /// use std::sync::atomic::AtomicBool;
    /// use rayreel::trace::Signals;
    /// use rayreel::{Engine, Time, World};
    ///
    /// let mut engine = Engine::new(World::new());
    /// let (mut begun, never) = (None, AtomicBool::new(false));
    /// let at_once = Signals { cancelled: &never, pause: &|| true };
    /// assert!(engine.render_on(Time::ZERO, &mut begun, at_once, &mut |_| ControlFlow::Break(()))?.is_none());
    ///
    /// let film = engine.render_on(Time::ZERO, &mut begun, Signals::unless(&never), &mut |_| ControlFlow::Continue(()))?;
    /// assert_eq!(film, Some(engine.render_at(Time::ZERO)?));
    /// # Ok::<(), rayreel::EngineError>(())
    /// ```
    ///
    /// # Errors
    ///
    /// As [`Engine::render_frame`].
    pub fn render_on(
        &mut self,
        time: Time,
        begun: &mut Option<RenderJob>,
        signals: Signals<'_>,
        visit: &mut dyn FnMut(&RenderJob) -> ControlFlow<()>,
    ) -> Result<Option<Film>, EngineError> {
        let exposed = self.expose((Linear, false), time, begun, signals, visit)?;
        Ok(exposed.map(|exposed| exposed.film))
    }

    /// Renders a moment to output bytes with the transfer function of the film settings, incrementally like
    /// [`render_on`](Engine::render_on). The bytes are the same as from the [encoded](Film::encoded) film, and take less time and memory.
    ///
    /// # Errors
    ///
    /// As [`Engine::render_frame`].
    pub fn render_encoded_on(
        &mut self,
        time: Time,
        signals: Signals<'_>,
        visit: &mut dyn FnMut(&RenderJob<Transfer>) -> ControlFlow<()>,
    ) -> Result<Option<EncodedFilm>, EngineError> {
        let transfer = self.film_settings().transfer;
        let exposed = self.expose((transfer, false), time, &mut None, signals, visit)?;
        Ok(exposed.map(|exposed| exposed.film))
    }

    /// Renders a moment with an alpha channel and without its background, incrementally like [`render_on`](Engine::render_on). With an
    /// error target, the error of alpha counts like the error of light.
    ///
    /// ```
    /// use std::ops::ControlFlow::Continue;
    /// use std::sync::atomic::AtomicBool;
    /// use rayreel::trace::Signals;
    /// use rayreel::{Engine, Time, World};
    ///
    /// let never = AtomicBool::new(false);
    /// let mut engine = Engine::new(World::new());
    /// let picture = engine.render_alpha_on(Time::ZERO, Signals::unless(&never), &mut |_| Continue(()))?.unwrap();
    /// assert!(picture.alpha.pixels().iter().all(|alpha| *alpha == 0.0));
    /// # Ok::<(), rayreel::EngineError>(())
    /// ```
    ///
    /// # Errors
    ///
    /// As [`Engine::render_frame`].
    pub fn render_alpha_on(
        &mut self,
        time: Time,
        signals: Signals<'_>,
        visit: &mut dyn FnMut(&RenderJob) -> ControlFlow<()>,
    ) -> Result<Option<AlphaFilm>, EngineError> {
        let exposed = self.expose((Linear, true), time, &mut None, signals, visit)?;
        Ok(exposed.and_then(|exposed| Some(AlphaFilm { light: exposed.film, alpha: exposed.alpha? })))
    }

    /// Renders a moment incrementally like [`render_on`](Engine::render_on), with its background or with an alpha channel.
    fn expose<E: Encoding>(
        &mut self,
        (encoding, alpha): (E, bool),
        time: Time,
        begun: &mut Option<RenderJob<E>>,
        signals: Signals<'_>,
        visit: &mut dyn FnMut(&RenderJob<E>) -> ControlFlow<()>,
    ) -> Result<Option<Developed<E::Pixel>>, EngineError> {
        let instants = self.instants(time);
        let (mut traced, mut whole) = (Duration::ZERO, true);
        let mut memory = std::mem::take(&mut self.sample_memory);
        let count = count_of(&instants);
        let first = begun.as_ref().map_or_else(|| self.first_instants(&instants), RenderJob::instants);
        let mut hashed = HashedInstants::new(self.effects_left().lighting, self.hashed_instants(&instants));
        let is_fresh = begun.is_none();
        if hashed.instants() != first {
            let instants_to_hash = hashed.instants().to_vec();
            self.seek_all(
                time,
                (&instants, instants_to_hash),
                signals.cancelled,
                |preparation, _, instant| {
                    hashed.note(preparation, time, instant);
                    let (scene, camera) = (preparation.scene(), preparation.camera());
                    let job = begun.get_or_insert_with(|| {
                        let plan = SamplePlan { alpha, ..sample_plan(preparation, count) };
                        RenderJob::encoded(encoding, camera.resolution(), plan, std::mem::take(&mut memory))
                    });
                    if is_fresh {
                        job.search(scene, camera, signals.cancelled);
                    }
                    NextInstants::GoOn
                },
            )?;
        }
        let mut hashing = Duration::ZERO;
        let policy = self.policy.clone();
        let sought =
            self.seek_all(time, (&instants, first), signals.cancelled, |preparation, effects, instant| {
                let (scene, camera) = (preparation.scene(), preparation.camera());
                let sampling = preparation.sampling(time);
                let start = Instant::now();
                hashed.note(preparation, time, instant);
                hashing += start.elapsed();
                let job = begun.get_or_insert_with(|| {
                    let plan = SamplePlan { alpha, ..sample_plan(preparation, count) };
                    RenderJob::encoded(encoding, camera.resolution(), plan, std::mem::take(&mut memory))
                });
                whole = add_all(signals, visit, job, |job| {
                    let start = Instant::now();
                    let whole = job.add(scene, camera, sampling, instant, effects, signals);
                    traced += start.elapsed();
                    whole
                });
                if !whole {
                    return NextInstants::Stop;
                }
                let start = Instant::now();
                let next = match job.is_round_done() {
                    false => NextInstants::GoOn,
                    true if job.next_round(policy.as_ref()) => NextInstants::Visit(job.instants()),
                    true => NextInstants::Stop,
                };
                traced += start.elapsed();
                next
            })?;
        self.report.trace = traced;
        self.report.prepare += hashing;
        if !(whole && sought) {
            return Ok(None);
        }
        let FilmSettings { width, height, .. } = self.film_settings();
        let job = begun.take();
        let nothing = || {
            let plan = SamplePlan { alpha, ..SamplePlan::uniform(1, 1) };
            RenderJob::encoded(encoding, (width, height), plan, SampleMemory::default())
        };
        let job = job.unwrap_or_else(nothing);
        self.rounds = job.rounds().to_vec();
        let developed = self.resolve(job);
        let fingerprint = hashed.finish();
        self.report.fingerprint = Some(match policy {
            Some(_) => fingerprint.with_rounds(&self.rounds),
            None => fingerprint,
        });
        Ok(Some(developed))
    }

    /// Renders a moment by the reference path, which tests every ray against every shape. It is slow and single-threaded, and gives the
    /// same bits.
    ///
    /// # Errors
    ///
    /// As [`Engine::render_frame`].
    pub fn render_reference(&mut self, time: Time) -> Result<Film, EngineError> {
        let FilmSettings { width, height, .. } = self.film_settings();
        let sums = self.reference_sums(time, false)?;
        Ok(sums.map_or_else(|| Film::new(width, height), |sums| sums.resolve()))
    }

    /// Renders a moment by the reference path, with an alpha channel and without the background.
    ///
    /// # Errors
    ///
    /// As [`Engine::render_frame`].
    pub fn render_alpha_reference(&mut self, time: Time) -> Result<AlphaFilm, EngineError> {
        let FilmSettings { width, height, .. } = self.film_settings();
        let sums = self.reference_sums(time, true)?;
        Ok(sums.map_or_else(|| AlphaFilm::empty(width, height), |sums| sums.develop_with_alpha()))
    }

    /// Takes all samples of a moment by the reference path, with or without an alpha channel.
    fn reference_sums(&mut self, time: Time, alpha: bool) -> Result<Option<ReferenceSums>, EngineError> {
        let instants = self.instants(time);
        let (mut sums, count, left) = (None, count_of(&instants), self.effects_left());
        let policy = self.policy.clone();
        let first = self.first_instants(&instants);
        let mut rest = first.len();
        let hashed = self.hashed_instants(&instants);
        if hashed != first {
            self.seek_all(time, (&instants, hashed), &NEVER, |preparation, _, _| {
                let (scene, camera) = (preparation.scene(), preparation.camera());
                let plan = SamplePlan { alpha, ..sample_plan(preparation, count) };
                let sums = sums.get_or_insert_with(|| ReferenceSums::new(camera.resolution(), plan));
                Reference::new(scene, camera, preparation.sampling(time), left).search(sums);
                NextInstants::GoOn
            })?;
        }
        self.seek_all(time, (&instants, first), &NEVER, |preparation, _, instant| {
            let (scene, camera) = (preparation.scene(), preparation.camera());
            let plan = SamplePlan { alpha, ..sample_plan(preparation, count) };
            let sums = sums.get_or_insert_with(|| ReferenceSums::new(camera.resolution(), plan));
            Reference::new(scene, camera, preparation.sampling(time), left).add(sums, instant);
            rest -= 1;
            if rest > 0 {
                return NextInstants::GoOn;
            }
            if !sums.next_round(policy.as_ref()) {
                return NextInstants::Stop;
            }
            let next = sums.instants();
            rest = next.len();
            NextInstants::Visit(next)
        })?;
        Ok(sums)
    }

    /// Returns the fingerprint that the [report](FrameReport::fingerprint) would have if the moment were rendered. Brings the world to the
    /// moment.
    ///
    /// # Errors
    ///
    /// As [`Engine::render_frame`].
    pub fn fingerprint_at(&mut self, time: Time) -> Result<FrameFingerprint, EngineError> {
        let instants = self.instants(time);
        let to_hash = self.hashed_instants(&instants);
        let mut hashed = HashedInstants::new(self.effects_left().lighting, to_hash.clone());
        self.seek_all(time, (&instants, to_hash), &NEVER, |preparation, _, instant| {
            hashed.note(preparation, time, instant);
            NextInstants::GoOn
        })?;
        let fingerprint = hashed.finish();
        let Some(policy) = &self.policy else { return Ok(fingerprint) };
        // No round has a least gain of 0, so this fingerprint matches no image whose rounds depended on a clock.
        Ok(fingerprint.with_rounds(round_policy::locked(policy).rounds().unwrap_or(&[0])))
    }

    /// Plans a moment, with reasons, without rendering it: see [`Engine::plan`].
    ///
    /// # Errors
    ///
    /// As [`Engine::render_frame`].
    pub fn plan_at(&mut self, time: Time) -> Result<Option<&Plan>, EngineError> {
        let instants = self.instants(time);
        let first = self.hashed_instants(&instants);
        self.seek_all(time, (&instants, first), &NEVER, |_, _, _| NextInstants::GoOn)?;
        Ok(self.plan.as_ref())
    }

    /// Returns the exposure of a frame. It is read from the world before custom systems run, since the instants of a frame must not depend
    /// on the state of the world at those instants.
    fn shutter(&mut self, time: Time) -> Shutter {
        self.shutters.get_or_insert_with(|| Shutters::of(&self.world)).at(time, &self.settings)
    }

    /// Returns the number of samples of each pixel of the last frame; 1, the minimum, if sampling is adaptive.
    #[must_use]
    pub fn least_samples(&self) -> u32 {
        let own = || self.settings.sampling(sampling_settings(&self.world)).samples;
        if self.is_adaptive() { 1 } else { self.sampling().map_or_else(own, |sampling| sampling.samples) }
    }

    /// Returns the instants at which a frame is rendered: its moment, or several instants while the shutter is open.
    pub(super) fn instants(&mut self, time: Time) -> Vec<Time> {
        let shutter = self.shutter(time);
        self.instants_of(shutter, time)
    }

    fn instants_of(&self, shutter: Shutter, time: Time) -> Vec<Time> {
        let single =
            [Effect::MotionBlur, Effect::Antialiasing].iter().any(|effect| self.left_out.contains(effect));
        match shutter {
            _ if single => vec![time],
            Shutter::Open(open, count) if self.full || self.may_move() => {
                let count = if self.is_adaptive() { InstantOrder::MOST } else { count };
                self.timeline.instants(time, open, count)
            }
            _ => vec![time],
        }
    }

    /// Returns the indices of the instants that the first round of a frame visits.
    fn first_instants(&self, instants: &[Time]) -> Vec<u32> {
        if instants.len() > 1 && self.is_adaptive() {
            return InstantOrder::new(true).first();
        }
        (0..count_of(instants)).collect()
    }

    /// Returns the indices of the instants that identify a frame: all of them or, if sampling is adaptive, the default number of instants.
    fn hashed_instants(&self, instants: &[Time]) -> Vec<u32> {
        if instants.len() > 1 && self.is_adaptive() {
            let count = Sampling::default().instants;
            return InstantOrder::new(true).instants(0..count);
        }
        (0..count_of(instants)).collect()
    }

    /// Returns whether any entity can move.
    fn may_move(&self) -> bool {
        let animated = |archetype: &hecs::Archetype| !archetype.is_empty() && archetype.has::<Animated>();
        !self.systems.is_empty() || self.world.archetypes().any(animated)
    }

    /// Visits instants of the frame at `time`, given by their indices, and calls `each` with the prepared data of each instant, the effects
    /// that it needs, and its index. The result of `each` determines the next instant. All instants use the film and the sampling of the
    /// first one. Returns `false` if cancelled.
    pub(super) fn seek_all(
        &mut self,
        time: Time,
        (instants, first): (&[Time], Vec<u32>),
        cancelled: &AtomicBool,
        mut each: impl FnMut(&Preparation, Effects, u32) -> NextInstants,
    ) -> Result<bool, EngineError> {
        self.report = FrameReport { time, ..FrameReport::default() };
        let mut plan: Option<Plan> = None;
        let (mut moves, mut job) = (false, None);
        let (mut next, mut is_first) = (VecDeque::from(first), true);
        while let Some(index) = next.pop_front() {
            let Some(instant) = instants.get(index as usize) else { continue };
            let Some(changed) = self.bring(*instant, cancelled)? else { return Ok(false) };
            let Some(own) = self.apply_settings(&mut job) else { continue };
            let Some(shown) = self.shown() else { continue };
            moves |= !std::mem::take(&mut is_first) && !changed.is_empty();
            let now = shown.plan(&self.world);
            let mut effects = if self.full { Effects::ALL } else { now.effects() };
            effects.lighting = effects.lighting.min(self.effects_left().lighting);
            match &mut plan {
                Some(plan) => plan.join(&now),
                None => plan = Some(now),
            }
            let mut then = each(&shown, effects, index);
            // The world is already at a single instant.
            while instants.len() == 1 && matches!(then, NextInstants::Visit(_)) {
                then = each(&shown, effects, index);
            }
            if let Some(preparation) = &mut self.preparation {
                preparation.replace_frame_settings(&own, &self.world);
            }
            match then {
                NextInstants::GoOn => {}
                NextInstants::Visit(instants) => next = instants.into(),
                NextInstants::Stop => break,
            }
        }
        let motion_blur = self.motion_blur(time, moves);
        if let Some(plan) = &mut plan {
            plan.set_motion_blur(motion_blur);
            plan.leave_out(&self.left_out);
        }
        self.plan = plan;
        Ok(true)
    }

    /// Applies the render settings overrides to the prepared instant, and the film and the sampling of the frame's first instant, which
    /// `job` stores. Returns the instant's own settings.
    fn apply_settings(&mut self, job: &mut Option<(FilmSettings, Sampling)>) -> Option<FrameSettings> {
        let preparation = self.preparation.as_mut()?;
        let mut settings = preparation.frame_settings();
        (settings.film, settings.sampling) = *job.get_or_insert((settings.film, settings.sampling));
        self.settings.apply(&mut settings);
        Some(preparation.replace_frame_settings(&settings, &self.world))
    }

    fn motion_blur(&mut self, time: Time, moves: bool) -> Need {
        match self.shutter(time) {
            Shutter::None => Need::LeftOut("the camera has no shutter"),
            Shutter::OneInstant => Need::LeftOut("all samples are taken at one instant"),
            Shutter::Open(..) if moves => Need::Needed("something moves while the shutter is open"),
            Shutter::Open(..) => Need::LeftOut("nothing moves while the shutter is open"),
        }
    }

    /// Advances the world and the kernel's data to a moment, without rendering.
    ///
    /// # Errors
    ///
    /// As [`Engine::render_frame`].
    pub fn seek(&mut self, time: Time) -> Result<(), EngineError> {
        self.seek_unless(time, &NEVER).map(|_| ())
    }

    /// Seeks like [`Engine::seek`], and returns `false` if cancelled.
    pub(in crate::engine) fn seek_unless(
        &mut self,
        time: Time,
        cancelled: &AtomicBool,
    ) -> Result<bool, EngineError> {
        self.report = FrameReport { time, ..FrameReport::default() };
        Ok(self.bring(time, cancelled)?.is_some())
    }

    /// Seeks like [`Engine::seek`], to the instant of sample `index` of the frame at `time`. While the shutter is open, samples are taken
    /// at different instants.
    ///
    /// # Errors
    ///
    /// As [`Engine::render_frame`].
    #[doc(hidden)]
    pub fn seek_sample(&mut self, time: Time, index: u32) -> Result<(), EngineError> {
        let instants = self.instants(time);
        self.report = FrameReport { time, ..FrameReport::default() };
        let (mut job, count) = (None, count_of(&instants));
        let is_adaptive = self.is_adaptive() && count > 1;
        let wanted = is_adaptive.then(|| InstantOrder::new(true).instants(index..index + 1));
        for (at, instant) in (0..).zip(&instants) {
            self.bring(*instant, &NEVER)?;
            self.apply_settings(&mut job);
            let Some(preparation) = &self.preparation else { continue };
            let belongs = match &wanted {
                Some(wanted) => wanted.contains(&at),
                None => block(preparation.samples(), count, at).contains(&index),
            };
            if belongs {
                break;
            }
        }
        Ok(())
    }

    /// Advances the world and the kernel's data to an instant of the reported frame. Returns the changes of the kernel's data, or `None` if
    /// cancelled.
    fn bring(&mut self, instant: Time, cancelled: &AtomicBool) -> Result<Option<SceneChanges>, EngineError> {
        let start = Instant::now();
        if let Err(halt) = self.systems.advance(&mut self.world, instant, &mut self.changes, cancelled) {
            return EngineError::of(halt, &self.script_sources).map_or(Ok(None), Err);
        }
        let animated = Instant::now();
        let changes = std::mem::take(&mut self.changes);
        if changes.is_all() {
            order_newcomers(&mut self.world, &[]);
        }
        let moved = propagate(&mut self.world, &changes);
        let changed = match &mut self.preparation {
            Some(preparation) => preparation.update(&mut self.world, self.report.time, &changes, &moved),
            None => {
                self.preparation = Some(Preparation::of(&mut self.world, self.report.time));
                SceneChanges::remade()
            }
        };
        if let Some(preparation) = &mut self.preparation {
            preparation.set_precision(self.precision);
            preparation.set_simd_level(self.simd);
        }
        self.report.bvh_builds += u32::from(changed.bvh == BvhUpdate::Built);
        self.report.bvh_refits += u32::from(changed.bvh == BvhUpdate::Refitted);
        self.report.animate += animated - start;
        self.report.prepare += animated.elapsed();
        Ok(Some(changed))
    }
}

/// The action after an instant of a frame.
pub(super) enum NextInstants {
    /// Continues with the next instant, if any.
    GoOn,
    /// Visits these instants next, in this order.
    Visit(Vec<u32>),
    /// Ends the frame.
    Stop,
}

/// Returns the number of instants, which is never more than the number of samples.
fn count_of(instants: &[Time]) -> u32 {
    u32::try_from(instants.len()).unwrap_or(u32::MAX)
}

/// Returns the sample plan of an image with this number of instants, without an alpha channel.
fn sample_plan(preparation: &Preparation, instants: u32) -> SamplePlan {
    let samples = preparation.samples();
    let target = preparation.error_target(instants > 1);
    let starts_wide = preparation.camera().has_lens();
    SamplePlan { target, starts_wide, ..SamplePlan::uniform(samples, instants) }
}
