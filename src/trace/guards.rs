//! How often arithmetic had to be helped.

use std::ops::AddAssign;

/// How often the kernel's guards stepped in. Numbers to be curious about: the picture is right however large they are.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct Guards {
    /// Does the ray meet the shape? Decided exactly, as `f64`'s error bounds left it open.
    pub open: u64,
    /// Which of two is nearer, or is it before the light? Decided exactly.
    pub contested: u64,
    /// Points whose distance had so few certain bits that one Newton step would not have made it right.
    pub rough: u64,
    /// Pixels whose sum overflowed, and that were kept finite.
    pub overflowed: u64,
}

impl Guards {
    /// Questions answered by more than `f64`, of every kind.
    #[must_use]
    pub fn escalations(&self) -> u64 {
        self.open + self.contested + self.rough
    }
}

impl AddAssign for Guards {
    fn add_assign(&mut self, other: Self) {
        self.open += other.open;
        self.contested += other.contested;
        self.rough += other.rough;
        self.overflowed += other.overflowed;
    }
}
