//! The camera and the settings of the whole scene, held to their limits.

use hecs::{Entity, World};

use crate::color::{Rgb, Transfer};
use crate::components::{Background, Camera, FilmSettings, Fog, Order, Projection, Quality, Sampling, View};
use crate::trace;

/// The first in document order of a component that a world has at most one of, or its default.
pub(super) fn first<T: hecs::Component + Default + Clone>(world: &World) -> T {
    let mut query = world.query::<(Entity, Option<&Order>, &T)>();
    let all = query.iter();
    let first = all.min_by_key(|(entity, order, _)| (order.map_or(u64::MAX, |order| order.0), entity.id()));
    first.map(|(.., component)| component.clone()).unwrap_or_default()
}

/// The film's settings, held to their limits.
#[must_use]
pub fn film_settings(world: &World) -> FilmSettings {
    let film = first::<FilmSettings>(world);
    let side = |side: u32| side.clamp(1, FilmSettings::LARGEST_SIDE);
    let width = side(film.width);
    let most_rows = FilmSettings::LARGEST_AREA / u64::from(width);
    let height = side(film.height).min(u32::try_from(most_rows).unwrap_or(u32::MAX));
    FilmSettings { width, height, ..film }
}

pub(super) fn prepared_camera(world: &World, film: FilmSettings) -> trace::Camera {
    let camera = first::<Camera>(world);
    let view = match camera.view {
        View::Direction(direction) => direction,
        View::Target(target) => target - camera.position,
    };
    // The first and last pixel lie on the screen's edges, so that there is one pitch less than there are pixels.
    let gaps = |pixels: u32| f64::from(pixels.saturating_sub(1).max(1));
    let (across, down) = (gaps(film.width), gaps(film.height));
    let (distance, size) = match camera.projection {
        Projection::Screen { distance, width, height } => {
            (distance, (width.unwrap_or(height / down * across), height))
        }
        Projection::FieldOfView { vertical } => {
            let pitch = 2.0 * libm::tan(0.5 * vertical) / f64::from(film.height);
            (1.0, (pitch * across, pitch * down))
        }
    };
    let resolution = (film.width, film.height);
    let pinhole = trace::Camera::new(camera.position, view, camera.up, distance, size, resolution);
    camera.lens.map_or(pinhole, |lens| pinhole.with_lens(lens.aperture, lens.focus))
}

pub(super) fn sane_sampling(sampling: Sampling) -> Sampling {
    let samples = sampling.samples.clamp(1, Sampling::LARGEST_COUNT);
    let instants = sampling.instants.clamp(1, Sampling::LARGEST_INSTANTS).min(samples);
    Sampling { samples, instants, ..sampling }
}

/// How a frame is exposed, from the world as it is.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) enum Shutter {
    /// At one instant: the camera has none.
    None,
    /// At one instant: no more are asked for, or a pixel has no more samples.
    OneInstant,
    /// Open for a share of the time from frame to frame, at this many instants, more than one.
    Open(f64, u32),
}

/// How a frame is exposed.
#[must_use]
pub(crate) fn shutter(world: &World) -> Shutter {
    let instants = sane_sampling(first(world)).instants;
    match first::<Camera>(world).shutter {
        Some(open) if open > 0.0 && instants > 1 => Shutter::Open(open.min(1.0), instants),
        Some(open) if open > 0.0 => Shutter::OneInstant,
        _ => Shutter::None,
    }
}

/// From steps of 8 bits to linear light. Where output is encoded as sRGB, steps are finest near black.
pub(super) fn linear_cutoff(codes: f32, transfer: Transfer) -> f32 {
    let steepest = match transfer {
        Transfer::Classic => 1.0,
        Transfer::Srgb => 12.92,
    };
    if codes > 0.0 { codes.min(Quality::LARGEST_CUTOFF) / (255.0 * steepest) } else { 0.0 }
}

pub(super) fn prepared_background(background: Background) -> trace::Background {
    match background {
        Background::Flat(color) => trace::Background::Flat(sane(color)),
        Background::Gradient { bottom, top } => {
            trace::Background::Gradient { bottom: sane(bottom), top: sane(top) }
        }
    }
}

pub(super) fn prepared_fog(fog: Fog) -> trace::Fog {
    let density = if fog.density > 0.0 { fog.density.min(f64::MAX) } else { 0.0 };
    trace::Fog { color: sane(fog.color), density }
}

/// Finite and not negative.
pub(super) fn sane(color: Rgb) -> Rgb {
    Rgb::from_array(color.to_array().map(|channel| if channel > 0.0 { channel.min(f32::MAX) } else { 0.0 }))
}
