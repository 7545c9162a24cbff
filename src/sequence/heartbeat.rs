//! Pictures in the making, looked at once a second.

use std::ops::ControlFlow::{self, Continue};
use std::sync::atomic::{AtomicBool, AtomicU64, Ordering};
use std::time::{Duration, Instant};

use crate::trace::{ExposureProgress, Signals};

/// Has a picture rendered, by a function of its signals and of what hears at every pause that these ask for how far it is, and tells so:
/// once a second.
pub(super) fn watched<T>(
    cancelled: &AtomicBool,
    tell: &mut dyn FnMut(ExposureProgress),
    render: impl FnOnce(Signals<'_>, &mut dyn FnMut(ExposureProgress) -> ControlFlow<()>) -> T,
) -> T {
    let heartbeat = Heartbeat::start();
    let pause = || heartbeat.is_due();
    render(Signals { cancelled, pause: &pause }, &mut |so_far| {
        heartbeat.begin();
        tell(so_far);
        Continue(())
    })
}

/// Says once a second that it is time to look at a picture in the making: seldom enough to cost nothing, as threads wait for each other
/// then.
#[derive(Debug)]
struct Heartbeat {
    start: Instant,
    /// In milliseconds from the start.
    next: AtomicU64,
}

impl Heartbeat {
    const PERIOD: Duration = Duration::from_secs(1);

    /// Begins the first second.
    fn start() -> Self {
        let heartbeat = Self { start: Instant::now(), next: AtomicU64::new(0) };
        heartbeat.begin();
        heartbeat
    }

    /// Returns whether the second is over. It stays so until another one begins.
    fn is_due(&self) -> bool {
        self.elapsed() >= self.next.load(Ordering::Relaxed)
    }

    /// Begins another second.
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
    fn it_is_due_until_another_second_begins() {
        let heartbeat = Heartbeat::start();
        assert!(!heartbeat.is_due());
        let late = Heartbeat { start: Instant::now() - 2 * Heartbeat::PERIOD, ..heartbeat };
        assert!(late.is_due() && late.is_due());
        late.begin();
        assert!(!late.is_due());
    }
}
