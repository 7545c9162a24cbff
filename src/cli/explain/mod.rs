//! `rayreel explain`
//!
//! [`timeline`] collects the frames that need each effect, with the reasons; [`cost`] renders with and without each effect, on request;
//! [`table`] formats the results. [`path`] draws the camera's path instead.

mod cost;
mod path;
mod table;
mod timeline;

use anyhow::Context;
use rayon::ThreadPool;
use serde_json::{Value, json};

use rayreel::scene::Printable;
use rayreel::time::FrameList;
use rayreel::{Engine, RenderSettings};

use super::args::ExplainArguments;
use super::exit::Failure;
use super::measure_progress::MeasureProgress;
use super::overrides::{Changed, load};
use super::print;
use super::settings::require_frame;
use cost::Costs;
use timeline::PlannedTimeline;

pub(super) fn run(arguments: &ExplainArguments) -> Result<(), Failure> {
    let mut engine = load(&arguments.scene, &arguments.overrides)?;
    let frames = match &arguments.frames {
        Some(frames) => frames.within(engine.timeline.frame_count()),
        None => FrameList::all(engine.timeline.frame_count()),
    };
    require_frame(frames.last(), engine.timeline)?;
    if let Some(file) = &arguments.path {
        return path::draw(&mut engine, &frames, &arguments.scene, file);
    }
    if let Some(size) = arguments.size {
        engine.settings = RenderSettings { size: Some(size), ..engine.settings };
    }
    let progress = arguments.measure.then(MeasureProgress::start);
    let threads = arguments.threads.map_or(0, usize::from);
    let pool: ThreadPool = rayon::ThreadPoolBuilder::new()
        .num_threads(threads)
        .build()
        .context("cannot start the rendering threads")?;
    let explanation = pool.install(|| Explanation::of(arguments, &mut engine, &frames, progress))?;
    if arguments.json {
        print::json(explanation.json())?;
    } else {
        print::result(&explanation.text())?;
    }
    Ok(())
}

/// The contents of an explanation.
struct Explanation {
    scene: String,
    changed: Changed,
    size: (u32, u32),
    timeline: PlannedTimeline,
    /// With `--measure`.
    costs: Option<Costs>,
}

impl Explanation {
    fn of(
        arguments: &ExplainArguments,
        engine: &mut Engine,
        frames: &FrameList,
        progress: Option<MeasureProgress>,
    ) -> Result<Self, rayreel::EngineError> {
        let timeline = PlannedTimeline::of(engine, frames)?;
        let costs = progress.map(|progress| Costs::measure(engine, &timeline, progress)).transpose()?;
        let film = engine.effective_settings().film;
        Ok(Self {
            scene: arguments.scene.display().to_string(),
            changed: Changed::new(&arguments.overrides),
            size: (film.width, film.height),
            timeline,
            costs,
        })
    }

    fn text(&self) -> String {
        let (width, height) = self.size;
        let count = match (self.timeline.count(), self.timeline.spread_over()) {
            (count, Some(chosen)) => format!("{count} of {chosen} frames, spread evenly,"),
            (1, None) => "1 frame".to_owned(),
            (count, None) => format!("{count} frames"),
        };
        let changed = self.changed.describe().map_or_else(String::new, |changed| changed + "\n");
        format!(
            "{}: {count} of {width}x{height}\n{changed}\n{}\n{}{}",
            Printable(&self.scene),
            self.timeline.describe(),
            self.costs.as_ref().map_or_else(String::new, |costs| costs.describe() + "\n"),
            table::draw(&self.timeline, self.costs.as_ref())
        )
    }

    fn json(&self) -> Value {
        let mut explanation = json!({
            "scene": self.scene,
            "width": self.size.0,
            "height": self.size.1,
            "frames": self.timeline.count(),
            "spread_over": self.timeline.spread_over(),
            "measured": self.costs.as_ref().map(Costs::json),
            "effects": self.timeline.effects().map(|needs| json!({
                "effect": needs.effect.name(),
                "spans": needs.spans.iter().map(|span| json!({
                    "frames": span.frames(),
                    "needed": span.need.is_needed(),
                    "why": span.need.reason(),
                })).collect::<Vec<_>>(),
                "cost": self.costs.as_ref().map(|costs| costs.effect_json(needs.effect)),
            })).collect::<Vec<_>>(),
        });
        self.changed.add_to(&mut explanation);
        explanation
    }
}
