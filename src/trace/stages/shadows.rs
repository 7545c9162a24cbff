//! Which of a light's proposals come through.

use fearless_simd::{dispatch, prelude::*};

use super::buffers::TileBuffers;
use super::tile::Sample;
use crate::trace::light::{MediumStack, PathState, ProposalPacket, visibility};
use crate::trace::math::{LANES, dot_lanes as dot, lanes, splat};
use crate::trace::packet::{Occlusion, ShadowPacket, WaysToLight, occluded};
use crate::trace::query::{Intersector, SurfacePacket};
use crate::trace::rays::RayPacket;
use crate::trace::scene::{Light, LightSource, Precision};

/// Follows the shadow rays of what was proposed for a light, number `place` of those that are on: drops what is hidden, and
/// weakens what comes through clear shapes.
pub(super) fn shadows(
    sample: &Sample<'_>,
    shapes: &impl Intersector,
    (place, light): (usize, &Light),
    buffers: &mut TileBuffers<'_>,
) {
    buffers.entered.shadows += 1;
    let context = sample.context;
    let scene = context.scene;
    // Where there were too many shapes for one wave, there are for the next.
    let listed = !buffers.crowded_lights[place] && find_candidates(sample, light, buffers);
    buffers.crowded_lights[place] |= listed && buffers.candidates.all_crowded();
    for packet in 0..buffers.wave.count {
        let asking = buffers.proposals[packet].asking;
        if asking == 0 {
            continue;
        }
        buffers.rays_traced.shadow += u64::from(asking.count_ones());
        let candidates = if listed { buffers.candidates.of(packet) } else { None };
        let last_occluder = &mut buffers.last_occluders[place];
        let proposals = &mut buffers.proposals[packet];
        let Occlusion { hidden, mut open } = if scene.precision == Precision::Guaranteed {
            let rays = &mut buffers.shadow_rays;
            dispatch!(scene.simd.level(), simd => leave(simd, &buffers.surfaces[packet], proposals, rays));
            let shadow = ShadowPacket {
                rays,
                limits: &proposals.limits,
                except: light.own_shape,
                candidates,
                clear: context.effects.clear_shadows(),
            };
            let search = &mut buffers.scratch.search;
            let effort = (&mut search.escalations, search.cancelled);
            occluded(scene, &shadow, last_occluder, &mut search.packet_stack, effort)
        } else {
            Occlusion { hidden: 0, open: asking }
        };
        if context.effects.clear_shadows() {
            open |= asking & (proposals.from_behind | inside(&buffers.wave.states[packet], asking));
        }
        proposals.lanes &= !hidden;
        for lane in lanes(open & !hidden) {
            let (surfaces, hits) = (&buffers.surfaces[packet], &buffers.hits[packet]);
            let Some(point) = surfaces.get(lane, hits) else { continue };
            let shadow_ray = &proposals.way(light, lane).ray(&point);
            let seen = (&point, buffers.wave.states[packet][lane].medium);
            let occluders = (light.own_shape, &mut *last_occluder, candidates);
            let scratch = &mut buffers.scratch;
            let share = visibility(context.effects, scene, shapes, shadow_ray, occluders, seen, scratch);
            match share {
                Some(share) if context.effects.clear_shadows() => {
                    proposals.colors.set(lane, proposals.colors.get(lane) * share);
                }
                Some(_) => {}
                None => proposals.lanes &= !(1 << lane),
            }
        }
    }
}

/// Returns the lanes of points that are seen from inside of clear solids.
fn inside(states: &[PathState; LANES], asking: u32) -> u32 {
    let inside = |lane: &usize| states[*lane].medium != MediumStack::NONE;
    lanes(asking).filter(inside).fold(0, |mask, lane| mask | 1 << lane)
}

/// Lets rays leave the surface points towards a light.
#[inline(always)]
fn leave<S: Simd>(simd: S, surfaces: &SurfacePacket, proposals: &ProposalPacket, rays: &mut RayPacket) {
    rays.origins = surfaces.points;
    rays.directions = proposals.directions;
    for half in 0..2 {
        let direction = rays.directions.load(simd, half);
        rays.inverse_squares.store(half, splat(simd, 1.0) / dot(direction, direction));
    }
    rays.lanes = proposals.asking;
    rays.left = surfaces.first_equals;
    rays.departing = proposals.asking;
    rays.outward = surfaces.from_outside ^ proposals.from_behind;
    rays.tied = surfaces.tied & proposals.asking;
}

/// Finds what may stand between a light and all points that it was proposed for. Says whether it did: rays to a light with a
/// size, or to one that is infinitely far away, have no point in common.
fn find_candidates(sample: &Sample<'_>, light: &Light, buffers: &mut TileBuffers<'_>) -> bool {
    let (LightSource::Point(place) | LightSource::Spot(place, _)) = light.source else { return false };
    // The textbook's shapes accept rays that pass them by more than bundles allow for.
    if sample.context.scene.precision != Precision::Guaranteed {
        return false;
    }
    let TileBuffers { wave, proposals, candidates, scratch, .. } = buffers;
    let ways = proposals[..wave.count].iter().map(|proposals| WaysToLight {
        directions: &proposals.directions,
        limits: &proposals.limits,
        lanes: proposals.asking,
    });
    candidates.find(sample.context.scene, place, ways, &mut scratch.search)
}
