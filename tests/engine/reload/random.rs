//! Deterministic pseudo-random values for scenes.

pub(crate) use crate::splitmix::Random;

impl Random {
    pub(crate) fn pick<'a, T: ?Sized>(&mut self, choices: &[&'a T]) -> &'a T {
        choices[self.index(choices.len())]
    }

    /// Returns a number in -4..=4 in steps of 1/8, so that exact coincidences and zeros of both signs occur.
    pub(crate) fn number(&mut self) -> f64 {
        let sign = if self.once_in(2) { 1.0 } else { -1.0 };
        sign * f64::from(u32::try_from(self.index(33)).unwrap()) / 8.0
    }

    /// Returns a number in 0..=1 in steps of 1/16.
    pub(crate) fn share(&mut self) -> f64 {
        f64::from(u32::try_from(self.index(17)).unwrap()) / 16.0
    }

    /// Returns three numbers in the notation of scenes.
    pub(crate) fn triple(&mut self) -> String {
        format!("({:?}, {:?}, {:?})", self.number(), self.number(), self.number())
    }

    pub(crate) fn light(&mut self) -> String {
        format!("({:?}, {:?}, {:?})", self.share(), self.share(), self.share())
    }

    pub(crate) fn color(&mut self) -> String {
        format!("({}, {}, {})", self.index(256), self.index(256), self.index(256))
    }
}
