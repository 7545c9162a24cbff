//! Fast approximation of output values, accurate enough for error estimates.

use crate::color::Transfer;

/// The transfer function from light to output values, with an error of at most 0.01.
///
/// For sRGB, 1.055 v^(1/2.4) - 0.055 equals 1.055 q^(5/3) - 0.055 with q = v^(1/4). Between the end of the linear segment and 1, a
/// polynomial in q is a close approximation. It needs only vectorizable arithmetic and square roots, whose results are the same on all
/// platforms.
#[derive(Clone, Copy, Debug)]
pub(super) struct OutputCurve {
    /// Slope of the linear segment.
    slope: f32,
    /// End of the linear segment, in light.
    linear_to: f32,
}

/// Coefficients of the polynomial in ascending powers of q, fitted at the Chebyshev points.
const COEFFICIENTS: [f32; 6] = [-15.678_25, 41.691_35, 318.693_9, -144.683_87, 71.647_62, -16.672_062];

impl OutputCurve {
    pub(super) fn of(transfer: Transfer) -> Self {
        match transfer {
            Transfer::Srgb => Self { slope: 255.0 * 12.92, linear_to: 0.003_130_8 },
            Transfer::Classic => Self { slope: 255.0, linear_to: 1.0 },
        }
    }

    /// Returns the output value of light, clamped. NaN is white, as it results from overflow.
    #[inline(always)]
    pub(super) fn value(&self, light: f32) -> f32 {
        let light = if light < 1.0 { light } else { 1.0 };
        let light = if light > 0.0 { light } else { 0.0 };
        let root = light.sqrt().sqrt();
        let [first @ .., last] = COEFFICIENTS;
        let curved = first.into_iter().rev().fold(last, |sum, coefficient| sum * root + coefficient);
        if light <= self.linear_to { self.slope * light } else { curved }
    }
}

impl OutputCurve {
    /// Returns the variance of one sample in output values, for `count` samples of light with this mean and the variance `square`. The
    /// curve is evaluated one standard deviation of the mean to each side, so clamped values contribute no variance.
    #[inline(always)]
    pub(super) fn variance(&self, mean: f32, square: f32, count: f32) -> f32 {
        let deviation = (square / count).sqrt();
        let apart = 0.5 * (self.value(mean + deviation) - self.value(mean - deviation));
        apart * apart * count
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::color::Rgb;

    #[test]
    fn values_are_off_by_little() {
        for transfer in [Transfer::Srgb, Transfer::Classic] {
            let curve = OutputCurve::of(transfer);
            for step in 0..40_000_u16 {
                let light = f32::from(step) / 39_000.0;
                let exact = transfer.encode_unrounded(Rgb::splat(light))[0];
                assert!((f64::from(curve.value(light)) - exact).abs() < 0.01, "{light}");
            }
            assert_eq!(curve.value(-1.0), 0.0);
            assert_eq!([f32::INFINITY, f32::NAN].map(|light| curve.value(light)), [curve.value(1.0); 2]);
        }
    }
}
