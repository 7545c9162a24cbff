//! The ladder of settings from the quickest picture to the best, and how long its rungs take.

use std::sync::atomic::AtomicBool;
use std::time::{Duration, Instant};

use super::frame_samples::{ADAPTIVE, HIGHEST};
use super::stop::{Stop, render, unless_cancelled};
use super::{FrameSamples, Pilot};
use crate::engine::{Engine, EngineError};
use crate::systems::Knobs;
use crate::time::Time;

/// How long frames take at the heights of the ladder.
#[derive(Clone, Debug, PartialEq)]
pub struct Ladder {
    /// Heights, ascending, with the logarithms of seconds a frame.
    rungs: Vec<(f64, f64)>,
}

impl Ladder {
    /// Measures it on small pictures of a pilot's moments, each time as if they were as large as the film: as many rungs as there is
    /// time for. `None` if it was cancelled.
    ///
    /// # Errors
    ///
    /// As [`Engine::render_frame`].
    pub fn measure(
        engine: &mut Engine,
        pilot: &Pilot,
        within: Duration,
        cancelled: &AtomicBool,
    ) -> Result<Option<Self>, EngineError> {
        unless_cancelled(measure(engine, &pilot.moments, within, cancelled))
    }

    /// Returns the ladder of these heights, ascending, and the seconds of a frame there.
    pub(super) fn of(rungs: impl Iterator<Item = (f64, f64)>) -> Self {
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
    pub(super) fn add(&mut self, height: f64, seconds: f64) {
        let least = self.rungs.last().map_or(f64::NEG_INFINITY, |(_, seconds)| seconds + 1e-2);
        self.rungs.push((height, libm::log(seconds).max(least)));
    }

    /// Returns the height of the last rung that was measured.
    pub(super) fn highest(&self) -> f64 {
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

fn measure(
    engine: &mut Engine,
    moments: &[Time],
    within: Duration,
    cancelled: &AtomicBool,
) -> Result<Ladder, Stop> {
    /// By what the film's width and height are divided.
    const DIVISOR: u32 = 4;
    /// From where on errors are small enough to tell how much longer smaller ones take.
    const SMALL: u32 = 6;
    /// How much longer a rung takes than the one before at most.
    const LONGER: u32 = 4;
    let film = engine.film_settings();
    let size = ((film.width / DIVISOR).max(1), (film.height / DIVISOR).max(1));
    let area = |(width, height)| f64::from(width) * f64::from(height);
    let count = moments.len().max(1) as f64;
    let larger = area((film.width, film.height)) / area(size) / count;
    let start = Instant::now();
    let (single, before) = small_pictures(engine, moments, (size, 0.0), cancelled)?;
    // What has been prepared for the first pictures is prepared for the others.
    let fixed = before / count;
    // More samples in all pixels take as much longer.
    let all_pixels = [(0.0, 1.0), (1.0, 2.0), (2.0, 4.0)].map(|(height, more)| (height, more * single));
    let mut rungs = all_pixels.to_vec();
    for height in
        std::iter::once(ADAPTIVE).chain((SMALL..).map(f64::from)).take_while(|height| *height < HIGHEST)
    {
        let begun = Instant::now();
        let (traced, _) = small_pictures(engine, moments, (size, height), cancelled)?;
        rungs.push((height, traced));
        if start.elapsed() + LONGER * begun.elapsed() > within {
            break;
        }
    }
    Ok(Ladder::of(rungs.into_iter().map(|(height, traced)| (height, fixed + traced * larger))))
}

/// Renders small pictures of some moments. Returns how long tracing them took, and what comes before it, in seconds.
fn small_pictures(
    engine: &mut Engine,
    moments: &[Time],
    (size, height): ((u32, u32), f64),
    cancelled: &AtomicBool,
) -> Result<(f64, f64), Stop> {
    let knobs = engine.knobs();
    let (mut traced, mut before) = (0.0, 0.0);
    for moment in moments {
        engine.set_knobs(Knobs { size: Some(size), ..FrameSamples::at_height(height).knobs() });
        let rendered = render(engine, *moment, cancelled);
        engine.set_knobs(knobs);
        rendered?;
        let report = engine.report();
        traced += report.trace.as_secs_f64();
        before += (report.animate + report.prepare).as_secs_f64();
    }
    Ok((traced, before))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn heights_and_seconds_belong_together() {
        let ladder = Ladder::of([(0.0, 0.1), (3.0, 0.6), (6.0, 0.8), (7.0, 1.4)].into_iter());
        for height in [0.0, 0.3, 2.9, 3.0, 5.5, 7.0, 9.0, 12.5] {
            assert!((ladder.height(ladder.seconds(height)) - height).abs() < 1e-9, "{height}");
        }
        assert_eq!(ladder.height(0.01), 0.0);
        assert_eq!(ladder.height(1e9), HIGHEST);
        assert!((ladder.seconds(8.0) - 1.4 * 4.0).abs() < 1e-9);
    }
}
