//! Lights in world space.

use std::f64::consts::PI;

use super::settings::sane;
use super::shape::towards_one;
use crate::components::{AreaShape, Falloff, Light, LightKind, Quantity, ValidRange, WorldTransform};
use crate::systems::FaultCause;
use crate::trace::{self, Cone, LightSource, ShapeId};

/// Returns a light in world space, or the cause for which it gives no light.
pub(super) fn prepared_light(
    light: &Light,
    transform: &WorldTransform,
    own_shape: Option<ShapeId>,
) -> Result<trace::PreparedLight, FaultCause> {
    let center = transform.affine.translation;
    let source = match light.kind {
        LightKind::Point => LightSource::Point(center),
        LightKind::Area { shape, .. } => prepared_area(shape, transform)?,
        LightKind::Spot { angle, softness } => {
            LightSource::Spot(center, prepared_cone(angle, softness, transform)?)
        }
        LightKind::Directional { direction } => {
            LightSource::Directional(-transform.affine.transform_vector3(direction))
        }
    };
    match source {
        LightSource::Directional(direction) if !direction.is_finite() => {
            return Err(FaultCause::NotFinite("direction"));
        }
        LightSource::Directional(_) => {}
        _ if !center.is_finite() => return Err(FaultCause::NotFinite("transform")),
        _ => {}
    }
    let falloff = match light.falloff {
        None => None,
        Some(_) if matches!(source, LightSource::Directional(_)) => None,
        Some(falloff) => Some(prepared_falloff(falloff)?),
    };
    Ok(trace::PreparedLight {
        source,
        intensity: sane(light.intensity),
        falloff,
        samples: match light.kind {
            LightKind::Area { samples, .. } => samples.clamp(1, AreaShape::LARGEST_SAMPLES),
            _ => 1,
        },
        casts_shadows: light.casts_shadows,
        own_shape,
    })
}

/// Returns the surface of an area light in world space.
fn prepared_area(shape: AreaShape, transform: &WorldTransform) -> Result<LightSource, FaultCause> {
    let (center, linear) = (transform.affine.translation, transform.affine.matrix3);
    match shape {
        AreaShape::Sphere { radius } => {
            let scale = transform.uniform_scale.unwrap_or_else(|| libm::cbrt(linear.determinant().abs()));
            let radius = radius * scale;
            let sized = (0.0..=f64::MAX).contains(&radius);
            sized.then_some(LightSource::Sphere { center, radius }).ok_or(out_of_size("radius", radius))
        }
        AreaShape::Rectangle { width, height } => {
            let halves = [linear.x_axis * (0.5 * width), linear.y_axis * (0.5 * height)];
            match halves.iter().find(|half| !half.is_finite()) {
                None => Ok(LightSource::Rectangle { center, halves }),
                Some(_) => Err(FaultCause::NotFinite("size in the world")),
            }
        }
    }
}

fn out_of_size(what: &'static str, value: f64) -> FaultCause {
    FaultCause::OutOfRange { what, error: ValidRange::NotNegative.violated_by(value) }
}

/// Returns the cone of a spot light, about the own +z axis as rotated by the transform.
fn prepared_cone(angle: f64, softness: f64, transform: &WorldTransform) -> Result<Cone, FaultCause> {
    let forward = transform.affine.matrix3.z_axis;
    let axis = (forward * towards_one(forward.abs().max_element())).try_normalize();
    let axis = axis.ok_or(FaultCause::NoDirection("own z axis"))?;
    if angle.is_nan() || angle <= 0.0 {
        return Err(FaultCause::OutOfRange {
            what: "angle",
            error: ValidRange::SpotAngle.violated_by(angle),
        });
    }
    Quantity::Softness.check(softness).map_err(|error| FaultCause::OutOfRange { what: "softness", error })?;
    let half = 0.5 * angle.min(PI);
    Ok(Cone { axis, inner: libm::cos((1.0 - softness) * half), outer: libm::cos(half) })
}

/// Returns a falloff that keeps the intensity bounded: its constant must be greater than 0.
fn prepared_falloff(falloff: Falloff) -> Result<trace::PreparedFalloff, FaultCause> {
    let Falloff { constant, linear, quadratic } = falloff;
    for part in [constant, linear, quadratic] {
        if !(0.0..=f64::MAX).contains(&part) {
            return Err(out_of_size("falloff", part));
        }
    }
    if constant == 0.0 {
        let error = ValidRange::Positive.violated_by(constant);
        return Err(FaultCause::OutOfRange { what: "constant of its falloff", error });
    }
    Ok(trace::PreparedFalloff { constant, linear, quadratic })
}
