//! [`Double`](super::Double)s of eight lanes.

use std::ops::{Add, Mul, Sub};

use fearless_simd::prelude::*;

use super::lanes::{F64s, quick_two_sum, two_product, two_sum};

/// An unevaluated sum `high + low` in each of half of the lanes. Its operations make those of [`Double`](super::Double) in their
/// order, for numbers whose products are [`moderate`](super::moderate).
#[derive(Clone, Copy)]
pub(crate) struct DoubleLanes<S: Simd> {
    pub(crate) high: F64s<S>,
    pub(crate) low: F64s<S>,
}

impl<S: Simd> DoubleLanes<S> {
    /// a - b, exactly.
    #[inline(always)]
    pub(crate) fn difference(a: F64s<S>, b: F64s<S>) -> Self {
        let (high, low) = two_sum(a, -b);
        Self { high, low }
    }

    /// a + b, exactly.
    #[inline(always)]
    pub(crate) fn sum(a: F64s<S>, b: F64s<S>) -> Self {
        let (high, low) = two_sum(a, b);
        Self { high, low }
    }

    /// a * b, exactly.
    #[inline(always)]
    pub(crate) fn product(a: F64s<S>, b: F64s<S>) -> Self {
        let (high, low) = two_product(a, b);
        Self { high, low }
    }

    /// The square root of numbers greater than zero.
    #[inline(always)]
    pub(crate) fn sqrt(self) -> Self {
        let root = self.high.sqrt();
        let residual = self - Self::product(root, root);
        let (high, low) = quick_two_sum(root, residual.high / (root * 2.0));
        Self { high, low }
    }
}

impl<S: Simd> Add for DoubleLanes<S> {
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

impl<S: Simd> Sub for DoubleLanes<S> {
    type Output = Self;

    #[inline(always)]
    fn sub(self, other: Self) -> Self {
        self + Self { high: -other.high, low: -other.low }
    }
}

impl<S: Simd> Mul for DoubleLanes<S> {
    type Output = Self;

    #[inline(always)]
    fn mul(self, other: Self) -> Self {
        let (high, error) = two_product(self.high, other.high);
        let (high, low) = quick_two_sum(high, error + (self.high * other.low + self.low * other.high));
        Self { high, low }
    }
}

impl<S: Simd> Mul<F64s<S>> for DoubleLanes<S> {
    type Output = Self;

    #[inline(always)]
    fn mul(self, other: F64s<S>) -> Self {
        let (high, error) = two_product(self.high, other);
        let (high, low) = quick_two_sum(high, error + self.low * other);
        Self { high, low }
    }
}
