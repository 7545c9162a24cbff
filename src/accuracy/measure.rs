//! Measures the errors and costs of many settings for a scene.

use std::sync::atomic::AtomicBool;
use std::time::{Duration, Instant};

use super::median_range::MedianRange;
use super::parameter::{Parameter, Subject, SweepRange, sweep, turned};
use super::report::{ReferenceInfo, Report, Row};
use super::resample::resampled;
use super::{FilmError, MeasuredFrame, OutputValues, ReferenceImage, Resolution, structural_similarity};
use crate::color::Transfer;
use crate::components::{FilmSettings, Sampling};
use crate::engine::{Engine, EngineError, unless_cancelled};
use crate::systems::{EffectiveSettings, Plan, RenderRequest, RenderSettings};
use crate::time::Time;
use crate::trace::{EstimatedError, Film, RayCounts};

/// The amount of work of a measurement.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Preset {
    /// The number of times that each variant is rendered to measure its cost.
    pub rounds: u32,
    /// The largest sample count per pixel of the sweep, unless the scene has more.
    pub samples: u32,
    /// The number of pictures of the reference, at least two.
    pub pictures: u32,
    /// The sample count per pixel of each reference picture, as a multiple of the sweep's largest count.
    pub factor: u32,
}

impl Preset {
    /// A measurement of minutes.
    pub const THOROUGH: Self = Self { rounds: 5, samples: 64, pictures: 4, factor: 4 };
    /// A measurement of seconds. With this number of rounds, the ranges of two equal settings are disjoint by chance in 3 % of all cases;
    /// with one round less, in 10 %.
    pub const QUICK: Self = Self { rounds: 4, samples: 8, pictures: 4, factor: 2 };
}

/// The specification of a measurement.
#[derive(Clone, Debug)]
pub struct Request {
    /// The frames to render, at least one.
    pub frames: Vec<u32>,
    /// The amount of work.
    pub preset: Preset,
    /// The parameters to vary, as far as they affect the frames.
    pub parameters: Vec<Parameter>,
    /// Other sizes of the film to compare, in columns and rows.
    pub sizes: Vec<(u32, u32)>,
    /// True if the rows keep the film of the first frame.
    pub keep_films: bool,
}

/// An observer of the progress, which may also count instructions.
pub trait Observer {
    /// Receives the current subject, or `None` for the reference, and the fraction of the work that is done, 0 to 1.
    fn at(&mut self, subject: Option<Subject>, share: f64);

    /// Returns the number of instructions executed so far in all threads, if it is known.
    fn instructions(&mut self) -> Option<u64> {
        None
    }
}

/// Measures the cost of accuracy in a scene. The variants override the engine's settings, which are kept. A measurement that is cancelled
/// after at least two rounds returns what these have measured, any other `None`.
///
/// # Errors
///
/// As [`Engine::render_frame`].
pub fn measure(
    engine: &mut Engine,
    request: &Request,
    cancelled: &AtomicBool,
    observer: &mut dyn Observer,
) -> Result<Option<Report>, EngineError> {
    let timeline = engine.timeline;
    let times = request.frames.iter().map(|frame| timeline.time_of(*frame)).collect();
    let (keep_films, work) = (request.keep_films, WorkEstimate::default());
    let mut measurer = Measurer { engine, times, cancelled, observer, keep_films, work };
    unless_cancelled(measurer.run(request))
}

/// The estimated work, in samples per pixel.
#[derive(Debug, Default)]
struct WorkEstimate {
    done: f64,
    all: f64,
    /// The approximate sample count per pixel of the scene's own settings.
    own: u32,
}

/// Renders the chosen frames with variants of the settings, and compares them.
struct Measurer<'a> {
    engine: &'a mut Engine,
    times: Vec<Time>,
    cancelled: &'a AtomicBool,
    observer: &'a mut dyn Observer,
    keep_films: bool,
    work: WorkEstimate,
}

/// All frames, rendered with one variant.
struct MeasuredVariant {
    films: Vec<Film>,
    /// Mean seconds per frame.
    seconds: f64,
    /// Ray counts of all frames together.
    rays: RayCounts,
    /// Mean number of instructions per frame.
    instructions: Option<f64>,
    /// The largest estimated error of all frames, if they have an error target.
    estimated: Option<EstimatedError>,
}

/// A cutoff in 8-bit levels, small enough to vanish in rounding.
const NO_CUTOFF: f32 = 1.0 / 64.0;
/// A depth beyond which rays contribute nothing visible.
const DEEP: u32 = 64;

/// The references for all variants, frame by frame.
struct ReferenceSet {
    /// The summary of the reference in the report.
    info: ReferenceInfo,
    films: Vec<Film>,
    /// References with the scene's own depth and cutoff. These two settings alone may prevent convergence to `films`.
    own: Vec<Film>,
}

impl Measurer<'_> {
    fn run(&mut self, request: &Request) -> Result<Report, EngineError> {
        let Preset { rounds, samples, pictures, factor } = request.preset;
        let pictures = pictures.max(2);
        let plan = self.plan()?;
        let own = self.engine.effective_settings();
        let most = if own.sampling.is_adaptive() { samples } else { samples.max(own.sampling.samples) };
        let range = SweepRange {
            samples: most,
            most: most.saturating_mul(factor).min(Sampling::LARGEST_COUNT),
            light_samples: samples.min(16),
            depth: own.quality.depth + 4,
        };
        let rows = sweep(&plan, own, range, &request.parameters, &request.sizes);
        self.estimate(&rows, own, rounds, range.most.saturating_mul(pictures));
        let reference = self.reference(own, range.most, pictures)?;
        let mut rows = self.rows(rows, &reference, own, range)?;
        let rounds = self.time(&mut rows, rounds)?;
        let mut report = Report {
            frames: request.frames.clone(),
            size: reference.films.first().map_or((0, 0), |film| (film.width(), film.height())),
            reference: reference.info,
            rows,
            resolution: Resolution::default(),
            orders: Vec::new(),
            rounds,
            own_samples: if own.sampling.is_adaptive() { 0 } else { own.sampling.samples },
        };
        report.conclude();
        Ok(report)
    }

    /// Renders the references.
    fn reference(
        &mut self,
        own: EffectiveSettings,
        samples: u32,
        pictures: u32,
    ) -> Result<ReferenceSet, EngineError> {
        let shallow = RenderSettings::default();
        let deep =
            RenderSettings { depth: Some(own.quality.depth.max(DEEP)), cutoff: Some(NO_CUTOFF), ..shallow };
        let own_depth = self.render(&RenderSettings::default(), None)?;
        let deeper = self.render(&deep, None)?;
        let is_deep = self.error(&own_depth.films, &deeper.films).max < f64::from(NO_CUTOFF);
        let seed = own.sampling.seed;
        let start = Instant::now();
        let reference = self.converged(if is_deep { shallow } else { deep }, pictures, seed, samples)?;
        let info = ReferenceInfo::of(&reference, samples.saturating_mul(pictures), pictures, start.elapsed());
        let films = films_of(reference);
        let own = if is_deep {
            films.clone()
        } else {
            self.work.all += f64::from(info.samples);
            films_of(self.converged(shallow, pictures, seed, samples)?)
        };
        Ok(ReferenceSet { info, films, own })
    }

    /// Renders every variant and compares it with the references.
    fn rows(
        &mut self,
        rows: Vec<(Subject, RenderSettings)>,
        reference: &ReferenceSet,
        own: EffectiveSettings,
        range: SweepRange,
    ) -> Result<Vec<Row>, EngineError> {
        let mut compared: Vec<Row> = Vec::with_capacity(rows.len());
        let mut best: Option<(RenderSettings, Vec<Film>)> = None;
        for (subject, settings) in rows {
            let rendered = self.render(&settings, Some(subject))?;
            let alone = match best_alone(subject, own, range) {
                None => self.error(&rendered.films, &reference.own),
                Some(variant) => {
                    let films = match best.take().filter(|(known, _)| *known == variant) {
                        Some((_, films)) => films,
                        None => self.render(&variant, Some(subject))?.films,
                    };
                    let error = self.error(&rendered.films, &films);
                    best = Some((variant, films));
                    error
                }
            };
            let row = Row {
                subject,
                settings,
                error: self.error(&rendered.films, &reference.films),
                similarity: self.similarity(&rendered.films, &reference.films),
                alone,
                seconds: MedianRange::default(),
                relative: MedianRange::default(),
                rays: self.mean_rays(rendered.rays),
                instructions: rendered.instructions,
                estimated: rendered.estimated,
                capped: capped(subject, &settings, rendered.estimated),
                same_as: None,
                on_front: false,
                film: rendered.films.into_iter().next().filter(|_| self.keep_films),
            };
            let same_as = compared.iter().position(|other| row.is_same_as(other));
            compared.push(Row { same_as, ..row });
        }
        Ok(compared)
    }

    /// Returns the effects that are needed by any of the frames.
    fn plan(&mut self) -> Result<Plan, EngineError> {
        let mut plan: Option<Plan> = None;
        for time in self.times.clone() {
            let request = RenderRequest { fingerprint: false, ..RenderRequest::at(time) };
            let Some(of_frame) = &self.engine.plan(request)?.plan else { continue };
            match &mut plan {
                Some(plan) => plan.join(of_frame),
                None => plan = Some(of_frame.clone()),
            }
        }
        plan.ok_or(EngineError::Cancelled)
    }

    /// Estimates the work: the reference, the rounds with the scene's own settings in between, and all rows once more.
    fn estimate(
        &mut self,
        rows: &[(Subject, RenderSettings)],
        own: EffectiveSettings,
        rounds: u32,
        reference: u32,
    ) {
        let own = if own.sampling.is_adaptive() { ADAPTIVE } else { own.sampling.samples };
        self.work.own = own;
        let of_rows: f64 = rows.iter().map(|(_, settings)| samples(settings, own)).sum();
        let between = f64::from(own) * (rows.len().div_ceil(BETWEEN) + 1) as f64;
        self.work.all = f64::from(reference) + (of_rows + between) * f64::from(rounds) + of_rows;
    }

    /// Renders all frames with one variant.
    fn render(
        &mut self,
        settings: &RenderSettings,
        subject: Option<Subject>,
    ) -> Result<MeasuredVariant, EngineError> {
        let mut rendered = MeasuredVariant {
            films: Vec::new(),
            seconds: 0.0,
            rays: RayCounts::default(),
            instructions: None,
            estimated: None,
        };
        for time in &self.times {
            let share = (self.work.done / self.work.all.max(1.0)).min(1.0);
            self.observer.at(subject, share);
            let instructions = &mut || self.observer.instructions();
            let frame = MeasuredFrame::render(self.engine, *time, *settings, self.cancelled, instructions)?;
            rendered.films.push(self.sized(frame.film));
            rendered.seconds += frame.seconds;
            rendered.rays += frame.rays;
            if let Some(count) = frame.instructions {
                *rendered.instructions.get_or_insert(0.0) += count as f64;
            }
            let largest = |one: EstimatedError, other: EstimatedError| {
                if one.value < other.value { other } else { one }
            };
            rendered.estimated = rendered.estimated.into_iter().chain(frame.estimated).reduce(largest);
            self.work.done += samples(settings, self.work.own) / self.times.len() as f64;
        }
        rendered.seconds /= self.times.len().max(1) as f64;
        rendered.instructions = rendered.instructions.map(|all| all / self.times.len().max(1) as f64);
        Ok(rendered)
    }

    /// Resamples a picture to the size of the scene's film.
    fn sized(&self, film: Film) -> Film {
        let FilmSettings { width, height, .. } = self.engine.effective_settings().film;
        if (film.width(), film.height()) == (width, height) { film } else { resampled(&film, width, height) }
    }

    /// Renders the reference of every frame: several pictures, each with its own samples.
    fn converged(
        &mut self,
        settings: RenderSettings,
        pictures: u32,
        seed: u64,
        samples: u32,
    ) -> Result<Vec<ReferenceImage>, EngineError> {
        /// The distance between seeds, 2^64 divided by the golden ratio. The resulting seeds are unlikely in scenes.
        const APART: u64 = 0x9e37_79b9_7f4a_7c15;
        let mut frames = vec![Vec::new(); self.times.len()];
        for picture in 1..=u64::from(pictures) {
            let settings = RenderSettings {
                samples: Some(samples),
                max_error: Some(0.0),
                instants: Some(samples),
                seed: Some(seed.wrapping_add(picture.wrapping_mul(APART))),
                ..settings
            };
            let rendered = self.render(&settings, None)?;
            frames.iter_mut().zip(rendered.films).for_each(|(films, film)| films.push(film));
        }
        let transfer = self.transfer();
        Ok(frames.iter().map(|films| ReferenceImage::mean(films, transfer)).collect())
    }

    /// Measures the time of every row, as a multiple of the time of the scene's own settings right before and after. Rows take turns, so
    /// that a temporarily slow machine does not affect only one of them. Rows that trace the same rays as another row get its time. Returns
    /// the number of complete rounds.
    fn time(&mut self, rows: &mut [Row], rounds: u32) -> Result<u32, EngineError> {
        let (distinct, same): (Vec<usize>, Vec<usize>) =
            (0..rows.len()).partition(|row| rows[*row].same_as.is_none());
        let unmeasured = same.iter().map(|row| samples(&rows[*row].settings, self.work.own)).sum::<f64>();
        self.work.all -= unmeasured * f64::from(rounds);
        let (mut measured, mut own_seconds) = (vec![Vec::new(); distinct.len()], Vec::new());
        let mut complete = 0;
        while complete < rounds {
            let (relative, own) = match self.round(rows, &distinct) {
                // The scatter of times is known from the second round on.
                Err(EngineError::Cancelled) if complete >= 2 => break,
                round => round?,
            };
            measured.iter_mut().zip(relative).for_each(|(all, one)| all.push(one));
            own_seconds.extend(own);
            complete += 1;
        }
        let own_seconds = MedianRange::of(&own_seconds).median;
        for (row, measured) in distinct.into_iter().zip(measured) {
            rows[row].relative = MedianRange::of(&measured);
        }
        for row in 0..rows.len() {
            let relative = rows[rows[row].same_as.unwrap_or(row)].relative;
            (rows[row].relative, rows[row].seconds) = (relative, relative.times(own_seconds));
        }
        Ok(complete)
    }

    /// Measures the time of `distinct` rows once. Returns them as multiples of the times of the scene's own settings, and these in seconds.
    fn round(&mut self, rows: &[Row], distinct: &[usize]) -> Result<(Vec<f64>, Vec<f64>), EngineError> {
        const OWN: Option<Subject> = Some(Subject::Own);
        let (mut relative, mut own_seconds) = (Vec::new(), Vec::new());
        let mut before = self.seconds(&RenderSettings::default(), OWN)?;
        for chunk in distinct.chunks(BETWEEN) {
            let mut seconds = Vec::new();
            for row in chunk {
                seconds.push(self.seconds(&rows[*row].settings, Some(rows[*row].subject))?);
            }
            let after = self.seconds(&RenderSettings::default(), OWN)?;
            let around = f64::midpoint(before, after).max(f64::MIN_POSITIVE);
            own_seconds.push(around);
            before = after;
            relative.extend(seconds.into_iter().map(|seconds| seconds / around));
        }
        Ok((relative, own_seconds))
    }

    /// Measures the seconds of a frame. A quick frame is rendered several times, for the minimum: the first one after a frame with other
    /// settings takes longer, and interruptions by the system are as long as such a frame.
    fn seconds(&mut self, settings: &RenderSettings, subject: Option<Subject>) -> Result<f64, EngineError> {
        /// The duration for which quick frames are repeated.
        const LEAST: Duration = Duration::from_millis(20);
        let start = Instant::now();
        let mut seconds = self.render(settings, subject)?.seconds;
        let done = self.work.done;
        while start.elapsed() < LEAST {
            seconds = seconds.min(self.render(settings, subject)?.seconds);
            self.work.done = done;
        }
        Ok(seconds)
    }

    fn transfer(&self) -> Transfer {
        self.engine.effective_settings().film.transfer
    }

    /// Returns the error of all frames together.
    fn error(&self, films: &[Film], references: &[Film]) -> FilmError {
        FilmError::of_sequence(films, references, self.transfer())
    }

    fn similarity(&self, films: &[Film], references: &[Film]) -> f64 {
        let transfer = self.transfer();
        let pairs = films.iter().zip(references);
        let values = |film| OutputValues::of_film(film, transfer);
        let sum: f64 =
            pairs.map(|(film, reference)| structural_similarity(&values(film), &values(reference))).sum();
        sum / films.len().max(1) as f64
    }

    fn mean_rays(&self, rays: RayCounts) -> RayCounts {
        let mean = |count: u64| count / self.times.len().max(1) as u64;
        RayCounts {
            camera: mean(rays.camera),
            shadow: mean(rays.shadow),
            reflection: mean(rays.reflection),
            refraction: mean(rays.refraction),
        }
    }
}

/// Returns the variant in which only this subject has its best value; `None` if its best value is the converged reference.
fn best_alone(subject: Subject, own: EffectiveSettings, range: SweepRange) -> Option<RenderSettings> {
    let turned = |parameter, value: f64| Some(turned(parameter, value));
    match subject {
        Subject::Precision(_) | Subject::Size(..) | Subject::Without(_) => Some(RenderSettings::default()),
        Subject::Parameter(parameter @ Parameter::LightSamples, _) => {
            turned(parameter, f64::from(range.light_samples) * 16.0)
        }
        Subject::Parameter(parameter @ Parameter::Instants, _) => {
            turned(parameter, own.sampling.samples.min(Sampling::LARGEST_INSTANTS).into())
        }
        Subject::Parameter(parameter @ Parameter::Depth, _) => {
            turned(parameter, own.quality.depth.max(DEEP).into())
        }
        Subject::Parameter(parameter @ Parameter::Cutoff, _) => turned(parameter, NO_CUTOFF.into()),
        Subject::Own | Subject::Parameter(..) => None,
    }
}

/// Returns the maximum sample count per pixel, if it prevented a picture from meeting its error target.
fn capped(subject: Subject, settings: &RenderSettings, estimated: Option<EstimatedError>) -> Option<u32> {
    match (subject, estimated) {
        (Subject::Parameter(Parameter::MaxError, target), Some(error)) if error.value > target => {
            settings.samples
        }
        _ => None,
    }
}

/// Returns the films of the frames.
fn films_of(frames: Vec<ReferenceImage>) -> Vec<Film> {
    frames.into_iter().map(|frame| frame.film).collect()
}

/// The number of rows after which the scene's own settings are measured again.
const BETWEEN: usize = 4;
/// The approximate sample count per pixel with an error target.
const ADAPTIVE: u32 = 16;

/// Returns the approximate sample count per pixel.
fn samples(settings: &RenderSettings, own: u32) -> f64 {
    match settings {
        RenderSettings { max_error: Some(error), .. } if *error > 0.0 => f64::from(ADAPTIVE),
        _ => f64::from(settings.samples.unwrap_or(own)),
    }
}
