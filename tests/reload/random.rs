//! Numbers that look random, the same every time.

/// A generator of 64-bit words (Steele, Lea, Flood, "Fast Splittable Pseudorandom Number Generators", 2014).
pub(crate) struct Random(pub(crate) u64);

impl Random {
    pub(crate) fn bits(&mut self) -> u64 {
        self.0 = self.0.wrapping_add(0x9e37_79b9_7f4a_7c15);
        let mut z = self.0;
        z = (z ^ (z >> 30)).wrapping_mul(0xbf58_476d_1ce4_e5b9);
        z = (z ^ (z >> 27)).wrapping_mul(0x94d0_49bb_1331_11eb);
        z ^ (z >> 31)
    }

    /// Yes once in so many times.
    pub(crate) fn once_in(&mut self, times: u64) -> bool {
        self.bits().is_multiple_of(times)
    }

    /// An index below `length`.
    pub(crate) fn below(&mut self, length: usize) -> usize {
        usize::try_from(self.bits() % u64::try_from(length).unwrap()).unwrap()
    }

    pub(crate) fn pick<'a, T: ?Sized>(&mut self, choices: &[&'a T]) -> &'a T {
        choices[self.below(choices.len())]
    }

    /// In -4..=4 by eighths, so that exact coincidences happen; zeros of both signs among them.
    pub(crate) fn number(&mut self) -> f64 {
        let sign = if self.once_in(2) { 1.0 } else { -1.0 };
        sign * f64::from(u32::try_from(self.below(33)).unwrap()) / 8.0
    }

    /// In 0..=1 by sixteenths.
    pub(crate) fn share(&mut self) -> f64 {
        f64::from(u32::try_from(self.below(17)).unwrap()) / 16.0
    }

    /// As a scene has three numbers.
    pub(crate) fn triple(&mut self) -> String {
        format!("({:?}, {:?}, {:?})", self.number(), self.number(), self.number())
    }

    pub(crate) fn light(&mut self) -> String {
        format!("({:?}, {:?}, {:?})", self.share(), self.share(), self.share())
    }

    pub(crate) fn color(&mut self) -> String {
        format!("({}, {}, {})", self.below(256), self.below(256), self.below(256))
    }
}
