//! Light samples at a shading point, before occlusion.

use glam::DVec3;

use super::terms::{diffuse, half_cosine, highlight, intensity, length, specular};
use crate::color::Rgb;
use crate::trace::effects::Effects;
use crate::trace::intersect::SurfacePoint;
use crate::trace::math::{Dimension, PixelSamples, scaled};
use crate::trace::rays::{PreparedRay, ShadowLimit};
use crate::trace::scene::{LightSource, PreparedLight, SurfaceMaterial, on_dome};

/// A shading point.
pub(crate) struct ShadingPoint<'a> {
    /// Direction of the ray that hit the point.
    pub(crate) arriving: DVec3,
    /// Index of that ray in the ray tree of its sample.
    pub(crate) path: u64,
    pub(crate) point: DVec3,
    pub(crate) material: &'a SurfaceMaterial,
    /// Diffuse colour at the point.
    pub(crate) diffuse: Rgb,
    /// Colour in ambient light at the point, if ambient light is occluded.
    pub(crate) ambient: Rgb,
    pub(crate) sample_id: SampleId,
    /// Unit normal on the side from which the ray arrived.
    pub(crate) normal: DVec3,
}

/// Identifies the pixel sample for which light is sampled.
#[derive(Clone, Copy, Debug)]
pub(crate) struct SampleId {
    pub(crate) seed: u64,
    /// Column and row of the pixel.
    pub(crate) pixel: (u32, u32),
    /// Index of the sample in its pixel.
    pub(crate) sample: u32,
}

/// A shadow ray.
#[derive(Clone, Copy, Debug)]
pub(crate) struct ShadowRay {
    pub(crate) ray: PreparedRay,
    /// End of the ray, at the light.
    pub(crate) limit: ShadowLimit,
    /// True if the light arrives from the other side, through the transparent medium behind the surface.
    pub(crate) from_behind: bool,
}

/// The contribution of a light, before occlusion.
#[derive(Clone, Copy, Debug)]
pub(crate) struct LightSample {
    /// The unoccluded contribution.
    pub(crate) color: Rgb,
    /// Direction and end of the shadow ray to trace; `None` if nothing can occlude the light.
    pub(crate) shadow: Option<ShadowSegment>,
}

/// The terms of a light's contribution to a shading point, before occlusion.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct LightTerms {
    /// The direction to the light; of any length except zero.
    pub to_light: DVec3,
    /// End of the shadow ray, at the light.
    pub(crate) limit: ShadowLimit,
    /// N.L, the cosine of the angle between the normal and the direction to the light. It is negative if the light arrives from behind,
    /// through a transparent medium.
    pub cosine: f64,
    /// N.H, if the surface has highlights.
    pub half_cosine: Option<f64>,
    /// I, the intensity of the light in this direction and at this distance.
    pub intensity: Rgb,
    /// The diffuse term, k_d c I |N.L|; for a dome, the ambient term k_a c I_a.
    pub diffuse: Rgb,
    /// The specular term, k_s I (N.H)^shininess.
    pub specular: Rgb,
}

impl LightTerms {
    /// Returns the unoccluded contribution.
    #[must_use]
    #[inline(always)]
    pub fn contribution(&self) -> Rgb {
        self.diffuse + self.specular
    }

    /// Returns the distance of the light; infinite for a directional light.
    #[must_use]
    pub fn distance(&self) -> f64 {
        self.to_light.length() * self.limit.t()
    }

    /// Returns the point of the light that is sampled; `None` for a directional light.
    #[must_use]
    pub fn place(&self) -> Option<DVec3> {
        Some(self.limit.place()).filter(|place| place.is_finite())
    }

    /// Returns the contribution, with the shadow ray that can occlude it.
    #[inline(always)]
    pub(crate) fn light_sample(&self, effects: Effects, light: &PreparedLight) -> LightSample {
        let Self { to_light: direction, limit, cosine, .. } = *self;
        let segment = ShadowSegment { direction, limit, from_behind: cosine < 0.0 };
        let shadow = (effects.shadows() && light.casts_shadows && limit.t() > 0.0).then_some(segment);
        LightSample { color: self.contribution(), shadow }
    }
}

/// The reason why a light contributes nothing to a shading point, before occlusion.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Unlit {
    /// The light has no intensity.
    Off,
    /// The light is behind the surface.
    Behind,
    /// The point is outside the light's cone.
    OutsideCone,
    /// The point is so far away that the light's falloff leaves nothing.
    OutOfReach,
    /// k_d times the surface's colour is 0, and the surface has no highlights.
    NotDiffuse,
    /// k_d times the surface's colour is 0, and (N.H)^shininess is 0 in the direction of the ray.
    NoHighlight,
    /// The product of the surface's colour and the light's is 0 in every channel.
    OtherColor,
    /// The direction to the light is not defined, as at the light itself.
    NoDirection,
}

/// The direction from a shading point to a light, [`scaled`], and its end.
#[derive(Clone, Copy, Debug)]
pub(crate) struct ShadowSegment {
    pub(crate) direction: DVec3,
    /// End of the shadow ray, at the light.
    pub(crate) limit: ShadowLimit,
    /// True if the light arrives from the other side, through the transparent medium behind the surface.
    pub(crate) from_behind: bool,
}

impl ShadowSegment {
    /// Returns the shadow ray from a surface point, which must be the one that was sampled.
    #[inline(always)]
    pub(crate) fn ray(&self, surface: &SurfacePoint) -> ShadowRay {
        let Self { direction, limit, from_behind } = *self;
        // The shadow ray leaves the surface on the side of the arriving ray, unless the light is behind the surface. The point is finite,
        // because it has a direction to the light.
        let exclusion = surface.exclusion(surface.from_outside != from_behind);
        ShadowRay { ray: PreparedRay::departing(surface.point, direction, exclusion), limit, from_behind }
    }
}

/// Returns the contribution of sample `sample` of light number `index`, before occlusion, or the reason why it is zero. Lights other than
/// area lights have one sample.
#[inline(always)]
pub(crate) fn sample_light(
    effects: Effects,
    (index, light): (usize, &PreparedLight),
    lit: &ShadingPoint<'_>,
    sample: u32,
) -> Result<LightSample, Unlit> {
    let terms = light_terms(effects, (index, light), lit, sample)?;
    Ok(terms.light_sample(effects, light))
}

/// Returns the terms of the contribution of [`sample_light`].
#[inline(always)]
pub(crate) fn light_terms(
    effects: Effects,
    (index, light): (usize, &PreparedLight),
    lit: &ShadingPoint<'_>,
    sample: u32,
) -> Result<LightTerms, Unlit> {
    match light.source {
        LightSource::Point(place) | LightSource::Spot(place, _) => from_place(effects, light, lit, place),
        LightSource::Directional(direction) => {
            // All other lights need no such test: a point that is not finite has no scaled direction to them.
            let to_light = if lit.point.is_finite() { scaled(direction) } else { None };
            let (to_light, _) = to_light.ok_or(Unlit::NoDirection)?;
            arriving(effects, light, lit, to_light, ShadowLimit::NONE)
        }
        LightSource::Sphere { .. } | LightSource::Rectangle { .. } | LightSource::Dome { .. }
            if !effects.extras =>
        {
            Err(Unlit::Off)
        }
        LightSource::Sphere { .. } | LightSource::Rectangle { .. } => {
            let place = light.source.place(lit.point, light_square((index, light), lit, sample));
            from_place(effects, light, lit, place)
        }
        LightSource::Dome { radius } => {
            let towards = on_dome(lit.normal.into(), light_square((index, light), lit, sample));
            from_dome((light, radius), lit, towards.into())
        }
    }
}

/// Returns the point of the unit square for sample `sample` of an area light or a dome at a shading point.
fn light_square((index, light): (usize, &PreparedLight), lit: &ShadingPoint<'_>, sample: u32) -> [f64; 2] {
    let SampleId { seed, pixel: (i, j), sample: of_pixel } = lit.sample_id;
    let index_in_sequence = light_point(light, of_pixel, sample);
    PixelSamples::new(seed, i, j).pair(light_dimension(index, lit.path), index_in_sequence)
}

/// Returns the sampling dimension of light number `index`, for the ray with index `path` in its tree.
#[inline(always)]
pub(super) fn light_dimension(index: usize, path: u64) -> Dimension {
    Dimension::Light { light: to_u32(index), path }
}

/// Returns the index, in the sequence of a pixel, of sample `sample` of a light for sample `of_pixel` of the pixel.
#[inline(always)]
pub(super) fn light_point(light: &PreparedLight, of_pixel: u32, sample: u32) -> u32 {
    of_pixel.wrapping_mul(light.sample_count()).wrapping_add(sample)
}

/// Returns the terms of a light from `place`.
#[inline(always)]
fn from_place(
    effects: Effects,
    light: &PreparedLight,
    lit: &ShadingPoint<'_>,
    place: DVec3,
) -> Result<LightTerms, Unlit> {
    let (to_light, scale) = scaled(place - lit.point).ok_or(Unlit::NoDirection)?;
    arriving(effects, light, lit, to_light, ShadowLimit::new(scale.recip(), place))
}

/// Returns the terms of ambient light from a point of a dome in the direction `towards`, of length 1. It is at full strength from all
/// directions: their density is the cosine to the normal.
#[inline(always)]
fn from_dome(
    (light, radius): (&PreparedLight, f64),
    lit: &ShadingPoint<'_>,
    towards: DVec3,
) -> Result<LightTerms, Unlit> {
    let place = lit.point + towards * radius;
    // Nothing occludes the light of a dome that is smaller than the spacing of representable points.
    let scaled = scaled(towards).filter(|_| place.is_finite() && place != lit.point);
    let (to_light, t) =
        scaled.map_or((lit.normal, 0.0), |(to_light, scale)| (to_light, radius * scale.recip()));
    // Rounding can put directions of the rim behind the surface.
    let cosine = lit.normal.dot(to_light) / length::<f64>(to_light.into());
    let terms = LightTerms {
        to_light,
        limit: ShadowLimit::new(t, place),
        cosine: if cosine > 0.0 { cosine } else { 0.0 },
        half_cosine: None,
        intensity: light.intensity,
        diffuse: lit.ambient * light.intensity,
        specular: Rgb::ZERO,
    };
    if terms.diffuse == Rgb::ZERO { Err(Unlit::OtherColor) } else { Ok(terms) }
}

/// Returns the terms of a light in direction `to_light`, which is [`scaled`]; `limit` is the end of the shadow ray, at the light.
#[inline(always)]
fn arriving(
    effects: Effects,
    light: &PreparedLight,
    lit: &ShadingPoint<'_>,
    to_light: DVec3,
    limit: ShadowLimit,
) -> Result<LightTerms, Unlit> {
    let ShadingPoint { material, normal, .. } = *lit;
    let length = length::<f64>(to_light.into());
    let cosine = normal.dot(to_light) / length;
    let from_behind = effects.transparent_shadows() && cosine < 0.0 && material.refraction.is_some();
    if !(cosine > 0.0 || from_behind) {
        return Err(Unlit::Behind);
    }
    let intensity = intensity(effects, light, to_light, length, limit.t());
    let diffuse = diffuse(lit.diffuse, intensity, cosine.abs());
    let mut terms =
        LightTerms { to_light, limit, cosine, half_cosine: None, intensity, diffuse, specular: Rgb::ZERO };
    if effects.extras && material.specular > 0.0 && !from_behind && intensity != Rgb::ZERO {
        let half_cosine = half_cosine::<f64>(normal.into(), to_light.into(), (-lit.arriving).into());
        (terms.half_cosine, terms.specular) = (Some(half_cosine), specular(material, intensity, half_cosine));
    }
    if terms.contribution() == Rgb::ZERO {
        return Err(unlit(light, &terms, lit));
    }
    Ok(terms)
}

/// Returns the reason why a light that is not behind a surface contributes nothing.
#[cold]
fn unlit(light: &PreparedLight, terms: &LightTerms, lit: &ShadingPoint<'_>) -> Unlit {
    let LightTerms { to_light, half_cosine, intensity, .. } = *terms;
    if intensity == Rgb::ZERO {
        return match &light.source {
            LightSource::Spot(_, cone) if cone.at(-cone.axis.dot(to_light) / to_light.length()) <= 0.0 => {
                Unlit::OutsideCone
            }
            _ => Unlit::OutOfReach,
        };
    }
    match half_cosine {
        _ if lit.diffuse != Rgb::ZERO => Unlit::OtherColor,
        Some(cosine) if highlight(lit.material, cosine) > 0.0 => Unlit::OtherColor,
        Some(_) => Unlit::NoHighlight,
        None if terms.cosine < 0.0 => Unlit::Behind,
        None => Unlit::NotDiffuse,
    }
}

fn to_u32(index: usize) -> u32 {
    u32::try_from(index).unwrap_or(u32::MAX)
}
