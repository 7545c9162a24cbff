//! `rayreel render`

use std::collections::VecDeque;
use std::fs;
use std::ops::ControlFlow::{self, Break, Continue};
use std::sync::atomic::{AtomicBool, Ordering};
use std::time::{Duration, Instant};

use anyhow::{Context, anyhow};
use serde_json::json;

use rayreel::output::{FoundFrame, WriteError, check_movie, frame_size, remove_leftovers};
use rayreel::scene::{Sources, input::is_stream};
use rayreel::sequence::{FrameRequest, FrameVerdict, SequenceObserver, Surplus, find_surplus, render_frames};
use rayreel::trace::RenderProgress;
use rayreel::{Engine, RenderSettings, Scene};

use super::args::{ProgressName, RenderArguments};
use super::choice::{Chosen, SampleSelection};
use super::draft;
use super::exit::Failure;
use super::interrupt::Interruption;
use super::manifest;
use super::movie;
use super::overrides::load;
use super::print;
use super::progress::Progress;
use super::report::{RenderReport, RenderedFrameReport, SheetReport};
use super::settings::OutputSettings;
use super::sheet;
use super::stream;

pub(super) fn run(arguments: &RenderArguments, interruption: &Interruption) -> Result<(), Failure> {
    let start = Instant::now();
    let mut engine = load(&arguments.scene, &arguments.overrides)?;
    let loaded = start.elapsed();
    let settings = set_up(&mut engine, arguments)?;
    let sheet =
        settings.sheet.map(|tiles| sheet::empty(tiles, engine.effective_settings().film)).transpose()?;
    if settings.stream.is_none() {
        let directory = settings.sequence.directory();
        fs::create_dir_all(directory)
            .with_context(|| format!("cannot make the folder `{}`", directory.display()))?;
        remove_leftovers(directory);
    }
    if let Some(movie) = &arguments.movie {
        check_movie(movie).map_err(anyhow::Error::from)?;
    }
    let cancelled = interruption.deferred();

    let pool = rayon::ThreadPoolBuilder::new()
        .num_threads(settings.threads.unwrap_or(0))
        .build()
        .context("cannot start the rendering threads")?;
    let chosen =
        pool.install(|| SampleSelection::new(arguments, &mut engine, &settings, start, cancelled))?;
    let Some(mut choice) = chosen else { return Err(interruption.failure()) };
    // A scene from a stream cannot be read again, so that `verify` has no use for a manifest.
    if settings.are_frames() && !is_stream(&arguments.scene) {
        manifest::write(arguments, &settings)?;
    }
    let mut report = RenderReport::new(arguments, &engine, loaded, pool.current_num_threads());
    let rendered = pool.install(|| match (sheet, settings.stream) {
        (Some(sheet), _) => sheet::render(&mut engine, &settings, &mut choice, sheet, cancelled, &mut report),
        (None, Some(format)) => {
            stream::render(&mut engine, &settings, &mut choice, format, cancelled, &mut report)
        }
        (None, None) => render_all(&mut engine, &settings, &mut choice, cancelled, &mut report),
    });
    // Ctrl-C after the last frame is not an interruption. A closed pipe counts as complete, unless the same Ctrl-C ended its reader.
    let unread = report.unread && !cancelled.load(Ordering::Relaxed);
    let complete = unread || report.done() == settings.count();
    // An incomplete sheet is not written, and neither are its samples.
    let recorded = if complete || settings.sheet.is_none() {
        choice.finish().map(|chosen| report.chosen = chosen)
    } else {
        Ok(())
    };
    let interrupted = cancelled.load(Ordering::Relaxed) && !complete;
    report.finish(start.elapsed(), interrupted);

    print_report(&report, arguments, &settings)?;
    rendered?;
    recorded?;
    if interrupted {
        return Err(interruption.failure());
    }
    if !complete {
        return Err(anyhow!("not all frames were written").into());
    }
    if settings.are_frames() {
        clear_up(&engine, &settings, arguments)?;
    }
    if let Some(movie) = &arguments.movie {
        if !movie::make(movie, &settings, engine.timeline.rate, cancelled)? {
            note(
                arguments,
                "interrupted: the movie was not made; the same command makes it from the frames, which are done",
            );
            return Err(interruption.failure());
        }
        let film = engine.effective_settings().film;
        let frames = settings.ascending().filter_map(|request| request.frame);
        let remarks = movie::Remarks::new(movie, (film.width, film.height), engine.timeline, frames);
        remarks.warnings.iter().for_each(|warning| warn(arguments, warning));
        remarks.notes.iter().for_each(|remark| note(arguments, remark));
        note(arguments, &format!("the movie is in {}", movie.display()));
        if report.chosen.is_some_and(|chosen| chosen.missed.is_none())
            && let Some(late) = choice.late()
        {
            warn(arguments, &late);
        }
    }
    Ok(())
}

/// Applies the arguments to the engine and returns the render settings.
pub(super) fn set_up(engine: &mut Engine, arguments: &RenderArguments) -> Result<OutputSettings, Failure> {
    if arguments.draft {
        engine.settings = draft::settings(engine);
    }
    let settings = OutputSettings::new(arguments, engine.timeline, engine.effective_settings().film)?;
    engine.settings = RenderSettings {
        size: settings.size,
        cutoff: arguments.cutoff,
        precision: Some(arguments.precision.into()),
        all_effects: arguments.full,
        ..RenderSettings::default()
    }
    .or(engine.settings);
    Ok(settings)
}

/// Prints the report, as text or as JSON.
fn print_report(
    report: &RenderReport,
    arguments: &RenderArguments,
    settings: &OutputSettings,
) -> Result<(), Failure> {
    let sources = sources_for(report, arguments);
    if arguments.json {
        return Ok(print::json(report.to_json(sources.as_ref()))?);
    }
    if arguments.progress == ProgressName::Json {
        report.warnings.print_events(sources.as_ref());
    } else {
        report.warnings.print(sources.as_ref());
    }
    if !report.frames.is_empty() {
        note(arguments, &report.plan());
    }
    if let Some(changed) = report.changed.describe() {
        note(arguments, &changed);
    }
    if let Some(Chosen { file, frames, missed, unequal }) = &report.chosen {
        let frames = if *frames == 1 { "frame".to_owned() } else { format!("{frames} frames") };
        let file = file.display();
        note(
            arguments,
            &format!("the samples are in {file}; --settings with that file gives the same {frames} again"),
        );
        missed.iter().chain(unequal).for_each(|warning| warn(arguments, warning));
    }
    if let Some(unchanged) = report.sheet.as_ref().and_then(SheetReport::unchanged) {
        note(arguments, &unchanged);
    }
    if let Some(slow) = report.slow_frames() {
        note(arguments, &slow);
    }
    note(arguments, &report.summary(settings));
    Ok(())
}

/// Prints a line about the whole run, unless `--quiet` is given. With `--progress json`, the line is a JSON object.
fn note(arguments: &RenderArguments, text: &str) {
    match arguments.progress {
        _ if arguments.quiet => {}
        ProgressName::Json => print::error_json(json!({ "event": "note", "message": text })),
        ProgressName::Auto | ProgressName::None => print::error_line(text),
    }
}

/// Prints a warning, as a JSON object with `--progress json`.
fn warn(arguments: &RenderArguments, text: &str) {
    match arguments.progress {
        ProgressName::Json => print::error_json(json!({ "event": "warning", "message": text })),
        ProgressName::Auto | ProgressName::None => print::error_line(&format!("warning: {text}")),
    }
}

/// Reads the scene's source text again if there are faults to locate in it. Faults are rare, so the text is not kept in memory.
fn sources_for(report: &RenderReport, arguments: &RenderArguments) -> Option<Sources> {
    if report.warnings.are_of_files() || is_stream(&arguments.scene) {
        return None;
    }
    Scene::load_overridden(&arguments.scene, &arguments.overrides.all()).ok().map(|(_, sources)| sources)
}

/// Renders every frame whose file cannot be kept. After a failure, the frames rendered so far are still written.
fn render_all(
    engine: &mut Engine,
    settings: &OutputSettings,
    choice: &mut SampleSelection,
    cancelled: &AtomicBool,
    report: &mut RenderReport,
) -> Result<(), Failure> {
    let progress = Progress::start(settings);
    let unwritten = VecDeque::new();
    let mut reporter =
        Reporter { settings, choice, report, progress, unwritten, noted: Ok(()), refused: None };
    let (requests, OutputSettings { sequence, existing, .. }) = (settings.requests(), settings);
    let rendered = render_frames(engine, requests, sequence, *existing, cancelled, &mut reporter);
    let Reporter { progress, noted, refused, .. } = reporter;
    drop(progress);
    let rendered = rendered.map_err(Failure::from).and(noted.map_err(Failure::from));
    outcome(refused.map(|error| Failure::Other(error.into())), rendered)
}

/// Observer of the sequence: configures the engine for each frame, reports its result and shows the progress.
struct Reporter<'a> {
    settings: &'a OutputSettings,
    choice: &'a mut SampleSelection,
    report: &'a mut RenderReport,
    progress: Progress,
    /// Rendered frames that are not yet written, in the order in which they are written.
    unwritten: VecDeque<RenderedFrameReport>,
    /// Result of recording the selected samples.
    noted: anyhow::Result<()>,
    refused: Option<WriteError>,
}

impl SequenceObserver for Reporter<'_> {
    fn begin(&mut self, engine: &mut Engine, request: &FrameRequest) {
        self.choice.begin(engine, request);
    }

    fn render(&mut self, engine: &mut Engine, _: &FrameRequest) {
        self.choice.render(engine);
    }

    fn kept(&mut self, engine: &Engine, request: &FrameRequest) -> ControlFlow<()> {
        self.report.warnings.collect(engine, &request.moment());
        self.choice.keep(request);
        self.report.kept.push(request.frame);
        self.progress.kept(request, &request.file(&self.settings.sequence));
        Continue(())
    }

    fn rejected(&mut self, request: &FrameRequest, verdict: &FrameVerdict) {
        self.progress.rejected(&request.file(&self.settings.sequence), verdict);
    }

    fn rendering(&mut self, request: &FrameRequest, progress: RenderProgress) {
        self.progress.rendering(request, progress);
    }

    fn rendered(&mut self, engine: &Engine, request: &FrameRequest) -> ControlFlow<()> {
        self.noted = self.choice.end(engine, request);
        self.report.warnings.collect(engine, &request.moment());
        let path = request.file(&self.settings.sequence);
        self.unwritten.push_back(RenderedFrameReport::new(request, Some(path), engine.report()));
        if self.noted.is_ok() { Continue(()) } else { Break(()) }
    }

    fn written(&mut self, _: &FrameRequest, duration: Duration) {
        self.choice.written(duration);
        let Some(frame) = self.unwritten.pop_front() else { return };
        let frame = frame.written(duration);
        self.progress.done(&frame);
        self.report.frames.push(frame);
    }

    fn refused(&mut self, error: WriteError) {
        self.unwritten.pop_front();
        self.refused.get_or_insert(error);
    }
}

/// Lists stray files: files in the folder that look like frames of the sequence but are not. With `--clean`, removes the ones that rayreel
/// wrote.
fn clear_up(engine: &Engine, settings: &OutputSettings, arguments: &RenderArguments) -> anyhow::Result<()> {
    /// Maximum number of files listed.
    const MOST: usize = 5;
    /// Stray frames with at most this many pixels (4K) are read to check that rayreel wrote them, even if the film is smaller. Larger
    /// frames could take any amount of memory.
    const MOST_PIXELS: u64 = 3840 * 2160;
    let (film, sequence, clean) = (engine.effective_settings().film, &settings.sequence, arguments.clean);
    let pixels = |(width, height): (u32, u32)| u64::from(width) * u64::from(height);
    let most_pixels = pixels((film.width, film.height)).max(MOST_PIXELS);
    let surplus = find_surplus(sequence, engine.timeline.frame_count(), (film.width, film.height))
        .with_context(|| format!("cannot read the folder `{}`", sequence.directory().display()))?;
    let (mut removed, mut remaining) = (0, Vec::new());
    for surplus in surplus {
        let is_own = || {
            let size =
                frame_size(&surplus.path, sequence.format()).filter(|size| pixels(*size) <= most_pixels);
            let found = size.map(|size| FoundFrame::expected_at(&surplus.path, sequence.format(), size));
            matches!(found, Some(FoundFrame::Complete { .. }))
        };
        if clean && is_own() {
            fs::remove_file(&surplus.path)
                .with_context(|| format!("cannot remove `{}`", surplus.path.display()))?;
            removed += 1;
        } else {
            remaining.push(surplus);
        }
    }
    if removed > 0 {
        let files = in_files(removed, "that was no frame", "that were no frames");
        note(arguments, &format!("removed {files}"));
    }
    for Surplus { path, reason } in remaining.iter().take(MOST) {
        warn(arguments, &format!("`{}` is no frame of this sequence: {reason}", path.display()));
    }
    if remaining.len() > MOST {
        warn(arguments, &format!("so {}", in_files(remaining.len() - MOST, "more is", "more are")));
    }
    let help = match clean {
        false => "--clean removes what `rayreel` has written of it",
        true => {
            "it was not removed: `rayreel` has not written it, or it is corrupt, or larger than the film and than 3840x2160"
        }
    };
    match arguments.progress {
        _ if remaining.is_empty() => {}
        ProgressName::Json => warn(arguments, help),
        ProgressName::Auto | ProgressName::None => print::error_line(&format!("  {help}")),
    }
    Ok(())
}

fn in_files(count: usize, one: &str, several: &str) -> String {
    if count == 1 { format!("1 file {one}") } else { format!("{count} files {several}") }
}

/// Combines a failure to write a file with the result of rendering. If both failed, prints the first failure and returns the second.
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
