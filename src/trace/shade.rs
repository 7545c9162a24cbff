//! The light that a surface point sends towards the ray that found it: ambient plus diffuse. Reflected light is added by
//! the rays themselves.

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
    /// Share of the mirrored ray, 0..=1; 0 where nothing is mirrored.
    pub reflected: f32,
}

/// A ray that asks whether a light reaches a point.
#[derive(Clone, Debug)]
pub(super) struct ShadowRay {
    pub(super) ray: Ray,
    /// Where the light is.
    pub(super) limit: f64,
    /// N.L, greater than 0.
    pub(super) cosine: f32,
}

/// C_a = k_a c I_a.
pub(super) fn ambient(scene: &PreparedScene, material: &SurfaceMaterial) -> Rgb {
    material.ambient * scene.ambient
}

/// k_d c I_j (N.L_j) for a light that is not hidden.
pub(super) fn diffuse(material: &SurfaceMaterial, light: &Light, cosine: f32) -> Rgb {
    material.diffuse * light.intensity * cosine
}

/// The shadow ray to a light; `None` where the light could add nothing: it is off, behind the surface or at the very
/// point, or the surface scatters none.
pub(super) fn shadow_ray(scene: &PreparedScene, surface: &Surface, light: &Light) -> Option<ShadowRay> {
    if scene.material(surface.hit.slot).diffuse * light.intensity == Rgb::ZERO {
        return None;
    }
    // Normals face the ray that arrived, and so does the side that is left.
    let outward = surface.from_outside;
    let (ray, limit) = match light.source {
        LightSource::Point(point) => Ray::leaving_to(surface, outward, point)?,
        LightSource::Towards(direction) => (Ray::leaving(surface, outward, direction)?, f64::INFINITY),
    };
    let direction = ray.direction();
    let cosine = surface.facing_normal().dot(direction) / direction.dot(direction).sqrt();
    (cosine > 0.0).then_some(ShadowRay { ray, limit, cosine: to_f32(cosine) })
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
