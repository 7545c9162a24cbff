//! Schedule of visits to a picture that is being rendered, and of showing it.

use std::sync::atomic::{AtomicU64, Ordering};
use std::time::{Duration, Instant};

/// Time of the first visit to a picture that is being rendered. Most pictures are finished by then.
const FIRST_VISIT: Duration = Duration::from_millis(300);
/// Time between further visits.
const VISIT: Duration = Duration::from_millis(200);
/// Inverse of the maximum fraction of the time that is spent on showing.
const SHOWING: u64 = 10;
/// Inverse of the fraction of the elapsed time that must pass before the picture is shown again. The first showings therefore come
/// quickly, and a picture that takes long does not keep a browser busy.
const MORE: u64 = 3;
/// Upper limit, in milliseconds, of the time that must pass before the picture is shown again.
const SELDOM: u64 = 5000;

/// The times of visits and showings of a picture that is being rendered, in milliseconds since the start.
pub(super) struct RefreshTimer {
    start: Instant,
    due: AtomicU64,
    last_shown: AtomicU64,
    showing: AtomicU64,
}

impl RefreshTimer {
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

    /// Returns whether it is time to show the unfinished picture.
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

    /// Returns the milliseconds spent on the picture itself, without showing it.
    pub(super) fn traced(&self) -> f64 {
        (self.now() - self.showing.load(Ordering::Relaxed)) as f64
    }
}

fn whole_milliseconds(time: Duration) -> u64 {
    u64::try_from(time.as_millis()).unwrap_or(u64::MAX)
}
