//! Error-free transforms: the rounded sum or product of two numbers, and its exact error.

use super::real::Real;

/// Returns the rounded sum a + b and its exact error (Knuth).
#[inline(always)]
pub(crate) fn two_sum<R: Real>(a: R, b: R) -> (R, R) {
    let sum = a + b;
    let b_part = sum - a;
    (sum, (a - (sum - b_part)) + (b - b_part))
}

/// Returns the result of [`two_sum`], for |a| >= |b|.
#[inline(always)]
pub(crate) fn quick_two_sum<R: Real>(a: R, b: R) -> (R, R) {
    let sum = a + b;
    (sum, b - (sum - a))
}

/// Returns the rounded product a * b and its exact error, barring underflow and overflow.
#[inline(always)]
pub(crate) fn two_product<R: Real>(a: R, b: R) -> (R, R) {
    a.two_product(b)
}
