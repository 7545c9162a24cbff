//! Render progress: a bar on a terminal, lines elsewhere, or JSON objects for programs.

use std::cell::Cell;
use std::io::{IsTerminal, stderr};
use std::path::Path;
use std::time::{Duration, Instant};

use indicatif::{FormattedDuration, ProgressBar, ProgressStyle};
use serde_json::json;

use rayreel::sequence::{FrameRequest, FrameVerdict};
use rayreel::trace::RenderProgress;

use super::print;
use super::report::RenderedFrameReport;
use super::settings::{OutputSettings, ProgressOutput};

/// Reports finished frames and the progress of slow frames.
pub(super) struct Progress {
    display: Display,
    times: FrameTimes,
    /// The current frame, if it is slow.
    slow: Option<SlowFrame>,
}

enum Display {
    Bar(ProgressBar),
    Lines(LinePace),
    /// Lines with all details of every frame.
    Details(LinePace),
    /// A JSON object per line for every frame.
    Json,
    Nothing,
}

/// Rate limit of lines.
#[derive(Debug)]
struct LinePace {
    /// Minimum time between lines about finished frames; zero for a line for every frame.
    interval: Duration,
    last: Cell<Option<Instant>>,
}

/// Frame counts and the time that frames take.
#[derive(Debug)]
struct FrameTimes {
    total: usize,
    /// Number of finished frames, including kept ones.
    done: usize,
    /// Number of frames that were rendered, not kept.
    rendered: usize,
    /// Seconds that rendering those frames took.
    seconds: f64,
}

/// A slow frame.
#[derive(Clone, Copy, Debug)]
struct SlowFrame {
    request: FrameRequest,
    start: Instant,
    progress: RenderProgress,
}

impl Progress {
    pub(super) fn start(settings: &OutputSettings) -> Self {
        let total = settings.count();
        let lines = LinePace::of(stderr().is_terminal(), print::is_dumb());
        let display = match (settings.progress, lines) {
            (ProgressOutput::Json, _) => Display::Json,
            (ProgressOutput::Nothing, _) => Display::Nothing,
            (ProgressOutput::Details, _) => Display::Details(LinePace::new(Duration::ZERO)),
            (ProgressOutput::Auto, Some(pace)) => Display::Lines(pace),
            (ProgressOutput::Auto, None) => Display::Bar(bar(total)),
        };
        let progress = Self { display, times: FrameTimes::new(total), slow: None };
        progress.draw("");
        progress
    }

    /// Reports a frame whose file was kept.
    pub(super) fn kept(&mut self, request: &FrameRequest, file: &Path) {
        self.times.done += 1;
        let FrameTimes { total, done, .. } = self.times;
        match &self.display {
            Display::Bar(_) => self.draw(""),
            Display::Details(_) => print::error_line(&format!("{done}/{total} {}: kept", file.display())),
            Display::Json => print::error_json(json!({
                "event": "kept",
                "frame": request.frame,
                "time": request.time.seconds(),
                "file": file.display().to_string(),
                "done": done,
                "total": total,
            })),
            Display::Lines(_) | Display::Nothing => {}
        }
    }

    /// Reports a file that is rendered again, with the reason.
    pub(super) fn rejected(&self, file: &Path, verdict: &FrameVerdict) {
        if let Display::Details(_) = self.display {
            print::error_line(&format!("{} is rendered again: {verdict}", file.display()));
        }
    }

    /// Reports the progress of a slow frame.
    pub(super) fn rendering(&mut self, request: &FrameRequest, progress: RenderProgress) {
        let now = Instant::now();
        let start = self.slow.filter(|slow| slow.request == *request).map_or(now, |slow| slow.start);
        self.slow = Some(SlowFrame { request: *request, start, progress });
        match &self.display {
            Display::Bar(_) => self.draw(""),
            Display::Lines(pace) | Display::Details(pace) if pace.is_due_within(now) => {
                print::error_line(&format!("{}: {}", request.moment(), so_far(&progress)));
            }
            Display::Json => print::error_json(json!({
                "event": "rendering",
                "frame": request.frame,
                "time": request.time.seconds(),
                "share": progress.share,
                "samples_per_pixel": progress.samples,
                "done": self.times.done,
                "total": self.times.total,
            })),
            Display::Lines(_) | Display::Details(_) | Display::Nothing => {}
        }
    }

    /// Reports a finished frame.
    pub(super) fn done(&mut self, report: &RenderedFrameReport) {
        self.times.note(report.seconds());
        self.slow = self.slow.filter(|slow| !report.is_of(&slow.request));
        let rate = report.rate();
        let FrameTimes { total, done, .. } = self.times;
        let line = || format!("{done}/{total} {}: {:.3} s, {rate}", report.name(), report.seconds());
        match &self.display {
            Display::Bar(_) => self.draw(&rate),
            Display::Lines(pace) if pace.is_due(Instant::now(), done == total) => print::error_line(&line()),
            Display::Details(_) => {
                print::error_line(&line());
                print::error_line(&format!("  {}", report.details()));
            }
            Display::Json => {
                let mut event = report.to_json();
                event["event"] = json!("rendered");
                event["done"] = json!(done);
                event["total"] = json!(total);
                print::error_json(event);
            }
            Display::Lines(_) | Display::Nothing => {}
        }
    }

    /// Draws the bar, if there is one. `rate` is the ray rate of the last frame, or empty.
    fn draw(&self, rate: &str) {
        let Display::Bar(bar) = &self.display else { return };
        let FrameTimes { total, done, .. } = self.times;
        let slow =
            self.slow.map(|SlowFrame { request, start, progress }| (request, start.elapsed(), progress));
        let share = slow.and_then(|(.., progress)| progress.share).unwrap_or(0.0);
        bar.set_position(steps(done as f64 + share));
        let current = slow.map(|(_, taken, progress)| (taken.as_secs_f64(), progress.share));
        let left = self.times.left(current);
        let words = [
            Some(format!("{done}/{total} frames")),
            slow.map(|(request, _, progress)| format!("{}: {}", request.moment(), so_far(&progress))),
            (!rate.is_empty()).then(|| rate.to_owned()),
            left.map(|left| format!("{} left", FormattedDuration(left))),
        ];
        bar.set_message(words.into_iter().flatten().collect::<Vec<_>>().join("  "));
    }
}

impl FrameTimes {
    fn new(total: usize) -> Self {
        Self { total, done: 0, rendered: 0, seconds: 0.0 }
    }

    /// Records a rendered frame.
    fn note(&mut self, seconds: f64) {
        self.done += 1;
        self.rendered += 1;
        self.seconds += seconds;
    }

    /// Returns the remaining time, if the remaining frames take as long on average as the rendered ones. Returns `None` before a frame is
    /// rendered: the start of the first frame does not predict its duration. `current` holds the elapsed seconds of the current frame and
    /// its finished share, if known.
    fn left(&self, current: Option<(f64, Option<f64>)>) -> Option<Duration> {
        let mean = (self.rendered > 0).then(|| self.seconds / self.rendered as f64)?;
        let all = mean * (self.total - self.done) as f64;
        let elapsed =
            current.map_or(0.0, |(taken, share)| share.map_or(taken.min(mean), |share| share * mean));
        Some(Duration::try_from_secs_f64(all - elapsed).unwrap_or(Duration::MAX))
    }
}

/// Formats the progress of a frame.
fn so_far(progress: &RenderProgress) -> String {
    match progress.share {
        Some(share) => format!("{:.0} %", (100.0 * share).floor()),
        None => format!("{:.1} samples a pixel so far", progress.samples),
    }
}

impl Drop for Progress {
    /// Removes the bar, even after an error.
    fn drop(&mut self) {
        if let Display::Bar(bar) = &self.display {
            bar.finish_and_clear();
        }
    }
}

/// Returns a simple bar for quick work; hidden if bars cannot be drawn.
pub(super) fn plain_bar(total: usize) -> ProgressBar {
    if !stderr().is_terminal() || print::is_dumb() {
        return ProgressBar::hidden();
    }
    let bar = ProgressBar::new(total as u64);
    if let Ok(style) = ProgressStyle::with_template("{bar:32} {pos}/{len} frames") {
        bar.set_style(style.progress_chars(FILLING));
    }
    bar
}

/// Fill levels of a cell of a bar, from full to empty.
const FILLING: &str = "█▉▊▋▌▍▎▏ ";

fn bar(total: usize) -> ProgressBar {
    let bar = ProgressBar::new(steps(total as f64));
    if let Ok(style) = ProgressStyle::with_template("{bar:32} {msg}") {
        bar.set_style(style.progress_chars(FILLING));
    }
    bar.enable_steady_tick(Duration::from_millis(200));
    bar
}

/// Returns the position of a bar at a number of frames.
#[expect(clippy::cast_possible_truncation, clippy::cast_sign_loss, reason = "a number of frames")]
fn steps(frames: f64) -> u64 {
    /// Number of bar positions per frame.
    const STEPS: f64 = 1000.0;
    (STEPS * frames) as u64
}

impl LinePace {
    /// Time between lines on a terminal that cannot draw a bar, where more lines would scroll away everything else. A log gets a line for
    /// every frame.
    const ON_DUMB_TERMINALS: Duration = Duration::from_secs(2);
    /// Time between lines about one frame.
    const WITHIN_FRAMES: Duration = Duration::from_secs(10);

    fn new(interval: Duration) -> Self {
        Self { interval, last: Cell::new(None) }
    }

    /// Returns the rate limit of lines, or `None` if a bar can be drawn.
    fn of(is_terminal: bool, is_dumb: bool) -> Option<Self> {
        let interval = match (is_terminal, is_dumb) {
            (true, false) => return None,
            (true, true) => Self::ON_DUMB_TERMINALS,
            (false, _) => Duration::ZERO,
        };
        Some(Self::new(interval))
    }

    /// Returns whether a line about a finished frame is due, and if so, restarts the interval.
    fn is_due(&self, now: Instant, is_end: bool) -> bool {
        self.is_after(now, if is_end { Duration::ZERO } else { self.interval })
    }

    /// Returns whether a line about an unfinished frame is due, and if so, restarts the interval.
    fn is_due_within(&self, now: Instant) -> bool {
        if self.last.get().is_none() {
            self.last.set(Some(now));
        }
        self.is_after(now, Self::WITHIN_FRAMES)
    }

    fn is_after(&self, now: Instant, interval: Duration) -> bool {
        let is_due = self.last.get().is_none_or(|last| now.duration_since(last) >= interval);
        if is_due {
            self.last.set(Some(now));
        }
        is_due
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn dumb_terminals_limit_lines_and_logs_print_all() {
        let start = Instant::now();
        // One frame every half second, except the last, which follows at once.
        let times = [0, 500, 1000, 1500, 2000, 2500, 2501].map(|later| start + Duration::from_millis(later));
        let lines = |is_terminal, is_dumb| {
            let pace = LinePace::of(is_terminal, is_dumb)?;
            Some((1..).zip(times).filter(|(count, now)| pace.is_due(*now, *count == times.len())).count())
        };
        assert_eq!(lines(true, false), None);
        assert_eq!(lines(true, true), Some(3));
        assert_eq!((lines(false, false), lines(false, true)), (Some(7), Some(7)));
    }

    #[test]
    fn slow_frames_print_a_line_every_ten_seconds() {
        let start = Instant::now();
        let pace = LinePace::new(Duration::ZERO);
        let is_due = |second: u64| pace.is_due_within(start + Duration::from_secs(second));
        assert_eq!((1..=32).filter(|second| is_due(*second)).collect::<Vec<_>>(), [11, 21, 31]);
        assert!(pace.is_due(start + Duration::from_secs(32), false) && !is_due(33));
    }

    #[test]
    fn time_left_is_estimated_from_rendered_frames() {
        let mut times = FrameTimes::new(10);
        assert_eq!((times.left(None), times.left(Some((5.0, Some(0.9))))), (None, None));
        // Kept frames do not affect the estimate.
        times.done = 2;
        assert_eq!(times.left(None), None);
        times.note(3.0);
        times.note(5.0);
        let seconds = |current| times.left(current).map(|left| left.as_secs_f64());
        assert_eq!(seconds(None), Some(24.0));
        assert_eq!(seconds(Some((1.0, Some(0.5)))), Some(22.0));
        // If the finished share is unknown, the elapsed time counts, up to the mean of the other frames.
        assert_eq!((seconds(Some((1.0, None))), seconds(Some((9.0, None)))), (Some(23.0), Some(20.0)));
    }
}
