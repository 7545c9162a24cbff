//! SIMD lanes as numbers of generic formulas.

use fearless_simd::{prelude::*, u64x8};

use super::lanes::{F64s, LEAST, MOST, Mask, fuses, none_below, splat};
use super::real::{
    BIAS, MANTISSA, MANTISSA_BITS, ROOT, ROUNDER, Real, Truth, UNBIAS, WHOLE_NUMBERS, absolute, split_product,
};

impl<S: Simd> Truth for Mask<S> {
    #[inline(always)]
    fn any(self) -> bool {
        self.any_true()
    }

    #[inline(always)]
    fn settled(self) -> bool {
        false
    }
}

impl<S: Simd> Real for F64s<S> {
    type Mask = Mask<S>;

    #[inline(always)]
    fn of(self, number: f64) -> Self {
        splat(self.simd, number)
    }

    #[inline(always)]
    fn less(self, other: Self) -> Mask<S> {
        self.simd_lt(other)
    }

    #[inline(always)]
    fn less_or_equal(self, other: Self) -> Mask<S> {
        self.simd_le(other)
    }

    #[inline(always)]
    fn greater(self, other: Self) -> Mask<S> {
        self.simd_gt(other)
    }

    #[inline(always)]
    fn pick(mask: Mask<S>, one: Self, other: Self) -> Self {
        mask.select(one, other)
    }

    #[inline(always)]
    fn min(self, other: Self) -> Self {
        self.simd.min_f64x8(self, other)
    }

    #[inline(always)]
    fn max(self, other: Self) -> Self {
        self.simd.max_f64x8(self, other)
    }

    #[inline(always)]
    fn abs(self) -> Self {
        self.simd.abs_f64x8(self)
    }

    #[inline(always)]
    fn sqrt(self) -> Self {
        self.simd.sqrt_f64x8(self)
    }

    #[inline(always)]
    fn copysign(self, other: Self) -> Self {
        self.simd.copysign_f64x8(self, other)
    }

    /// With fused multiply-subtract, the error is the fused difference of the exact and the rounded product. The error has at most 53 bits,
    /// none of which is lost unless it underflows. Dekker's splitting is exact under the same condition, if no half overflows, so both give
    /// the same number.
    #[inline(always)]
    fn two_product(self, other: Self) -> (Self, Self) {
        if fuses(self.simd) {
            let product = self * other;
            return (product, self.mul_sub(other, product));
        }
        split_product(self, other)
    }

    #[inline(always)]
    fn moderate(self) -> Mask<S> {
        let size = Real::abs(self);
        let zero = splat(self.simd, 0.0);
        (size.simd_ge(splat(self.simd, LEAST)) | size.simd_eq(zero)) & size.simd_lt(splat(self.simd, MOST))
    }

    #[inline(always)]
    fn moderate3(vector: [Self; 3]) -> Mask<S> {
        let (simd, sizes) = (vector[0].simd, absolute(vector));
        // A NaN makes the sum NaN, and the comparison false.
        let sum = sizes[0] + sizes[1] + sizes[2];
        sum.simd_lt(splat(simd, MOST)) & none_below(simd, sizes, LEAST)
    }

    #[inline(always)]
    fn power_of_two(self) -> Self {
        let bits: u64x8<S> = (self + (ROUNDER + 1023.0)).bitcast();
        (bits << MANTISSA).bitcast()
    }

    #[inline(always)]
    fn mantissa_and_exponent(self) -> (Self, Self) {
        let (simd, bits): (S, u64x8<S>) = (self.simd, self.bitcast());
        let above = bits + u64x8::splat(simd, (BIAS << MANTISSA).wrapping_sub(ROOT));
        let mantissa = (above & u64x8::splat(simd, MANTISSA_BITS)) + u64x8::splat(simd, ROOT);
        let exponent: Self = ((above >> MANTISSA) | u64x8::splat(simd, WHOLE_NUMBERS.to_bits())).bitcast();
        let mantissa: Self = mantissa.bitcast();
        (mantissa, exponent - UNBIAS)
    }
}
