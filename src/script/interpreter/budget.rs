//! Operation counts of scripts. Rhai counts one operation for a call and for a use of a variable, regardless of the size of the value.
//! List functions and uses of variables therefore add operations of their own, so that a limit on operations is a limit on time.

use std::cell::Cell;

use rhai::{Dynamic, Engine, EvalAltResult, Position};

use super::limits;

thread_local! {
    /// Operations of the script that runs on this thread, in addition to Rhai's own count.
    static DONE: Cell<u64> = const { Cell::new(0) };
    /// Operations of this script by Rhai's count.
    static OPERATIONS: Cell<u64> = const { Cell::new(0) };
}

/// The size of a value, including nested values.
#[derive(Clone, Copy, Debug, Default)]
pub(super) struct ValueSize {
    /// Number of values in lists.
    listed: usize,
    /// Number of values in maps.
    mapped: usize,
    /// Bytes of strings and of map keys.
    text: usize,
    /// Number of lists and maps, each of which is a separate allocation.
    containers: usize,
}

impl ValueSize {
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

    /// Returns the number of operations charged for copying or traversing the value.
    pub(super) fn work(self) -> usize {
        /// Number of plain values that are copied in the time of one operation.
        const VALUES: usize = 32;
        /// Number of plain values that are copied in the time of one list, map or map entry.
        const CONTAINER: usize = 16;
        /// Number of bytes of text that are traversed in the time of one operation.
        const BYTES: usize = 64;
        (self.listed + CONTAINER * (self.containers + self.mapped)) / VALUES + self.text / BYTES
    }

    /// Returns the number of operations charged for formatting the value as text.
    pub(super) fn writing(self) -> usize {
        self.work() + 4 * (self.listed + self.mapped)
    }

    /// Returns an error if the size exceeds the limits of a value.
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

/// Charges the work of a function that traverses `values` values.
pub(super) fn add(values: usize) {
    DONE.set(DONE.get() + values as u64);
}

/// Charges the work of a function that traverses `bytes` bytes of text.
pub(super) fn add_text(bytes: usize) {
    add(ValueSize { text: bytes, ..ValueSize::default() }.work());
}

/// Resets the counts at the start of a script.
pub(super) fn start() {
    DONE.set(0);
    OPERATIONS.set(0);
}

/// Returns the number of operations of the script on this thread so far.
pub(super) fn done() -> u64 {
    OPERATIONS.get() + DONE.get()
}

/// Stops scripts once `is_too_much` holds for their number of operations.
pub(super) fn limit(engine: &mut Engine, is_too_much: impl Fn(u64) -> bool + Send + Sync + 'static) {
    engine.on_progress(move |operations| {
        OPERATIONS.set(operations);
        is_too_much(done()).then_some(Dynamic::UNIT)
    });
}

/// Resolves names provided from outside by `outside`. Each use of a script's own variable charges the size of its value and checks it
/// against the limits. Assignments into a list or a map are not checked, so a value can exceed its limits until its next use.
pub(super) fn on_outside(
    engine: &mut Engine,
    outside: impl Fn(&str) -> Option<Dynamic> + Send + Sync + 'static,
) {
    #[expect(deprecated, reason = "marked so because it may change, not because it will go")]
    engine.on_var(move |name, index, context| {
        // A script's own variables have an index, counted from the newest.
        let Some(place) = index.checked_sub(1) else { return Ok(outside(name)) };
        if let Some((_, _, own)) = context.scope().iter_raw().nth(place) {
            let extent = ValueSize::of(own);
            add(extent.work());
            extent.refuse_excess()?;
        }
        Ok(None)
    });
}
