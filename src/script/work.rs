//! Counts what a program does. Rhai counts an operation for a call, however much the function has to do: functions of lists
//! add theirs, so that a limit on operations is one on time.

use std::cell::Cell;

use rhai::{Dynamic, Engine, EvalAltResult, Position};

use super::limits;

thread_local! {
    /// What functions have done beyond their calls in the program that runs on this thread.
    static DONE: Cell<u64> = const { Cell::new(0) };
    /// The operations of this program.
    static OPERATIONS: Cell<u64> = const { Cell::new(0) };
}

/// A function goes through so many values.
pub(super) fn add(values: usize) {
    DONE.set(DONE.get() + values as u64);
}

/// Nothing has been done yet.
pub(super) fn start() {
    DONE.set(0);
    OPERATIONS.set(0);
}

/// All that the program on this thread has done.
pub(super) fn done() -> u64 {
    OPERATIONS.get() + DONE.get()
}

/// Stops programs that do more than `most` says.
pub(super) fn limit(engine: &mut Engine, most: impl Fn() -> u64 + Send + Sync + 'static) {
    engine.on_progress(move |operations| {
        OPERATIONS.set(operations);
        (done() > most()).then_some(Dynamic::UNIT)
    });
}

/// Gives programs what they read from outside. The size of a map is looked at here too, whenever a variable is used: assignments to what
/// a map does not hold yet make it larger without being asked.
pub(super) fn on_outside(
    engine: &mut Engine,
    outside: impl Fn(&str) -> Option<Dynamic> + Send + Sync + 'static,
) {
    #[expect(deprecated, reason = "marked so because it may change, not because it will go")]
    engine.on_var(move |name, index, context| {
        // Variables of the program's own have an index.
        if index == 0 {
            return Ok(outside(name));
        }
        match context.scope().get(name) {
            Some(own) if mapped(own) > limits::MAP => {
                Err(EvalAltResult::ErrorDataTooLarge("map".to_owned(), Position::NONE).into())
            }
            _ => Ok(None),
        }
    });
}

/// The values in a map and in those in it, or in those in a list.
fn mapped(value: &Dynamic) -> usize {
    if let Ok(map) = value.as_map_ref() {
        return map.len() + map.values().map(mapped).sum::<usize>();
    }
    value.as_array_ref().map_or(0, |list| list.iter().map(mapped).sum())
}
