//! The samples of a frame, as they are chosen.

use crate::components::Sampling;
use crate::systems::Knobs;

/// The samples of a frame: what is chosen for an error or for a deadline, and what brings back the same picture.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct FrameSamples {
    /// The most samples of a pixel: [`Sampling::samples`].
    pub samples: u32,
    /// The error that the picture may have, 0 for as many samples everywhere.
    pub max_error: f32,
}

impl FrameSamples {
    /// Returns them as knobs.
    #[must_use]
    pub fn knobs(self) -> Knobs {
        Knobs { samples: Some(self.samples), max_error: Some(self.max_error), ..Knobs::default() }
    }

    /// Returns this many samples in all pixels.
    #[must_use]
    pub fn everywhere(samples: u32) -> Self {
        Self { samples, max_error: 0.0 }
    }

    /// Returns as many samples as it takes for an error, of this many at most.
    #[must_use]
    pub fn for_error(max_error: f32, samples: u32) -> Self {
        Self { samples, max_error }
    }

    /// Returns the samples at a height of the ladder: 1, 2 and 4 for all pixels at 0, 1 and 2, and from 3 on an error of 16 steps that
    /// is halved with every rung.
    #[must_use]
    pub fn at_height(height: f64) -> Self {
        if height < ADAPTIVE {
            #[expect(clippy::cast_possible_truncation, clippy::cast_sign_loss, reason = "0 to 2")]
            let exponent = height.max(0.0) as u32;
            return Self::everywhere(1 << exponent);
        }
        #[expect(clippy::cast_possible_truncation, reason = "it becomes the setting")]
        let max_error = (LARGEST * libm::exp2(ADAPTIVE - height.min(HIGHEST))) as f32;
        Self::for_error(max_error, Sampling::LARGEST_COUNT)
    }
}

/// From where on pixels get as many samples as they need.
pub(super) const ADAPTIVE: f64 = 3.0;
/// The error there.
const LARGEST: f64 = 16.0;
/// An error of 2^-10 steps.
pub(super) const HIGHEST: f64 = 17.0;

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn rungs_are_what_they_are_called() {
        assert_eq!(FrameSamples::at_height(0.0), FrameSamples::everywhere(1));
        assert_eq!(FrameSamples::at_height(2.9), FrameSamples::everywhere(4));
        assert_eq!(FrameSamples::at_height(3.0), FrameSamples::for_error(16.0, Sampling::LARGEST_COUNT));
        assert_eq!(FrameSamples::at_height(7.0).max_error, 1.0);
    }
}
