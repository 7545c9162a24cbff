//! The pictures, times, plan and sources of a scene.

use std::error::Error;
use std::fs;
use std::path::{Path, PathBuf};
use std::sync::atomic::AtomicBool;

use rayreel::components::Sampling;
use rayreel::output::{FrameFormat, MovieWriter, check_movie, write};
use rayreel::time::{FrameList, FrameRate};
use rayreel::{Effect, Engine, Need, RenderRequest, Scene};

use super::Options;

/// A scene of the gallery.
pub(crate) struct Exhibit {
    /// Base name of the scene's files in the gallery.
    pub(crate) id: String,
    pub(crate) title: String,
    /// The comment at the beginning of the scene file.
    pub(crate) about: String,
    /// Width and height of the pictures.
    pub(crate) size: (u32, u32),
    /// Number of samples per pixel, as `16 samples`.
    pub(crate) samples: String,
    pub(crate) still: Still,
    /// The loop; `None` if the scene has a single frame.
    pub(crate) movie: Option<Movie>,
    /// Seconds for each rendered frame, ascending.
    pub(crate) seconds: Vec<f64>,
    pub(crate) plan: Vec<(Effect, Vec<Span>)>,
    /// Paths and texts of the scene file and the files that it uses.
    pub(crate) sources: Vec<(PathBuf, String)>,
}

/// The picture of one frame.
pub(crate) struct Still {
    pub(crate) file: String,
    pub(crate) frame: u32,
}

/// The moving picture of a scene.
pub(crate) struct Movie {
    pub(crate) file: String,
    /// The frames, of `of` frames in all.
    pub(crate) frames: FrameList,
    pub(crate) of: u32,
    /// Length in seconds.
    pub(crate) seconds: f64,
}

/// The rendered frames with the same need for an effect.
pub(crate) struct Span {
    pub(crate) need: Need,
    pub(crate) frames: Vec<u32>,
}

impl Exhibit {
    /// Renders a scene into the folder of the gallery.
    pub(crate) fn make(file: &Path, options: &Options) -> Result<Self, Box<dyn Error>> {
        let scene = Scene::load(file)?;
        let sources = scene.files.iter().map(|path| Ok((path.clone(), fs::read_to_string(path)?)));
        let sources = sources.collect::<Result<Vec<_>, std::io::Error>>()?;
        let mut engine = Engine::from_scene(scene);
        let film = engine.effective_settings().film;
        engine.settings.samples = options.samples;
        engine.settings.size = Some(fitting((film.width, film.height), options.size));
        let settings = engine.effective_settings();
        let mut exhibit = Self {
            id: id(file),
            title: title(file),
            about: sources.first().map(|(_, text)| comment(text)).unwrap_or_default(),
            size: (settings.film.width, settings.film.height),
            samples: match settings.sampling {
                Sampling { samples: 1, .. } => "1 sample".to_owned(),
                sampling if sampling.is_adaptive() => format!("up to {} samples", sampling.samples),
                Sampling { samples, .. } => format!("{samples} samples"),
            },
            still: Still { file: format!("{}.png", id(file)), frame: engine.timeline.frame_count() / 2 },
            movie: None,
            seconds: Vec::new(),
            plan: Effect::ALL.map(|effect| (effect, Vec::new())).into(),
            sources,
        };
        let film = engine.render_frame(exhibit.still.frame)?;
        write(
            &options.folder.join(&exhibit.still.file),
            &film,
            settings.film.transfer,
            FrameFormat::default(),
        )?;
        if engine.timeline.frame_count() > 1 {
            exhibit.movie = Some(exhibit.write_movie(&mut engine, options)?);
        } else {
            exhibit.record(&engine, exhibit.still.frame);
        }
        exhibit.seconds.sort_by(f64::total_cmp);
        Ok(exhibit)
    }

    /// Renders as many frames as there is time for, evenly distributed over the timeline, after the frame in the engine's report.
    fn write_movie(&mut self, engine: &mut Engine, options: &Options) -> Result<Movie, Box<dyn Error>> {
        let (timeline, a_frame) = (engine.timeline, seconds(engine));
        let count = timeline.frame_count();
        let takes = |step: u32| f64::from(count.div_ceil(step)) * a_frame;
        let step = (1..count / 2).find(|step| takes(*step) <= options.seconds).unwrap_or((count / 2).max(1));
        let frames = FrameList::of((0..count).step_by(step as usize)).ok_or("the timeline is empty")?;
        // For 72 frames of 640x360 pixels of three scenes, H.264 takes 0.1 to 0.4 MB, GIF with 256 colours 2.6 to 3.2 MB, and APNG 4.9 to
        // 7.4 MB. VP9 is as small as H.264 and takes longer. APNG needs no other program.
        let movie = ["mp4", "apng"].map(|end| format!("{}.{end}", self.id));
        let file = movie.into_iter().find(|file| check_movie(&options.folder.join(file)).is_ok());
        let file = file.ok_or("there is no format for the loop")?;
        let (numerator, denominator) = timeline.rate.parts();
        let rate = FrameRate::new(numerator, denominator.saturating_mul(step)).unwrap_or(timeline.rate);
        write_loop(engine, &frames, rate, &options.folder.join(&file), |engine, frame| {
            self.record(engine, frame);
        })?;
        Ok(Movie { file, frames, of: count, seconds: f64::from(count) / timeline.rate.per_second() })
    }

    /// Records the time and the plan of a frame that has just been rendered.
    fn record(&mut self, engine: &Engine, frame: u32) {
        self.seconds.push(seconds(engine));
        let Some(plan) = &engine.report().plan else { return };
        for (effect, spans) in &mut self.plan {
            let need = plan.need(*effect);
            match spans.iter_mut().find(|span| span.need == need) {
                Some(span) => span.frames.push(frame),
                None => spans.push(Span { need, frames: vec![frame] }),
            }
        }
    }
}

/// Renders frames as a moving picture. Calls `rendered` after each frame.
pub(crate) fn write_loop(
    engine: &mut Engine,
    frames: &FrameList,
    rate: FrameRate,
    movie: &Path,
    mut rendered: impl FnMut(&Engine, u32),
) -> Result<(), Box<dyn Error>> {
    let never = AtomicBool::new(false);
    let mut writer = MovieWriter::create(movie, u32::try_from(frames.count())?, rate)?;
    for frame in frames.frames() {
        let (time, transfer) = (engine.timeline.time_of(frame), engine.effective_settings().film.transfer);
        let request = RenderRequest { fingerprint: false, ..RenderRequest::encoded(time, transfer) };
        writer.add(engine.render(request)?.film, &never)?;
        rendered(engine, frame);
    }
    writer.finish(&never)?;
    Ok(())
}

/// Returns the largest size with the proportions of a film that fits into a box.
pub(crate) fn fitting((width, height): (u32, u32), (most_wide, most_high): (u32, u32)) -> (u32, u32) {
    let scaled = |side: u32, by: u32, of: u32| {
        let product = u64::from(side) * u64::from(by);
        u32::try_from((product + u64::from(of / 2)) / u64::from(of)).unwrap_or(u32::MAX).max(1)
    };
    if u64::from(width) * u64::from(most_high) > u64::from(height) * u64::from(most_wide) {
        (most_wide, scaled(height, most_wide, width))
    } else {
        (scaled(width, most_high, height), most_high)
    }
}

/// Returns the time of the last frame.
fn seconds(engine: &Engine) -> f64 {
    let report = engine.report();
    (report.animate + report.prepare + report.trace).as_secs_f64()
}

/// Returns the path of a scene below its folder `scenes` without its ending, as `lesson/1_ambient`, or else its name.
fn name(file: &Path) -> String {
    let below = file.strip_prefix("scenes").ok().or(file.file_name().map(Path::new)).unwrap_or(file);
    below.with_extension("").display().to_string()
}

fn id(file: &Path) -> String {
    name(file).replace(['/', '\\'], "_")
}

fn title(file: &Path) -> String {
    let words = name(file).replace('_', " ").replace('/', ": ");
    let mut letters = words.chars();
    letters.next().map(|first| first.to_uppercase().chain(letters).collect()).unwrap_or_default()
}

/// Returns the text of the comment at the beginning of a scene.
fn comment(source: &str) -> String {
    let lines = source.lines().map_while(|line| line.strip_prefix("//")).map(str::trim);
    lines.collect::<Vec<_>>().join(" ")
}
