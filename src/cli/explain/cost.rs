//! The cost and the worth of effects: the difference that leaving one out makes.

use serde_json::{Value, json};

use rayreel::{Effect, Engine, EngineError, Film};

use super::super::report::in_millions;
use super::timeline::PlannedTimeline;

/// Means over the measured frames.
pub(super) struct Costs {
    frames: Vec<u32>,
    rays: f64,
    seconds: f64,
    effects: Vec<(Effect, Cost)>,
}

/// The savings and the errors of leaving an effect out.
#[derive(Clone, Copy, Debug, Default)]
pub(super) struct Cost {
    /// The rays saved per frame.
    pub(super) rays: f64,
    /// The share of the time saved.
    pub(super) share: f64,
    /// The largest difference of any byte of the pictures.
    pub(super) max_error: u8,
    /// The root of the mean square of all of them.
    pub(super) rms_error: f64,
}

/// One rendering of a frame.
struct Rendered {
    film: Film,
    rays: f64,
    seconds: f64,
}

impl Costs {
    pub(super) fn of(engine: &mut Engine, timeline: &PlannedTimeline) -> Result<Self, EngineError> {
        let frames = timeline.samples();
        let needed: Vec<Effect> =
            timeline.effects().filter(|told| told.is_ever_needed()).map(|told| told.effect).collect();
        let mut effects: Vec<(Effect, Cost)> =
            needed.into_iter().map(|effect| (effect, Cost::default())).collect();
        let (mut rays, mut seconds) = (0.0, 0.0);
        let mut squares = vec![0.0; effects.len()];
        for frame in &frames {
            // Caches are warm from the second time on.
            render(engine, *frame, None)?;
            let whole = render(engine, *frame, None)?;
            rays += whole.rays;
            seconds += whole.seconds;
            for ((effect, cost), squares) in effects.iter_mut().zip(&mut squares) {
                let part = render(engine, *frame, Some(*effect))?;
                let (max_error, square) = difference(engine, &whole.film, &part.film);
                cost.rays += whole.rays - part.rays;
                cost.share += whole.seconds - part.seconds;
                cost.max_error = cost.max_error.max(max_error);
                *squares += square;
            }
        }
        let count = frames.len().max(1) as f64;
        for ((_, cost), squares) in effects.iter_mut().zip(squares) {
            cost.rays /= count;
            cost.share = (cost.share / seconds.max(f64::MIN_POSITIVE)).max(0.0);
            cost.rms_error = (squares / count).sqrt();
        }
        Ok(Self { frames, rays: rays / count, seconds: seconds / count, effects })
    }

    /// Returns the cost of an effect that is needed.
    pub(super) fn effect(&self, effect: Effect) -> Option<&Cost> {
        Some(&self.effects.iter().find(|(other, _)| *other == effect)?.1)
    }

    pub(super) fn in_words(&self) -> String {
        let frames: Vec<_> = self.frames.iter().map(u32::to_string).collect();
        let (of, mean) = match &frames[..] {
            [] => return String::new(),
            [one] => (format!("frame {one}"), ""),
            [others @ .., last] => (format!("frames {} and {last}", others.join(", ")), ", on average"),
        };
        format!("Measured at {of}: {} rays in {:.3} s{mean}.\n", in_millions(self.rays), self.seconds)
    }

    pub(super) fn json(&self) -> Value {
        json!({ "frames": self.frames, "rays": self.rays, "seconds": self.seconds })
    }

    pub(super) fn effect_json(&self, effect: Effect, measure: bool) -> Value {
        let Some(cost) = self.effect(effect) else { return Value::Null };
        let mut told = json!({ "rays": cost.rays, "share": cost.share });
        if measure {
            told["max_error"] = cost.max_error.into();
            told["rms_error"] = cost.rms_error.into();
        }
        told
    }
}

fn render(engine: &mut Engine, frame: u32, left_out: Option<Effect>) -> Result<Rendered, EngineError> {
    let others = engine.left_out().to_vec();
    engine.set_left_out(others.iter().copied().chain(left_out));
    let film = engine.render_frame(frame);
    engine.set_left_out(others);
    let report = engine.report();
    let seconds = (report.animate + report.prepare + report.trace).as_secs_f64();
    Ok(Rendered { film: film?, rays: report.rays.total() as f64, seconds })
}

/// Returns the largest and the mean square difference of the pictures' bytes.
fn difference(engine: &Engine, film: &Film, other: &Film) -> (u8, f64) {
    let transfer = engine.film_settings().transfer;
    let (mut largest, mut squares) = (0, 0.0);
    for (pixel, other) in film.pixels().iter().zip(other.pixels()) {
        for (byte, other) in transfer.encode(*pixel).into_iter().zip(transfer.encode(*other)) {
            let apart = byte.abs_diff(other);
            largest = largest.max(apart);
            squares += f64::from(apart) * f64::from(apart);
        }
    }
    (largest, squares / (3.0 * film.pixels().len().max(1) as f64))
}
