//! Scaling by powers of two, without rounding.

use glam::DVec3;

/// Returns `direction` times a power of two, and that power of two. The power brings the largest component into 1..2, or into 1..4 for the
/// largest exponent. If scaling would round a tiny component, the direction is returned unscaled, unless its largest component is 2^400 or
/// more. Returns `None` if `direction` is zero or not finite.
#[inline]
pub(crate) fn scaled(direction: DVec3) -> Option<(DVec3, f64)> {
    /// Power of two that moves subnormal numbers into the normal range.
    const LIFT: f64 = f64::from_bits((1023 + 600) << 52);
    const EXPONENT: u64 = 0x7ff;

    let exponent = |vector: DVec3| (vector.abs().max_element().to_bits() >> 52) & EXPONENT;
    if !direction.is_finite() || direction == DVec3::ZERO {
        return None;
    }
    let (lifted, lift) = if exponent(direction) < 600 { (direction * LIFT, LIFT) } else { (direction, 1.0) };
    // The biased exponent of 2^-e is 2046 - (1023 + e). It would be 0, a subnormal, for the largest exponent.
    let scale = f64::from_bits((2046 - exponent(lifted).min(2045)) << 52);
    let scaled = lifted * scale;
    let beside_subnormal = || exponent(lifted) < 1023 + 400 && scaled / scale != lifted;
    if scale < 1.0 && lifted.abs().min_element() < 1e-200 && beside_subnormal() {
        return Some((lifted, lift));
    }
    Some((scaled, lift * scale))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn directions_of_any_length_are_scaled_exactly() {
        for exponent in [-1074, -1040, -1022, -500, -1, 0, 1, 52, 900, 1022] {
            let length = libm::ldexp(1.0, exponent);
            let (direction, scale) = scaled(DVec3::new(length, -length, 0.0)).unwrap();
            assert_eq!(direction, DVec3::new(1.0, -1.0, 0.0), "2^{exponent}");
            assert!(exponent < -1023 || scale * length == 1.0);
        }
        assert!(scaled(DVec3::new(f64::MAX, 0.0, 1.0)).unwrap().0.x < 4.0);
        assert!(scaled(DVec3::ZERO).is_none());
        assert!(scaled(DVec3::new(f64::NAN, 1.0, 0.0)).is_none());
        assert!(scaled(DVec3::new(f64::INFINITY, 1.0, 0.0)).is_none());
    }
}
