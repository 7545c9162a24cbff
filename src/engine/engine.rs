//! The engine: a world with its systems and its prepared data.

use std::borrow::Cow;
use std::path::Path;

use hecs::{Component, World};

use super::cast::{Hit, IntoRay, Ray};
use super::probe::Probe;
use super::report::FrameReport;
use crate::components::FilmSettings;
use crate::scene::{LoadError, Scene, SceneScripts, ScriptMistake, ScriptSources};
use crate::systems::{
    self, Changes, Context, Effect, Fault, Interrupted, Plan, Preparation, RenderSettings, Schedule,
    ScriptFailure, Scripts, Shutters, Step, UnknownComponent, sampling_settings,
};
use crate::time::Timeline;
use crate::trace::reference::Reference;
use crate::trace::{self, Effects, Lighting, Precision, SampleMemory, SharedRoundPolicy, SimdLevel};

/// A world of entities that is rendered at any moment of its timeline.
///
/// # Simulation
///
/// Bouncing balls, stepped 240 times per second. Frames may be requested in any order: going back in time replays the steps from the start
/// and gives the same bits.
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
    /// The writes since the last preparation.
    pub(super) changes: Changes,
    pub(super) preparation: Option<Preparation>,
    pub(super) precision: Precision,
    pub(super) simd: SimdLevel,
    /// True if all effects are rendered, even those that the scene does not need.
    pub(super) full: bool,
    /// The disabled effects.
    pub(super) left_out: Vec<Effect>,
    pub(super) settings: RenderSettings,
    /// The exposure of frames; `None` until it is read from the world.
    pub(super) shutters: Option<Shutters>,
    pub(super) plan: Option<Plan>,
    pub(super) report: FrameReport,
    /// The policy that chooses the samples of each round. `None` uses the error target alone.
    pub(super) policy: Option<SharedRoundPolicy>,
    /// The least gains of the last image's rounds, if a policy chose them.
    pub(super) rounds: Vec<u32>,
    /// The sample buffers of the last image, kept for reuse and for [`Engine::sample_counts`].
    pub(super) sample_memory: SampleMemory,
    pub(super) script_sources: ScriptSources,
}

/// The reason why a frame could not be rendered.
#[derive(Debug, thiserror::Error)]
pub enum EngineError {
    /// The scene file could not be loaded.
    #[error(transparent)]
    Scene(#[from] LoadError),
    /// The world cannot be copied, as custom systems require.
    #[error(transparent)]
    UnknownComponent(#[from] UnknownComponent),
    /// A script failed to return a value.
    #[error(transparent)]
    Script(#[from] ScriptMistake),
}

impl EngineError {
    /// Returns the error for a halt. `None` if the frame was only cancelled.
    pub(super) fn of(halt: Interrupted, sources: &ScriptSources) -> Option<Self> {
        Some(match halt {
            Interrupted::Cancelled => return None,
            Interrupted::UnknownComponent(unknown) => Self::UnknownComponent(unknown),
            Interrupted::Script(failure) => {
                let ScriptFailure { script, channel, seconds, error } = *failure;
                let about = format!("{channel} at t = {seconds}");
                Self::Script(sources.mistake(script, &about, &error))
            }
        })
    }
}

impl Engine {
    /// Loads a scene file and creates an engine at its first moment.
    ///
    /// # Errors
    ///
    /// If the file cannot be read or is wrong: lists every mistake, where it is and how to fix it.
    pub fn load(path: impl AsRef<Path>) -> Result<Self, EngineError> {
        Ok(Self::from_scene(Scene::load(path.as_ref())?))
    }

    /// Creates an engine for a loaded scene.
    #[must_use]
    pub fn from_scene(scene: Scene) -> Self {
        let Scene { world, timeline, scripts, .. } = scene;
        let mut engine = Self::new(world);
        engine.start(timeline, scripts);
        engine
    }

    /// Starts with the timeline and the scripts of a scene, after its world has been set.
    pub(super) fn start(&mut self, timeline: Timeline, scripts: SceneScripts) {
        let (scripts, sources) = scripts.into_parts();
        self.systems.set_scripts(Scripts::new(scripts, timeline));
        self.script_sources = sources;
        self.timeline = timeline;
        self.shutters = None;
    }

    /// Creates an engine for a world. Its timeline has 24 frames per second and a single frame; [`set_timeline`](Engine::set_timeline)
    /// changes it. Frames beyond the end of the timeline can be rendered too. Missing parts of the world (a camera, film settings) have
    /// defaults.
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
            settings: RenderSettings::default(),
            shutters: None,
            plan: None,
            policy: None,
            rounds: Vec::new(),
            report: FrameReport::default(),
            sample_memory: SampleMemory::default(),
            script_sources: ScriptSources::default(),
        }
    }

    /// Adds a pure system: a function of time that writes to the world. Its writes are undone before every frame.
    pub fn add_system(&mut self, system: impl Fn(&mut Context<'_>) + Send + 'static) {
        self.systems.rewind(&mut self.world);
        self.changes.mark_all();
        self.shutters = None;
        self.systems.add(system);
    }

    /// Adds a system that carries state from step to step. For the moment `t` the engine runs it `floor(t / step)` times, starting from a
    /// copy of the world at time 0. Going back in time starts over.
    pub fn add_stepped_system(&mut self, step: Step, system: impl Fn(&mut Context<'_>) + Send + 'static) {
        self.systems.rewind(&mut self.world);
        self.changes.mark_all();
        self.shutters = None;
        self.systems.add_stepped(step, system);
    }

    /// Registers a custom component type as part of the state that is copied and restored. Custom systems require this for every custom
    /// component type.
    pub fn register<T: Component + Clone>(&mut self) {
        self.systems.registry_mut().register::<T>();
    }

    /// Returns the world at the moment of the last frame. If the shutter was open, the world is at the last instant of the frame;
    /// [`seek`](Engine::seek) brings it to the frame's own moment.
    #[must_use]
    pub fn world(&self) -> &World {
        &self.world
    }

    /// Returns the world as it was at the start, before any step, for editing. The next frame reads the whole world again.
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

    /// Sets the precision of intersections from the next frame on. The default is guaranteed; the other values are for comparisons with
    /// textbook formulas.
    pub fn set_precision(&mut self, precision: Precision) {
        self.precision = precision;
    }

    /// Returns the precision of intersections.
    #[must_use]
    pub fn precision(&self) -> Precision {
        self.precision
    }

    /// Sets the SIMD level from the next frame on. The default is the best level that the processor supports; the others are for
    /// comparisons. Images are the same at all levels.
    #[doc(hidden)]
    pub fn set_simd_level(&mut self, simd: SimdLevel) {
        self.simd = simd;
    }

    /// Returns the size and the encoding of the film.
    #[must_use]
    pub fn film_settings(&self) -> FilmSettings {
        systems::film_settings(&self.world)
    }

    /// Returns the prepared camera at the moment of the last frame (the last instant, if the shutter was open) or [`seek`](Engine::seek).
    /// `None` before the first frame or seek.
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
    pub fn camera(&self) -> Option<&trace::PreparedCamera> {
        Some(self.preparation.as_ref()?.camera())
    }

    /// Returns the effects that the last frame needed or omitted, with reasons. `None` before the first frame.
    #[must_use]
    pub fn plan(&self) -> Option<&Plan> {
        self.plan.as_ref()
    }

    /// Disables these effects, and no others, from the next frame on, even if a scene needs them, to measure their contribution. If the
    /// shadows of transparent objects are disabled, these objects occlude lights like opaque ones.
    pub fn set_left_out(&mut self, effects: impl IntoIterator<Item = Effect>) {
        self.left_out = effects.into_iter().collect();
    }

    /// Returns the disabled effects.
    #[must_use]
    pub fn left_out(&self) -> &[Effect] {
        &self.left_out
    }

    /// Sets the render settings that override the scene's own from the next frame on. Drafts use the scene's own settings.
    pub fn set_render_settings(&mut self, settings: RenderSettings) {
        self.settings = settings;
    }

    /// Sets the policy that chooses the samples of each round, for images with an error target. `None` uses the target alone.
    pub fn set_round_policy(&mut self, policy: Option<SharedRoundPolicy>) {
        self.policy = policy;
    }

    /// Returns the least gains of the last image's rounds, if a policy chose them. A [`Replay`](trace::Replay) of them gives the same
    /// image.
    #[must_use]
    pub fn rounds(&self) -> &[u32] {
        &self.rounds
    }

    /// Returns the number of samples of each pixel of the last image, row by row from the top. Empty if all pixels have the same number,
    /// that is, without an [error target](Engine::is_adaptive).
    #[must_use]
    pub fn sample_counts(&self) -> Vec<u32> {
        let FilmSettings { width, height, .. } = self.film_settings();
        self.sample_memory.counts((width, height))
    }

    /// Returns the render settings that override the scene's own.
    #[must_use]
    pub fn settings(&self) -> RenderSettings {
        self.settings
    }

    /// Sets whether to render with all effects, even those that a scene does not need. This is slower and gives the same bits; it is meant
    /// for comparisons.
    pub fn set_full(&mut self, full: bool) {
        self.full = full;
    }

    /// Returns the entities whose shapes are rendered at the moment of the last frame or [`seek`](Engine::seek), in document order. Empty
    /// before the first frame or seek.
    pub fn drawn(&self) -> impl Iterator<Item = hecs::Entity> {
        self.preparation.iter().flat_map(|preparation| preparation.drawn().iter().copied())
    }

    /// Returns the faults of the world at the moment of the last frame (the last instant, if the shutter was open) or
    /// [`seek`](Engine::seek), in document order: each entity that is not drawn or not used as given, the cause and the remedy. Empty
    /// before the first frame or seek.
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

    /// Returns the closest hit of a ray at the moment of the last frame (the last instant, if the shutter was open) or
    /// [`seek`](Engine::seek), exactly as the renderer computes it. `None` before the first frame or seek, for a ray that hits nothing, and
    /// for a ray without a direction.
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

    /// Casts many rays like [`cast`](Engine::cast), on the threads of the current rayon pool. The hits are in the order of the rays.
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

    /// Returns the ray tree of the first sample of the pixel in column `i` and row `j`. It is the only sample unless
    /// [`Sampling`](crate::components::Sampling) has more. See [`probe_sample`](Engine::probe_sample).
    #[doc(hidden)]
    #[must_use]
    pub fn probe(&self, i: u32, j: u32) -> Option<Probe<'_>> {
        self.probe_sample(i, j, 0)
    }

    /// Returns the ray tree of sample `index` of the pixel in column `i` and row `j`, traced by the reference path, at the moment of the
    /// last [`seek`](Engine::seek) or, if the shutter is open, [`seek_sample`](Engine::seek_sample). `None` before the first of them,
    /// outside the film, and for a sample that the pixel does not have.
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

    /// Returns the number and the choice of samples per pixel at the moment of the last frame or [`seek`](Engine::seek). `None` before the
    /// first frame or seek.
    #[must_use]
    pub fn sampling(&self) -> Option<trace::PixelSampling> {
        let sampling = self.preparation.as_ref()?.sampling(self.report.time);
        let samples = if self.left_out.contains(&Effect::Antialiasing) { 1 } else { sampling.samples };
        Some(trace::PixelSampling { samples, ..sampling })
    }

    /// Returns whether sampling is adaptive: see [`Sampling::max_error`](crate::components::Sampling::max_error).
    #[must_use]
    pub fn is_adaptive(&self) -> bool {
        let sampling = self.settings.sampling(sampling_settings(&self.world));
        sampling.max_error > 0.0 && !self.left_out.contains(&Effect::Antialiasing)
    }

    /// Returns the prepared data without the disabled effects.
    pub(super) fn shown(&self) -> Option<Cow<'_, Preparation>> {
        let mut shown = Cow::Borrowed(self.preparation.as_ref()?);
        for effect in &self.left_out {
            shown.to_mut().leave_out(*effect);
        }
        Some(shown)
    }

    /// Returns the effects that images may have if a scene needs them. The other disabled effects are already absent from the
    /// [shown](Engine::shown) data.
    pub(super) fn effects_left(&self) -> Effects {
        let lighting = match self.left_out.contains(&Effect::ClearShadows) {
            true => Lighting::Shadows,
            false => Lighting::ClearShadows,
        };
        Effects { lighting, ..Effects::ALL }
    }
}
