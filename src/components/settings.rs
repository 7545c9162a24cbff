//! Settings of the whole scene. A world has at most one of each; the first in document order counts.

use crate::color::{Rgb, Transfer};

/// The ambient light's intensity I_a, the same everywhere.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Ambient(pub Rgb);

/// What a ray sees that hits nothing.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Background(pub Rgb);

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
        Self { width: 640, height: 360, transfer: Transfer::Classic }
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
}

impl Default for Sampling {
    fn default() -> Self {
        Self { samples: 1, seed: 0, noise: Noise::Fixed }
    }
}

/// How far light is followed.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Quality {
    /// Generations of rays that are traced: 1 is camera rays alone, 5 adds four reflections. A ray beyond sees the
    /// background.
    pub depth: u32,
}

impl Quality {
    /// The most generations.
    pub const LARGEST_DEPTH: u32 = 1000;
}

impl Default for Quality {
    fn default() -> Self {
        Self { depth: 5 }
    }
}
