//! `rayreel accuracy`
//!
//! [`rayreel::accuracy`] measures, and [`table`], [`data`] and [`html`] format the results.

mod bars;
mod chart;
mod data;
mod html;
mod machine;
mod table;

use std::sync::atomic::Ordering;

use anyhow::{Context, bail};

use rayreel::accuracy::{OutputValues, Parameter, Preset, Report, Request, measure};
use rayreel::components::FilmSettings;
use rayreel::time::FrameList;
use rayreel::trace::Signals;
use rayreel::{EffectiveSettings, Engine, EngineError, Film, RenderRequest, RenderSettings};

use super::args::AccuracyArguments;
use super::exit::Failure;
use super::heat_map::heat_map;
use super::interrupt::Interruption;
use super::measure_progress::MeasureProgress;
use super::overrides::{Changed, load};
use super::print;
use super::settings::require_frame;
use super::values::argument_name;
use super::write_file::{ensure_not_the_scene, write_file};
use machine::Machine;

/// Maximum number of frames measured.
const MOST_FRAMES: u32 = 8;

/// The measurements of a scene, with the machine they were made on.
struct Measured {
    scene: String,
    changed: Changed,
    machine: Machine,
    preset: Preset,
    /// Number of chosen frames, if not all of them were measured.
    spread_over: Option<usize>,
    report: Report,
}

pub(super) fn run(arguments: &AccuracyArguments, interruption: &Interruption) -> Result<(), Failure> {
    for file in
        arguments.html.iter().chain(&arguments.csv).chain(&arguments.error_map).chain(&arguments.sample_map)
    {
        ensure_not_the_scene(file, &arguments.scene)?;
    }
    let mut engine = load(&arguments.scene, &arguments.overrides)?;
    let (frames, spread_over) = frames(arguments, &engine)?;
    engine.settings = RenderSettings { size: arguments.size, ..engine.settings };
    let mut progress = MeasureProgress::start();
    let pool = rayon::ThreadPoolBuilder::new()
        .num_threads(arguments.threads.map_or(0, usize::from))
        .build()
        .context("cannot start the rendering threads")?;
    let first = engine.timeline.time_of(frames.first().copied().unwrap_or(0));
    let preset = if arguments.quick { Preset::QUICK } else { Preset::THOROUGH };
    let parameters = varied(arguments, &mut engine, &frames)?;
    let request = Request {
        frames,
        preset,
        parameters,
        sizes: arguments.sizes.clone(),
        keep_films: arguments.html.is_some() || arguments.error_map.is_some(),
    };
    let cancelled = interruption.deferred();
    let report = pool.install(|| measure(&mut engine, &request, cancelled, &mut progress));
    drop(progress);
    let Some(report) = report? else {
        return Err(if cancelled.load(Ordering::Relaxed) {
            print::error_line("interrupted before every setting was timed twice: there is no table yet");
            interruption.failure()
        } else {
            anyhow::anyhow!("there is nothing to measure").into()
        });
    };
    let measured = Measured {
        scene: arguments.scene.display().to_string(),
        changed: Changed::new(&arguments.overrides),
        machine: Machine::this(pool.current_num_threads()),
        preset,
        spread_over,
        report,
    };
    print(&measured, arguments, &engine)?;
    if let Some(file) = &arguments.sample_map {
        let signals = Signals::unless(cancelled);
        let request = || RenderRequest { sample_counts: true, signals, ..RenderRequest::at(first) };
        match pool.install(|| engine.render(request())) {
            Err(EngineError::Cancelled) => {}
            image => write_file(file, &sample_map(&engine, image?.sample_counts)?)?,
        }
    }
    if cancelled.load(Ordering::Relaxed) { Err(interruption.failure()) } else { Ok(()) }
}

/// Returns a PNG heat map of a picture's samples per pixel, on a logarithmic scale.
fn sample_map(engine: &Engine, counts: Option<Film<u32>>) -> anyhow::Result<Vec<u8>> {
    let EffectiveSettings { film: FilmSettings { width, height, .. }, sampling, .. } =
        engine.effective_settings();
    let everywhere = || vec![sampling.samples; width as usize * height as usize];
    let counts = counts.map_or_else(everywhere, |counts| counts.pixels().to_vec());
    let powers: Vec<f64> =
        counts.into_iter().map(|count| 1.0 + libm::log2(f64::from(count.max(1)))).collect();
    heat_map((width, height), &powers)
}

/// Returns the parameters to vary. One that affects none of the frames is an error, before the measurement takes its time.
fn varied(
    arguments: &AccuracyArguments,
    engine: &mut Engine,
    frames: &[u32],
) -> anyhow::Result<Vec<Parameter>> {
    if arguments.vary.is_empty() {
        return Ok(Parameter::ALL.to_vec());
    }
    let mut plans = Vec::new();
    for frame in frames {
        let time = engine.timeline.time_of(*frame);
        let request = RenderRequest { fingerprint: false, ..RenderRequest::at(time) };
        plans.extend(engine.plan(request)?.plan.clone());
    }
    let affects = |parameter: &Parameter| plans.iter().any(|plan| parameter.affects(plan));
    match arguments.vary.iter().find(|parameter| !affects(parameter)) {
        Some(parameter) => {
            let name = argument_name(parameter.name());
            bail!("--vary {name}: it affects none of the measured frames; leave it out")
        }
        None => Ok(arguments.vary.clone()),
    }
}

/// Returns the frames to measure, by default the middle one. Also returns the number of chosen frames, if not all of them are measured.
fn frames(arguments: &AccuracyArguments, engine: &Engine) -> anyhow::Result<(Vec<u32>, Option<usize>)> {
    let timeline = engine.timeline;
    let Some(list) = &arguments.frames else { return Ok((vec![timeline.frame_count() / 2], None)) };
    let chosen: FrameList = list.within(timeline.frame_count());
    require_frame(chosen.last(), timeline)?;
    Ok(match chosen.spread_frames(MOST_FRAMES) {
        Some(spread) => (spread, Some(chosen.count())),
        None => (chosen.frames().collect(), None),
    })
}

fn print(measured: &Measured, arguments: &AccuracyArguments, engine: &Engine) -> Result<(), Failure> {
    if let Some(file) = &arguments.html {
        let page = html::page(measured, engine.effective_settings().film.transfer)?;
        write_file(file, page.as_bytes())?;
    }
    if let Some(file) = &arguments.csv {
        write_file(file, &data::csv(measured)?)?;
    }
    if let (Some(file), Some(film)) = (&arguments.error_map, &measured.report.own().film) {
        let transfer = engine.effective_settings().film.transfer;
        let [own, reference] =
            [film, &measured.report.reference.film].map(|film| OutputValues::of_film(film, transfer));
        write_file(file, &heat_map(own.size(), &own.differences(&reference))?)?;
    }
    if arguments.json {
        print::json(data::json(measured))?;
    } else {
        print::result(&table::draw(measured))?;
    }
    Ok(())
}
