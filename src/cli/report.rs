//! The report of a run, as text and as JSON.

use std::path::PathBuf;
use std::time::Duration;

use serde_json::{Value, json};

use rayreel::scene::Sources;
use rayreel::sequence::FrameRequest;
use rayreel::trace::{Escalations, EstimatedError, RayCounts, TreeEnds};
use rayreel::{Effect, Engine, FrameReport, Plan};

use super::args::RenderArguments;
use super::choice::Chosen;
use super::overrides::Changed;
use super::settings::OutputSettings;
use super::values::effect_name;
use super::warnings::Warnings;

/// The report of all frames of one run.
#[derive(Debug)]
pub(super) struct RenderReport {
    scene: PathBuf,
    pub(super) changed: Changed,
    size: (u32, u32),
    threads: usize,
    load: Duration,
    /// The frames that were written or added to the sheet, in order.
    pub(super) frames: Vec<RenderedFrameReport>,
    /// The pictures whose files were kept: frame numbers, or `None` for a moment that is not a frame.
    pub(super) kept: Vec<Option<u32>>,
    /// The sheet, once it is written.
    pub(super) sheet: Option<SheetReport>,
    /// Summary of the recorded samples, if there are any.
    pub(super) chosen: Option<Chosen>,
    pub(super) warnings: Warnings,
    total: Duration,
    interrupted: bool,
    /// True if the reader of standard output has closed the pipe.
    pub(super) unread: bool,
}

/// The report of the sheet that holds all frames.
#[derive(Clone, Debug)]
pub(super) struct SheetReport {
    pub(super) path: PathBuf,
    /// The columns and rows of tiles.
    pub(super) tiles: (u32, u32),
    /// The size in pixels.
    pub(super) size: (u32, u32),
    /// The effects without which the picture was rendered again.
    pub(super) variants: Vec<Effect>,
    /// The effects without which the picture is the same.
    pub(super) unchanged: Vec<UnchangedVariant>,
    /// Time for encoding and writing.
    pub(super) write: Duration,
}

/// The report of one frame.
#[derive(Clone, Debug)]
pub(super) struct RenderedFrameReport {
    frame: Option<u32>,
    /// Path of the frame's own file; `None` on a sheet or a stream.
    path: Option<PathBuf>,
    cost: FrameReport,
    write: Duration,
}

impl RenderReport {
    pub(super) fn new(arguments: &RenderArguments, engine: &Engine, load: Duration, threads: usize) -> Self {
        let film = engine.effective_settings().film;
        Self {
            scene: arguments.scene.clone(),
            changed: Changed::new(&arguments.overrides),
            size: (film.width, film.height),
            threads,
            load,
            frames: Vec::new(),
            kept: Vec::new(),
            sheet: None,
            chosen: None,
            warnings: Warnings::except(&arguments.allowed),
            total: Duration::ZERO,
            interrupted: false,
            unread: false,
        }
    }

    pub(super) fn finish(&mut self, total: Duration, interrupted: bool) {
        self.total = total;
        self.interrupted = interrupted;
    }

    /// Returns the report as one JSON object. The lines of warnings are looked up in `sources`.
    pub(super) fn to_json(&self, sources: Option<&Sources>) -> Value {
        let mut report = json!({
            "scene": self.scene.display().to_string(),
            "width": self.size.0,
            "height": self.size.1,
            "threads": self.threads,
            "load_seconds": self.load.as_secs_f64(),
            "total_seconds": self.total.as_secs_f64(),
            "peak_memory_bytes": peak_memory(),
            "interrupted": self.interrupted,
            "settings": self.chosen.as_ref().map(|chosen| chosen.file.display().to_string()),
            "missed": self.chosen.as_ref().and_then(|chosen| chosen.missed.clone()),
            "unequal": self.chosen.as_ref().and_then(|chosen| chosen.unequal.clone()),
            "sheet": self.sheet.as_ref().map(SheetReport::to_json),
            "warnings": self.warnings.to_json(sources),
            "kept": self.kept,
            "frames": self.frames.iter().map(RenderedFrameReport::to_json).collect::<Vec<_>>(),
        });
        self.changed.add_to(&mut report);
        report
    }

    /// Returns the number of finished frames, including kept ones.
    pub(super) fn done(&self) -> usize {
        self.frames.len() + self.kept.len()
    }

    /// Lists the effects that any frame needed, and counts the others.
    pub(super) fn plan(&self) -> String {
        let needed =
            |effect: &Effect| self.frames.iter().any(|frame| frame.needed().any(|needed| needed == *effect));
        let (needed, omitted): (Vec<_>, Vec<_>) = Effect::ALL.into_iter().partition(needed);
        let names: Vec<_> = needed.iter().map(|effect| effect.name()).collect();
        let names = if names.is_empty() { "nothing".to_owned() } else { names.join(", ") };
        let others = match omitted.len() {
            1 => "1 other effect".to_owned(),
            count => format!("{count} other effects"),
        };
        format!("needed: {names}; {others} omitted (`rayreel explain` says why)")
    }

    /// Lists the frames that took much longer than the median, slowest first. Returns `None` if there are none.
    pub(super) fn slow_frames(&self) -> Option<String> {
        /// Maximum number of frames listed.
        const MOST: usize = 3;
        let mut frames: Vec<&RenderedFrameReport> = self.frames.iter().collect();
        frames.sort_by(|one, other| other.seconds().total_cmp(&one.seconds()));
        let median = frames.get(frames.len() / 2)?.seconds();
        let slow = frames.iter().take(MOST).filter(|frame| is_slow(frame.seconds(), median));
        let slow: Vec<String> =
            slow.map(|frame| format!("{} ({:.1} s)", frame.name(), frame.seconds())).collect();
        (!slow.is_empty())
            .then(|| format!("slowest, where half take {median:.1} s or less: {}", slow.join(", ")))
    }

    /// Summarises the rendering in one line.
    pub(super) fn summary(&self, settings: &OutputSettings) -> String {
        let frames = match self.frames.len() {
            1 => "1 frame".to_owned(),
            count if !settings.variants.is_empty() => format!("{count} variants of a frame"),
            count => format!("{count} frames"),
        };
        let rays: u64 = self.frames.iter().map(|frame| frame.cost.rays.total()).sum();
        let (seconds, rays) = (self.total.as_secs_f64(), in_millions(rays as f64));
        let kept = match self.kept.len() {
            0 => String::new(),
            1 => "; 1 frame was there already".to_owned(),
            count => format!("; {count} frames were there already"),
        };
        let rendered = format!("{frames} in {seconds:.2} s, {rays} rays{kept}");
        let rendered = if self.interrupted { format!("interrupted: {rendered}") } else { rendered };
        match (&self.sheet, settings.sheet) {
            (Some(sheet), _) => format!("{rendered}, in {}", sheet.path.display()),
            (None, Some(_)) => format!("{rendered}; no sheet was written"),
            (None, None) if settings.stream.is_some() => format!("{rendered}, on standard output"),
            (None, None) => {
                let complete = if self.interrupted {
                    "; they are complete, and the same command renders the rest"
                } else {
                    ""
                };
                format!("{rendered}, in {}{complete}", settings.sequence.directory().display())
            }
        }
    }
}

/// An effect without which a picture is the same.
#[derive(Clone, Debug)]
pub(super) struct UnchangedVariant {
    pub(super) effect: Effect,
    /// The reason why the picture does not need it, if the plan knows one.
    pub(super) reason: Option<&'static str>,
}

impl SheetReport {
    /// Lists the effects without which the picture is the same, if there are any.
    pub(super) fn unchanged(&self) -> Option<String> {
        let text = |UnchangedVariant { effect, reason }: &UnchangedVariant| match reason {
            Some(reason) => format!("{effect} ({reason})"),
            None => effect.to_string(),
        };
        let names: Vec<_> = self.unchanged.iter().map(text).collect();
        (!names.is_empty()).then(|| format!("the picture is the same without {}", names.join(", ")))
    }

    fn to_json(&self) -> Value {
        let variants: Vec<_> = self.variants.iter().map(|effect| effect_name(*effect)).collect();
        let unchanged: Vec<_> = self.unchanged.iter().map(|variant| effect_name(variant.effect)).collect();
        json!({
            "file": self.path.display().to_string(),
            "columns": self.tiles.0,
            "rows": self.tiles.1,
            "variants": variants,
            "unchanged": unchanged,
            "width": self.size.0,
            "height": self.size.1,
            "write_seconds": self.write.as_secs_f64(),
        })
    }
}

impl RenderedFrameReport {
    /// Creates the report of a frame. `path` is `None` if the frame has no file of its own.
    pub(super) fn new(request: &FrameRequest, path: Option<PathBuf>, report: &FrameReport) -> Self {
        Self { frame: request.frame, path, cost: report.clone(), write: Duration::ZERO }
    }

    /// Returns the effects that the frame needed.
    fn needed(&self) -> impl Iterator<Item = Effect> {
        self.cost.plan.iter().flat_map(Plan::needed)
    }

    /// Returns the path of the frame's own file or, without one, its number or time.
    pub(super) fn name(&self) -> String {
        match (&self.path, self.frame) {
            (Some(path), _) => path.display().to_string(),
            (None, Some(frame)) => format!("frame {frame}"),
            (None, None) => format!("{} s", self.cost.time.seconds()),
        }
    }

    /// Returns whether this is the report of the requested frame.
    pub(super) fn is_of(&self, request: &FrameRequest) -> bool {
        (self.frame, self.cost.time) == (request.frame, request.time)
    }

    /// Formats the times, ray counts and estimated error of the frame.
    pub(super) fn details(&self) -> String {
        let FrameReport { animate, prepare, trace, rays, error, .. } = &self.cost;
        let phases = [("animate", animate), ("prepare", prepare), ("trace", trace), ("write", &self.write)];
        let phases = phases.map(|(name, time)| format!("{name} {:.3} s", time.as_secs_f64())).join(", ");
        let kinds = [
            (rays.camera, "camera"),
            (rays.shadow, "shadow"),
            (rays.reflection, "reflected"),
            (rays.refraction, "refracted"),
        ];
        let kinds = kinds.into_iter().filter(|(count, _)| *count > 0);
        let kinds = kinds.map(|(count, name)| format!("{} {name}", in_millions(count as f64)));
        let rays = kinds.collect::<Vec<_>>().join(", ");
        let error = error.map_or_else(String::new, |EstimatedError { value, deviation, hidden }| {
            let unseen = if hidden > deviation {
                format!(", and {hidden:.2} by features that no sample hit")
            } else {
                String::new()
            };
            format!("; off by about {value:.2} (± {deviation:.2}){unseen}")
        });
        format!("{phases}; rays: {rays}{error}")
    }

    /// Returns the report with the given write time.
    pub(super) fn written(&self, write: Duration) -> Self {
        Self { write, ..self.clone() }
    }

    /// Returns the seconds to animate, prepare and trace. Writing is not included, as it runs in parallel.
    pub(super) fn seconds(&self) -> f64 {
        (self.cost.animate + self.cost.prepare + self.cost.trace).as_secs_f64()
    }

    /// Formats the rays per second or, if not all pixels were traced, the share of those that were taken from the former frame.
    pub(super) fn rate(&self) -> String {
        let FrameReport { reused, rays, trace, .. } = &self.cost;
        match *reused {
            0.0 => format!("{} rays/s", in_millions(rays.total() as f64 / trace.as_secs_f64().max(1e-9))),
            reused => format!("{:.0} % reused", 100.0 * reused),
        }
    }

    pub(super) fn to_json(&self) -> Value {
        let RayCounts { camera, shadow, reflection, refraction } = self.cost.rays;
        let TreeEnds { depth, strong, cutoff } = self.cost.ends;
        let Escalations { ambiguous, contested, rough, overflowed } = self.cost.escalations;
        json!({
            "frame": self.frame,
            "time": self.cost.time.seconds(),
            "file": self.path.as_ref().map(|path| path.display().to_string()),
            "seconds": {
                "animate": self.cost.animate.as_secs_f64(),
                "prepare": self.cost.prepare.as_secs_f64(),
                "trace": self.cost.trace.as_secs_f64(),
                "write": self.write.as_secs_f64(),
            },
            "rays": {
                "camera": camera,
                "shadow": shadow,
                "reflection": reflection,
                "refraction": refraction,
            },
            "reused": self.cost.reused,
            "estimated_error": self.cost.error.map(|error| error.value),
            "estimated_error_deviation": self.cost.error.map(|error| error.deviation),
            "hidden_error": self.cost.error.map(|error| error.hidden),
            "needed": self.needed().map(Effect::name).collect::<Vec<_>>(),
            "not_followed": { "depth": depth, "strong": strong, "cutoff": cutoff },
            "guards": { "open": ambiguous, "contested": contested, "rough": rough, "overflowed": overflowed },
        })
    }
}

/// Returns whether a frame is notably slow: more than twice the median, and more than a second above it.
fn is_slow(seconds: f64, median: f64) -> bool {
    seconds > 2.0 * median && seconds > median + 1.0
}

/// Formats a count in millions, as `12.3 M`, or in thousands if it is below a million.
pub(super) fn in_millions(count: f64) -> String {
    if count < 1e6 { format!("{:.0} k", count / 1e3) } else { format!("{:.1} M", count / 1e6) }
}

/// Returns the peak memory of this process in bytes, or `None` if the system does not report it.
fn peak_memory() -> Option<u64> {
    let status = std::fs::read_to_string("/proc/self/status").ok()?;
    let line = status.lines().find_map(|line| line.strip_prefix("VmHWM:"))?;
    let kibibytes: u64 = line.trim().strip_suffix("kB")?.trim().parse().ok()?;
    Some(kibibytes * 1024)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn slow_frames_take_twice_the_median_and_a_second_more() {
        assert!(is_slow(3.1, 1.5) && is_slow(1.1, 0.01));
        // Less than a second above the median, or at most twice the median.
        assert!(!is_slow(0.9, 0.01) && !is_slow(10.0, 6.0) && !is_slow(1.0, 1.0));
    }
}
