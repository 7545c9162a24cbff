//! Sums of products that are rounded once, regardless of cancellation.

use glam::DVec3;

use super::double::Double;
use super::error_free::{two_product, two_sum};
use super::vector::Double3;

/// Returns a sum of a few terms as non-overlapping components in ascending order; exact, barring overflow (Shewchuk's growing expansions).
fn expansion<const COUNT: usize>(terms: [f64; COUNT]) -> [f64; COUNT] {
    let mut parts = [0.0; COUNT];
    for (length, term) in terms.into_iter().enumerate() {
        let mut carry = term;
        for part in &mut parts[..length] {
            (carry, *part) = two_sum(carry, *part);
        }
        parts[length] = carry;
    }
    parts
}

/// Returns a sum of a few terms, rounded once, regardless of cancellation.
#[must_use]
pub(crate) fn sum<const COUNT: usize>(terms: [f64; COUNT]) -> Double {
    expansion(terms).into_iter().fold(Double::ZERO, |sum, part| sum + Double::from(part))
}

/// Returns a.b, rounded once.
#[must_use]
pub(crate) fn exact_dot(a: Double3, b: DVec3) -> Double {
    let mut terms = [0.0; 12];
    for (terms, (a, b)) in terms.chunks_exact_mut(4).zip([(a.x, b.x), (a.y, b.y), (a.z, b.z)]) {
        let ((high, high_error), (low, low_error)) = (two_product(a.high, b), two_product(a.low, b));
        terms.copy_from_slice(&[high, high_error, low, low_error]);
    }
    sum(terms)
}

/// Returns a.a - b^2, rounded once.
#[must_use]
pub(crate) fn square_difference(a: Double3, b: f64) -> Double {
    let mut terms = [0.0; 20];
    for (terms, a) in terms.chunks_exact_mut(6).zip([a.x, a.y, a.z]) {
        let (high, low) = (two_product(a.high, a.high), two_product(a.low, a.low));
        let mixed = two_product(2.0 * a.high, a.low);
        terms.copy_from_slice(&[high.0, high.1, mixed.0, mixed.1, low.0, low.1]);
    }
    let square = two_product(b, b);
    (terms[18], terms[19]) = (-square.0, -square.1);
    sum(terms)
}

/// Returns offset - row.point, rounded once; its sign is exact.
#[must_use]
pub(crate) fn offset_height(offset: f64, row: DVec3, point: DVec3) -> Double {
    let mut terms = [0.0; 7];
    for axis in 0..3 {
        let (product, error) = two_product(-row[axis], point[axis]);
        (terms[2 * axis], terms[2 * axis + 1]) = (product, error);
    }
    terms[6] = offset;
    sum(terms)
}

#[cfg(test)]
mod tests {
    use std::cmp::Ordering;

    use super::*;

    #[test]
    fn sums_are_rounded_once_however_much_cancels() {
        let sign = |terms| sum::<4>(terms).sign();
        assert_eq!(sign([1e100, 1.0, -1e100, -1.0]), Ordering::Equal);
        assert_eq!(sign([1e100, 1.0, -1e100, -1.0 + 1e-16]), Ordering::Greater);
        assert_eq!(sign([1e100, -1e-100, -1e100, 0.0]), Ordering::Less);
        assert_eq!(sign([0.0, -0.0, 0.0, 0.0]), Ordering::Equal);
    }
}
