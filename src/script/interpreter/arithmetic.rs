//! Arithmetic operators. Integers and floating-point numbers mix: two integers give an integer if the result is integral and fits, except
//! that `/` is always real division. Operators apply element by element to two lists of the same length, and to a list and a number.

use rhai::{Dynamic, Engine, EvalAltResult, FLOAT, INT, ImmutableString};

use super::budget::ValueSize;
use super::dynamic::kind;
use super::result::{Outcome, failed, finite, number};
use super::{budget, limits, maths};

#[derive(Clone, Copy)]
enum Operator {
    Add,
    Subtract,
    Multiply,
    Divide,
    Remainder,
    Power,
}

impl Operator {
    const ALL: [Self; 6] =
        [Self::Add, Self::Subtract, Self::Multiply, Self::Divide, Self::Remainder, Self::Power];

    fn symbol(self) -> &'static str {
        match self {
            Self::Add => "+",
            Self::Subtract => "-",
            Self::Multiply => "*",
            Self::Divide => "/",
            Self::Remainder => "%",
            Self::Power => "**",
        }
    }

    fn apply(self, left: &Dynamic, right: &Dynamic) -> Outcome {
        if let (Ok(left), Ok(right)) = (left.as_int(), right.as_int())
            && let Some(whole) = self.whole(left, right)
        {
            return Ok(Dynamic::from_int(whole));
        }
        if let (Some(left), Some(right)) = (number(left), number(right)) {
            return self.numbers(left, right);
        }
        if matches!(self, Self::Add) && (left.is_string() || right.is_string()) {
            return joined(left, right);
        }
        if left.is_array() || right.is_array() {
            return self.parts(left, right);
        }
        self.unfit(left, right)
    }

    /// Returns the integer result for integer operands, if there is one that fits.
    fn whole(self, left: INT, right: INT) -> Option<INT> {
        match self {
            Self::Add => left.checked_add(right),
            Self::Subtract => left.checked_sub(right),
            Self::Multiply => left.checked_mul(right),
            Self::Divide => None,
            Self::Remainder => left.checked_rem(right),
            Self::Power => left.checked_pow(u32::try_from(right).ok()?),
        }
    }

    fn numbers(self, left: FLOAT, right: FLOAT) -> Outcome {
        match self {
            Self::Add => finite(left + right),
            Self::Subtract => finite(left - right),
            Self::Multiply => finite(left * right),
            Self::Divide | Self::Remainder if right == 0.0 => {
                failed(format!("division by zero\n{left} is divided by something that is 0 here"))
            }
            Self::Divide => finite(left / right),
            Self::Remainder => finite(left % right),
            Self::Power => maths::power(left, right),
        }
    }

    /// Applies the operator element by element to two lists, or to a list and a number.
    fn parts(self, left: &Dynamic, right: &Dynamic) -> Outcome {
        let numbers = |value: &Dynamic| number(value).is_some();
        let lists = (left.as_array_ref(), right.as_array_ref());
        budget::add(lists.0.as_ref().or(lists.1.as_ref()).map_or(0, |list| list.len()));
        let parts: Vec<Dynamic> = match lists {
            (Ok(left), Ok(right)) if left.len() == right.len() => left
                .iter()
                .zip(&*right)
                .map(|(left, right)| self.apply(left, right))
                .collect::<Result<_, _>>()?,
            (Ok(left), Ok(right)) => {
                let (left, right) = (left.len(), right.len());
                return failed(format!(
                    "`{}` of a list of {left} and a list of {right} values\nboth must have the same length; `append(a, b)` makes one list of two",
                    self.symbol()
                ));
            }
            (Ok(left), Err(_)) if numbers(right) => {
                left.iter().map(|part| self.apply(part, right)).collect::<Result<_, _>>()?
            }
            (Err(_), Ok(right)) if numbers(left) => {
                right.iter().map(|part| self.apply(left, part)).collect::<Result<_, _>>()?
            }
            _ => return self.unfit(left, right),
        };
        Ok(Dynamic::from_array(parts))
    }

    fn unfit(self, left: &Dynamic, right: &Dynamic) -> Outcome {
        failed(format!("`{}` does not take {} and {}", self.symbol(), kind(left), kind(right)))
    }
}

/// Concatenates two strings, or a string with a number or a Boolean.
fn joined(left: &Dynamic, right: &Dynamic) -> Outcome {
    let text = format!("{}{}", text_of(left)?, text_of(right)?);
    if text.len() > limits::TEXT {
        return failed(format!("this text is longer than {} bytes", limits::TEXT));
    }
    budget::add_text(text.len());
    Ok(ImmutableString::from(text).into())
}

fn text_of(value: &Dynamic) -> Result<String, Box<EvalAltResult>> {
    if let Ok(text) = value.as_immutable_string_ref() {
        return Ok(text.to_string());
    }
    if let Ok(whole) = value.as_int() {
        return Ok(whole.to_string());
    }
    match (value.as_float(), value.as_bool()) {
        (Ok(number), _) => Ok(number.to_string()),
        (_, Ok(flag)) => Ok(flag.to_string()),
        _ => failed(format!("`+` does not join a text and {}", kind(value))),
    }
}

fn negative(value: &Dynamic) -> Outcome {
    if let Some(whole) = value.as_int().ok().and_then(INT::checked_neg) {
        return Ok(Dynamic::from_int(whole));
    }
    if let Some(number) = number(value) {
        return Ok(Dynamic::from_float(-number));
    }
    match value.as_array_ref() {
        Ok(parts) => {
            budget::add(parts.len());
            Ok(Dynamic::from_array(parts.iter().map(negative).collect::<Result<_, _>>()?))
        }
        Err(_) => failed(format!("`-` does not take {}", kind(value))),
    }
}

/// Compares numbers by value, lists and maps recursively, and strings, Booleans and `()` by type and value. Values of other types are
/// unequal.
pub(super) fn equal(left: &Dynamic, right: &Dynamic) -> bool {
    if let (Ok(left), Ok(right)) = (left.as_int(), right.as_int()) {
        return left == right;
    }
    if let (Some(left), Some(right)) = (number(left), number(right)) {
        return left == right;
    }
    if let (Ok(left), Ok(right)) = (left.as_array_ref(), right.as_array_ref()) {
        budget::add(left.len());
        return left.len() == right.len() && left.iter().zip(&*right).all(|(left, right)| equal(left, right));
    }
    if let (Ok(left), Ok(right)) = (left.as_map_ref(), right.as_map_ref()) {
        budget::add(left.len());
        let same = |((a, left), (b, right)): ((&_, &Dynamic), (&_, &Dynamic))| a == b && equal(left, right);
        return left.len() == right.len() && left.iter().zip(right.iter()).all(same);
    }
    if let (Ok(left), Ok(right)) = (left.as_immutable_string_ref(), right.as_immutable_string_ref()) {
        budget::add_text(left.len());
        return *left == *right;
    }
    if let (Ok(left), Ok(right)) = (left.as_char(), right.as_char()) {
        return left == right;
    }
    match (left.as_bool(), right.as_bool()) {
        (Ok(left), Ok(right)) => left == right,
        _ => left.is_unit() && right.is_unit(),
    }
}

pub(super) fn register(engine: &mut Engine) {
    for operator in Operator::ALL {
        let symbol = operator.symbol();
        engine.register_fn(symbol, move |left: Dynamic, right: Dynamic| operator.apply(&left, &right));
        engine.register_fn(
            format!("{symbol}="),
            move |left: &mut Dynamic, right: Dynamic| -> Result<(), Box<EvalAltResult>> {
                *left = operator.apply(left, &right)?;
                Ok(())
            },
        );
    }
    engine.register_fn("-", |value: Dynamic| negative(&value));
    engine.register_fn("+", |value: Dynamic| {
        if number(&value).is_some() {
            Ok(value)
        } else {
            failed(format!("`+` does not take {}", kind(&value)))
        }
    });
    // Called by string interpolation.
    engine.register_fn("to_string", |number: FLOAT| number.to_string());
    engine.register_fn("to_string", |value: &mut Dynamic| {
        budget::add(ValueSize::of(value).writing());
        value.to_string()
    });
    engine.register_fn("!", |flag: bool| !flag);
    engine.register_fn("==", |left: Dynamic, right: Dynamic| equal(&left, &right));
    engine.register_fn("!=", |left: Dynamic, right: Dynamic| !equal(&left, &right));
}
