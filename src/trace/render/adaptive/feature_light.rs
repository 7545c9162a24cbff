//! The brightness of small features, measured in many pixels together.

use std::collections::BTreeMap;
use std::ops::AddAssign;

/// Weight of what is assumed before a measurement, in pixels of weight 1.
pub(super) const PRIOR: f64 = 8.0;

/// The variance of light in the pixels of small features: as seen by the first samples, and by the upper bounds of the features' radiance,
/// which assume that all lights are near and visible. Features with about the same bound are measured together: most have the same material.
#[derive(Clone, Debug, Default)]
pub(super) struct FeatureLight(BTreeMap<u32, LightSums>);

#[derive(Clone, Copy, Debug, Default)]
struct LightSums {
    /// Number of pixels, by their weights.
    pixels: f64,
    bound: f64,
    seen: f64,
}

impl FeatureLight {
    /// Adds a pixel with the bound of its feature's radiance, its [weight](super::evidence::PixelPacket::met), and the variances.
    pub(super) fn add(&mut self, radiance: f32, met: f64, bound: f64, seen: f64) {
        *self.0.entry(Self::key(radiance)).or_default() += LightSums { pixels: met, bound, seen };
    }

    /// Adds the pixels of another part of the picture.
    pub(super) fn merge(mut self, other: Self) -> Self {
        other.0.into_iter().for_each(|(key, sums)| *self.0.entry(key).or_default() += sums);
        self
    }

    /// Returns the measured radiance of features as a fraction of the bound. `is_met` is true if samples have met the pixel's feature.
    pub(super) fn radiance_fraction(&self, radiance: f32, is_met: bool) -> f64 {
        /// Lower limit for other features, lest a few bright ones among many dark ones be taken for dark.
        const DARKEST: f64 = 0.25;
        let Some(LightSums { pixels, bound, seen }) = self.0.get(&Self::key(radiance)) else { return 1.0 };
        let prior = PRIOR * bound / pixels;
        let share = (seen + prior) / (bound + prior);
        // Bounds can be 0 or infinite.
        if share.is_finite() { share.sqrt().clamp(if is_met { 0.0 } else { DARKEST }, 1.0) } else { 1.0 }
    }

    /// Returns eight keys per power of two.
    fn key(radiance: f32) -> u32 {
        radiance.to_bits() >> 20
    }
}

impl AddAssign for LightSums {
    fn add_assign(&mut self, other: Self) {
        self.pixels += other.pixels;
        self.bound += other.bound;
        self.seen += other.seen;
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn features_of_one_bound_are_measured_together() {
        let mut light = FeatureLight::default();
        for _ in 0..100_000 {
            light.add(1.0, 1.0, 4.0, 1.0);
            light.add(2.0, 1.0, 4.0, 0.0);
            light.add(4.0, 1.0, 4.0, 9.0);
        }
        light.add(8.0, 1.0, 4.0, 0.0);
        light.add(f32::INFINITY, 1.0, f64::INFINITY, 1.0);
        light.add(0.0, 0.0, 0.0, 0.0);
        let merged = light.merge(FeatureLight::default());
        let check = |radiance: f32, is_met: bool, expected: f64| {
            let found = merged.radiance_fraction(radiance, is_met);
            assert!((found - expected).abs() < 1e-3, "{radiance} {is_met}: {found} instead of {expected}");
        };
        for is_met in [false, true] {
            check(1.0, is_met, 0.5);
            check(8.0, is_met, 0.9428);
            // Unknown, out of range, or brighter than the bound.
            [0.0, 3.0, 4.0, f32::INFINITY].into_iter().for_each(|radiance| check(radiance, is_met, 1.0));
        }
        check(2.0, false, 0.25);
        check(2.0, true, 0.0089);
    }
}
