//! Rejects values from scripts that are invalid in scene files too. Light, colours and coefficients are not rejected but clamped to their
//! ranges.

use glam::DVec3;

use crate::animation::Value;
use crate::animation::limits::SMALLEST;
use crate::components::{Property, Quantity, ValidRange};

/// The remedy for numbers that must be greater than 0.
const POSITIVE_HELP: &str = "max(x, 0.001) keeps it above 0";
/// The remedy for numbers that must be 0 or more.
const NOT_NEGATIVE_HELP: &str = "max(x, 0) keeps it from falling below";

/// Returns an error message and a remedy if the value is invalid.
pub(super) fn value_error(property: Property, value: Value) -> Option<(String, &'static str)> {
    match value {
        Value::Number(number) => number_error(property.quantity(), number),
        Value::Vector(vector) => vector_error(property.quantity(), vector),
        Value::Rotation(_) | Value::Color(_) | Value::Flag(_) => None,
    }
}

fn number_error(quantity: Quantity, number: f64) -> Option<(String, &'static str)> {
    let (what, help) = match quantity {
        Quantity::Length => ("a length", POSITIVE_HELP),
        Quantity::Aperture => ("the lens's aperture", NOT_NEGATIVE_HELP),
        Quantity::Density => ("the fog's density", NOT_NEGATIVE_HELP),
        Quantity::Mortar => ("mortar", NOT_NEGATIVE_HELP),
        Quantity::Contrast => ("contrast", NOT_NEGATIVE_HELP),
        Quantity::RefractiveIndex => ("ior", "1.33 is water, 1.5 glass"),
        Quantity::AngularSize => ("a size in the sky", "clamp(x, 0.1, 180) keeps it there"),
        Quantity::SpotAngle => ("the angle of a spot light", "clamp(x, 0.1, 180) keeps it there"),
        Quantity::FieldOfView => ("the field of view", "clamp(x, 1, 179) keeps it there"),
        _ => return None,
    };
    quantity.check(number).err().map(|error| (format!("{what} {error}"), help))
}

fn vector_error(quantity: Quantity, vector: DVec3) -> Option<(String, &'static str)> {
    let parts = vector.to_array();
    let is_nothing = |part: &f64| part.abs() < SMALLEST;
    match quantity {
        Quantity::Edges => parts.into_iter().find_map(|edge| {
            let error = quantity.check(edge).err()?;
            Some((format!("every edge of a box {error}"), POSITIVE_HELP))
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
            let range = if index == 0 { ValidRange::Positive } else { ValidRange::NotNegative };
            let help = "1 / (c0 + c1 d + c2 d^2) of the light is left at distance d; [1, 0, 0] never weakens";
            range.check(part).err().map(|error| (format!("c{index} of a falloff {error}"), help))
        }),
        _ => None,
    }
}
