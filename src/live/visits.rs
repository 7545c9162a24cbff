//! The times at which a picture in the making is looked at, and shown.

use std::sync::atomic::{AtomicU64, Ordering};
use std::time::{Duration, Instant};

/// The time after which a picture in the making is first looked at: most are done by then.
const FIRST_VISIT: Duration = Duration::from_millis(300);
/// The time between further looks.
const VISIT: Duration = Duration::from_millis(200);
/// Showing takes at most one part in this many of the time.
const SHOWING: u64 = 10;
/// It is shown again after one part in this many more of the time, so that the first ones come quickly and a long one does not
/// keep a browser busy,
const MORE: u64 = 3;
/// or after this many milliseconds, if that is sooner.
const SELDOM: u64 = 5000;

/// The times at which a picture in the making is looked at and shown, in milliseconds since the start.
pub(super) struct Visits {
    start: Instant,
    due: AtomicU64,
    last_shown: AtomicU64,
    showing: AtomicU64,
}

impl Visits {
    pub(super) fn new() -> Self {
        Self {
            start: Instant::now(),
            due: AtomicU64::new(whole_milliseconds(FIRST_VISIT)),
            last_shown: AtomicU64::new(0),
            showing: AtomicU64::new(0),
        }
    }

    pub(super) fn now(&self) -> u64 {
        whole_milliseconds(self.start.elapsed())
    }

    pub(super) fn are_due(&self) -> bool {
        self.now() >= self.due.load(Ordering::Relaxed)
    }

    /// Returns whether it is time to show what there is.
    pub(super) fn show(&self) -> bool {
        let last = self.last_shown.load(Ordering::Relaxed);
        let showing = self.showing.load(Ordering::Relaxed);
        showing <= self.now() / SHOWING && self.now() - last >= (last / MORE).min(SELDOM)
    }

    pub(super) fn shown(&self, since: u64) {
        self.showing.fetch_add(self.now() - since, Ordering::Relaxed);
        self.last_shown.store(self.now(), Ordering::Relaxed);
    }

    pub(super) fn go_on(&self) {
        self.due.store(self.now() + whole_milliseconds(VISIT), Ordering::Relaxed);
    }

    /// Returns the milliseconds that went into the picture itself.
    pub(super) fn traced(&self) -> f64 {
        (self.now() - self.showing.load(Ordering::Relaxed)) as f64
    }
}

fn whole_milliseconds(time: Duration) -> u64 {
    u64::try_from(time.as_millis()).unwrap_or(u64::MAX)
}
