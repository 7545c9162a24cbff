//! Progress reports of pictures that are being rendered, once a second.

use std::ops::ControlFlow::{self, Continue};
use std::sync::atomic::{AtomicBool, AtomicU64, Ordering};
use std::time::{Duration, Instant};

use crate::trace::{RenderProgress, Signals};

/// Renders a picture, and reports its progress to `on_progress` once a second. `render` receives signals that request pauses, and a function to
/// call at every pause with the progress.
pub(super) fn watched<T>(
    cancelled: &AtomicBool,
    on_progress: &mut dyn FnMut(RenderProgress),
    render: impl FnOnce(Signals<'_>, &mut dyn FnMut(RenderProgress) -> ControlFlow<()>) -> T,
) -> T {
    let timer = ProgressTimer::start();
    let pause = || timer.is_due();
    render(Signals { cancelled, pause: &pause }, &mut |so_far| {
        timer.begin();
        on_progress(so_far);
        Continue(())
    })
}

/// A timer that requests a pause of rendering once a second. At a pause, threads wait for each other; the cost is negligible.
#[derive(Debug)]
struct ProgressTimer {
    start: Instant,
    /// Time of the next pause, in milliseconds from the start.
    next: AtomicU64,
}

impl ProgressTimer {
    const PERIOD: Duration = Duration::from_secs(1);

    /// Starts the timer and its first period.
    fn start() -> Self {
        let timer = Self { start: Instant::now(), next: AtomicU64::new(0) };
        timer.begin();
        timer
    }

    /// Returns whether the period is over. The result stays true until the next period begins.
    fn is_due(&self) -> bool {
        self.elapsed() >= self.next.load(Ordering::Relaxed)
    }

    /// Begins the next period.
    fn begin(&self) {
        let period = u64::try_from(Self::PERIOD.as_millis()).unwrap_or(u64::MAX);
        self.next.store(self.elapsed() + period, Ordering::Relaxed);
    }

    fn elapsed(&self) -> u64 {
        u64::try_from(self.start.elapsed().as_millis()).unwrap_or(u64::MAX)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn timer_stays_due_until_the_next_second_begins() {
        let timer = ProgressTimer::start();
        assert!(!timer.is_due());
        let late = ProgressTimer { start: Instant::now() - 2 * ProgressTimer::PERIOD, ..timer };
        assert!(late.is_due() && late.is_due());
        late.begin();
        assert!(!late.is_due());
    }
}
