//! With how many samples each frame is rendered: the scene's own, as many as an error or a deadline asks for, or those of an earlier
//! run.
//!
//! What is chosen is written beside the frames, and read back by `--settings`: the same pictures then come without a clock.

use std::fs;
use std::path::{Path, PathBuf};
use std::time::{Duration, Instant};

use anyhow::{Context, anyhow, bail, ensure};
use serde_json::{Value, json};

use rayreel::accuracy::{Deadline, FewSamples, FrameSamples, Ladder};
use rayreel::components::Sampling;
use rayreel::{Engine, Knobs, Time};

use super::args::RenderArguments;
use super::exit::Failure;
use super::settings::{RenderSettings, Shot};
use super::write_file::write_file;

/// The samples of frames.
pub(super) struct Choice {
    by: By,
    /// The chosen ones, frame by frame.
    chosen: Vec<Value>,
    /// The time that it took to find out what can be had.
    pub(super) pilot: Duration,
    /// When the frame in hand was begun.
    begun: Instant,
    start: Instant,
}

/// Who chooses.
enum By {
    /// The scene.
    Scene,
    /// One for all frames.
    Error(FrameSamples),
    Deadline(Box<Deadline>),
    /// What an earlier run has written.
    Settings(PathBuf, Vec<Value>),
}

impl Choice {
    /// Finds out what can be had, for a run that began at `start`.
    pub(super) fn new(
        arguments: &RenderArguments,
        engine: &mut Engine,
        settings: &RenderSettings,
        start: Instant,
    ) -> Result<Self, Failure> {
        let pilot = Instant::now();
        let by = if let Some(error) = arguments.max_error {
            let samples = arguments.overrides.samples().unwrap_or(Sampling::LARGEST_COUNT);
            By::Error(for_error(engine, settings, error, samples)?)
        } else if let Some(within) = arguments.deadline {
            By::Deadline(Box::new(deadline(engine, settings, within, start)?))
        } else if let Some(file) = &arguments.settings {
            By::Settings(file.clone(), read(file)?)
        } else {
            By::Scene
        };
        Ok(Self { by, chosen: Vec::new(), pilot: pilot.elapsed(), begun: start, start })
    }

    /// Sets the engine up for a frame.
    pub(super) fn begin(&mut self, engine: &mut Engine, shot: &Shot) -> anyhow::Result<()> {
        self.begun = Instant::now();
        let samples = match &mut self.by {
            By::Scene => return Ok(()),
            By::Error(samples) => *samples,
            By::Deadline(deadline) => deadline.next(self.start.elapsed()),
            By::Settings(file, frames) => samples_of(frames, shot)
                .with_context(|| format!("`{}` has no settings for {}", file.display(), shot.moment()))?,
        };
        engine.set_knobs(samples.knobs());
        Ok(())
    }

    /// Notes what became of it.
    pub(super) fn end(&mut self, engine: &Engine, shot: &Shot) {
        if let By::Deadline(deadline) = &mut self.by {
            deadline.note(self.begun.elapsed());
        }
        let (Knobs { samples: Some(samples), max_error: Some(error), .. }, false) =
            (engine.knobs(), matches!(self.by, By::Scene | By::Settings(..)))
        else {
            return;
        };
        let film = engine.film_settings();
        let report = engine.report();
        self.chosen.push(json!({
            "frame": shot.frame,
            "time": shot.time.seconds(),
            "samples": samples,
            "max_error": error,
            "estimated_error": report.error,
            "samples_per_pixel": report.rays.camera as f64 / (f64::from(film.width) * f64::from(film.height)),
            "seconds": self.begun.elapsed().as_secs_f64(),
        }));
    }

    /// Writes what was chosen beside the frames, together with what is there of other frames. Returns the file, if anything was chosen.
    pub(super) fn write(&self, settings: &RenderSettings, scene: &Path) -> anyhow::Result<Option<PathBuf>> {
        if self.chosen.is_empty() {
            return Ok(None);
        }
        let file = settings.sequence.settings();
        let is_new = |frame: &&Value| self.chosen.iter().all(|chosen| chosen["time"] != frame["time"]);
        let mut frames: Vec<Value> =
            read(&file).unwrap_or_default().iter().filter(is_new).chain(&self.chosen).cloned().collect();
        let time = |frame: &Value| frame["time"].as_f64().unwrap_or(0.0);
        frames.sort_by(|one, other| time(one).total_cmp(&time(other)));
        let text = json!({
            "rayreel": env!("CARGO_PKG_VERSION"),
            "scene": scene.display().to_string(),
            "pilot_seconds": self.pilot.as_secs_f64(),
            "frames": frames,
        });
        write_file(&file, format!("{text:#}\n").as_bytes())?;
        Ok(Some(file))
    }
}

/// Returns the samples for an error: as many everywhere where few are enough. It is an error of ours if no picture can be as good.
fn for_error(
    engine: &mut Engine,
    settings: &RenderSettings,
    error: f32,
    samples: u32,
) -> Result<FrameSamples, Failure> {
    let few = FewSamples::estimate(engine, &moments(settings))?;
    if let Some(enough) = few.enough_for(error.into()) {
        return Ok(FrameSamples { samples: enough.min(samples), max_error: 0.0 });
    }
    let (best, sure) = few.errors_with(samples);
    if best > f64::from(error) {
        return Err(anyhow!(
            "an error of {error} cannot be had with at most {samples} samples per pixel; {sure:.2} can, as in --max-error {sure:.2}"
        )
        .into());
    }
    Ok(FrameSamples::for_error(error, samples))
}

/// Returns the moments of a few pictures, spread over all.
fn moments(settings: &RenderSettings) -> Vec<Time> {
    /// From how many frames on three of them are looked at.
    const MANY: usize = 24;
    let count = settings.count();
    let chosen = if count < MANY { vec![count / 2] } else { vec![0, count / 2, count - 1] };
    let shots = settings.shots().enumerate().filter(|(index, _)| chosen.contains(index));
    shots.map(|(_, shot)| shot.time).collect()
}

/// Plans a sequence within a time.
fn deadline(
    engine: &mut Engine,
    settings: &RenderSettings,
    within: Duration,
    start: Instant,
) -> Result<Deadline, Failure> {
    let count = settings.count();
    let ladder = Ladder::measure(engine, &moments(settings))?;
    let deadline = Deadline::new(ladder, within, u32::try_from(count).unwrap_or(u32::MAX));
    let least = deadline.least();
    if least > within.saturating_sub(start.elapsed()) {
        return Err(anyhow!(
            "{} cannot be rendered within {:.0} s: with one sample per pixel they take about {:.0} s; give more time, a smaller --size, \
             fewer --frames, or --draft",
            if count == 1 { "1 frame".to_owned() } else { format!("{count} frames") },
            within.as_secs_f64(),
            (least + start.elapsed()).as_secs_f64().ceil()
        )
        .into());
    }
    Ok(deadline)
}

/// Reads the frames of a file of settings.
fn read(file: &Path) -> anyhow::Result<Vec<Value>> {
    let name = file.display();
    let text = fs::read_to_string(file).with_context(|| format!("cannot read `{name}`"))?;
    let settings: Value =
        serde_json::from_str(&text).with_context(|| format!("`{name}` is no JSON, as rayreel writes it"))?;
    let Some(frames) = settings["frames"].as_array() else {
        bail!("`{name}` has no list `frames`: it is written by render --max-error and --deadline");
    };
    for frame in frames {
        ensure!(
            samples(frame).is_some(),
            "`{name}` has a frame without sound `samples` and `max_error`: {frame}"
        );
    }
    Ok(frames.clone())
}

/// Returns the samples that are written for a shot.
fn samples_of(frames: &[Value], shot: &Shot) -> Option<FrameSamples> {
    let is_it = |frame: &&Value| match shot.frame {
        Some(index) => frame["frame"].as_u64() == Some(index.into()),
        None => frame["time"].as_f64() == Some(shot.time.seconds()),
    };
    samples(frames.iter().find(is_it)?)
}

fn samples(frame: &Value) -> Option<FrameSamples> {
    let samples = u32::try_from(frame["samples"].as_u64()?).ok()?;
    #[expect(clippy::cast_possible_truncation, reason = "it is one, written out")]
    let max_error = frame["max_error"].as_f64()? as f32;
    let sound = (1..=Sampling::LARGEST_COUNT).contains(&samples)
        && (0.0..=Sampling::LARGEST_ERROR).contains(&max_error);
    sound.then_some(FrameSamples { samples, max_error })
}
