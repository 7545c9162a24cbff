//! What has come to the pixels of a packet.

use fearless_simd::prelude::*;
use glam::DVec3;

use crate::color::Rgb;
use crate::trace::math::{Colors, Vectors, splat};

/// What samples of a packet's pixels add up to.
pub(crate) trait ExposedLight: Copy + Send + Sync {
    /// What there is without samples.
    const NONE: Self;

    /// Adds a sample of each pixel.
    fn add<S: Simd>(&mut self, simd: S, samples: &Colors);

    /// Returns the means of so many samples.
    fn mean<S: Simd>(&self, simd: S, samples: u32) -> Colors;
}

/// The only sample of each pixel.
impl ExposedLight for Colors {
    const NONE: Self = Self::splat(Rgb::ZERO);

    #[inline(always)]
    fn add<S: Simd>(&mut self, simd: S, samples: &Colors) {
        self.store(samples.load(simd));
    }

    #[inline(always)]
    fn mean<S: Simd>(&self, _: S, _: u32) -> Colors {
        *self
    }
}

/// Sums in `f64`, so that the mean of equal samples is exactly their value, and that of 2^16 samples is as good as that of two.
impl ExposedLight for Vectors {
    const NONE: Self = Self::splat(DVec3::ZERO);

    #[inline(always)]
    fn add<S: Simd>(&mut self, simd: S, samples: &Colors) {
        for (channel, samples) in samples.load(simd).into_iter().enumerate() {
            let (first, second) = samples.widen();
            let sums = self.axis_mut(channel);
            sums.store(0, sums.load(simd, 0) + first);
            sums.store(1, sums.load(simd, 1) + second);
        }
    }

    #[inline(always)]
    fn mean<S: Simd>(&self, simd: S, samples: u32) -> Colors {
        let count = splat(simd, f64::from(samples));
        let mut means = [Colors::splat(Rgb::ZERO).load(simd)[0]; 3];
        for (channel, mean) in means.iter_mut().enumerate() {
            let sums = self.axis(channel);
            *mean = (sums.load(simd, 0) / count).narrow(sums.load(simd, 1) / count);
        }
        let mut colors = Colors::splat(Rgb::ZERO);
        colors.store(means);
        colors
    }
}
