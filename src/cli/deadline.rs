//! `rayreel render --deadline`: all frames within a time.

use std::ops::ControlFlow;
use std::path::{Path, PathBuf};
use std::sync::atomic::{AtomicBool, Ordering};
use std::sync::{Arc, Mutex, MutexGuard, PoisonError};
use std::time::{Duration, Instant};

use anyhow::{Context, anyhow};

use rayreel::Engine;
use rayreel::accuracy::{Deadline, FrameSamples, FrameSurvey, survey_order};
use rayreel::components::Sampling;
use rayreel::output::{Sequence, WriteError};
use rayreel::sequence::{Existing, FrameVerdict, SequenceObserver, Shot};
use rayreel::trace::RoundPolicy;

use super::exit::Failure;
use super::movie;
use super::settings::RenderSettings;
use super::settings_file::SettingsFile;

/// Frames that are rendered within a time, in the order of the shots.
pub(super) struct Paced {
    deadline: Arc<Mutex<Deadline>>,
    place: usize,
    /// The time of this run.
    within: Duration,
}

/// The error that ends a frame early: no picture shows less.
const LEAST_ERROR: f32 = 1.0 / 1024.0;
/// The part of the time in which frames are surveyed, and that of the first one.
const SURVEY: f64 = 0.1;
const LONG: f64 = 0.03;

impl Paced {
    /// Looks at frames to find out what they take. `None` if it was cancelled.
    ///
    /// # Errors
    ///
    /// If there is not even time for one sample per pixel.
    pub(super) fn new(
        engine: &mut Engine,
        (settings, known): (&RenderSettings, &SettingsFile),
        movie: Option<&Path>,
        (start, within): (Instant, Duration),
        cancelled: &AtomicBool,
    ) -> Result<Option<Self>, Failure> {
        let shots: Vec<Shot> = settings.shots().collect();
        let (mut used, mut wanted, mut kept) = (0.0, Vec::new(), Vec::new());
        for (place, shot) in shots.iter().enumerate() {
            match kept_seconds(engine, shot, (settings, known), within)? {
                Some(seconds) => {
                    used += seconds;
                    kept.push(place);
                }
                None => wanted.push(place),
            }
        }
        let within = within.saturating_sub(Duration::from_secs_f64(used));
        let mut deadline = Deadline::new(start, within, shots.len());
        kept.into_iter().for_each(|place| deadline.keep(place));
        let folder = tempfile::tempdir().context("cannot make a temporary folder")?;
        let Surveyed { files, quickest } =
            survey(engine, (&shots, &wanted), (settings, folder.path()), &mut deadline, cancelled)?;
        let least = if files.is_empty() { 0.0 } else { quickest * wanted.len() as f64 };
        require_time(least, wanted.len(), within, start.elapsed())?;
        if let Some(movie) = movie.filter(|_| !files.is_empty()) {
            let trial = folder.path().join(movie.file_name().unwrap_or_default());
            let encode = |count: usize| {
                let (begun, files) = (Instant::now(), files[..count].to_vec());
                let rate = engine.timeline().rate;
                movie::make_of(&trial, (files, settings.sequence.format()), rate, cancelled)?;
                anyhow::Ok(begun.elapsed().as_secs_f64())
            };
            let one = encode(1)?;
            let each =
                if files.len() > 1 { (encode(files.len())? - one) / (files.len() - 1) as f64 } else { 0.0 };
            deadline.reserve(one + each.max(0.0) * (shots.len() - 1) as f64);
        }
        if cancelled.load(Ordering::Relaxed) {
            return Ok(None);
        }
        deadline.spread_demands();
        Ok(Some(Self { deadline: Arc::new(Mutex::new(deadline)), place: 0, within }))
    }

    /// Sets the engine up for the next frame. Returns its samples.
    pub(super) fn begin(&mut self, engine: &mut Engine) -> FrameSamples {
        let samples = FrameSamples::for_error(LEAST_ERROR, Sampling::LARGEST_COUNT);
        samples.set_up(engine);
        engine.set_round_policy(Some(self.deadline.clone()));
        let place = self.place;
        self.locked().begin(place);
        samples
    }

    /// Notes that the next frame is there already.
    pub(super) fn keep(&mut self) {
        let place = self.place;
        self.locked().keep(place);
        self.place += 1;
    }

    /// Notes that the frame is rendered.
    pub(super) fn end(&mut self) {
        self.locked().end();
        self.place += 1;
    }

    /// Notes that a frame is written, which took so long.
    pub(super) fn written(&mut self, took: Duration) {
        self.locked().written(took);
    }

    /// Returns by how much a time is longer than it was to be, in words.
    pub(super) fn late(&self, took: Duration) -> Option<String> {
        (took > self.within).then(|| {
            format!(
                "it took {:.1} s longer than the {:.1} s they were given",
                (took - self.within).as_secs_f64(),
                self.within.as_secs_f64()
            )
        })
    }

    fn locked(&self) -> MutexGuard<'_, Deadline> {
        self.deadline.lock().unwrap_or_else(PoisonError::into_inner)
    }
}

/// Returns the seconds that a shot took, if it is there as it was chosen for the same deadline.
fn kept_seconds(
    engine: &mut Engine,
    shot: &Shot,
    (settings, known): (&RenderSettings, &SettingsFile),
    within: Duration,
) -> Result<Option<f64>, Failure> {
    let known = known.of_deadline(shot, within.as_secs_f64()).filter(|_| settings.are_frames());
    let Some((samples, seconds)) = known else { return Ok(None) };
    samples.set_up(engine);
    let sequence = (&settings.sequence, settings.existing);
    let verdict = engine.verdict(shot, &shot.file(&settings.sequence), sequence)?;
    Ok((verdict == FrameVerdict::Whole).then_some(seconds))
}

/// The frames that were surveyed.
struct Surveyed {
    files: Vec<PathBuf>,
    /// The seconds of the one that took the least.
    quickest: f64,
}

/// Takes a few samples of frames that are spread over the sequence, as many frames as a part of the time allows, and writes them into a folder
/// as frames are written.
fn survey(
    engine: &mut Engine,
    (shots, wanted): (&[Shot], &[usize]),
    (settings, folder): (&RenderSettings, &Path),
    deadline: &mut Deadline,
    cancelled: &AtomicBool,
) -> Result<Surveyed, Failure> {
    let end = deadline.left() * (1.0 - SURVEY);
    let mut surveyed = Surveyed { files: Vec::new(), quickest: f64::INFINITY };
    for place in survey_order(wanted.len()).map(|place| wanted[place]) {
        if cancelled.load(Ordering::Relaxed) || (!surveyed.files.is_empty() && deadline.left() < end) {
            break;
        }
        let (shot, format) = (shots[place], settings.sequence.format());
        let name = format!("{place}");
        let sequence = Sequence::new(folder.to_owned(), name, shot.frame.unwrap_or(0), format);
        let begun = Instant::now();
        // The first one is looked at for longer.
        let long = if surveyed.files.is_empty() { LONG * deadline.left() } else { 0.0 };
        let survey = Arc::new(Mutex::new(FrameSurvey::until(begun + Duration::from_secs_f64(long))));
        let mut surveyor = Surveyor { survey, begun, first: 0.0, writing: 0.0, refused: None };
        engine.render_shots(
            std::iter::once(shot),
            (&sequence, Existing::Overwrite),
            cancelled,
            &mut surveyor,
        )?;
        let Surveyor { survey, first, writing, refused, .. } = surveyor;
        if let Some(error) = refused {
            return Err(anyhow!(error).into());
        }
        let survey = survey.lock().unwrap_or_else(PoisonError::into_inner);
        deadline.note_demand(place, survey.demand(), [first, writing]);
        if let Some(calibration) = survey.calibration() {
            deadline.calibrate(calibration);
        }
        surveyed.quickest = surveyed.quickest.min(first);
        surveyed.files.push(shot.file(&sequence));
    }
    engine.set_round_policy(None);
    Ok(surveyed)
}

/// Hears what a surveyed frame takes.
struct Surveyor {
    survey: Arc<Mutex<FrameSurvey>>,
    begun: Instant,
    /// Seconds until there was a sample of each pixel, and of writing.
    first: f64,
    writing: f64,
    refused: Option<WriteError>,
}

impl SequenceObserver for Surveyor {
    fn render(&mut self, engine: &mut Engine, _: &Shot) {
        FrameSamples::for_error(LEAST_ERROR, Sampling::LARGEST_COUNT).set_up(engine);
        engine.set_round_policy(Some(self.survey.clone() as Arc<Mutex<dyn RoundPolicy>>));
    }

    fn rendered(&mut self, _: &Engine, _: &Shot) -> ControlFlow<()> {
        let first = self.survey.lock().unwrap_or_else(PoisonError::into_inner).first_round();
        self.first = (first.unwrap_or_else(Instant::now) - self.begun).as_secs_f64();
        ControlFlow::Continue(())
    }

    fn written(&mut self, _: &Shot, took: Duration) {
        self.writing = took.as_secs_f64();
    }

    fn refused(&mut self, error: WriteError) {
        self.refused = Some(error);
    }
}

/// Returns an error if there is not enough time for frames that take at least so many seconds, as the quickest of those that were surveyed
/// tells.
fn require_time(least: f64, frames: usize, within: Duration, gone: Duration) -> anyhow::Result<()> {
    /// By how much a measurement may be wrong: what may be possible is not refused.
    const WRONG: f64 = 2.0;
    if least / WRONG <= within.saturating_sub(gone).as_secs_f64() {
        return Ok(());
    }
    let (frames, take) = match frames {
        1 => ("1 frame".to_owned(), "it takes"),
        count => (format!("{count} frames"), "they take"),
    };
    Err(anyhow!(
        "{frames} cannot be rendered within {}: with one sample per pixel {take} about {}; give more time, a smaller --size, fewer \
         --frames, or --draft",
        in_words(within),
        in_words(Duration::from_secs_f64(least) + gone)
    ))
}

/// Writes a time as `90 s` or `0.4 s`.
fn in_words(time: Duration) -> String {
    let seconds = time.as_secs_f64();
    let decimals = if seconds < 0.1 { 3 } else { usize::from(seconds < 10.0) };
    format!("{seconds:.decimals$} s")
}
