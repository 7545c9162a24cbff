//! The settings that trade accuracy for time.

use super::settings::{linear_cutoff, sane_film, sane_sampling};
use crate::components::{AreaShape, FilmSettings, Quality, Sampling};

/// The settings of one frame that trade accuracy for time, clamped to their limits.
#[derive(Clone, Debug)]
pub(crate) struct FrameSettings {
    pub(crate) film: FilmSettings,
    pub(crate) sampling: Sampling,
    /// The maximum ray depth, 1 or more.
    pub(crate) depth: u32,
    /// The cutoff in linear light, 0 or more.
    pub(crate) cutoff: f32,
    /// The number of samples of each light, 1 or more.
    pub(crate) light_samples: Vec<u32>,
}

/// Render settings that override the scene's own and trade accuracy for time. `None` keeps the scene's value; other values are clamped to
/// their limits.
///
/// ```
/// use rayreel::components::FilmSettings;
/// use rayreel::{Engine, RenderSettings, Time, World};
///
/// let mut world = World::new();
/// world.spawn((FilmSettings { width: 8, height: 4, ..FilmSettings::default() },));
/// let mut engine = Engine::new(world);
/// engine.set_render_settings(RenderSettings { samples: Some(16), ..RenderSettings::default() });
/// engine.render_at(Time::ZERO)?;
/// assert_eq!(engine.report().rays.camera, 8 * 4 * 16);
/// # Ok::<(), rayreel::EngineError>(())
/// ```
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct RenderSettings {
    /// The number of columns and rows of the film.
    pub size: Option<(u32, u32)>,
    /// The number of samples per pixel: [`Sampling::samples`].
    pub samples: Option<u32>,
    /// The target for the image error: [`Sampling::max_error`].
    pub max_error: Option<f32>,
    /// The seed of all samples: [`Sampling::seed`].
    pub seed: Option<u64>,
    /// The maximum number of instants while the shutter is open: [`Sampling::instants`].
    pub instants: Option<u32>,
    /// The number of samples of each area light per lit point.
    pub light_samples: Option<u32>,
    /// The maximum ray depth: [`Quality::depth`].
    pub depth: Option<u32>,
    /// The cutoff in 8-bit levels: [`Quality::cutoff`].
    pub cutoff: Option<f32>,
}

impl RenderSettings {
    /// Returns the sampling with the overrides applied.
    pub(crate) fn sampling(&self, own: Sampling) -> Sampling {
        sane_sampling(Sampling {
            samples: self.samples.unwrap_or(own.samples),
            max_error: self.max_error.unwrap_or(own.max_error),
            seed: self.seed.unwrap_or(own.seed),
            instants: self.instants.unwrap_or(own.instants),
            ..own
        })
    }

    /// Applies the overrides to the settings.
    pub(crate) fn apply(&self, settings: &mut FrameSettings) {
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
            // Lights without an extent take one sample, regardless of this number.
            settings.light_samples.fill(samples.clamp(1, AreaShape::LARGEST_SAMPLES));
        }
    }
}
