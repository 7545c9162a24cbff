//! Ray parameters with error bounds.

use super::double::Double;
use super::real::Real;

/// The `t` of a hit, with a bound of its error; of one ray, or one per lane.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) struct BoundedT<R = f64> {
    t: R,
    error: R,
}

impl<R: Real> BoundedT<R> {
    /// Returns a `t` with an error of at most `error`.
    #[must_use]
    #[inline(always)]
    pub(crate) fn within(t: R, error: R) -> Self {
        Self { t, error }
    }

    /// Rounds a `t` from double-double arithmetic to `f64`. The error bound is its rounding error.
    #[must_use]
    #[inline(always)]
    pub(crate) fn rounded(t: Double<R>) -> Self {
        Self { t: t.rounded(), error: t.rest().abs() * (1.0 + f64::EPSILON) }
    }

    /// Returns the rounded value.
    #[must_use]
    #[inline(always)]
    pub(crate) fn t(&self) -> R {
        self.t
    }

    /// Returns the error bound.
    #[must_use]
    #[inline(always)]
    pub(crate) fn error(&self) -> R {
        self.error
    }

    /// Returns the upper bound of the exact value.
    #[must_use]
    #[inline(always)]
    pub(crate) fn latest(&self) -> R {
        self.t + self.error
    }

    /// Returns the lower bound of the exact value.
    #[must_use]
    #[inline(always)]
    pub(crate) fn earliest(&self) -> R {
        self.t - self.error
    }

    /// Returns `one` where the mask is true, else `other`.
    #[inline(always)]
    pub(crate) fn pick(mask: R::Mask, one: Self, other: Self) -> Self {
        Self { t: R::pick(mask, one.t, other.t), error: R::pick(mask, one.error, other.error) }
    }

    /// Returns the later of two values. If their intervals overlap, the error bound covers both.
    #[must_use]
    #[inline(always)]
    pub(crate) fn later(self, other: Self) -> Self {
        let (first, second) = self.ordered(other);
        let apart = second.earliest().greater(first.latest());
        let own = apart | second.error.greater(first.error);
        Self { t: second.t, error: R::pick(own, second.error, first.error) }
    }

    /// Returns the earlier of two values. If their intervals overlap, the error bound covers both.
    #[must_use]
    #[inline(always)]
    pub(crate) fn earlier(self, other: Self) -> Self {
        let (first, second) = self.ordered(other);
        let apart = second.earliest().greater(first.latest());
        let own = apart | first.error.greater(second.error);
        Self { t: first.t, error: R::pick(own, first.error, second.error) }
    }

    /// Returns both values, the one with the smaller `t` first.
    #[inline(always)]
    fn ordered(self, other: Self) -> (Self, Self) {
        let ordered = self.t.less(other.t);
        (Self::pick(ordered, self, other), Self::pick(ordered, other, self))
    }

    /// Returns whether fewer than 28 bits are certain, about half of the bits of an `f64`.
    #[must_use]
    #[inline(always)]
    pub(crate) fn is_rough(&self) -> R::Mask {
        self.error.greater(self.t * (1.0 / 268_435_456.0))
    }

    /// Returns whether the value is accurate up to its own rounding.
    #[must_use]
    #[inline(always)]
    pub(crate) fn is_rounded(&self) -> R::Mask {
        self.error.less_or_equal(self.t * f64::EPSILON)
    }

    /// Returns whether the two exact values may be equal.
    #[must_use]
    #[inline(always)]
    pub(crate) fn may_equal(&self, other: &Self) -> R::Mask {
        self.earliest().less_or_equal(other.latest()) & other.earliest().less_or_equal(self.latest())
    }
}
