//! Sequences within a time.

use std::time::Duration;

use super::frame_samples::ADAPTIVE;
use super::{FrameSamples, Ladder};

/// Chooses the samples of each frame of a sequence so that all are done in time. What is chosen depends on how long the frames before
/// took; what is written down of it brings back the same pictures without a clock.
#[derive(Clone, Debug)]
pub struct Deadline {
    ladder: Ladder,
    seconds: f64,
    left: u32,
    /// By what factor frames take longer than the ladder says.
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
        let most = match (self.left == self.frames, self.frames) {
            // There is no other frame to be kept waiting.
            (true, 1) => f64::INFINITY,
            (true, _) => self.ladder.highest() + RISE,
            (false, _) => self.height + RISE,
        };
        self.height = self.ladder.height(each / self.slower).min(most);
        if self.height < ADAPTIVE {
            self.height = self.height.floor();
        }
        FrameSamples::at_height(self.height)
    }

    /// Notes that the frame took no time: it was there already.
    pub fn skip(&mut self) {
        self.left = self.left.saturating_sub(1);
        self.frames = self.frames.saturating_sub(1);
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

    /// Frames that take longer or less long than the ladder says, and some that are harder than others.
    #[test]
    fn all_frames_are_done_in_time() {
        let ladder = Ladder::of([(0.0, 0.1), (3.0, 0.6), (6.0, 0.8), (7.0, 1.4)].into_iter());
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
