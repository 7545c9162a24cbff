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
    met: f64,
    bound: f64,
    seen: f64,
}

impl FeatureLight {
    /// Adds a pixel with the bound of its feature's radiance, its [weight](super::evidence::PixelPacket::met), and the variances.
    pub(super) fn add(&mut self, radiance: f32, met: f64, bound: f64, seen: f64) {
        *self.0.entry(Self::key(radiance)).or_default() += LightSums { met, bound, seen };
    }

    /// Adds the pixels of another part of the picture.
    pub(super) fn merge(mut self, other: Self) -> Self {
        other.0.into_iter().for_each(|(key, sums)| *self.0.entry(key).or_default() += sums);
        self
    }

    /// Returns the measured radiance of features as a fraction of the bound.
    pub(super) fn radiance_fraction(&self, radiance: f32) -> f64 {
        /// Lower limit, lest a few bright features among many dark ones be taken for dark.
        const DARKEST: f64 = 0.25;
        let Some(LightSums { met, bound, seen }) = self.0.get(&Self::key(radiance)) else { return 1.0 };
        let prior = PRIOR * bound / met;
        let share = (seen + prior) / (bound + prior);
        // Bounds can be 0 or infinite.
        if share.is_finite() { share.sqrt().clamp(DARKEST, 1.0) } else { 1.0 }
    }

    /// Returns eight keys per power of two.
    fn key(radiance: f32) -> u32 {
        radiance.to_bits() >> 20
    }
}

impl AddAssign for LightSums {
    fn add_assign(&mut self, other: Self) {
        self.met += other.met;
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
        let fractions =
            [1.0, 2.0, 4.0, 8.0, f32::INFINITY, 0.0, 3.0].map(|radiance| merged.radiance_fraction(radiance));
        for (found, expected) in fractions.into_iter().zip([0.5, 0.25, 1.0, 0.9428, 1.0, 1.0, 1.0]) {
            assert!((found - expected).abs() < 1e-3, "{fractions:?}");
        }
    }
}
