//! The engine.

use std::borrow::Cow;
use std::path::Path;

use hecs::{Component, World};

use super::cast::{Hit, IntoRay, Ray};
use super::probe::Probe;
use super::report::FrameReport;
use crate::components::FilmSettings;
use crate::scene::{LoadError, Scene, SceneScripts, ScriptMistake, ScriptSources};
use crate::systems::{
    self, Changes, Context, Effect, Fault, Halt, Knobs, Plan, Preparation, Schedule, ScriptFailure, Scripts,
    Shutters, Step, UnknownComponent, sampling_settings,
};
use crate::time::Timeline;
use crate::trace::reference::Reference;
use crate::trace::{self, Effects, Lighting, Precision, SampleMemory, SharedRoundPolicy, SimdLevel};

/// A world of entities that is rendered moment by moment.
///
/// # A simulation as a movie
///
/// Balls that bounce, stepped 240 times a second. Frames may be requested in any order: going back replays the steps from the
/// start, and gives the same bits.
///
/// ```
/// use glam::DVec3;
/// use rayreel::components::{Camera, FilmSettings, Light, LightKind, Material, Shape, Transform};
/// use rayreel::{Context, Engine, Rgb, Step, World};
///
/// #[derive(Clone)]
/// struct Velocity(DVec3);
///
/// fn physics(context: &mut Context<'_>) {
///     let dt = context.step_seconds();
///     let mut moved = Vec::new();
///     for (entity, transform, velocity) in
///         context.world.query_mut::<(rayreel::Entity, &mut Transform, &mut Velocity)>()
///     {
///         velocity.0.y -= 9.81 * dt;
///         transform.translation += velocity.0 * dt;
///         if transform.translation.y < 1.0 {
///             transform.translation.y = 2.0 - transform.translation.y;
///             velocity.0.y = -0.8 * velocity.0.y;
///         }
///         moved.push(entity);
///     }
///     for entity in moved {
///         context.changes.mark_transform(entity); // what is not declared need not be looked at
///     }
/// }
///
/// let mut world = World::new();
/// let clay = Material { k_a: 0.3, k_d: 0.7, color: Rgb::new(1.0, 0.5, 0.2), ambient_color: None };
/// let ball = world.spawn((
///     Shape::Sphere { radius: 1.0 },
///     clay,
///     Transform::from_translation(DVec3::new(0.0, 4.0, 0.0)),
///     Velocity(DVec3::X),
/// ));
/// world.spawn((Light::new(LightKind::Point, Rgb::ONE), Transform::from_translation(DVec3::splat(9.0))));
/// world.spawn((Camera { position: DVec3::new(0.0, 2.0, -12.0), ..Camera::default() },));
/// world.spawn((FilmSettings { width: 32, height: 18, ..FilmSettings::default() },));
///
/// let mut engine = Engine::new(world);
/// engine.register::<Velocity>();
/// engine.add_stepped_system(Step::per_second(240), physics);
///
/// let early = engine.render_frame(12)?;
/// let late = engine.render_frame(24)?;
/// let height = engine.world().get::<&Transform>(ball).unwrap().translation.y;
/// assert_ne!(early, late);
///
/// assert_eq!(engine.render_frame(12)?, early); // back in time
/// assert_eq!(engine.render_frame(24)?, late);
/// assert_eq!(engine.world().get::<&Transform>(ball).unwrap().translation.y, height);
/// # Ok::<(), rayreel::EngineError>(())
/// ```
pub struct Engine {
    pub(super) world: World,
    pub(super) timeline: Timeline,
    pub(super) systems: Schedule,
    /// Writes since the last preparation.
    pub(super) changes: Changes,
    pub(super) preparation: Option<Preparation>,
    pub(super) precision: Precision,
    pub(super) simd: SimdLevel,
    /// Whether to render with everything compiled in.
    pub(super) full: bool,
    /// The effects that are left out, even if a scene calls for them.
    pub(super) left_out: Vec<Effect>,
    pub(super) knobs: Knobs,
    /// The exposure of frames, once it has been read.
    pub(super) shutters: Option<Shutters>,
    pub(super) plan: Option<Plan>,
    pub(super) report: FrameReport,
    /// The choice of the samples of rounds, if it is not the target's.
    pub(super) policy: Option<SharedRoundPolicy>,
    /// The least gains of the last picture's rounds, where a policy has chosen them.
    pub(super) rounds: Vec<u32>,
    /// The last picture's, kept for their memory.
    pub(super) sample_memory: SampleMemory,
    pub(super) script_sources: ScriptSources,
}

/// The reason why a frame could not be rendered.
#[derive(Debug, thiserror::Error)]
pub enum EngineError {
    /// The scene file could not be loaded.
    #[error(transparent)]
    Scene(#[from] LoadError),
    /// The world cannot be copied, which custom systems need.
    #[error(transparent)]
    UnknownComponent(#[from] UnknownComponent),
    /// A script gave no value.
    #[error(transparent)]
    Script(#[from] ScriptMistake),
}

impl EngineError {
    /// Returns the error of a halt; `None` if nothing is wrong and the frame was only cancelled.
    pub(super) fn of(halt: Halt, sources: &ScriptSources) -> Option<Self> {
        Some(match halt {
            Halt::Cancelled => return None,
            Halt::UnknownComponent(unknown) => Self::UnknownComponent(unknown),
            Halt::Script(failure) => {
                let ScriptFailure { script, channel, seconds, error } = *failure;
                let about = format!("{channel} at t = {seconds}");
                Self::Script(sources.mistake(script, &about, &error))
            }
        })
    }
}

impl Engine {
    /// Loads a scene file, at its first moment.
    ///
    /// # Errors
    ///
    /// If the file cannot be read or is wrong: lists every mistake, where it is and how to fix it.
    pub fn load(path: impl AsRef<Path>) -> Result<Self, EngineError> {
        Ok(Self::from_scene(Scene::load(path.as_ref())?))
    }

    /// Creates an engine for a scene that has been read.
    #[must_use]
    pub fn from_scene(scene: Scene) -> Self {
        let Scene { world, timeline, scripts, .. } = scene;
        let mut engine = Self::new(world);
        engine.start(timeline, scripts);
        engine
    }

    /// Starts with the timeline and the scripts of a scene whose world is this one.
    pub(super) fn start(&mut self, timeline: Timeline, scripts: SceneScripts) {
        let (scripts, sources) = scripts.into_parts();
        self.systems.set_scripts(Scripts::new(scripts, timeline));
        self.script_sources = sources;
        self.timeline = timeline;
        self.shutters = None;
    }

    /// Creates an engine for a world. Its timeline has 24 frames per second and a single frame, which
    /// [`set_timeline`](Engine::set_timeline) changes; others can be rendered all the same. What the world lacks (a camera, film
    /// settings) has defaults.
    #[must_use]
    pub fn new(world: World) -> Self {
        Self {
            world,
            timeline: Timeline::still(),
            systems: Schedule::default(),
            changes: Changes::all(),
            preparation: None,
            precision: Precision::default(),
            simd: SimdLevel::best(),
            full: false,
            left_out: Vec::new(),
            knobs: Knobs::default(),
            shutters: None,
            plan: None,
            policy: None,
            rounds: Vec::new(),
            report: FrameReport::default(),
            sample_memory: SampleMemory::default(),
            script_sources: ScriptSources::default(),
        }
    }

    /// Adds a pure function of time that writes to the world. Its writes are undone before every frame.
    pub fn add_system(&mut self, system: impl Fn(&mut Context<'_>) + Send + 'static) {
        self.systems.rewind(&mut self.world);
        self.changes.mark_all();
        self.shutters = None;
        self.systems.add(system);
    }

    /// Adds a system that carries state from step to step. The engine runs it `floor(t / step)` times for the moment `t`, from a
    /// copy of the world at 0; going back starts over.
    pub fn add_stepped_system(&mut self, step: Step, system: impl Fn(&mut Context<'_>) + Send + 'static) {
        self.systems.rewind(&mut self.world);
        self.changes.mark_all();
        self.shutters = None;
        self.systems.add_stepped(step, system);
    }

    /// Registers a custom component type as part of the state that is copied and restored. Required for every such type once
    /// there are custom systems.
    pub fn register<T: Component + Clone>(&mut self) {
        self.systems.registry_mut().register::<T>();
    }

    /// Returns the world at the moment of the last frame, or, if its shutter was open, at the last of its instants;
    /// [`seek`](Engine::seek) brings it to the frame's own moment.
    #[must_use]
    pub fn world(&self) -> &World {
        &self.world
    }

    /// Returns the world as it was at the start, before any step, for editing. Everything is read again for the next frame.
    pub fn world_mut(&mut self) -> &mut World {
        self.systems.rewind(&mut self.world);
        self.changes.mark_all();
        self.shutters = None;
        &mut self.world
    }

    /// Returns the frame rate and the duration.
    #[must_use]
    pub fn timeline(&self) -> Timeline {
        self.timeline
    }

    /// Sets the frame rate and the duration.
    pub fn set_timeline(&mut self, timeline: Timeline) {
        self.timeline = timeline;
        self.systems.scripts_mut().set_timeline(timeline);
    }

    /// Sets the precision of intersections from the next frame on: guaranteed, unless a comparison with textbooks is wanted.
    pub fn set_precision(&mut self, precision: Precision) {
        self.precision = precision;
    }

    /// Returns the precision of intersections.
    #[must_use]
    pub fn precision(&self) -> Precision {
        self.precision
    }

    /// Sets the vector instructions from the next frame on: the best that the processor has, unless they are compared. Pictures are
    /// the same with all.
    #[doc(hidden)]
    pub fn set_simd_level(&mut self, simd: SimdLevel) {
        self.simd = simd;
    }

    /// Returns the film's size and transfer.
    #[must_use]
    pub fn film_settings(&self) -> FilmSettings {
        systems::film_settings(&self.world)
    }

    /// Returns the prepared camera at the moment of the last frame (the last of its instants, if its shutter was open) or
    /// [`seek`](Engine::seek). `None` before the first of them.
    ///
    /// ```no_run
    /// use rayreel::Engine;
    ///
    /// let mut engine = Engine::load("scenes/fly_around.ron")?;
    /// let timeline = engine.timeline();
    /// for frame in 0..timeline.frame_count() {
    ///     engine.seek(timeline.time_of(frame))?;
    ///     if let Some(camera) = engine.camera() {
    ///         println!("{} looks along {}", camera.position(), camera.axes()[2]);
    ///     }
    /// }
    /// # Ok::<(), rayreel::EngineError>(())
    /// ```
    #[must_use]
    pub fn camera(&self) -> Option<&trace::Camera> {
        Some(self.preparation.as_ref()?.camera())
    }

    /// Returns the effects that the last frame needed or left out, and why. `None` before the first frame.
    #[must_use]
    pub fn plan(&self) -> Option<&Plan> {
        self.plan.as_ref()
    }

    /// Leaves these effects, and no others, out of the frames from now on, even if a scene calls for them: to see what they are worth.
    /// Without shadows of transparent objects, they occlude lights like opaque ones.
    pub fn set_left_out(&mut self, effects: impl IntoIterator<Item = Effect>) {
        self.left_out = effects.into_iter().collect();
    }

    /// Returns the effects that are left out of frames even if a scene calls for them.
    #[must_use]
    pub fn left_out(&self) -> &[Effect] {
        &self.left_out
    }

    /// Sets what frames are rendered with from now on in the place of the scene's own settings. Drafts keep to the scene's.
    pub fn set_knobs(&mut self, knobs: Knobs) {
        self.knobs = knobs;
    }

    /// Sets what chooses the samples of each round of pictures that have a target, in the place of the target.
    pub fn set_round_policy(&mut self, policy: Option<SharedRoundPolicy>) {
        self.policy = policy;
    }

    /// Returns the least gains of the last picture's rounds, where a policy has chosen them: a [`Replay`](trace::Replay) of them gives the
    /// same picture.
    #[must_use]
    pub fn rounds(&self) -> &[u32] {
        &self.rounds
    }

    /// Returns how many samples each pixel of the last picture took, row by row from the top. Empty where all took the same: without
    /// a [target](Engine::is_adaptive).
    #[must_use]
    pub fn sample_counts(&self) -> Vec<u32> {
        let FilmSettings { width, height, .. } = self.film_settings();
        self.sample_memory.counts((width, height))
    }

    /// Returns what frames are rendered with in the place of the scene's own settings.
    #[must_use]
    pub fn knobs(&self) -> Knobs {
        self.knobs
    }

    /// Sets whether to render with every effect, even those that a scene does not call for: slower, and the same bits. For
    /// comparisons.
    pub fn set_full(&mut self, full: bool) {
        self.full = full;
    }

    /// Returns the entities whose shapes are in the picture at the moment of the last frame or [`seek`](Engine::seek), in
    /// document order. None before the first of them.
    pub fn drawn(&self) -> impl Iterator<Item = hecs::Entity> {
        self.preparation.iter().flat_map(|preparation| preparation.drawn().iter().copied())
    }

    /// Returns what is wrong with the world at the moment of the last frame (the last of its instants, if its shutter was open)
    /// or [`seek`](Engine::seek), in document order: what is not drawn or not used as given, why, and how to fix it. Nothing
    /// before the first of them.
    ///
    /// ```
    /// use rayreel::components::{Material, Shape, Transform};
    /// use rayreel::{Engine, Rgb, Time, World};
    ///
    /// let mut world = World::new();
    /// let clay = Material { k_a: 0.3, k_d: 0.7, color: Rgb::ONE, ambient_color: None };
    /// let ball = world.spawn((Shape::Sphere { radius: -1.0 }, clay, Transform::IDENTITY));
    /// let mut engine = Engine::new(world);
    /// engine.seek(Time::ZERO)?;
    /// let faults = engine.faults();
    /// assert_eq!(faults[0].entity, ball);
    /// assert_eq!(faults[0].to_string(), "is not drawn: its radius is -1");
    /// assert_eq!(faults[0].remedy(), "make it greater than 0");
    /// # Ok::<(), rayreel::EngineError>(())
    /// ```
    #[must_use]
    pub fn faults(&self) -> Vec<Fault> {
        self.preparation.as_ref().map_or_else(Vec::new, |preparation| preparation.faults(&self.world))
    }

    /// Returns the cost of the last frame.
    #[must_use]
    pub fn report(&self) -> &FrameReport {
        &self.report
    }

    /// Returns the closest hit of a ray, at the moment of the last frame (the last of its instants, if its shutter was open) or
    /// [`seek`](Engine::seek), exactly as the renderer sees it. `None` before the first of them, for a ray that hits nothing, and
    /// for one without a direction.
    ///
    /// ```no_run
    /// use glam::DVec3;
    /// use rayreel::{Engine, Ray, Time};
    ///
    /// let mut engine = Engine::load("scenes/first_light.ron")?;
    /// engine.seek(Time::ZERO)?;
    /// let ray = Ray { origin: DVec3::new(0.0, 1.0, -8.0), direction: DVec3::Z };
    /// if let Some(hit) = engine.cast(ray) {
    ///     println!("{:?} after {} units", hit.entity, hit.distance);
    ///     let next = hit.leave_towards(hit.normal); // starts on the surface, and never meets it by rounding
    ///     assert!(engine.cast(next).is_none_or(|next| next.distance > 0.0));
    /// }
    /// # Ok::<(), rayreel::EngineError>(())
    /// ```
    #[must_use]
    pub fn cast(&self, ray: impl IntoRay) -> Option<Hit> {
        let preparation = self.preparation.as_ref()?;
        let (ray, exponent) = ray.into_ray()?;
        let surface = preparation.scene().cast(&ray)?;
        Some(Hit::new(preparation.entity(surface.hit.id), &ray, exponent, surface))
    }

    /// Casts many rays as [`cast`](Engine::cast) does, on the current rayon pool's threads. The hits are in the rays' order.
    #[must_use]
    pub fn cast_all(&self, rays: &[Ray]) -> Vec<Option<Hit>> {
        let Some(preparation) = &self.preparation else {
            return vec![None; rays.len()];
        };
        let (rays, exponents): (Vec<_>, Vec<_>) = rays
            .iter()
            .map(|ray| match ray.into_ray() {
                Some((ray, exponent)) => (Some(ray), exponent),
                None => (None, 0),
            })
            .unzip();
        let surfaces = preparation.scene().cast_all(&rays);
        surfaces
            .into_iter()
            .zip(rays.iter().zip(exponents))
            .map(|(surface, (ray, exponent))| {
                let surface = surface?;
                Some(Hit::new(preparation.entity(surface.hit.id), ray.as_ref()?, exponent, surface))
            })
            .collect()
    }

    /// Returns everything that goes into the first sample of the pixel in column `i` and row `j`: the only one, unless
    /// [`Sampling`](crate::components::Sampling) has more. As [`probe_sample`](Engine::probe_sample).
    #[doc(hidden)]
    #[must_use]
    pub fn probe(&self, i: u32, j: u32) -> Option<Probe<'_>> {
        self.probe_sample(i, j, 0)
    }

    /// Returns everything that goes into sample `index` of the pixel in column `i` and row `j`, at the moment of the last
    /// [`seek`](Engine::seek) or, where a shutter is open, [`seek_sample`](Engine::seek_sample), by the reference path. `None`
    /// before the first of them, outside the film, and for a sample that the pixel does not have.
    #[doc(hidden)]
    #[must_use]
    pub fn probe_sample(&self, i: u32, j: u32, index: u32) -> Option<Probe<'_>> {
        let shown = self.shown()?;
        let (camera, sampling) = (shown.camera(), shown.sampling(self.report.time));
        let (columns, rows) = camera.resolution();
        let exists = i < columns && j < rows && index < sampling.samples;
        let mut reference = Reference::new(shown.scene(), camera, sampling, self.effects_left());
        let tree = exists.then(|| reference.sample(i, j, index))??;
        Some(Probe::new(self.preparation.as_ref()?, tree))
    }

    /// Returns the number of samples per pixel, and their choice, at the moment of the last frame or [`seek`](Engine::seek).
    /// `None` before the first of them.
    #[must_use]
    pub fn sampling(&self) -> Option<trace::Sampling> {
        let sampling = self.preparation.as_ref()?.sampling(self.report.time);
        let samples = if self.left_out.contains(&Effect::Antialiasing) { 1 } else { sampling.samples };
        Some(trace::Sampling { samples, ..sampling })
    }

    /// Returns whether pixels get as many samples as they need: see [`Sampling::max_error`](crate::components::Sampling::max_error).
    #[must_use]
    pub fn is_adaptive(&self) -> bool {
        let sampling = self.knobs.sampling(sampling_settings(&self.world));
        sampling.max_error > 0.0 && !self.left_out.contains(&Effect::Antialiasing)
    }

    /// Returns what is prepared, without what is left out.
    pub(super) fn shown(&self) -> Option<Cow<'_, Preparation>> {
        let mut shown = Cow::Borrowed(self.preparation.as_ref()?);
        for effect in &self.left_out {
            shown.to_mut().leave_out(*effect);
        }
        Some(shown)
    }

    /// Returns the effects that pictures may have, if a scene calls for them. Others are not in what is [shown](Engine::shown).
    pub(super) fn effects_left(&self) -> Effects {
        let lighting = match self.left_out.contains(&Effect::ClearShadows) {
            true => Lighting::Shadows,
            false => Lighting::ClearShadows,
        };
        Effects { lighting, ..Effects::ALL }
    }
}
