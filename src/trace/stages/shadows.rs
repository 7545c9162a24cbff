//! Occlusion of light samples.

use glam::DVec3;

use super::buffers::TileBuffers;
use super::clear_shadows::weaken;
use super::slots::Sample;
use crate::trace::math::{HALF, lanes};
use crate::trace::packet::{LightBox, LitPoints, Occluders, Occlusion, ShadowPacket, WaysToLight, occluded};
use crate::trace::scene::{LightSource, Precision, PreparedLight};
use crate::trace::shading::visibility;

/// Traces the shadow rays of a light sample. Drops occluded contributions, and attenuates those that pass through transparent shapes. `place`
/// is the index of the light among the enabled lights.
pub(super) fn shadows(
    sample: &Sample<'_>,
    (place, light, light_sample): (usize, &PreparedLight, u32),
    buffers: &mut TileBuffers<'_>,
) {
    buffers.stage_runs.shadows += 1;
    if light_sample == 0 {
        // A light with too many possible occluders for one wavefront has too many for the next.
        buffers.listed = !buffers.crowded_lights[place] && find_candidates(sample, light, buffers);
        buffers.crowded_lights[place] |= buffers.listed && buffers.candidates.all_crowded();
    }
    let listed = buffers.listed;
    for packet in 0..buffers.wavefront.count {
        let asking = buffers.light_samples[packet].asking;
        if asking == 0 {
            continue;
        }
        buffers.rays_traced.shadow += u64::from(asking.count_ones());
        let hidden = if listed { asking & buffers.candidates.hidden(packet) } else { 0 };
        buffers.light_samples[packet].drop_hidden(hidden);
        let asking = asking & !hidden;
        if asking == 0 {
            continue;
        }
        if listed && are_clear(packet, buffers) {
            if sample.context.effects.clear_shadows() {
                buffers.packet_scratch.crossed.clear();
                weaken(sample, light, packet, asking, buffers);
            }
            continue;
        }
        let Occlusion { hidden, undecided } = occlusion(sample, (place, light), (packet, listed), buffers);
        buffers.light_samples[packet].drop_hidden(hidden);
        if sample.context.effects.clear_shadows() {
            weaken(sample, light, packet, asking & !hidden & !undecided, buffers);
        }
        follow(sample, (place, light), (packet, listed), undecided & !hidden, buffers);
    }
}

/// Returns whether nothing can occlude the remaining shadow rays of a packet.
fn are_clear(packet: usize, buffers: &TileBuffers<'_>) -> bool {
    let TileBuffers { light_samples, candidates, .. } = buffers;
    // A ray that leaves coincident surfaces can still hit the far side of a shape that it enters.
    light_samples[packet].rays.tied == 0 && candidates.is_clear(packet)
}

/// Finds the shadow rays of a packet that are certainly occluded, and those that have to be traced one by one.
fn occlusion(
    sample: &Sample<'_>,
    (place, light): (usize, &PreparedLight),
    (packet, listed): (usize, bool),
    buffers: &mut TileBuffers<'_>,
) -> Occlusion {
    let scene = sample.context.scene;
    let TileBuffers { light_samples, candidates, last_occluders, scratch, packet_scratch, .. } = buffers;
    let light_samples = &light_samples[packet];
    if scene.precision != Precision::Robust {
        return Occlusion { hidden: 0, undecided: light_samples.asking };
    }
    let shadow = ShadowPacket {
        rays: &light_samples.rays,
        limits: &light_samples.limits,
        light: place_of(light),
        occluders: occluders(sample, light),
        unbounded: if listed { candidates.unbounded() } else { &scene.unbounded },
        candidates: [0, 1].map(|half| if listed { candidates.of(packet, half) } else { None }),
    };
    let cancelled = scratch.search.cancelled;
    occluded(scene, &shadow, &mut last_occluders[place], packet_scratch, cancelled)
}

/// Traces the shadow rays in the lanes `undecided` of a packet one by one.
fn follow(
    sample: &Sample<'_>,
    (place, light): (usize, &PreparedLight),
    (packet, listed): (usize, bool),
    undecided: u32,
    buffers: &mut TileBuffers<'_>,
) {
    let (scene, effects) = (sample.context.scene, sample.context.effects);
    let TileBuffers { wavefront, hits, surfaces, light_samples, candidates, last_occluders, scratch, .. } =
        buffers;
    let light_samples = &mut light_samples[packet];
    for lane in lanes(undecided) {
        let Some(point) = surfaces[packet].get(lane, &hits[packet]) else { continue };
        let shadow_ray = &light_samples.way(light, lane).ray(&point);
        let seen = (&point, wavefront.paths[packet].media[lane]);
        let candidates = if listed { candidates.of(packet, lane / HALF) } else { None };
        let occluders = (light.own_shape, &mut last_occluders[place], candidates);
        match visibility(effects, scene, shadow_ray, occluders, seen, scratch) {
            Some(share) if effects.clear_shadows() => {
                light_samples.colors.set(lane, light_samples.colors.get(lane) * share);
            }
            Some(_) => {}
            None => light_samples.lanes &= !(1 << lane),
        }
    }
}

/// Returns the kinds of shapes that can occlude a light.
fn occluders(sample: &Sample<'_>, light: &PreparedLight) -> Occluders {
    Occluders { except: light.own_shape, clear: sample.context.effects.clear_shadows() }
}

/// Returns the common end point of all rays to a light, if there is one.
fn place_of(light: &PreparedLight) -> Option<DVec3> {
    match light.source {
        LightSource::Point(place) | LightSource::Spot(place, _) => Some(place),
        LightSource::Directional(_) | LightSource::Sphere { .. } | LightSource::Rectangle { .. } => None,
    }
}

/// Collects the possible occluders between a light and the surface points: for an area light, those on the way to any point of it. Returns
/// `false` if there are no candidate lists. Directional lights never have any, as their rays form no bundle.
fn find_candidates(sample: &Sample<'_>, light: &PreparedLight, buffers: &mut TileBuffers<'_>) -> bool {
    // Naive shapes accept rays that miss them by more than the tolerance of bundles.
    if sample.context.scene.precision != Precision::Robust {
        return false;
    }
    let TileBuffers { wavefront, surfaces, light_samples, candidates, scratch, .. } = buffers;
    let (scene, search) = (sample.context.scene, &mut scratch.search);
    let Some(place) = place_of(light) else {
        let Some((middle, reach)) = light.source.extent() else { return false };
        let points = surfaces[..wavefront.count].iter().map(|surfaces| LitPoints {
            points: &surfaces.points,
            left: &surfaces.first_equals,
            lanes: surfaces.lanes,
        });
        let light = (LightBox { middle, reach }, occluders(sample, light));
        return candidates.find_all(scene, light, &points, search);
    };
    let ways = light_samples[..wavefront.count].iter().map(|light_samples| WaysToLight {
        rays: &light_samples.rays,
        limits: &light_samples.limits,
        lanes: light_samples.asking,
    });
    candidates.find(scene, (place, occluders(sample, light)), &ways, search)
}
