//! Counts what a program does. Rhai counts an operation for a call and for a variable, however much is in it: functions of lists add
//! theirs, and so does every use of a variable, so that a limit on operations is one on time.

use std::cell::Cell;

use rhai::{Dynamic, Engine, EvalAltResult, Position};

use super::limits;

thread_local! {
    /// What has been done beyond Rhai's own count in the program that runs on this thread.
    static DONE: Cell<u64> = const { Cell::new(0) };
    /// The operations of this program by Rhai's count.
    static OPERATIONS: Cell<u64> = const { Cell::new(0) };
}

/// What is in a value, with all that is in the values in it.
#[derive(Clone, Copy, Debug, Default)]
pub(super) struct Extent {
    /// Values in lists.
    listed: usize,
    /// Values in maps.
    mapped: usize,
    /// Bytes of texts and of names in maps.
    text: usize,
    /// Lists and maps, each with memory of its own.
    containers: usize,
}

impl Extent {
    pub(super) fn of(value: &Dynamic) -> Self {
        let mut extent = Self::default();
        extent.add(value);
        extent
    }

    fn add(&mut self, value: &Dynamic) {
        if value.is_array() {
            self.containers += 1;
            if let Ok(list) = value.as_array_ref() {
                self.listed += list.len();
                list.iter().for_each(|value| self.add(value));
            }
        } else if value.is_map() {
            self.containers += 1;
            if let Ok(map) = value.as_map_ref() {
                self.mapped += map.len();
                for (name, value) in map.iter() {
                    self.text += name.len();
                    self.add(value);
                }
            }
        } else if value.is_string()
            && let Ok(text) = value.as_immutable_string_ref()
        {
            self.text += text.len();
        }
    }

    /// The operations that it is to copy all of this, or to look through it.
    pub(super) fn work(self) -> usize {
        /// Plain values that are copied in the time of an operation,
        const VALUES: usize = 32;
        /// those that are copied in the time that a list or an entry of a map takes,
        const CONTAINER: usize = 16;
        /// and the bytes of text that are looked through.
        const BYTES: usize = 64;
        (self.listed + CONTAINER * (self.containers + self.mapped)) / VALUES + self.text / BYTES
    }

    /// The same once more for each value, to write them down.
    pub(super) fn writing(self) -> usize {
        self.work() + 4 * (self.listed + self.mapped)
    }

    /// Is it beyond what a program may hold?
    fn refuse_excess(self) -> Result<(), Box<EvalAltResult>> {
        let what = match self {
            Self { listed, .. } if listed > limits::LIST => "array",
            Self { mapped, .. } if mapped > limits::MAP => "map",
            Self { text, .. } if text > limits::TEXT => "string",
            _ => return Ok(()),
        };
        Err(EvalAltResult::ErrorDataTooLarge(what.to_owned(), Position::NONE).into())
    }
}

/// A function goes through so many values.
pub(super) fn add(values: usize) {
    DONE.set(DONE.get() + values as u64);
}

/// A function goes through so many bytes of text.
pub(super) fn add_text(bytes: usize) {
    add(Extent { text: bytes, ..Extent::default() }.work());
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

/// Stops programs as soon as what they have done is too much.
pub(super) fn limit(engine: &mut Engine, is_too_much: impl Fn(u64) -> bool + Send + Sync + 'static) {
    engine.on_progress(move |operations| {
        OPERATIONS.set(operations);
        is_too_much(done()).then_some(Dynamic::UNIT)
    });
}

/// Gives programs what they read from outside. What variables hold is counted here whenever they are used, and held to its limits:
/// assignments into a list or a map make it larger without being asked, but only until its next use.
pub(super) fn on_outside(
    engine: &mut Engine,
    outside: impl Fn(&str) -> Option<Dynamic> + Send + Sync + 'static,
) {
    #[expect(deprecated, reason = "marked so because it may change, not because it will go")]
    engine.on_var(move |name, index, context| {
        // Variables of the program's own have an index, counted from the newest.
        let Some(place) = index.checked_sub(1) else { return Ok(outside(name)) };
        if let Some((_, _, own)) = context.scope().iter_raw().nth(place) {
            let extent = Extent::of(own);
            add(extent.work());
            extent.refuse_excess()?;
        }
        Ok(None)
    });
}
