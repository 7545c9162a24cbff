//! Rejects values from scripts that are invalid in scene files too. Light, colours and coefficients are not rejected but clamped to their
//! ranges.

use glam::DVec3;

use crate::animation::limits::SMALLEST;
use crate::animation::{Notation, Value};
use crate::components::{Property, Quantity};

/// Returns an error message and a remedy if the value is invalid.
pub(super) fn refusal(property: Property, value: Value) -> Option<(String, &'static str)> {
    match value {
        Value::Number(number) => refused_number(property.quantity(), number),
        Value::Vector(vector) => refused_vector(property.quantity(), vector),
        Value::Rotation(_) | Value::Color(_) => None,
    }
}

/// The result of a check: true if the number is valid, the requirement, and the remedy.
type Expected = (bool, String, &'static str);

fn refused_number(quantity: Quantity, number: f64) -> Option<(String, &'static str)> {
    let range = quantity.range();
    let (good, expected, help) = match quantity {
        Quantity::Length => length("a length", number),
        Quantity::Aperture => nothing_negative("the lens's aperture", number),
        Quantity::Density => nothing_negative("the density of the fog", number),
        Quantity::RefractiveIndex => {
            let expected = format!("ior must be from {} to {}", range.start(), range.end());
            (range.contains(&number), expected, "1.33 is water, 1.5 glass")
        }
        Quantity::SpotAngle => {
            let expected = "the angle of a spot light must be above 0, at most 180 degrees".to_owned();
            (number > 0.0 && number <= *range.end(), expected, "clamp(x, 0.1, 180) keeps it there")
        }
        Quantity::FieldOfView => {
            let expected = "the field of view must be between 0 and 180 degrees".to_owned();
            (number > 0.0 && number <= *range.end(), expected, "clamp(x, 1, 179) keeps it there")
        }
        _ => return None,
    };
    let shown = match quantity.notation() {
        Notation::Degrees => in_degrees(number),
        _ => number,
    };
    (!good).then(|| (format!("{expected}, not {}", figure(shown)), help))
}

fn refused_vector(quantity: Quantity, vector: DVec3) -> Option<(String, &'static str)> {
    let parts = vector.to_array();
    let is_nothing = |part: &f64| part.abs() < SMALLEST;
    match quantity {
        Quantity::Edges => parts.into_iter().find_map(|edge| {
            let (good, expected, help) = length("every edge of a box", edge);
            (!good).then(|| (format!("{expected}, not {}", figure(edge)), help))
        }),
        Quantity::Factors => parts.iter().any(is_nothing).then(|| {
            let help = "give a factor other than 0; max(x, 0.001) keeps it above 0";
            ("a scale of 0 leaves nothing".to_owned(), help)
        }),
        Quantity::Direction => parts.iter().all(is_nothing).then(|| {
            let help = "give a vector of any length but 0, as [0, 1, 0]";
            ("a vector of length 0 has no direction".to_owned(), help)
        }),
        Quantity::Falloff => parts.into_iter().enumerate().find_map(|(index, part)| {
            let what = format!("c{index} of a falloff");
            let (good, expected, _) =
                if index == 0 { length(&what, part) } else { nothing_negative(&what, part) };
            let help = "1 / (c0 + c1 d + c2 d^2) of the light is left at distance d; [1, 0, 0] never weakens";
            (!good).then(|| (format!("{expected}, not {}", figure(part)), help))
        }),
        _ => None,
    }
}

fn length(what: &str, number: f64) -> Expected {
    let least = if number > 0.0 { format!("at least {SMALLEST:e}") } else { "greater than 0".to_owned() };
    (number >= SMALLEST, format!("{what} must be {least}"), "max(x, 0.001) keeps it above 0")
}

fn nothing_negative(what: &str, number: f64) -> Expected {
    (number >= 0.0, format!("{what} must be 0 or more"), "max(x, 0) keeps it from falling below")
}

/// Formats a number, with an exponent if it is very large or very small.
fn figure(number: f64) -> String {
    let plain = number == 0.0 || (1e-6..1e9).contains(&number.abs());
    if plain { number.to_string() } else { format!("{number:e}") }
}

/// Converts radians to degrees, without the rounding error of the conversion to radians.
fn in_degrees(radians: f64) -> f64 {
    const DIGITS: f64 = 1e9;
    libm::round(radians.to_degrees() * DIGITS) / DIGITS
}
