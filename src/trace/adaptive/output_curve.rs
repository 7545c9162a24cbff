//! Output values, quickly: good enough for estimates of errors.

use std::fmt;

use glam::{DVec3, Vec3};

use crate::color::{Rgb, Transfer};

/// How light becomes output values: on lines between some of them, off by at most a hundredth.
#[derive(Clone)]
pub(super) struct OutputCurve(Box<[f64; PIECES + 1]>);

const PIECES: usize = 4096;

impl OutputCurve {
    pub(super) fn of(transfer: Transfer) -> Self {
        let value = |piece: u16| transfer.encode_unrounded(Rgb::splat(f32::from(piece) / PIECES as f32))[0];
        let mut values = Box::new([0.0; PIECES + 1]);
        values.iter_mut().zip(0..).for_each(|(stored, piece)| *stored = value(piece));
        Self(values)
    }

    fn value(&self, light: f64) -> f64 {
        let place = light.clamp(0.0, 1.0) * PIECES as f64;
        #[expect(clippy::cast_possible_truncation, clippy::cast_sign_loss, reason = "0 to PIECES - 1")]
        let piece = (place as usize).min(PIECES - 1);
        let (low, high) = (self.0[piece], self.0[piece + 1]);
        low + (high - low) * (place - piece as f64)
    }

    /// Returns the mean square of the difference that small differences of a colour make to its output values.
    pub(super) fn mean_square_near(&self, color: Vec3, apart: DVec3) -> f64 {
        let slope = |light: f32| {
            #[expect(clippy::cast_possible_truncation, clippy::cast_sign_loss, reason = "0 to PIECES - 1")]
            let piece = (light.clamp(0.0, 1.0) * PIECES as f32) as usize;
            let piece = piece.min(PIECES - 1);
            (self.0[piece + 1] - self.0[piece]) * PIECES as f64
        };
        let apart = apart * DVec3::from_array(color.to_array().map(slope));
        apart.length_squared() / 3.0
    }

    /// Returns the mean square of the difference of two colours' output values.
    pub(super) fn mean_square(&self, [one, other]: [DVec3; 2]) -> f64 {
        let mut sum = 0.0;
        for (one, other) in one.to_array().into_iter().zip(other.to_array()) {
            if one != other {
                let apart = self.value(one) - self.value(other);
                sum += apart * apart;
            }
        }
        sum / 3.0
    }
}

impl fmt::Debug for OutputCurve {
    fn fmt(&self, formatter: &mut fmt::Formatter<'_>) -> fmt::Result {
        formatter.debug_struct("OutputCurve").finish_non_exhaustive()
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn values_are_off_by_little() {
        for transfer in [Transfer::Srgb, Transfer::Classic] {
            let curve = OutputCurve::of(transfer);
            for step in 0..40_000_u16 {
                let light = f32::from(step) / 39_000.0;
                let exact = transfer.encode_unrounded(Rgb::splat(light))[0];
                assert!((curve.value(light.into()) - exact).abs() < 0.01, "{light}");
            }
            assert_eq!(curve.value(-1.0), curve.value(0.0));
            assert_eq!(curve.value(f64::INFINITY), curve.value(1.0));
        }
    }
}
