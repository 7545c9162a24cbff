//! The settings that decide between accuracy and time.

use super::settings::{linear_cutoff, sane_film, sane_sampling};
use crate::components::{AreaShape, FilmSettings, Quality, Sampling};

/// The settings of one frame that decide between accuracy and time, within their limits.
#[derive(Clone, Debug)]
pub(crate) struct FrameSettings {
    pub(crate) film: FilmSettings,
    pub(crate) sampling: Sampling,
    /// The most generations of rays, 1 or more.
    pub(crate) depth: u32,
    /// The cutoff in linear light, 0 or more.
    pub(crate) cutoff: f32,
    /// The samples of every light, 1 or more.
    pub(crate) light_samples: Vec<u32>,
}

/// Values in the place of a scene's own, by which accuracy is traded for time. `None` leaves the scene's; others are clamped to their
/// limits.
///
/// ```
/// use rayreel::components::FilmSettings;
/// use rayreel::{Engine, Knobs, Time, World};
///
/// let mut world = World::new();
/// world.spawn((FilmSettings { width: 8, height: 4, ..FilmSettings::default() },));
/// let mut engine = Engine::new(world);
/// engine.set_knobs(Knobs { samples: Some(16), ..Knobs::default() });
/// engine.render_at(Time::ZERO)?;
/// assert_eq!(engine.report().rays.camera, 8 * 4 * 16);
/// # Ok::<(), rayreel::EngineError>(())
/// ```
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Knobs {
    /// The film's columns and rows.
    pub size: Option<(u32, u32)>,
    /// Samples per pixel: [`Sampling::samples`].
    pub samples: Option<u32>,
    /// The error that pictures are meant to have: [`Sampling::max_error`].
    pub max_error: Option<f32>,
    /// The seed of all samples: [`Sampling::seed`].
    pub seed: Option<u64>,
    /// Instants while the shutter is open: [`Sampling::instants`].
    pub instants: Option<u32>,
    /// Samples of every light with a size, for each of a pixel's.
    pub light_samples: Option<u32>,
    /// Generations of rays: [`Quality::depth`].
    pub depth: Option<u32>,
    /// Steps of 8 bits below which rays are not traced: [`Quality::cutoff`].
    pub cutoff: Option<f32>,
}

impl Knobs {
    /// Returns the samples with what is turned of them.
    pub(crate) fn sampling(&self, own: Sampling) -> Sampling {
        sane_sampling(Sampling {
            samples: self.samples.unwrap_or(own.samples),
            max_error: self.max_error.unwrap_or(own.max_error),
            seed: self.seed.unwrap_or(own.seed),
            instants: self.instants.unwrap_or(own.instants),
            ..own
        })
    }

    /// Turns settings.
    pub(crate) fn turn(&self, settings: &mut FrameSettings) {
        settings.sampling = self.sampling(settings.sampling);
        if let Some((width, height)) = self.size {
            settings.film = sane_film(FilmSettings { width, height, ..settings.film });
        }
        if let Some(depth) = self.depth {
            settings.depth = depth.clamp(1, Quality::LARGEST_DEPTH);
        }
        if let Some(cutoff) = self.cutoff {
            settings.cutoff = linear_cutoff(cutoff, settings.film.transfer);
        }
        if let Some(samples) = self.light_samples {
            // Lights without a size are asked once, however many samples they have.
            settings.light_samples.fill(samples.clamp(1, AreaShape::LARGEST_SAMPLES));
        }
    }
}
