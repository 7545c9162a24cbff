//! The cost and the worth of effects: the differences in time and error when an effect is disabled.

use serde_json::{Value, json};

use rayreel::accuracy::{FilmError, MeasuredFrame, MedianRange, Observer};
use rayreel::trace::Signals;
use rayreel::{Effect, Engine, EngineError, Film, RenderSettings};

use super::super::measure_progress::MeasureProgress;
use super::super::report::in_millions;
use super::timeline::PlannedTimeline;

/// Costs as means over the measured frames.
pub(super) struct Costs {
    frames: Vec<u32>,
    rays: f64,
    /// Instructions per frame, if they are counted.
    instructions: Option<f64>,
    seconds: MedianRange,
    effects: Vec<(Effect, Cost)>,
}

/// The savings and the error of disabling an effect.
#[derive(Clone, Debug, Default)]
pub(super) struct Cost {
    /// Rays saved per frame.
    pub(super) rays: f64,
    /// Instructions saved per frame, if they are counted.
    instructions: Option<f64>,
    /// Fraction of the time saved in each round.
    shares: Vec<f64>,
    /// Error without the effect: the largest of any frame, and the RMS over all frames.
    pub(super) error: FilmError,
}

/// Number of rounds in which every effect is measured.
const ROUNDS: u32 = 5;

/// All measured frames, rendered with one set of effects.
struct MeasuredEffects {
    films: Vec<Film>,
    rays: f64,
    instructions: Option<f64>,
    seconds: f64,
}

impl Costs {
    /// Measures each effect once per round. Every measurement without an effect lies between two measurements with all effects, because the
    /// speed of machines varies over time.
    pub(super) fn measure(
        engine: &mut Engine,
        timeline: &PlannedTimeline,
        mut progress: MeasureProgress,
    ) -> Result<Self, EngineError> {
        let frames = timeline.samples();
        let count = frames.len().max(1) as f64;
        let needed = timeline.effects().filter(|effect| effect.is_ever_needed());
        let mut effects: Vec<(Effect, Cost)> =
            needed.map(|needed| (needed.effect, Cost::default())).collect();
        // The first render warms up the caches and is not measured.
        progress.show("all effects", 0.0);
        render(engine, &frames, None, &mut progress)?;
        let mut seconds = Vec::new();
        let mut full = render(engine, &frames, None, &mut progress)?;
        let steps = f64::from(ROUNDS) * effects.len() as f64;
        let mut done = 0.0;
        for round in 0..ROUNDS {
            for (effect, cost) in &mut effects {
                progress.show(effect.name(), done / steps);
                done += 1.0;
                let part = render(engine, &frames, Some(*effect), &mut progress)?;
                let before = std::mem::replace(&mut full, render(engine, &frames, None, &mut progress)?);
                let mean = f64::midpoint(before.seconds, full.seconds).max(f64::MIN_POSITIVE);
                cost.shares.push((1.0 - part.seconds / mean).max(0.0));
                if round == 0 {
                    cost.rays = (full.rays - part.rays) / count;
                    let instructions = full.instructions.zip(part.instructions);
                    cost.instructions = instructions.map(|(full, part)| (full - part) / count);
                    let transfer = engine.effective_settings().film.transfer;
                    cost.error = FilmError::of_sequence(&part.films, &full.films, transfer);
                }
                seconds.push(mean / count);
            }
        }
        if seconds.is_empty() {
            seconds.push(full.seconds / count);
        }
        let instructions = full.instructions.map(|all| all / count);
        let (rays, seconds) = (full.rays / count, MedianRange::of(&seconds));
        Ok(Self { frames, rays, instructions, seconds, effects })
    }

    /// Returns the cost of an effect, or `None` if the effect is never needed.
    pub(super) fn effect(&self, effect: Effect) -> Option<&Cost> {
        Some(&self.effects.iter().find(|(other, _)| *other == effect)?.1)
    }

    pub(super) fn describe(&self) -> String {
        let frames: Vec<_> = self.frames.iter().map(u32::to_string).collect();
        let (of, mean) = match &frames[..] {
            [] => return String::new(),
            [one] => (format!("frame {one}"), ""),
            [others @ .., last] => (format!("frames {} and {last}", others.join(", ")), ", on average"),
        };
        let (rays, seconds) = (in_millions(self.rays), self.seconds.median);
        format!("Measured at {of}: {rays} rays in {seconds:.3} s{mean}.\n")
    }

    pub(super) fn json(&self) -> Value {
        json!({
            "frames": self.frames,
            "rays": self.rays,
            "instructions": self.instructions,
            "seconds": self.seconds.median,
        })
    }

    pub(super) fn effect_json(&self, effect: Effect) -> Value {
        let Some(cost) = self.effect(effect) else { return Value::Null };
        let share = cost.share();
        json!({
            "rays": cost.rays,
            "instructions": cost.instructions,
            "share": share.median,
            "share_low": share.low,
            "share_high": share.high,
            "max_error": cost.error.max,
            "rms_error": cost.error.rms,
        })
    }
}

impl Cost {
    /// Returns the fraction of the time that is saved, over all rounds.
    pub(super) fn share(&self) -> MedianRange {
        MedianRange::of(&self.shares)
    }
}

fn render(
    engine: &mut Engine,
    frames: &[u32],
    without: Option<Effect>,
    progress: &mut MeasureProgress,
) -> Result<MeasuredEffects, EngineError> {
    let settings = RenderSettings { without: without.into_iter().collect(), ..RenderSettings::default() };
    let mut rendered = MeasuredEffects { films: Vec::new(), rays: 0.0, instructions: None, seconds: 0.0 };
    let cancelled = Signals::none().cancelled;
    for frame in frames {
        let time = engine.timeline.time_of(*frame);
        let measured =
            MeasuredFrame::render(engine, time, settings, cancelled, &mut || progress.instructions())?;
        let MeasuredFrame { film, seconds, rays, instructions, .. } = measured;
        rendered.films.push(film);
        rendered.seconds += seconds;
        rendered.rays += rays.total() as f64;
        if let Some(count) = instructions {
            *rendered.instructions.get_or_insert(0.0) += count as f64;
        }
    }
    Ok(rendered)
}
