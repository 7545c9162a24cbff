//! Exact arithmetic: sums and products of `f64`s, and roots of quadratic equations with such coefficients.
//!
//! It decides the cases that `f64` and its error bounds leave open: whether a line hits a shape, and which of two hits is nearer. Signs and
//! comparisons are exact, so that the hits of a ray are totally ordered, and coincident shapes are distinguished from merely close ones. An
//! exact decision takes microseconds and is rare.

use std::cmp::Ordering;
use std::ops::{Add, Mul, Neg, Sub};

use dashu_int::IBig;
use dashu_int::ops::{BitTest, SquareRoot, UnsignedAbs};
use glam::DVec3;

use super::double::Double;
use super::vector::Double3;

/// An integer times a power of two, of any size.
#[derive(Clone, Debug)]
pub(crate) struct Exact {
    digits: IBig,
    exponent: isize,
}

/// A vector of three exact numbers.
#[derive(Clone, Debug)]
pub(crate) struct Exact3(pub(crate) [Exact; 3]);

/// A root of a quadratic equation: (middle + sign √square) / divisor, with divisor > 0. If `square` is zero, it is the solution of a linear
/// equation.
#[derive(Clone, Debug)]
pub(crate) struct ExactRoot {
    middle: Exact,
    sign: Sign,
    square: Exact,
    divisor: Exact,
}

#[derive(Clone, Copy, Debug)]
enum Sign {
    Minus,
    Plus,
}

impl Exact {
    pub(crate) const ZERO: Self = Self { digits: IBig::ZERO, exponent: 0 };

    pub(crate) fn sign(&self) -> Ordering {
        self.digits.cmp(&IBig::ZERO)
    }

    fn squared(&self) -> Self {
        self * self
    }

    /// Returns `self`, negated if `sign` is less than zero.
    fn signed(&self, sign: Ordering) -> Self {
        if sign.is_lt() { -self } else { self.clone() }
    }

    /// Returns the digits at a smaller exponent.
    fn digits_at(&self, exponent: isize) -> IBig {
        &self.digits << (self.exponent - exponent).unsigned_abs()
    }

    /// Returns the square root of a non-negative number, rounded down by a relative error of less than 2^-150.
    fn sqrt(&self) -> Self {
        const BITS: usize = 320;
        let spare = BITS.saturating_sub(self.digits.bit_len());
        // The exponent must be even to be halved.
        let shift = spare + (spare + self.exponent.unsigned_abs()) % 2;
        let digits = self.digits.clone() << shift;
        let root = digits.unsigned_abs().sqrt();
        Self { digits: root.into(), exponent: (self.exponent - shift.cast_signed()) / 2 }
    }

    /// Returns the quotient, rounded to a [`Double`]. The divisor must not be zero.
    pub(crate) fn over(&self, divisor: &Self) -> Double {
        const BITS: isize = 160;
        let length = |number: &Self| number.digits.bit_len().cast_signed();
        let shift = BITS + length(divisor) - length(self);
        let (mut dividend, mut by) = (self.digits.clone(), divisor.digits.clone());
        if shift > 0 {
            dividend <<= shift.unsigned_abs();
        } else {
            by <<= shift.unsigned_abs();
        }
        Self { digits: dividend / by, exponent: self.exponent - divisor.exponent - shift }.rounded()
    }

    /// Returns the number rounded to a [`Double`].
    pub(crate) fn rounded(&self) -> Double {
        let high = self.to_f64();
        if high.is_infinite() {
            return high.into();
        }
        let rest = self - &Self::from(high);
        Double::sum(high, rest.to_f64())
    }

    /// Returns the number rounded to an `f64`; infinite if it is out of range.
    fn to_f64(&self) -> f64 {
        // The leading 120 bits suffice, although a number may have more than 1000.
        let spare = self.digits.bit_len().saturating_sub(120);
        let digits = (&self.digits >> spare).to_f64().value();
        let exponent = self.exponent + spare.cast_signed();
        libm::scalbn(digits, i32::try_from(exponent).unwrap_or(i32::MAX))
    }
}

impl From<f64> for Exact {
    /// Converts a finite number.
    fn from(value: f64) -> Self {
        const FRACTION: u64 = (1 << 52) - 1;
        let bits = value.to_bits();
        let (biased, fraction) = (((bits >> 52) & 0x7ff) as isize, bits & FRACTION);
        let (mantissa, exponent) =
            if biased == 0 { (fraction, -1074) } else { (fraction | (FRACTION + 1), biased - 1075) };
        if mantissa == 0 {
            return Self::ZERO;
        }
        let zeros = mantissa.trailing_zeros();
        let magnitude = IBig::from(mantissa >> zeros);
        let digits = if value < 0.0 { -magnitude } else { magnitude };
        Self { digits, exponent: exponent + zeros as isize }
    }
}

impl From<Double> for Exact {
    fn from(value: Double) -> Self {
        &Self::from(value.rounded()) + &Self::from(value.rest())
    }
}

impl Add for &Exact {
    type Output = Exact;

    fn add(self, other: Self) -> Exact {
        let exponent = self.exponent.min(other.exponent);
        Exact { digits: self.digits_at(exponent) + other.digits_at(exponent), exponent }
    }
}

impl Sub for &Exact {
    type Output = Exact;

    fn sub(self, other: Self) -> Exact {
        let exponent = self.exponent.min(other.exponent);
        Exact { digits: self.digits_at(exponent) - other.digits_at(exponent), exponent }
    }
}

impl Mul for &Exact {
    type Output = Exact;

    fn mul(self, other: Self) -> Exact {
        Exact { digits: &self.digits * &other.digits, exponent: self.exponent + other.exponent }
    }
}

impl Neg for &Exact {
    type Output = Exact;

    fn neg(self) -> Exact {
        Exact { digits: -&self.digits, exponent: self.exponent }
    }
}

impl Exact3 {
    pub(crate) fn dot(&self, other: &Self) -> Exact {
        let [x, y, z] = std::array::from_fn(|axis| &self.0[axis] * &other.0[axis]);
        &(&x + &y) + &z
    }

    pub(crate) fn cross(&self, other: &Self) -> Self {
        Self(std::array::from_fn(|axis| {
            let (next, last) = ((axis + 1) % 3, (axis + 2) % 3);
            &(&self.0[next] * &other.0[last]) - &(&self.0[last] * &other.0[next])
        }))
    }
}

impl Sub for &Exact3 {
    type Output = Exact3;

    fn sub(self, other: Self) -> Exact3 {
        Exact3(std::array::from_fn(|axis| &self.0[axis] - &other.0[axis]))
    }
}

impl From<DVec3> for Exact3 {
    fn from(vector: DVec3) -> Self {
        Self(vector.to_array().map(Exact::from))
    }
}

impl From<Double3> for Exact3 {
    fn from(vector: Double3) -> Self {
        Self(vector.to_array().map(Exact::from))
    }
}

impl ExactRoot {
    pub(crate) const ZERO: Self = Self {
        middle: Exact::ZERO,
        sign: Sign::Plus,
        square: Exact::ZERO,
        divisor: Exact { digits: IBig::ONE, exponent: 0 },
    };

    /// Returns height / speed. `speed` must not be zero.
    pub(crate) fn quotient(height: &Exact, speed: &Exact) -> Self {
        let sign = speed.sign();
        Self {
            middle: height.signed(sign),
            sign: Sign::Plus,
            square: Exact::ZERO,
            divisor: speed.signed(sign),
        }
    }

    /// Returns the roots of a t^2 - 2 b t + c = 0, the lesser one first, for a > 0. Returns `None` if there are no real roots.
    pub(crate) fn of_quadratic(a: &Exact, b: &Exact, c: &Exact) -> Option<[Self; 2]> {
        let square = &b.squared() - &(a * c);
        if square.sign().is_lt() {
            return None;
        }
        let root = |sign| Self { middle: b.clone(), sign, square: square.clone(), divisor: a.clone() };
        Some([root(Sign::Minus), root(Sign::Plus)])
    }

    /// Compares the root with zero.
    pub(crate) fn sign(&self) -> Ordering {
        sign_of(&self.middle, self.sign.order(), &self.square)
    }

    /// Returns the root rounded to a [`Double`].
    pub(crate) fn rounded(&self) -> Double {
        if self.square.sign().is_eq() {
            return self.middle.over(&self.divisor);
        }
        let root = self.square.sqrt();
        let opposite = self.middle.sign() == self.sign.order().reverse();
        if !opposite {
            let sum = match self.sign {
                Sign::Minus => &self.middle - &root,
                Sign::Plus => &self.middle + &root,
            };
            return sum.over(&self.divisor);
        }
        // The conjugate avoids cancellation: m + s √q = (m^2 - q) / (m - s √q).
        let conjugate = match self.sign {
            Sign::Minus => &self.middle + &root,
            Sign::Plus => &self.middle - &root,
        };
        (&self.middle.squared() - &self.square).over(&(&conjugate * &self.divisor))
    }
}

impl Sign {
    fn order(self) -> Ordering {
        match self {
            Self::Minus => Ordering::Less,
            Self::Plus => Ordering::Greater,
        }
    }
}

impl PartialEq for ExactRoot {
    fn eq(&self, other: &Self) -> bool {
        self.cmp(other).is_eq()
    }
}

impl Eq for ExactRoot {}

impl PartialOrd for ExactRoot {
    fn partial_cmp(&self, other: &Self) -> Option<Ordering> {
        Some(self.cmp(other))
    }
}

impl Ord for ExactRoot {
    /// Compares two roots by the sign of their difference a + b √p + c √q, which is squared until no root is left (Devillers, Fronville,
    /// Mourrain, Teillaud, "Algebraic methods and arithmetic filtering for exact predicates on circle arcs", 2000).
    fn cmp(&self, other: &Self) -> Ordering {
        let a = &(&self.middle * &other.divisor) - &(&other.middle * &self.divisor);
        if self.square.sign().is_eq() && other.square.sign().is_eq() {
            return a.sign();
        }
        let b = other.divisor.signed(self.sign.order());
        let c = self.divisor.signed(other.sign.order().reverse());
        let first = sign_of_sum(&a, &b, &self.square);
        let second = if other.square.sign().is_eq() { Ordering::Equal } else { c.sign() };
        if first.is_eq() || second.is_eq() || first == second {
            return first.then(second);
        }
        // The signs of a + b √p and c √q are opposite: the one with the larger square decides.
        let (p, q) = (&self.square, &other.square);
        let rest = &(&a.squared() + &(&b.squared() * p)) - &(&c.squared() * q);
        let mixed = &(&a * &b) + &(&a * &b);
        match sign_of_sum(&rest, &mixed, p) {
            Ordering::Less => second,
            Ordering::Equal => Ordering::Equal,
            Ordering::Greater => first,
        }
    }
}

/// Returns the sign of a + b √p.
fn sign_of_sum(a: &Exact, b: &Exact, p: &Exact) -> Ordering {
    let second = if p.sign().is_eq() { Ordering::Equal } else { b.sign() };
    sign_of_two(a, second, || &b.squared() * p)
}

/// Returns the sign of a + √p or a - √p; `root` is the sign of the square root.
fn sign_of(a: &Exact, root: Ordering, p: &Exact) -> Ordering {
    let second = if p.sign().is_eq() { Ordering::Equal } else { root };
    sign_of_two(a, second, || p.clone())
}

/// Returns the sign of a + s, where s is given by its sign and its square.
fn sign_of_two(a: &Exact, second: Ordering, square: impl FnOnce() -> Exact) -> Ordering {
    let first = a.sign();
    if first.is_eq() || second.is_eq() || first == second {
        return first.then(second);
    }
    match (&a.squared() - &square()).sign() {
        Ordering::Less => second,
        Ordering::Equal => Ordering::Equal,
        Ordering::Greater => first,
    }
}

#[cfg(test)]
mod tests {
    use proptest::prelude::*;

    use super::*;

    fn exact(value: f64) -> Exact {
        value.into()
    }

    fn roots(a: f64, b: f64, c: f64) -> [ExactRoot; 2] {
        ExactRoot::of_quadratic(&exact(a), &exact(b), &exact(c)).unwrap()
    }

    fn quotient(height: f64, speed: f64) -> ExactRoot {
        ExactRoot::quotient(&exact(height), &exact(speed))
    }

    #[test]
    fn every_number_is_taken_over_and_given_back() {
        for value in [0.0, 1.0, -1.0, 0.1, 5e-324, -2.2e-308, f64::MIN_POSITIVE, f64::MAX, f64::MIN, 1e300] {
            assert_eq!(exact(value).to_f64(), value);
            assert_eq!((&exact(value) - &exact(value)).sign(), Ordering::Equal);
        }
    }

    #[test]
    fn the_same_number_is_the_same_however_it_is_written() {
        let [minus, plus] = roots(1.0, 1.0, -3.0); // 1 -+ 2
        assert_eq!([&minus, &plus], [&quotient(-1.0, 1.0), &quotient(9.0, 3.0)]);
        let [minus, plus] = roots(1.0, 0.0, -2.0);
        let [twice_minus, twice_plus] = roots(0.25, 0.0, -0.5);
        assert_eq!([&minus, &plus], [&twice_minus, &twice_plus]);
        // √2 + 1 = 1 / (√2 - 1) is a root of t^2 - 2t - 1, and of three times this polynomial.
        let [_, one] = roots(1.0, 1.0, -1.0);
        let [_, other] = roots(3.0, 3.0, -3.0);
        assert_eq!(one, other);
        let below = std::f64::consts::SQRT_2.next_down();
        assert!(minus < quotient(-below, 1.0) && quotient(below, 1.0) < plus);
        assert!(plus < quotient(std::f64::consts::SQRT_2, 1.0));
        assert_eq!(roots(1.0, 0.0, 0.0).map(|root| root.sign()), [Ordering::Equal; 2]);
        assert!(ExactRoot::of_quadratic(&exact(1.0), &exact(1e-200), &exact(5e-324)).is_none());
    }

    #[test]
    fn roots_are_rounded_with_a_hundred_bits_whatever_cancels() {
        // The lesser root of t^2 - 2e10 t + 1 is 5e-11 (1 + 2.5e-21 + ..).
        let [small, _] = roots(1.0, 1e10, 1.0);
        let rest = small.rounded() - Double::from(1.0) / Double::from(2e10);
        assert!((rest.rounded() / 1.25e-31 - 1.0).abs() < 1e-9, "{rest:?}");
        let [_, root] = roots(1.0, 0.0, -2.0);
        let square = root.rounded() * root.rounded() - Double::from(2.0);
        assert!(square.rounded().abs() < 1e-30);
        assert_eq!(quotient(1.0, 3.0).rounded(), Double::from(1.0) / Double::from(3.0));
        assert_eq!(quotient(1e300, 1e-300).rounded().rounded(), f64::INFINITY);
    }

    fn small() -> impl Strategy<Value = f64> {
        (-4..=4_i32).prop_map(f64::from)
    }

    fn any_root() -> impl Strategy<Value = ExactRoot> {
        (1..=3_i32, small(), small(), any::<bool>()).prop_map(|(a, b, c, far)| {
            let both = ExactRoot::of_quadratic(&exact(f64::from(a)), &exact(b), &exact(c));
            let [near, other] = both.unwrap_or([quotient(b, f64::from(a)), quotient(c, -1.0)]);
            if far { other } else { near }
        })
    }

    proptest! {
        /// Uses small numbers, so that ties are frequent.
        #[test]
        fn the_order_is_total(a in any_root(), b in any_root(), c in any_root()) {
            prop_assert_eq!(a.cmp(&b), b.cmp(&a).reverse());
            prop_assert_eq!(a.sign(), a.cmp(&ExactRoot::ZERO));
            if a <= b && b <= c {
                prop_assert!(a <= c);
                prop_assert_eq!(a == c, a == b && b == c);
            }
            let apart = a.rounded().rounded() - b.rounded().rounded();
            if apart.abs() > 1e-9 {
                prop_assert_eq!(a < b, apart < 0.0);
            } else {
                prop_assert_eq!(a.cmp(&b), Ordering::Equal);
            }
        }
    }
}
