//! With how many samples each frame is rendered: the scene's own, as many as an error or a deadline asks for, or those of an earlier
//! run.
//!
//! What is chosen is written beside the frames, and read back by `--settings`: the same pictures then come without a clock.

use std::collections::BTreeSet;
use std::fs::File;
use std::path::{Path, PathBuf};
use std::sync::atomic::AtomicBool;
use std::time::{Duration, Instant};

use anyhow::{Context, anyhow};

use rayreel::Engine;
use rayreel::accuracy::FrameSamples;
use rayreel::components::Sampling;
use rayreel::output::folder_of;
use rayreel::sequence::Shot;
use rayreel::trace::EstimatedError;

use super::args::RenderArguments;
use super::deadline::Paced;
use super::exit::Failure;
use super::settings::RenderSettings;
use super::settings_file::{FrameSettings, Picture, SettingsFile};

/// The samples of frames.
pub(super) struct Choice {
    by: By,
    /// Where the chosen ones are written, and with them those of other frames in the same folder.
    record: Option<Record>,
    start: Instant,
    /// When the frame in hand was begun.
    begun: Instant,
    /// Its samples, if they are not the scene's own.
    samples: Option<FrameSamples>,
}

/// Who chooses.
enum By {
    /// The scene.
    Scene,
    /// One for all frames.
    Error(FrameSamples),
    Deadline(Paced),
    /// What an earlier run has written.
    Settings(SettingsFile),
}

/// What is written of the chosen samples.
struct Record {
    file: PathBuf,
    settings: SettingsFile,
    scene: PathBuf,
    /// In seconds.
    deadline: Option<f64>,
    /// The next time at which it is to be written.
    due: Instant,
    /// Whether each frame has a file of its own. Of a sheet there is all or nothing.
    is_of_files: bool,
    /// The pictures that were noted.
    noted: BTreeSet<Picture>,
    /// The frames that are not as good as they were to be, as far as their pixels tell, and those that may be worse than that.
    worse: Vec<(String, f64)>,
    hidden: Vec<(String, f64)>,
}

/// What is told of the choice in the end.
#[derive(Debug)]
pub(super) struct Chosen {
    /// The file with the settings.
    pub(super) file: PathBuf,
    /// The frames for which they were chosen.
    pub(super) frames: usize,
    /// What was not reached, in words.
    pub(super) missed: Option<String>,
}

impl Choice {
    /// Finds out what can be had, for a run that began at `start`. `None` if it was cancelled meanwhile.
    ///
    /// # Errors
    ///
    /// If it cannot be had, or if the settings of an earlier run cannot be read or lack a frame.
    pub(super) fn new(
        arguments: &RenderArguments,
        engine: &mut Engine,
        settings: &RenderSettings,
        (start, cancelled): (Instant, &AtomicBool),
    ) -> Result<Option<Self>, Failure> {
        ensure_unset(arguments)?;
        let record = match arguments.max_error.is_some() || arguments.deadline.is_some() {
            true => Some(Record::new(settings, &arguments.scene, arguments.deadline)?),
            false => None,
        };
        let by = if let Some(error) = arguments.max_error {
            let samples = arguments.overrides.samples().unwrap_or(Sampling::LARGEST_COUNT);
            By::Error(FrameSamples::for_error(error, samples))
        } else if let (Some(within), Some(record)) = (arguments.deadline, &record) {
            let known = &record.settings;
            match Paced::new(
                engine,
                (settings, known),
                arguments.movie.as_deref(),
                (start, within),
                cancelled,
            )? {
                Some(paced) => By::Deadline(paced),
                None => return Ok(None),
            }
        } else if let Some(file) = &arguments.settings {
            By::Settings(read(file, settings)?)
        } else {
            By::Scene
        };
        Ok(Some(Self { by, record, start, begun: start, samples: None }))
    }

    /// Sets the engine up for looking whether a frame is done already.
    pub(super) fn begin(&mut self, engine: &mut Engine, shot: &Shot) {
        self.begun = Instant::now();
        self.samples = match &self.by {
            By::Scene => None,
            By::Error(samples) => Some(samples.clone()),
            By::Deadline(_) => self.record.as_ref().and_then(|record| record.of_deadline(shot)),
            By::Settings(settings) => settings.samples_of(shot),
        };
        if let Some(samples) = &self.samples {
            samples.set_up(engine);
        }
    }

    /// Sets the engine up for rendering it.
    pub(super) fn render(&mut self, engine: &mut Engine) {
        if let By::Deadline(paced) = &mut self.by {
            self.samples = Some(paced.begin(engine));
        }
    }

    /// Notes that it was done already.
    pub(super) fn keep(&mut self, shot: &Shot) {
        if let By::Deadline(paced) = &mut self.by {
            paced.keep();
        }
        if let Some(record) = &mut self.record {
            record.note_kept(self.samples.clone(), shot);
        }
    }

    /// Notes what became of it.
    pub(super) fn end(&mut self, engine: &Engine, shot: &Shot) -> anyhow::Result<()> {
        let took = self.begun.elapsed();
        if let By::Deadline(paced) = &mut self.by {
            paced.end();
        }
        let (Some(record), Some(samples)) = (&mut self.record, self.samples.take()) else { return Ok(()) };
        let rounds = matches!(self.by, By::Deadline(_)).then(|| engine.rounds().to_vec());
        record.note(engine, FrameSamples { rounds, ..samples }, shot, took);
        record.write_if_due()
    }

    /// Notes that a frame is written.
    pub(super) fn written(&mut self, took: Duration) {
        if let By::Deadline(paced) = &mut self.by {
            paced.written(took);
        }
    }

    /// Returns by how much the deadline is over, in words, if it is.
    pub(super) fn late(&self) -> Option<String> {
        let By::Deadline(paced) = &self.by else { return None };
        paced.late(self.start.elapsed())
    }

    /// Writes what was chosen beside the frames. Returns what is to be told of it, if anything was.
    pub(super) fn finish(&mut self) -> anyhow::Result<Option<Chosen>> {
        let Some(mut record) = self.record.take().filter(|record| !record.noted.is_empty()) else {
            return Ok(None);
        };
        record.write()?;
        let missed = self.late().or_else(|| record.worse());
        Ok(Some(Chosen { file: record.file, frames: record.noted.len(), missed }))
    }
}

impl Record {
    /// Reads what is there of other frames.
    fn new(settings: &RenderSettings, scene: &Path, deadline: Option<Duration>) -> anyhow::Result<Self> {
        let file = settings.file_of_settings();
        let known = if file.exists() {
            SettingsFile::read(&file).context(
                "what is known of other frames would be lost: remove the file or name another --out",
            )?
        } else {
            SettingsFile::default()
        };
        let deadline = deadline.map(|deadline| deadline.as_secs_f64());
        let (scene, due) = (scene.to_owned(), Instant::now());
        let is_of_files = settings.sheet.is_none();
        let noted = BTreeSet::new();
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
        shot: &Shot,
        took: Duration,
    ) {
        let (film, report) = (engine.film_settings(), engine.report());
        if let Some(EstimatedError { value, hidden, .. }) = report.error.filter(|_| rounds.is_none()) {
            if value > f64::from(max_error) {
                self.worse.push((shot.moment(), value));
            } else if value.hypot(hidden) > f64::from(max_error) {
                self.hidden.push((shot.moment(), hidden));
            }
        }
        let error = report.error.map(|error| error.value);
        self.noted.insert(Picture::of_shot(shot));
        self.settings.put(FrameSettings {
            frame: shot.frame,
            time: shot.time.seconds(),
            samples,
            max_error,
            estimated_error: error,
            samples_per_pixel: report.rays.camera as f64 / (f64::from(film.width) * f64::from(film.height)),
            seconds: took.as_secs_f64(),
            deadline_seconds: self.deadline,
            rounds,
        });
    }

    /// Returns the samples that a frame got for the same deadline.
    fn of_deadline(&self, shot: &Shot) -> Option<FrameSamples> {
        Some(self.settings.of_deadline(shot, self.deadline?)?.0)
    }

    /// Notes the samples of a frame that was done already, unless more is known of it.
    fn note_kept(&mut self, samples: Option<FrameSamples>, shot: &Shot) {
        let Some(FrameSamples { samples, max_error, rounds }) = samples else { return };
        self.noted.insert(Picture::of_shot(shot));
        if self.settings.samples_of(shot).is_none() {
            self.settings.put(FrameSettings {
                frame: shot.frame,
                time: shot.time.seconds(),
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

    /// Writes what is known, with what other processes have written of other frames meanwhile.
    fn write(&mut self) -> anyhow::Result<()> {
        let begun = Instant::now();
        // Others wait with their own until this is there. Where folders have no locks, nobody does.
        let folder = File::open(folder_of(&self.file));
        let _lock = folder.and_then(|folder| folder.lock().map(|()| folder)).ok();
        if self.file.exists() {
            self.settings.put_others(SettingsFile::read(&self.file)?, &self.noted);
        }
        self.settings.write(&self.file, &self.scene)?;
        // It takes a thirtieth of the time at most.
        self.due = Instant::now() + 30 * begun.elapsed();
        Ok(())
    }

    /// Writes what is known from time to time: long sequences may come to an end that nobody has foreseen.
    fn write_if_due(&mut self) -> anyhow::Result<()> {
        if self.is_of_files && Instant::now() >= self.due { self.write() } else { Ok(()) }
    }

    /// Names the worst of the frames that are not as good as they were to be, or may not be.
    fn worse(&self) -> Option<String> {
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
            format!(
                "{moment} is off by about {error:.2} with all the samples that its pixels may get{others}"
            )
        });
        let hidden = worst(&self.hidden).map(|(moment, error, others)| {
            format!(
                "{moment} may be off by up to {error:.2} more, by small bright things in mirrors or glass that no sample has met{others}; \
                 --min-samples 16 meets those larger than a quarter of a pixel"
            )
        });
        match (limited, hidden) {
            (Some(limited), Some(hidden)) => Some(format!("{limited}; {hidden}")),
            (limited, hidden) => limited.or(hidden),
        }
    }
}

/// Returns an error if values are set that are to be chosen.
fn ensure_unset(arguments: &RenderArguments) -> anyhow::Result<()> {
    let option = match arguments {
        RenderArguments { max_error: Some(_), .. } => "--max-error",
        RenderArguments { deadline: Some(_), .. } => "--deadline",
        RenderArguments { settings: Some(_), .. } => "--settings",
        _ => return Ok(()),
    };
    let chosen = ["sampling.max_error", "sampling.samples"];
    // With an error they are the most that a pixel gets.
    let count = if arguments.max_error.is_some() { 1 } else { 2 };
    match chosen.into_iter().take(count).find_map(|path| arguments.overrides.last(path)) {
        Some(set) => Err(anyhow!("{option} decides over `{set}`: leave one of them out")),
        None => Ok(()),
    }
}

/// Reads settings, which must have every picture that is wanted.
fn read(file: &Path, settings: &RenderSettings) -> anyhow::Result<SettingsFile> {
    let known = SettingsFile::read(file)?;
    match settings.shots().find(|shot| known.samples_of(shot).is_none()) {
        Some(shot) => Err(anyhow!("`{}` has no settings for {}", file.display(), shot.moment())),
        None => Ok(known),
    }
}
