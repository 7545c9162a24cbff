//! What comes through between a surface and a light.
//!
//! Opaque shapes let nothing through. Clear ones let k_t through at each crossing of their surface, and exp(-absorption length)
//! inside, without bending the ray: shadows of glass are tinted, and no light is gathered in them.

use super::direct::ShadowRay;
use super::effects::Effects;
use super::geometry::Leaves;
use super::media::{Inside, Nesting};
use super::scratch::Scratch;
use super::surroundings::transmittance;
use super::{PreparedScene, Slot, Surface};
use crate::color::Rgb;

/// Where a shadow ray crosses a clear shape's surface.
#[derive(Clone, Copy, Debug)]
pub(super) struct Crossing {
    pub(super) t: f64,
    pub(super) slot: Slot,
    pub(super) entering: bool,
}

/// What a clear solid does to a shadow ray.
#[derive(Clone, Copy, Debug)]
pub(super) struct Filter {
    slot: Slot,
    crossings: u32,
    /// How far the ray goes in it, as far as it is the last entered.
    length: f64,
}

/// What share of a light comes to a surface point, channel by channel; `None` where nothing does. The light is given by its own
/// shape, and by what hid it from the last point that asked, which is asked first: neighbours are mostly in the same shadow.
/// `inside` are the solids that the surface is seen from.
#[inline(always)]
pub(super) fn visibility<E: Effects>(
    scene: &PreparedScene,
    leaves: &impl Leaves,
    shadow_ray: ShadowRay<'_>,
    (own_shape, last_occluder): (Option<Slot>, &mut Option<Slot>),
    (surface, inside): (&Surface, Inside),
    scratch: &mut Scratch<'_>,
) -> Option<Rgb> {
    let ShadowRay { ray, limit, .. } = shadow_ray;
    if !E::CLEAR_SHADOWS {
        if let Some(slot) = *last_occluder
            && Some(slot) != own_shape
            && leaves.stands_before(slot, ray, &limit, &mut scratch.guards)
        {
            return None;
        }
        *last_occluder = scene.occluder(leaves, ray, &limit, own_shape, scratch);
        return last_occluder.is_none().then_some(Rgb::ONE);
    }
    let hidden = scene.is_hidden_or_filtered(leaves, ray, &limit, own_shape, scratch);
    (!hidden).then(|| filtered(scene, shadow_ray, own_shape, (surface, inside), scratch))
}

/// What clear shapes leave of the light, given in `scratch.crossings` where the ray crosses them: the product of k_t for every
/// crossing and of what is absorbed in between, shape by shape in document order.
pub(super) fn filtered(
    scene: &PreparedScene,
    shadow_ray: ShadowRay<'_>,
    own_shape: Option<Slot>,
    (surface, inside): (&Surface, Inside),
    scratch: &mut Scratch<'_>,
) -> Rgb {
    let Scratch { crossings, nesting, filters, .. } = scratch;
    if crossings.is_empty() && !shadow_ray.from_behind && inside == Inside::NONE {
        return Rgb::ONE;
    }
    filters.clear();
    // Places in the nesting that are made here are of no use to anybody else.
    let mark = nesting.mark();
    let mut inside = inside;
    if shadow_ray.from_behind {
        inside = nesting.through(scene, inside, surface, shadow_ray.ray.direction());
        filters.push(Filter { slot: surface.hit.slot, crossings: 1, length: 0.0 });
    }
    crossings.sort_unstable_by(|one, other| one.t.total_cmp(&other.t).then(one.slot.cmp(&other.slot)));
    let per_t = shadow_ray.ray.direction().length();
    let mut from = 0.0;
    let mut passed = |nesting: &Nesting, inside: Inside, to: f64| {
        if let Some(slot) = nesting.solids(inside).find(|slot| Some(*slot) != own_shape) {
            let length = (to - from) * per_t;
            filters.push(Filter { slot, crossings: 0, length: length.max(0.0) });
        }
        from = to;
    };
    for crossing in crossings.iter() {
        if !scene.may_nest(crossing.slot) {
            continue;
        }
        passed(nesting, inside, crossing.t);
        inside = if crossing.entering {
            nesting.entered(inside, crossing.slot)
        } else {
            nesting.left(inside, crossing.slot)
        };
    }
    passed(nesting, inside, shadow_ray.limit.t());
    filters.extend(crossings.iter().map(|crossing| Filter {
        slot: crossing.slot,
        crossings: 1,
        length: 0.0,
    }));
    nesting.truncate(mark);
    filters.retain(|filter| Some(filter.slot) != own_shape);
    product(scene, filters)
}

fn product(scene: &PreparedScene, filters: &mut [Filter]) -> Rgb {
    // Parts of one solid's way stay in their order along the ray.
    filters.sort_by_key(|filter| filter.slot);
    let mut share = Rgb::ONE;
    for same in filters.chunk_by(|one, other| one.slot == other.slot) {
        let Some(refraction) = scene.material(same[0].slot).refraction else { continue };
        for _ in 0..same.iter().map(|filter| filter.crossings).sum() {
            share *= refraction.transmitted;
        }
        let length = same.iter().map(|filter| filter.length).sum();
        share *= transmittance(refraction.absorption, length);
    }
    share
}
