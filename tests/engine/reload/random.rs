//! Numbers that look random, the same every time.

pub(crate) use crate::splitmix::Random;

impl Random {
    pub(crate) fn pick<'a, T: ?Sized>(&mut self, choices: &[&'a T]) -> &'a T {
        choices[self.index(choices.len())]
    }

    /// In -4..=4 by eighths, so that exact coincidences happen; zeros of both signs among them.
    pub(crate) fn number(&mut self) -> f64 {
        let sign = if self.once_in(2) { 1.0 } else { -1.0 };
        sign * f64::from(u32::try_from(self.index(33)).unwrap()) / 8.0
    }

    /// In 0..=1 by sixteenths.
    pub(crate) fn share(&mut self) -> f64 {
        f64::from(u32::try_from(self.index(17)).unwrap()) / 16.0
    }

    /// As a scene has three numbers.
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
