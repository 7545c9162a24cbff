//! Sines and cosines that are exact at quarter turns.

use std::f64::consts::{FRAC_1_SQRT_2, FRAC_PI_2};

/// Returns the sine and the cosine of an angle. `quarter` is a quarter turn in the unit of the angle, a number with few digits.
///
/// Whole and quarter turns are subtracted before any rounding. At multiples of a quarter turn both results are exactly -1, 0 or 1; whole
/// turns change no bit; and at odd multiples of an eighth of a turn both have exactly the same magnitude.
pub(super) fn sine_cosine(angle: f64, quarter: f64) -> (f64, f64) {
    let angle = angle % (4.0 * quarter);
    let count = (angle / quarter).round();
    let rest = angle - count * quarter;
    let (sine, cosine) = if rest.abs() == 0.5 * quarter {
        (FRAC_1_SQRT_2.copysign(rest), FRAC_1_SQRT_2)
    } else {
        libm::sincos(rest * (FRAC_PI_2 / quarter))
    };
    match count.rem_euclid(4.0) {
        0.0 => (sine, cosine),
        1.0 => (cosine, -sine),
        2.0 => (-sine, -cosine),
        _ => (-cosine, sine),
    }
}

#[cfg(test)]
mod tests {
    use std::f64::consts::TAU;

    use super::*;

    #[test]
    fn sines_agree_with_those_of_radians() {
        for step in -4000..=4000 {
            let turns = f64::from(step) / 1000.0;
            for (angle, quarter) in [(turns, 0.25), (360.0 * turns, 90.0)] {
                let (sine, cosine) = sine_cosine(angle, quarter);
                assert!((sine - libm::sin(TAU * turns)).abs() < 5e-15, "{turns}");
                assert!((cosine - libm::cos(TAU * turns)).abs() < 5e-15, "{turns}");
            }
        }
    }

    #[test]
    fn quarter_turns_are_exact_and_eighths_symmetric_however_many_turns_there_are() {
        const QUARTERS: [(f64, f64); 4] = [(0.0, 1.0), (1.0, 0.0), (0.0, -1.0), (-1.0, 0.0)];
        for quarters in (-9..=9_i32).chain([1 << 30, -(1 << 30), (1 << 30) + 1, i32::MAX]) {
            let expected = QUARTERS[usize::try_from(quarters.rem_euclid(4)).unwrap()];
            for quarter in [0.25, 90.0] {
                let angle = f64::from(quarters) * quarter;
                assert_eq!(sine_cosine(angle, quarter), expected, "{quarters} quarters");
                let (sine, cosine) = sine_cosine(angle + 0.5 * quarter, quarter);
                assert_eq!(sine.abs().to_bits(), cosine.abs().to_bits(), "and half a quarter");
            }
        }
    }

    #[test]
    fn whole_turns_change_no_bit() {
        for step in 0..1000 {
            let degrees = f64::from(step) * 0.375;
            assert_eq!(sine_cosine(degrees, 90.0), sine_cosine(degrees - 720.0, 90.0));
            assert_eq!(sine_cosine(degrees, 90.0), sine_cosine(degrees + 360e6, 90.0));
        }
    }
}
