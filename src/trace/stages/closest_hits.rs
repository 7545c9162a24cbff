//! Closest-hit search for the rays of the wavefront.

use super::buffers::TileBuffers;
use super::tile::PACKETS;
use super::wavefront::RayOrigin;
use crate::trace::math::lanes;
use crate::trace::packet::{bundle_hits, closest_hits as packet_hits, lens_hits};
use crate::trace::scene::Precision;
use crate::trace::shading::RenderContext;

/// Finds the closest hits of the wavefront. Rays that start at one point or on a lens are traced together, others packet by packet. Lanes that
/// remain undecided are traced as single rays, with the same result.
pub(super) fn closest_hits(context: &RenderContext<'_>, buffers: &mut TileBuffers<'_>) {
    buffers.stage_runs.closest_hits += 1;
    let TileBuffers { wavefront, hits, spread, scratch, packet_scratch, .. } = buffers;
    let (scene, search) = (context.scene, &mut scratch.search);
    search.tied_hits.clear();
    // Camera rays use all packets of a tile, though some may be empty.
    let count = if matches!(wavefront.start, RayOrigin::Anywhere) { wavefront.count } else { PACKETS };
    let (rays, hits) = (&wavefront.rays[..count], &mut hits[..count]);
    if scene.precision != Precision::Robust {
        for (rays, hits) in rays.iter().zip(&mut *hits) {
            hits.clear();
            hits.undecided = rays.lanes;
        }
    } else if !match wavefront.start {
        RayOrigin::Eye(eye) => bundle_hits(scene, eye, rays, hits, (search, packet_scratch)),
        RayOrigin::Lens => lens_hits(scene, &spread.candidates, rays, hits, packet_scratch, search.cancelled),
        RayOrigin::Anywhere => false,
    } {
        for (rays, hits) in rays.iter().zip(&mut *hits) {
            packet_hits(scene, rays, hits, packet_scratch, search.cancelled);
        }
    }
    for (rays, hits) in rays.iter().zip(hits) {
        for lane in lanes(hits.undecided) {
            hits.set(lane, scene.closest(&rays.get(lane), search));
        }
    }
}
