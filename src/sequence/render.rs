//! Rendering of frames that are not done yet. Each frame is written while the next is traced.

use std::fmt;
use std::fs;
use std::io;
use std::ops::ControlFlow::{self, Continue};
use std::path::{Path, PathBuf};
use std::sync::atomic::{AtomicBool, Ordering};
use std::time::Duration;

use super::progress_timer::watched;
use super::verify::verdict_of;
use super::{FormerFrame, FrameRequest, FrameVerdict, SequenceFault};
use crate::color::{Linear, Transfer};
use crate::engine::{Engine, EngineError, RenderRequest, unless_cancelled};
use crate::output::{
    Channels, FoundFrame, FrameFormat, FramePixels, FrameWriter, LinearFrame, MovieError, MovieFormat,
    Sequence, WriteError, WrittenFrame, remove_leftovers,
};
use crate::time::FrameList;
use crate::trace::{EncodedFilm, RenderProgress, RenderedImage};

/// The treatment of existing frames.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub enum Existing {
    /// Complete and up-to-date frames are kept; all others are rendered.
    #[default]
    Keep,
    /// All frames are rendered.
    Overwrite,
}

/// An observer of the rendering of frames.
pub trait SequenceObserver {
    /// Called before the file of a frame is checked. Settings that affect how the frame is rendered may be set here.
    fn begin(&mut self, _: &mut Engine, _: &FrameRequest) {}

    /// Called for a frame that is already done, with the engine at its moment. `Break` ends the sequence.
    fn kept(&mut self, _: &Engine, _: &FrameRequest) -> ControlFlow<()> {
        Continue(())
    }

    /// Called for a frame whose file cannot be kept, with the verdict on the file.
    fn rejected(&mut self, _: &FrameRequest, _: &FrameVerdict) {}

    /// Called before a frame is rendered. Settings that affect how the frame is rendered may be set here.
    fn render(&mut self, _: &mut Engine, _: &FrameRequest) {}

    /// Called once a second with the progress of a frame that takes longer than a second.
    fn rendering(&mut self, _: &FrameRequest, _: RenderProgress) {}

    /// Called when a frame is rendered and before it is written in parallel. The engine's report describes the frame. `Break` ends the
    /// sequence after this frame.
    fn rendered(&mut self, _: &Engine, _: &FrameRequest) -> ControlFlow<()> {
        Continue(())
    }

    /// Called when the file of a frame is complete, with the time for encoding and writing.
    fn written(&mut self, _: &FrameRequest, _: Duration) {}

    /// Called if the file of a frame could not be written. The sequence ends.
    fn refused(&mut self, error: WriteError);
}

/// The progress of a sequence.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct SequenceProgress {
    /// Index of the frame that has just been finished.
    pub frame: u32,
    /// True if the frame was done before.
    pub kept: bool,
    /// Number of frames done, including this one.
    pub done: usize,
    /// Total number of frames.
    pub total: usize,
}

/// The result of rendering a sequence. `Display` writes the numbers of frames, and each fault on a line of its own.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct SequenceReport {
    /// Number of frames that were rendered and written.
    pub written: usize,
    /// Number of frames that were already complete and up to date.
    pub kept: usize,
    /// The [faults](Engine::faults) of all frames: entities that are not drawn or not used as given, and components that the world lacks.
    pub faults: Vec<SequenceFault>,
}

impl fmt::Display for SequenceReport {
    fn fmt(&self, formatter: &mut fmt::Formatter<'_>) -> fmt::Result {
        let Self { written, kept, faults } = self;
        write!(formatter, "{written} frames rendered, {kept} kept")?;
        faults.iter().try_for_each(|fault| write!(formatter, "\n{fault}"))
    }
}

impl SequenceReport {
    /// Adds the faults of a frame, at the engine's current moment.
    pub(super) fn collect_faults(&mut self, engine: &Engine, request: &FrameRequest) {
        let frame = request.frame.unwrap_or_default();
        SequenceFault::collect(&mut self.faults, usize::MAX, engine, frame, |_| true);
    }
}

/// An error that stops the rendering of a sequence. All files written are complete.
#[derive(thiserror::Error)]
pub enum SequenceError {
    /// A frame could not be rendered.
    #[error(transparent)]
    Engine(#[from] EngineError),
    /// A file could not be written.
    #[error(transparent)]
    Write(#[from] WriteError),
    /// A movie could not be made.
    #[error(transparent)]
    Movie(#[from] MovieError),
    /// A folder for frames is named like a movie.
    #[error(
        "`{}` is the name of a movie, and `render_to` writes frames into a folder: call `engine.render_movie` for a movie, or name a folder",
        .0.display()
    )]
    NamedLikeMovie(PathBuf),
    /// The folder does not exist and could not be created.
    #[error("cannot make the folder `{}`", path.display())]
    Folder {
        /// The folder.
        path: PathBuf,
        /// The system's error.
        source: io::Error,
    },
}

debug_as_message!(SequenceError);

impl Engine {
    /// Renders all frames of the timeline as PNG files into a folder, which is created if it does not exist. The files are named after the
    /// folder: `out/ball/ball.0000.png` and so on. Frames that are already complete and up to date are kept, so that the next call
    /// continues an interrupted sequence. [`render_sequence`] renders a part of the timeline, writes other formats, and reports progress;
    /// [`render_movie`](Engine::render_movie) makes a movie.
    ///
    /// ```no_run
    /// use rayreel::Engine;
    ///
    /// let report = Engine::load("scenes/first_light.ron")?.render_to("out/first_light")?;
    /// println!("{report}"); // the numbers of frames, and the faults: entities that are not drawn, and why
    /// # Ok::<(), rayreel::sequence::SequenceError>(())
    /// ```
    ///
    /// # Errors
    ///
    /// As [`Engine::render_frame`]; if the name of a new folder ends like that of a movie, as `ball.mp4`; and if the file system reports an
    /// error. All files written are complete.
    pub fn render_to(&mut self, folder: impl AsRef<Path>) -> Result<SequenceReport, SequenceError> {
        let (folder, count) = (folder.as_ref(), self.timeline.frame_count());
        if MovieFormat::of(folder).is_ok() && !folder.is_dir() {
            return Err(SequenceError::NamedLikeMovie(folder.to_owned()));
        }
        let name = folder.file_name().unwrap_or("frame".as_ref());
        let sequence = Sequence::new(folder.to_owned(), name, count - 1, FrameFormat::default());
        render_sequence(self, &FrameList::all(count), &sequence, |_| Continue(()))
    }
}

/// Renders frames into the folder of a sequence, except for frames that are already complete and up to date. After each frame,
/// `on_progress` decides whether to continue.
///
/// ```no_run
/// use std::ops::ControlFlow::Continue;
/// use rayreel::output::{Channels, FrameFormat, Sequence};
/// use rayreel::{Engine, sequence::render_sequence, time::FrameList};
///
/// let mut engine = Engine::load("scenes/first_light.ron")?;
/// let sequence = Sequence::new("out".into(), "first_light", 95, FrameFormat::Png16(Channels::Rgb));
/// let frames: FrameList = "0-95x5".parse()?;
/// let report = render_sequence(&mut engine, &frames, &sequence, |progress| {
///     println!("{} of {}", progress.done, progress.total);
///     Continue(())
/// })?;
/// assert_eq!(report.written + report.kept, 20);
/// # Ok::<(), Box<dyn std::error::Error>>(())
/// ```
///
/// # Errors
///
/// As [`Engine::render_frame`], and if the file system reports an error. All files written are complete.
pub fn render_sequence(
    engine: &mut Engine,
    frames: &FrameList,
    sequence: &Sequence,
    on_progress: impl FnMut(SequenceProgress) -> ControlFlow<()>,
) -> Result<SequenceReport, SequenceError> {
    render_sequence_until(engine, frames, sequence, &AtomicBool::new(false), on_progress)
}

/// Renders frames like [`render_sequence`], until `cancelled` becomes true, also in the middle of a frame.
///
/// # Errors
///
/// As [`render_sequence`].
pub fn render_sequence_until(
    engine: &mut Engine,
    frames: &FrameList,
    sequence: &Sequence,
    cancelled: &AtomicBool,
    on_progress: impl FnMut(SequenceProgress) -> ControlFlow<()>,
) -> Result<SequenceReport, SequenceError> {
    make_folder(sequence.directory())?;
    let frames = frames.within(engine.timeline.frame_count());
    let mut counted = Counted {
        on_progress,
        total: frames.count(),
        report: SequenceReport::default(),
        flow: Continue(()),
        refused: None,
    };
    let timeline = engine.timeline;
    let requests = FrameRequest::frames(&frames, timeline);
    render_frames(engine, requests, sequence, Existing::Keep, cancelled, &mut counted)?;
    let Counted { mut report, refused, .. } = counted;
    SequenceFault::remove_passing(&mut report.faults, report.written + report.kept);
    refused.map_or(Ok(report), |error| Err(error.into()))
}

/// Renders frames into the folder of a sequence, which must exist, until a file cannot be written, the observer breaks, or `cancelled`
/// becomes true. Frames that were rendered before an error are written.
///
/// # Errors
///
/// As [`Engine::render_frame`].
pub fn render_frames(
    engine: &mut Engine,
    requests: impl Iterator<Item = FrameRequest>,
    sequence: &Sequence,
    existing: Existing,
    cancelled: &AtomicBool,
    observer: &mut dyn SequenceObserver,
) -> Result<(), EngineError> {
    let writer = FrameWriter::start();
    let mut former = Default::default();
    // Requests of the frames submitted to the writer, indexed by ticket.
    let mut submitted: Vec<FrameRequest> = Vec::new();
    let report_written =
        |written: WrittenFrame, submitted: &[FrameRequest], observer: &mut dyn SequenceObserver| {
            let is_good = written.result.is_ok();
            match written.result {
                Ok(()) => observer.written(&submitted[written.ticket], written.duration),
                Err(error) => observer.refused(error),
            }
            is_good
        };
    let mut rendered = Ok(());
    for request in requests {
        if cancelled.load(Ordering::Relaxed) {
            break;
        }
        observer.begin(engine, &request);
        let path = request.file(sequence);
        match frame_verdict(engine, &request, &path, sequence, existing) {
            Ok(FrameVerdict::Missing) => {}
            Ok(FrameVerdict::UpToDate) => {
                if observer.kept(engine, &request).is_break() {
                    break;
                }
                continue;
            }
            Ok(verdict) => observer.rejected(&request, &verdict),
            Err(error) => {
                rendered = Err(error);
                break;
            }
        }
        observer.render(engine, &request);
        let mut all_good = true;
        let mut on_progress = |progress| {
            for written in writer.written() {
                all_good &= report_written(written, &submitted, observer);
            }
            observer.rendering(&request, progress);
        };
        let format = sequence.format();
        let pixels = match render_pixels(engine, &request, format, &mut former, cancelled, &mut on_progress) {
            Ok(Some(pixels)) => pixels,
            stopped => {
                rendered = stopped.map(drop);
                break;
            }
        };
        let flow = observer.rendered(engine, &request);
        let fingerprint = engine.report().fingerprint;
        writer.submit(submitted.len(), path, pixels, format, fingerprint);
        submitted.push(request);
        for written in writer.written() {
            all_good &= report_written(written, &submitted, observer);
        }
        if !all_good || flow.is_break() {
            break;
        }
    }
    for written in writer.finish() {
        report_written(written, &submitted, observer);
    }
    rendered
}

/// Renders a frame as output bytes, and reuses tiles of the former one. Returns `None` if `cancelled` becomes true during rendering. Reports
/// the progress to `on_progress` once a second.
///
/// # Errors
///
/// As [`Engine::render_frame`].
pub fn render_encoded(
    engine: &mut Engine,
    request: &FrameRequest,
    former: &mut FormerFrame<Transfer>,
    cancelled: &AtomicBool,
    on_progress: &mut dyn FnMut(RenderProgress),
) -> Result<Option<EncodedFilm>, EngineError> {
    let transfer = engine.effective_settings().film.transfer;
    let image = watched(cancelled, on_progress, |signals, report| {
        engine.render(RenderRequest {
            signals,
            on_pause: Some(&mut |job| report(job.progress())),
            reuse: former.begin(),
            ..RenderRequest::encoded(request.time, transfer)
        })
    });
    let image = unless_cancelled(image)?;
    former.end(engine.report());
    Ok(image.map(|image| image.film))
}

/// Renders the pixels of a frame for a format, with cancellation and progress reports as in [`render_encoded`].
fn render_pixels(
    engine: &mut Engine,
    request: &FrameRequest,
    format: FrameFormat,
    (linear, encoded): &mut (FormerFrame<Linear>, FormerFrame<Transfer>),
    cancelled: &AtomicBool,
    on_progress: &mut dyn FnMut(RenderProgress),
) -> Result<Option<FramePixels>, EngineError> {
    if !format.is_linear() {
        return Ok(
            render_encoded(engine, request, encoded, cancelled, on_progress)?.map(FramePixels::Encoded)
        );
    }
    let image = watched(cancelled, on_progress, |signals, report| {
        engine.render(RenderRequest {
            alpha: format.channels() == Channels::Rgba,
            passes: !format.passes().is_empty(),
            signals,
            on_pause: Some(&mut |job| report(job.progress())),
            reuse: linear.begin(),
            ..RenderRequest::at(request.time)
        })
    });
    let image = unless_cancelled(image)?;
    linear.end(engine.report());
    let Some(RenderedImage { film, alpha, passes, .. }) = image else { return Ok(None) };
    let transfer = engine.effective_settings().film.transfer;
    Ok(Some(FramePixels::Linear(LinearFrame { film, alpha, transfer, passes })))
}

/// Returns the state of a frame's file. Files to be overwritten count as missing.
///
/// # Errors
///
/// As [`Engine::render_frame`].
pub fn frame_verdict(
    engine: &mut Engine,
    request: &FrameRequest,
    path: &Path,
    sequence: &Sequence,
    existing: Existing,
) -> Result<FrameVerdict, EngineError> {
    match existing {
        Existing::Overwrite => Ok(FrameVerdict::Missing),
        Existing::Keep => {
            let film = engine.effective_settings().film;
            let size = (film.width, film.height);
            verdict_of(engine, request, FoundFrame::expected_at(path, sequence.format(), size))
        }
    }
}

/// Creates a folder, and removes partial files of killed processes from it.
pub(super) fn make_folder(folder: &Path) -> Result<(), SequenceError> {
    fs::create_dir_all(folder).map_err(|source| SequenceError::Folder { path: folder.to_owned(), source })?;
    remove_leftovers(folder);
    Ok(())
}

/// An observer that counts frames and reports each of them.
struct Counted<F> {
    on_progress: F,
    total: usize,
    report: SequenceReport,
    flow: ControlFlow<()>,
    refused: Option<WriteError>,
}

impl<F: FnMut(SequenceProgress) -> ControlFlow<()>> Counted<F> {
    fn report_progress(&mut self, request: &FrameRequest, kept: bool) {
        let SequenceReport { written, kept: kept_before, .. } = self.report;
        let progress = SequenceProgress {
            frame: request.frame.unwrap_or_default(),
            kept,
            done: written + kept_before,
            total: self.total,
        };
        if (self.on_progress)(progress).is_break() {
            self.flow = ControlFlow::Break(());
        }
    }
}

impl<F: FnMut(SequenceProgress) -> ControlFlow<()>> SequenceObserver for Counted<F> {
    fn kept(&mut self, engine: &Engine, request: &FrameRequest) -> ControlFlow<()> {
        self.report.collect_faults(engine, request);
        self.report.kept += 1;
        self.report_progress(request, true);
        self.flow
    }

    fn rendered(&mut self, engine: &Engine, request: &FrameRequest) -> ControlFlow<()> {
        self.report.collect_faults(engine, request);
        self.flow
    }

    fn written(&mut self, request: &FrameRequest, _: Duration) {
        self.report.written += 1;
        self.report_progress(request, false);
    }

    fn refused(&mut self, error: WriteError) {
        self.refused.get_or_insert(error);
    }
}
