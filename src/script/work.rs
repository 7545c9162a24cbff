//! Counts what a program does. Rhai counts an operation for a call, however much the function has to do: functions of lists
//! add theirs, so that a limit on operations is one on time.

use std::cell::Cell;

use rhai::{Dynamic, Engine};

thread_local! {
    /// What functions have done beyond their calls in the program that runs on this thread.
    static DONE: Cell<u64> = const { Cell::new(0) };
}

/// A function goes through so many values.
pub(super) fn add(values: usize) {
    DONE.set(DONE.get() + values as u64);
}

/// Nothing has been done yet.
pub(super) fn start() {
    DONE.set(0);
}

/// Stops programs that do more than `most` says.
pub(super) fn limit(engine: &mut Engine, most: impl Fn() -> u64 + Send + Sync + 'static) {
    engine.on_progress(move |operations| (operations + DONE.get() > most()).then_some(Dynamic::UNIT));
}
