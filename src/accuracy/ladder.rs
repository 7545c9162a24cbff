//! The ladder of settings from the quickest picture to the best, and how long its rungs take.

use std::time::Duration;

use crate::components::Sampling;
use crate::engine::{Engine, EngineError};
use crate::systems::Knobs;
use crate::time::Time;

/// The samples of a frame: what is chosen for an error or for a deadline, and what brings back the same picture.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct FrameSamples {
    /// The most samples of a pixel: [`Sampling::samples`].
    pub samples: u32,
    /// The error that the picture may have, 0 for as many samples everywhere: [`Sampling::max_error`].
    pub max_error: f32,
}

impl FrameSamples {
    /// Returns them as knobs.
    #[must_use]
    pub fn knobs(self) -> Knobs {
        Knobs { samples: Some(self.samples), max_error: Some(self.max_error), ..Knobs::default() }
    }

    /// Returns as many samples as it takes for an error, of this many at most.
    #[must_use]
    pub fn for_error(max_error: f32, samples: u32) -> Self {
        Self { samples, max_error }
    }

    /// Returns the samples at a height of the ladder: 1, 2 and 4 for all pixels at 0, 1 and 2, and from 3 on an error of 16 steps that
    /// is halved with every rung.
    #[must_use]
    pub fn at_height(height: f64) -> Self {
        if height < ADAPTIVE {
            #[expect(clippy::cast_possible_truncation, clippy::cast_sign_loss, reason = "0 to 2")]
            let exponent = height.max(0.0) as u32;
            return Self { samples: 1 << exponent, max_error: 0.0 };
        }
        #[expect(clippy::cast_possible_truncation, reason = "it becomes the setting")]
        let max_error = (LARGEST * libm::exp2(ADAPTIVE - height.min(HIGHEST))) as f32;
        Self { samples: Sampling::LARGEST_COUNT, max_error }
    }
}

/// From where on pixels get as many samples as they need.
const ADAPTIVE: f64 = 3.0;
/// The error there.
const LARGEST: f64 = 16.0;
/// An error of 2^-10 steps.
const HIGHEST: f64 = 17.0;

/// How long frames take at the heights of the ladder.
#[derive(Clone, Debug, PartialEq)]
pub struct Ladder {
    /// Heights, ascending, with the logarithms of seconds a frame.
    rungs: Vec<(f64, f64)>,
}

impl Ladder {
    /// Measures it on small pictures of some moments of a scene, each time as if they were as large as the film.
    ///
    /// # Errors
    ///
    /// As [`Engine::render_frame`].
    pub fn measure(engine: &mut Engine, moments: &[Time]) -> Result<Self, EngineError> {
        /// By what the film's width and height are divided.
        const DIVISOR: u32 = 4;
        const HEIGHTS: [f64; 4] = [0.0, 3.0, 6.0, 7.0];
        let (knobs, film) = (engine.knobs(), engine.film_settings());
        let size = ((film.width / DIVISOR).max(1), (film.height / DIVISOR).max(1));
        let larger = f64::from(film.width * film.height) / f64::from(size.0 * size.1);
        let mut seconds = [0.0; HEIGHTS.len()];
        let mut fixed = 0.0;
        for moment in moments {
            for (height, seconds) in HEIGHTS.into_iter().zip(&mut seconds) {
                engine.set_knobs(Knobs { size: Some(size), ..FrameSamples::at_height(height).knobs() });
                let rendered = engine.render_at(*moment);
                engine.set_knobs(knobs);
                rendered?;
                *seconds += engine.report().trace.as_secs_f64() * larger;
                // What has been prepared once takes no time again.
                let report = engine.report();
                fixed += if height == 0.0 { (report.animate + report.prepare).as_secs_f64() } else { 0.0 };
            }
        }
        let count = moments.len().max(1) as f64;
        let rungs = HEIGHTS.into_iter().zip(seconds.map(|seconds| (seconds + fixed) / count));
        Ok(Self::of(rungs))
    }

    /// Returns the ladder of these heights, ascending, and the seconds of a frame there.
    fn of(rungs: impl Iterator<Item = (f64, f64)>) -> Self {
        let mut least = f64::MIN_POSITIVE;
        let rungs = rungs.map(|(height, seconds)| {
            // More work takes longer, whatever a clock says.
            least = seconds.max(1.01 * least);
            (height, libm::log(least))
        });
        Self { rungs: rungs.collect() }
    }

    /// Returns the seconds of a frame at a height: on lines between the rungs, and beyond the last four times as many for every rung,
    /// which is what errors that fall as n^-1/2 take.
    #[must_use]
    pub fn seconds(&self, height: f64) -> f64 {
        if let Some((highest, seconds)) = self.rungs.last().filter(|(highest, _)| *highest < height) {
            return libm::exp(*seconds) * libm::exp2(2.0 * (height - highest));
        }
        let count = self.rungs.len();
        let above = self.rungs.partition_point(|(rung, _)| *rung <= height).clamp(1, count - 1);
        let ((below, low), (above, high)) = (self.rungs[above - 1], self.rungs[above]);
        libm::exp(low + (high - low) * (height - below) / (above - below))
    }

    /// Adds a rung above all others.
    fn add(&mut self, height: f64, seconds: f64) {
        let least = self.rungs.last().map_or(f64::NEG_INFINITY, |(_, seconds)| seconds + 1e-2);
        self.rungs.push((height, libm::log(seconds).max(least)));
    }

    /// Returns the height of the last rung that was measured.
    fn highest(&self) -> f64 {
        self.rungs.last().map_or(0.0, |(height, _)| *height)
    }

    /// Returns the height at which a frame takes so many seconds: 0 if none is as quick.
    #[must_use]
    pub fn height(&self, seconds: f64) -> f64 {
        let (mut low, mut high) = (0.0, HIGHEST);
        if self.seconds(high) <= seconds {
            return high;
        }
        for _ in 0..40 {
            let middle = f64::midpoint(low, high);
            if self.seconds(middle) <= seconds { low = middle } else { high = middle }
        }
        low
    }
}

/// Chooses the samples of each frame of a sequence so that all are done in time. What is chosen depends on how long the frames before
/// took; what is written down of it brings back the same pictures without a clock.
#[derive(Clone, Debug)]
pub struct Deadline {
    ladder: Ladder,
    seconds: f64,
    left: u32,
    /// By how much longer frames take than the ladder says.
    slower: f64,
    /// The height of the frame in hand.
    height: f64,
    frames: u32,
}

impl Deadline {
    /// The part of the time that is planned for: what is left over makes up for frames that take longer than the others.
    const PLANNED: f64 = 0.97;

    /// Returns choices for so many frames within a time.
    #[must_use]
    pub fn new(ladder: Ladder, within: Duration, frames: u32) -> Self {
        let seconds = within.as_secs_f64() * Self::PLANNED;
        Self { ladder, seconds, left: frames, slower: 1.0, height: 0.0, frames }
    }

    /// Returns the least time that the frames can take: with a sample per pixel.
    #[must_use]
    pub fn least(&self) -> Duration {
        Duration::from_secs_f64(self.ladder.seconds(0.0) * self.slower * f64::from(self.frames))
    }

    /// Returns the samples of the next frame, with so much of the time gone.
    pub fn next(&mut self, gone: Duration) -> FrameSamples {
        /// By how many rungs a frame is better than the one before at most: what is far from what was measured is not known well.
        const RISE: f64 = 2.0;
        let each = (self.seconds - gone.as_secs_f64()).max(0.0) / f64::from(self.left.max(1));
        let most = if self.left == self.frames { self.ladder.highest() } else { self.height + RISE };
        self.height = self.ladder.height(each / self.slower).min(most);
        if self.height < ADAPTIVE {
            self.height = self.height.floor();
        }
        FrameSamples::at_height(self.height)
    }

    /// Notes how long that frame took.
    pub fn note(&mut self, took: Duration) {
        /// How much the last frame counts among those before.
        const NEWEST: f64 = 0.4;
        self.left = self.left.saturating_sub(1);
        if self.height > self.ladder.highest() {
            // There is nothing yet to compare it with.
            self.ladder.add(self.height, took.as_secs_f64() / self.slower);
            return;
        }
        let found = took.as_secs_f64() / self.ladder.seconds(self.height);
        let is_first = self.left + 1 == self.frames;
        let weight = if is_first { 1.0 } else { NEWEST };
        self.slower *= libm::pow((found / self.slower).max(1e-3), weight);
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn ladder() -> Ladder {
        Ladder::of([(0.0, 0.1), (3.0, 0.6), (6.0, 0.8), (7.0, 1.4)].into_iter())
    }

    #[test]
    fn heights_and_seconds_belong_together() {
        let ladder = ladder();
        for height in [0.0, 0.3, 2.9, 3.0, 5.5, 7.0, 9.0, 12.5] {
            assert!((ladder.height(ladder.seconds(height)) - height).abs() < 1e-9, "{height}");
        }
        assert_eq!(ladder.height(0.01), 0.0);
        assert_eq!(ladder.height(1e9), HIGHEST);
        assert!((ladder.seconds(8.0) - 1.4 * 4.0).abs() < 1e-9);
    }

    #[test]
    fn rungs_are_what_they_are_called() {
        assert_eq!(FrameSamples::at_height(0.0), FrameSamples { samples: 1, max_error: 0.0 });
        assert_eq!(FrameSamples::at_height(2.9), FrameSamples { samples: 4, max_error: 0.0 });
        assert_eq!(FrameSamples::at_height(3.0), FrameSamples::for_error(16.0, Sampling::LARGEST_COUNT));
        assert_eq!(FrameSamples::at_height(7.0).max_error, 1.0);
    }

    /// Frames that take longer or less long than the ladder says, and some that are harder than others.
    #[test]
    fn all_frames_are_done_in_time() {
        let ladder = ladder();
        for within in [8.0, 60.0, 100.0, 400.0] {
            for factor in [0.5, 1.0, 2.5] {
                let mut deadline = Deadline::new(ladder.clone(), Duration::from_secs_f64(within), 24);
                let mut gone = 0.0;
                for frame in 0..24_u8 {
                    let chosen = deadline.next(Duration::from_secs_f64(gone));
                    assert_eq!(chosen, FrameSamples::at_height(deadline.height));
                    let harder = 1.0 + 0.3 * libm::sin(f64::from(frame));
                    let took = ladder.seconds(deadline.height) * factor * harder;
                    gone += took;
                    deadline.note(Duration::from_secs_f64(took));
                }
                assert!(gone < 1.03 * within || within == 8.0, "{gone} of {within}");
                assert!(gone > 0.8 * within, "{gone} of {within}");
            }
        }
    }
}
