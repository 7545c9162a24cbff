//! Vectors whose rounding errors are kept beside them.

use glam::DVec3;

use super::double::Double;
use super::error_free::{two_product, two_products, two_sum, two_sums};
use super::vector::Double3;

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

    /// The sum of the products with double-doubles.
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
