//! Where a ray meets a shape, with what is known of its error.

use super::double::Double;

/// The `t` of a meeting and a bound of its error.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct BoundedT {
    t: f64,
    error: f64,
}

impl BoundedT {
    /// A `t` that is off by at most `error`.
    #[must_use]
    pub fn within(t: f64, error: f64) -> Self {
        Self { t, error }
    }

    /// A `t` that was computed in double-double arithmetic and rounded to `f64`.
    #[must_use]
    pub fn rounded(t: Double) -> Self {
        Self { t: t.rounded(), error: t.rest().abs() * (1.0 + f64::EPSILON) }
    }

    /// The value, rounded.
    #[must_use]
    pub fn t(&self) -> f64 {
        self.t
    }

    /// The bound of its error.
    #[must_use]
    pub(crate) fn error(&self) -> f64 {
        self.error
    }

    /// The largest that it may really be.
    #[must_use]
    pub fn latest(&self) -> f64 {
        self.t + self.error
    }

    /// The smallest that it may really be.
    #[must_use]
    pub fn earliest(&self) -> f64 {
        self.t - self.error
    }

    /// The later of two. Where either may be the later one, the bounds allow for both.
    #[must_use]
    pub(crate) fn later(self, other: Self) -> Self {
        let (first, second) = if self.t < other.t { (self, other) } else { (other, self) };
        if second.earliest() > first.latest() {
            second
        } else {
            Self { t: second.t, error: first.error.max(second.error) }
        }
    }

    /// The earlier of two, likewise.
    #[must_use]
    pub(crate) fn earlier(self, other: Self) -> Self {
        let (first, second) = if self.t < other.t { (self, other) } else { (other, self) };
        if second.earliest() > first.latest() {
            first
        } else {
            Self { t: first.t, error: first.error.max(second.error) }
        }
    }

    /// Returns whether it has fewer than 28 certain bits, about half of an `f64`'s.
    #[must_use]
    pub fn is_rough(&self) -> bool {
        self.error > self.t * (1.0 / 268_435_456.0)
    }

    /// Returns whether it is right up to its rounding.
    #[must_use]
    pub fn is_rounded(&self) -> bool {
        self.error <= self.t * f64::EPSILON
    }

    /// Returns whether both may be the same.
    #[must_use]
    pub fn may_equal(&self, other: &Self) -> bool {
        self.earliest() <= other.latest() && other.earliest() <= self.latest()
    }
}
