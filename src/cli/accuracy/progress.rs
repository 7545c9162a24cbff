//! What is being measured, and how long it still takes.

use std::io::{IsTerminal, stderr};
use std::time::{Duration, Instant};

use indicatif::{ProgressBar, ProgressStyle};

use rayreel::accuracy::{Observer, Progress, Step, time_left};

use super::super::instructions::Instructions;
use super::super::print;

/// Shows it: as a bar on a terminal, elsewhere as a line now and then.
pub(super) struct MeasureProgress {
    start: Instant,
    bar: Option<ProgressBar>,
    /// When the last line was printed.
    last: Instant,
    instructions: Instructions,
}

impl MeasureProgress {
    const STEPS: u64 = 1000;
    const BETWEEN_LINES: Duration = Duration::from_secs(10);

    /// Starts before there are threads whose instructions count.
    pub(super) fn start() -> Self {
        let bar = (stderr().is_terminal() && !print::is_dumb()).then(|| {
            let bar = ProgressBar::new(Self::STEPS);
            if let Ok(style) = ProgressStyle::with_template("{bar:32} {percent} %  {msg}") {
                bar.set_style(style.progress_chars("█▉▊▋▌▍▎▏ "));
            }
            bar.enable_steady_tick(Duration::from_millis(200));
            bar
        });
        let instructions = Instructions::start();
        Self { start: Instant::now(), bar, last: Instant::now(), instructions }
    }
}

impl Observer for MeasureProgress {
    fn at(&mut self, progress: Progress) {
        let Progress { step, share } = progress;
        let step = match step {
            Step::Reference => "the reference".to_owned(),
            Step::Row(subject) => subject.to_string(),
        };
        let left = time_left(self.start.elapsed(), share);
        let left = left.map_or_else(String::new, |left| format!(", about {} s left", left.as_secs() + 1));
        match &self.bar {
            Some(bar) => {
                #[expect(clippy::cast_possible_truncation, clippy::cast_sign_loss, reason = "0 to 1000")]
                bar.set_position((share * Self::STEPS as f64) as u64);
                bar.set_message(format!("{step}{left}"));
            }
            None if self.last.elapsed() >= Self::BETWEEN_LINES => {
                self.last = Instant::now();
                print::error_line(&format!("{:.0} %: {step}{left}", 100.0 * share));
            }
            None => {}
        }
    }

    fn instructions(&mut self) -> Option<u64> {
        self.instructions.so_far()
    }
}

impl Drop for MeasureProgress {
    /// Removes the bar, however it ended.
    fn drop(&mut self) {
        if let Some(bar) = &self.bar {
            bar.finish_and_clear();
        }
    }
}
