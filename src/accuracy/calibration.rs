//! How far pictures that tell how good they are err on the safe side, found out by a scene's own frames.

use std::sync::atomic::AtomicBool;

use super::estimate::pair;
use super::frame_samples::FrameSamples;
use super::stop::Stop;
use crate::engine::Engine;
use crate::systems::Knobs;
use crate::time::Time;

/// A moment of a pilot whose pictures are smaller than the film.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) struct SmallPicture {
    pub(super) moment: Time,
    /// Columns and rows.
    pub(super) size: (u32, u32),
    /// By what factor its errors are larger than those of a picture that is as large as the film.
    pub(super) larger: f64,
}

/// Returns samples with which pictures are just as good as those that are chosen are meant to be: their error is turned up or down until it
/// is so in pictures of a pilot, whose errors may be larger by a factor. How far these are off is seen from pairs of them with
/// independent samples.
pub(super) fn calibrated(
    engine: &mut Engine,
    pictures: &[SmallPicture],
    (chosen, uncertain): (FrameSamples, f64),
    cancelled: &AtomicBool,
) -> Result<FrameSamples, Stop> {
    let mut search = Search::new(chosen.max_error.into(), uncertain);
    while let Some(overestimate) = search.next {
        let samples = FrameSamples { overestimate, ..chosen };
        let mut found: f64 = 0.0;
        for SmallPicture { moment, size, larger } in pictures {
            let knobs = samples.knobs();
            #[expect(clippy::cast_possible_truncation, reason = "it becomes the setting")]
            let max_error = knobs.max_error.map(|error| (f64::from(error) * larger) as f32);
            let knobs = Knobs { size: Some(*size), max_error, ..knobs };
            let pair = pair(engine, *moment, knobs, cancelled)?;
            if engine.report().error.is_some_and(|error| Some(error) > max_error.map(f64::from)) {
                // More samples than there may be would be needed.
                return Ok(chosen);
            }
            found = found.max(pair.estimate.rms / larger);
        }
        search.note(overestimate, found);
    }
    Ok(FrameSamples { overestimate: search.found(), ..chosen })
}

/// The search for how much an error may be turned up.
struct Search {
    /// The error that is small enough where none was turned up: pictures may be worse than they seem.
    tolerated: f64,
    /// The one that is small enough else: by as much other frames may be worse than those of the pilot.
    wanted: f64,
    /// The largest that is known to be small enough, and the smallest that is not.
    good: Option<f32>,
    bad: Option<f32>,
    /// What is tried next.
    next: Option<f32>,
    tries: u32,
}

impl Search {
    /// How often it is tried.
    const TRIES: u32 = 3;
    /// A picture that is so near to what is wanted is good enough.
    const NEAR: f64 = 0.95;
    /// The least and the most: a frame that is unlike those of the pilot is not to be off by much more.
    const LEAST: f64 = 0.5;
    const MOST: f64 = 1.125;

    fn new(asked: f64, uncertain: f64) -> Self {
        let tolerated = asked / uncertain;
        Self { tolerated, wanted: tolerated / uncertain, good: None, bad: None, next: Some(1.0), tries: 0 }
    }

    /// Notes the error that was found.
    fn note(&mut self, tried: f32, found: f64) {
        self.tries += 1;
        if self.tries == 1 && (self.wanted..=self.tolerated).contains(&found) {
            (self.good, self.next) = (Some(tried), None);
            return;
        }
        if found <= self.wanted {
            self.good = Some(tried);
        } else {
            self.bad = Some(tried);
        }
        // Into the middle of what is near enough.
        let by = Self::NEAR.sqrt() * self.wanted / found.max(1e-9);
        let next = match (self.good, self.bad) {
            (Some(good), Some(bad)) => (f64::from(good) * f64::from(bad)).sqrt(),
            (Some(good), None) => f64::from(good) * by.max(1.05),
            (None, bad) => bad.map_or(1.0, f64::from) * by.min(0.97),
        };
        #[expect(clippy::cast_possible_truncation, reason = "it becomes the setting")]
        let next = next.clamp(Self::LEAST, Self::MOST) as f32;
        let is_near = found <= self.wanted && found >= Self::NEAR * self.wanted;
        let is_known = self.good == Some(next) || self.bad == Some(next);
        // One more, where none was small enough.
        let is_over = self.tries == Self::TRIES && self.good.is_some() || self.tries > Self::TRIES;
        self.next = (!is_near && !is_known && !is_over).then_some(next);
    }

    /// Returns the largest that is small enough; the least where none is.
    fn found(&self) -> f32 {
        self.good.or(self.bad).unwrap_or(1.0)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Searches where errors are found as a function of what is tried.
    fn search(asked: f64, error: impl Fn(f32) -> f64) -> (f32, u32) {
        let mut search = Search::new(asked, 1.25);
        while let Some(tried) = search.next {
            search.note(tried, error(tried));
        }
        (search.found(), search.tries)
    }

    #[test]
    fn errors_are_turned_up_as_far_as_they_may_be() {
        // Errors of 2 are wanted where 3.125 are asked for, twice by a factor of 1.25; what is estimated is a tenth too large.
        let (found, tries) = search(3.125, |tried| 2.0 / 1.1 * f64::from(tried));
        assert!(found < 1.1 && found > 0.95 * 1.1 && tries == 2, "{found} {tries}");
        // What is larger than 2.5 is turned down as far as it should be.
        let (found, _) = search(3.125, |tried| 2.6 * f64::from(tried));
        assert!(2.6 * found < 2.0 && found > 0.7, "{found}");
        // What is near enough is left alone, and nothing is turned up without end.
        assert_eq!(search(3.125, |_| 2.4), (1.0, 1));
        assert_eq!(search(3.125, |_| 1.95), (1.0, 1));
        assert_eq!(search(3.125, |_| 0.1).0, 1.125);
        assert_eq!(search(3.125, |tried| if tried > 1.0 { 2.1 } else { 1.0 }).0, 1.0);
    }

    #[test]
    fn it_ends() {
        for wanted in [0.01, 1.0, 200.0] {
            for error in [0.0, 1e-30, 0.5, 1.0, 1e30, f64::INFINITY, f64::NAN] {
                let (found, tries) = search(wanted, |_| error);
                assert!((0.5..=1.125).contains(&found) && tries <= Search::TRIES + 1, "{found} {tries}");
            }
        }
    }
}
