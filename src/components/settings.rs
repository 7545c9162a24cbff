//! Settings of the whole scene. A world has at most one of each; the first in document order counts.

use crate::color::{ErrorNorm, Rgb, Transfer};

/// The ambient light's intensity I_a, the same everywhere.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Ambient(pub Rgb);

/// The radiance of a ray that hits nothing.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Background {
    /// The same in all directions.
    Flat(Rgb),
    /// A blend along the world's y axis: in a direction of unit length, (1 + y) / 2 of it is the top.
    Gradient {
        /// Straight down, -y.
        bottom: Rgb,
        /// Straight up, +y.
        top: Rgb,
    },
}

impl Default for Background {
    /// Returns black.
    fn default() -> Self {
        Self::Flat(Rgb::ZERO)
    }
}

/// Fog everywhere: over a length l, exp(-density l) of what is behind is seen, and the fog's colour makes up the rest.
///
/// It attenuates camera, reflection and refraction rays, but not shadow rays. With a density above 0, a ray that hits nothing
/// sees only fog.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Fog {
    /// The colour of fog of infinite depth.
    pub color: Rgb,
    /// Per scene unit of length in the world, 0 or more; 0 is no fog.
    pub density: f64,
}

/// The picture's size and encoding.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct FilmSettings {
    /// Columns, 1..=[`Self::LARGEST_SIDE`].
    pub width: u32,
    /// Rows, 1..=[`Self::LARGEST_SIDE`].
    pub height: u32,
    /// The conversion from linear light to bytes.
    pub transfer: Transfer,
}

impl FilmSettings {
    /// The most columns or rows.
    pub const LARGEST_SIDE: u32 = 32_768;
    /// The most pixels, 2^28: about 3 GB of film.
    pub const LARGEST_AREA: u64 = 1 << 28;
}

impl Default for FilmSettings {
    fn default() -> Self {
        Self { width: 640, height: 360, transfer: Transfer::default() }
    }
}

/// The number of samples per pixel, and their choice.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Sampling {
    /// Samples per pixel, 1..=[`Self::LARGEST_COUNT`]. A single sample is in the pixel's centre; several are spread over the
    /// pixel, which is their mean. With a `max_error`, the most that a pixel gets; 1 sets no limit then.
    pub samples: u32,
    /// The fewest samples of a pixel with a `max_error`, 1..=[`Self::LARGEST_COUNT`], though not more than `samples`.
    pub min_samples: u32,
    /// The target for the picture's error in the `norm`, in steps of 8-bit output, 0..=[`Self::LARGEST_ERROR`]. Samples are added where they are needed until the estimate of the error, [`FrameReport::error`](crate::FrameReport::error), meets it. 0
    /// gives all pixels the same number.
    pub max_error: f32,
    /// The norm of that error.
    pub norm: ErrorNorm,
    /// The seed: another seed gives other samples.
    pub seed: u64,
    /// How the samples of different frames are related.
    pub noise: Noise,
    /// The most instants at which the scene is drawn while the shutter is open, 1..=[`Self::LARGEST_INSTANTS`]; there are never
    /// more instants than samples. With a `max_error` their number follows from it, up to 256. See [`Camera::shutter`](super::Camera::shutter).
    pub instants: u32,
}

/// How the noise of different frames is related.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub enum Noise {
    /// The samples of all frames are the same: what does not change does not flicker.
    #[default]
    Fixed,
    /// Every moment has its own samples, so that noise averages out to the eye. They are a function of the seed and the exact
    /// time.
    PerFrame,
}

impl Sampling {
    /// The most samples per pixel.
    pub const LARGEST_COUNT: u32 = 65_536;
    /// The largest error: the whole range of 8-bit output.
    pub const LARGEST_ERROR: f32 = 255.0;
    /// The most instants while the shutter is open.
    pub const LARGEST_INSTANTS: u32 = 256;
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
    /// The most generations of rays that are traced: 1 is camera rays alone, 5 adds four reflections. A ray beyond that sees the
    /// background.
    pub depth: u32,
    /// The cutoff: rays whose contributions to a pixel are together certainly less than this many steps of 8-bit output are not
    /// traced, 0..=[`Self::LARGEST_CUTOFF`]; 0 traces all.
    pub cutoff: f32,
}

impl Quality {
    /// The most generations.
    pub const LARGEST_DEPTH: u32 = 1000;
    /// The largest cutoff: the whole range of 8-bit output.
    pub const LARGEST_CUTOFF: f32 = 255.0;
}

impl Default for Quality {
    fn default() -> Self {
        Self { depth: 5, cutoff: 0.25 }
    }
}
