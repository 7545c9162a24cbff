//! Local shading: the light from a surface point back along the ray that hit it. It is the ambient term and the emission, plus a diffuse and
//! a specular term for each light. Secondary rays add mirrored and refracted light.

use glam::DVec3;

use crate::color::{Rgb, to_f32};
use crate::trace::effects::Effects;
use crate::trace::math::{Real, add, dot, pow};
use crate::trace::scene::{LightSource, PreparedLight, PreparedScene, SurfaceMaterial};

/// Computes the ambient term, C_a = k_a c I_a.
#[inline]
pub(crate) fn ambient(scene: &PreparedScene, color: Rgb) -> Rgb {
    color * scene.ambient
}

/// Returns the light that a surface gives off.
#[inline]
pub(crate) fn emission(effects: Effects, material: &SurfaceMaterial) -> Rgb {
    if effects.extras { material.emission } else { Rgb::ZERO }
}

/// Clamps light that exceeds the finite numbers to the largest one.
#[inline]
pub(crate) fn clamped(light: Rgb) -> Rgb {
    if light.x + light.y + light.z < f32::INFINITY { light } else { light.min(Rgb::splat(f32::MAX)) }
}

/// Computes I_j, the intensity of a light in this direction and at this distance. `length` is the length of `to_light`, and `limit` is the
/// light's `t` along it.
#[inline(always)]
pub(crate) fn intensity(
    effects: Effects,
    light: &PreparedLight,
    to_light: DVec3,
    length: f64,
    limit: f64,
) -> Rgb {
    let mut intensity = light.intensity;
    if effects.extras {
        if let LightSource::Spot(_, cone) = &light.source {
            intensity = dimmed(intensity, cone.at(-cone.axis.dot(to_light) / length));
        }
        if let Some(falloff) = &light.falloff {
            intensity = dimmed(intensity, falloff.at(length * limit));
        }
    }
    intensity
}

/// Scales an intensity, clamped to `f32::MAX`.
fn dimmed(intensity: Rgb, share: f64) -> Rgb {
    (intensity * to_f32(share.min(f64::from(f32::MAX)))).min(Rgb::splat(f32::MAX))
}

/// Computes the diffuse term, k_d c I_j (N.L_j).
#[inline]
pub(crate) fn diffuse(color: Rgb, intensity: Rgb, cosine: f64) -> Rgb {
    color * intensity * to_f32(cosine)
}

/// Computes the specular term, k_s I_j (N.H_j)^shininess, with the [`half_cosine`] N.H_j; of metals, in their colour.
pub(crate) fn specular(material: &SurfaceMaterial, intensity: Rgb, half_cosine: f64) -> Rgb {
    intensity * highlight(material, half_cosine) * material.tint.unwrap_or(Rgb::ONE)
}

/// Computes k_s (N.H)^shininess.
#[inline]
pub(crate) fn highlight(material: &SurfaceMaterial, half_cosine: f64) -> f32 {
    material.specular * to_f32(pow(half_cosine, f64::from(material.shininess)))
}

/// Computes max(0, N.H), at most 1, for the half vector H between two directions of any length except zero.
#[inline(always)]
pub(super) fn half_cosine<R: Real>(normal: [R; 3], to_light: [R; 3], back: [R; 3]) -> R {
    let between = add(over(to_light, length(to_light)), over(back, length(back)));
    let cosine = dot(normal, between) / length(between);
    let (zero, one) = (cosine.of(0.0), cosine.of(1.0));
    // Opposite directions have no half vector: the cosine is then NaN, which becomes 0.
    R::pick(cosine.greater(zero), cosine.if_less(one, cosine, one), zero)
}

#[inline(always)]
pub(super) fn length<R: Real>(vector: [R; 3]) -> R {
    dot(vector, vector).sqrt()
}

#[inline(always)]
pub(super) fn over<R: Real>([x, y, z]: [R; 3], divisor: R) -> [R; 3] {
    [x / divisor, y / divisor, z / divisor]
}
