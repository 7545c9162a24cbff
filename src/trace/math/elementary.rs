//! Exponentials, powers, sines and cosines as one sequence of basic operations. Results are bit-identical for scalars and lanes, and on
//! every machine.
//!
//! The relative error is at most 2^-44 where the result is a normal `f32`: results are rounded to `f32`, or place a sample. Powers of two
//! are factored out, and the remainder is evaluated by Taylor series.

use std::f64::consts::{LN_2, LOG2_E};

use super::real::{ROUNDER, Real};

/// Returns e^x, for x up to 700; 0 for x below -700.
#[inline(always)]
pub(crate) fn exp<R: Real>(x: R) -> R {
    let power = (x * LOG2_E + ROUNDER) - ROUNDER;
    let rest = (x - power * LN_2_HIGH) - power * LN_2_LOW;
    x.if_less(x.of(-700.0), x.of(0.0), series(rest, &EXP) * power.power_of_two())
}

/// Returns ln x of a positive normal number.
#[inline(always)]
fn ln<R: Real>(x: R) -> R {
    let (mantissa, exponent) = x.mantissa_and_exponent();
    // ln m = 2 artanh f.
    let f = (mantissa - 1.0) / (mantissa + 1.0);
    let of_mantissa = f * series(f * f, &ARTANH) * 2.0;
    (of_mantissa + exponent * LN_2_LOW) + exponent * LN_2_HIGH
}

/// Returns x^y, for x in 0..=1 and y >= 0. Subnormal arguments count as zero.
#[inline(always)]
pub(crate) fn pow<R: Real>(x: R, y: R) -> R {
    let of_zero = y.if_less(y.of(f64::MIN_POSITIVE), y.of(1.0), y.of(0.0));
    x.if_less(x.of(f64::MIN_POSITIVE), of_zero, exp(y * ln(x)))
}

/// Returns the sine and the cosine of an angle in -π/4..=π/4, in radians.
#[inline(always)]
pub(crate) fn sine_and_cosine<R: Real>(angle: R) -> (R, R) {
    let square = angle * angle;
    (angle * series(square, &SINE), series(square, &COSINE))
}

/// Evaluates a polynomial. Even and odd powers are summed separately, which gives two independent dependency chains.
#[inline(always)]
fn series<R: Real, const N: usize>(x: R, coefficients: &[f64; N]) -> R {
    let square = x * x;
    let (mut even, mut odd) = (x.of(0.0), x.of(0.0));
    for index in (0..N).rev() {
        let sum = if index % 2 == 0 { &mut even } else { &mut odd };
        *sum = *sum * square + coefficients[index];
    }
    even + x * odd
}

/// High part of ln 2, its first 32 bits, and low part. Products of the high part with integers up to 2^20 are exact.
const LN_2_HIGH: f64 = f64::from_bits(LN_2.to_bits() & !0x1f_ffff);
const LN_2_LOW: f64 = 1.908_214_929_270_587_7e-10;

/// Taylor coefficients of e^x: 1 / k!.
const EXP: [f64; 14] = inverse_factorials(0, 1, 1.0);
/// Taylor coefficients of sin(x) / x and of cos(x) in x^2: (-1)^k / (2k + 1)! and (-1)^k / (2k)!.
const SINE: [f64; 9] = inverse_factorials(1, 2, -1.0);
const COSINE: [f64; 9] = inverse_factorials(0, 2, -1.0);
/// Taylor coefficients of artanh(x) / x in x^2: 1 / (2k + 1).
const ARTANH: [f64; 11] = {
    let mut coefficients = [1.0; 11];
    let (mut index, mut divisor) = (0, 1.0);
    while index < coefficients.len() {
        coefficients[index] = 1.0 / divisor;
        divisor += 2.0;
        index += 1;
    }
    coefficients
};

/// Returns sign^k / (first + step k)! for k = 0, 1, ...
const fn inverse_factorials<const N: usize>(first: u32, step: u32, sign: f64) -> [f64; N] {
    let mut coefficients = [1.0; N];
    // `first` is 0 or 1, so that its factorial is 1.
    let (mut index, mut number, mut factorial) = (1, first as f64, 1.0);
    while index < N {
        let mut steps = 0;
        while steps < step {
            number += 1.0;
            factorial *= number;
            steps += 1;
        }
        factorial *= sign;
        coefficients[index] = 1.0 / factorial;
        index += 1;
    }
    coefficients
}

#[cfg(test)]
mod tests {
    use std::f64::consts::FRAC_PI_4;

    use fearless_simd::dispatch;
    use proptest::prelude::*;

    use super::*;
    use crate::trace::math::{Numbers, SimdLevel, splat};

    /// 2^-44
    const CLOSE: f64 = 5.7e-14;

    /// Returns whether the relative error is at most 2^-44, or the absolute error is below the range of `f32`.
    fn close(found: f64, expected: f64) -> bool {
        (found - expected).abs() <= CLOSE * expected.abs() + 1e-46
    }

    /// Evaluates a function in eight lanes at every SIMD level.
    macro_rules! in_lanes {
        ($function:expr, $($number:expr),+) => {{
            SimdLevel::all().into_iter().map(|(_, level)| dispatch!(level.level(), simd => {
                let found = $function($(splat(simd, $number)),+);
                let mut numbers = Numbers::splat(0.0);
                numbers.store(0, found);
                (0..8).map(|lane| numbers.get(lane)).collect::<Vec<f64>>()
            })).collect::<Vec<_>>()
        }};
    }

    fn all_are(found: &[Vec<f64>], expected: f64) -> bool {
        found.iter().flatten().all(|number| number.to_bits() == expected.to_bits())
    }

    proptest! {
        #![proptest_config(ProptestConfig::with_cases(20_000))]

        #[test]
        fn they_are_what_they_are_called(
            x in prop_oneof![0.0..=1.0_f64, (0.0..1e-6_f64).prop_map(|below| 1.0 - below), (-300.0..0.0_f64).prop_map(libm::exp10)],
            y in prop_oneof![0.0..4.0_f64, 0.0..1000.0_f64, 0.0..1e9_f64],
            way in prop_oneof![-3.0..0.0_f64, -800.0..700.0_f64],
            angle in -FRAC_PI_4..FRAC_PI_4,
        ) {
            let power = pow(x, y);
            prop_assert!(close(power, libm::pow(x, y)), "{power:e} {:e}", libm::pow(x, y));
            prop_assert!(close(exp(way), libm::exp(way)), "{:e} {:e}", exp(way), libm::exp(way));
            let (sine, cosine) = sine_and_cosine(angle);
            prop_assert!((sine - libm::sin(angle)).abs() < 4e-16 && (cosine - libm::cos(angle)).abs() < 4e-16);
            prop_assert!(all_are(&in_lanes!(pow, x, y), power));
            prop_assert!(all_are(&in_lanes!(exp, way), exp(way)));
            let both = sine + cosine;
            let found = in_lanes!(|angle| { let (sine, cosine) = sine_and_cosine(angle); sine + cosine }, angle);
            prop_assert!(all_are(&found, both));
        }
    }

    #[test]
    fn ends_are_exact() {
        for (x, y, expected) in
            [(0.0, 0.0, 1.0), (0.0, 1e-30, 0.0), (1.0, 1e30, 1.0), (0.5, 0.0, 1.0), (0.5, f64::MAX, 0.0)]
        {
            assert_eq!(pow(x, y), expected, "{x}^{y}");
        }
        for (x, expected) in [(0.0, 1.0), (-0.0, 1.0), (f64::NEG_INFINITY, 0.0), (-701.0, 0.0)] {
            assert_eq!(exp(x), expected, "e^{x}");
        }
        assert_eq!(sine_and_cosine(0.0), (0.0, 1.0));
    }
}
