//! The settings that trade accuracy for time.

use glam::DVec3;
use hecs::World;

use super::settings::{
    film_settings, linear_cutoff, quality_settings, sampling_settings, sane_film, sane_quality, sane_sampling,
};
use crate::components::{AreaShape, FilmSettings, Quality, Sampling};
use crate::systems::{Effect, EffectSet};
use crate::trace::{Precision, SimdLevel};

/// The settings of one frame that trade accuracy for time, clamped to their limits.
#[derive(Clone, Debug)]
pub(crate) struct FrameSettings {
    pub(crate) film: FilmSettings,
    pub(crate) viewpoint: Option<Viewpoint>,
    pub(crate) sampling: Sampling,
    /// The maximum ray depth, 1 or more.
    pub(crate) depth: u32,
    /// The cutoff in linear light, 0 or more.
    pub(crate) cutoff: f32,
    /// The settings of each light.
    pub(crate) lights: Vec<LightSettings>,
    /// The number of samples of ambient occlusion, 1 or more.
    pub(crate) ambient_samples: u32,
}

/// The settings of a light.
#[derive(Clone, Copy, Debug)]
pub(crate) struct LightSettings {
    /// The number of samples, 1 or more.
    pub(crate) samples: u32,
    pub(crate) casts_shadows: bool,
}

/// The film, the quality and the sampling of a scene, with [`RenderSettings`] applied and clamped to their limits.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct EffectiveSettings {
    /// The size and the encoding of the film.
    pub film: FilmSettings,
    /// The maximum ray depth and the cutoff.
    pub quality: Quality,
    /// The number and the choice of samples per pixel. If sampling is [adaptive](Sampling::is_adaptive), `samples` is the maximum.
    pub sampling: Sampling,
}

/// A view in place of that of the active camera, in the space of the world. The projection, the lens, the roll and the shutter stay those of
/// the camera.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Viewpoint {
    /// The position of the eye.
    pub position: DVec3,
    /// The point that is looked at.
    pub target: DVec3,
    /// The direction that is up in the image.
    pub up: DVec3,
}

/// Settings of rendering. `None` keeps the scene's own value; other values are clamped to their limits.
///
/// ```
/// use rayreel::components::FilmSettings;
/// use rayreel::{Engine, World};
///
/// let mut world = World::new();
/// world.spawn((FilmSettings::new(8, 4),));
/// let mut engine = Engine::new(world);
/// engine.settings.samples = Some(16);
/// engine.render_frame(0)?;
/// assert_eq!(engine.report().rays.camera, 8 * 4 * 16);
/// # Ok::<(), rayreel::EngineError>(())
/// ```
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct RenderSettings {
    /// The view in place of that of the active camera.
    pub view: Option<Viewpoint>,
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
    /// The number of samples of each area light, and of ambient occlusion, per point.
    pub light_samples: Option<u32>,
    /// The maximum number of samples of each area light, and of ambient occlusion, per point.
    pub max_light_samples: Option<u32>,
    /// The maximum ray depth: [`Quality::depth`].
    pub depth: Option<u32>,
    /// The cutoff in 8-bit levels: [`Quality::cutoff`].
    pub cutoff: Option<f32>,
    /// Disabled effects, even if the scene needs them. Without the shadows of transparent objects, these objects occlude lights like opaque
    /// ones.
    pub without: EffectSet,
    /// True if all other effects are rendered, even those that the scene does not need. This is slower and gives the same bits; it is meant
    /// for comparisons.
    pub all_effects: bool,
    /// The precision of intersections. `None` is robust precision; the other values are for comparisons with naive formulas.
    pub precision: Option<Precision>,
    /// The SIMD level, for comparisons: images are the same at all levels. `None` is the best level that the processor supports.
    pub simd: Option<SimdLevel>,
}

impl RenderSettings {
    /// Returns the settings of a draft of a film: sides divided by `divisor`, at least one pixel each, and one sample per pixel, at the
    /// frame's own moment and through the centre of the lens.
    #[must_use]
    pub fn draft(film: FilmSettings, divisor: u32) -> Self {
        let side = |pixels: u32| (pixels / divisor.max(1)).max(1);
        Self {
            size: Some((side(film.width), side(film.height))),
            samples: Some(1),
            max_error: Some(0.0),
            ..Self::default()
        }
    }

    /// Returns these settings, with every `None` replaced by the value of `base`. Effects that either of them disables are disabled.
    #[must_use]
    pub fn or(self, base: Self) -> Self {
        Self {
            view: self.view.or(base.view),
            size: self.size.or(base.size),
            samples: self.samples.or(base.samples),
            max_error: self.max_error.or(base.max_error),
            seed: self.seed.or(base.seed),
            instants: self.instants.or(base.instants),
            light_samples: self.light_samples.or(base.light_samples),
            max_light_samples: self.max_light_samples.or(base.max_light_samples),
            depth: self.depth.or(base.depth),
            cutoff: self.cutoff.or(base.cutoff),
            without: self.without.iter().chain(base.without.iter()).collect(),
            all_effects: self.all_effects || base.all_effects,
            precision: self.precision.or(base.precision),
            simd: self.simd.or(base.simd),
        }
    }

    /// Returns the settings of the world with the overrides applied.
    pub(crate) fn effective(&self, world: &World) -> EffectiveSettings {
        EffectiveSettings {
            film: self.film(film_settings(world)),
            quality: self.quality(quality_settings(world)),
            sampling: self.sampling(sampling_settings(world)),
        }
    }

    /// Returns the film settings with the overrides applied.
    pub(crate) fn film(&self, own: FilmSettings) -> FilmSettings {
        let (width, height) = self.size.unwrap_or((own.width, own.height));
        sane_film(FilmSettings { width, height, ..own })
    }

    /// Returns the depth and the cutoff with the overrides applied.
    pub(crate) fn quality(&self, own: Quality) -> Quality {
        sane_quality(Quality {
            depth: self.depth.unwrap_or(own.depth),
            cutoff: self.cutoff.unwrap_or(own.cutoff),
        })
    }

    /// Returns the sampling with the overrides applied.
    pub(crate) fn sampling(&self, own: Sampling) -> Sampling {
        let (samples, max_error) = match self.without.contains(Effect::Antialiasing) {
            true => (1, 0.0),
            false => (self.samples.unwrap_or(own.samples), self.max_error.unwrap_or(own.max_error)),
        };
        sane_sampling(Sampling {
            samples,
            max_error,
            seed: self.seed.unwrap_or(own.seed),
            instants: self.instants.unwrap_or(own.instants),
            ..own
        })
    }

    /// Applies the overrides to the settings.
    pub(crate) fn apply(&self, settings: &mut FrameSettings) {
        settings.sampling = self.sampling(settings.sampling);
        settings.film = self.film(settings.film);
        settings.viewpoint = self.view;
        if let Some(depth) = self.depth {
            settings.depth = depth.clamp(1, Quality::LARGEST_DEPTH);
        }
        if let Some(cutoff) = self.cutoff {
            settings.cutoff = linear_cutoff(cutoff, settings.film.transfer);
        }
        let most = self.max_light_samples.map_or(AreaShape::LARGEST_SAMPLES, |most| most.max(1));
        let samples =
            |own: u32| self.light_samples.unwrap_or(own).clamp(1, most.min(AreaShape::LARGEST_SAMPLES));
        settings.ambient_samples = samples(settings.ambient_samples);
        for light in &mut settings.lights {
            // Lights without an extent take one sample, regardless of this number.
            light.samples = samples(light.samples);
            light.casts_shadows &= !self.without.contains(Effect::Shadows);
        }
    }
}
