//! Light intensities and highlights at sixteen shading points: the operations of [`intensity`](super::terms::intensity) and
//! [`specular`](super::terms::specular), in the same order.

use fearless_simd::{f32x16, prelude::*};

use super::facing_normals::facing_normals;
use super::light_sample_packet::{LightSamplePacket, ShadingPacket};
use super::terms::half_cosine;
use crate::color::Rgb;
use crate::trace::effects::Effects;
use crate::trace::math::{Colors, F64s, LANES, Numbers, dot, half_of, lanes, negative, pow, splat, splat3};
use crate::trace::scene::{LightSource, PreparedLight, PreparedScene, SurfaceMaterial};

/// Computes the intensity of a light in the lanes of light samples. `lengths` are the lengths of their directions.
#[inline(always)]
pub(super) fn intensities<S: Simd>(
    simd: S,
    effects: Effects,
    light: &PreparedLight,
    lengths: &Numbers,
    light_samples: &LightSamplePacket,
) -> [f32x16<S>; 3] {
    let Rgb { x, y, z } = light.intensity;
    let mut intensity = [f32x16::splat(simd, x), f32x16::splat(simd, y), f32x16::splat(simd, z)];
    if !effects.extras {
        return intensity;
    }
    let mut shares = Numbers::splat(1.0);
    if let LightSource::Spot(_, cone) = &light.source {
        let axis = splat3(simd, cone.axis);
        for half in 0..2 {
            let along = dot(axis, light_samples.rays.directions.load(simd, half));
            shares.store(half, cone.at(-along / lengths.load(simd, half)));
        }
        intensity = dimmed(simd, intensity, &shares);
    }
    if let Some(falloff) = &light.falloff {
        for half in 0..2 {
            let distance = lengths.load(simd, half) * light_samples.limits.load(simd, half);
            shares.store(half, falloff.at(distance));
        }
        intensity = dimmed(simd, intensity, &shares);
    }
    intensity
}

/// Scales an intensity, clamped to `f32::MAX`.
#[inline(always)]
fn dimmed<S: Simd>(simd: S, mut intensity: [f32x16<S>; 3], shares: &Numbers) -> [f32x16<S>; 3] {
    let share = at_most(simd, shares.load(simd, 0)).narrow(at_most(simd, shares.load(simd, 1)));
    let most = f32x16::splat(simd, f32::MAX);
    for channel in &mut intensity {
        let dimmed = *channel * share;
        *channel = dimmed.simd_lt(most).select(dimmed, most);
    }
    intensity
}

/// Clamps numbers to `f32::MAX`.
#[inline(always)]
fn at_most<S: Simd>(simd: S, number: F64s<S>) -> F64s<S> {
    let most = splat(simd, f64::from(f32::MAX));
    number.simd_lt(most).select(number, most)
}

/// Adds the tint of a material in a lane, if it has one, to those of other lanes.
#[inline(always)]
pub(super) fn add_tint(tints: &mut Option<Colors>, lane: usize, material: &SurfaceMaterial) {
    if let Some(tint) = material.tint {
        tints.get_or_insert(Colors::splat(Rgb::ONE)).set(lane, tint);
    }
}

/// Adds highlights to the colours of light samples.
#[inline(always)]
pub(super) fn add_highlights<S: Simd>(
    simd: S,
    scene: &PreparedScene,
    lit: &ShadingPacket<'_>,
    intensity: [f32x16<S>; 3],
    light_samples: &mut LightSamplePacket,
) {
    let active = lit.shiny & light_samples.lanes & !light_samples.from_behind;
    if active == 0 {
        return;
    }
    let (mut coefficients, mut exponents, mut tints) = ([0.0; LANES], [0.0; LANES], None);
    for lane in lanes(active) {
        let Some(id) = lit.hits.ids.get(lane) else { continue };
        let material = scene.material(id);
        (coefficients[lane], exponents[lane]) = (material.specular, f64::from(material.shininess));
        add_tint(&mut tints, lane, material);
    }
    let exponents = Numbers::new(&exponents);
    let mut shares = Numbers::splat(0.0);
    for half in 0..2 {
        if half_of(active, half) == 0 {
            continue;
        }
        let back = negative(lit.rays.directions.load(simd, half));
        let to_light = light_samples.rays.directions.load(simd, half);
        let cosine = half_cosine(facing_normals(simd, lit.surfaces, half), to_light, back);
        shares.store(half, pow(cosine, exponents.load(simd, half)));
    }
    let share = f32x16::load_array_ref(simd, &coefficients) * shares.rounded(simd);
    let mut highlights = intensity;
    for highlight in &mut highlights {
        *highlight *= share;
    }
    if let Some(tints) = &tints {
        highlights = tints.times(simd, highlights);
    }
    let mut colors = light_samples.colors.load(simd);
    for (color, highlight) in colors.iter_mut().zip(highlights) {
        *color += highlight;
    }
    light_samples.colors.store(colors);
}
