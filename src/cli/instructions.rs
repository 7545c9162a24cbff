//! The instructions that the program executes, where they are counted: on Linux, if the processor has counters and the system lets
//! programs read them. Unlike seconds they do not depend on what else the machine does.

#[cfg(target_os = "linux")]
use perf_event::{Builder, Counter, events::Hardware};

/// Counts the instructions of the thread that starts it, and of all threads that this one starts later.
pub(super) struct Instructions {
    #[cfg(target_os = "linux")]
    counter: Option<Counter>,
}

#[cfg(target_os = "linux")]
impl Instructions {
    pub(super) fn start() -> Self {
        let counter = Builder::new(Hardware::INSTRUCTIONS).inherit(true).build();
        let started = counter.and_then(|mut counter| counter.enable().map(|()| counter));
        Self { counter: started.ok() }
    }

    /// Returns how many there were since the start; `None` where they are not counted.
    pub(super) fn so_far(&mut self) -> Option<u64> {
        self.counter.as_mut()?.read().ok()
    }
}

#[cfg(not(target_os = "linux"))]
impl Instructions {
    pub(super) fn start() -> Self {
        Self {}
    }

    /// Returns `None`: they are not counted here.
    #[expect(clippy::unused_self, reason = "where there are counters, one is read")]
    pub(super) fn so_far(&mut self) -> Option<u64> {
        None
    }
}
