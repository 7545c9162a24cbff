//! Convergence: the decrease of errors while samples are added.

use crate::trace::scene::{PreparedCamera, PreparedScene};

/// The assumed decrease of errors with the sample count n, until it is measured.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) enum Convergence {
    /// Errors fall as n^-3/4.
    Edges,
    /// Errors fall as n^-1/2, and faster once samples have met features that move while the shutter is open.
    Motion,
    /// Errors fall as n^-1/2.
    Effects,
}

impl Convergence {
    /// Returns the convergence for a camera's view of a scene; `is_open` is true if the shutter is open.
    pub(crate) fn of(scene: &PreparedScene, camera: &PreparedCamera, is_open: bool) -> Self {
        if camera.has_lens() || scene.samples_light() {
            Self::Effects
        } else if is_open {
            Self::Motion
        } else {
            Self::Edges
        }
    }

    /// Returns the factor of a squared error when the sample count is doubled.
    pub(super) fn of_doubling(self) -> f64 {
        match self {
            Self::Edges => 0.353_553_390_593_273_8,
            Self::Motion | Self::Effects => 0.5,
        }
    }

    /// Returns the fraction of a small feature's area that a pixel shows at least, on average over the exposure. A feature may straddle the
    /// corner of four pixels, and pass through the pixel at a single one of 256 instants. 0 if samples stay independent after they have
    /// met it.
    pub(super) fn least_part(self) -> f32 {
        match self {
            Self::Edges => 0.25,
            Self::Motion => 0.25 / 256.0,
            Self::Effects => 0.0,
        }
    }
}
