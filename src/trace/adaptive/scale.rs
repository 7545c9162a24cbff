//! Corrections of the scale of estimates, by how far the halves of samples are apart.

use std::ops::AddAssign;

use super::evidence::PixelPacket;
use crate::trace::math::LANES;

/// The weight of what is known of a class beforehand, in pixels.
const PRIOR: f64 = 8.0;

/// Correction of a class's estimates.
#[derive(Clone, Copy, Debug)]
pub(super) struct Scale {
    pub(super) factor: f64,
    /// The factor of a square error when the number of samples is doubled.
    pub(super) falls: f64,
    /// The relative variance of the factor.
    pub(super) uncertain: f64,
}

/// Sums over the pixels of a class whose samples were doubled.
#[derive(Clone, Copy, Debug, Default)]
pub(super) struct Halves {
    pixels: f64,
    model: f64,
    apart: f64,
    apart_squared: f64,
    /// Of the pixels that were doubled before, too: then and now.
    earlier: f64,
    later: f64,
}

impl Halves {
    /// Adds a pixel whose samples were doubled, with the estimates of its packet.
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
    /// Creates that of estimates that fall by a factor with each doubling, before anything is measured.
    pub(super) fn new(falls: f64) -> Self {
        Self { factor: 1.0, falls, uncertain: 0.25 }
    }

    /// Corrects it by how far the halves of a class's pixels are apart.
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
            let measured = self.falls / (1.0 - self.falls) * halves.apart;
            let prior = PRIOR * halves.model / halves.pixels;
            self.factor = ((measured + prior * self.factor) / (halves.model + prior)).clamp(0.125, 8.0);
        }
        if halves.apart > 0.0 {
            // The square of a normal number has twice the variance of its square.
            self.uncertain = (halves.apart_squared / (halves.apart * halves.apart)).min(0.25);
        }
    }
}
