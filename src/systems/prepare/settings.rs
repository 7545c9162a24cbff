//! The settings of the whole scene, clamped to their limits.

use std::f64::consts::PI;

use glam::DVec3;
use hecs::{Entity, World};

use super::shape::towards_one;
use crate::animation::limits::SMALLEST;
use crate::color::{Rgb, Transfer};
use crate::components::{
    AmbientOcclusion, Background, FilmSettings, Fog, Order, Quality, Sampling, Stars, Sun,
};
use crate::trace;

/// Returns the component of the first entity in document order that has it, or its default.
pub(super) fn first<T: hecs::Component + Default + Clone>(world: &World) -> T {
    first_of(world).unwrap_or_default()
}

/// Returns the component of the first entity in document order that has it.
pub(super) fn first_of<T: hecs::Component + Clone>(world: &World) -> Option<T> {
    let found = first_entity::<T>(world).and_then(|entity| world.get::<&T>(entity).ok());
    found.map(|component| T::clone(&component))
}

/// Returns the first entity in document order that has a component.
pub(super) fn first_entity<T: hecs::Component>(world: &World) -> Option<Entity> {
    let mut query = world.query::<hecs::With<(Entity, Option<&Order>), &T>>();
    let all = query.iter();
    let first = all.min_by_key(|(entity, order)| (order.map_or(u64::MAX, |order| order.0), entity.id()));
    first.map(|(entity, _)| entity)
}

/// Returns the film settings, clamped to their limits.
#[must_use]
pub(super) fn film_settings(world: &World) -> FilmSettings {
    sane_film(first(world))
}

/// Clamps film settings to their limits.
pub(super) fn sane_film(film: FilmSettings) -> FilmSettings {
    let side = |side: u32| side.clamp(1, FilmSettings::LARGEST_SIDE);
    let width = side(film.width);
    let most_rows = FilmSettings::LARGEST_AREA / u64::from(width);
    let height = side(film.height).min(u32::try_from(most_rows).unwrap_or(u32::MAX));
    FilmSettings { width, height, ..film }
}

/// Returns the number and the choice of samples, clamped to their limits.
#[must_use]
pub(crate) fn sampling_settings(world: &World) -> Sampling {
    sane_sampling(first(world))
}

/// Returns the depth and the cutoff, clamped to their limits.
#[must_use]
pub(crate) fn quality_settings(world: &World) -> Quality {
    sane_quality(first(world))
}

/// Clamps the depth and the cutoff to their limits.
pub(super) fn sane_quality(Quality { depth, cutoff }: Quality) -> Quality {
    let cutoff = if cutoff > 0.0 { cutoff.min(Quality::LARGEST_CUTOFF) } else { 0.0 };
    Quality { depth: depth.clamp(1, Quality::LARGEST_DEPTH), cutoff }
}

pub(super) fn sane_sampling(sampling: Sampling) -> Sampling {
    let no_limit = sampling.max_error > 0.0 && sampling.samples <= 1;
    let most = Sampling::LARGEST_COUNT;
    let samples = if no_limit { most } else { sampling.samples.clamp(1, most) };
    let instants = sampling.instants.clamp(1, Sampling::LARGEST_INSTANTS);
    let max_error =
        if sampling.max_error > 0.0 { sampling.max_error.min(Sampling::LARGEST_ERROR) } else { 0.0 };
    let min_samples = sampling.min_samples.clamp(1, most);
    Sampling { samples, min_samples, instants, max_error, ..sampling }
}

/// Converts 8-bit levels to linear light. With sRGB output, the width of a level near black, the smallest, is used.
pub(super) fn linear_cutoff(codes: f32, transfer: Transfer) -> f32 {
    let steepest = match transfer {
        Transfer::Classic => 1.0,
        Transfer::Srgb => 12.92,
    };
    if codes > 0.0 { codes.min(Quality::LARGEST_CUTOFF) / (255.0 * steepest) } else { 0.0 }
}

/// Returns the occlusion of ambient light, clamped to its limits; `None` if its distance is not above 0.
pub(super) fn prepared_ambient_occlusion(
    AmbientOcclusion { samples, distance }: AmbientOcclusion,
) -> Option<trace::PreparedAmbientOcclusion> {
    /// Farther than any two shapes are apart whose coordinates can be squared.
    const FARTHEST: f64 = 1e150;
    (distance > 0.0).then(|| trace::PreparedAmbientOcclusion {
        samples: samples.clamp(1, AmbientOcclusion::LARGEST_SAMPLES),
        distance: distance.min(FARTHEST),
    })
}

pub(super) fn prepared_background(background: Background) -> trace::PreparedBackground {
    match background {
        Background::Flat(color) => trace::PreparedBackground::Flat(sane(color)),
        Background::Gradient { bottom, horizon, top } => trace::PreparedBackground::Gradient {
            bottom: sane(bottom),
            horizon: horizon.map(sane),
            top: sane(top),
        },
        Background::Stops(ramp) => trace::PreparedBackground::Stops(ramp.with_colors(sane)),
    }
}

pub(super) fn prepared_fog(fog: Fog) -> trace::PreparedFog {
    let density = if fog.density > 0.0 { fog.density.min(f64::MAX) } else { 0.0 };
    let layer = fog.height.filter(|height| *height > 0.0 && height.is_finite() && fog.level.is_finite());
    trace::PreparedFog {
        color: sane(fog.color),
        density,
        layer: layer.map(|height| trace::FogLayer { level: fog.level, height }),
        hides_background: fog.hides_background,
    }
}

/// Returns a direction as a unit vector; `None` if it is zero or not finite.
fn unit(direction: DVec3) -> Option<DVec3> {
    // Squares of very large or small numbers would overflow or underflow.
    let largest = direction.abs().max_element();
    (direction.is_finite() && largest > 0.0).then(|| (direction * towards_one(largest)).normalize())
}

/// Returns the sun and the stars, without those that give no light or have no direction.
pub(super) fn prepared_sky(sun: Option<Sun>, stars: Option<Stars>) -> trace::PreparedSky {
    let shines = |intensity: Rgb| sane(intensity) != Rgb::ZERO;
    let angle = |angle: f64| if angle > SMALLEST { angle.min(PI) } else { SMALLEST };
    let sun = sun.filter(|sun| shines(sun.intensity)).and_then(|sun| {
        Some(trace::PreparedSun {
            direction: unit(sun.direction)?,
            intensity: sane(sun.intensity),
            radius: angle(sun.size) / 2.0,
            glow: if sun.glow > 0.0 { sun.glow.min(1.0) } else { 0.0 },
            glow_size: angle(sun.glow_size),
        })
    });
    let stars = stars.filter(|stars| shines(stars.intensity)).map(|stars| {
        let count = stars.count.clamp(1, Stars::LARGEST_COUNT);
        trace::PreparedStars::new(sane(stars.intensity), angle(stars.size) / 2.0, count, stars.seed)
    });
    trace::PreparedSky { sun, stars }
}

/// Clamps a colour to finite, non-negative values.
pub(super) fn sane(color: Rgb) -> Rgb {
    Rgb::from_array(color.to_array().map(|channel| if channel > 0.0 { channel.min(f32::MAX) } else { 0.0 }))
}
