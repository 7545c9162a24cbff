//! When to look at a picture in the making.

use std::sync::atomic::{AtomicU64, Ordering};
use std::time::{Duration, Instant};

/// Says once a second that it is time to look at a picture in the making: seldom enough to cost nothing, as threads wait for each other
/// then.
#[derive(Debug)]
pub(super) struct Heartbeat {
    start: Instant,
    /// In milliseconds from the start.
    next: AtomicU64,
}

impl Heartbeat {
    const PERIOD: Duration = Duration::from_secs(1);

    /// Begins the first second.
    pub(super) fn start() -> Self {
        let heartbeat = Self { start: Instant::now(), next: AtomicU64::new(0) };
        heartbeat.begin();
        heartbeat
    }

    /// Returns whether the second is over. It stays so until another one begins.
    pub(super) fn is_due(&self) -> bool {
        self.elapsed() >= self.next.load(Ordering::Relaxed)
    }

    /// Begins another second.
    pub(super) fn begin(&self) {
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
