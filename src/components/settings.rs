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
