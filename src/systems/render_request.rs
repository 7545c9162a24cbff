//! Requests to render an image.

use std::fmt;
use std::ops::ControlFlow;
use std::sync::Arc;

use super::RenderSettings;
use crate::color::{Encoding, Linear};
use crate::time::Time;
use crate::trace::{RenderJob, ReusablePicture, Signals};

/// A request to render an image.
///
/// ```
/// use rayreel::{Engine, RenderRequest, RenderSettings, Time, World};
///
/// let mut engine = Engine::new(World::new());
/// let small = RenderSettings { size: Some((4, 3)), ..engine.settings };
/// let request = RenderRequest { alpha: true, settings: Some(small), ..RenderRequest::at(Time::ZERO) };
/// let image = engine.render(request)?;
/// assert!(image.alpha.unwrap().pixels().iter().all(|alpha| *alpha == 0.0)); // an empty world covers nothing
/// # Ok::<(), rayreel::EngineError>(())
/// ```
///
/// # Passes
///
/// Passes are the first hit of the ray through the centre of each pixel.
///
/// ```
/// use rayreel::components::{Camera, FilmSettings, Material, Shape, Transform};
/// use rayreel::{Engine, RenderRequest, Rgb, Time, World};
///
/// let mut world = World::new();
/// let clay = Material::matte(Rgb::ONE);
/// world.spawn((Shape::Sphere { radius: 1.0 }, clay, Transform::default()));
/// world.spawn((Camera::default(),));
/// world.spawn((FilmSettings::new(3, 3),));
/// let request = RenderRequest { passes: true, ..RenderRequest::at(Time::ZERO) };
/// let centre = Engine::new(world).render(request)?.passes.unwrap().pixel(1, 1);
/// assert_eq!((centre.depth, centre.normal, centre.id), (4.0, [0.0, 0.0, -1.0], 1));
/// # Ok::<(), rayreel::EngineError>(())
/// ```
///
/// # Pauses
///
/// At every pause that the signals request, `on_pause` is called and decides whether to continue. If it stops, `resume` keeps the samples
/// traced so far. A later request with the same `resume` continues and gives the same bits, provided that neither the moment, the settings
/// nor the world has changed. Passes are computed after the last sample: if that is cancelled, the samples are lost.
///
/// ```
/// use std::ops::ControlFlow::Break;
/// use rayreel::trace::Signals;
/// use rayreel::{Engine, EngineError, RenderRequest, Time, World};
///
/// let mut engine = Engine::new(World::new());
/// let (mut job, at_once) = (None, Signals { pause: &|| true, ..Signals::none() });
/// let paused = RenderRequest {
///     signals: at_once,
///     on_pause: Some(&mut |_| Break(())),
///     resume: Some(&mut job),
///     ..RenderRequest::at(Time::ZERO)
/// };
/// assert!(matches!(engine.render(paused), Err(EngineError::Cancelled)));
///
/// let resumed = RenderRequest { resume: Some(&mut job), ..RenderRequest::at(Time::ZERO) };
/// assert_eq!(engine.render(resumed)?.film, engine.render_frame(0)?);
/// # Ok::<(), rayreel::EngineError>(())
/// ```
///
/// # Reuse
///
/// After an edit, the parts of an image that the edit cannot reach are taken from the former one.
///
/// ```
/// use rayreel::{Engine, RenderRequest, Scene, Time};
///
/// let text = |color: &str| {
///     format!(
///         r#"(
///             film: (width: 96, height: 64), camera: (position: (0, 0, -5), target: (0, 0, 0)), ambient: (1, 1, 1),
///             entities: [(shape: Sphere(radius: 0.3), color: "{color}"), (shape: Sphere(radius: 1), color: (200, 200, 200), transform: (translation: (0, 0, 2)))],
///         )"#
///     )
/// };
/// let scene = |color: &str| Scene::from_text("balls.ron", text(color));
/// let mut engine = Engine::from_scene(scene("#ff0000")?);
/// let mut former = None;
/// engine.render(RenderRequest { reuse: Some(&mut former), ..RenderRequest::at(Time::ZERO) })?;
///
/// engine.reload(scene("#0000ff")?);
/// let edited = engine.render(RenderRequest { reuse: Some(&mut former), ..RenderRequest::at(Time::ZERO) })?;
/// assert!(engine.report().reused > 0.5);
/// assert_eq!(edited.film, Engine::from_scene(scene("#0000ff")?).render_frame(0)?);
/// # Ok::<(), Box<dyn std::error::Error>>(())
/// ```
pub struct RenderRequest<'a, E: Encoding = Linear> {
    /// The moment.
    pub time: Time,
    /// The encoding of the pixels: linear light, or output bytes by a [`Transfer`](crate::color::Transfer). The bytes are the same as from
    /// the [encoded](crate::Film::encoded) linear film, and take less time and memory.
    pub encoding: E,
    /// True for an image with an alpha channel and without its background. With an error target, the error of alpha counts like the error
    /// of light.
    pub alpha: bool,
    /// True for the reference path, which tests every ray against every shape. It is slow and single-threaded, has no pauses and no ray
    /// counts, and gives the same bits.
    pub reference: bool,
    /// True if the image gets the passes: see [`RenderedImage::passes`](crate::RenderedImage::passes).
    pub passes: bool,
    /// True if the image gets the number of samples of each pixel: see
    /// [`RenderedImage::sample_counts`](crate::RenderedImage::sample_counts).
    pub sample_counts: bool,
    /// True if the report gets the statistics of each tile: see [`FrameReport::tile_stats`](super::FrameReport::tile_stats).
    pub tile_stats: bool,
    /// The settings. `None` uses the engine's.
    pub settings: Option<RenderSettings>,
    /// True if the report gets the image's fingerprint, which takes time if there are many shapes.
    pub fingerprint: bool,
    /// The signals that cancel or pause rendering.
    pub signals: Signals<'a>,
    /// The function that decides at each pause whether to continue. `None` continues.
    pub on_pause: Option<OnPause<'a, E>>,
    /// The samples of the unfinished image, if it was stopped at a pause.
    pub resume: Option<&'a mut Option<RenderJob<E>>>,
    /// A former image, of which the tiles are reused that no change of the scene can reach; it is replaced by this image. The bits are the same as
    /// without, and so are the numbers of rays: only the time differs, see [`FrameReport::reused`](super::FrameReport::reused). Images with
    /// an error target, of more than 131072 shapes in all instants, or of several instants of custom systems are rendered in full; they do
    /// not replace the former image.
    pub reuse: Option<&'a mut Option<Arc<ReusablePicture<E>>>>,
}

/// The function that decides, from the samples so far, whether to continue after a pause.
pub type OnPause<'a, E = Linear> = &'a mut dyn FnMut(&RenderJob<E>) -> ControlFlow<()>;

impl RenderRequest<'_> {
    /// Creates a request for linear light, with the engine's settings, without pauses.
    #[must_use]
    pub fn at(time: Time) -> Self {
        Self::encoded(time, Linear)
    }
}

impl<E: Encoding> RenderRequest<'_, E> {
    /// Creates a request for pixels with this encoding, with the engine's settings, without pauses.
    #[must_use]
    pub fn encoded(time: Time, encoding: E) -> Self {
        Self {
            time,
            encoding,
            alpha: false,
            reference: false,
            passes: false,
            sample_counts: false,
            tile_stats: false,
            settings: None,
            fingerprint: true,
            signals: Signals::none(),
            on_pause: None,
            resume: None,
            reuse: None,
        }
    }
}

impl From<Time> for RenderRequest<'_> {
    fn from(time: Time) -> Self {
        Self::at(time)
    }
}

impl<E: Encoding + fmt::Debug> fmt::Debug for RenderRequest<'_, E> {
    fn fmt(&self, formatter: &mut fmt::Formatter<'_>) -> fmt::Result {
        formatter
            .debug_struct("RenderRequest")
            .field("time", &self.time)
            .field("encoding", &self.encoding)
            .field("alpha", &self.alpha)
            .field("reference", &self.reference)
            .field("passes", &self.passes)
            .field("sample_counts", &self.sample_counts)
            .field("tile_stats", &self.tile_stats)
            .field("settings", &self.settings)
            .finish_non_exhaustive()
    }
}
