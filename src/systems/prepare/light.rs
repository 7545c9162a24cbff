//! Lights in world space.

use std::f64::consts::PI;

use super::settings::sane;
use super::shape::towards_one;
use crate::components::{AreaShape, Falloff, Light, LightKind, WorldTransform};
use crate::trace::{self, Cone, LightSource, Slot};

pub(super) fn prepared_light(
    light: &Light,
    transform: &WorldTransform,
    own_shape: Option<Slot>,
) -> Option<trace::Light> {
    let center = transform.affine.translation;
    let source = match light.kind {
        LightKind::Point => LightSource::Point(center),
        LightKind::Area { shape, .. } => prepared_area(shape, transform)?,
        LightKind::Spot { angle, softness } => {
            LightSource::Spot(center, prepared_cone(angle, softness, transform)?)
        }
        LightKind::Directional { direction } => {
            LightSource::Towards(-transform.affine.transform_vector3(direction))
        }
    };
    let place = match source {
        LightSource::Towards(direction) => direction,
        _ => center,
    };
    let falloff = match light.falloff {
        None => None,
        Some(_) if matches!(source, LightSource::Towards(_)) => None,
        Some(falloff) => Some(prepared_falloff(falloff)?),
    };
    place.is_finite().then_some(trace::Light {
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

/// What shines of an area light. `None` where that is not a finite size.
fn prepared_area(shape: AreaShape, transform: &WorldTransform) -> Option<LightSource> {
    let (center, linear) = (transform.affine.translation, transform.affine.matrix3);
    match shape {
        AreaShape::Sphere { radius } => {
            let scale = transform.uniform_scale.unwrap_or_else(|| libm::cbrt(linear.determinant().abs()));
            let radius = radius * scale;
            (0.0..=f64::MAX).contains(&radius).then_some(LightSource::Ball { center, radius })
        }
        AreaShape::Rectangle { width, height } => {
            let halves = [linear.x_axis * (0.5 * width), linear.y_axis * (0.5 * height)];
            halves.iter().all(|half| half.is_finite()).then_some(LightSource::Panel { center, halves })
        }
    }
}

/// The cone about +z as the transform turns it. `None` where it is none.
fn prepared_cone(angle: f64, softness: f64, transform: &WorldTransform) -> Option<Cone> {
    let forward = transform.affine.matrix3.z_axis;
    let axis = (forward * towards_one(forward.abs().max_element())).try_normalize()?;
    let half = 0.5 * angle.min(PI);
    let sane = half > 0.0 && (0.0..=1.0).contains(&softness);
    sane.then(|| Cone { axis, inner: libm::cos((1.0 - softness) * half), outer: libm::cos(half) })
}

/// `None` where it is none: a light must not brighten without bounds.
fn prepared_falloff(falloff: Falloff) -> Option<trace::Falloff> {
    let Falloff { constant, linear, quadratic } = falloff;
    let sane = [constant, linear, quadratic].iter().all(|part| (0.0..=f64::MAX).contains(part));
    (sane && constant > 0.0).then_some(trace::Falloff { constant, linear, quadratic })
}
