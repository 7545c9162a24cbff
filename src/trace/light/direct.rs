//! What lights add at a surface point, as far as nothing stands in their way.

use glam::DVec3;

use super::shading::{diffuse, intensity, length, specular};
use crate::color::Rgb;
use crate::trace::effects::Effects;
use crate::trace::math::{Dimension, PixelSamples, scaled};
use crate::trace::query::SurfacePoint;
use crate::trace::rays::{Ray, ShadowLimit};
use crate::trace::scene::{Light, LightSource, SurfaceMaterial};

/// A surface point to be lit.
pub(crate) struct ShadingPoint<'a> {
    /// The direction of the ray that found it.
    pub(crate) arriving: DVec3,
    /// The place in the tree of rays of that ray.
    pub(crate) path: u64,
    pub(crate) point: DVec3,
    pub(crate) material: &'a SurfaceMaterial,
    /// The diffuse colour there.
    pub(crate) diffuse: Rgb,
    pub(crate) asker: SampleId,
    /// The unit normal on the side that the ray came from.
    pub(crate) normal: DVec3,
}

/// Identifies the sample for which light is asked.
#[derive(Clone, Copy, Debug)]
pub(crate) struct SampleId {
    pub(crate) seed: u64,
    /// The pixel's column and row.
    pub(crate) pixel: (u32, u32),
    /// Index of the pixel's sample.
    pub(crate) sample: u32,
}

/// A ray towards a light.
#[derive(Clone, Copy, Debug)]
pub(crate) struct ShadowRay {
    pub(crate) ray: Ray,
    /// Where the light is.
    pub(crate) limit: ShadowLimit,
    /// Whether the light comes from the other side, through the clear medium behind the surface.
    pub(crate) from_behind: bool,
}

/// What a light adds, if it comes through.
#[derive(Clone, Copy, Debug)]
pub(crate) struct LightSample {
    /// What it adds where nothing is in its way.
    pub(crate) color: Rgb,
    /// What has to be asked first; `None` where nothing can stand in the way.
    pub(crate) shadow: Option<WayToLight>,
}

/// The way from a surface point to a light, [`scaled`].
#[derive(Clone, Copy, Debug)]
pub(crate) struct WayToLight {
    pub(crate) direction: DVec3,
    /// Where the light is.
    pub(crate) limit: ShadowLimit,
    /// Whether the light comes from the other side, through the clear medium behind the surface.
    pub(crate) from_behind: bool,
}

impl WayToLight {
    /// Returns the ray from a surface point: the one that it was proposed for.
    #[inline(always)]
    pub(crate) fn ray(&self, surface: &SurfacePoint) -> ShadowRay {
        let Self { direction, limit, from_behind } = *self;
        // Normals face the ray that arrived, and so does the side that is left. The point is finite, as there is a way to the light.
        let exclusion = surface.exclusion(surface.from_outside != from_behind);
        ShadowRay { ray: Ray::departing(surface.point, direction, exclusion), limit, from_behind }
    }
}

/// Returns what sample `sample` of light number `index` adds, as far as nothing stands in its way; `None` where it is nothing
/// whatever stands there. Lights without a size have one sample.
#[inline(always)]
pub(crate) fn sample_light(
    effects: Effects,
    (index, light): (usize, &Light),
    lit: &ShadingPoint<'_>,
    sample: u32,
) -> Option<LightSample> {
    match light.source {
        LightSource::Point(place) | LightSource::Spot(place, _) => from_place(effects, light, lit, place),
        LightSource::Directional(direction) => {
            // From a place that is not finite there is no way to any other light by itself.
            let (to_light, _) = lit.point.is_finite().then(|| scaled(direction))??;
            arriving(effects, light, lit, to_light, ShadowLimit::NONE)
        }
        LightSource::Sphere { .. } | LightSource::Rectangle { .. } if !effects.extras => None,
        LightSource::Sphere { .. } | LightSource::Rectangle { .. } => {
            let place = light_place((index, light), lit.point, (lit.asker, lit.path), sample);
            from_place(effects, light, lit, place)
        }
    }
}

/// Returns the place of a light with a size from which its sample `sample` comes to a point. The ray that found the point has this
/// place in the tree of rays of the sample that asks.
fn light_place(
    (index, light): (usize, &Light),
    point: DVec3,
    (asker, path): (SampleId, u64),
    sample: u32,
) -> DVec3 {
    let SampleId { seed, pixel: (i, j), sample: of_pixel } = asker;
    let index_in_sequence = light_point(light, of_pixel, sample);
    let square = PixelSamples::new(seed, i, j).pair(light_dimension(index, path), index_in_sequence);
    light.source.place(point, square)
}

/// Returns for what the places on light number `index` are asked, by a ray with this place in its tree of rays.
#[inline(always)]
pub(super) fn light_dimension(index: usize, path: u64) -> Dimension {
    Dimension::Light { light: to_u32(index), path }
}

/// Returns the index, in the sequence of a pixel, of sample `sample` of a light for sample `of_pixel` of the pixel.
#[inline(always)]
pub(super) fn light_point(light: &Light, of_pixel: u32, sample: u32) -> u32 {
    of_pixel.wrapping_mul(light.places()).wrapping_add(sample)
}

/// Returns what a light adds from one of its places. It adds nothing at the very point.
#[inline(always)]
fn from_place(effects: Effects, light: &Light, lit: &ShadingPoint<'_>, place: DVec3) -> Option<LightSample> {
    let (to_light, scale) = scaled(place - lit.point)?;
    arriving(effects, light, lit, to_light, ShadowLimit::new(scale.recip(), place))
}

/// Returns what a light adds that is as far as `limit` in a direction that is [`scaled`]. It adds nothing, and no ray is sent, if it
/// is behind what is opaque, if it shines elsewhere, or if the surface scatters none of it back along the ray that found it.
#[inline(always)]
fn arriving(
    effects: Effects,
    light: &Light,
    lit: &ShadingPoint<'_>,
    to_light: DVec3,
    limit: ShadowLimit,
) -> Option<LightSample> {
    let ShadingPoint { material, normal, .. } = *lit;
    let length = length(to_light);
    let cosine = normal.dot(to_light) / length;
    let from_behind = effects.clear_shadows() && cosine < 0.0 && material.refraction.is_some();
    if !(cosine > 0.0 || from_behind) {
        return None;
    }
    let intensity = intensity(effects, light, to_light, length, limit.t());
    let mut color = diffuse(lit.diffuse, intensity, cosine.abs());
    if effects.extras && material.specular > 0.0 && !from_behind && intensity != Rgb::ZERO {
        color += specular(material, intensity, normal, to_light, -lit.arriving);
    }
    if color == Rgb::ZERO {
        return None;
    }
    if !(effects.shadows() && light.casts_shadows) {
        return Some(LightSample { color, shadow: None });
    }
    Some(LightSample { color, shadow: Some(WayToLight { direction: to_light, limit, from_behind }) })
}

fn to_u32(index: usize) -> u32 {
    u32::try_from(index).unwrap_or(u32::MAX)
}
