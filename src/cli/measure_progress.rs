//! Progress of measurements: the current setting and the remaining time.

use std::io::{IsTerminal, stderr};
use std::time::{Duration, Instant};

use indicatif::{ProgressBar, ProgressStyle};

use rayreel::accuracy::{Observer, Subject};

use super::instructions::Instructions;
use super::print;

/// Display of the progress: a bar on a terminal, occasional lines elsewhere.
pub(super) struct MeasureProgress {
    start: Instant,
    bar: Option<ProgressBar>,
    /// Time of the last printed line.
    last: Instant,
    instructions: Instructions,
}

impl MeasureProgress {
    const STEPS: u64 = 1000;
    const BETWEEN_LINES: Duration = Duration::from_secs(10);

    /// Starts the display and the instruction counter. Must be called before the threads start whose instructions are counted.
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

    /// Shows the current step, and the fraction of the work that is done, 0 to 1.
    pub(super) fn show(&mut self, step: &str, share: f64) {
        /// Fraction of the work that must be done before the remaining time is estimated.
        const LEAST: f64 = 0.02;
        let left = self.start.elapsed().as_secs_f64() * (1.0 - share) / share.max(LEAST);
        let left = if share > LEAST { format!(", about {left:.0} s left") } else { String::new() };
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
}

impl Observer for MeasureProgress {
    fn at(&mut self, subject: Option<Subject>, share: f64) {
        let step = subject.map_or_else(|| "the reference".to_owned(), |subject| subject.to_string());
        self.show(&step, share);
    }

    fn instructions(&mut self) -> Option<u64> {
        self.instructions.so_far()
    }
}

impl Drop for MeasureProgress {
    /// Removes the bar, even after an error.
    fn drop(&mut self) {
        if let Some(bar) = &self.bar {
            bar.finish_and_clear();
        }
    }
}
