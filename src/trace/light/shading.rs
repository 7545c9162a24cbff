//! The light that a surface point sends towards the ray that found it: ambient plus, light by light, diffuse and specular.
//! Reflected and refracted light is added by the rays themselves.

use glam::DVec3;

use crate::color::{Rgb, to_f32};
use crate::trace::effects::Effects;
use crate::trace::math::pow;
use crate::trace::scene::{Light, LightSource, PreparedScene, SurfaceMaterial};

/// C_a = k_a c I_a.
#[inline]
pub(crate) fn ambient(scene: &PreparedScene, color: Rgb) -> Rgb {
    color * scene.ambient
}

/// Light that is too much for a number, held to the largest one.
#[inline]
pub(crate) fn held(light: Rgb) -> Rgb {
    if light.x + light.y + light.z < f32::INFINITY { light } else { light.min(Rgb::splat(f32::MAX)) }
}

/// I_j: what is left of a light's intensity in this direction, at this distance.
#[inline(always)]
pub(crate) fn intensity(effects: Effects, light: &Light, to_light: DVec3, length: f64, limit: f64) -> Rgb {
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

/// Some times the intensity, never more than a number can hold.
fn dimmed(intensity: Rgb, share: f64) -> Rgb {
    (intensity * to_f32(share.min(f64::from(f32::MAX)))).min(Rgb::splat(f32::MAX))
}

/// k_d c I_j (N.L_j).
#[inline]
pub(crate) fn diffuse(color: Rgb, intensity: Rgb, cosine: f64) -> Rgb {
    color * intensity * to_f32(cosine)
}

/// k_s I_j (N.H_j)^shininess, for directions to the light and back along the ray of any length but zero.
pub(crate) fn specular(
    material: &SurfaceMaterial,
    intensity: Rgb,
    normal: DVec3,
    to_light: DVec3,
    back: DVec3,
) -> Rgb {
    let highlight = pow(half_cosine(normal, to_light, back), f64::from(material.shininess));
    intensity * (material.specular * to_f32(highlight))
}

/// max(0, N.H), at most 1, for the half vector H between two directions of any length but zero.
fn half_cosine(normal: DVec3, to_light: DVec3, back: DVec3) -> f64 {
    let between = to_light / length(to_light) + back / length(back);
    let cosine = normal.dot(between) / length(between);
    // Opposite directions have nothing between them.
    if cosine > 0.0 { cosine.min(1.0) } else { 0.0 }
}

pub(crate) fn length(vector: DVec3) -> f64 {
    vector.dot(vector).sqrt()
}
