//! Transmittance between a surface and a light.
//!
//! Opaque shapes occlude the light. Transparent shapes transmit k_t at each crossing of their surface, and exp(-absorption length) inside
//! (Beer's law), without bending the ray: shadows of glass are tinted, and there are no caustics.

use super::direct::{ShadowRay, ShadowSegment};
use super::filter::Filter;
use super::medium_stack::{MediumStack, MediumStacks};
use super::scratch::LightScratch;
use crate::color::Rgb;
use crate::trace::bvh::LeafId;
use crate::trace::effects::Effects;
use crate::trace::intersect::{Crossed, Crossing, Scratch, SurfacePoint};
use crate::trace::rays::{RayView, ShapeId, TieLists};
use crate::trace::scene::{PreparedScene, transmittance};

/// Returns the share of a light that reaches a surface point, per channel; `None` if the light is occluded. `own_shape` is the light's own
/// shape, which does not occlude it. `last_occluder` occluded the light at the previous shading point. It is tested first, because
/// neighbouring points are usually in the same shadow, and it is updated. If `candidates` are given, no other shapes of the tree are
/// tested. `medium` is the stack of transparent solids from which the surface is seen.
#[inline(always)]
pub(crate) fn visibility(
    effects: Effects,
    scene: &PreparedScene,
    shadow_ray: &ShadowRay,
    (own_shape, last_occluder, candidates): (Option<ShapeId>, &mut Option<ShapeId>, Option<&[LeafId]>),
    (surface, medium): (&SurfacePoint, MediumStack),
    scratch: &mut LightScratch<'_>,
) -> Option<Rgb> {
    let ShadowRay { ray, limit, .. } = shadow_ray;
    let Scratch { intersector, ties, .. } = &mut scratch.search;
    if let Some(id) = *last_occluder
        && Some(id) != own_shape
        && intersector.occludes(scene.geometry(), id, &RayView::new(ray, ties), limit)
    {
        return None;
    }
    if !effects.transparent_shadows() {
        *last_occluder = scene.occluder(ray, limit, (own_shape, candidates), &mut scratch.search);
        return last_occluder.is_none().then_some(Rgb::ONE);
    }
    *last_occluder = scene.occluder_or_crossed(ray, limit, (own_shape, candidates), &mut scratch.search);
    let visible = last_occluder.is_none();
    visible.then(|| filtered(scene, shadow_ray, own_shape, (surface, medium), scratch))
}

/// Computes the transmittance of the transparent shapes along the ray, which are in `scratch.search.crossed`.
fn filtered(
    scene: &PreparedScene,
    shadow_ray: &ShadowRay,
    own_shape: Option<ShapeId>,
    (surface, medium): (&SurfacePoint, MediumStack),
    scratch: &mut LightScratch<'_>,
) -> Rgb {
    if scratch.search.crossed.is_empty() && !shadow_ray.from_behind && medium == MediumStack::NONE {
        return Rgb::ONE;
    }
    let absorbs = |id: ShapeId| {
        scene.material(id).refraction.is_some_and(|refraction| refraction.absorption != Rgb::ZERO)
    };
    let behind = shadow_ray.from_behind.then_some(surface);
    let mut behind = behind.into_iter().flat_map(|surface| {
        let tied = scratch.search.ties.of(surface.ties).iter().map(|tie| tie.id);
        tied.chain([surface.first_equal])
    });
    let absorbed = scene.surfaces().absorbs
        && (scratch.search.crossed.iter().any(|crossed| absorbs(crossed.id()))
            || scratch.media.solids(medium).any(absorbs)
            || behind.any(|first_equal| scene.media_at(&first_equal).iter().copied().any(absorbs)));
    if absorbed {
        filtered_and_absorbed(scene, shadow_ray, own_shape, (surface, medium), scratch)
    } else {
        filtered_alone(scene, shadow_ray, own_shape, surface, scratch)
    }
}

/// Computes [`filtered_and_absorbed`] without absorption, for which the positions of the crossings do not matter.
fn filtered_alone(
    scene: &PreparedScene,
    ShadowRay { ray, limit, from_behind }: &ShadowRay,
    own_shape: Option<ShapeId>,
    surface: &SurfacePoint,
    scratch: &mut LightScratch<'_>,
) -> Rgb {
    let Scratch { crossed, crossings, intersector, ties, .. } = &mut scratch.search;
    let own_id = own_crossing(scene, surface, ties);
    let ray = &RayView::new(ray, ties);
    if *from_behind && Some(own_id) != own_shape {
        crossed.push(Crossed::Times(own_id, 1));
    }
    crossed.sort_unstable_by_key(|crossed| scene.order().rank(crossed.id()));
    let mut share = Rgb::ONE;
    for crossed in crossed.iter() {
        let Some(refraction) = scene.material(crossed.id()).refraction else { continue };
        let times = if let Crossed::Times(_, times) = crossed {
            *times
        } else {
            crossings.clear();
            crossed.cross(scene, (ray, limit), crossings, intersector);
            if crossings.len() > 1 { 2 } else { 1 }
        };
        for _ in 0..times {
            share *= refraction.transmitted;
        }
    }
    share
}

/// Computes the transmittance of the transparent shapes along the ray, which are in `scratch.search.crossed`: the product of k_t for every
/// crossing and of the transmittances between crossings, shape by shape in document order.
pub(crate) fn filtered_and_absorbed(
    scene: &PreparedScene,
    shadow_ray: &ShadowRay,
    own_shape: Option<ShapeId>,
    (surface, medium): (&SurfacePoint, MediumStack),
    scratch: &mut LightScratch<'_>,
) -> Rgb {
    let Scratch { crossed, crossings, intersector, ties, .. } = &mut scratch.search;
    let ShadowRay { ray, limit, .. } = shadow_ray;
    let ray = &RayView::new(ray, ties);
    crossings.clear();
    for crossed in crossed.iter() {
        crossed.cross(scene, (ray, limit), crossings, intersector);
    }
    let segment =
        ShadowSegment { direction: ray.direction(), limit: *limit, from_behind: shadow_ray.from_behind };
    absorbed_along(scene, &segment, own_shape, (surface, medium), scratch)
}

/// Computes the transmittance of transparent shapes from the crossings of the ray in `scratch.search.crossings`, in any order.
pub(crate) fn filtered_along(
    scene: &PreparedScene,
    segment: &ShadowSegment,
    own_shape: Option<ShapeId>,
    (surface, medium): (&SurfacePoint, MediumStack),
    scratch: &mut LightScratch<'_>,
) -> Rgb {
    if !segment.from_behind && medium == MediumStack::NONE {
        match scratch.search.crossings[..] {
            [] => return Rgb::ONE,
            // Fast path: usually the ray crosses a single solid from one side to the other.
            [into, out] if into.id == out.id && into.entering && scene.may_be_medium(into.id) => {
                let length = (out.t - into.t) * segment.direction.length();
                let filter = Filter { id: into.id, crossings: 2, length: length.max(0.0) };
                return product(scene, &mut [filter]);
            }
            _ => {}
        }
    }
    absorbed_along(scene, segment, own_shape, (surface, medium), scratch)
}

/// Computes [`filtered_along`] for any number of solids.
fn absorbed_along(
    scene: &PreparedScene,
    ShadowSegment { direction, limit, from_behind }: &ShadowSegment,
    own_shape: Option<ShapeId>,
    (surface, medium): (&SurfacePoint, MediumStack),
    scratch: &mut LightScratch<'_>,
) -> Rgb {
    let LightScratch { search, media, filters } = scratch;
    let Scratch { crossings, ties, .. } = search;
    filters.clear();
    // Stacks that are created here are temporary.
    let mark = media.mark();
    let mut medium = medium;
    if *from_behind {
        medium = media.through(scene, medium, surface, ties, *direction);
        filters.push(Filter { id: own_crossing(scene, surface, ties), crossings: 1, length: 0.0 });
    }
    sort_along_ray(scene, crossings);
    let per_t = direction.length();
    let mut from = 0.0;
    // Adds the segment from `from` to `to` to the last entered solid that is not the shape of the light.
    let mut passed = |media: &MediumStacks, medium: MediumStack, to: f64| {
        if let Some(id) = media.solids(medium).find(|id| Some(*id) != own_shape) {
            let length = (to - from) * per_t;
            filters.push(Filter { id, crossings: 0, length: length.max(0.0) });
        }
        from = to;
    };
    for crossing in crossings.iter() {
        if !scene.may_be_medium(crossing.id) {
            continue;
        }
        passed(media, medium, crossing.t);
        medium = if crossing.entering {
            media.entered(medium, crossing.id)
        } else {
            media.left(medium, crossing.id)
        };
    }
    passed(media, medium, limit.t());
    filters.extend(crossings.iter().map(|crossing| Filter { id: crossing.id, crossings: 1, length: 0.0 }));
    media.truncate(mark);
    filters.retain(|filter| Some(filter.id) != own_shape);
    product(scene, filters)
}

/// Returns the shape whose surface light from behind crosses at a surface point: the shaded one or, if shadow rays do not see it, the first
/// transparent one that coincides with it and that they do see.
fn own_crossing(scene: &PreparedScene, surface: &SurfacePoint, ties: &TieLists) -> ShapeId {
    let id = surface.hit.id;
    if scene.material(id).refraction.is_some() {
        return id;
    }
    let coincident = ties.of(surface.ties).iter().flat_map(|tie| scene.media_at(&tie.id)).copied();
    coincident.min_by_key(|id| scene.order().rank(*id)).unwrap_or(id)
}

/// Sorts crossings from the surface to the light. At equal `t`, shapes are in document order, and entering a shape precedes leaving it.
fn sort_along_ray(scene: &PreparedScene, crossings: &mut [Crossing]) {
    let rank = |crossing: &Crossing| scene.order().rank(crossing.id);
    crossings.sort_unstable_by(|one, other| {
        let along = one.t.total_cmp(&other.t).then(rank(one).cmp(&rank(other)));
        along.then(other.entering.cmp(&one.entering))
    });
}

fn product(scene: &PreparedScene, filters: &mut [Filter]) -> Rgb {
    // The sort is stable: segments inside the same solid stay in their order along the ray.
    filters.sort_by_key(|filter| scene.order().rank(filter.id));
    let mut share = Rgb::ONE;
    for same in filters.chunk_by(|one, other| one.id == other.id) {
        let Some(refraction) = scene.material(same[0].id).refraction else { continue };
        for _ in 0..same.iter().map(|filter| filter.crossings).sum() {
            share *= refraction.transmitted;
        }
        if refraction.absorption != Rgb::ZERO {
            let length = same.iter().map(|filter| filter.length).sum();
            share *= transmittance(refraction.absorption, length);
        }
    }
    share
}
