//! The engine: a world with its systems and its prepared data.

use std::path::Path;

use hecs::{Component, World};

use super::cast::{Hit, IntoRay, Ray};
use crate::color::Encoding;
use crate::scene::{LoadError, Scene, SceneScripts, SceneWarning, ScriptMistake, ScriptSources};
use crate::systems::{
    self, CloudFailure, Context, EffectiveSettings, Fault, FrameInstants, FrameReport, Interrupted,
    Preparation, RenderRequest, RenderSettings, ScriptFailure, Scripts, Simulation, Step, UnknownComponent,
};
use crate::time::{Time, Timeline};
use crate::trace::{Film, PreparedRay, RayTree, RenderedImage, SampleMemory, SharedRoundPolicy, Signals};

/// A world of entities that is rendered at any moment of its timeline.
///
/// # Simulation
///
/// Stepped systems simulate motion, as in the film of the [crate documentation](crate). Frames may be requested in any order: going back in time
/// replays the steps from the start and gives the same bits.
///
/// ```
/// use rayreel::components::{Ambient, FilmSettings, Material, Shape, Transform};
/// use rayreel::{Context, Engine, Rgb, Step, World};
///
/// let mut world = World::new();
/// let ball = world.spawn((Shape::Sphere { radius: 1.0 }, Material::matte(Rgb::ONE), Transform::IDENTITY));
/// world.spawn((FilmSettings::new(32, 18), Ambient(Rgb::ONE)));
/// let mut engine = Engine::new(world);
/// engine.add_stepped_system(Step::per_second(240), move |context: &mut Context<'_>| {
///     let dt = context.step_seconds();
///     context.world.get::<&mut Transform>(ball).unwrap().translation.y += dt * context.time.seconds();
///     context.changes.mark_transform(ball); // undeclared entities are not read again
/// });
///
/// let early = engine.render_frame(12)?;
/// let late = engine.render_frame(24)?;
/// assert_ne!(early, late);
/// assert_eq!(engine.render_frame(12)?, early); // back in time
/// assert_eq!(engine.render_frame(24)?, late);
/// # Ok::<(), rayreel::EngineError>(())
/// ```
pub struct Engine {
    /// The settings of rendering, which override the scene's own from the next frame on.
    pub settings: RenderSettings,
    /// The frame rate and the duration, from the next frame on.
    pub timeline: Timeline,
    /// The policy that chooses the samples of each round, for images with an error target. `None` uses the target alone.
    pub round_policy: Option<SharedRoundPolicy>,
    pub(super) simulation: Simulation,
    /// The sample buffers of the last image.
    memory: SampleMemory,
    report: FrameReport,
    script_sources: ScriptSources,
    scene_warnings: Vec<SceneWarning>,
}

/// The reason why a frame could not be rendered.
#[derive(thiserror::Error)]
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
    /// A cloud has no particles at a moment, because its file cannot be read or does not fit its settings.
    #[error("{0}")]
    Cloud(String),
    /// The image was cancelled, or stopped at a pause: see [`RenderRequest::signals`].
    #[error("rendering was cancelled")]
    Cancelled,
}

debug_as_message!(EngineError);

/// Returns a result, or `None` if it was cancelled.
pub(crate) fn unless_cancelled<T>(result: Result<T, EngineError>) -> Result<Option<T>, EngineError> {
    match result {
        Err(EngineError::Cancelled) => Ok(None),
        result => result.map(Some),
    }
}

impl Engine {
    /// Loads a scene file and creates an engine at its first moment.
    ///
    /// # Errors
    ///
    /// If the file cannot be read or has mistakes. The error lists all of them, each with position and remedy.
    pub fn load(path: impl AsRef<Path>) -> Result<Self, EngineError> {
        Ok(Self::from_scene(Scene::load(path.as_ref())?))
    }

    /// Creates an engine for a loaded scene.
    #[must_use]
    pub fn from_scene(scene: Scene) -> Self {
        let Scene { world, timeline, scripts, warnings, .. } = scene;
        let mut engine = Self::new(world);
        engine.start(timeline, scripts, warnings);
        engine
    }

    /// Starts with the timeline, the scripts and the warnings of a scene, after its world has been set.
    pub(super) fn start(&mut self, timeline: Timeline, scripts: SceneScripts, warnings: Vec<SceneWarning>) {
        let (scripts, sources) = scripts.into_parts();
        self.timeline = timeline;
        self.simulation.start(Scripts::new(scripts));
        self.script_sources = sources;
        self.scene_warnings = warnings;
    }

    /// Creates an engine for a world. Its [timeline](Engine::timeline) has 24 frames per second and a single frame. Frames beyond the end of
    /// the timeline can be rendered too. Missing parts of the world (a camera, film settings) have defaults.
    #[must_use]
    pub fn new(world: World) -> Self {
        Self {
            settings: RenderSettings::default(),
            timeline: Timeline::still(),
            round_policy: None,
            simulation: Simulation::new(world),
            memory: SampleMemory::default(),
            report: FrameReport::default(),
            script_sources: ScriptSources::default(),
            scene_warnings: Vec::new(),
        }
    }

    /// Adds a pure system: a function of time that writes to the world. Its writes are undone before every frame.
    pub fn add_system(&mut self, system: impl Fn(&mut Context<'_>) + Send + 'static) {
        self.simulation.rewind();
        self.simulation.schedule.add(system);
    }

    /// Adds a system that carries state from step to step. For the moment `t` the engine runs it `floor(t / step)` times, starting from a
    /// copy of the world at time 0. Going back in time starts over.
    pub fn add_stepped_system(&mut self, step: Step, system: impl Fn(&mut Context<'_>) + Send + 'static) {
        self.simulation.rewind();
        self.simulation.schedule.add_stepped(step, system);
    }

    /// Registers a custom component type as part of the state that is copied and restored. Custom systems require this for every custom
    /// component type.
    pub fn register<T: Component + Clone>(&mut self) {
        self.simulation.schedule.registry_mut().register::<T>();
    }

    /// Returns the world at the moment of the last frame. If the shutter was open, the world is at the last instant of the frame;
    /// [`seek`](Engine::seek) brings it to the frame's own moment.
    #[must_use]
    pub fn world(&self) -> &World {
        &self.simulation.world
    }

    /// Returns the world as it was at the start, before any step, for editing. The next frame reads the whole world again.
    pub fn world_mut(&mut self) -> &mut World {
        self.simulation.rewind();
        &mut self.simulation.world
    }

    /// Returns the scene's film, quality and sampling, with the [settings](Engine::settings) applied.
    #[must_use]
    pub fn effective_settings(&self) -> EffectiveSettings {
        self.settings.effective(self.world())
    }

    /// Returns the prepared data of the world at the moment of the last frame (the last instant, if the shutter was open) or
    /// [`seek`](Engine::seek). `None` before the first frame or seek.
    ///
    /// ```no_run
    /// use rayreel::Engine;
    ///
    /// let mut engine = Engine::load("scenes/fly_around.ron")?;
    /// let timeline = engine.timeline;
    /// for frame in 0..timeline.frame_count() {
    ///     engine.seek(timeline.time_of(frame))?;
    ///     if let Some(prepared) = engine.prepared() {
    ///         let camera = prepared.camera();
    ///         println!("{} looks along {}", camera.position(), camera.axes()[2]);
    ///     }
    /// }
    /// # Ok::<(), rayreel::EngineError>(())
    /// ```
    #[must_use]
    pub fn prepared(&self) -> Option<&Preparation> {
        self.simulation.preparation.as_ref()
    }

    /// Returns the faults of the world at the moment of the last frame (the last instant, if the shutter was open) or
    /// [`seek`](Engine::seek), in document order: each entity that is not drawn or not used as given, the cause and the remedy. Components
    /// that the whole world lacks, such as lights, are faults of the first shape. With debug assertions, the undeclared
    /// [changes](crate::Changes) of systems are faults too; finding them takes about as long as reading the world again. Empty before the
    /// first frame or seek.
    ///
    /// ```
    /// use rayreel::components::{Material, Shape, Transform};
    /// use rayreel::{Engine, Rgb, Time, World};
    ///
    /// let mut world = World::new();
    /// let clay = Material::matte(Rgb::ONE);
    /// let ball = world.spawn((Shape::Sphere { radius: -1.0 }, clay, Transform::IDENTITY));
    /// let mut engine = Engine::new(world);
    /// engine.seek(Time::ZERO)?;
    /// let faults = engine.faults();
    /// assert_eq!(faults[0].entity, ball);
    /// assert_eq!(faults[0].to_string(), "is not drawn: its radius is -1");
    /// assert_eq!(faults[0].remedy(), "keep it greater than 0");
    /// # Ok::<(), rayreel::EngineError>(())
    /// ```
    #[must_use]
    pub fn faults(&self) -> Vec<Fault> {
        let Some(prepared) = self.prepared() else { return Vec::new() };
        let mut faults = prepared.faults(self.world());
        // Without some effects, an image may be black as requested.
        if self.settings.without.is_empty() {
            faults.extend(systems::image_faults(self.world(), prepared, &self.report));
        }
        faults
    }

    /// Returns the [warnings](Scene::warnings) about the scene's files.
    #[must_use]
    pub fn scene_warnings(&self) -> &[SceneWarning] {
        &self.scene_warnings
    }

    /// Returns the report of the last frame.
    #[must_use]
    pub fn report(&self) -> &FrameReport {
        &self.report
    }

    /// Returns the closest hit of a ray at the moment of the last frame (the last instant, if the shutter was open) or
    /// [`seek`](Engine::seek), exactly as the renderer computes it for a ray from the camera, which does not hit shapes that are hidden from
    /// the camera. `None` before the first frame or seek, for a ray that hits nothing, and for a ray without a direction.
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
    ///     let next = hit.leave_towards(hit.normal); // starts on the surface, and never hits it through rounding
    ///     assert!(engine.cast(next).is_none_or(|next| next.distance > 0.0));
    /// }
    /// # Ok::<(), rayreel::EngineError>(())
    /// ```
    #[must_use]
    pub fn cast(&self, ray: impl IntoRay) -> Option<Hit> {
        let preparation = self.prepared()?;
        let (ray, exponent) = ray.into_ray()?;
        let surface = preparation.scene().cast(&ray)?;
        Some(Hit::new(preparation, &ray, exponent, surface))
    }

    /// Casts many rays like [`cast`](Engine::cast), on the threads of the current rayon pool. The hits are in the order of the rays.
    #[must_use]
    pub fn cast_all(&self, rays: &[Ray]) -> Vec<Option<Hit>> {
        let Some(preparation) = self.prepared() else {
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
                Some(Hit::new(preparation, ray.as_ref()?, exponent, surface))
            })
            .collect()
    }

    /// Renders frame `index` of the timeline, which may be beyond its end. The result does not depend on previously rendered frames.
    ///
    /// # Errors
    ///
    /// If custom systems need the world copied and it holds components that were not registered, or if a script fails.
    pub fn render_frame(&mut self, index: u32) -> Result<Film, EngineError> {
        Ok(self.render(self.timeline.time_of(index))?.film)
    }

    /// Renders an image: of a moment, or as a [`RenderRequest`] specifies. Afterwards the [report](Engine::report) describes it.
    ///
    /// ```
    /// use rayreel::{Engine, RenderRequest, Time, World};
    ///
    /// let mut engine = Engine::new(World::new());
    /// let film = engine.render(Time::ZERO)?.film;
    /// let reference = engine.render(RenderRequest { reference: true, ..RenderRequest::at(Time::ZERO) })?;
    /// assert_eq!(reference.film, film);
    /// # Ok::<(), rayreel::EngineError>(())
    /// ```
    ///
    /// # Errors
    ///
    /// As [`Engine::render_frame`], and [`EngineError::Cancelled`].
    pub fn render<'a, E: Encoding + 'a>(
        &mut self,
        request: impl Into<RenderRequest<'a, E>>,
    ) -> Result<RenderedImage<E::Pixel>, EngineError> {
        let request = request.into();
        let frame = self.frame(request.time, request.settings);
        let policy = self.round_policy.as_ref();
        self.report = FrameReport::at(request.time);
        let image = systems::render(
            &mut self.simulation,
            &frame,
            request,
            policy,
            &mut self.memory,
            &mut self.report,
        );
        image.map_err(|interrupted| self.error(interrupted))
    }

    /// Plans an image without rendering it. The returned report has the [plan](FrameReport::plan) and, if requested, the
    /// [fingerprint](FrameReport::fingerprint) that the image would have. Brings the world to the moment or, if the shutter is open, to one
    /// of the frame's instants.
    ///
    /// # Errors
    ///
    /// As [`Engine::render`].
    pub fn plan<'a, E: Encoding + 'a>(
        &mut self,
        request: impl Into<RenderRequest<'a, E>>,
    ) -> Result<&FrameReport, EngineError> {
        let request = request.into();
        let frame = self.frame(request.time, request.settings);
        let policy = self.round_policy.as_ref();
        self.report = FrameReport::at(request.time);
        let planned = systems::plan(&mut self.simulation, &frame, &request, policy, &mut self.report);
        planned.map_err(|interrupted| self.error(interrupted))?;
        Ok(&self.report)
    }

    /// Advances the world and the kernel's data to a moment, without rendering.
    ///
    /// # Errors
    ///
    /// As [`Engine::render_frame`].
    pub fn seek(&mut self, time: Time) -> Result<(), EngineError> {
        let frame = self.frame(time, None);
        self.report = FrameReport::at(time);
        let never = Signals::none().cancelled;
        let sought = self.simulation.advance_to(time, &frame, &mut self.report, never);
        sought.map(drop).map_err(|interrupted| self.error(interrupted))
    }

    /// Advances the world to a moment, without the kernel's data, which stay those of another moment.
    #[cfg(feature = "live")]
    pub(crate) fn advance(&mut self, time: Time) -> Result<(), EngineError> {
        let advanced = self.simulation.advance_world(time, Signals::none().cancelled);
        advanced.map_err(|interrupted| self.error(interrupted))
    }

    /// Returns the ray tree of sample `index` of the pixel in column `i` and row `j` at a moment, traced by the reference path. `None`
    /// outside the film, and for a sample that the pixel does not have. The [report](Engine::report) of the last image is kept.
    ///
    /// # Errors
    ///
    /// As [`Engine::render_frame`].
    pub fn probe(
        &mut self,
        time: Time,
        pixel: (u32, u32),
        index: u32,
    ) -> Result<Option<RayTree>, EngineError> {
        let frame = self.frame(time, None);
        let tree = systems::trace_sample(&mut self.simulation, &frame, pixel, index);
        tree.map_err(|interrupted| self.error(interrupted))
    }

    /// Returns the ray tree of any ray at a moment, traced by the reference path: the rays that follow from it, and their light. Area lights
    /// are sampled as for the first sample of the first pixel. `None` if a number of the ray is not finite or its direction is zero.
    ///
    /// # Errors
    ///
    /// As [`Engine::render_frame`].
    pub fn probe_ray(&mut self, time: Time, ray: Ray) -> Result<Option<RayTree>, EngineError> {
        let Some(ray) = PreparedRay::new(ray.origin, ray.direction) else { return Ok(None) };
        let frame = self.frame(time, None);
        let tree = systems::trace_ray(&mut self.simulation, &frame, ray);
        tree.map_err(|interrupted| self.error(interrupted))
    }

    /// Returns the frame at a moment, with the engine's settings unless others are given.
    fn frame(&mut self, time: Time, settings: Option<RenderSettings>) -> FrameInstants {
        self.simulation.frame(time, self.timeline, settings.unwrap_or(self.settings))
    }

    /// Returns the error for an interruption.
    fn error(&self, interrupted: Interrupted) -> EngineError {
        match interrupted {
            Interrupted::Cancelled => EngineError::Cancelled,
            Interrupted::UnknownComponent(unknown) => EngineError::UnknownComponent(unknown),
            Interrupted::Cloud(failure) => {
                let CloudFailure { cloud, seconds, message } = *failure;
                EngineError::Cloud(format!("{cloud} at t = {seconds}: {message}"))
            }
            Interrupted::Script(failure) => {
                let ScriptFailure { script, channel, seconds, error } = *failure;
                let about = format!("{channel} at t = {seconds}");
                EngineError::Script(self.script_sources.mistake(script, &about, &error))
            }
        }
    }
}
