//! The light that a surface point sends towards the ray that found it: ambient plus, light by light, diffuse and specular.
//! Reflected and refracted light is added by the rays themselves.

use glam::DVec3;

use super::effects::Effects;
use super::{Light, LightSource, PreparedScene, Ray, Surface, SurfaceMaterial};
use crate::color::Rgb;

/// A light as it comes to a surface point, unless something stands in its way.
#[derive(Clone, Debug)]
pub(super) struct Incidence {
    /// The shadow ray: towards the light.
    pub(super) ray: Ray,
    /// Where the light is.
    pub(super) limit: f64,
    /// Does it come from the other side, through the clear medium behind the surface?
    pub(super) from_behind: bool,
    /// What it adds, not black.
    pub(super) color: Rgb,
}

/// C_a = k_a c I_a.
pub(super) fn ambient(scene: &PreparedScene, color: Rgb) -> Rgb {
    color * scene.ambient
}

/// How a light comes from one of its places to a surface point; `None` where it could add nothing: it is off, behind what is
/// opaque or at the very point, or shines elsewhere, or the surface scatters none towards where `arrived` came from.
/// `diffuse` is the surface's colour there.
#[inline]
pub(super) fn incidence<E: Effects>(
    scene: &PreparedScene,
    arrived: &Ray,
    surface: &Surface,
    diffuse: Rgb,
    light: &Light,
    place: DVec3,
) -> Option<Incidence> {
    let material = scene.material(surface.hit.slot);
    let full = light.intensity;
    if diffuse * full == Rgb::ZERO && full * material.specular == Rgb::ZERO {
        return None;
    }
    // Normals face the ray that arrived, and so does the side that is left.
    let outward = surface.from_outside;
    let is_towards = matches!(light.source, LightSource::Towards(_));
    let (mut ray, limit) = if is_towards {
        (Ray::leaving(surface, outward, place)?, f64::INFINITY)
    } else {
        Ray::leaving_to(surface, outward, place)?
    };
    let normal = surface.facing_normal();
    let to_light = ray.direction();
    let length_to_light = length(to_light);
    let cosine = normal.dot(to_light) / length_to_light;
    let from_behind = E::CLEAR_SHADOWS && cosine < 0.0 && material.refraction.is_some();
    if from_behind {
        ray = ray.through();
    } else if cosine.is_nan() || cosine <= 0.0 {
        return None;
    }
    let mut intensity = full;
    if let LightSource::Spot(_, cone) = &light.source {
        intensity = dimmed(intensity, cone.at(-cone.axis.dot(to_light) / length_to_light));
    }
    if let Some(falloff) = &light.falloff {
        intensity = dimmed(intensity, falloff.at(length_to_light * limit));
    }
    if intensity == Rgb::ZERO {
        return None;
    }
    let mut color = diffuse * intensity * to_f32(cosine.abs());
    if material.specular > 0.0 && !from_behind {
        color += specular(material, intensity, half_cosine(normal, to_light, -arrived.direction()));
    }
    (color != Rgb::ZERO).then_some(Incidence { ray, limit, from_behind, color })
}

/// Some times the intensity, never more than a number can hold.
fn dimmed(intensity: Rgb, share: f64) -> Rgb {
    (intensity * to_f32(share.min(f64::from(f32::MAX)))).min(Rgb::splat(f32::MAX))
}

/// k_s I_j (N.H_j)^shininess.
fn specular(material: &SurfaceMaterial, intensity: Rgb, half_cosine: f64) -> Rgb {
    let highlight = libm::pow(half_cosine, f64::from(material.shininess));
    intensity * (material.specular * to_f32(highlight))
}

/// max(0, N.H), at most 1, for the half vector H between two directions of any length but zero.
fn half_cosine(normal: DVec3, to_light: DVec3, back: DVec3) -> f64 {
    let between = to_light / length(to_light) + back / length(back);
    let cosine = normal.dot(between) / length(between);
    // Opposite directions have nothing between them.
    if cosine > 0.0 { cosine.min(1.0) } else { 0.0 }
}

fn length(vector: DVec3) -> f64 {
    vector.dot(vector).sqrt()
}

#[expect(clippy::cast_possible_truncation, reason = "colour is f32")]
fn to_f32(value: f64) -> f32 {
    value as f32
}
