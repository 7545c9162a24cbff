//! Error estimates of pictures, from other pictures of the same moment.

use std::f64::consts::SQRT_2;
use std::sync::atomic::AtomicBool;

use super::film_error::tile_squares;
use super::{FilmError, MeasuredFrame, OutputValues};
use crate::engine::{Engine, EngineError, unless_cancelled};
use crate::systems::RenderSettings;
use crate::time::Time;

/// The estimated error of a picture, and its cost.
#[derive(Clone, Debug, PartialEq)]
pub struct Estimate {
    /// The RMS error, in output values.
    pub rms: f64,
    /// The RMS error of each tile of 16 by 16 pixels, row by row from the top, in output values. Tiles at the right and lower borders may be
    /// smaller.
    pub tiles: Vec<f32>,
    /// The time to animate, prepare and trace the picture, in seconds.
    pub seconds: f64,
}

/// Estimates the RMS error of pictures of a moment without a reference. The settings override the engine's.
///
/// Two pictures are rendered with independent samples; the error of each is their difference divided by the square root of two. A single
/// sample per pixel is the same in all pictures, so such a picture is compared with pictures of four samples. Errors that all pictures
/// share, such as errors caused by the instants of an open shutter, are not detected. Returns `None` if cancelled.
///
/// # Errors
///
/// As [`Engine::render_frame`].
pub fn estimate(
    engine: &mut Engine,
    moment: Time,
    settings: RenderSettings,
    cancelled: &AtomicBool,
) -> Result<Option<Estimate>, EngineError> {
    let sampling = settings.or(engine.settings).effective(engine.world()).sampling;
    unless_cancelled(if sampling.samples > 1 {
        pair(engine, moment, settings, cancelled).map(|estimated| estimated.estimate)
    } else {
        single(engine, moment, settings, cancelled)
    })
}

/// Seeds of the independent pictures: digits of pi and of e, which scenes do not use.
const SEEDS: [u64; 2] = [0x243f_6a88_85a3_08d3, 0xb7e1_5162_8aed_2a6a];

/// One of two pictures with independent samples, and the estimated error of each.
struct EstimatedPicture {
    picture: OutputValues,
    estimate: Estimate,
}

/// Renders two pictures with independent samples.
fn pair(
    engine: &mut Engine,
    moment: Time,
    settings: RenderSettings,
    cancelled: &AtomicBool,
) -> Result<EstimatedPicture, EngineError> {
    let mut seeded =
        |seed| render_timed(engine, moment, RenderSettings { seed: Some(seed), ..settings }, cancelled);
    let [(picture, first), (other, second)] = [seeded(SEEDS[0])?, seeded(SEEDS[1])?];
    let rms = FilmError::of_values(&picture, &other).rms / SQRT_2;
    let tiles = tile_squares(&picture, &other).into_iter().map(|square| root(square / 2.0)).collect();
    Ok(EstimatedPicture { picture, estimate: Estimate { rms, tiles, seconds: f64::midpoint(first, second) } })
}

/// Estimates the error of a picture with a single sample per pixel, from two pictures with four.
fn single(
    engine: &mut Engine,
    moment: Time,
    settings: RenderSettings,
    cancelled: &AtomicBool,
) -> Result<Estimate, EngineError> {
    let (picture, seconds) = render_timed(engine, moment, settings, cancelled)?;
    let four = RenderSettings { samples: Some(4), max_error: Some(0.0), ..settings };
    let four = pair(engine, moment, four, cancelled)?;
    let apart = FilmError::of_values(&picture, &four.picture).rms;
    let rms = (apart * apart - four.estimate.rms * four.estimate.rms).max(0.0).sqrt();
    let tiles = tile_squares(&picture, &four.picture).into_iter().zip(&four.estimate.tiles);
    let tiles = tiles.map(|(square, error)| root(square - f64::from(error * error))).collect();
    Ok(Estimate { rms, tiles, seconds })
}

/// Returns the square root of a squared error, which may be negative as the difference of two estimates.
#[expect(clippy::cast_possible_truncation, reason = "an estimate")]
fn root(square: f64) -> f32 {
    square.max(0.0).sqrt() as f32
}

/// Renders a picture. Returns its output values and its time in seconds.
fn render_timed(
    engine: &mut Engine,
    moment: Time,
    settings: RenderSettings,
    cancelled: &AtomicBool,
) -> Result<(OutputValues, f64), EngineError> {
    let MeasuredFrame { film, seconds, .. } =
        MeasuredFrame::render(engine, moment, settings, cancelled, &mut || None)?;
    Ok((OutputValues::of_film(&film, engine.effective_settings().film.transfer), seconds))
}
