//! Functions of lists, and of lists of numbers as vectors.

use rhai::{Array, Dynamic, Engine, EvalAltResult, FLOAT, INT, ImmutableString, Map};

use super::arithmetic::equal;
use super::dynamic::kind;
use super::maths::argument;
use super::result::{Outcome, failed, finite};
use super::{budget, limits};

/// Returns the elements of a list of numbers.
fn numbers(function: &str, value: &Dynamic) -> Result<Vec<FLOAT>, Box<EvalAltResult>> {
    match value.as_array_ref() {
        Ok(list) => {
            budget::add(list.len());
            list.iter().map(|part| argument(function, part)).collect()
        }
        Err(_) => failed(format!("`{function}` takes a list of numbers, not {}", kind(value))),
    }
}

fn pair(
    function: &str,
    left: &Dynamic,
    right: &Dynamic,
) -> Result<(Vec<FLOAT>, Vec<FLOAT>), Box<EvalAltResult>> {
    let (left, right) = (numbers(function, left)?, numbers(function, right)?);
    if left.len() == right.len() {
        return Ok((left, right));
    }
    failed(format!(
        "`{function}` takes two lists of the same length, not of {} and {}",
        left.len(),
        right.len()
    ))
}

fn norm(parts: &[FLOAT]) -> FLOAT {
    parts.iter().fold(0.0, |length, part| libm::hypot(length, *part))
}

fn length(list: &Dynamic) -> Outcome {
    finite(norm(&numbers("length", list)?))
}

fn distance(left: &Dynamic, right: &Dynamic) -> Outcome {
    let (left, right) = pair("distance", left, right)?;
    finite(norm(&left.iter().zip(&right).map(|(left, right)| right - left).collect::<Vec<_>>()))
}

fn dot(left: &Dynamic, right: &Dynamic) -> Outcome {
    let (left, right) = pair("dot", left, right)?;
    finite(left.iter().zip(&right).map(|(left, right)| left * right).sum())
}

fn normalize(list: &Dynamic) -> Outcome {
    let parts = numbers("normalize", list)?;
    let length = norm(&parts);
    if !length.is_finite() {
        return finite(length);
    }
    if length == 0.0 {
        return failed("a vector of length 0 has no direction\n`normalize` needs another vector");
    }
    Ok(Dynamic::from_array(parts.iter().map(|part| finite(part / length)).collect::<Result<_, _>>()?))
}

fn cross(left: &Dynamic, right: &Dynamic) -> Outcome {
    let (Ok([a, b, c]), Ok([x, y, z])) =
        (<[FLOAT; 3]>::try_from(numbers("cross", left)?), <[FLOAT; 3]>::try_from(numbers("cross", right)?))
    else {
        return failed("`cross` takes two lists of three numbers");
    };
    let parts = [b * z - c * y, c * x - a * z, a * y - b * x];
    Ok(Dynamic::from_array(parts.into_iter().map(finite).collect::<Result<_, _>>()?))
}

fn sum(list: &Dynamic) -> Outcome {
    finite(numbers("sum", list)?.iter().sum())
}

/// The numbers `from + i step` for i = 0, 1, 2, ..., up to `to`, exclusive.
#[derive(Clone, Debug)]
struct NumberRange {
    from: FLOAT,
    to: FLOAT,
    step: FLOAT,
    count: u32,
}

impl NumberRange {
    fn between(from: &Dynamic, to: &Dynamic, step: FLOAT) -> Result<Self, Box<EvalAltResult>> {
        if step == 0.0 {
            return failed(
                "the step of `range` is 0\nwrite one that leads from the first number to the last",
            );
        }
        Ok(Self { from: argument("range", from)?, to: argument("range", to)?, step, count: 0 })
    }
}

impl Iterator for NumberRange {
    type Item = FLOAT;

    fn next(&mut self) -> Option<FLOAT> {
        let next = self.from + FLOAT::from(self.count) * self.step;
        self.count = self.count.checked_add(1)?;
        let is_before = if self.step > 0.0 { next < self.to } else { next > self.to };
        is_before.then_some(next)
    }
}

/// Registers ranges of numbers that need not be integers.
fn register_range(engine: &mut Engine) {
    engine.register_iterator::<NumberRange>();
    engine.register_fn("range", |from: Dynamic, to: Dynamic| NumberRange::between(&from, &to, 1.0));
    engine.register_fn("range", |from: Dynamic, to: Dynamic, step: Dynamic| {
        NumberRange::between(&from, &to, argument("range", &step)?)
    });
    engine.register_fn("range", |from: FLOAT, to: FLOAT| {
        NumberRange::between(&Dynamic::from_float(from), &Dynamic::from_float(to), 1.0)
    });
    engine.register_fn("range", |from: FLOAT, to: FLOAT, step: FLOAT| {
        NumberRange::between(&Dynamic::from_float(from), &Dynamic::from_float(to), step)
    });
}

fn room<T>(length: usize, result: T) -> Result<T, Box<EvalAltResult>> {
    if length > limits::LIST {
        return failed(format!("a list has at most {} values", limits::LIST));
    }
    Ok(result)
}

#[expect(clippy::cast_possible_wrap, reason = "lengths are limited")]
pub(super) fn register(engine: &mut Engine) {
    register_range(engine);
    engine.register_fn("length", |list: Dynamic| length(&list));
    engine.register_fn("normalize", |list: Dynamic| normalize(&list));
    engine.register_fn("distance", |left: Dynamic, right: Dynamic| distance(&left, &right));
    engine.register_fn("dot", |left: Dynamic, right: Dynamic| dot(&left, &right));
    engine.register_fn("cross", |left: Dynamic, right: Dynamic| cross(&left, &right));
    engine.register_fn("sum", |list: Dynamic| sum(&list));
    engine.register_fn("len", |list: &mut Array| list.len() as INT);
    engine.register_fn("len", |map: &mut Map| map.len() as INT);
    engine.register_fn("len", |text: ImmutableString| {
        budget::add_text(text.len());
        text.chars().count() as INT
    });
    engine.register_fn("push", |list: &mut Array, value: Dynamic| -> Result<(), Box<EvalAltResult>> {
        room(list.len() + 1, ())?;
        list.push(value);
        Ok(())
    });
    engine.register_fn("pop", |list: &mut Array| list.pop().map_or_else(|| failed("the list is empty"), Ok));
    engine.register_fn("append", |mut left: Array, right: Array| {
        left.extend(right);
        budget::add(left.len());
        room(left.len(), left)
    });
    engine.register_fn("reverse", |mut list: Array| {
        budget::add(list.len());
        list.reverse();
        list
    });
    engine.register_fn("contains", |list: &mut Array, value: Dynamic| {
        budget::add(list.len());
        list.iter().any(|part| equal(part, &value))
    });
    engine.register_fn("contains", |map: &mut Map, name: ImmutableString| map.contains_key(name.as_str()));
    engine.register_fn("contains", |text: ImmutableString, part: ImmutableString| {
        budget::add_text(text.len() + part.len());
        text.contains(part.as_str())
    });
    engine.register_fn("keys", |map: &mut Map| -> Array {
        budget::add(map.len());
        map.keys().map(|name| Dynamic::from(ImmutableString::from(name.as_str()))).collect()
    });
}
