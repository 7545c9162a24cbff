//! Selection of the samples of each frame: by the scene, an error target, a deadline, or the settings file of an earlier run.
//!
//! Samples selected for an error target or a deadline are written to a settings file next to the frames. `--settings` reads that file and
//! reproduces the same pictures independently of timing.

use std::collections::BTreeMap;
use std::fs::File;
use std::path::{Path, PathBuf};
use std::sync::atomic::AtomicBool;
use std::time::{Duration, Instant};

use anyhow::{Context, anyhow};

use rayreel::Engine;
use rayreel::accuracy::FrameSamples;
use rayreel::components::Sampling;
use rayreel::output::folder_of;
use rayreel::sequence::FrameRequest;
use rayreel::trace::EstimatedError;

use super::args::RenderArguments;
use super::compare::number;
use super::deadline::Paced;
use super::exit::Failure;
use super::settings::OutputSettings;
use super::settings_file::{FrameRecord, PictureKey, SettingsFile};

/// Selects the samples of each frame and records the selection.
pub(super) struct SampleSelection {
    strategy: Strategy,
    /// Record of the selected samples; it includes the entries of other frames in the same folder.
    record: Option<SettingsRecorder>,
    start: Instant,
    /// Start time of the current frame.
    frame_start: Instant,
    /// Samples of the current frame; `None` for the scene's own.
    samples: Option<FrameSamples>,
}

/// Source of the samples.
enum Strategy {
    /// The scene's own settings.
    Scene,
    /// An error target, the same for all frames.
    Error(FrameSamples),
    Deadline(Paced),
    /// The settings file of an earlier run.
    Settings(SettingsFile),
}

/// The settings file that this run writes.
struct SettingsRecorder {
    file: PathBuf,
    settings: SettingsFile,
    scene: PathBuf,
    /// The deadline in seconds, if one is given.
    deadline: Option<f64>,
    /// Earliest time of the next intermediate write.
    due: Instant,
    /// True if each frame has its own file. The record of a sheet is written only once the sheet is complete.
    is_of_files: bool,
    /// The pictures recorded by this run.
    noted: BTreeMap<PictureKey, FrameRequest>,
    /// Frames whose estimated error exceeds the target, with that error.
    worse: Vec<(String, f64)>,
    /// Frames that may exceed the target because of features that no sample hit, with the error of those features.
    hidden: Vec<(String, f64)>,
}

/// Summary of the recorded samples.
#[derive(Debug)]
pub(super) struct Chosen {
    /// The settings file.
    pub(super) file: PathBuf,
    /// Number of frames recorded by this run.
    pub(super) frames: usize,
    /// Message about the missed deadline or error target, if one was missed.
    pub(super) missed: Option<String>,
    /// Message about the unequal errors of the frames of a deadline.
    pub(super) unequal: Option<String>,
}

impl SampleSelection {
    /// Determines the source of the samples for a run that began at `start`. Returns `None` on cancellation.
    ///
    /// # Errors
    ///
    /// If options conflict, if the deadline is too short, or if the settings of an earlier run cannot be read or lack a frame.
    pub(super) fn new(
        arguments: &RenderArguments,
        engine: &mut Engine,
        settings: &OutputSettings,
        start: Instant,
        cancelled: &AtomicBool,
    ) -> Result<Option<Self>, Failure> {
        ensure_unset(arguments)?;
        let record = match arguments.max_error.is_some() || arguments.deadline.is_some() {
            true => Some(SettingsRecorder::new(settings, &arguments.scene, arguments.deadline)?),
            false => None,
        };
        let strategy = if let Some(error) = arguments.max_error {
            let samples = arguments.overrides.samples().unwrap_or(Sampling::LARGEST_COUNT);
            Strategy::Error(FrameSamples::for_error(error, samples))
        } else if let (Some(within), Some(record)) = (arguments.deadline, &record) {
            let known = &record.settings;
            let movie = arguments.movie.as_deref();
            match Paced::new(engine, settings, known, movie, start, within, cancelled)? {
                Some(paced) => Strategy::Deadline(paced),
                None => return Ok(None),
            }
        } else if let Some(file) = &arguments.settings {
            Strategy::Settings(read(file, settings)?)
        } else {
            Strategy::Scene
        };
        Ok(Some(Self { strategy, record, start, frame_start: start, samples: None }))
    }

    /// Configures the engine for checking whether the file of a frame can be kept.
    pub(super) fn begin(&mut self, engine: &mut Engine, request: &FrameRequest) {
        self.frame_start = Instant::now();
        self.samples = match &self.strategy {
            Strategy::Scene => None,
            Strategy::Error(samples) => Some(samples.clone()),
            Strategy::Deadline(_) => self.record.as_ref().and_then(|record| record.of_deadline(request)),
            Strategy::Settings(settings) => settings.samples_of(request),
        };
        if let Some(samples) = &self.samples {
            samples.set_up(engine);
        }
    }

    /// Configures the engine for rendering the frame.
    pub(super) fn render(&mut self, engine: &mut Engine) {
        if let Strategy::Deadline(paced) = &mut self.strategy {
            self.samples = Some(paced.begin(engine));
        }
    }

    /// Records that the file of the frame was kept.
    pub(super) fn keep(&mut self, request: &FrameRequest) {
        if let Strategy::Deadline(paced) = &mut self.strategy {
            paced.keep();
        }
        if let Some(record) = &mut self.record {
            record.note_kept(self.samples.clone(), request);
        }
    }

    /// Records the samples and the result of the rendered frame.
    pub(super) fn end(&mut self, engine: &Engine, request: &FrameRequest) -> anyhow::Result<()> {
        let took = self.frame_start.elapsed();
        if let Strategy::Deadline(paced) = &mut self.strategy {
            paced.end();
        }
        let (Some(record), Some(samples)) = (&mut self.record, self.samples.take()) else { return Ok(()) };
        let rounds = matches!(self.strategy, Strategy::Deadline(_)).then(|| engine.report().rounds.clone());
        record.note(engine, FrameSamples { rounds, ..samples }, request, took);
        record.write_if_due()
    }

    /// Records the time taken to write a frame.
    pub(super) fn written(&mut self, took: Duration) {
        if let Strategy::Deadline(paced) = &mut self.strategy {
            paced.written(took);
        }
    }

    /// Returns a message if the deadline is missed.
    pub(super) fn late(&self) -> Option<String> {
        let Strategy::Deadline(paced) = &self.strategy else { return None };
        paced.late(self.start.elapsed())
    }

    /// Writes the settings file. Returns its summary, or `None` if nothing was recorded.
    pub(super) fn finish(&mut self) -> anyhow::Result<Option<Chosen>> {
        let Some(mut record) = self.record.take().filter(|record| !record.noted.is_empty()) else {
            return Ok(None);
        };
        record.write()?;
        let missed = self.late().or_else(|| record.missed_target());
        let unequal = record.deadline.and_then(|deadline| unequal_errors(&record.errors_under(deadline)));
        Ok(Some(Chosen { file: record.file, frames: record.noted.len(), missed, unequal }))
    }
}

impl SettingsRecorder {
    /// Creates a record with the entries of the existing settings file, if there is one.
    fn new(settings: &OutputSettings, scene: &Path, deadline: Option<Duration>) -> anyhow::Result<Self> {
        let file = settings.file_of_settings();
        let known = if file.exists() {
            SettingsFile::read(&file).context(
                "the samples of other frames would be lost: remove the file, or name another --out",
            )?
        } else {
            SettingsFile::default()
        };
        let deadline = deadline.map(|deadline| deadline.as_secs_f64());
        let (scene, due) = (scene.to_owned(), Instant::now());
        let is_of_files = settings.sheet.is_none();
        let noted = BTreeMap::new();
        Ok(Self {
            file,
            settings: known,
            scene,
            deadline,
            due,
            is_of_files,
            noted,
            worse: Vec::new(),
            hidden: Vec::new(),
        })
    }

    fn note(
        &mut self,
        engine: &Engine,
        FrameSamples { samples, max_error, rounds }: FrameSamples,
        request: &FrameRequest,
        took: Duration,
    ) {
        let (film, report) = (engine.effective_settings().film, engine.report());
        if let Some(EstimatedError { value, hidden, .. }) = report.error.filter(|_| rounds.is_none()) {
            if value > f64::from(max_error) {
                self.worse.push((request.moment(), value));
            } else if value.hypot(hidden) > f64::from(max_error) {
                self.hidden.push((request.moment(), hidden));
            }
        }
        let error = report.error.map(|error| error.value);
        self.noted.insert(PictureKey::of_request(request), *request);
        self.settings.put(FrameRecord {
            frame: request.frame,
            time: request.time.seconds(),
            samples,
            max_error,
            estimated_error: error,
            samples_per_pixel: report.rays.camera as f64 / (f64::from(film.width) * f64::from(film.height)),
            seconds: took.as_secs_f64(),
            deadline_seconds: self.deadline,
            rounds,
        });
    }

    /// Returns the recorded samples of a frame, if they were selected for the same deadline.
    fn of_deadline(&self, request: &FrameRequest) -> Option<FrameSamples> {
        Some(self.settings.of_deadline(request, self.deadline?)?.0)
    }

    /// Returns the estimated errors of the frames whose samples were selected for a deadline, in ascending order.
    fn errors_under(&self, deadline: f64) -> Vec<(f64, String)> {
        let error_of = |(picture, request): (&PictureKey, &FrameRequest)| {
            let record =
                self.settings.get(picture).filter(|record| record.deadline_seconds == Some(deadline))?;
            Some((record.estimated_error?, request.moment()))
        };
        let mut errors: Vec<(f64, String)> = self.noted.iter().filter_map(error_of).collect();
        errors.sort_by(|(one, _), (other, _)| one.total_cmp(other));
        errors
    }

    /// Records the samples of a kept frame. An existing entry stays unchanged.
    fn note_kept(&mut self, samples: Option<FrameSamples>, request: &FrameRequest) {
        let Some(FrameSamples { samples, max_error, rounds }) = samples else { return };
        self.noted.insert(PictureKey::of_request(request), *request);
        if self.settings.samples_of(request).is_none() {
            self.settings.put(FrameRecord {
                frame: request.frame,
                time: request.time.seconds(),
                samples,
                max_error,
                estimated_error: None,
                samples_per_pixel: 0.0,
                seconds: 0.0,
                deadline_seconds: self.deadline,
                rounds,
            });
        }
    }

    /// Writes the settings file, merged with the entries that other processes have written for other frames.
    fn write(&mut self) -> anyhow::Result<()> {
        let start = Instant::now();
        // The lock makes concurrent processes update the file one after the other. On file systems without folder locks,
        // updates are not synchronized.
        let folder = File::open(folder_of(&self.file));
        let _lock = folder.and_then(|folder| folder.lock().map(|()| folder)).ok();
        if self.file.exists() {
            self.settings.put_others(SettingsFile::read(&self.file)?, &self.noted);
        }
        self.settings.write(&self.file, &self.scene)?;
        // Limits writing to at most a thirtieth of the time.
        self.due = Instant::now() + 30 * start.elapsed();
        Ok(())
    }

    /// Writes the settings file from time to time, because long runs may end unexpectedly.
    fn write_if_due(&mut self) -> anyhow::Result<()> {
        if self.is_of_files && Instant::now() >= self.due { self.write() } else { Ok(()) }
    }

    /// Returns a message that names the worst of the frames that miss, or may miss, the error target.
    fn missed_target(&self) -> Option<String> {
        let worst = |frames: &[(String, f64)]| {
            let (moment, error) = frames.iter().max_by(|(_, one), (_, other)| one.total_cmp(other))?;
            let others = match frames.len() {
                1 => String::new(),
                2 => ", and 1 other frame too".to_owned(),
                count => format!(", and {} other frames too", count - 1),
            };
            Some((moment.clone(), *error, others))
        };
        let limited = worst(&self.worse).map(|(moment, error, others)| {
            // With more digits than targets usually have.
            let error = number(error);
            format!("{moment} is off by about {error} with the largest number of samples per pixel{others}")
        });
        let hidden = worst(&self.hidden).map(|(moment, error, others)| {
            format!(
                "{moment} may be off by up to {} more, by small bright objects in mirrors or glass that no sample hit{others}; \
                 --min-samples 16 hits those larger than a quarter of a pixel",
                number(error)
            )
        });
        match (limited, hidden) {
            (Some(limited), Some(hidden)) => Some(format!("{limited}; {hidden}")),
            (limited, hidden) => limited.or(hidden),
        }
    }
}

/// Returns a message if the largest of some errors, in ascending order and in 8-bit levels, is much larger than their median.
fn unequal_errors(errors: &[(f64, String)]) -> Option<String> {
    /// Ratio to the median, which the simulations of `accuracy::Deadline` allow on a machine with a little other work.
    const UNEQUAL: f64 = 2.0;
    /// Errors of less than half a level are invisible.
    const VISIBLE: f64 = 0.5;
    let (median, _) = errors.get(errors.len().saturating_sub(1) / 2)?;
    let (worst, moment) = errors.last()?;
    (*worst > VISIBLE.max(UNEQUAL * median)).then(|| {
        format!(
            "{moment} has an estimated error of {}, half of the frames {} or less: other work may have slowed it down. If its file is \
             removed, the same command renders it again in the time that it took",
            number(*worst),
            number(*median)
        )
    })
}

/// Returns an error if an override sets a value that an option selects.
fn ensure_unset(arguments: &RenderArguments) -> anyhow::Result<()> {
    let option = match arguments {
        RenderArguments { max_error: Some(_), .. } => "--max-error",
        RenderArguments { deadline: Some(_), .. } => "--deadline",
        RenderArguments { settings: Some(_), .. } => "--settings",
        _ => return Ok(()),
    };
    let chosen = ["sampling.max_error", "sampling.samples"];
    // With an error target, the samples are the maximum per pixel.
    let count = if arguments.max_error.is_some() { 1 } else { 2 };
    match chosen.into_iter().take(count).find_map(|path| arguments.overrides.last(path)) {
        Some(set) => Err(anyhow!("{option} decides over `{set}`: omit one of them")),
        None => Ok(()),
    }
}

/// Reads a settings file, which must cover every picture of this run.
fn read(file: &Path, settings: &OutputSettings) -> anyhow::Result<SettingsFile> {
    let known = SettingsFile::read(file)?;
    match settings.requests().find(|request| known.samples_of(request).is_none()) {
        Some(request) => Err(anyhow!("`{}` has no settings for {}", file.display(), request.moment())),
        None => Ok(known),
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn only_visible_and_far_larger_errors_are_unequal() {
        let of = |errors: [f64; 4]| {
            let named = errors.iter().zip(1..).map(|(error, frame)| (*error, format!("frame {frame}")));
            unequal_errors(&named.collect::<Vec<_>>()).is_some()
        };
        assert!(of([1.0, 1.0, 1.5, 2.1]) && of([0.1, 0.1, 0.1, 0.6]));
        assert!(!of([1.0, 1.0, 1.5, 2.0]) && !of([0.01, 0.01, 0.01, 0.5]));
        assert_eq!((unequal_errors(&[]), unequal_errors(&[(9.0, "frame 1".to_owned())])), (None, None));
    }
}
