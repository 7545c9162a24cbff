//! Numeric functions, computed by libm so that their results are bit-identical on all platforms.

use std::f64::consts::{E, PI, TAU};

use rhai::{Dynamic, Engine, FLOAT, INT, Module};

use super::budget;
use super::dynamic::kind;
use super::result::{Outcome, failed, finite, number};

/// Names and values of the constants.
pub(super) const CONSTANTS: [(&str, FLOAT); 3] = [("pi", PI), ("tau", TAU), ("e", E)];

/// Returns an argument of a function as a number.
pub(super) fn argument(function: &str, value: &Dynamic) -> Result<FLOAT, Box<rhai::EvalAltResult>> {
    match number(value) {
        Some(number) => Ok(number),
        None => failed(format!("`{function}` takes numbers, not {}", kind(value))),
    }
}

type Unary = fn(FLOAT) -> FLOAT;
type Binary = fn(FLOAT, FLOAT) -> FLOAT;

const LOGARITHMS: [(&str, Unary); 3] = [("ln", libm::log), ("log", libm::log10), ("log2", libm::log2)];

const UNARY: [(&str, Unary); 15] = [
    ("sin", libm::sin),
    ("cos", libm::cos),
    ("tan", libm::tan),
    ("asin", libm::asin),
    ("acos", libm::acos),
    ("atan", libm::atan),
    ("sinh", libm::sinh),
    ("cosh", libm::cosh),
    ("tanh", libm::tanh),
    ("exp", libm::exp),
    ("sqrt", libm::sqrt),
    ("cbrt", libm::cbrt),
    ("radians", FLOAT::to_radians),
    ("degrees", FLOAT::to_degrees),
    ("fract", |x| x - libm::floor(x)),
];

/// Functions with integer results, up to a magnitude of 2^53.
const ROUNDING: [(&str, Unary); 4] =
    [("floor", libm::floor), ("ceil", libm::ceil), ("round", libm::round), ("trunc", libm::trunc)];

const BINARY: [(&str, Binary); 3] =
    [("atan2", libm::atan2), ("hypot", libm::hypot), ("step", |edge, x| if x < edge { 0.0 } else { 1.0 })];

pub(super) fn power(base: FLOAT, exponent: FLOAT) -> Outcome {
    if base == 0.0 && exponent < 0.0 {
        return failed("division by zero\n0 to a negative power");
    }
    finite(libm::pow(base, exponent))
}

#[expect(clippy::cast_possible_truncation, reason = "within the range of whole numbers")]
fn whole(value: FLOAT) -> Dynamic {
    const LARGEST: FLOAT = 9_007_199_254_740_992.0;
    if value.abs() <= LARGEST { Dynamic::from_int(value as INT) } else { Dynamic::from_float(value) }
}

/// Computes x - y floor(x / y), which has the sign of y.
fn modulo(x: FLOAT, y: FLOAT) -> Outcome {
    if y == 0.0 {
        return failed("division by zero\n`mod(x, y)` needs a y other than 0");
    }
    let rest = x % y;
    finite(if rest != 0.0 && (rest < 0.0) != (y < 0.0) { rest + y } else { rest })
}

fn smoothstep(low: FLOAT, high: FLOAT, x: FLOAT) -> Outcome {
    if low >= high {
        return failed("`smoothstep(low, high, x)` needs a low below its high");
    }
    let u = ((x - low) / (high - low)).clamp(0.0, 1.0);
    finite(u * u * (3.0 - 2.0 * u))
}

fn clamp(x: FLOAT, low: FLOAT, high: FLOAT) -> Outcome {
    if low > high {
        return failed("`clamp(x, low, high)` needs a low that is not above its high");
    }
    finite(x.clamp(low, high))
}

/// Interpolates linearly between two numbers, or element by element between two lists.
fn mix(from: &Dynamic, to: &Dynamic, share: FLOAT) -> Outcome {
    if let (Some(from), Some(to)) = (number(from), number(to)) {
        return finite(from * (1.0 - share) + to * share);
    }
    match (from.as_array_ref(), to.as_array_ref()) {
        (Ok(from), Ok(to)) if from.len() == to.len() => {
            budget::add(from.len());
            let parts = from.iter().zip(&*to).map(|(from, to)| mix(from, to, share));
            Ok(Dynamic::from_array(parts.collect::<Result<_, _>>()?))
        }
        _ => failed(format!(
            "`mix` does not take {} and {}\nit takes two numbers, or two lists of the same length",
            kind(from),
            kind(to)
        )),
    }
}

/// Computes a logarithm; returns an error for 0.
fn logarithm(function: Unary, x: FLOAT) -> Outcome {
    if x == 0.0 {
        return failed(
            "the logarithm of 0 is minus infinity\nkeep what it is taken of above 0, as max(x, 0.001)",
        );
    }
    finite(function(x))
}

fn sign(value: &Dynamic) -> Outcome {
    let number = argument("sign", value)?;
    Ok(Dynamic::from_int(INT::from(number > 0.0) - INT::from(number < 0.0)))
}

fn abs(value: &Dynamic) -> Outcome {
    if let Some(whole) = value.as_int().ok().and_then(INT::checked_abs) {
        return Ok(Dynamic::from_int(whole));
    }
    finite(argument("abs", value)?.abs())
}

/// Returns the best of the values, the first one among equals.
fn extreme(name: &'static str, values: &[Dynamic], better: fn(FLOAT, FLOAT) -> bool) -> Outcome {
    budget::add(values.len());
    let mut best: Option<(FLOAT, &Dynamic)> = None;
    for value in values {
        let number = argument(name, value)?;
        if best.is_none_or(|(best, _)| better(number, best)) {
            best = Some((number, value));
        }
    }
    match best {
        Some((_, value)) => Ok(value.clone()),
        None => failed(format!("`{name}` of an empty list")),
    }
}

fn register_extreme(engine: &mut Engine, name: &'static str, better: fn(FLOAT, FLOAT) -> bool) {
    engine.register_fn(name, move |list: Dynamic| match list.as_array_ref() {
        Ok(values) => extreme(name, &values, better),
        Err(_) => failed(format!("`{name}` takes several numbers, or a list of them")),
    });
    engine.register_fn(name, move |a: Dynamic, b: Dynamic| extreme(name, &[a, b], better));
    engine.register_fn(name, move |a: Dynamic, b: Dynamic, c: Dynamic| extreme(name, &[a, b, c], better));
    engine.register_fn(name, move |a: Dynamic, b: Dynamic, c: Dynamic, d: Dynamic| {
        extreme(name, &[a, b, c, d], better)
    });
}

pub(super) fn register(engine: &mut Engine) {
    for (name, function) in UNARY {
        engine.register_fn(name, move |x: Dynamic| finite(function(argument(name, &x)?)));
    }
    for (name, function) in LOGARITHMS {
        engine.register_fn(name, move |x: Dynamic| logarithm(function, argument(name, &x)?));
    }
    for (name, function) in ROUNDING {
        engine.register_fn(name, move |x: Dynamic| -> Outcome { Ok(whole(function(argument(name, &x)?))) });
    }
    for (name, function) in BINARY {
        engine.register_fn(name, move |x: Dynamic, y: Dynamic| {
            finite(function(argument(name, &x)?, argument(name, &y)?))
        });
    }
    engine.register_fn("pow", |x: Dynamic, y: Dynamic| power(argument("pow", &x)?, argument("pow", &y)?));
    engine.register_fn("mod", |x: Dynamic, y: Dynamic| modulo(argument("mod", &x)?, argument("mod", &y)?));
    engine.register_fn("abs", |x: Dynamic| abs(&x));
    engine.register_fn("sign", |x: Dynamic| sign(&x));
    engine.register_fn("clamp", |x: Dynamic, low: Dynamic, high: Dynamic| {
        clamp(argument("clamp", &x)?, argument("clamp", &low)?, argument("clamp", &high)?)
    });
    engine.register_fn("smoothstep", |low: Dynamic, high: Dynamic, x: Dynamic| {
        let argument = |value| argument("smoothstep", value);
        smoothstep(argument(&low)?, argument(&high)?, argument(&x)?)
    });
    engine.register_fn("mix", |from: Dynamic, to: Dynamic, share: Dynamic| {
        mix(&from, &to, argument("mix", &share)?)
    });
    register_extreme(engine, "min", |value, best| value < best);
    register_extreme(engine, "max", |value, best| value > best);
    let mut constants = Module::new();
    for (name, value) in CONSTANTS {
        constants.set_var(name, value);
    }
    engine.register_global_module(constants.into());
}
