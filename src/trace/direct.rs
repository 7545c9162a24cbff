//! What lights add at a surface point.

use glam::DVec3;

use super::branch::TreeRay;
use super::effects::Effects;
use super::sampler::{Dimension, PixelSamples};
use super::shade::{Incidence, incidence};
use super::{Light, LightSource, PreparedScene, Surface};
use crate::color::Rgb;

/// A surface point to be lit.
pub(super) struct Lit<'a> {
    /// The ray that found it.
    pub(super) arrived: &'a TreeRay,
    pub(super) surface: &'a Surface,
    /// The diffuse colour there.
    pub(super) diffuse: Rgb,
    /// The pixel that asks.
    pub(super) pixel: PixelSamples,
    /// Index of the pixel's sample.
    pub(super) sample: u32,
}

/// What light number `index` adds: of an extended one, the mean over its samples. `visible` answers what share of it comes
/// through, if any.
#[inline]
pub(super) fn from_light<E: Effects>(
    scene: &PreparedScene,
    (index, light): (usize, &Light),
    lit: &Lit<'_>,
    mut visible: impl FnMut(&Incidence) -> Option<Rgb>,
) -> Rgb {
    let mut from = |place: DVec3| {
        let incidence = incidence::<E>(scene, &lit.arrived.ray, lit.surface, lit.diffuse, light, place)?;
        if E::SHADOWS && light.casts_shadows {
            Some(incidence.color * visible(&incidence)?)
        } else {
            Some(incidence.color)
        }
    };
    match light.source {
        LightSource::Point(place) | LightSource::Spot(place, _) | LightSource::Towards(place) => {
            from(place).unwrap_or(Rgb::ZERO)
        }
        LightSource::Ball { .. } | LightSource::Panel { .. } if !E::RARE => Rgb::ZERO,
        LightSource::Ball { .. } | LightSource::Panel { .. } => {
            let dimension = Dimension::Light { light: to_u32(index), path: lit.arrived.path };
            let first = lit.sample.wrapping_mul(light.samples);
            let sum: DVec3 = (0..light.samples)
                .filter_map(|sample| {
                    let square = lit.pixel.pair(dimension, first.wrapping_add(sample));
                    from(light.source.place(lit.surface.point, square))
                })
                .map(Rgb::as_dvec3)
                .sum();
            (sum / f64::from(light.samples)).as_vec3()
        }
    }
}

fn to_u32(index: usize) -> u32 {
    u32::try_from(index).unwrap_or(u32::MAX)
}
