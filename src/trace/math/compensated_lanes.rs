//! [`Compensated3`](super::Compensated3)s of eight lanes.

use fearless_simd::prelude::*;

use super::double_lanes::DoubleLanes;
use super::lanes::{F64s, F64s3, add, two_product, two_sum};

/// Vectors whose rounding errors are kept beside them: [`Compensated3`](super::Compensated3) in every lane.
#[derive(Clone, Copy)]
pub(crate) struct CompensatedLanes<S: Simd> {
    value: F64s3<S>,
    rest: F64s3<S>,
}

impl<S: Simd> CompensatedLanes<S> {
    /// origin + t direction.
    #[inline(always)]
    pub(crate) fn along(origin: F64s3<S>, direction: F64s3<S>, t: F64s<S>) -> Self {
        let (mut value, mut rest) = (origin, origin);
        for axis in 0..3 {
            let (way, way_error) = two_product(direction[axis], t);
            let (sum, error) = two_sum(origin[axis], way);
            (value[axis], rest[axis]) = (sum, error + way_error);
        }
        Self { value, rest }
    }

    /// Less a point.
    #[inline(always)]
    pub(crate) fn minus(self, point: F64s3<S>) -> Self {
        let Self { mut value, mut rest } = self;
        for axis in 0..3 {
            let (difference, error) = two_sum(value[axis], -point[axis]);
            (value[axis], rest[axis]) = two_sum(difference, error + rest[axis]);
        }
        Self { value, rest }
    }

    /// Rounded to `f64`.
    #[inline(always)]
    pub(crate) fn rounded(self) -> F64s3<S> {
        self.value
    }

    /// Plus a short way, rounded once.
    #[inline(always)]
    pub(crate) fn moved(self, way: F64s3<S>) -> F64s3<S> {
        add(self.value, add(self.rest, way))
    }

    /// The sum of the products with plain numbers, rounded to `f64`.
    #[inline(always)]
    pub(crate) fn dot(self, other: F64s3<S>) -> F64s<S> {
        let (sum, error) = self.products(other);
        sum + error
    }

    /// The same, not rounded.
    #[inline(always)]
    pub(crate) fn dot_double(self, other: F64s3<S>) -> DoubleLanes<S> {
        let (sum, error) = self.products(other);
        DoubleLanes::sum(sum, error)
    }

    #[inline(always)]
    fn products(self, other: F64s3<S>) -> (F64s<S>, F64s<S>) {
        let (mut products, mut errors) = (other, other);
        for axis in 0..3 {
            let (product, error) = two_product(self.value[axis], other[axis]);
            (products[axis], errors[axis]) = (product, error + self.rest[axis] * other[axis]);
        }
        summed(products, errors)
    }

    /// The sum of the products with double-doubles.
    #[inline(always)]
    pub(crate) fn dot_exact(self, high: F64s3<S>, low: F64s3<S>) -> DoubleLanes<S> {
        let (mut products, mut errors) = (high, high);
        for axis in 0..3 {
            let (product, error) = two_product(self.value[axis], high[axis]);
            let rest = self.rest[axis] * high[axis] + self.value[axis] * low[axis];
            (products[axis], errors[axis]) = (product, error + rest);
        }
        let (sum, error) = summed(products, errors);
        DoubleLanes::sum(sum, error)
    }

    /// The square of its length less that of a radius, rounded to `f64`.
    #[inline(always)]
    pub(crate) fn beyond(self, radius: F64s<S>) -> F64s<S> {
        let (mut squares, mut errors) = (self.value, self.rest);
        for axis in 0..3 {
            let value = self.value[axis];
            let (square, error) = two_product(value, value);
            let twice = value * 2.0;
            (squares[axis], errors[axis]) = (square, error + self.rest[axis] * twice);
        }
        let (square, square_error) = two_product(radius, radius);
        let (sum, sum_error) = two_sum(squares[0], squares[1]);
        let (sum, other_error) = two_sum(sum, squares[2]);
        let (sum, last_error) = two_sum(sum, -square);
        let error =
            (errors[0] + errors[1] + errors[2] - square_error) + (sum_error + other_error + last_error);
        sum + error
    }
}

impl<S: Simd> From<[DoubleLanes<S>; 3]> for CompensatedLanes<S> {
    #[inline(always)]
    fn from([x, y, z]: [DoubleLanes<S>; 3]) -> Self {
        Self { value: [x.high, y.high, z.high], rest: [x.low, y.low, z.low] }
    }
}

/// The sum of three numbers that have errors, and what is left over.
#[inline(always)]
fn summed<S: Simd>(parts: F64s3<S>, errors: F64s3<S>) -> (F64s<S>, F64s<S>) {
    let (sum, sum_error) = two_sum(parts[0], parts[1]);
    let (sum, other_error) = two_sum(sum, parts[2]);
    (sum, (errors[0] + errors[1] + errors[2]) + (sum_error + other_error))
}
