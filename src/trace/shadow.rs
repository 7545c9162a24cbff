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
use super::{Guards, Hit, Limit, PreparedScene, Ray, Refined, Slot, Surface};
use crate::color::Rgb;

/// A clear shape in the way of a shadow ray.
#[derive(Clone, Copy, Debug)]
pub(super) enum Crossed {
    /// Its surface is crossed so many times, and nobody has asked where.
    Times(Slot, u32),
    /// First met here, before the light.
    At(Hit),
}

/// Where a shadow ray crosses a clear shape's surface.
#[derive(Clone, Copy, Debug)]
pub(super) struct Crossing {
    t: f64,
    slot: Slot,
    entering: bool,
}

/// What a clear solid does to a shadow ray.
#[derive(Clone, Copy, Debug)]
pub(super) struct Filter {
    slot: Slot,
    crossings: u32,
    /// How far the ray goes in it, as far as it is the last entered.
    length: f64,
}

/// How closely a clear shape is looked at.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) enum Look {
    /// No more than how often it is crossed, where that is certain at a glance.
    Glance,
    /// Where it is crossed.
    Whole,
}

impl Crossed {
    /// A clear shape, if it is in the way.
    #[inline]
    pub(super) fn new(
        leaves: &impl Leaves,
        slot: Slot,
        (ray, limit): (&Ray, &Limit),
        look: Look,
        guards: &mut Guards,
    ) -> Option<Self> {
        let certain = if look == Look::Glance { leaves.certain_crossings(slot, ray, limit) } else { None };
        match certain {
            Some(0) => None,
            Some(times) => Some(Self::Times(slot, times)),
            None => {
                let hit = leaves.first_hit(slot, ray, guards)?;
                leaves.is_before(&hit, ray, limit, guards).then_some(Self::At(hit))
            }
        }
    }

    /// The same of another shape that equals it.
    pub(super) fn by(self, slot: Slot) -> Self {
        match self {
            Self::Times(_, times) => Self::Times(slot, times),
            Self::At(hit) => Self::At(Hit { slot, ..hit }),
        }
    }

    fn slot(&self) -> Slot {
        match self {
            Self::Times(slot, _) => *slot,
            Self::At(hit) => hit.slot,
        }
    }

    /// Adds where the ray crosses its surface.
    fn cross(
        &self,
        scene: &PreparedScene,
        leaves: &impl Leaves,
        (ray, limit): (&Ray, &Limit),
        crossings: &mut Vec<Crossing>,
        guards: &mut Guards,
    ) {
        let hit = match self {
            Self::At(hit) => Some(*hit),
            // Asked of the one that the ray knows.
            Self::Times(slot, _) => {
                leaves.first_hit(scene.first_equal(*slot), ray, guards).map(|hit| Hit { slot: *slot, ..hit })
            }
        };
        let Some(hit) = hit else { return };
        let Refined { t, point, normal } = leaves.refined(ray, &hit, guards);
        let (t, slot) = (t.rounded(), hit.slot);
        let entering = !hit.far && ray.direction().dot(normal) < 0.0;
        crossings.push(Crossing { t, slot, entering });
        if entering && let Some(on) = scene.geometry().far_side(slot, point, ray.direction()) {
            let t = t + on;
            if t < limit.t() {
                crossings.push(Crossing { t, slot, entering: false });
            }
        }
    }
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
    if let Some(slot) = *last_occluder
        && Some(slot) != own_shape
        && leaves.stands_before(slot, ray, &limit, &mut scratch.guards)
    {
        return None;
    }
    if !E::CLEAR_SHADOWS {
        *last_occluder = scene.occluder(leaves, ray, &limit, own_shape, scratch);
        return last_occluder.is_none().then_some(Rgb::ONE);
    }
    *last_occluder = scene.occluder_or_crossed(leaves, ray, &limit, own_shape, scratch);
    let visible = last_occluder.is_none();
    visible.then(|| filtered(scene, leaves, shadow_ray, own_shape, (surface, inside), scratch))
}

/// What clear shapes leave of the light. Those in the way are in `scratch.crossed`.
fn filtered(
    scene: &PreparedScene,
    leaves: &impl Leaves,
    shadow_ray: ShadowRay<'_>,
    own_shape: Option<Slot>,
    (surface, inside): (&Surface, Inside),
    scratch: &mut Scratch<'_>,
) -> Rgb {
    if scratch.crossed.is_empty() && !shadow_ray.from_behind && inside == Inside::NONE {
        return Rgb::ONE;
    }
    let absorbs = |slot: Slot| {
        scene.material(slot).refraction.is_some_and(|refraction| refraction.absorption != Rgb::ZERO)
    };
    let behind = shadow_ray.from_behind.then_some(surface);
    let mut behind = behind.into_iter().flat_map(|surface| surface.ties.slots().chain([surface.asked]));
    let absorbed = scene.surfaces().absorbs
        && (scratch.crossed.iter().any(|crossed| absorbs(crossed.slot()))
            || scratch.nesting.solids(inside).any(absorbs)
            || behind.any(|asked| scene.nesting_at(&asked).iter().copied().any(absorbs)));
    if absorbed {
        filtered_and_absorbed(scene, leaves, shadow_ray, own_shape, (surface, inside), scratch)
    } else {
        filtered_alone(scene, leaves, shadow_ray, own_shape, surface, scratch)
    }
}

/// As [`filtered_and_absorbed`], where nothing absorbs: no matter where the crossings are.
fn filtered_alone(
    scene: &PreparedScene,
    leaves: &impl Leaves,
    ShadowRay { ray, limit, from_behind }: ShadowRay<'_>,
    own_shape: Option<Slot>,
    surface: &Surface,
    scratch: &mut Scratch<'_>,
) -> Rgb {
    let Scratch { crossed, crossings, guards, .. } = scratch;
    if from_behind && Some(surface.hit.slot) != own_shape {
        crossed.push(Crossed::Times(surface.hit.slot, 1));
    }
    crossed.sort_unstable_by_key(Crossed::slot);
    let mut share = Rgb::ONE;
    for crossed in crossed.iter() {
        let Some(refraction) = scene.material(crossed.slot()).refraction else { continue };
        let times = if let Crossed::Times(_, times) = crossed {
            *times
        } else {
            crossings.clear();
            crossed.cross(scene, leaves, (ray, &limit), crossings, guards);
            if crossings.len() > 1 { 2 } else { 1 }
        };
        for _ in 0..times {
            share *= refraction.transmitted;
        }
    }
    share
}

/// What clear shapes leave of the light, given in `scratch.crossed` what is in the ray's way: the product of k_t for every
/// crossing and of what is absorbed in between, shape by shape in document order.
pub(super) fn filtered_and_absorbed(
    scene: &PreparedScene,
    leaves: &impl Leaves,
    shadow_ray: ShadowRay<'_>,
    own_shape: Option<Slot>,
    (surface, inside): (&Surface, Inside),
    scratch: &mut Scratch<'_>,
) -> Rgb {
    let Scratch { crossed, crossings, nesting, filters, guards, .. } = scratch;
    let ShadowRay { ray, limit, .. } = shadow_ray;
    crossings.clear();
    for crossed in crossed.iter() {
        crossed.cross(scene, leaves, (ray, &limit), crossings, guards);
    }
    filters.clear();
    // Places in the nesting that are made here are of no use to anybody else.
    let mark = nesting.mark();
    let mut inside = inside;
    if shadow_ray.from_behind {
        inside = nesting.through(scene, inside, surface, ray.direction());
        filters.push(Filter { slot: surface.hit.slot, crossings: 1, length: 0.0 });
    }
    crossings.sort_unstable_by(|one, other| {
        let along = one.t.total_cmp(&other.t).then(one.slot.cmp(&other.slot));
        along.then(other.entering.cmp(&one.entering))
    });
    let per_t = ray.direction().length();
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
    passed(nesting, inside, limit.t());
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
        if refraction.absorption != Rgb::ZERO {
            let length = same.iter().map(|filter| filter.length).sum();
            share *= transmittance(refraction.absorption, length);
        }
    }
    share
}

#[cfg(test)]
mod tests {
    use glam::DVec3;
    use proptest::prelude::*;

    use super::*;
    use crate::trace::shapes::Sphere;
    use crate::trace::{Geometry, PreparedShape, SurfaceMaterial};

    /// Often where others are, so that rays graze, start on surfaces and end on them.
    fn coordinate() -> impl Strategy<Value = f64> {
        let nudge = prop_oneof![Just(0.0), -1e-15..1e-15, -1e-9..1e-9, -1e-4..1e-4];
        prop_oneof![3 => (-4..=4).prop_map(f64::from), 2 => -4.0..4.0, 1 => (-4..=4, nudge).prop_map(|(whole, off)| f64::from(whole) + off)]
    }

    fn point() -> impl Strategy<Value = DVec3> {
        (coordinate(), coordinate(), coordinate()).prop_map(DVec3::from)
    }

    fn ball(center: DVec3, radius: f64) -> PreparedScene {
        let mut geometry = Geometry::default();
        let _ = geometry.push(PreparedShape::Sphere(Sphere { center, radius }));
        PreparedScene::new(geometry, vec![SurfaceMaterial::default()])
    }

    /// How often the ray crosses the ball, if it is certain at a glance; and in fact.
    fn crossings(scene: &PreparedScene, ray: &Ray, limit: &Limit) -> (Option<u32>, usize) {
        let (leaves, slot, guards) = (scene.geometry(), Slot(0), &mut Guards::default());
        let mut crossings = Vec::new();
        if let Some(met) = Crossed::new(leaves, slot, (ray, limit), Look::Whole, guards) {
            met.cross(scene, leaves, (ray, limit), &mut crossings, guards);
        }
        (leaves.certain_crossings(slot, ray, limit), crossings.len())
    }

    proptest! {
        #![proptest_config(ProptestConfig::with_cases(20_000))]

        #[test]
        fn what_a_glance_says_is_so(center in point(), radius in 0..3_usize, from in point(), light in point()) {
            let radius = [1.0, 2.0, 0.3][radius];
            let scene = ball(center, radius);
            // Along with the ray itself, one that starts on the ball where it meets it, to either side.
            let mut rays: Vec<(Ray, Limit)> = Vec::new();
            if let Some(ray) = Ray::new(from, light - from) {
                let length = (light - from).abs().max_element() / ray.direction().abs().max_element();
                if let Some(surface) = scene.cast(&ray) {
                    rays.extend([true, false].iter().filter_map(|outward| Ray::leaving_to(&surface, *outward, light)));
                }
                rays.extend([(ray.clone(), Limit::new(length, light)), (ray, Limit::NONE)]);
            }
            for (ray, limit) in rays {
                let (certain, counted) = crossings(&scene, &ray, &limit);
                prop_assert!(certain.is_none_or(|certain| certain as usize == counted), "{certain:?}, {counted}: {ray:?} {limit:?}");
            }
        }
    }

    /// Where it is not close, a glance is enough: a test of the test above, which could not fail otherwise.
    #[test]
    fn a_glance_is_mostly_enough() {
        let scene = ball(DVec3::ZERO, 1.0);
        let limit = |t: f64| Limit::new(t, DVec3::new(-5.0 + t, 0.3, 0.2));
        let ray = Ray::new(DVec3::new(-5.0, 0.3, 0.2), DVec3::X).unwrap();
        for (t, count) in [(2.0, 0), (5.0, 1), (7.0, 2), (f64::INFINITY, 2)] {
            assert_eq!(crossings(&scene, &ray, &limit(t)), (Some(count), count as usize));
        }
        let inside = Ray::new(DVec3::new(0.1, 0.3, 0.2), DVec3::X).unwrap();
        assert_eq!(crossings(&scene, &inside, &Limit::NONE), (Some(1), 1));
        let beside = Ray::new(DVec3::new(-5.0, 1.3, 0.2), DVec3::X).unwrap();
        assert_eq!(crossings(&scene, &beside, &Limit::NONE), (Some(0), 0));
    }
}
