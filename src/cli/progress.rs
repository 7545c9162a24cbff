//! How far it is: a bar on a terminal, plain lines elsewhere.

use std::io::{IsTerminal, stderr};
use std::time::Duration;

use indicatif::{ProgressBar, ProgressStyle};

use super::print;
use super::report::{ShotReport, in_millions};

/// Tells about frames as they are done.
pub(super) struct Progress {
    total: usize,
    /// `None` off a terminal.
    bar: Option<ProgressBar>,
}

impl Progress {
    pub(super) fn start(total: usize) -> Self {
        let bar = stderr().is_terminal().then(|| {
            let bar = ProgressBar::new(total as u64);
            let template = "{bar:32} {pos}/{len} frames  {msg}  {eta} left";
            if let Ok(style) = ProgressStyle::with_template(template) {
                bar.set_style(style.progress_chars("█▉▊▋▌▍▎▏ "));
            }
            bar.enable_steady_tick(Duration::from_millis(200));
            bar
        });
        Self { total, bar }
    }

    /// One more is done; `count` so far.
    pub(super) fn done(&self, shot: &ShotReport, count: usize) {
        let rate = in_millions(shot.rays_per_second());
        match &self.bar {
            Some(bar) => {
                bar.set_message(format!("{rate} rays/s"));
                bar.set_position(count as u64);
            }
            None => print::error_line(&format!(
                "{count}/{} {}: {:.3} s, {rate} rays/s",
                self.total,
                shot.name(),
                shot.seconds()
            )),
        }
    }
}

impl Drop for Progress {
    /// However it ended, no bar stays behind.
    fn drop(&mut self) {
        if let Some(bar) = &self.bar {
            bar.finish_and_clear();
        }
    }
}
