//! How often more arithmetic than `f64` was called for.

use std::ops::AddAssign;

/// Counts how often `f64` did not suffice. The picture is right however large these numbers are.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct Escalations {
    /// Hits that `f64`'s error bounds left open, decided exactly.
    pub ambiguous: u64,
    /// Comparisons of two hits, or of a hit and the light, decided exactly.
    pub contested: u64,
    /// Points whose distance had so few certain bits that one Newton step would not have made it right.
    pub rough: u64,
    /// Pixels whose sum overflowed, and that were kept finite.
    pub overflowed: u64,
}

impl Escalations {
    /// Questions answered by more than `f64`, of every kind.
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
