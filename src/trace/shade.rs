//! The light that a surface point sends towards the ray that found it: ambient plus, light by light, diffuse and specular.
//! Reflected light is added by the rays themselves.

use glam::DVec3;

use super::{Light, LightSource, PreparedScene, Ray, Surface};
use crate::color::Rgb;

/// How a slot's surface answers light.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct SurfaceMaterial {
    /// Ambient coefficient times ambient colour.
    pub ambient: Rgb,
    /// Diffuse coefficient times colour.
    pub diffuse: Rgb,
    /// Specular coefficient, 0..=1; 0 where there are no highlights.
    pub specular: f32,
    /// The exponent of N.H in highlights, 0 or more.
    pub shininess: f32,
    /// Share of the mirrored ray, 0..=1; 0 where nothing is mirrored.
    pub reflected: f32,
}

impl SurfaceMaterial {
    /// Is anything of lights sent on?
    pub(super) fn scatters(&self) -> bool {
        self.diffuse != Rgb::ZERO || self.specular > 0.0
    }
}

/// A light as it comes to a surface point, unless something stands in its way.
#[derive(Clone, Debug)]
pub(super) struct Incidence {
    /// The shadow ray: towards the light.
    pub(super) ray: Ray,
    /// Where the light is.
    pub(super) limit: f64,
    /// What it adds, not black.
    pub(super) color: Rgb,
}

/// C_a = k_a c I_a.
pub(super) fn ambient(scene: &PreparedScene, material: &SurfaceMaterial) -> Rgb {
    material.ambient * scene.ambient
}

/// How a light comes to a surface point; `None` where it could add nothing: it is off, behind the surface or at the very
/// point, or shines elsewhere, or the surface scatters none towards where `arrived` came from.
pub(super) fn incidence(
    scene: &PreparedScene,
    arrived: &Ray,
    surface: &Surface,
    light: &Light,
) -> Option<Incidence> {
    let material = scene.material(surface.hit.slot);
    let full = light.intensity;
    if material.diffuse * full == Rgb::ZERO && full * material.specular == Rgb::ZERO {
        return None;
    }
    // Normals face the ray that arrived, and so does the side that is left.
    let outward = surface.from_outside;
    let (ray, limit) = match light.source {
        LightSource::Point(point) | LightSource::Spot(point, _) => Ray::leaving_to(surface, outward, point)?,
        LightSource::Towards(direction) => (Ray::leaving(surface, outward, direction)?, f64::INFINITY),
    };
    let normal = surface.facing_normal();
    let to_light = ray.direction();
    let length_to_light = length(to_light);
    let cosine = Some(normal.dot(to_light) / length_to_light).filter(|cosine| *cosine > 0.0)?;
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
    let mut color = diffuse(material, intensity, cosine);
    if material.specular > 0.0 {
        color += specular(material, intensity, half_cosine(normal, to_light, -arrived.direction()));
    }
    (color != Rgb::ZERO).then_some(Incidence { ray, limit, color })
}

/// Some times the intensity, never more than a number can hold.
fn dimmed(intensity: Rgb, share: f64) -> Rgb {
    (intensity * to_f32(share.min(f64::from(f32::MAX)))).min(Rgb::splat(f32::MAX))
}

/// k_d c I_j (N.L_j).
fn diffuse(material: &SurfaceMaterial, intensity: Rgb, cosine: f64) -> Rgb {
    material.diffuse * intensity * to_f32(cosine)
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

/// The mirrored ray: d - 2 (d.N) N.
pub(super) fn mirrored(arrived: &Ray, surface: &Surface) -> Option<Ray> {
    let direction = reflect(arrived.direction(), surface.normal);
    Ray::leaving(surface, surface.from_outside, direction)
}

fn reflect(direction: DVec3, normal: DVec3) -> DVec3 {
    direction - normal * (2.0 * direction.dot(normal))
}

#[expect(clippy::cast_possible_truncation, reason = "colour is f32")]
fn to_f32(value: f64) -> f32 {
    value as f32
}
