//! Which of a light's proposals come through.

use super::buffers::TileBuffers;
use crate::trace::light::{Proposal, RenderContext, visibility};
use crate::trace::query::Intersector;
use crate::trace::scene::Light;

/// Follows the shadow rays of what was proposed for a light, number `place` of those that are on: drops what is hidden, and
/// weakens what comes through clear shapes.
pub(super) fn shadows(
    context: &RenderContext<'_>,
    shapes: &impl Intersector,
    (place, light): (usize, &Light),
    buffers: &mut TileBuffers<'_>,
) {
    buffers.entered.shadows += 1;
    let TileBuffers { wave, surfaces, proposals, scratch, rays_traced, last_occluders, .. } = buffers;
    let last_occluder = &mut last_occluders[place];
    proposals.retain_mut(|(at, Proposal { color, shadow })| {
        let Some(way) = shadow else { return true };
        rays_traced.shadow += 1;
        let surface = &surfaces[*at as usize];
        let shadow_ray = &way.ray(&surface.point);
        let seen = (&surface.point, wave[surface.ray as usize].tree.state.medium);
        let occluders = (light.own_shape, &mut *last_occluder);
        let share = visibility(context.effects, context.scene, shapes, shadow_ray, occluders, seen, scratch);
        if context.effects.clear_shadows()
            && let Some(share) = share
        {
            *color *= share;
        }
        share.is_some()
    });
}
