//! Correction of the scale of estimates by what the samples of many pixels show together.

use std::ops::AddAssign;

use super::evidence::PixelPacket;
use super::feature_light::PRIOR;
use crate::trace::math::LANES;

/// Correction factor of a class's estimates.
#[derive(Clone, Copy, Debug)]
pub(super) struct Scale {
    pub(super) factor: f64,
    /// Factor of a squared error when the sample count is doubled.
    pub(super) falls: f64,
    /// Relative variance of `factor`.
    pub(super) uncertain: f64,
}

/// Sums over the pixels of a class whose sample counts were doubled and, of edges, over those that have their first samples.
#[derive(Clone, Copy, Debug, Default)]
pub(super) struct ClassSums {
    /// Number of pixels, by their [weights](PixelPacket::met).
    pixels: f64,
    /// Squared errors by the model, as first samples show them, and the sum of `PixelPacket::moved`.
    model: f64,
    shown: f64,
    moved: f64,
    /// Squares of `shown` and `moved`.
    squared: f64,
    /// Sums of `moved` before and after the last doubling, for pixels that were doubled twice.
    earlier: f64,
    later: f64,
}

impl ClassSums {
    /// Adds a pixel that has its first samples, with its squared errors by the model and as the samples show it.
    pub(super) fn add_first(&mut self, model: f32, shown: f32) {
        let [model, shown] = [model, shown].map(f64::from);
        *self += Self { pixels: 1.0, model, shown, squared: shown * shown, ..Self::default() };
    }

    /// Adds a pixel whose sample count was doubled, with the estimates of its packet.
    pub(super) fn add_doubled(&mut self, pixels: &PixelPacket, lane: usize, errors: &[f32; LANES]) {
        let [moved, before, model] =
            [pixels.moved[lane], pixels.moved_before[lane], errors[lane]].map(f64::from);
        let (earlier, later) = if before >= 0.0 { (before, moved) } else { (0.0, 0.0) };
        let met = f64::from(pixels.met(lane));
        *self +=
            Self { pixels: met, model, moved, squared: moved * moved, earlier, later, ..Self::default() };
    }
}

impl AddAssign for ClassSums {
    fn add_assign(&mut self, other: Self) {
        self.pixels += other.pixels;
        self.model += other.model;
        self.shown += other.shown;
        self.moved += other.moved;
        self.squared += other.squared;
        self.earlier += other.earlier;
        self.later += other.later;
    }
}

/// Weight of the assumed factor of doubling, in pixels. The squared changes of single pixels scatter so much that the ratio of two sums over
/// 64 of them is uncertain by a third: as much as the factor differs between scenes, 0.2 to 0.5.
const FALLS_PRIOR: f64 = 64.0;

impl Scale {
    /// Creates the scale of estimates that fall by the factor `falls` with each doubling, before any measurement.
    pub(super) fn new(falls: f64) -> Self {
        Self { factor: 1.0, falls, uncertain: 0.25 }
    }

    /// Corrects the scale by what the samples of a class's pixels show. The pixels were not selected by these samples.
    pub(super) fn correct(&mut self, sums: &ClassSums) {
        if sums.pixels == 0.0 {
            return;
        }
        if sums.earlier > 0.0 {
            let prior = FALLS_PRIOR * sums.earlier / sums.pixels;
            let measured = (sums.later + prior * self.falls) / (sums.earlier + prior);
            self.falls = measured.clamp(0.2, 0.5);
        }
        if sums.model > 0.0 {
            // On average, `moved` is (1 - q) e², and the squared error after doubling is q e².
            let measured = sums.shown + self.falls / (1.0 - self.falls) * sums.moved;
            let prior = PRIOR * sums.model / sums.pixels;
            self.factor = ((measured + prior * self.factor) / (sums.model + prior)).clamp(0.125, 8.0);
        }
        let sum = sums.shown + sums.moved;
        if sum > 0.0 {
            // For normal X, Var(X²) = 2 E[X²]² = 2/3 E[X⁴]: the ratio overestimates the relative variance of the sum.
            self.uncertain = (sums.squared / (sum * sum)).min(0.25);
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn close(one: f64, other: f64) -> bool {
        (one - other).abs() < 1e-3
    }

    #[test]
    fn first_samples_scale_the_model() {
        let mut sums = ClassSums::default();
        for pixel in 0..100_000 {
            sums.add_first(4.0, if pixel % 4 == 0 { 4.0 } else { 0.0 });
        }
        let mut scale = Scale::new(0.5);
        scale.correct(&sums);
        assert!(close(scale.factor, 0.25), "the samples show a quarter");
    }

    #[test]
    fn few_pixels_hardly_change_the_scale() {
        let (mut sums, mut scale) = (ClassSums::default(), Scale::new(0.5));
        sums.add_first(4.0, 0.0);
        scale.correct(&sums);
        assert!(close(scale.factor, 8.0 / 9.0), "{}", scale.factor);
    }
}
