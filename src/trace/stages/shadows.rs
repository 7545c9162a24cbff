//! Which of a light's proposals come through.

use super::buffers::TileBuffers;
use super::tile::Sample;
use crate::trace::light::{Proposal, WayToLight, visibility};
use crate::trace::query::Intersector;
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
    let listed = find_candidates(sample, light, buffers);
    let context = sample.context;
    let TileBuffers { wave, surfaces, proposals, candidates, scratch, rays_traced, last_occluders, .. } =
        buffers;
    let last_occluder = &mut last_occluders[place];
    proposals.retain_mut(|(at, Proposal { color, shadow })| {
        let Some(way) = shadow else { return true };
        rays_traced.shadow += 1;
        let surface = &surfaces[*at as usize];
        let queued = &wave[surface.ray as usize];
        let shadow_ray = &way.ray(&surface.point);
        let seen = (&surface.point, queued.tree.state.medium);
        let candidates = if listed { candidates.of(queued.part.into()) } else { None };
        let occluders = (light.own_shape, &mut *last_occluder, candidates);
        let share = visibility(context.effects, context.scene, shapes, shadow_ray, occluders, seen, scratch);
        if context.effects.clear_shadows()
            && let Some(share) = share
        {
            *color *= share;
        }
        share.is_some()
    });
}

/// Finds what may stand between a light and all points that it was proposed for. Says whether it did: rays to a light with a
/// size, or to one that is infinitely far away, have no point in common.
fn find_candidates(sample: &Sample<'_>, light: &Light, buffers: &mut TileBuffers<'_>) -> bool {
    if !matches!(light.source, LightSource::Point(_) | LightSource::Spot(..)) {
        return false;
    }
    // The textbook's shapes accept rays that pass them by more than bundles allow for.
    if sample.context.scene.precision != Precision::Guaranteed {
        return false;
    }
    let TileBuffers { wave, surfaces, proposals, candidates, scratch, .. } = buffers;
    let rays = proposals.iter().filter_map(|(at, Proposal { shadow, .. })| {
        let WayToLight { direction, limit, .. } = shadow.as_ref()?;
        let part = wave[surfaces[*at as usize].ray as usize].part;
        Some((part.into(), *direction, *limit))
    });
    candidates.find(sample.context.scene, rays, &mut scratch.search)
}
