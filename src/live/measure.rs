//! Measurements of a frame: the costs of its effects, and its error by the number of samples.

use std::sync::Arc;
use std::sync::atomic::AtomicBool;

use super::state::CurvePoint;
use crate::accuracy::{Estimate, MeasuredFrame, estimate};
use crate::engine::{Engine, EngineError, RenderRequest, unless_cancelled};
use crate::systems::{Effect, EffectSet, RenderSettings};
use crate::time::Time;

/// Maximum number of samples per pixel of a curve point, whose error is about 1/32 of that of a single sample.
const MOST_SAMPLES: u32 = 1024;

/// Returns the share of the measurements that are done, given their number: all effects, then the points of the curve, of which there may
/// be fewer.
pub(super) fn share(done: usize) -> f64 {
    let points = 2 + MOST_SAMPLES.ilog2() as usize;
    (done as f64 / (Effect::ALL.len() + points) as f64).min(1.0)
}

/// A measured point of the error curve.
pub(super) struct MeasuredPoint {
    pub(super) point: CurvePoint,
    /// RMS error of each tile, in output values.
    pub(super) tile_errors: Arc<[f32]>,
}

/// Returns the fraction of a frame's time that is saved by disabling an effect, or `Some(None)` if the effect is not needed. Returns
/// `None` if cancelled.
pub(super) fn cost(
    engine: &mut Engine,
    time: Time,
    effect: Effect,
    cancelled: &AtomicBool,
) -> Result<Option<Option<f64>>, EngineError> {
    let request = RenderRequest { fingerprint: false, ..RenderRequest::at(time) };
    if !engine.plan(request)?.plan.as_ref().is_some_and(|plan| plan.needs(effect)) {
        return Ok(Some(None));
    }
    let mut measure = |without: EffectSet| {
        let settings = RenderSettings { without, view: engine.settings.view, ..RenderSettings::default() };
        unless_cancelled(MeasuredFrame::render(engine, time, settings, cancelled, &mut || None))
    };
    // Each picture is compared with a complete one rendered at the same time, since the speed of the machine may change.
    let (full, reduced) = (measure(EffectSet::default())?, measure([effect].into())?);
    Ok(full.zip(reduced).map(|(full, reduced)| Some((1.0 - reduced.seconds / full.seconds).max(0.0))))
}

/// Returns the error of a frame and of its tiles at a point of the curve: with the scene's own samples at point 0, then with 1, 2, 4 and so on
/// samples per pixel. Returns `None` beyond the maximum, or if cancelled.
pub(super) fn curve_point(
    engine: &mut Engine,
    time: Time,
    index: usize,
    cancelled: &AtomicBool,
) -> Result<Option<MeasuredPoint>, EngineError> {
    let base = RenderSettings { view: engine.settings.view, ..RenderSettings::default() };
    let sampling = engine.effective_settings().sampling;
    let own = (!sampling.is_adaptive()).then_some(sampling.samples);
    let (samples, settings) = match index.checked_sub(1) {
        None => (own, base),
        Some(exponent) => {
            let samples = (0..).map(|exponent| 1 << exponent).take_while(|samples| *samples <= MOST_SAMPLES);
            let samples = samples.filter(|samples| Some(*samples) != own).nth(exponent);
            if samples.is_none() {
                return Ok(None);
            }
            (samples, RenderSettings { samples, max_error: Some(0.0), ..base })
        }
    };
    let estimate = estimate(engine, time, settings, cancelled)?;
    Ok(estimate.map(|Estimate { rms, tiles, seconds }| MeasuredPoint {
        point: CurvePoint { samples, milliseconds: 1e3 * seconds, error: rms },
        tile_errors: tiles.into(),
    }))
}
