//! Vectors with compensated rounding errors.

use super::double::Double;
use super::error_free::{two_product, two_sum};
use super::real::{Real, add, pick3};

/// A vector as an unevaluated sum of a value and its rounding error. It serves the single Newton step that refines an approximate `t`.
/// After cancellation its results are as accurate as in twice the working precision, without the cost of a [`Double`] for every
/// intermediate result (Ogita, Rump, Oishi, "Accurate Sum and Dot Product", 2005).
#[derive(Clone, Copy, Debug)]
pub(crate) struct Compensated<R> {
    value: [R; 3],
    rest: [R; 3],
}

impl<R: Real> Compensated<R> {
    /// Returns origin + t direction.
    #[inline(always)]
    pub(crate) fn along(origin: impl Into<[R; 3]>, direction: impl Into<[R; 3]>, t: R) -> Self {
        let (origin, direction) = (origin.into(), direction.into());
        let (mut value, mut rest) = (origin, origin);
        for axis in 0..3 {
            let (way, way_error) = two_product(direction[axis], t);
            let (sum, error) = two_sum(origin[axis], way);
            (value[axis], rest[axis]) = (sum, error + way_error);
        }
        Self { value, rest }
    }

    /// Subtracts a point.
    #[inline(always)]
    pub(crate) fn minus(self, point: impl Into<[R; 3]>) -> Self {
        let (Self { mut value, mut rest }, point) = (self, point.into());
        for axis in 0..3 {
            let (difference, error) = two_sum(value[axis], -point[axis]);
            (value[axis], rest[axis]) = two_sum(difference, error + rest[axis]);
        }
        Self { value, rest }
    }

    /// Returns the vector rounded to `f64`.
    #[inline(always)]
    pub(crate) fn rounded(self) -> [R; 3] {
        self.value
    }

    /// Adds a small displacement and rounds once.
    #[inline(always)]
    pub(crate) fn moved(self, way: impl Into<[R; 3]>) -> [R; 3] {
        add(self.value, add(self.rest, way.into()))
    }

    /// Returns the dot product with a vector of working precision.
    #[inline(always)]
    pub(crate) fn dot(self, other: impl Into<[R; 3]>) -> Double<R> {
        let other = other.into();
        let (mut products, mut errors) = (other, other);
        for axis in 0..3 {
            let (product, error) = two_product(self.value[axis], other[axis]);
            (products[axis], errors[axis]) = (product, error + self.rest[axis] * other[axis]);
        }
        summed(products, errors)
    }

    /// Returns the dot product with a double-double vector.
    #[inline(always)]
    pub(crate) fn dot_exact(self, high: impl Into<[R; 3]>, low: impl Into<[R; 3]>) -> Double<R> {
        let (high, low) = (high.into(), low.into());
        let (mut products, mut errors) = (high, high);
        for axis in 0..3 {
            let (product, error) = two_product(self.value[axis], high[axis]);
            let rest = self.rest[axis] * high[axis] + self.value[axis] * low[axis];
            (products[axis], errors[axis]) = (product, error + rest);
        }
        summed(products, errors)
    }

    /// Returns the cross product with a double-double vector.
    #[inline(always)]
    pub(crate) fn cross_exact(self, high: impl Into<[R; 3]>, low: impl Into<[R; 3]>) -> Self {
        let (high, low) = (high.into(), low.into());
        let Self { mut value, mut rest } = self;
        for axis in 0..3 {
            let (next, last) = ((axis + 1) % 3, (axis + 2) % 3);
            let (one, one_error) = two_product(self.value[next], high[last]);
            let (other, other_error) = two_product(self.value[last], high[next]);
            let one_rest = self.rest[next] * high[last] + self.value[next] * low[last];
            let other_rest = self.rest[last] * high[next] + self.value[last] * low[next];
            let (difference, error) = two_sum(one, -other);
            let rests = (one_error - other_error) + (one_rest - other_rest);
            (value[axis], rest[axis]) = two_sum(difference, error + rests);
        }
        Self { value, rest }
    }

    /// Returns `one` where the mask is true, else `other`.
    #[inline(always)]
    pub(crate) fn pick(mask: R::Mask, one: Self, other: Self) -> Self {
        Self { value: pick3(mask, one.value, other.value), rest: pick3(mask, one.rest, other.rest) }
    }

    /// Returns |self|^2 - radius^2, rounded to `f64`.
    #[inline(always)]
    pub(crate) fn beyond(self, radius: R) -> R {
        let (high, low) = two_product(radius, radius);
        self.beyond_square(Double { high, low })
    }

    /// Returns |self|^2 - square, rounded to `f64`.
    #[inline(always)]
    pub(crate) fn beyond_square(self, square: Double<R>) -> R {
        let (mut squares, mut errors) = (self.value, self.rest);
        for axis in 0..3 {
            let value = self.value[axis];
            let (square, error) = two_product(value, value);
            let twice = value * 2.0;
            (squares[axis], errors[axis]) = (square, error + self.rest[axis] * twice);
        }
        let (sum, sum_error) = two_sum(squares[0], squares[1]);
        let (sum, other_error) = two_sum(sum, squares[2]);
        let (sum, last_error) = two_sum(sum, -square.high);
        let error = (errors[0] + errors[1] + errors[2] - square.low) + (sum_error + other_error + last_error);
        sum + error
    }
}

impl<R> From<[Double<R>; 3]> for Compensated<R> {
    #[inline(always)]
    fn from([x, y, z]: [Double<R>; 3]) -> Self {
        Self { value: [x.high, y.high, z.high], rest: [x.low, y.low, z.low] }
    }
}

/// Returns the sum of three numbers and their errors.
#[inline(always)]
fn summed<R: Real>(parts: [R; 3], errors: [R; 3]) -> Double<R> {
    let (sum, sum_error) = two_sum(parts[0], parts[1]);
    let (sum, other_error) = two_sum(sum, parts[2]);
    Double::sum(sum, (errors[0] + errors[1] + errors[2]) + (sum_error + other_error))
}
