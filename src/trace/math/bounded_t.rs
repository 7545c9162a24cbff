//! Ray parameters with error bounds.

use super::double::Double;

/// The `t` of a hit, with a bound of its error.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct BoundedT {
    t: f64,
    error: f64,
}

impl BoundedT {
    /// Returns a `t` with an error of at most `error`.
    #[must_use]
    pub fn within(t: f64, error: f64) -> Self {
        Self { t, error }
    }

    /// Rounds a `t` from double-double arithmetic to `f64`. The error bound is its rounding error.
    #[must_use]
    pub fn rounded(t: Double) -> Self {
        Self { t: t.rounded(), error: t.rest().abs() * (1.0 + f64::EPSILON) }
    }

    /// Returns the rounded value.
    #[must_use]
    pub fn t(&self) -> f64 {
        self.t
    }

    /// Returns the error bound.
    #[must_use]
    pub(crate) fn error(&self) -> f64 {
        self.error
    }

    /// Returns the upper bound of the exact value.
    #[must_use]
    pub fn latest(&self) -> f64 {
        self.t + self.error
    }

    /// Returns the lower bound of the exact value.
    #[must_use]
    pub fn earliest(&self) -> f64 {
        self.t - self.error
    }

    /// Returns the later of two values. If their intervals overlap, the error bound covers both.
    #[must_use]
    pub(crate) fn later(self, other: Self) -> Self {
        let (first, second) = if self.t < other.t { (self, other) } else { (other, self) };
        if second.earliest() > first.latest() {
            second
        } else {
            Self { t: second.t, error: first.error.max(second.error) }
        }
    }

    /// Returns the earlier of two values. If their intervals overlap, the error bound covers both.
    #[must_use]
    pub(crate) fn earlier(self, other: Self) -> Self {
        let (first, second) = if self.t < other.t { (self, other) } else { (other, self) };
        if second.earliest() > first.latest() {
            first
        } else {
            Self { t: first.t, error: first.error.max(second.error) }
        }
    }

    /// Returns whether fewer than 28 bits are certain, about half of the bits of an `f64`.
    #[must_use]
    pub fn is_rough(&self) -> bool {
        self.error > self.t * (1.0 / 268_435_456.0)
    }

    /// Returns whether the value is accurate up to its own rounding.
    #[must_use]
    pub fn is_rounded(&self) -> bool {
        self.error <= self.t * f64::EPSILON
    }

    /// Returns whether the two exact values may be equal.
    #[must_use]
    pub fn may_equal(&self, other: &Self) -> bool {
        self.earliest() <= other.latest() && other.earliest() <= self.latest()
    }
}
