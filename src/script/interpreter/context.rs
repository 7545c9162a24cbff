//! Script inputs: the time, the owner of the script, and the values of other channels.

use std::cell::RefCell;
use std::collections::HashMap;

use rhai::{Dynamic, Engine, EvalAltResult, ImmutableString, NativeCallContext, Position};

use super::dynamic::kind;
use super::positions::span_of;
use super::result::{Outcome, failed, number};
use super::{Data, Read, budget};
use crate::animation::limits::LARGEST;

/// The inputs of a script: the time, its owner, and the known values of other channels.
#[derive(Clone, Debug, Default)]
pub(crate) struct ScriptContext {
    seconds: f64,
    frame: f64,
    fps: f64,
    duration: f64,
    index: u64,
    name: Dynamic,
    base: Dynamic,
    operations: u64,
    values: HashMap<ValueKey, Dynamic>,
}

/// The owner and the name of a channel, and the bits of a moment in seconds.
type ValueKey = (ImmutableString, ImmutableString, u64);

/// A read of an unknown value, as stored in the error that stops the script.
#[derive(Clone, Debug)]
struct ReadRequest {
    target: String,
    channel: String,
    seconds: f64,
    position: Position,
}

impl ScriptContext {
    /// Names of the variables provided to scripts.
    pub(super) const NAMES: [&'static str; 7] = ["t", "frame", "fps", "duration", "index", "name", "base"];

    /// Creates a context at the start of a timeline of `duration` seconds with `fps` frames per second.
    #[must_use]
    pub(crate) fn new(fps: f64, duration: f64) -> Self {
        Self { fps, duration, ..Self::default() }
    }

    /// Sets the owner of the script: its `index`, its `name`, and `base`, the value of its channel without the script.
    pub(crate) fn set_owner(&mut self, index: u64, name: &str, base: Data) {
        self.index = index;
        self.name = ImmutableString::from(name).into();
        self.base = base.into_dynamic();
    }

    /// Sets the time, in seconds and in fractional frames.
    pub(crate) fn set_time(&mut self, seconds: f64, frame: f64) {
        (self.seconds, self.frame) = (seconds, frame);
    }

    /// Returns the number of operations of the last run.
    #[must_use]
    pub(crate) fn operations(&self) -> u64 {
        self.operations
    }

    pub(super) fn record_operations(&mut self, operations: u64) {
        self.operations = operations;
    }

    /// Discards all values of channels.
    pub(crate) fn clear_values(&mut self) {
        self.values.clear();
    }

    /// Stores the value of a channel for subsequent reads.
    pub(crate) fn set_value(&mut self, read: &Read, value: Data) {
        let key = (read.target.as_str().into(), read.channel.as_str().into(), read.seconds.to_bits());
        self.values.insert(key, value.into_dynamic());
    }

    /// Returns the value of a provided variable, or `None` for any other name.
    #[expect(clippy::cast_possible_wrap, reason = "there are far fewer entities")]
    fn named(&self, name: &str) -> Option<Dynamic> {
        Some(match name {
            "t" => Dynamic::from_float(self.seconds),
            "frame" => Dynamic::from_float(self.frame),
            "fps" => Dynamic::from_float(self.fps),
            "duration" => Dynamic::from_float(self.duration),
            "index" => Dynamic::from_int(self.index as i64),
            "name" => self.name.clone(),
            "base" => self.base.clone(),
            _ => return None,
        })
    }
}

thread_local! {
    /// Context of the script that runs on this thread. The registered functions read it from here, since all scripts share them.
    static CURRENT: RefCell<ScriptContext> = RefCell::default();
}

/// Calls `run` with `context` as the context of this thread.
pub(super) fn within<R>(context: &mut ScriptContext, run: impl FnOnce() -> R) -> R {
    CURRENT.with_borrow_mut(|current| std::mem::swap(current, context));
    let result = run();
    CURRENT.with_borrow_mut(|current| std::mem::swap(current, context));
    result
}

/// Returns the read that stopped a script, if the error is a read of an unknown value.
pub(super) fn unknown_read(text: &str, error: &EvalAltResult) -> Option<Read> {
    match error {
        EvalAltResult::ErrorInFunctionCall(_, _, inner, _) => unknown_read(text, inner),
        EvalAltResult::ErrorTerminated(request, _) => {
            let ReadRequest { target, channel, seconds, position } =
                request.clone().try_cast::<ReadRequest>()?;
            Some(Read { target, channel, seconds, span: span_of(text, position) })
        }
        _ => None,
    }
}

/// Returns the value of a channel at a moment, if it is known; otherwise the error that stops the script.
fn value(
    call: &NativeCallContext<'_>,
    target: ImmutableString,
    channel: ImmutableString,
    seconds: f64,
) -> Outcome {
    budget::add_text(target.len() + channel.len());
    let key: ValueKey = (target, channel, seconds.to_bits());
    let known = CURRENT.with_borrow(|current| current.values.get(&key).cloned());
    known.ok_or_else(|| {
        let position = call.call_position();
        let (target, channel) = (key.0.to_string(), key.1.to_string());
        let request = ReadRequest { target, channel, seconds, position };
        // Scripts cannot catch this error.
        EvalAltResult::ErrorTerminated(Dynamic::from(request), Position::NONE).into()
    })
}

/// Returns a moment that a script has computed, in seconds.
fn moment(seconds: &Dynamic) -> Result<f64, Box<EvalAltResult>> {
    match number(seconds) {
        // The sum with 0 removes the sign of -0.
        Some(seconds) if seconds.abs() <= LARGEST => Ok(seconds + 0.0),
        Some(seconds) => {
            failed(format!("there is no moment at {seconds:?} s\nmoments reach to 1e60 seconds"))
        }
        None => failed(format!("`value` takes a number of seconds, not {}\nwrite `t - 0.5`", kind(seconds))),
    }
}

pub(super) fn register(engine: &mut Engine) {
    type Name = ImmutableString;
    engine.register_fn("value", |call: NativeCallContext<'_>, target: Name, channel: Name| {
        value(&call, target, channel, CURRENT.with_borrow(|current| current.seconds))
    });
    engine.register_fn(
        "value",
        |call: NativeCallContext<'_>, target: Name, channel: Name, seconds: Dynamic| {
            value(&call, target, channel, moment(&seconds)?)
        },
    );
    budget::on_outside(engine, |name| CURRENT.with_borrow(|current| current.named(name)));
}
