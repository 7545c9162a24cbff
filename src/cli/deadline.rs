//! `rayreel render --deadline`: renders all frames within a time limit.

use std::ops::ControlFlow;
use std::path::{Path, PathBuf};
use std::sync::atomic::{AtomicBool, Ordering};
use std::sync::{Arc, Mutex, MutexGuard, PoisonError};
use std::time::{Duration, Instant};

use anyhow::{Context, anyhow};

use rayreel::Engine;
use rayreel::accuracy::{Deadline, FrameSamples, FrameSurvey, survey_order};
use rayreel::components::Sampling;
use rayreel::output::{Sequence, WriteError, write_movie};
use rayreel::sequence::{
    Existing, FrameRequest, FrameVerdict, SequenceObserver, frame_verdict, render_frames,
};
use rayreel::trace::RoundPolicy;

use super::exit::Failure;
use super::settings::OutputSettings;
use super::settings_file::SettingsFile;

/// Frames that are rendered within a time limit, in the order of the requests.
pub(super) struct Paced {
    deadline: Arc<Mutex<Deadline>>,
    /// Index of the current or next frame among the requests.
    index: usize,
    /// Time limit of this run, less the time that kept frames took.
    within: Duration,
}

/// Error at which a frame ends early, in 8-bit levels. Smaller errors are invisible.
const LEAST_ERROR: f32 = 1.0 / 1024.0;
/// Fraction of the time that is spent on surveying frames.
const SURVEY: f64 = 0.1;
/// Fraction of the time that is spent on surveying the first frame.
const FIRST_SURVEY: f64 = 0.03;

impl Paced {
    /// Surveys frames to estimate their cost. Returns `None` on cancellation.
    ///
    /// # Errors
    ///
    /// If the time does not suffice for one sample per pixel.
    pub(super) fn new(
        engine: &mut Engine,
        settings: &OutputSettings,
        known: &SettingsFile,
        movie: Option<&Path>,
        start: Instant,
        within: Duration,
        cancelled: &AtomicBool,
    ) -> Result<Option<Self>, Failure> {
        let requests: Vec<FrameRequest> = settings.requests().collect();
        let (mut used, mut wanted, mut kept) = (0.0, Vec::new(), Vec::new());
        for (index, request) in requests.iter().enumerate() {
            match kept_seconds(engine, request, settings, known, within)? {
                Some(seconds) => {
                    used += seconds;
                    kept.push(index);
                }
                None => wanted.push(index),
            }
        }
        let within = within.saturating_sub(Duration::from_secs_f64(used));
        let mut deadline = Deadline::new(start, within, requests.len());
        kept.into_iter().for_each(|index| deadline.keep(index));
        let folder = tempfile::tempdir().context("cannot make a temporary folder")?;
        let Surveyed { files, quickest } =
            survey(engine, &requests, &wanted, settings, folder.path(), &mut deadline, cancelled)?;
        let least = if files.is_empty() { 0.0 } else { quickest * wanted.len() as f64 };
        require_time(least, wanted.len(), within, start.elapsed())?;
        if let Some(movie) = movie.filter(|_| !files.is_empty()) {
            let trial = folder.path().join(movie.file_name().unwrap_or_default());
            let encode = |count: usize| {
                let (start, rate) = (Instant::now(), engine.timeline.rate);
                write_movie(&trial, &files[..count], settings.sequence.format(), rate, cancelled)?;
                anyhow::Ok(start.elapsed().as_secs_f64())
            };
            let one = encode(1)?;
            let each =
                if files.len() > 1 { (encode(files.len())? - one) / (files.len() - 1) as f64 } else { 0.0 };
            deadline.reserve(one + each.max(0.0) * (requests.len() - 1) as f64);
        }
        if cancelled.load(Ordering::Relaxed) {
            return Ok(None);
        }
        deadline.spread_demands();
        Ok(Some(Self { deadline: Arc::new(Mutex::new(deadline)), index: 0, within }))
    }

    /// Configures the engine for the next frame and returns its samples.
    pub(super) fn begin(&mut self, engine: &mut Engine) -> FrameSamples {
        let samples = FrameSamples::for_error(LEAST_ERROR, Sampling::LARGEST_COUNT);
        samples.set_up(engine);
        engine.round_policy = Some(self.deadline.clone());
        let index = self.index;
        self.locked().begin(index);
        samples
    }

    /// Records that the next frame is kept.
    pub(super) fn keep(&mut self) {
        let index = self.index;
        self.locked().keep(index);
        self.index += 1;
    }

    /// Records that the current frame is rendered.
    pub(super) fn end(&mut self) {
        self.locked().end();
        self.index += 1;
    }

    /// Records the time taken to write a frame.
    pub(super) fn written(&mut self, took: Duration) {
        self.locked().written(took);
    }

    /// Returns a message if a duration exceeds the time limit.
    pub(super) fn late(&self, took: Duration) -> Option<String> {
        (took > self.within).then(|| {
            format!(
                "it took {:.1} s longer than the {:.1} s of the deadline",
                (took - self.within).as_secs_f64(),
                self.within.as_secs_f64()
            )
        })
    }

    fn locked(&self) -> MutexGuard<'_, Deadline> {
        self.deadline.lock().unwrap_or_else(PoisonError::into_inner)
    }
}

/// Returns the seconds that a frame took, if its file is valid and its samples were selected for the same deadline.
fn kept_seconds(
    engine: &mut Engine,
    request: &FrameRequest,
    settings: &OutputSettings,
    known: &SettingsFile,
    within: Duration,
) -> Result<Option<f64>, Failure> {
    let known = known.of_deadline(request, within.as_secs_f64()).filter(|_| settings.are_frames());
    let Some((samples, seconds)) = known else { return Ok(None) };
    samples.set_up(engine);
    let OutputSettings { sequence, existing, .. } = settings;
    let verdict = frame_verdict(engine, request, &request.file(sequence), sequence, *existing)?;
    Ok((verdict == FrameVerdict::UpToDate).then_some(seconds))
}

/// The surveyed frames.
struct Surveyed {
    files: Vec<PathBuf>,
    /// Shortest time in seconds for one sample of every pixel of a frame.
    quickest: f64,
}

/// Renders frames that are spread over the sequence with a few samples each, until a fraction of the time is spent, and writes them to a
/// folder in the format of the sequence.
fn survey(
    engine: &mut Engine,
    requests: &[FrameRequest],
    wanted: &[usize],
    settings: &OutputSettings,
    folder: &Path,
    deadline: &mut Deadline,
    cancelled: &AtomicBool,
) -> Result<Surveyed, Failure> {
    let end = deadline.time_left() * (1.0 - SURVEY);
    let mut surveyed = Surveyed { files: Vec::new(), quickest: f64::INFINITY };
    for index in survey_order(wanted.len()).map(|index| wanted[index]) {
        if cancelled.load(Ordering::Relaxed) || (!surveyed.files.is_empty() && deadline.time_left() < end) {
            break;
        }
        let (request, format) = (requests[index], settings.sequence.format());
        let name = format!("{index}");
        let sequence = Sequence::new(folder.to_owned(), name, request.frame.unwrap_or(0), format);
        let start = Instant::now();
        // The first frame is surveyed for longer, to calibrate the estimates.
        let long = if surveyed.files.is_empty() { FIRST_SURVEY * deadline.time_left() } else { 0.0 };
        let survey = Arc::new(Mutex::new(FrameSurvey::until(start + Duration::from_secs_f64(long))));
        let mut surveyor = Surveyor { survey, start, first: 0.0, writing: 0.0, refused: None };
        render_frames(
            engine,
            std::iter::once(request),
            &sequence,
            Existing::Overwrite,
            cancelled,
            &mut surveyor,
        )?;
        let Surveyor { survey, first, writing, refused, .. } = surveyor;
        if let Some(error) = refused {
            return Err(anyhow!(error).into());
        }
        let survey = survey.lock().unwrap_or_else(PoisonError::into_inner);
        deadline.note_survey(index, &survey, [first, writing]);
        surveyed.quickest = surveyed.quickest.min(first);
        surveyed.files.push(request.file(&sequence));
    }
    engine.round_policy = None;
    Ok(surveyed)
}

/// Observer that measures a surveyed frame.
struct Surveyor {
    survey: Arc<Mutex<FrameSurvey>>,
    start: Instant,
    /// Seconds until every pixel had one sample.
    first: f64,
    /// Seconds for encoding and writing.
    writing: f64,
    refused: Option<WriteError>,
}

impl SequenceObserver for Surveyor {
    fn render(&mut self, engine: &mut Engine, _: &FrameRequest) {
        FrameSamples::for_error(LEAST_ERROR, Sampling::LARGEST_COUNT).set_up(engine);
        engine.round_policy = Some(self.survey.clone() as Arc<Mutex<dyn RoundPolicy>>);
    }

    fn rendered(&mut self, _: &Engine, _: &FrameRequest) -> ControlFlow<()> {
        let first = self.survey.lock().unwrap_or_else(PoisonError::into_inner).first_round();
        self.first = (first.unwrap_or_else(Instant::now) - self.start).as_secs_f64();
        ControlFlow::Continue(())
    }

    fn written(&mut self, _: &FrameRequest, took: Duration) {
        self.writing = took.as_secs_f64();
    }

    fn refused(&mut self, error: WriteError) {
        self.refused = Some(error);
    }
}

/// Returns an error if the frames do not fit into the limit `within` less the time `elapsed`. They need at least `least` seconds, as
/// estimated from the fastest surveyed frame.
fn require_time(least: f64, frames: usize, within: Duration, elapsed: Duration) -> anyhow::Result<()> {
    /// Assumed error factor of the measurement. A deadline that might be met is accepted.
    const ERROR_FACTOR: f64 = 2.0;
    if least / ERROR_FACTOR <= within.saturating_sub(elapsed).as_secs_f64() {
        return Ok(());
    }
    let (frames, take) = match frames {
        1 => ("1 frame".to_owned(), "it takes"),
        count => (format!("{count} frames"), "they take"),
    };
    Err(anyhow!(
        "{frames} cannot be rendered within {}: with one sample per pixel {take} about {}; give more time, a smaller --size, fewer \
         --frames, or --draft",
        describe(within),
        describe(Duration::from_secs_f64(least) + elapsed)
    ))
}

/// Formats a time as `90 s` or `0.4 s`.
fn describe(time: Duration) -> String {
    let seconds = time.as_secs_f64();
    let decimals = if seconds < 0.1 { 3 } else { usize::from(seconds < 10.0) };
    format!("{seconds:.decimals$} s")
}
