//! Settings of the whole scene. A world has at most one of each; the first in document order counts.

use crate::color::{Rgb, Transfer};

/// The ambient light's intensity I_a, the same everywhere.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Ambient(pub Rgb);

/// What a ray sees that hits nothing.
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
    /// Black.
    fn default() -> Self {
        Self::Flat(Rgb::ZERO)
    }
}

/// Fog everywhere: over a length l, exp(-density l) is seen of what is behind, and the fog's colour makes up the rest.
///
/// It lies on camera, mirror and refracted rays, not on shadow rays. With a density above 0, a ray that meets
/// nothing sees only fog.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Fog {
    /// What is seen through endless fog.
    pub color: Rgb,
    /// Per scene unit of length in the world, 0 or more; 0 is no fog.
    pub density: f64,
}

/// The picture's size and how it is written.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct FilmSettings {
    /// Columns, 1..=[`Self::LARGEST_SIDE`].
    pub width: u32,
    /// Rows, 1..=[`Self::LARGEST_SIDE`].
    pub height: u32,
    /// From linear light to bytes.
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

/// How many samples a pixel has, and which.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Sampling {
    /// 1..=[`Self::LARGEST_COUNT`]. A single sample is in the pixel's centre; several are spread over the pixel, which is
    /// their mean.
    pub samples: u32,
    /// Another seed gives other samples.
    pub seed: u64,
    /// What the samples of different frames have to do with each other.
    pub noise: Noise,
    /// At how many instants, at most, things are drawn while the shutter is open, 1..=[`Self::LARGEST_INSTANTS`]; there are
    /// never more instants than samples. See [`Camera::shutter`](super::Camera::shutter).
    pub instants: u32,
}

/// What the noise of different frames has to do with each other.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub enum Noise {
    /// The samples of all frames lie alike: what does not change does not flicker.
    #[default]
    Fixed,
    /// Every moment has samples of its own, so that noise averages out to the eye. They are a function of the seed and the
    /// exact time.
    PerFrame,
}

impl Sampling {
    /// The most samples in a pixel.
    pub const LARGEST_COUNT: u32 = 65_536;
    /// The most instants while the shutter is open.
    pub const LARGEST_INSTANTS: u32 = 256;
}

impl Default for Sampling {
    fn default() -> Self {
        Self { samples: 1, seed: 0, noise: Noise::Fixed, instants: 16 }
    }
}

/// How far light is followed.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Quality {
    /// Generations of rays that are traced: 1 is camera rays alone, 5 adds four reflections. A ray beyond sees the
    /// background.
    pub depth: u32,
    /// Rays are not followed whose contributions to a pixel are together certainly less than this many steps of an output
    /// of 8 bits, 0..=[`Self::LARGEST_CUTOFF`]; 0 follows all.
    pub cutoff: f32,
}

impl Quality {
    /// The most generations.
    pub const LARGEST_DEPTH: u32 = 1000;
    /// The largest cutoff: the whole range of an output of 8 bits.
    pub const LARGEST_CUTOFF: f32 = 255.0;
}

impl Default for Quality {
    fn default() -> Self {
        Self { depth: 5, cutoff: 0.25 }
    }
}
