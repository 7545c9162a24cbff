//! What is rendered to find out what a sequence takes.

use crate::time::Time;

/// The small pictures that are rendered before a sequence to find out what it takes: smaller and fewer for short ones, so that they have less
/// than a tenth of its rays, unless it is a single frame with one sample per pixel.
#[derive(Clone, Debug, PartialEq)]
pub struct Pilot {
    /// When pictures are rendered.
    pub(super) moments: Vec<Time>,
    /// By what the film's width and height are divided in the largest pictures.
    pub(super) divisor: u32,
    /// By what factor errors may be larger than such pictures tell.
    pub(super) uncertain: f64,
}

impl Pilot {
    /// Returns that of a sequence of so many frames, whose times are told by their place in it.
    pub fn new(frames: usize, time_of: impl Fn(usize) -> Time) -> Self {
        /// How many frames it takes for pictures of so many of them, of how large a part of the film's sides. Nine samples are taken of a
        /// moment, and nine of a picture of half of that, together 11.25 by the square of the part.
        const LEVELS: [(usize, u32, f64); 3] = [(36, 2, 1.1), (FEW, 4, 1.2), (0, 8, 1.3)];
        const FEW: usize = 12;
        const MOST: usize = 5;
        let level = LEVELS.into_iter().find(|(least, ..)| *least <= frames);
        let (least, divisor, uncertain) = level.unwrap_or(LEVELS[2]);
        let count = (frames / least.max(FEW)).clamp(1, MOST);
        let moments = (0..count).map(|index| time_of((2 * index + 1) * frames / (2 * count))).collect();
        Self { moments, divisor, uncertain }
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
        assert_eq!(places(11), (vec![5.0], 8));
        assert_eq!(places(24), (vec![6.0, 18.0], 4));
        assert_eq!(places(96), (vec![24.0, 72.0], 2));
        assert_eq!(places(1000), (vec![100.0, 300.0, 500.0, 700.0, 900.0], 2));
    }
}
