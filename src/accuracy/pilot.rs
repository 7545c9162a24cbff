//! What is rendered to find out what a sequence takes.

use crate::time::Time;

/// The small pictures that are rendered before a sequence to find out what it takes: few for few frames, so that they take less than a
/// tenth of the time of the sequence, even with one sample per pixel (from six frames on, or where more samples are chosen).
#[derive(Clone, Debug, PartialEq)]
pub struct Pilot {
    /// When pictures are rendered.
    pub(super) moments: Vec<Time>,
    /// By what the film's width and height are divided in the largest pictures.
    pub(super) divisor: u32,
}

impl Pilot {
    /// Returns that of a sequence of so many frames, whose times are told by their place in it.
    pub fn new(frames: usize, time_of: impl Fn(usize) -> Time) -> Self {
        /// What one moment's pictures are worth.
        const FRAMES_PER_MOMENT: usize = 12;
        const MOST: usize = 5;
        let count = (frames / FRAMES_PER_MOMENT).clamp(1, MOST);
        let moments = (0..count).map(|index| time_of((2 * index + 1) * frames / (2 * count))).collect();
        Self { moments, divisor: if frames < FRAMES_PER_MOMENT / 2 { 8 } else { 4 } }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn moments_are_spread_over_the_sequence() {
        let places = |frames| {
            let pilot = Pilot::new(frames, |index| Time::from_ratio(index as u64, 1).unwrap());
            (pilot.moments.iter().map(|time| time.seconds()).collect::<Vec<_>>(), pilot.divisor)
        };
        assert_eq!(places(1), (vec![0.0], 8));
        assert_eq!(places(6), (vec![3.0], 4));
        assert_eq!(places(24), (vec![6.0, 18.0], 4));
        assert_eq!(places(1000), (vec![100.0, 300.0, 500.0, 700.0, 900.0], 4));
    }
}
