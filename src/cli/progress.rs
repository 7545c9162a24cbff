//! Progress: a bar on a terminal, plain lines elsewhere, and objects for machines.

use std::cell::Cell;
use std::io::{IsTerminal, stderr};
use std::time::{Duration, Instant};

use indicatif::{ProgressBar, ProgressStyle};
use serde_json::json;

use rayreel::sequence::Shot;

use super::args::ProgressName;
use super::print;
use super::report::{ShotReport, in_millions};

/// Reports frames as they are done.
pub(super) struct Progress {
    total: usize,
    display: Display,
}

enum Display {
    Bar(ProgressBar),
    Lines(LinePace),
    /// An object in a line for every frame.
    Json,
    Nothing,
}

/// The time between lines.
#[derive(Debug)]
struct LinePace {
    /// Zero for a line for every frame.
    apart: Duration,
    last: Cell<Option<Instant>>,
}

impl Progress {
    pub(super) fn start(total: usize, how: ProgressName) -> Self {
        let display = match (how, LinePace::of(stderr().is_terminal(), print::is_dumb())) {
            (ProgressName::Json, _) => Display::Json,
            (ProgressName::None, _) => Display::Nothing,
            (ProgressName::Auto, Some(pace)) => Display::Lines(pace),
            (ProgressName::Auto, None) => Display::Bar(bar(total)),
        };
        Self { total, display }
    }

    /// Reports a shot that was done already, the `count`-th so far.
    pub(super) fn kept(&self, shot: &Shot, count: usize) {
        match &self.display {
            Display::Bar(bar) => bar.set_position(count as u64),
            Display::Json => print::error_json(&json!({
                "frame": shot.frame,
                "time": shot.time.seconds(),
                "kept": true,
                "done": count,
                "total": self.total,
            })),
            Display::Lines(_) | Display::Nothing => {}
        }
    }

    /// Reports a finished shot, the `count`-th so far.
    pub(super) fn done(&self, shot: &ShotReport, count: usize) {
        let rate = in_millions(shot.rays_per_second());
        match &self.display {
            Display::Bar(bar) => {
                bar.set_message(format!("{rate} rays/s"));
                bar.set_position(count as u64);
            }
            Display::Lines(pace) if pace.is_due(Instant::now(), count == self.total) => {
                print::error_line(&format!(
                    "{count}/{} {}: {:.3} s, {rate} rays/s",
                    self.total,
                    shot.name(),
                    shot.seconds()
                ));
            }
            Display::Json => {
                let mut told = shot.to_json();
                told["kept"] = json!(false);
                told["done"] = json!(count);
                told["total"] = json!(self.total);
                print::error_json(&told);
            }
            Display::Lines(_) | Display::Nothing => {}
        }
    }
}

impl Drop for Progress {
    /// Removes the bar, however it ended.
    fn drop(&mut self) {
        if let Display::Bar(bar) = &self.display {
            bar.finish_and_clear();
        }
    }
}

/// Returns a bar for work that is done quickly; hidden where none can be drawn.
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

/// The steps of a cell of a bar, from full to empty.
const FILLING: &str = "█▉▊▋▌▍▎▏ ";

fn bar(total: usize) -> ProgressBar {
    let bar = ProgressBar::new(total as u64);
    let template = "{bar:32} {pos}/{len} frames  {msg}  {eta} left";
    if let Ok(style) = ProgressStyle::with_template(template) {
        bar.set_style(style.progress_chars(FILLING));
    }
    bar.enable_steady_tick(Duration::from_millis(200));
    bar
}

impl LinePace {
    /// The time between lines where they would scroll everything else away: on a terminal that can draw no bar. A log has a line
    /// for every frame.
    const ON_DUMB_TERMINALS: Duration = Duration::from_secs(2);

    /// Returns the pace of lines. `None` where a bar can be drawn.
    fn of(is_terminal: bool, is_dumb: bool) -> Option<Self> {
        let apart = match (is_terminal, is_dumb) {
            (true, false) => return None,
            (true, true) => Self::ON_DUMB_TERMINALS,
            (false, _) => Duration::ZERO,
        };
        Some(Self { apart, last: Cell::new(None) })
    }

    fn is_due(&self, now: Instant, is_end: bool) -> bool {
        let is_early = self.last.get().is_some_and(|last| now.duration_since(last) < self.apart);
        let is_due = is_end || !is_early;
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
    fn dumb_terminals_have_lines_now_and_then_and_logs_have_them_all() {
        let start = Instant::now();
        // A frame every half second, the last one right after the one before.
        let times = [0, 500, 1000, 1500, 2000, 2500, 2501].map(|later| start + Duration::from_millis(later));
        let told = |is_terminal, is_dumb| {
            let pace = LinePace::of(is_terminal, is_dumb)?;
            Some((1..).zip(times).filter(|(count, now)| pace.is_due(*now, *count == times.len())).count())
        };
        assert_eq!(told(true, false), None);
        assert_eq!(told(true, true), Some(3));
        assert_eq!((told(false, false), told(false, true)), (Some(7), Some(7)));
    }
}
