//! The transition from a ray to rays of another class that start at its end, which may see other shapes.

use std::ptr;

use super::context::{RenderContext, outer_first};
use super::medium_stack::{MediumStack, MediumStacks};
use super::scratch::LightScratch;
use crate::trace::intersect::{SurfacePoint, UnseenShape};
use crate::trace::rays::{CoincidentHits, PreparedRay, ShapeId, Tie};
use crate::trace::scene::PreparedScene;

/// Returns a surface point, found by `ray` in the scene `from`, as it is left by rays that see the scene `to`: with the shapes of that scene
/// that coincide there, which these rays must not hit, and the solids of that scene that contain `ray` at its end. `medium` is the stack of
/// the solids of `from` that contain it.
pub(crate) fn handed_over(
    context: &RenderContext<'_>,
    (from, to): (&PreparedScene, &PreparedScene),
    (ray, surface): (&PreparedRay, &SurfacePoint),
    medium: MediumStack,
    LightScratch { search, media, .. }: &mut LightScratch<'_>,
) -> (SurfacePoint, MediumStack) {
    // Most often, nothing else is there. The reference path tests every shape all the same.
    let is_alone = || {
        let has_equals = from.equal_shapes.group(surface.first_equal).is_some();
        surface.ties == CoincidentHits::NONE
            && medium == MediumStack::NONE
            && !has_equals
            && !to.sees_more_than(from)
    };
    if ptr::eq(from, to) || !surface.point.is_finite() || (!context.scans_all && is_alone()) {
        return (*surface, medium);
    }
    let unseen = if context.scans_all {
        to.unseen_of_all(from, (ray, surface), search)
    } else {
        to.unseen(from, (ray, surface), search)
    };
    let before = search.ties.of(surface.ties);
    let mut ties = before.to_vec();
    let first_equal = Tie { id: surface.first_equal, normal: surface.normal };
    for Tie { id, normal } in before.iter().chain([&first_equal]) {
        // Of equal shapes, rays of each class query the first one that they see.
        let seen = from.equal_shapes.group(*id).and_then(|group| group.ids().iter().find(|id| to.sees(**id)));
        ties.extend(seen.map(|id| Tie { id: to.first_equal(*id), normal: *normal }));
    }
    ties.extend(unseen.iter().filter_map(|shape| Some(Tie { id: shape.id, normal: shape.normal? })));
    ties.sort_by_key(|tie| tie.id.0);
    ties.dedup_by_key(|tie| tie.id);
    ties.retain(|tie| tie.id != surface.first_equal);
    let mut surface = *surface;
    if ties.len() != before.len() {
        surface.ties = search.ties.add(ties.into_iter());
    }
    let in_media = context.effects.in_media();
    (surface, if in_media { solids_of(to, medium, &unseen, media) } else { medium })
}

/// Returns the stack of the solids of a scene among those of another scene in `medium`, and of the solids that were unseen.
fn solids_of(
    scene: &PreparedScene,
    medium: MediumStack,
    unseen: &[UnseenShape],
    media: &mut MediumStacks,
) -> MediumStack {
    let before: Vec<ShapeId> = media.solids(medium).collect();
    let mut solids: Vec<ShapeId> = before.iter().copied().filter(|id| scene.sees(*id)).collect();
    let kept = solids.len();
    let around = unseen.iter().filter(|shape| shape.contains_ray).map(|shape| shape.id);
    // A ray in a solid is also in all solids equal to it.
    for id in solids.clone().into_iter().chain(around) {
        for solid in scene.media_at(&id) {
            if !solids.contains(solid) {
                solids.push(*solid);
            }
        }
    }
    let added = solids.len() > kept;
    solids.retain(|id| scene.may_be_medium(*id));
    if solids == before {
        return medium;
    }
    solids.reverse();
    if added {
        solids.sort_by(|one, other| outer_first(scene, *one, *other));
    }
    solids.into_iter().fold(MediumStack::NONE, |medium, id| media.added(medium, id))
}
