//! Validation of lights.

use super::{At, Problems, check};
use crate::components::{AreaShape, Quantity};
use crate::scene::document::{AreaShapeDocument, LightDocument, Triple};
use crate::scene::quote::Figure;

pub(super) fn validate(light: &LightDocument, at: &At<'_>, problems: &mut Problems) {
    match *light {
        LightDocument::Point { intensity, falloff, .. } => {
            check::intensity(intensity, "the intensity", &at.field("intensity"), problems);
            if let Some(coefficients) = falloff {
                self::falloff(coefficients, &at.field("falloff"), problems);
            }
        }
        LightDocument::Spot { intensity, angle, softness, falloff, .. } => {
            check::intensity(intensity, "the intensity", &at.field("intensity"), problems);
            self::angle(angle, &at.field("angle"), problems);
            self::softness(softness, &at.field("softness"), problems);
            if let Some(coefficients) = falloff {
                self::falloff(coefficients, &at.field("falloff"), problems);
            }
        }
        LightDocument::Directional { intensity, direction, falloff, .. } => {
            if falloff.is_some() {
                problems.add(
                    &at.field("falloff"),
                    "a directional light cannot weaken with distance",
                    "it is infinitely far away",
                    "remove `falloff`, or make it a Point, Spot or Area light",
                );
            }
            check::intensity(intensity, "the intensity", &at.field("intensity"), problems);
            check::direction(direction, "the direction", &at.field("direction"), problems);
        }
        LightDocument::Area { shape, intensity, samples, falloff, .. } => {
            area_shape(shape, &at.field("shape"), problems);
            check::intensity(intensity, "the intensity", &at.field("intensity"), problems);
            let help = "1 is a single point, 16 gives soft shadows";
            let most = AreaShape::LARGEST_SAMPLES;
            check::count(samples, most, "samples", help, &at.field("samples"), problems);
            if let Some(coefficients) = falloff {
                self::falloff(coefficients, &at.field("falloff"), problems);
            }
        }
    }
}

pub(super) fn angle(angle: f64, at: &At<'_>, problems: &mut Problems) {
    if !(angle > 0.0 && angle <= 180.0) {
        let angle = Figure(angle);
        let message = format!("the angle of a spot light must be above 0, at most 180 degrees, not {angle}");
        problems.add(at, message, "out of range", "write the angle from rim to rim, as 40");
    }
}

pub(super) fn softness(softness: f64, at: &At<'_>, problems: &mut Problems) {
    if !Quantity::Softness.range().contains(&softness) {
        let message = format!("the softness of a spot light must be from 0 to 1, not {}", Figure(softness));
        let help = "0 is a hard rim, 1 fades all the way from the middle";
        problems.add(at, message, "out of range", help);
    }
}

fn area_shape(shape: AreaShapeDocument, at: &At<'_>, problems: &mut Problems) {
    match shape {
        AreaShapeDocument::Sphere { radius } => {
            check::size(radius, "the radius", &at.field("radius"), problems);
        }
        AreaShapeDocument::Rectangle { width, height } => {
            check::size(width, "the rectangle's width", &at.field("width"), problems);
            check::size(height, "the rectangle's height", &at.field("height"), problems);
        }
    }
}

pub(super) fn falloff(coefficients: Triple, at: &At<'_>, problems: &mut Problems) {
    for (index, value) in coefficients.into_iter().enumerate() {
        let at = at.index(index);
        let help = "1 / (c0 + c1 d + c2 d^2) of the light is left at distance d; (1, 0, 0) never weakens";
        if index == 0 {
            check::positive(value, "c0 of a falloff", help, &at, problems);
        } else if check::number(value, &at, problems) && value < 0.0 {
            let message = format!("c{index} of a falloff must be 0 or more, not {}", Figure(value));
            problems.add(&at, message, "out of range", help);
        }
    }
}
