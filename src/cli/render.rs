//! `rayreel render`

use std::fs;
use std::sync::atomic::{AtomicBool, Ordering};
use std::time::Instant;

use anyhow::{Context, anyhow};

use rayreel::output::{FrameWriter, WrittenFrame, remove_leftovers};
use rayreel::scene::Sources;
use rayreel::{Engine, Scene};

use super::args::RenderArguments;
use super::choice::{Choice, Chosen};
use super::draft;
use super::exit::Failure;
use super::interrupt::Interruption;
use super::overrides::load;
use super::print;
use super::progress::Progress;
use super::report::{RenderReport, ShotReport};
use super::settings::{RenderSettings, resize, set_cutoff};
use super::sheet;

pub(super) fn run(arguments: &RenderArguments, interruption: &Interruption) -> Result<(), Failure> {
    let start = Instant::now();
    let mut engine = load(&arguments.scene, &arguments.overrides)?;
    let loaded = start.elapsed();
    let settings = set_up(&mut engine, arguments)?;
    let sheet = settings.sheet.map(|tiles| sheet::empty(tiles, engine.film_settings())).transpose()?;
    let directory = settings.sequence.directory();
    fs::create_dir_all(directory)
        .with_context(|| format!("cannot make the folder `{}`", directory.display()))?;
    remove_leftovers(directory);
    let cancelled = interruption.deferred();

    let pool = rayon::ThreadPoolBuilder::new()
        .num_threads(settings.threads.unwrap_or(0))
        .build()
        .context("cannot start the rendering threads")?;
    let chosen = pool.install(|| Choice::new(arguments, &mut engine, &settings, (start, cancelled)))?;
    let Some(mut choice) = chosen else { return Err(interruption.failure()) };
    let mut report = RenderReport::new(arguments, &engine, loaded, pool.current_num_threads());
    let rendered = pool.install(|| match sheet {
        Some(sheet) => sheet::render(&mut engine, (&settings, &mut choice), sheet, cancelled, &mut report),
        None => render_all(&mut engine, (&settings, &mut choice), cancelled, &mut report),
    });
    // Ctrl-C after the last frame interrupts nothing.
    let complete = report.shots.len() == settings.count();
    // Of a sheet there is all or nothing.
    let recorded = if complete || settings.sheet.is_none() {
        choice.finish().map(|chosen| report.chosen = chosen)
    } else {
        Ok(())
    };
    let interrupted = cancelled.load(Ordering::Relaxed) && !complete;
    report.finish(start.elapsed(), interrupted);

    tell(&report, arguments, &settings)?;
    rendered?;
    recorded?;
    if interrupted {
        return Err(interruption.failure());
    }
    if !complete {
        return Err(anyhow!("not all frames were written").into());
    }
    Ok(())
}

/// Sets the engine up as the arguments want it, and returns what to render.
fn set_up(engine: &mut Engine, arguments: &RenderArguments) -> Result<RenderSettings, Failure> {
    if arguments.draft {
        draft::apply(engine);
    }
    let settings = RenderSettings::new(arguments, engine.timeline(), engine.film_settings())?;
    engine.set_precision(arguments.precision.into());
    engine.set_full(arguments.full);
    if let Some(cutoff) = arguments.cutoff {
        set_cutoff(engine, cutoff);
    }
    if let Some(size) = settings.size {
        resize(engine, size);
    }
    Ok(settings)
}

/// Prints what was rendered.
fn tell(
    report: &RenderReport,
    arguments: &RenderArguments,
    settings: &RenderSettings,
) -> Result<(), Failure> {
    let sources = sources_for(report, arguments);
    if !arguments.json {
        report.warnings.tell(sources.as_ref());
        if !report.shots.is_empty() {
            print::error_line(&report.plan());
        }
        if let Some(changed) = report.changed.in_words() {
            print::error_line(&changed);
        }
        if let Some(Chosen { file, frames, pilot, missed }) = &report.chosen {
            let frames = if *frames == 1 { "frame".to_owned() } else { format!("{frames} frames") };
            print::error_line(&format!(
                "the samples are in {}, chosen in {:.2} s; --settings with that file gives the same {frames} again",
                file.display(),
                pilot.as_secs_f64()
            ));
            if let Some(missed) = missed {
                print::error_line(&format!("warning: {missed}"));
            }
        }
        print::error_line(&report.summary(settings));
    }
    if arguments.json {
        print::json(&report.to_json(sources.as_ref()))?;
    }
    Ok(())
}

/// Reads the scene's texts again if there are warnings to look up in them. Mostly there are none, so that the texts are not kept.
fn sources_for(report: &RenderReport, arguments: &RenderArguments) -> Option<Sources> {
    if report.warnings.is_empty() || !arguments.scene.is_file() {
        return None;
    }
    Scene::load_overridden(&arguments.scene, &arguments.overrides.all()).ok().map(|(_, sources)| sources)
}

/// Renders every shot and hands it to the writer, which works in parallel. If it cannot go on, what was handed over is written.
fn render_all(
    engine: &mut Engine,
    (settings, choice): (&RenderSettings, &mut Choice),
    cancelled: &AtomicBool,
    report: &mut RenderReport,
) -> Result<(), Failure> {
    let format = settings.sequence.format();
    let writer = FrameWriter::start();
    let progress = Progress::start(settings.count());
    let mut pending = Vec::new();
    let (mut rendered, mut refused) = (Ok(()), None);
    let mut settle =
        |written: WrittenFrame, pending: &Vec<ShotReport>, report: &mut RenderReport| match written.result {
            Ok(()) => {
                let shot = pending[written.ticket].written(written.duration);
                progress.done(&shot, report.shots.len() + 1);
                report.shots.push(shot);
            }
            Err(error) => refused = refused.take().or(Some(error)),
        };
    for (ticket, shot) in settings.shots().enumerate() {
        choice.begin(engine, &shot);
        let film = match engine.render_encoded_unless(shot.time, cancelled) {
            Ok(Some(film)) => film,
            stopped => {
                rendered = stopped.map(drop).map_err(Failure::from);
                break;
            }
        };
        let noted = choice.end(engine, &shot);
        report.warnings.look(engine, &shot.moment());
        let path = settings.file_of(&shot);
        pending.push(ShotReport::new(&shot, Some(path.clone()), engine));
        writer.submit(ticket, path, film, format);
        let mut all_good = true;
        for written in writer.written() {
            all_good &= written.result.is_ok();
            settle(written, &pending, report);
        }
        if let Err(error) = noted {
            rendered = Err(error.into());
            break;
        }
        if !all_good {
            break;
        }
    }
    for written in writer.finish() {
        settle(written, &pending, report);
    }
    drop(progress);
    outcome(refused.map(|error| Failure::Other(error.into())), rendered)
}

/// Returns the first failure, and prints another one before it: a file may be refused, and rendering may stop.
fn outcome(refused: Option<Failure>, rendered: Result<(), Failure>) -> Result<(), Failure> {
    match (refused, rendered) {
        (Some(refused), Err(failure)) => {
            refused.print();
            Err(failure)
        }
        (Some(refused), Ok(())) => Err(refused),
        (None, rendered) => rendered,
    }
}
