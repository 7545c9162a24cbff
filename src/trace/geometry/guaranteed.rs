//! Every verdict and every digit right: `f64` where its error bounds suffice, exact arithmetic where they do not.

use std::cmp::Ordering;

use glam::DVec3;

use super::{Geometry, Kind, Leaves, Place, Slot};
use crate::trace::algebraic::Exact3;
use crate::trace::exact::{Double, Double3};
use crate::trace::shapes::{Face, Meeting, Side, Verdict};
use crate::trace::{Guards, Hit, Limit, Ray, Refined, Root};

/// 2^-36: nearer to a light than so, compared with its distance, what a ray meets is compared with the light's exact place, which
/// the ray, of a rounded direction, passes by.
const NEAR: f64 = f64::from_bits((1023 - 36) << 52);

/// 2^-44: some units in the last place of a light's place, which is rounded too: a panel flush with a ceiling is on it.
const ROUNDED: f64 = f64::from_bits((1023 - 44) << 52);

/// 2^-20: a normal that is on the wrong side by more than so is not so by rounding.
const CLEARLY: f64 = f64::from_bits((1023 - 20) << 52);

/// Evaluates an expression with `$shape` bound to the shape at a slot, whatever its kind.
macro_rules! ask {
    ($geometry:expr, $slot:expr, $shape:ident => $question:expr) => {{
        let Place { kind, index } = $geometry.places[$slot.index()];
        let index = index as usize;
        match kind {
            Kind::Sphere => {
                let $shape = &$geometry.spheres[index];
                $question
            }
            Kind::Plane => {
                let $shape = &$geometry.planes[index];
                $question
            }
            Kind::AlignedBox => {
                let $shape = &$geometry.boxes[index];
                $question
            }
            Kind::SphereImage => {
                let $shape = &$geometry.sphere_images[index];
                $question
            }
            Kind::BoxImage => {
                let $shape = &$geometry.box_images[index];
                $question
            }
        }
    }};
}

impl Leaves for Geometry {
    /// The shape that the ray leaves is met again only from inside, on its far side; and so is every other shape whose
    /// surface coincided with it where the ray starts, each in its own sense.
    #[inline]
    fn first_hit(&self, slot: Slot, ray: &Ray, guards: &mut Guards) -> Option<Hit> {
        if let Some(departure) = ray.departure() {
            if slot == departure.slot {
                return if departure.outward { None } else { self.far_hit(slot, ray, guards) };
            }
            if let Some(normal) = departure.ties.normal_of(slot) {
                return if ray.direction().dot(normal) < 0.0 {
                    self.far_hit(slot, ray, guards)
                } else {
                    None
                };
            }
        }
        self.near_hit(slot, ray, guards)
    }

    #[inline]
    fn compare(&self, ray: &Ray, hit: &Hit, other: &Hit, guards: &mut Guards) -> Ordering {
        if !hit.root.may_equal(&other.root) {
            return hit.root.t().total_cmp(&other.root.t());
        }
        guards.contested += 1;
        if self.meet_one_plane(hit, other, ray) {
            return Ordering::Equal;
        }
        match (self.exactly(hit.slot, hit.far, ray), self.exactly(other.slot, other.far, ray)) {
            (Some(one), Some(two)) => one.t.cmp(&two.t),
            _ => hit.root.t().total_cmp(&other.root.t()),
        }
    }

    #[inline]
    fn is_before(&self, hit: &Hit, ray: &Ray, limit: &Limit, guards: &mut Guards) -> bool {
        let (nearer, farther) = (limit.t() * (1.0 - NEAR), limit.t() * (1.0 + NEAR));
        if hit.root.latest() < nearer || hit.root.earliest() > farther {
            return hit.root.latest() < nearer;
        }
        guards.contested += 1;
        self.exactly_before(hit, ray, limit)
    }

    #[inline(always)]
    fn refined(&self, ray: &Ray, hit: &Hit, guards: &mut Guards) -> Refined {
        let (origin, direction, t) = (ray.origin(), ray.direction(), hit.root.t());
        if !hit.root.is_rounded()
            && !hit.root.is_rough()
            && let Some(refined) = ask!(self, hit.slot, shape => shape.refined(origin, direction, t, hit.far))
        {
            return refined;
        }
        self.refined_specially(ray, hit, guards)
    }

    #[inline]
    fn certain_crossings(&self, slot: Slot, ray: &Ray, limit: &Limit) -> Option<u32> {
        self.crossings_at_a_glance(slot, ray, limit)
    }
}

impl Geometry {
    /// What a hit found whose `t` is not just a few roundings off, or that is near an edge.
    #[cold]
    fn refined_specially(&self, ray: &Ray, hit: &Hit, guards: &mut Guards) -> Refined {
        let (origin, direction, t) = (ray.origin(), ray.direction(), hit.root.t());
        if hit.root.is_rough() && !hit.root.is_rounded() {
            guards.rough += 1;
            if let Some(solved) = ask!(self, hit.slot, shape => shape.solved(origin, direction, t)) {
                return solved;
            }
        }
        let Some(meeting) = self.exactly(hit.slot, hit.far, ray) else {
            return ask!(self, hit.slot, shape => shape.surface_on(origin, direction, t.into(), Face::default()));
        };
        let (t, face) = (meeting.t.rounded(), meeting.face);
        let refined = ask!(self, hit.slot, shape => shape.surface_on(origin, direction, t, face));
        // From so far away that the shape is smaller than the points there are, no normal can be told but by its side.
        let direction = direction.normalize();
        let wrong = match meeting.side {
            Side::Entry => refined.normal.dot(direction) > CLEARLY,
            Side::Exit => refined.normal.dot(direction) < -CLEARLY,
            Side::Either => false,
        };
        if wrong {
            let outward = if matches!(meeting.side, Side::Entry) { -direction } else { direction };
            return Refined { normal: outward, ..refined };
        }
        refined
    }

    /// Is the point inside the shape, as solids go?
    #[must_use]
    pub(in crate::trace) fn contains(&self, slot: Slot, point: DVec3) -> bool {
        ask!(self, slot, shape => shape.contains(point))
    }

    /// How far on a line leaves a shape that it enters at a point of its surface. `None` where it never does.
    #[must_use]
    pub(in crate::trace) fn far_side(&self, slot: Slot, point: DVec3, direction: DVec3) -> Option<f64> {
        match ask!(self, slot, shape => shape.far_hit(point, direction)) {
            Verdict::Hit(root) => Some(root.t()),
            Verdict::Miss => None,
            Verdict::Open => {
                let exit = ask!(self, slot, shape => shape.exit(point, &direction.into()))?;
                Some(exit.t.rounded().rounded())
            }
        }
    }

    #[inline]
    fn near_hit(&self, slot: Slot, ray: &Ray, guards: &mut Guards) -> Option<Hit> {
        // The ray is read by each kind of shape for itself: copied here, it would go through memory a second time.
        let verdict = ask!(self, slot, shape => shape.first_hit(ray));
        self.decided(verdict, slot, false, ray, guards)
    }

    #[cold]
    fn far_hit(&self, slot: Slot, ray: &Ray, guards: &mut Guards) -> Option<Hit> {
        let verdict = ask!(self, slot, shape => shape.far_hit(ray.origin(), ray.direction()));
        self.decided(verdict, slot, true, ray, guards)
    }

    #[inline(always)]
    fn decided(
        &self,
        verdict: Verdict,
        slot: Slot,
        far: bool,
        ray: &Ray,
        guards: &mut Guards,
    ) -> Option<Hit> {
        let root = match verdict {
            Verdict::Hit(root) => root,
            Verdict::Miss => return None,
            Verdict::Open => {
                guards.open += 1;
                Root::rounded(self.exactly(slot, far, ray)?.t.rounded())
            }
        };
        // What is infinitely far away is not met.
        (root.t() < f64::INFINITY).then_some(Hit { root, slot, far })
    }

    /// Where the ray first meets the shape, or, if it starts there and goes inwards, where it comes out; without any rounding.
    #[cold]
    fn exactly(&self, slot: Slot, far: bool, ray: &Ray) -> Option<Meeting> {
        self.exactly_met(slot, far, ray.origin(), &ray.direction().into())
    }

    fn exactly_met(&self, slot: Slot, far: bool, origin: DVec3, direction: &Exact3) -> Option<Meeting> {
        if far {
            return ask!(self, slot, shape => shape.exit(origin, direction));
        }
        let crossing = ask!(self, slot, shape => shape.crossing(origin, direction))?;
        crossing.into_iter().find(|meeting| meeting.t.sign().is_ge())
    }

    /// Do both meet one and the same plane, as they do where faces are flush? Then they need not be compared.
    fn meet_one_plane(&self, hit: &Hit, other: &Hit, ray: &Ray) -> bool {
        let facet = |hit: &Hit| {
            let (origin, direction, t) = (ray.origin(), ray.direction(), hit.root.t());
            ask!(self, hit.slot, shape => shape.facet(origin, direction, t, hit.far))
        };
        facet(hit).is_some_and(|one| facet(other) == Some(one))
    }

    /// Does the shape stand between the ray's origin and the light's very place, which the ray passes by as far as its direction is
    /// rounded? A shape that the light lies on, as far as its place is known, does not.
    #[cold]
    fn exactly_before(&self, hit: &Hit, ray: &Ray, limit: &Limit) -> bool {
        let (slot, origin) = (hit.slot, ray.origin());
        let exact_way = Double3::difference(limit.place(), origin);
        let way = exact_way.rounded();
        let sizes = origin.abs().max_element() + limit.place().abs().max_element();
        let latest = -ROUNDED * sizes / way.abs().max_element();
        if let Some(met) = ask!(self, slot, shape => shape.refined(origin, way, 1.0, hit.far)) {
            // A direction that is off by u in each coordinate is off by so much in t, times 1 over the cosine.
            let error = 16.0 * f64::EPSILON * (1.0 + way.length() / met.normal.dot(way).abs());
            let beyond = (met.t - Double::from(1.0)).rounded() - latest;
            if beyond.abs() > error {
                return beyond < 0.0;
            }
        }
        self.exactly_met(slot, hit.far, origin, &exact_way.into())
            .is_some_and(|met| (met.t.rounded() - Double::from(1.0)).rounded() < latest)
    }
}
