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

use rayreel::accuracy::{Deadline, FrameSamples, Ladder, Pilot};
use rayreel::components::{FilmSettings, Sampling};
use rayreel::output::folder_of;
use rayreel::sequence::Shot;
use rayreel::{Engine, FrameReport};

use super::args::RenderArguments;
use super::exit::Failure;
use super::settings::RenderSettings;
use super::settings_file::{FrameSettings, Picture, SettingsFile};

/// The samples of frames.
pub(super) struct Choice {
    by: By,
    /// Where the chosen ones are written, and with them those of other frames in the same folder.
    record: Option<Record>,
    /// The time that it took to find out what can be had.
    pilot: Duration,
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
    Deadline(Box<Deadline>, Duration),
    /// What an earlier run has written.
    Settings(SettingsFile),
}

/// What is written of the chosen samples.
struct Record {
    file: PathBuf,
    settings: SettingsFile,
    scene: PathBuf,
    written: Instant,
    /// Whether each frame has a file of its own. Of a sheet there is all or nothing.
    is_of_files: bool,
    /// The pictures that were noted.
    noted: BTreeSet<Picture>,
    /// The frames that are not as good as they were to be, as far as their pixels tell.
    worse: Vec<(String, f64)>,
}

/// What is told of the choice in the end.
#[derive(Debug)]
pub(super) struct Chosen {
    /// The file with the settings.
    pub(super) file: PathBuf,
    /// The frames for which they were chosen.
    pub(super) frames: usize,
    /// The time of finding out what could be had.
    pub(super) pilot: Duration,
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
        let begun = Instant::now();
        ensure_unset(arguments)?;
        let by = if let Some(error) = arguments.max_error {
            let samples = arguments.overrides.samples().unwrap_or(Sampling::LARGEST_COUNT);
            Some(By::Error(FrameSamples::for_error(error, samples)))
        } else if let Some(within) = arguments.deadline {
            let deadline = deadline(engine, settings, (within, start), cancelled)?;
            deadline.map(|deadline| By::Deadline(Box::new(deadline), within))
        } else if let Some(file) = &arguments.settings {
            Some(By::Settings(read(file, settings)?))
        } else {
            Some(By::Scene)
        };
        let Some(by) = by else { return Ok(None) };
        let record = match &by {
            By::Error(_) | By::Deadline(..) => Some(Record::new(settings, &arguments.scene)?),
            By::Scene | By::Settings(_) => None,
        };
        Ok(Some(Self { by, record, pilot: begun.elapsed(), start, begun, samples: None }))
    }

    /// Sets the engine up for a frame.
    pub(super) fn begin(&mut self, engine: &mut Engine, shot: &Shot) {
        self.begun = Instant::now();
        self.samples = match &mut self.by {
            By::Scene => None,
            By::Error(samples) => Some(*samples),
            By::Deadline(deadline, _) => Some(deadline.next(self.start.elapsed())),
            By::Settings(settings) => settings.samples_of(shot),
        };
        if let Some(samples) = self.samples {
            engine.set_knobs(samples.knobs());
        }
    }

    /// Notes that it was done already.
    pub(super) fn keep(&mut self, shot: &Shot) {
        if let By::Deadline(deadline, _) = &mut self.by {
            deadline.skip();
        }
        if let Some(record) = &mut self.record {
            record.note_kept(self.samples, shot);
        }
    }

    /// Notes what became of it.
    pub(super) fn end(&mut self, engine: &Engine, shot: &Shot) -> anyhow::Result<()> {
        let took = self.begun.elapsed();
        if let By::Deadline(deadline, _) = &mut self.by {
            deadline.note(took);
        }
        let report = *engine.report();
        let Some(record) = &mut self.record else { return Ok(()) };
        let (film, Some(samples)) = (engine.film_settings(), self.samples) else { return Ok(()) };
        record.note((film, &report), samples, shot, took);
        /// Long sequences may come to an end that nobody has foreseen.
        const EVERY: Duration = Duration::from_secs(2);
        let is_due = record.is_of_files && record.written.elapsed() > EVERY;
        if is_due { record.write(self.pilot) } else { Ok(()) }
    }

    /// Writes what was chosen beside the frames. Returns what is to be told of it, if anything was.
    pub(super) fn finish(mut self) -> anyhow::Result<Option<Chosen>> {
        let Some(mut record) = self.record.take().filter(|record| !record.noted.is_empty()) else {
            return Ok(None);
        };
        record.write(self.pilot)?;
        let took = self.start.elapsed();
        let missed = match &self.by {
            By::Deadline(_, within) if took > *within => Some(format!(
                "the frames took {:.1} s longer than the {:.1} s they were given",
                (took - *within).as_secs_f64(),
                within.as_secs_f64()
            )),
            _ => record.worse(),
        };
        Ok(Some(Chosen { file: record.file, frames: record.noted.len(), pilot: self.pilot, missed }))
    }
}

impl Record {
    /// Reads what is there of other frames.
    fn new(settings: &RenderSettings, scene: &Path) -> anyhow::Result<Self> {
        let file = settings.file_of_settings();
        let known = if file.exists() {
            SettingsFile::read(&file).context(
                "what is known of other frames would be lost: remove the file or name another --out",
            )?
        } else {
            SettingsFile::default()
        };
        let (scene, written) = (scene.to_owned(), Instant::now());
        let is_of_files = settings.sheet.is_none();
        let noted = BTreeSet::new();
        Ok(Self { file, settings: known, scene, written, is_of_files, noted, worse: Vec::new() })
    }

    fn note(
        &mut self,
        (film, report): (FilmSettings, &FrameReport),
        FrameSamples { samples, max_error }: FrameSamples,
        shot: &Shot,
        took: Duration,
    ) {
        let error = report.error.map(|error| error.rms);
        if let Some(error) = error.filter(|error| max_error > 0.0 && *error > f64::from(max_error)) {
            self.worse.push((shot.moment(), error));
        }
        self.noted.insert(Picture::of_shot(shot));
        self.settings.put(FrameSettings {
            frame: shot.frame,
            time: shot.time.seconds(),
            samples,
            max_error,
            estimated_error: error,
            samples_per_pixel: report.rays.camera as f64 / (f64::from(film.width) * f64::from(film.height)),
            seconds: took.as_secs_f64(),
        });
    }

    /// Notes the samples of a frame that was done already, unless more is known of it.
    fn note_kept(&mut self, samples: Option<FrameSamples>, shot: &Shot) {
        let Some(FrameSamples { samples, max_error }) = samples else { return };
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
            });
        }
    }

    /// Writes what is known, with what other processes have written of other frames meanwhile.
    fn write(&mut self, pilot: Duration) -> anyhow::Result<()> {
        self.written = Instant::now();
        // Others wait with their own until this is there. Where folders have no locks, nobody does.
        let folder = File::open(folder_of(&self.file));
        let _lock = folder.and_then(|folder| folder.lock().map(|()| folder)).ok();
        if self.file.exists() {
            self.settings.put_others(SettingsFile::read(&self.file)?, &self.noted);
        }
        self.settings.write(&self.file, &self.scene, pilot.as_secs_f64())
    }

    /// Names the worst of the frames that are not as good as they were to be.
    fn worse(&self) -> Option<String> {
        let (moment, error) = self.worse.iter().max_by(|(_, one), (_, other)| one.total_cmp(other))?;
        let others = match self.worse.len() {
            1 => String::new(),
            2 => ", and 1 other frame is worse than asked for".to_owned(),
            count => format!(", and {} other frames are worse than asked for", count - 1),
        };
        Some(format!(
            "{moment} is off by about {error:.2} with all the samples that its pixels may get{others}"
        ))
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

/// Plans a sequence within a time. `None` if it was cancelled.
fn deadline(
    engine: &mut Engine,
    settings: &RenderSettings,
    (within, start): (Duration, Instant),
    cancelled: &AtomicBool,
) -> Result<Option<Deadline>, Failure> {
    /// The part of the time in which it is found out how long frames take.
    const PILOT: u32 = 20;
    let Some(ladder) = Ladder::measure(engine, &pilot(settings), within / PILOT, cancelled)? else {
        return Ok(None);
    };
    let count = settings.count();
    let deadline = Deadline::new(ladder, within, u32::try_from(count).unwrap_or(u32::MAX));
    let least = deadline.least();
    if least > within.saturating_sub(start.elapsed()) {
        let (frames, take) = if count == 1 {
            ("1 frame".to_owned(), "it takes")
        } else {
            (format!("{count} frames"), "they take")
        };
        return Err(anyhow!(
            "{frames} cannot be rendered within {}: with one sample per pixel {take} about {}; give more time, a smaller --size, fewer \
             --frames, or --draft",
            in_words(within),
            in_words(least + start.elapsed())
        )
        .into());
    }
    Ok(Some(deadline))
}

/// Writes a time as `90 s` or `0.4 s`.
fn in_words(time: Duration) -> String {
    let seconds = time.as_secs_f64();
    let decimals = if seconds < 0.1 { 3 } else { usize::from(seconds < 10.0) };
    format!("{seconds:.decimals$} s")
}

/// Returns what is rendered to find out what the pictures take.
fn pilot(settings: &RenderSettings) -> Pilot {
    Pilot::new(settings.count(), |place| settings.time_of(place))
}
