//! Counts of executed instructions. They are available on Linux, if the processor has counters and the system allows programs to read
//! them. Unlike times, they do not depend on other load of the machine.

#[cfg(target_os = "linux")]
use perf_event::{Builder, Counter, events::Hardware};

/// Counter of the instructions of the thread that starts it, and of all threads which that thread starts later.
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

    /// Returns the number of instructions since the start, or `None` if they are not counted.
    pub(super) fn so_far(&mut self) -> Option<u64> {
        self.counter.as_mut()?.read().ok()
    }
}

#[cfg(not(target_os = "linux"))]
impl Instructions {
    pub(super) fn start() -> Self {
        Self {}
    }

    /// Returns `None`: instructions are not counted on this system.
    #[expect(clippy::unused_self, reason = "where there are counters, one is read")]
    pub(super) fn so_far(&mut self) -> Option<u64> {
        None
    }
}
