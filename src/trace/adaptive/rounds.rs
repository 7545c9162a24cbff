//! Which samples of a pixel are taken when: at which instant of an open shutter, and in which round.

use std::ops::Range;

/// How a pixel's samples are divided among instants, and at each instant among rounds.
///
/// Every instant has a block of the pixel's sequence: sample s of n belongs to instant floor(s instants / n). A round takes the next
/// samples of every block, as many as all rounds before it together. So after each round a block's samples are a sequence's first 2^m,
/// which are spread evenly.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) struct Rounds {
    /// The most samples of a pixel.
    samples: u32,
    instants: u32,
    /// The samples of an instant in the first round.
    first: u32,
    /// The present round.
    round: u32,
}

/// The samples that one round takes at one instant.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) struct Portion {
    /// The first of them.
    pub(crate) from: u32,
    /// One beyond the last.
    pub(crate) to: u32,
    /// How many of the pixel's samples are taken before.
    pub(crate) before: u32,
}

impl Portion {
    /// Returns how many of the pixel's samples are taken after these.
    pub(crate) fn after(&self) -> u32 {
        self.before + (self.to - self.from)
    }

    /// Returns those that are left of a pixel that has so many samples already.
    pub(crate) fn rest(&self, samples: u32) -> Range<u32> {
        self.from + samples.saturating_sub(self.before)..self.to
    }
}

impl Rounds {
    /// Returns a single round with all samples.
    pub(crate) fn single(samples: u32, instants: u32) -> Self {
        Self { samples, instants: instants.max(1), first: u32::MAX, round: 0 }
    }

    /// Returns rounds that double the number of samples. The first has one, or one at each instant.
    pub(crate) fn doubling(samples: u32, instants: u32) -> Self {
        let instants = instants.max(1);
        Self { samples, instants, first: 1, round: 0 }
    }

    /// Returns the present round's samples at an instant.
    pub(crate) fn portion(&self, instant: u32) -> Portion {
        let (before, after) = (self.of_instant_before(), self.of_instant_after());
        let (start, length) = self.block(instant);
        let elsewhere: u32 = (0..self.instants)
            .filter(|other| *other != instant)
            .map(|other| self.block(other).1.min(if other < instant { after } else { before }))
            .sum();
        let (from, to) = (length.min(before), length.min(after));
        Portion { from: start + from, to: start + to, before: elsewhere + from }
    }

    /// Returns the number of a pixel's samples before the present round, and after it.
    pub(crate) fn taken(&self) -> (u32, u32) {
        let most =
            |of_instant: u32| (0..self.instants).map(|instant| self.block(instant).1.min(of_instant)).sum();
        (most(self.of_instant_before()), most(self.of_instant_after()))
    }

    /// Returns the most samples of a pixel.
    pub(crate) fn samples(&self) -> u32 {
        self.samples
    }

    /// Returns the last round in which all pixels have samples: there are eight after it, and four at each instant.
    pub(crate) fn floor_index(&self) -> u32 {
        if self.instants == 1 { 3 } else { 2 }
    }

    /// Returns the samples of a pixel after that.
    pub(crate) fn least(&self) -> u32 {
        Self { round: self.floor_index(), ..*self }.taken().1
    }

    /// Returns the present round, from 0.
    pub(crate) fn index(&self) -> u32 {
        self.round
    }

    /// Returns whether there are no samples left for another round.
    pub(crate) fn is_last(&self) -> bool {
        self.taken().1 == self.samples
    }

    /// Goes on to the next round.
    pub(crate) fn advance(&mut self) {
        self.round += 1;
    }

    fn of_instant_before(&self) -> u32 {
        self.round.checked_sub(1).map_or(0, |before| self.of_instant(before))
    }

    fn of_instant_after(&self) -> u32 {
        self.of_instant(self.round)
    }

    /// Returns the number of an instant's samples after a round, if its block has as many.
    fn of_instant(&self, round: u32) -> u32 {
        self.first.checked_shl(round).filter(|count| count >> round == self.first).unwrap_or(u32::MAX)
    }

    /// Returns the first sample of an instant, and how many it has.
    fn block(&self, instant: u32) -> (u32, u32) {
        let start = |instant: u32| {
            let start = (u64::from(instant) * u64::from(self.samples)).div_ceil(u64::from(self.instants));
            u32::try_from(start).unwrap_or(self.samples)
        };
        (start(instant), start(instant + 1) - start(instant))
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// All samples in the order in which they are taken, round by round.
    fn all(mut rounds: Rounds) -> Vec<Vec<u32>> {
        let mut taken = Vec::new();
        loop {
            let (before, after) = rounds.taken();
            let mut round = Vec::new();
            for instant in 0..rounds.instants {
                let Portion { from, to, before: so_far } = rounds.portion(instant);
                assert_eq!(so_far as usize, before as usize + round.len());
                round.extend(from..to);
            }
            assert_eq!(round.len(), (after - before) as usize);
            taken.push(round);
            if rounds.is_last() {
                return taken;
            }
            rounds.advance();
        }
    }

    #[test]
    fn every_sample_is_taken_once() {
        for samples in [1, 2, 3, 7, 8, 64, 100, 65_536] {
            for instants in [1, 2, 3, 7, 16, 256] {
                if instants > samples {
                    continue;
                }
                for rounds in [Rounds::single(samples, instants), Rounds::doubling(samples, instants)] {
                    let mut all = all(rounds).concat();
                    all.sort_unstable();
                    assert!(all.into_iter().eq(0..samples), "{rounds:?}");
                }
            }
        }
    }

    #[test]
    fn rounds_double_what_every_instant_has() {
        let counts = |rounds| all(rounds).iter().map(Vec::len).collect::<Vec<_>>();
        assert_eq!(counts(Rounds::single(100, 16)), [100]);
        assert_eq!(counts(Rounds::doubling(64, 1)), [1, 1, 2, 4, 8, 16, 32]);
        assert_eq!(counts(Rounds::doubling(64, 16)), [16, 16, 32]);
        assert_eq!(counts(Rounds::doubling(20, 1)), [1, 1, 2, 4, 8, 4]);
        assert_eq!(all(Rounds::doubling(8, 2))[1], [1, 5]);
        assert_eq!(all(Rounds::doubling(8, 2))[2], [2, 3, 6, 7]);
    }

    #[test]
    fn pixels_are_told_apart_with_eight_samples_and_four_at_each_instant() {
        for (samples, instants, least) in [(64, 1, 8), (5, 1, 5), (1024, 16, 64), (1024, 2, 8), (40, 16, 40)]
        {
            assert_eq!(Rounds::doubling(samples, instants).least(), least, "{samples} {instants}");
        }
    }
}
