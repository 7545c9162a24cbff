//! Counts the operations of a script. Rhai counts one for a call and for a variable, however much is in it. Functions of lists
//! therefore add theirs, and so does every use of a variable, so that a limit on operations is a limit on time.

use std::cell::Cell;

use rhai::{Dynamic, Engine, EvalAltResult, Position};

use super::limits;

thread_local! {
    /// The operations beyond Rhai's own count of the script that runs on this thread.
    static DONE: Cell<u64> = const { Cell::new(0) };
    /// The operations of this script by Rhai's count.
    static OPERATIONS: Cell<u64> = const { Cell::new(0) };
}

/// The size of a value, with all values in it.
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

    /// Returns the operations that copying all of this, or looking through it, counts as.
    pub(super) fn work(self) -> usize {
        /// Plain values that are copied in the time of an operation,
        const VALUES: usize = 32;
        /// those that are copied in the time that a list or an entry of a map takes,
        const CONTAINER: usize = 16;
        /// and the bytes of text that are looked through.
        const BYTES: usize = 64;
        (self.listed + CONTAINER * (self.containers + self.mapped)) / VALUES + self.text / BYTES
    }

    /// Returns the operations that writing all of this as text counts as.
    pub(super) fn writing(self) -> usize {
        self.work() + 4 * (self.listed + self.mapped)
    }

    /// Returns an error if this is more than a script may hold.
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

/// Counts the work of a function that goes through `values` values.
pub(super) fn add(values: usize) {
    DONE.set(DONE.get() + values as u64);
}

/// Counts the work of a function that goes through `bytes` bytes of text.
pub(super) fn add_text(bytes: usize) {
    add(Extent { text: bytes, ..Extent::default() }.work());
}

/// Resets the counts, at the start of a script.
pub(super) fn start() {
    DONE.set(0);
    OPERATIONS.set(0);
}

/// Returns all operations of the script on this thread so far.
pub(super) fn done() -> u64 {
    OPERATIONS.get() + DONE.get()
}

/// Stops scripts as soon as what they have done is too much.
pub(super) fn limit(engine: &mut Engine, is_too_much: impl Fn(u64) -> bool + Send + Sync + 'static) {
    engine.on_progress(move |operations| {
        OPERATIONS.set(operations);
        is_too_much(done()).then_some(Dynamic::UNIT)
    });
}

/// Gives scripts what they read from outside. What variables hold is counted here whenever they are used, and held to its limits:
/// assignments into a list or a map make it larger without being asked, but only until its next use.
pub(super) fn on_outside(
    engine: &mut Engine,
    outside: impl Fn(&str) -> Option<Dynamic> + Send + Sync + 'static,
) {
    #[expect(deprecated, reason = "marked so because it may change, not because it will go")]
    engine.on_var(move |name, index, context| {
        // Variables of the script's own have an index, counted from the newest.
        let Some(place) = index.checked_sub(1) else { return Ok(outside(name)) };
        if let Some((_, _, own)) = context.scope().iter_raw().nth(place) {
            let extent = Extent::of(own);
            add(extent.work());
            extent.refuse_excess()?;
        }
        Ok(None)
    });
}
