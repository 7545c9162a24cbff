//! Every verdict and every digit right: `f64` where its error bounds suffice, a hundred bits where they do not.

use std::cmp::Ordering;

use glam::DVec3;

use super::{Geometry, Kind, Leaves, Place, Slot};
use crate::trace::exact::Double;
use crate::trace::shapes::Verdict;
use crate::trace::{Guards, Hit, Ray, Refined, Root};

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
        let (origin, direction) = (ray.origin(), ray.direction());
        if let Some(departure) = ray.departure() {
            if slot == departure.slot {
                return if departure.outward { None } else { self.far_hit(slot, origin, direction) };
            }
            if let Some(normal) = departure.ties.normal_of(slot) {
                let inward = direction.dot(normal) < 0.0;
                return if inward { self.far_hit(slot, origin, direction) } else { None };
            }
        }
        self.near_hit(slot, origin, direction, guards)
    }

    #[inline]
    fn compare(&self, ray: &Ray, hit: &Hit, other: &Hit, guards: &mut Guards) -> Ordering {
        if !hit.root.may_equal(&other.root) {
            return hit.root.t().total_cmp(&other.root.t());
        }
        guards.contested += 1;
        self.exact_t(hit, ray).partial_cmp(&self.exact_t(other, ray)).unwrap_or(Ordering::Equal)
    }

    #[inline]
    fn stands_before(&self, slot: Slot, ray: &Ray, limit: f64, guards: &mut Guards) -> bool {
        let Some(hit) = self.first_hit(slot, ray, guards) else {
            return false;
        };
        if hit.root.latest() < limit || hit.root.earliest() >= limit {
            return hit.root.latest() < limit;
        }
        guards.contested += 1;
        self.exact_t(&hit, ray) < Double::from(limit)
    }

    #[inline]
    fn refined(&self, ray: &Ray, hit: &Hit, guards: &mut Guards) -> Refined {
        let (origin, direction) = (ray.origin(), ray.direction());
        // A Newton step squares the relative error, and cannot better what was decided with a hundred bits.
        if hit.far || hit.root.is_rough() || hit.root.is_rounded() {
            guards.rough += u64::from(!hit.far);
            let t = self.exact_t(hit, ray);
            return ask!(self, hit.slot, shape => shape.surface_at(origin, direction, t, hit.far));
        }
        ask!(self, hit.slot, shape => shape.refined(origin, direction, hit.root.t()))
    }
}

impl Geometry {
    #[inline]
    fn near_hit(&self, slot: Slot, origin: DVec3, direction: DVec3, guards: &mut Guards) -> Option<Hit> {
        let root = match ask!(self, slot, shape => shape.first_hit(origin, direction)) {
            Verdict::Hit(root) => root,
            Verdict::Miss => return None,
            Verdict::Open => {
                guards.open += 1;
                Root::rounded(self.exact_hit(slot, origin, direction)?)
            }
        };
        // What is infinitely far away is not met.
        (root.t() < f64::INFINITY).then_some(Hit { root, slot, far: false })
    }

    fn far_hit(&self, slot: Slot, origin: DVec3, direction: DVec3) -> Option<Hit> {
        ask!(self, slot, shape => shape.far_hit(origin, direction)).map(|root| Hit { root, slot, far: true })
    }

    #[cold]
    fn exact_hit(&self, slot: Slot, origin: DVec3, direction: DVec3) -> Option<Double> {
        ask!(self, slot, shape => shape.exact_hit(origin, direction))
    }

    /// A hit's `t` with a hundred bits. A far side's is as exact as the point that the ray starts from.
    fn exact_t(&self, hit: &Hit, ray: &Ray) -> Double {
        let inexact = || hit.root.t().into();
        if hit.far {
            return inexact();
        }
        self.exact_hit(hit.slot, ray.origin(), ray.direction()).unwrap_or_else(inexact)
    }
}
