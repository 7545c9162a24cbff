//! Time that does not depend on what else a machine does.

use std::fs;
use std::time::{Duration, Instant};

/// A moment, by the time that this thread has spent on a processor where the system tells: a machine may be busy with other things.
#[derive(Clone, Copy)]
pub(crate) struct Spent {
    moment: Instant,
    on_processor: Option<Duration>,
}

impl Spent {
    pub(crate) fn now() -> Self {
        let told = fs::read_to_string("/proc/thread-self/schedstat").ok();
        let nanoseconds = told.and_then(|told| told.split_whitespace().next()?.parse().ok());
        Self { moment: Instant::now(), on_processor: nanoseconds.map(Duration::from_nanos) }
    }

    pub(crate) fn since(self, start: Self) -> Duration {
        match (self.on_processor, start.on_processor) {
            (Some(end), Some(start)) => end.saturating_sub(start),
            _ => self.moment - start.moment,
        }
    }
}
