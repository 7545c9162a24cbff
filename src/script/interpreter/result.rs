//! Results of script functions: a value, or an error.

use rhai::{Dynamic, EvalAltResult, FLOAT, Position};

use super::{budget, limits};

pub(super) type Outcome = Result<Dynamic, Box<EvalAltResult>>;

/// Returns an error at the position of the call. A second line of the message is the remedy.
pub(super) fn failed<T>(message: impl Into<String>) -> Result<T, Box<EvalAltResult>> {
    budget::add(limits::FAILURE);
    Err(EvalAltResult::ErrorArithmetic(message.into(), Position::NONE).into())
}

/// Returns a number, or an error if it is not finite.
pub(super) fn finite(value: FLOAT) -> Outcome {
    if value.is_nan() {
        return failed(
            "the result is not a number\nsome functions do not take all numbers: sqrt none below 0",
        );
    }
    if value.is_infinite() {
        return failed("the result is too large for a number\nnumbers reach to about 1.8e308");
    }
    Ok(Dynamic::from_float(value))
}

/// Returns the value of an integer or floating-point number.
#[expect(
    clippy::cast_precision_loss,
    reason = "whole numbers beyond 2^53 round, as any number in a file does"
)]
pub(super) fn number(value: &Dynamic) -> Option<FLOAT> {
    value.as_float().ok().or_else(|| value.as_int().ok().map(|integer| integer as FLOAT))
}
