//! Counters of escalations beyond `f64` arithmetic.

use std::ops::AddAssign;

/// Counts cases in which `f64` did not suffice. The picture is correct however large these numbers are.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct Escalations {
    /// Hits left undecided by the error bounds of `f64`, decided exactly.
    pub ambiguous: u64,
    /// Comparisons of two hits, or of a hit and the light, decided exactly.
    pub contested: u64,
    /// Points whose distance had too few certain bits for a single Newton step to make it accurate.
    pub rough: u64,
    /// Pixels whose sum overflowed and was clamped to a finite value.
    pub overflowed: u64,
}

impl Escalations {
    /// Returns the number of decisions and points that needed more than `f64`, of all kinds.
    #[must_use]
    pub fn total(&self) -> u64 {
        self.ambiguous + self.contested + self.rough
    }
}

impl AddAssign for Escalations {
    fn add_assign(&mut self, other: Self) {
        self.ambiguous += other.ambiguous;
        self.contested += other.contested;
        self.rough += other.rough;
        self.overflowed += other.overflowed;
    }
}
