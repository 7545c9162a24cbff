//! Error-free transforms: sums and products of two `f64`s as their rounded value and its exact error.

use glam::DVec3;

/// 2^27 + 1.
const SPLITTER: f64 = 134_217_729.0;

/// a + b as a rounded sum and its exact error (Knuth).
#[inline]
pub(crate) fn two_sum(a: f64, b: f64) -> (f64, f64) {
    let sum = a + b;
    let b_part = sum - a;
    (sum, (a - (sum - b_part)) + (b - b_part))
}

/// As [`two_sum`], for |a| >= |b|.
#[inline]
pub(crate) fn quick_two_sum(a: f64, b: f64) -> (f64, f64) {
    let sum = a + b;
    (sum, b - (sum - a))
}

/// a * b as a rounded product and its exact error (Dekker, Veltkamp), barring underflow and overflow.
#[inline]
pub(crate) fn two_product(a: f64, b: f64) -> (f64, f64) {
    let product = a * b;
    let (a_high, a_low) = split(a);
    let (b_high, b_low) = split(b);
    let error = ((a_high * b_high - product) + a_high * b_low + a_low * b_high) + a_low * b_low;
    (product, error)
}

/// Two halves of at most 26 bits each.
#[inline]
fn split(a: f64) -> (f64, f64) {
    let scaled = SPLITTER * a;
    let high = scaled - (scaled - a);
    (high, a - high)
}

/// [`two_sum`] in each coordinate.
#[inline]
pub(crate) fn two_sums(a: DVec3, b: DVec3) -> (DVec3, DVec3) {
    let sum = a + b;
    let b_part = sum - a;
    (sum, (a - (sum - b_part)) + (b - b_part))
}

/// [`two_product`] in each coordinate.
#[inline]
pub(crate) fn two_products(a: DVec3, b: DVec3) -> (DVec3, DVec3) {
    let halves = |a: DVec3| {
        let scaled = a * SPLITTER;
        let high = scaled - (scaled - a);
        (high, a - high)
    };
    let product = a * b;
    let ((a_high, a_low), (b_high, b_low)) = (halves(a), halves(b));
    (product, ((a_high * b_high - product) + a_high * b_low + a_low * b_high) + a_low * b_low)
}
