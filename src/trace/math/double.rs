//! Double-double numbers of about 106 bits.

use std::cmp::Ordering;
use std::ops::{Add, Div, Mul, Neg, Sub};

use super::error_free::{quick_two_sum, two_product, two_sum};
use super::real::Real;

/// An unevaluated sum `high + low`, where `high` is the sum rounded to `f64`.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Double<R = f64> {
    pub(crate) high: R,
    pub(crate) low: R,
}

impl Double {
    /// Zero.
    pub const ZERO: Self = Self { high: 0.0, low: 0.0 };

    /// One.
    pub const ONE: Self = Self { high: 1.0, low: 0.0 };

    /// Returns the short decimal number that was rounded to `number`: the one with at most 15 digits whose nearest `f64` is `number`.
    /// Returns `number` itself if there is none.
    #[must_use]
    #[inline]
    pub fn decimal(number: f64) -> Self {
        /// Bound of the scaled numbers: integers below it have at most 15 digits. Powers of ten up to 1e22 are exact.
        const LARGEST: f64 = 1e15;
        /// 1.5 2^52: adding it to a number of at most 2^51 rounds to an integer.
        const WHOLE: f64 = 6_755_399_441_055_744.0;
        if number == number.trunc() {
            return number.into();
        }
        for power in [1e3, 1e8, 1e15, 1e22] {
            let places = number * power;
            if places.abs() > LARGEST {
                break;
            }
            // Rounds to an integer without a function call.
            let digits = (places + WHOLE) - WHOLE;
            if digits / power == number {
                // The residual of a rounded quotient is representable as an `f64`.
                let rest = Self::from(digits) - Self::product(number, power);
                let (high, low) = quick_two_sum(number, rest.rounded() / power);
                return Self { high, low };
            }
        }
        number.into()
    }

    /// Returns the absolute value.
    #[must_use]
    pub fn abs(self) -> Self {
        if self.high < 0.0 { -self } else { self }
    }

    /// Returns the square root; 0 for a negative number.
    #[must_use]
    #[inline]
    pub fn sqrt(self) -> Self {
        if self.high <= 0.0 {
            return Self::ZERO;
        }
        self.root_of_positive()
    }

    /// Compares the number with zero.
    #[must_use]
    #[inline]
    pub fn sign(self) -> Ordering {
        self.high.partial_cmp(&0.0).unwrap_or(Ordering::Equal)
    }
}

impl<R: Real> Double<R> {
    /// Returns a - b, exactly.
    #[must_use]
    #[inline(always)]
    pub fn difference(a: R, b: R) -> Self {
        let (high, low) = two_sum(a, -b);
        Self { high, low }
    }

    /// Returns a + b, exactly.
    #[must_use]
    #[inline(always)]
    pub fn sum(a: R, b: R) -> Self {
        let (high, low) = two_sum(a, b);
        Self { high, low }
    }

    /// Returns a * b, exactly.
    #[must_use]
    #[inline(always)]
    pub fn product(a: R, b: R) -> Self {
        let (high, low) = two_product(a, b);
        Self { high, low }
    }

    /// Returns the product with a power of two, exactly.
    #[must_use]
    #[inline(always)]
    pub fn scaled(self, power: f64) -> Self {
        Self { high: self.high * power, low: self.low * power }
    }

    /// Returns the number rounded to `f64`.
    #[must_use]
    #[inline(always)]
    pub fn rounded(self) -> R {
        self.high
    }

    /// Returns the rounding error: the number minus its value rounded to `f64`.
    #[must_use]
    #[inline(always)]
    pub fn rest(self) -> R {
        self.low
    }

    /// Returns the square root of a positive number.
    #[inline(always)]
    pub(crate) fn root_of_positive(self) -> Self {
        // One Newton step: √x = r + (x - r^2) / (2 r) to first order.
        let root = self.high.sqrt();
        let residual = self - Self::product(root, root);
        let (high, low) = quick_two_sum(root, residual.high / (root * 2.0));
        Self { high, low }
    }
}

impl From<f64> for Double {
    #[inline]
    fn from(high: f64) -> Self {
        Self { high, low: 0.0 }
    }
}

impl<R: Real> Add for Double<R> {
    type Output = Self;

    #[inline(always)]
    fn add(self, other: Self) -> Self {
        let (high, error) = two_sum(self.high, other.high);
        let (low, low_error) = two_sum(self.low, other.low);
        let (high, error) = quick_two_sum(high, error + low);
        let (high, low) = quick_two_sum(high, error + low_error);
        Self { high, low }
    }
}

impl<R: Real> Neg for Double<R> {
    type Output = Self;

    #[inline(always)]
    fn neg(self) -> Self {
        Self { high: -self.high, low: -self.low }
    }
}

impl<R: Real> Sub for Double<R> {
    type Output = Self;

    #[inline(always)]
    fn sub(self, other: Self) -> Self {
        self + -other
    }
}

impl<R: Real> Mul for Double<R> {
    type Output = Self;

    #[inline(always)]
    fn mul(self, other: Self) -> Self {
        let (high, error) = two_product(self.high, other.high);
        let (high, low) = quick_two_sum(high, error + (self.high * other.low + self.low * other.high));
        Self { high, low }
    }
}

impl<R: Real> Div for Double<R> {
    type Output = Self;

    #[inline(always)]
    fn div(self, other: Self) -> Self {
        let first = self.high / other.high;
        let rest = self - other * first;
        let (high, low) = quick_two_sum(first, rest.high / other.high);
        Self { high, low }
    }
}

impl<R: Real> Mul<R> for Double<R> {
    type Output = Self;

    #[inline(always)]
    fn mul(self, other: R) -> Self {
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
    fn decimal_numbers_are_what_was_written() {
        for (sum, expected) in
            [([0.4, 0.3], 0.7), ([1.1, -0.4], 0.7), ([0.1, 0.2], 0.3), ([1e-9, 2e-9], 3e-9)]
        {
            assert_eq!((Double::decimal(sum[0]) + Double::decimal(sum[1])).rounded(), expected);
        }
        for whole in [0.0, -3.0, 1e15, 1e300, 5e-324, f64::MAX, 1.0 / 3.0 * 1e-30] {
            assert_eq!(Double::decimal(whole), Double::from(whole), "{whole:e}");
        }
        // Every number of few digits equals its decimal representation to 106 bits.
        for digits in 1..100_000_u32 {
            let number = Double::decimal(f64::from(digits) / 1e4);
            let rest = number * Double::from(1e4) - Double::from(f64::from(digits));
            assert!(rest.rounded().abs() <= f64::from(digits) * 1e-31, "{digits}");
        }
    }
}
