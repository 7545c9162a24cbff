//! Comparison of generic formulas over numbers with the same formulas over lanes, at every SIMD level.

use fearless_simd::dispatch;
use proptest::prelude::*;

use super::lanes::{HALF, Numbers, splat};
use super::real::Real;
use super::simd_level::SimdLevel;

/// A function of `N` numbers with `M` results that is generic over scalars and lanes.
pub(crate) trait Formulas<const N: usize, const M: usize> {
    fn evaluate<R: Real>(&self, arguments: [R; N]) -> [R; M];
}

/// Checks that the results in the last lane of half a packet have the bits of the results for single numbers. All NaNs count as equal.
pub(crate) fn compare<const N: usize, const M: usize>(
    formulas: &impl Formulas<N, M>,
    arguments: [f64; N],
) -> Result<(), TestCaseError> {
    let bits = |number: f64| if number.is_nan() { f64::NAN.to_bits() } else { number.to_bits() };
    let expected = formulas.evaluate(arguments);
    for (name, level) in SimdLevel::all() {
        let mut found = [0.0; M];
        dispatch!(level.level(), simd => {
            let lanes = formulas.evaluate(arguments.map(|number| splat(simd, number)));
            for (number, lanes) in found.iter_mut().zip(lanes) {
                let mut numbers = Numbers::splat(0.0);
                numbers.store(0, lanes);
                *number = numbers.get(HALF - 1);
            }
        });
        prop_assert_eq!(found.map(bits), expected.map(bits), "{}: {:?}", name, arguments);
    }
    Ok(())
}
