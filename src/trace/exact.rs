//! Arithmetic with more digits than `f64` has, for the few decisions and distances that need them.
//!
//! A [`Double`] is an unevaluated sum of two `f64` and carries some 106 bits (Dekker, "A Floating-Point Technique for
//! Extending the Available Precision", 1971; Joldes, Muller, Popescu, "Tight and Rigorous Error Bounds for Basic Building
//! Blocks of Double-Word Arithmetic", 2017). [`sign_of_sum`] is exact (Shewchuk, "Adaptive Precision Floating-Point
//! Arithmetic", 1997). Only + - * / and square roots are used, so that the bits are the same everywhere.

use std::cmp::Ordering;
use std::ops::{Add, Div, Mul, Neg, Sub};

use glam::DVec3;

/// An unevaluated sum `high + low`, where `high` is the sum rounded to `f64`.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Double {
    high: f64,
    low: f64,
}

/// Three [`Double`]s.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Double3 {
    /// Along x.
    pub x: Double,
    /// Along y.
    pub y: Double,
    /// Along z.
    pub z: Double,
}

/// 2^27 + 1.
const SPLITTER: f64 = 134_217_729.0;

/// a + b as a rounded sum and its exact error (Knuth).
#[inline]
fn two_sum(a: f64, b: f64) -> (f64, f64) {
    let sum = a + b;
    let b_part = sum - a;
    (sum, (a - (sum - b_part)) + (b - b_part))
}

/// As [`two_sum`], for |a| >= |b|.
#[inline]
fn quick_two_sum(a: f64, b: f64) -> (f64, f64) {
    let sum = a + b;
    (sum, b - (sum - a))
}

/// a * b as a rounded product and its exact error (Dekker, Veltkamp), barring underflow and overflow.
#[inline]
fn two_product(a: f64, b: f64) -> (f64, f64) {
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
fn two_sums(a: DVec3, b: DVec3) -> (DVec3, DVec3) {
    let sum = a + b;
    let b_part = sum - a;
    (sum, (a - (sum - b_part)) + (b - b_part))
}

/// [`two_product`] in each coordinate.
#[inline]
fn two_products(a: DVec3, b: DVec3) -> (DVec3, DVec3) {
    let halves = |a: DVec3| {
        let scaled = a * SPLITTER;
        let high = scaled - (scaled - a);
        (high, a - high)
    };
    let product = a * b;
    let ((a_high, a_low), (b_high, b_low)) = (halves(a), halves(b));
    (product, ((a_high * b_high - product) + a_high * b_low + a_low * b_high) + a_low * b_low)
}

impl Double {
    /// Nothing.
    pub const ZERO: Self = Self { high: 0.0, low: 0.0 };

    /// a - b, exactly.
    #[must_use]
    #[inline]
    pub fn difference(a: f64, b: f64) -> Self {
        let (high, low) = two_sum(a, -b);
        Self { high, low }
    }

    /// a + b, exactly.
    #[must_use]
    #[inline]
    pub fn sum(a: f64, b: f64) -> Self {
        let (high, low) = two_sum(a, b);
        Self { high, low }
    }

    /// a * b, exactly.
    #[must_use]
    #[inline]
    pub fn product(a: f64, b: f64) -> Self {
        let (high, low) = two_product(a, b);
        Self { high, low }
    }

    /// Times a power of two, exactly.
    #[must_use]
    #[inline]
    pub fn scaled(self, power: f64) -> Self {
        Self { high: self.high * power, low: self.low * power }
    }

    /// Rounded to `f64`.
    #[must_use]
    #[inline]
    pub fn rounded(self) -> f64 {
        self.high
    }

    /// What rounding to `f64` leaves over.
    #[must_use]
    #[inline]
    pub fn rest(self) -> f64 {
        self.low
    }

    /// The square root of a number that is not negative; 0 for one that is.
    #[must_use]
    #[inline]
    pub fn sqrt(self) -> Self {
        if self.high <= 0.0 {
            return Self::ZERO;
        }
        let root = self.high.sqrt();
        let residual = self - Self::product(root, root);
        let (high, low) = quick_two_sum(root, residual.high / (2.0 * root));
        Self { high, low }
    }

    /// Less than, equal to or greater than zero.
    #[must_use]
    #[inline]
    pub fn sign(self) -> Ordering {
        // A sum of two that is zero in its larger part is zero.
        self.high.partial_cmp(&0.0).unwrap_or(Ordering::Equal)
    }
}

impl From<f64> for Double {
    #[inline]
    fn from(high: f64) -> Self {
        Self { high, low: 0.0 }
    }
}

impl Add for Double {
    type Output = Self;

    #[inline]
    fn add(self, other: Self) -> Self {
        let (high, error) = two_sum(self.high, other.high);
        let (low, low_error) = two_sum(self.low, other.low);
        let (high, error) = quick_two_sum(high, error + low);
        let (high, low) = quick_two_sum(high, error + low_error);
        Self { high, low }
    }
}

impl Neg for Double {
    type Output = Self;

    #[inline]
    fn neg(self) -> Self {
        Self { high: -self.high, low: -self.low }
    }
}

impl Sub for Double {
    type Output = Self;

    #[inline]
    fn sub(self, other: Self) -> Self {
        self + -other
    }
}

impl Mul for Double {
    type Output = Self;

    #[inline]
    fn mul(self, other: Self) -> Self {
        let (high, error) = two_product(self.high, other.high);
        let (high, low) = quick_two_sum(high, error + (self.high * other.low + self.low * other.high));
        Self { high, low }
    }
}

impl Div for Double {
    type Output = Self;

    #[inline]
    fn div(self, other: Self) -> Self {
        let first = self.high / other.high;
        let rest = self - other * first;
        let (high, low) = quick_two_sum(first, rest.high / other.high);
        Self { high, low }
    }
}

impl Mul<f64> for Double {
    type Output = Self;

    #[inline]
    fn mul(self, other: f64) -> Self {
        let (high, error) = two_product(self.high, other);
        let (high, low) = quick_two_sum(high, error + self.low * other);
        Self { high, low }
    }
}

impl PartialOrd for Double {
    fn partial_cmp(&self, other: &Self) -> Option<Ordering> {
        match self.high.partial_cmp(&other.high)? {
            Ordering::Equal => self.low.partial_cmp(&other.low),
            order => Some(order),
        }
    }
}

impl Double3 {
    /// a - b, exactly.
    #[must_use]
    #[inline]
    pub fn difference(a: DVec3, b: DVec3) -> Self {
        Self {
            x: Double::difference(a.x, b.x),
            y: Double::difference(a.y, b.y),
            z: Double::difference(a.z, b.z),
        }
    }

    /// The sum of the products.
    #[must_use]
    #[inline]
    pub fn dot(self, other: Self) -> Double {
        self.x * other.x + self.y * other.y + self.z * other.z
    }

    /// Times a number.
    #[must_use]
    #[inline]
    pub fn scaled(self, factor: Double) -> Self {
        Self { x: self.x * factor, y: self.y * factor, z: self.z * factor }
    }

    /// Rounded to `f64`.
    #[must_use]
    #[inline]
    pub fn rounded(self) -> DVec3 {
        DVec3::new(self.x.rounded(), self.y.rounded(), self.z.rounded())
    }
}

impl From<DVec3> for Double3 {
    #[inline]
    fn from(vector: DVec3) -> Self {
        Self { x: vector.x.into(), y: vector.y.into(), z: vector.z.into() }
    }
}

impl Add for Double3 {
    type Output = Self;

    #[inline]
    fn add(self, other: Self) -> Self {
        Self { x: self.x + other.x, y: self.y + other.y, z: self.z + other.z }
    }
}

impl Neg for Double3 {
    type Output = Self;

    #[inline]
    fn neg(self) -> Self {
        Self { x: -self.x, y: -self.y, z: -self.z }
    }
}

impl Sub for Double3 {
    type Output = Self;

    #[inline]
    fn sub(self, other: Self) -> Self {
        Self { x: self.x - other.x, y: self.y - other.y, z: self.z - other.z }
    }
}

/// A vector as an unevaluated sum, for the one step from a nearly right `t` to a right one. Its operations are as good as
/// twice the working precision for what is left after cancellation, without carrying every result on as a [`Double`]
/// (Ogita, Rump, Oishi, "Accurate Sum and Dot Product", 2005).
#[derive(Clone, Copy, Debug)]
pub struct Compensated3 {
    value: DVec3,
    rest: DVec3,
}

impl Compensated3 {
    /// origin + t direction.
    #[must_use]
    #[inline]
    pub fn along(origin: DVec3, direction: DVec3, t: f64) -> Self {
        let (way, way_error) = two_products(direction, DVec3::splat(t));
        let (value, error) = two_sums(origin, way);
        Self { value, rest: error + way_error }
    }

    /// Less a point.
    #[must_use]
    #[inline]
    pub fn minus(self, point: DVec3) -> Self {
        let (difference, error) = two_sums(self.value, -point);
        let (value, rest) = two_sums(difference, error + self.rest);
        Self { value, rest }
    }

    /// Rounded to `f64`.
    #[must_use]
    #[inline]
    pub fn rounded(self) -> DVec3 {
        self.value
    }

    /// Plus a short way, rounded once.
    #[must_use]
    #[inline]
    pub fn moved(self, way: DVec3) -> DVec3 {
        self.value + (self.rest + way)
    }

    /// The sum of the products with plain numbers.
    #[must_use]
    #[inline]
    pub fn dot(self, other: DVec3) -> Double {
        let (products, errors) = two_products(self.value, other);
        Self::sum(products, errors + self.rest * other)
    }

    /// The sum of the products with numbers of a hundred bits.
    #[must_use]
    #[inline]
    pub fn dot_exact(self, other: Double3) -> Double {
        let (high, low) = (other.rounded(), DVec3::new(other.x.low, other.y.low, other.z.low));
        let (products, errors) = two_products(self.value, high);
        Self::sum(products, errors + (self.rest * high + self.value * low))
    }

    /// The square of its length less that of a radius.
    #[must_use]
    #[inline]
    pub fn beyond(self, radius: f64) -> Double {
        let (squares, errors) = two_products(self.value, self.value);
        let (square, square_error) = two_product(radius, radius);
        let (sum, sum_error) = two_sum(squares.x, squares.y);
        let (sum, other_error) = two_sum(sum, squares.z);
        let (sum, last_error) = two_sum(sum, -square);
        let errors = errors + self.rest * (self.value * 2.0);
        let error = (errors.x + errors.y + errors.z - square_error) + (sum_error + other_error + last_error);
        let (high, low) = two_sum(sum, error);
        Double { high, low }
    }

    #[inline]
    fn sum(parts: DVec3, errors: DVec3) -> Double {
        let (sum, sum_error) = two_sum(parts.x, parts.y);
        let (sum, other_error) = two_sum(sum, parts.z);
        let (high, low) = two_sum(sum, (errors.x + errors.y + errors.z) + (sum_error + other_error));
        Double { high, low }
    }
}

impl From<[Double; 3]> for Compensated3 {
    #[inline]
    fn from([x, y, z]: [Double; 3]) -> Self {
        Self { value: DVec3::new(x.high, y.high, z.high), rest: DVec3::new(x.low, y.low, z.low) }
    }
}

/// A sum of few numbers as non-overlapping parts, ascending; exact, barring overflow (Shewchuk's growing expansions).
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

/// The exact sign of a sum of few numbers.
#[must_use]
pub fn sign_of_sum<const COUNT: usize>(terms: [f64; COUNT]) -> Ordering {
    let largest = expansion(terms).into_iter().rev().find(|part| *part != 0.0).unwrap_or(0.0);
    largest.partial_cmp(&0.0).unwrap_or(Ordering::Equal)
}

/// A sum of few numbers, rounded once, however much of it cancels.
#[must_use]
pub fn sum<const COUNT: usize>(terms: [f64; COUNT]) -> Double {
    expansion(terms).into_iter().fold(Double::ZERO, |sum, part| sum + Double::from(part))
}

/// a.b, rounded once.
#[must_use]
pub fn dot(a: Double3, b: DVec3) -> Double {
    let mut terms = [0.0; 12];
    for (terms, (a, b)) in terms.chunks_exact_mut(4).zip([(a.x, b.x), (a.y, b.y), (a.z, b.z)]) {
        let ((high, high_error), (low, low_error)) = (two_product(a.high, b), two_product(a.low, b));
        terms.copy_from_slice(&[high, high_error, low, low_error]);
    }
    sum(terms)
}

/// a.a - b^2, rounded once.
#[must_use]
pub fn square_difference(a: Double3, b: f64) -> Double {
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

/// The exact order of the quotients `a / b` and `c / d` of a difference by a number each, for b and d other than 0.
#[must_use]
pub fn compare_quotients(a: Double, b: f64, c: Double, d: f64) -> Ordering {
    // a/b < c/d  <=>  a d < c b, if b d > 0.
    let [left, left_rest] = [two_product(a.high, d), two_product(a.low, d)];
    let [right, right_rest] = [two_product(-c.high, b), two_product(-c.low, b)];
    let sign =
        sign_of_sum([left.0, left.1, left_rest.0, left_rest.1, right.0, right.1, right_rest.0, right_rest.1]);
    if (b < 0.0) == (d < 0.0) { sign } else { sign.reverse() }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn sums_products_quotients_and_roots_have_a_hundred_bits() {
        let third = Double::from(1.0) / Double::from(3.0);
        let rest = third * Double::from(3.0) - Double::from(1.0);
        assert!(rest.rounded().abs() < 1e-31, "{rest:?}");
        let two = Double::from(2.0);
        let rest = two.sqrt() * two.sqrt() - two;
        assert!(rest.rounded().abs() < 1e-30, "{rest:?}");
        let tiny = Double::difference(1.0, -1e-30) - Double::from(1.0);
        assert!((tiny.rounded() - 1e-30).abs() < 1e-45);
        assert_eq!(
            Double::product(1.0 + f64::EPSILON, 1.0 - f64::EPSILON).rest(),
            -f64::EPSILON * f64::EPSILON
        );
    }

    #[test]
    fn signs_of_sums_are_exact() {
        assert_eq!(sign_of_sum([1e100, 1.0, -1e100, -1.0]), Ordering::Equal);
        assert_eq!(sign_of_sum([1e100, 1.0, -1e100, -1.0 + 1e-16]), Ordering::Greater);
        assert_eq!(sign_of_sum([1e100, -1e-100, -1e100]), Ordering::Less);
        assert_eq!(sign_of_sum([0.0, -0.0]), Ordering::Equal);
    }

    #[test]
    fn quotients_are_compared_exactly() {
        let difference = Double::difference;
        // (1 - 0.3)/0.7 is not 1: neither 0.3 nor 0.7 is what it says. The same products in another order are.
        assert_eq!(compare_quotients(difference(3.0, 0.0), 7.0, difference(6.0, 0.0), 14.0), Ordering::Equal);
        assert_eq!(
            compare_quotients(difference(3.0, 0.0), -7.0, difference(-6.0, 0.0), 14.0),
            Ordering::Equal
        );
        assert_eq!(
            compare_quotients(difference(1.0, -1e-30), 1.0, difference(1.0, 0.0), 1.0),
            Ordering::Greater
        );
        assert_eq!(compare_quotients(difference(-1.0, 0.0), 3.0, difference(1.0, 0.0), 3.0), Ordering::Less);
        assert_eq!(compare_quotients(difference(1.0, 0.0), -3.0, difference(1.0, 0.0), 3.0), Ordering::Less);
    }
}
