//! How good pictures are, judged by others like them.

use std::f64::consts::SQRT_2;
use std::sync::atomic::AtomicBool;

use super::FilmError;
use super::stop::{Stop, render, unless_cancelled};
use crate::engine::{Engine, EngineError};
use crate::systems::{Knobs, sampling_settings};
use crate::time::Time;
use crate::trace::Film;

/// How far a picture is off, as far as others like it tell, and what it takes.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Estimate {
    /// The root of the mean square of the error, in output values.
    pub rms: f64,
    /// The time to animate, prepare and trace it, in seconds.
    pub seconds: f64,
}

/// Estimates how far pictures of a moment with these knobs are off, without a reference: from two with independent samples, each of which
/// is off by what they differ over the root of two. A single sample, which is the same in all pictures, is compared with four.
/// What all of them share, as the instants of an open shutter, is not seen. `None` if it was cancelled.
///
/// # Errors
///
/// As [`Engine::render_frame`].
pub fn estimate(
    engine: &mut Engine,
    moment: Time,
    knobs: Knobs,
    cancelled: &AtomicBool,
) -> Result<Option<Estimate>, EngineError> {
    let usual = engine.knobs();
    let estimated = if knobs.sampling(sampling_settings(engine.world())).samples > 1 {
        pair(engine, moment, knobs, cancelled).map(|pair| pair.estimate)
    } else {
        single(engine, moment, knobs, cancelled)
    };
    engine.set_knobs(usual);
    unless_cancelled(estimated)
}

/// Of pictures that are independent, and of nobody's scene: digits of pi and of e.
const SEEDS: [u64; 2] = [0x243f_6a88_85a3_08d3, 0xb7e1_5162_8aed_2a6a];

/// Two pictures with independent samples.
pub(super) struct Pair {
    pub(super) films: [Film; 2],
    pub(super) estimate: Estimate,
}

/// Renders two pictures with independent samples. Knobs stay turned.
pub(super) fn pair(
    engine: &mut Engine,
    moment: Time,
    knobs: Knobs,
    cancelled: &AtomicBool,
) -> Result<Pair, Stop> {
    let [(one, first), (other, second)] = [
        timed(engine, moment, Knobs { seed: Some(SEEDS[0]), ..knobs }, cancelled)?,
        timed(engine, moment, Knobs { seed: Some(SEEDS[1]), ..knobs }, cancelled)?,
    ];
    let rms = FilmError::between(&one, &other, engine.film_settings().transfer).rms / SQRT_2;
    Ok(Pair { films: [one, other], estimate: Estimate { rms, seconds: f64::midpoint(first, second) } })
}

/// Estimates how far a picture with a single sample is off, as far as one with four tells. Knobs stay turned.
fn single(engine: &mut Engine, moment: Time, knobs: Knobs, cancelled: &AtomicBool) -> Result<Estimate, Stop> {
    let (film, seconds) = timed(engine, moment, knobs, cancelled)?;
    let four = pair(engine, moment, Knobs { samples: Some(4), max_error: Some(0.0), ..knobs }, cancelled)?;
    Ok(Estimate { rms: four.error_of(&film, engine), seconds })
}

impl Pair {
    /// Estimates how far another, worse picture is off.
    pub(super) fn error_of(&self, film: &Film, engine: &Engine) -> f64 {
        let apart = FilmError::between(film, &self.films[0], engine.film_settings().transfer).rms;
        (apart * apart - self.estimate.rms * self.estimate.rms).max(0.0).sqrt()
    }
}

fn timed(
    engine: &mut Engine,
    moment: Time,
    knobs: Knobs,
    cancelled: &AtomicBool,
) -> Result<(Film, f64), Stop> {
    engine.set_knobs(knobs);
    let film = render(engine, moment, cancelled)?;
    let report = engine.report();
    Ok((film, (report.animate + report.prepare + report.trace).as_secs_f64()))
}
