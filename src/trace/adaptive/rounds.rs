//! Which samples of a pixel are taken when: at which instant of an open shutter, and in which round.

use std::ops::Range;

/// How a pixel's samples are divided among instants, and at each instant among rounds.
///
/// Every instant has a block of the pixel's sequence: sample s of n belongs to instant floor(s instants / n). The first round takes two
/// samples of every block, and every other as many as all rounds before it together. So after each round a block's samples are a
/// sequence's first 2^m, which are spread evenly, and so are both halves of them.
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
    /// One beyond the last of the first half of a first round's; there is none in later rounds.
    pub(crate) halfway: u32,
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

    /// Returns rounds that double the number of samples. The first has two, or two at each instant.
    pub(crate) fn doubling(samples: u32, instants: u32) -> Self {
        Self { samples, instants: instants.max(1), first: 2, round: 0 }
    }

    /// Returns the present round's samples at an instant.
    pub(crate) fn portion(&self, instant: u32) -> Portion {
        let (before, after) = (self.of_instant_before(), self.of_instant_after());
        let (start, length) = self.block(instant);
        let elsewhere: u32 = (0..self.instants)
            .filter(|other| *other != instant)
            .map(|other| self.block(other).1.min(if other < instant { after } else { before }))
            .sum();
        let [from, to, half] = [before, after, self.first_half()].map(|count| length.min(count));
        Portion { from: start + from, to: start + to, halfway: start + half, before: elsewhere + from }
    }

    /// Returns the number of a pixel's samples after the present round.
    pub(crate) fn taken(&self) -> u32 {
        self.of_all(self.of_instant_after())
    }

    /// Returns the number of a pixel's samples in the first half of those after the present round: there are as many before it, but
    /// before the first.
    pub(crate) fn first_half_taken(&self) -> u32 {
        self.of_all(self.of_instant_before().max(self.first_half()))
    }

    /// Returns the most samples of a pixel.
    pub(crate) fn samples(&self) -> u32 {
        self.samples
    }

    /// Returns the samples of a pixel after the first round: all have so many.
    pub(crate) fn least(&self) -> u32 {
        Self { round: 0, ..*self }.taken()
    }

    /// Returns whether the present round is the first.
    pub(crate) fn is_first(&self) -> bool {
        self.round == 0
    }

    /// Returns whether there are no samples left for another round.
    pub(crate) fn is_last(&self) -> bool {
        self.taken() == self.samples
    }

    /// Goes on to the next round.
    pub(crate) fn advance(&mut self) {
        self.round += 1;
    }

    /// Returns the samples of an instant in the first half of the first round.
    fn first_half(&self) -> u32 {
        self.first / 2
    }

    /// Returns the samples of a pixel that has so many at each instant, if their blocks have as many.
    fn of_all(&self, of_instant: u32) -> u32 {
        (0..self.instants).map(|instant| self.block(instant).1.min(of_instant)).sum()
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
        let mut taken: Vec<Vec<u32>> = Vec::new();
        loop {
            let before = taken.iter().map(Vec::len).sum::<usize>();
            let mut round = Vec::new();
            for instant in 0..rounds.instants {
                let Portion { from, to, before: so_far, .. } = rounds.portion(instant);
                assert_eq!(so_far as usize, before + round.len());
                round.extend(from..to);
            }
            assert_eq!(rounds.taken() as usize, before + round.len());
            assert!(rounds.is_first() || rounds.first_half_taken() as usize == before);
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
        assert_eq!(counts(Rounds::doubling(64, 1)), [2, 2, 4, 8, 16, 32]);
        assert_eq!(counts(Rounds::doubling(64, 16)), [32, 32]);
        assert_eq!(counts(Rounds::doubling(20, 1)), [2, 2, 4, 8, 4]);
        assert_eq!(counts(Rounds::doubling(20, 16)), [20]);
        assert_eq!(all(Rounds::doubling(8, 2))[0], [0, 1, 4, 5]);
        assert_eq!(all(Rounds::doubling(8, 2))[1], [2, 3, 6, 7]);
    }

    #[test]
    fn all_pixels_have_two_samples_at_each_instant_in_two_halves() {
        for (samples, instants, half, least) in
            [(64, 1, 1, 2), (1, 1, 1, 1), (1024, 16, 16, 32), (20, 16, 16, 20), (16, 16, 16, 16)]
        {
            let rounds = Rounds::doubling(samples, instants);
            assert_eq!((rounds.first_half_taken(), rounds.least()), (half, least), "{samples} {instants}");
            let halves = (0..instants).map(|instant| rounds.portion(instant));
            assert_eq!(halves.map(|portion| portion.halfway - portion.from).sum::<u32>(), half);
        }
    }
}
