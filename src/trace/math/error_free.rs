//! Error-free transforms: sums and products of two numbers as their rounded value and its exact error.

use super::real::Real;

/// 2^27 + 1.
const SPLITTER: f64 = 134_217_729.0;

/// a + b as a rounded sum and its exact error (Knuth).
#[inline(always)]
pub(crate) fn two_sum<R: Real>(a: R, b: R) -> (R, R) {
    let sum = a + b;
    let b_part = sum - a;
    (sum, (a - (sum - b_part)) + (b - b_part))
}

/// As [`two_sum`], for |a| >= |b|.
#[inline(always)]
pub(crate) fn quick_two_sum<R: Real>(a: R, b: R) -> (R, R) {
    let sum = a + b;
    (sum, b - (sum - a))
}

/// a * b as a rounded product and its exact error, barring underflow and overflow.
#[inline(always)]
pub(crate) fn two_product<R: Real>(a: R, b: R) -> (R, R) {
    a.two_product(b)
}

/// The same where products and sums are not fused (Dekker, Veltkamp).
#[inline(always)]
pub(crate) fn split_product<R: Real>(a: R, b: R) -> (R, R) {
    let product = a * b;
    let (a_high, a_low) = split(a);
    let (b_high, b_low) = split(b);
    let error = ((a_high * b_high - product) + a_high * b_low + a_low * b_high) + a_low * b_low;
    (product, error)
}

/// Two halves of at most 26 bits each.
#[inline(always)]
fn split<R: Real>(a: R) -> (R, R) {
    let scaled = a * SPLITTER;
    let high = scaled - (scaled - a);
    (high, a - high)
}
