//! Time measurements that do not depend on other load of the machine.

use std::fs;
use std::time::{Duration, Instant};

/// A point in time, by the processor time of this thread where the system reports it, because the machine may be busy.
#[derive(Clone, Copy)]
pub(crate) struct Spent {
    moment: Instant,
    on_processor: Option<Duration>,
}

impl Spent {
    pub(crate) fn now() -> Self {
        let schedstat = fs::read_to_string("/proc/thread-self/schedstat").ok();
        let nanoseconds = schedstat.and_then(|schedstat| schedstat.split_whitespace().next()?.parse().ok());
        Self { moment: Instant::now(), on_processor: nanoseconds.map(Duration::from_nanos) }
    }

    pub(crate) fn since(self, start: Self) -> Duration {
        match (self.on_processor, start.on_processor) {
            (Some(end), Some(start)) => end.saturating_sub(start),
            _ => self.moment - start.moment,
        }
    }
}
