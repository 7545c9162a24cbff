//! Settings of the whole scene. A world has at most one of each; if there are several, the first in document order is used.

use glam::DVec3;

use super::AreaShape;
use crate::color::{ColorRamp, ErrorNorm, Rgb, Transfer};

/// The intensity I_a of the ambient light, constant everywhere.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Ambient(pub Rgb);

/// The occlusion of ambient light. A point receives the share of the ambient light that arrives from the half space in front of its
/// surface without meeting a shape within a distance, weighted by the cosine of its angle to the normal. Transparent shapes transmit ambient
/// light like that of a light source.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct AmbientOcclusion {
    /// The number of directions that are tested per point, 1..=[`AmbientOcclusion::LARGEST_SAMPLES`].
    pub samples: u32,
    /// The distance in scene units up to which shapes occlude, greater than 0.
    pub distance: f64,
}

impl AmbientOcclusion {
    /// The default number of samples.
    pub const DEFAULT_SAMPLES: u32 = 8;
    /// The maximum number of samples.
    pub const LARGEST_SAMPLES: u32 = AreaShape::LARGEST_SAMPLES;
}

/// The radiance of a ray that hits nothing.
#[derive(Clone, Copy, Debug, PartialEq)]
#[expect(
    clippy::large_enum_variant,
    reason = "a scene has one background, which is copied like other settings"
)]
pub enum Background {
    /// A constant radiance in all directions.
    Flat(Rgb),
    /// A gradient along the world's y axis. In a direction of unit length without a `horizon`, `top` has the weight (1 + y) / 2 and
    /// `bottom` the rest. With a `horizon`, `top` or, below, `bottom` has the weight |y| and `horizon` the rest.
    Gradient {
        /// The radiance straight down, -y.
        bottom: Rgb,
        /// The radiance of level directions, with y = 0; `None` for the mean of `bottom` and `top`.
        horizon: Option<Rgb>,
        /// The radiance straight up, +y.
        top: Rgb,
    },
    /// A gradient along the world's y axis with stops at values of y of the unit direction, -1..=1.
    Stops(ColorRamp),
}

impl Default for Background {
    /// Returns black.
    fn default() -> Self {
        Self::Flat(Rgb::ZERO)
    }
}

/// Fog. Over a length l in uniform fog, the fraction exp(-density l) of the light from behind is transmitted, and the fog's colour
/// contributes the remaining fraction. In fog with a `height`, density times length becomes the integral of the density along the ray.
///
/// Fog attenuates camera, reflection and refraction rays, but not shadow rays. A ray that hits nothing is infinitely long: with a density
/// above 0, it sees only fog, unless it rises out of fog with a height or `hides_background` is false.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Fog {
    /// The colour of fog of infinite depth.
    pub color: Rgb,
    /// The density per scene unit of length in the world, 0 or more; 0 disables fog.
    pub density: f64,
    /// The height in scene units over which the density falls to 1/e, greater than 0: at y, the density is multiplied by
    /// exp(-(y - level) / height). `None` for uniform fog.
    pub height: Option<f64>,
    /// The y in the world at which fog with a height has its density.
    pub level: f64,
    /// False if rays that hit nothing see the background without fog.
    pub hides_background: bool,
}

impl Fog {
    /// Creates uniform fog.
    #[must_use]
    pub fn new(color: Rgb, density: f64) -> Self {
        Self { color, density, height: None, level: 0.0, hides_background: true }
    }
}

impl Default for Fog {
    /// Returns fog without density.
    fn default() -> Self {
        Self::new(Rgb::ZERO, 0.0)
    }
}

/// The orientation of the axes, as a viewer sees them who looks along z with x to the right and y up.
///
/// It determines which direction is to the right of a camera, and nothing else: shapes, rotations and light have the same formulas in both
/// spaces. A scene with all z coordinates negated, in the other space, gives the same image.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub enum Space {
    /// The z axis points away from the viewer: to the right is up x view.
    #[default]
    LeftHanded,
    /// The z axis points towards the viewer: to the right is view x up.
    RightHanded,
}

/// A sun in the sky: a disc with a soft edge and a halo, added to the [`Background`]. It lights no surface.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Sun {
    /// The direction towards the sun in the world, of any length except zero: opposite to the direction of its light.
    pub direction: DVec3,
    /// The radiance of the disc, 0 or more.
    pub intensity: Rgb,
    /// The diameter in radians, greater than 0 and at most pi.
    pub size: f64,
    /// The radiance of the halo at the edge of the disc as a fraction of the intensity, 0 to 1.
    pub glow: f64,
    /// The angle from the edge over which the halo falls to 1/e, in radians, greater than 0 and at most pi.
    pub glow_size: f64,
}

impl Sun {
    /// Creates a sun of half a degree without a halo.
    #[must_use]
    pub fn new(direction: DVec3, intensity: Rgb) -> Self {
        let [size, glow_size] = [0.5_f64, 10.0].map(f64::to_radians);
        Self { direction, intensity, size, glow: 0.0, glow_size }
    }
}

impl Default for Sun {
    /// Returns a sun without light.
    fn default() -> Self {
        Self::new(DVec3::Y, Rgb::ZERO)
    }
}

/// Stars in all directions, added to the [`Background`]. They light no surface.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Stars {
    /// The approximate number of stars in the whole sky, 1..=[`Self::LARGEST_COUNT`].
    pub count: u32,
    /// The radiance of the middle of the brightest star, 0 or more. The faintest has 13 % of it.
    pub intensity: Rgb,
    /// The diameter in radians, greater than 0 and at most pi. Stars that are too large for their number are made smaller.
    pub size: f64,
    /// The seed of their places and brightnesses.
    pub seed: u64,
}

impl Stars {
    /// The maximum number of stars.
    pub const LARGEST_COUNT: u32 = 1_000_000;
}

impl Default for Stars {
    /// Returns 3000 stars, about as many as the eye sees on a clear night, with a diameter of a fifth of a degree.
    fn default() -> Self {
        Self { count: 3000, intensity: Rgb::ONE, size: 0.2_f64.to_radians(), seed: 0 }
    }
}

/// The size and the encoding of the image.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct FilmSettings {
    /// The number of columns, 1..=[`Self::LARGEST_SIDE`].
    pub width: u32,
    /// The number of rows, 1..=[`Self::LARGEST_SIDE`].
    pub height: u32,
    /// The conversion from linear light to bytes.
    pub transfer: Transfer,
}

impl FilmSettings {
    /// The maximum number of columns or rows.
    pub const LARGEST_SIDE: u32 = 32_768;
    /// The maximum number of pixels, 2^28: about 3 GB of film.
    pub const LARGEST_AREA: u64 = 1 << 28;

    /// Creates settings for sRGB images of `width` columns and `height` rows.
    #[must_use]
    pub fn new(width: u32, height: u32) -> Self {
        Self { width, height, transfer: Transfer::Srgb }
    }
}

impl Default for FilmSettings {
    /// Returns settings for sRGB images of 640 columns and 360 rows.
    fn default() -> Self {
        Self::new(640, 360)
    }
}

/// The number and the choice of samples per pixel.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Sampling {
    /// The number of samples per pixel, 1..=[`Self::LARGEST_COUNT`]. A single sample is at the pixel's centre. Several samples are
    /// distributed over the pixel, whose colour is their mean. With a `max_error` this is the maximum number per pixel, and 1 means no
    /// limit.
    pub samples: u32,
    /// The minimum number of samples per pixel with a `max_error`, 1..=[`Self::LARGEST_COUNT`]; at most `samples`.
    pub min_samples: u32,
    /// The target for the image error in the `norm`, in 8-bit levels, 0..=[`Self::LARGEST_ERROR`]. Samples are added where needed until the
    /// estimated error, [`FrameReport::error`](crate::FrameReport::error), meets the target. 0 gives all pixels the same number of samples.
    pub max_error: f32,
    /// The norm of `max_error`.
    pub norm: ErrorNorm,
    /// The seed of the sample patterns.
    pub seed: u64,
    /// The relation between the samples of different frames.
    pub noise: Noise,
    /// The maximum number of instants at which the scene is rendered while the shutter is open, 1..=[`Self::LARGEST_INSTANTS`]; never more
    /// than the number of samples. With a `max_error`, the number of instants is adaptive, up to 256. See
    /// [`Camera::shutter`](super::Camera::shutter).
    pub instants: u32,
}

/// The relation between the noise of different frames.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub enum Noise {
    /// All frames have the same samples, so that static content does not flicker.
    #[default]
    Fixed,
    /// Every moment has its own samples, so that noise averages out to the eye. They are a function of the seed and the exact time.
    PerFrame,
}

impl Sampling {
    /// The maximum number of samples per pixel.
    pub const LARGEST_COUNT: u32 = 65_536;
    /// The largest error: the whole range of 8-bit output.
    pub const LARGEST_ERROR: f32 = 255.0;
    /// The maximum number of instants while the shutter is open.
    pub const LARGEST_INSTANTS: u32 = 256;

    /// Returns whether sampling is adaptive: pixels have different numbers of samples, as many as the error target requires.
    #[must_use]
    pub fn is_adaptive(&self) -> bool {
        self.max_error > 0.0
    }
}

impl Default for Sampling {
    fn default() -> Self {
        Self {
            samples: 1,
            min_samples: 1,
            max_error: 0.0,
            norm: ErrorNorm::Rms,
            seed: 0,
            noise: Noise::Fixed,
            instants: 16,
        }
    }
}

/// The depth and the cutoff of ray tracing.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Quality {
    /// The maximum ray depth: 1 traces camera rays only, 5 allows four reflections. A ray beyond it sees the background.
    pub depth: u32,
    /// The cutoff in 8-bit levels, 0..=[`Self::LARGEST_CUTOFF`]. Rays whose contributions to a pixel are certain to sum to less than the
    /// cutoff are not traced; 0 traces all rays.
    pub cutoff: f32,
}

impl Quality {
    /// The maximum ray depth.
    pub const LARGEST_DEPTH: u32 = 1000;
    /// The largest cutoff: the whole range of 8-bit output.
    pub const LARGEST_CUTOFF: f32 = 255.0;
}

impl Default for Quality {
    fn default() -> Self {
        Self { depth: 5, cutoff: 0.25 }
    }
}
