//! What each ray of the wave meets first.

use super::buffers::TileBuffers;
use super::tile::Sample;
use crate::trace::light::RenderContext;
use crate::trace::query::Intersector;
use crate::trace::scene::Precision;

/// Finds the closest hits of the wave, ray by ray.
pub(super) fn closest_hits(
    context: &RenderContext<'_>,
    shapes: &impl Intersector,
    buffers: &mut TileBuffers<'_>,
) {
    buffers.entered.closest_hits += 1;
    let TileBuffers { wave, hits, scratch, .. } = buffers;
    hits.clear();
    scratch.search.tied_hits.clear();
    hits.extend(
        wave.iter().map(|queued| context.scene.closest(shapes, &queued.tree.ray, &mut scratch.search)),
    );
}

/// Finds the closest hits of a wave of camera rays, as many at once as they have their origin in common. What cannot be decided
/// at once is decided ray by ray, and has the same answer.
pub(super) fn camera_hits(sample: &Sample<'_>, shapes: &impl Intersector, buffers: &mut TileBuffers<'_>) {
    let scene = sample.context.scene;
    if scene.precision != Precision::Guaranteed {
        return closest_hits(sample.context, shapes, buffers);
    }
    let TileBuffers { wave, hits, scratch, bundle, .. } = buffers;
    let rays = wave.iter().map(|queued| (usize::from(queued.part), queued.tree.ray));
    let Some(open) = bundle.closest_hits(scene, rays, &mut scratch.search, hits) else {
        return closest_hits(sample.context, shapes, buffers);
    };
    buffers.entered.closest_hits += 1;
    scratch.search.tied_hits.clear();
    for index in open {
        let index = *index as usize;
        hits[index] = scene.closest(shapes, &wave[index].tree.ray, &mut scratch.search);
    }
}
