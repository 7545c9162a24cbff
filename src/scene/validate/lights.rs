//! Validation of lights.

use super::{At, Problems, check};
use crate::components::{AreaShape, Quantity, ValidRange};
use crate::scene::document::{AreaShapeDocument, LightDocument, Triple};

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
    let (what, help) = ("the angle of a spot light", "write the angle from rim to rim, as 40");
    check::range(angle, Quantity::SpotAngle.range(), what, help, at, problems);
}

pub(super) fn softness(softness: f64, at: &At<'_>, problems: &mut Problems) {
    let help = "0 is a hard rim, 1 fades all the way from the middle";
    let what = "the softness of a spot light";
    check::range(softness, Quantity::Softness.range(), what, help, at, problems);
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
        let range = if index == 0 { ValidRange::Positive } else { ValidRange::NotNegative };
        check::range(value, range, &format!("c{index} of a falloff"), help, &at, problems);
    }
}
