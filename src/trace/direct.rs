//! What lights add at a surface point.

use glam::DVec3;

use super::branch::TreeRay;
use super::effects::Effects;
use super::ray::{Limit, scaled};
use super::sampler::{Dimension, PixelSamples};
use super::shade::{diffuse, intensity, length, specular};
use super::{Light, LightSource, Ray, Surface, SurfaceMaterial};
use crate::color::Rgb;

/// A surface point to be lit.
pub(super) struct Lit<'a> {
    /// The ray that found it.
    pub(super) arrived: &'a TreeRay,
    pub(super) surface: &'a Surface,
    pub(super) material: &'a SurfaceMaterial,
    /// The diffuse colour there.
    pub(super) diffuse: Rgb,
    /// Seed, column and row of the pixel that asks.
    pub(super) pixel: (u64, u32, u32),
    /// Index of the pixel's sample.
    pub(super) sample: u32,
}

/// A ray towards a light.
#[derive(Clone, Copy, Debug)]
pub(super) struct ShadowRay<'a> {
    pub(super) ray: &'a Ray,
    /// Where the light is.
    pub(super) limit: Limit,
    /// Does the light come from the other side, through the clear medium behind the surface?
    pub(super) from_behind: bool,
}

/// What light number `index` adds: of an extended one, the mean over its samples. `visible` answers what share of it comes
/// through, if any.
#[inline(always)]
pub(super) fn from_light<E: Effects>(
    (index, light): (usize, &Light),
    lit: &Lit<'_>,
    mut visible: impl FnMut(ShadowRay<'_>) -> Option<Rgb>,
) -> Rgb {
    let mut from = |place| from_place::<E>(light, lit, place, &mut visible);
    match light.source {
        LightSource::Point(place) | LightSource::Spot(place, _) | LightSource::Towards(place) => from(place),
        LightSource::Ball { .. } | LightSource::Panel { .. } if !E::EXTRAS => Rgb::ZERO,
        LightSource::Ball { .. } | LightSource::Panel { .. } => {
            let dimension = Dimension::Light { light: to_u32(index), path: lit.arrived.path };
            let (seed, i, j) = lit.pixel;
            let samples = PixelSamples::new(seed, i, j);
            let first = lit.sample.wrapping_mul(light.samples);
            let sum: DVec3 = (0..light.samples)
                .map(|sample| {
                    let square = samples.pair(dimension, first.wrapping_add(sample));
                    from(light.source.place(lit.surface.point, square)).as_dvec3()
                })
                .sum();
            (sum / f64::from(light.samples)).as_vec3()
        }
    }
}

/// What a light adds from one of its places. It adds nothing, and no ray is sent, if it is behind what is opaque or at the very
/// point, if it shines elsewhere, or if the surface scatters none of it back along the ray that found it.
#[inline(always)]
fn from_place<E: Effects>(
    light: &Light,
    lit: &Lit<'_>,
    place: DVec3,
    visible: &mut impl FnMut(ShadowRay<'_>) -> Option<Rgb>,
) -> Rgb {
    let surface = lit.surface;
    let is_towards = matches!(light.source, LightSource::Towards(_));
    let Some((to_light, scale)) = scaled(if is_towards { place } else { place - surface.point }) else {
        return Rgb::ZERO;
    };
    let limit = if is_towards { Limit::NONE } else { Limit::new(scale.recip(), place) };
    let (normal, length) = (surface.facing_normal(), length(to_light));
    let cosine = normal.dot(to_light) / length;
    let material = lit.material;
    let from_behind = E::CLEAR_SHADOWS && cosine < 0.0 && material.refraction.is_some();
    if !(cosine > 0.0 || from_behind) {
        return Rgb::ZERO;
    }
    let intensity = intensity::<E>(light, to_light, length, limit.t());
    let mut color = diffuse(lit.diffuse, intensity, cosine.abs());
    if E::EXTRAS && material.specular > 0.0 && !from_behind && intensity != Rgb::ZERO {
        color += specular(material, intensity, normal, to_light, -lit.arrived.ray.direction());
    }
    if color == Rgb::ZERO || !(E::SHADOWS && light.casts_shadows) {
        return if surface.point.is_finite() { color } else { Rgb::ZERO };
    }
    // Normals face the ray that arrived, and so does the side that is left.
    let Some(ray) = Ray::departing(surface, surface.from_outside != from_behind, to_light) else {
        return Rgb::ZERO;
    };
    match visible(ShadowRay { ray: &ray, limit, from_behind }) {
        Some(share) if E::CLEAR_SHADOWS => color * share,
        Some(_) => color,
        None => Rgb::ZERO,
    }
}

fn to_u32(index: usize) -> u32 {
    u32::try_from(index).unwrap_or(u32::MAX)
}
