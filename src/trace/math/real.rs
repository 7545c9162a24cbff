//! Formulas that are generic over scalars and SIMD lanes: the operations that both support.

use std::f64::consts::FRAC_1_SQRT_2;
use std::ops::{Add, BitAnd, BitOr, Div, Mul, Neg, Not, Sub};

use glam::DVec3;

/// 2^52, from which on all numbers are integers, and 1.5 2^52, around which the spacing of numbers is 1.
pub(super) const WHOLE_NUMBERS: f64 = 4_503_599_627_370_496.0;
pub(super) const ROUNDER: f64 = 1.5 * WHOLE_NUMBERS;

/// Bits of √½, the lower end of the mantissa range, and the bias that keeps exponents non-negative.
pub(super) const ROOT: u64 = FRAC_1_SQRT_2.to_bits();
pub(super) const BIAS: u64 = 1024;
pub(super) const UNBIAS: f64 = WHOLE_NUMBERS + 1024.0;

/// Number of stored mantissa bits, and their mask.
pub(super) const MANTISSA: u32 = f64::MANTISSA_DIGITS - 1;
pub(super) const MANTISSA_BITS: u64 = (1 << MANTISSA) - 1;

/// 2^27 + 1, the factor of Veltkamp's splitting.
const SPLITTER: f64 = 134_217_729.0;

/// A truth value, or a mask of half of the lanes.
pub trait Truth: Copy + BitAnd<Output = Self> + BitOr<Output = Self> + Not<Output = Self> {
    /// Returns whether it is true, for a mask in any lane.
    fn any(self) -> bool;

    /// Returns whether it is true, so that the remaining cases need not be evaluated. Always `false` for lanes, where the branch does not
    /// pay off.
    fn settled(self) -> bool;
}

/// A number, or one number per lane in half of the lanes.
pub trait Real:
    Copy
    + Add<Output = Self>
    + Sub<Output = Self>
    + Mul<Output = Self>
    + Div<Output = Self>
    + Neg<Output = Self>
    + Add<f64, Output = Self>
    + Sub<f64, Output = Self>
    + Mul<f64, Output = Self>
{
    /// Result type of comparisons.
    type Mask: Truth;

    /// Returns `number`, in every lane.
    fn of(self, number: f64) -> Self;

    /// Returns whether `self < other`.
    fn less(self, other: Self) -> Self::Mask;

    /// Returns whether `self <= other`.
    fn less_or_equal(self, other: Self) -> Self::Mask;

    /// Returns whether `self > other`.
    fn greater(self, other: Self) -> Self::Mask;

    /// Returns `one` where the mask is true, else `other`.
    fn pick(mask: Self::Mask, one: Self, other: Self) -> Self;

    /// Returns the smaller number; of two zeros, either. Unspecified for NaN.
    fn min(self, other: Self) -> Self;

    /// Returns the larger number; of two zeros, either. Unspecified for NaN.
    fn max(self, other: Self) -> Self;

    /// Returns the absolute value.
    fn abs(self) -> Self;

    /// Returns the square root.
    fn sqrt(self) -> Self;

    /// Returns the magnitude of `self` with the sign of `other`.
    fn copysign(self, other: Self) -> Self;

    /// Returns the rounded product and its exact error, barring underflow and overflow. Requires [`moderate`] numbers.
    fn two_product(self, other: Self) -> (Self, Self);

    /// Computes [`moderate`].
    fn moderate(self) -> Self::Mask;

    /// Computes [`moderate3`].
    fn moderate3(vector: [Self; 3]) -> Self::Mask;

    /// Returns 2^self, for an integer in -1022..=1023.
    fn power_of_two(self) -> Self;

    /// Returns m and e with self = m 2^e and m in √½..√2, for a positive normal number.
    fn mantissa_and_exponent(self) -> (Self, Self);

    /// Returns `one` where `self < bound`, else `other`.
    #[inline(always)]
    fn if_less(self, bound: Self, one: Self, other: Self) -> Self {
        Self::pick(self.less(bound), one, other)
    }
}

impl Truth for bool {
    #[inline(always)]
    fn any(self) -> bool {
        self
    }

    #[inline(always)]
    fn settled(self) -> bool {
        self
    }
}

impl Real for f64 {
    type Mask = bool;

    #[inline(always)]
    fn of(self, number: f64) -> Self {
        number
    }

    #[inline(always)]
    fn less(self, other: Self) -> bool {
        self < other
    }

    #[inline(always)]
    fn less_or_equal(self, other: Self) -> bool {
        self <= other
    }

    #[inline(always)]
    fn greater(self, other: Self) -> bool {
        self > other
    }

    #[inline(always)]
    fn pick(mask: bool, one: Self, other: Self) -> Self {
        if mask { one } else { other }
    }

    #[inline(always)]
    fn min(self, other: Self) -> Self {
        if self < other { self } else { other }
    }

    #[inline(always)]
    fn max(self, other: Self) -> Self {
        if self > other { self } else { other }
    }

    #[inline(always)]
    fn abs(self) -> Self {
        Self::abs(self)
    }

    #[inline(always)]
    fn sqrt(self) -> Self {
        Self::sqrt(self)
    }

    #[inline(always)]
    fn copysign(self, other: Self) -> Self {
        Self::copysign(self, other)
    }

    #[inline(always)]
    fn two_product(self, other: Self) -> (Self, Self) {
        split_product(self, other)
    }

    #[inline(always)]
    fn moderate(self) -> bool {
        true
    }

    #[inline(always)]
    fn moderate3(_: [Self; 3]) -> bool {
        true
    }

    #[inline(always)]
    fn power_of_two(self) -> Self {
        Self::from_bits((self + (ROUNDER + 1023.0)).to_bits() << MANTISSA)
    }

    #[inline(always)]
    fn mantissa_and_exponent(self) -> (Self, Self) {
        let above = self.to_bits().wrapping_add((BIAS << MANTISSA).wrapping_sub(ROOT));
        let mantissa = Self::from_bits((above & MANTISSA_BITS) + ROOT);
        (mantissa, Self::from_bits(above >> MANTISSA | WHOLE_NUMBERS.to_bits()) - UNBIAS)
    }
}

/// Returns the rounded product and its exact error without fused operations (Dekker 1971, with Veltkamp's splitting).
#[inline(always)]
pub(super) fn split_product<R: Real>(a: R, b: R) -> (R, R) {
    let product = a * b;
    let (a_high, a_low) = split(a);
    let (b_high, b_low) = split(b);
    let error = ((a_high * b_high - product) + a_high * b_low + a_low * b_high) + a_low * b_low;
    (product, error)
}

/// Splits a number into two halves of at most 26 bits each.
#[inline(always)]
fn split<R: Real>(a: R) -> (R, R) {
    let scaled = a * SPLITTER;
    let high = scaled - (scaled - a);
    (high, a - high)
}

/// Returns whether a number is zero or of a magnitude in 2^-400..2^400, so that products of two such numbers and their rounding errors are
/// normal numbers or zero. Lanes that are not are left to scalar code, whose own result therefore is always true.
#[inline(always)]
pub(crate) fn moderate<R: Real>(number: R) -> R::Mask {
    number.moderate()
}

/// Applies [`moderate`] to three numbers. Their magnitudes must also sum to less than 2^400.
#[inline(always)]
pub(crate) fn moderate3<R: Real>(vector: [R; 3]) -> R::Mask {
    R::moderate3(vector)
}

/// Returns `vector`, in every lane that `like` has.
#[inline(always)]
pub(crate) fn spread<R: Real>(like: R, vector: DVec3) -> [R; 3] {
    [like.of(vector.x), like.of(vector.y), like.of(vector.z)]
}

/// Returns `one` where the mask is true, else `other`.
#[inline(always)]
pub(crate) fn pick3<R: Real>(mask: R::Mask, one: [R; 3], other: [R; 3]) -> [R; 3] {
    [R::pick(mask, one[0], other[0]), R::pick(mask, one[1], other[1]), R::pick(mask, one[2], other[2])]
}

#[inline(always)]
pub(crate) fn negative<R: Real>([x, y, z]: [R; 3]) -> [R; 3] {
    [-x, -y, -z]
}

/// Returns the dot product, summed in the order of `DVec3::dot`.
#[inline(always)]
pub(crate) fn dot<R: Real>(a: [R; 3], b: [R; 3]) -> R {
    a[0] * b[0] + a[1] * b[1] + a[2] * b[2]
}

#[inline(always)]
pub(crate) fn cross<R: Real>([ax, ay, az]: [R; 3], [bx, by, bz]: [R; 3]) -> [R; 3] {
    [ay * bz - az * by, az * bx - ax * bz, ax * by - ay * bx]
}

#[inline(always)]
pub(crate) fn add<R: Real>(a: [R; 3], b: [R; 3]) -> [R; 3] {
    [a[0] + b[0], a[1] + b[1], a[2] + b[2]]
}

#[inline(always)]
pub(crate) fn subtract<R: Real>(a: [R; 3], b: [R; 3]) -> [R; 3] {
    [a[0] - b[0], a[1] - b[1], a[2] - b[2]]
}

#[inline(always)]
pub(crate) fn times<R: Real>(a: [R; 3], factor: R) -> [R; 3] {
    [a[0] * factor, a[1] * factor, a[2] * factor]
}

#[inline(always)]
pub(crate) fn absolute<R: Real>([x, y, z]: [R; 3]) -> [R; 3] {
    [x.abs(), y.abs(), z.abs()]
}

#[cfg(test)]
mod tests {
    use proptest::prelude::*;

    use super::*;
    use crate::trace::math::same_bits::{Formulas, compare};
    use crate::trace::math::{Compensated, Double};

    /// Applies every operation of [`Real`] and converts masks to numbers.
    fn operations<R: Real>(a: R, b: R) -> [R; 17] {
        let (one, zero) = (a.of(1.0), a.of(0.0));
        let number = |mask: R::Mask| R::pick(mask, one, zero);
        let (less, greater) = (a.less(b), a.greater(b));
        [
            a + b,
            a - b,
            a * b,
            a / b,
            -a,
            a + 0.5,
            a * 0.5,
            a.abs().sqrt(),
            a.copysign(b),
            number(less),
            number(greater),
            number(less & !greater),
            number(less | greater),
            a.if_less(b, b, a),
            number(a.less_or_equal(b)),
            // The sign of a zero is unspecified.
            R::pick(!(less | greater), zero, a.min(b)),
            R::pick(!(less | greater), zero, a.max(b)),
        ]
    }

    /// Evaluates formulas with error-free products, for numbers whose products neither overflow nor underflow.
    fn formulas<R: Real>([a, b, c]: [R; 3]) -> [R; 10] {
        let (one, other) = (Double::product(a, b), Double::difference(b, c));
        let place = Compensated::along([a, b, c], [c, a, b], b).minus([b, c, a]);
        let (quotient, product, sum) = (one / other, one * other, one + other);
        let [x, y, z] = place.rounded();
        let height = place.dot([c, b, a]);
        [
            quotient.high,
            quotient.low,
            product.low,
            sum.high,
            sum.low,
            x + y + z,
            height.high,
            height.low,
            place.beyond(c),
            {
                let root = Double { high: one.high.abs(), low: a.of(0.0) }.root_of_positive();
                root.low
            },
        ]
    }

    struct Operations;
    impl Formulas<2, 17> for Operations {
        #[inline(always)]
        fn evaluate<R: Real>(&self, [a, b]: [R; 2]) -> [R; 17] {
            operations(a, b)
        }
    }

    struct Compositions;
    impl Formulas<3, 10> for Compositions {
        #[inline(always)]
        fn evaluate<R: Real>(&self, arguments: [R; 3]) -> [R; 10] {
            formulas(arguments)
        }
    }

    proptest! {
        #![proptest_config(ProptestConfig { cases: 20_000, failure_persistence: None, ..ProptestConfig::default() })]

        #[test]
        fn operations_of_lanes_have_the_bits_of_numbers(a in any::<f64>(), b in prop_oneof![any::<f64>(), Just(0.0), Just(-0.0)]) {
            compare(&Operations, [a, b])?;
        }

        #[test]
        fn formulas_of_lanes_have_the_bits_of_numbers(numbers in prop::array::uniform3((1.0..2.0_f64, -90..90_i32, any::<bool>()))) {
            let arguments = numbers.map(|(mantissa, exponent, minus)| {
                libm::ldexp(if minus { -mantissa } else { mantissa }, exponent)
            });
            compare(&Compositions, arguments)?;
        }
    }
}
