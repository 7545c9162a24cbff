//! `rayreel render --sheet` and `--variants`: renders all pictures onto one contact sheet.

use std::sync::atomic::AtomicBool;
use std::time::{Duration, Instant};

use rayreel::Engine;
use rayreel::components::FilmSettings;
use rayreel::output::Sheet;
use rayreel::sequence::{FormerFrame, render_encoded};
use rayreel::systems::{Effect, EffectSet, FrameReport, Need, Plan};
use rayreel::trace::EncodedFilm;

use super::choice::SampleSelection;
use super::exit::Failure;
use super::progress::Progress;
use super::report::{RenderReport, RenderedFrameReport, SheetReport, UnchangedVariant};
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
    let (mut progress, mut former) = (Progress::start(settings), FormerFrame::default());
    let mut variants = Variants { without: engine.settings.without, first: None, unchanged: Vec::new() };
    let versions = [None].into_iter().chain(settings.variants.iter().copied().map(Some));
    for request in settings.requests() {
        for version in versions.clone() {
            engine.settings.without =
                version.map_or(variants.without, |effect| variants.without.with(effect));
            choice.begin(engine, &request);
            choice.render(engine);
            let film = render_encoded(engine, &request, &mut former, cancelled, &mut |so_far| {
                progress.rendering(&request, so_far);
            })?;
            let Some(film) = film else { return Ok(()) };
            choice.end(engine, &request)?;
            choice.written(Duration::ZERO);
            if version.is_none() {
                report.warnings.collect(engine, &request.moment());
            }
            let rendered = RenderedFrameReport::new(&request, None, engine.report());
            progress.done(&rendered);
            report.frames.push(rendered);
            if settings.variants.is_empty() {
                sheet.add(&film, request.frame.unwrap_or(0), request.time);
            } else {
                variants.add(&mut sheet, film, version, engine.report());
            }
        }
    }
    drop(progress);
    engine.settings.without = variants.without;
    report.sheet = Some(SheetReport { unchanged: variants.unchanged, ..write(&sheet, settings)? });
    Ok(())
}

/// The variants of a picture so far.
struct Variants {
    /// The effects that are disabled in all variants.
    without: EffectSet,
    /// The picture with all other effects, and its plan.
    first: Option<(EncodedFilm, Option<Plan>)>,
    unchanged: Vec<UnchangedVariant>,
}

impl Variants {
    /// Adds a picture to the sheet, with all effects or without one.
    fn add(&mut self, sheet: &mut Sheet, film: EncodedFilm, version: Option<Effect>, report: &FrameReport) {
        let Some(effect) = version else {
            sheet.add_captioned(&film, &["all effects", "all"]);
            self.first = Some((film, report.plan.clone()));
            return;
        };
        let caption = format!("no {effect}");
        match &self.first {
            Some((first, plan)) if *first == film => {
                sheet.add_captioned(&film, &[&format!("{caption}  unchanged"), &caption]);
                let need = plan.as_ref().map(|plan| plan.need(effect)).filter(|need| !need.is_needed());
                self.unchanged.push(UnchangedVariant { effect, reason: need.map(Need::reason) });
            }
            _ => sheet.add_captioned(&film, &[&caption]),
        }
    }
}

fn write(sheet: &Sheet, settings: &OutputSettings) -> anyhow::Result<SheetReport> {
    let start = Instant::now();
    let path = settings.file_of_sheet();
    sheet.write(&path, settings.sequence.format())?;
    Ok(SheetReport {
        path,
        tiles: settings.sheet.unwrap_or_default(),
        size: (sheet.width(), sheet.height()),
        variants: settings.variants.clone(),
        unchanged: Vec::new(),
        write: start.elapsed(),
    })
}
