//! Light samples at sixteen shading points: the operations of [`sample_light`](super::sample_light), in the same order.

use fearless_simd::{f32x16, prelude::*};
use glam::DVec3;

use super::direct::{SampleId, ShadingPoint, sample_light};
use super::facing_normals::facing_normal;
use super::light_sample_packet::{LightSamplePacket, ShadingPacket};
use super::terms_packet::{add_highlights, intensities};
use crate::trace::effects::Effects;
use crate::trace::math::{
    F64s, F64s3, Mask, Numbers, Scaled, add, bits, bits16, dot, finite3, half_of, lanes, scaled,
    scaled_lanes, splat, splat3, subtract, times,
};
use crate::trace::scene::{LightSource, PreparedLight, PreparedScene, SurfaceMaterial};

/// Computes the contribution of sample `sample` of light number `index` at each shading point, before occlusion. `sample_id` returns the pixel
/// sample of a lane.
#[inline(always)]
pub(crate) fn sample_light_lanes<S: Simd>(
    simd: S,
    (scene, effects): (&PreparedScene, Effects),
    (index, light): (usize, &PreparedLight),
    lit: &ShadingPacket<'_>,
    sample: u32,
    sample_id: impl Fn(usize) -> SampleId,
    light_samples: &mut LightSamplePacket,
) {
    (light_samples.lanes, light_samples.needs_shadow_ray, light_samples.from_behind) = (0, 0, 0);
    light_samples.rays.clear();
    if lit.surfaces.lanes == 0 {
        return;
    }
    let Some(target) = target(simd, light, effects, lit, sample, light_samples) else { return };
    let Aim { cosines, lengths, facing, behind, escalated } = aim(simd, &target, lit, light_samples);
    if let LightSource::Dome { .. } = light.source {
        light_samples.lanes = lit.surfaces.lanes & !escalated;
        let (color, intensity) = (lit.ambient.load(simd), light.intensity.to_array());
        light_samples.colors.store([0, 1, 2].map(|channel| color[channel] * intensity[channel]));
    } else {
        if effects.transparent_shadows() {
            light_samples.from_behind = behind & lit.transparent;
        }
        light_samples.lanes = facing | light_samples.from_behind;
        let arriving = intensities(simd, effects, light, &lengths, light_samples);
        let (diffuse, cosine) = (lit.diffuse.load(simd), cosines.rounded(simd));
        light_samples.colors.store([
            diffuse[0] * arriving[0] * cosine,
            diffuse[1] * arriving[1] * cosine,
            diffuse[2] * arriving[2] * cosine,
        ]);
        if effects.extras {
            add_highlights(simd, scene, lit, arriving, light_samples);
        }
    }
    let black = f32x16::splat(simd, 0.0);
    let [red, green, blue] = light_samples.colors.load(simd);
    light_samples.lanes &= bits16(!(red.simd_eq(black) & green.simd_eq(black) & blue.simd_eq(black)));
    if effects.shadows() && light.casts_shadows {
        light_samples.needs_shadow_ray = light_samples.lanes;
    }
    for lane in lanes(escalated) {
        let Some(id) = lit.hits.ids.get(lane) else { continue };
        let point = lit_point(lit, lane, scene.material(id), sample_id(lane));
        if let Ok(light_sample) = sample_light(effects, (index, light), &point, sample) {
            light_samples.set(lane, &light_sample);
        }
    }
    light_samples.leave(lit.surfaces);
}

/// The directions from shading points to a light.
struct Aim {
    /// Cosines of the angles between directions and normals, without their signs.
    cosines: Numbers,
    /// Lengths of the directions to the light.
    lengths: Numbers,
    /// Lanes whose surfaces face the light.
    facing: u32,
    /// Lanes whose surfaces face away from the light.
    behind: u32,
    /// Lanes left to the scalar function [`sample_light`].
    escalated: u32,
}

/// Computes the directions to a light and its `t` along them, and stores them as rays and limits of `light_samples`.
#[inline(always)]
fn aim<S: Simd>(
    simd: S,
    target: &LightPosition,
    lit: &ShadingPacket<'_>,
    light_samples: &mut LightSamplePacket,
) -> Aim {
    let active = lit.surfaces.lanes;
    let (cosines, lengths) = (Numbers::splat(0.0), Numbers::splat(1.0));
    let mut aim = Aim { cosines, lengths, facing: 0, behind: 0, escalated: 0 };
    let (mut in_range, mut above, mut below) = (0, 0, 0);
    for half in 0..2 {
        if half_of(active, half) == 0 {
            continue;
        }
        let point = lit.surfaces.points.load(simd, half);
        let (to_light, limit, found) = way(simd, target, point, (light_samples, half));
        let length = dot(to_light, to_light).sqrt();
        // Uses the outward normal. The normal that faces the ray differs at most in its sign, and so does the cosine.
        let cosine = dot(lit.surfaces.normals.load(simd, half), to_light) / length;
        let zero = splat(simd, 0.0);
        in_range |= bits(found, half);
        above |= bits(cosine.simd_gt(zero), half);
        below |= bits(cosine.simd_lt(zero), half);
        aim.cosines.store(half, cosine.abs());
        aim.lengths.store(half, length);
        light_samples.rays.origins.store(half, point);
        light_samples.rays.directions.store(half, to_light);
        light_samples.limits.store(half, limit);
    }
    let outside = lit.surfaces.from_outside;
    aim.facing = (above & outside | below & !outside) & active & in_range;
    aim.behind = (below & outside | above & !outside) & active & in_range;
    aim.escalated = active & !in_range;
    aim
}

fn lit_point<'a>(
    lit: &ShadingPacket<'_>,
    lane: usize,
    material: &'a SurfaceMaterial,
    sample_id: SampleId,
) -> ShadingPoint<'a> {
    ShadingPoint {
        arriving: lit.rays.directions.get(lane),
        path: lit.paths.places[lane],
        point: lit.surfaces.points.get(lane),
        normal: facing_normal(lit.surfaces, lane),
        material,
        diffuse: lit.diffuse.get(lane),
        ambient: lit.ambient.get(lane),
        sample_id,
    }
}

/// The origin of a light's rays.
enum LightPosition {
    /// The position of a point light or spot light.
    Place(DVec3),
    /// The sample points of an area light, one per lane.
    Places,
    /// The directions to the points of a dome of this radius, one per lane.
    Dome(f64),
    /// The direction to a directional light; [`scaled`].
    Direction(DVec3),
}

/// Returns the origin of a light's rays; `None` if it contributes nothing. The sample points of area lights and the directions to those of
/// domes are stored in `light_samples`.
#[inline(always)]
fn target<S: Simd>(
    simd: S,
    light: &PreparedLight,
    effects: Effects,
    lit: &ShadingPacket<'_>,
    sample: u32,
    light_samples: &mut LightSamplePacket,
) -> Option<LightPosition> {
    match light.source {
        LightSource::Point(place) | LightSource::Spot(place, _) => Some(LightPosition::Place(place)),
        LightSource::Directional(direction) => Some(LightPosition::Direction(scaled(direction)?.0)),
        LightSource::Sphere { .. } | LightSource::Rectangle { .. } | LightSource::Dome { .. }
            if !effects.extras =>
        {
            None
        }
        LightSource::Sphere { .. } | LightSource::Rectangle { .. } | LightSource::Dome { .. } => {
            lit.places.find(simd, &light.source, lit.surfaces, sample, &mut light_samples.places);
            Some(match light.source {
                LightSource::Dome { radius } => LightPosition::Dome(radius),
                _ => LightPosition::Places,
            })
        }
    }
}

/// Returns the directions to the light, its `t` along them, and a mask of the lanes in which both are valid. Replaces the directions to the
/// points of a dome by these points.
#[inline(always)]
fn way<S: Simd>(
    simd: S,
    target: &LightPosition,
    point: F64s3<S>,
    (light_samples, half): (&mut LightSamplePacket, usize),
) -> (F64s3<S>, F64s<S>, Mask<S>) {
    let place = match *target {
        LightPosition::Place(place) => splat3(simd, place),
        LightPosition::Places => light_samples.places.load(simd, half),
        LightPosition::Dome(radius) => {
            let towards = light_samples.places.load(simd, half);
            let place = add(point, times(towards, splat(simd, radius)));
            light_samples.places.store(half, place);
            let Scaled { direction, length, in_range } = scaled_lanes(simd, towards);
            let is_same =
                place[0].simd_eq(point[0]) & place[1].simd_eq(point[1]) & place[2].simd_eq(point[2]);
            return (direction, length * radius, in_range & finite3(simd, place) & !is_same);
        }
        LightPosition::Direction(direction) => {
            return (splat3(simd, direction), splat(simd, f64::INFINITY), finite3(simd, point));
        }
    };
    let Scaled { direction, length, in_range } = scaled_lanes(simd, subtract(place, point));
    (direction, length, in_range)
}
