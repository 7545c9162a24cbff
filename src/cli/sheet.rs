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
use super::report::{RenderReport, RenderedFrameReport, SheetReport};
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
    for request in settings.requests() {
        choice.begin(engine, &request);
        choice.render(engine);
        let film =
            render_encoded(engine, &request, cancelled, &mut |so_far| progress.rendering(&request, so_far))?;
        let Some(film) = film else { return Ok(()) };
        choice.end(engine, &request)?;
        choice.written(Duration::ZERO);
        report.warnings.collect(engine, &request.moment());
        sheet.add(&film, request.frame.unwrap_or(0), request.time);
        let rendered = RenderedFrameReport::new(&request, None, engine.report());
        progress.done(&rendered);
        report.frames.push(rendered);
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
