//! The transition from the wavefront's rays to shadow rays, which may see other shapes.

use std::ptr;

use super::buffers::TileBuffers;
use crate::trace::math::lanes;
use crate::trace::rays::CoincidentHits;
use crate::trace::shading::{MediumStack, RenderContext, handed_over};

/// A surface point that shadow rays leave otherwise than the wavefront's rays do.
struct Handover {
    packet: usize,
    lane: usize,
    ties: CoincidentHits,
    medium: MediumStack,
}

/// Runs `light` with the surface points and the media of the wavefront as shadow rays see them, and restores both.
pub(super) fn with_shadow_scene<'a>(
    context: &RenderContext<'_>,
    buffers: &mut TileBuffers<'a>,
    light: impl FnOnce(&mut TileBuffers<'a>),
) {
    let from = buffers.wavefront.scene(context);
    if ptr::eq(from, context.shadow) || !context.effects.shadows() {
        light(buffers);
        return;
    }
    let TileBuffers { wavefront, hits, surfaces, scratch, .. } = buffers;
    let mark = scratch.media.mark();
    let mut seen = Vec::new();
    for packet in 0..wavefront.count {
        for lane in lanes(surfaces[packet].lanes) {
            if scratch.search.is_cancelled() {
                return;
            }
            let Some(point) = surfaces[packet].get(lane, &hits[packet]) else { continue };
            let (ray, medium) = (wavefront.rays[packet].get(lane), wavefront.paths[packet].media[lane]);
            let to = (from, context.shadow);
            let (shown, inside) = handed_over(context, to, (&ray, &point), medium, scratch);
            if shown.ties != point.ties || inside != medium {
                seen.push(Handover { packet, lane, ties: shown.ties, medium: inside });
            }
        }
    }
    swap(&mut seen, buffers);
    light(buffers);
    swap(&mut seen, buffers);
    // The stacks made for shadow rays are at the end.
    buffers.scratch.media.truncate(mark);
}

/// Exchanges the ties and media of surface points.
fn swap(handovers: &mut [Handover], buffers: &mut TileBuffers<'_>) {
    for Handover { packet, lane, ties, medium } in handovers {
        let surfaces = &mut buffers.surfaces[*packet];
        let before =
            surfaces.get(*lane, &buffers.hits[*packet]).map_or(CoincidentHits::NONE, |point| point.ties);
        surfaces.set_ties(*lane, *ties);
        *ties = before;
        std::mem::swap(medium, &mut buffers.wavefront.paths[*packet].media[*lane]);
    }
}
