//! `rayreel render --sheet`: renders all pictures onto one contact sheet.

use std::sync::atomic::AtomicBool;
use std::time::{Duration, Instant};

use rayreel::Engine;
use rayreel::components::FilmSettings;
use rayreel::output::Sheet;
use rayreel::sequence::render_encoded;

use super::choice::SampleSelection;
use super::exit::Failure;
use super::progress::Progress;
use super::report::{RenderReport, SheetReport, ShotReport};
use super::settings::OutputSettings;

/// Creates an empty sheet with the given columns and rows of films.
pub(super) fn empty((columns, rows): (u32, u32), film: FilmSettings) -> anyhow::Result<Sheet> {
    Ok(Sheet::new(columns, rows, (film.width, film.height))?)
}

/// Renders every frame onto the sheet and then writes it. Writes nothing on cancellation.
pub(super) fn render(
    engine: &mut Engine,
    settings: &OutputSettings,
    choice: &mut SampleSelection,
    mut sheet: Sheet,
    cancelled: &AtomicBool,
    report: &mut RenderReport,
) -> Result<(), Failure> {
    let mut progress = Progress::start(settings);
    for shot in settings.shots() {
        choice.begin(engine, &shot);
        choice.render(engine);
        let film = render_encoded(engine, &shot, cancelled, &mut |so_far| progress.rendering(&shot, so_far))?;
        let Some(film) = film else { return Ok(()) };
        choice.end(engine, &shot)?;
        choice.written(Duration::ZERO);
        report.warnings.look(engine, &shot.moment());
        sheet.add(&film, shot.frame.unwrap_or(0), shot.time);
        let shot = ShotReport::new(&shot, None, engine.report());
        progress.done(&shot);
        report.shots.push(shot);
    }
    drop(progress);
    report.sheet = Some(write(&sheet, settings)?);
    Ok(())
}

fn write(sheet: &Sheet, settings: &OutputSettings) -> anyhow::Result<SheetReport> {
    let start = Instant::now();
    let path = settings.sequence.sheet();
    sheet.write(&path, settings.sequence.format())?;
    Ok(SheetReport {
        path,
        tiles: settings.sheet.unwrap_or_default(),
        size: (sheet.width(), sheet.height()),
        write: start.elapsed(),
    })
}
