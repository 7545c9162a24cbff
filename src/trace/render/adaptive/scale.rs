//! Correction of the scale of estimates by the differences between halves of samples.

use std::ops::AddAssign;

use super::evidence::PixelPacket;
use crate::trace::math::LANES;

/// Weight of the prior of a class, in pixels.
const PRIOR: f64 = 8.0;

/// Correction factor of a class's estimates.
#[derive(Clone, Copy, Debug)]
pub(super) struct Scale {
    pub(super) factor: f64,
    /// Factor of a squared error when the sample count is doubled.
    pub(super) falls: f64,
    /// Relative variance of `factor`.
    pub(super) uncertain: f64,
}

/// Sums over the pixels of a class whose sample counts were doubled.
#[derive(Clone, Copy, Debug, Default)]
pub(super) struct Halves {
    pixels: f64,
    model: f64,
    apart: f64,
    apart_squared: f64,
    /// Sums of `apart` before and after the last doubling, for pixels that were doubled twice.
    earlier: f64,
    later: f64,
}

impl Halves {
    /// Adds a pixel whose sample count was doubled, with the estimates of its packet.
    pub(super) fn add(&mut self, pixels: &PixelPacket, lane: usize, errors: &[f32; LANES]) {
        let [apart, before, model] =
            [pixels.apart[lane], pixels.apart_before[lane], errors[lane]].map(f64::from);
        let (earlier, later) = if before >= 0.0 { (before, apart) } else { (0.0, 0.0) };
        *self += Self { pixels: 1.0, model, apart, apart_squared: apart * apart, earlier, later };
    }
}

impl AddAssign for Halves {
    fn add_assign(&mut self, other: Self) {
        self.pixels += other.pixels;
        self.model += other.model;
        self.apart += other.apart;
        self.apart_squared += other.apart_squared;
        self.earlier += other.earlier;
        self.later += other.later;
    }
}

impl Scale {
    /// Creates the scale of estimates that fall by the factor `falls` with each doubling, before any measurement.
    pub(super) fn new(falls: f64) -> Self {
        Self { factor: 1.0, falls, uncertain: 0.25 }
    }

    /// Corrects the scale by the differences between the halves of a class's pixels.
    pub(super) fn correct(&mut self, halves: &Halves) {
        if halves.pixels == 0.0 {
            return;
        }
        if halves.earlier > 0.0 {
            let prior = PRIOR * halves.earlier / halves.pixels;
            let measured = (halves.later + prior * self.falls) / (halves.earlier + prior);
            self.falls = measured.clamp(0.2, 0.5);
        }
        if halves.model > 0.0 {
            // On average, `apart` is (1 - q) e², and the squared error after doubling is q e².
            let measured = self.falls / (1.0 - self.falls) * halves.apart;
            let prior = PRIOR * halves.model / halves.pixels;
            self.factor = ((measured + prior * self.factor) / (halves.model + prior)).clamp(0.125, 8.0);
        }
        if halves.apart > 0.0 {
            // For normal X, Var(X²) = 2 E[X²]² = 2/3 E[X⁴]: the ratio overestimates the relative variance of the sum.
            self.uncertain = (halves.apart_squared / (halves.apart * halves.apart)).min(0.25);
        }
    }
}
