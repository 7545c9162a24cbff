//! Every verdict and every digit right: `f64` where its error bounds suffice, a hundred bits where they do not.

use std::cmp::Ordering;

use glam::DVec3;

use super::{Geometry, Kind, Leaves, Place, Slot};
use crate::trace::exact::{Double, Double3};
use crate::trace::shapes::Verdict;
use crate::trace::{Guards, Hit, Limit, Ray, Refined, Root};

/// 2^-90: surfaces that a ray meets nearer to each other than so, compared with how far they are, are in the same place. Faces
/// are flush then that would be but for the rounding of a hundred bits.
const SAME: f64 = f64::from_bits((1023 - 90) << 52);

/// 2^-36: nearer to a light than so, compared with its distance, what a ray meets is compared with the light's exact place, which
/// the ray, of a rounded direction, passes by.
const NEAR: f64 = f64::from_bits((1023 - 36) << 52);

/// 2^-44: some units in the last place of a light's place, which is rounded too: a panel flush with a ceiling is on it.
const ROUNDED: f64 = f64::from_bits((1023 - 44) << 52);

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
                return if departure.outward { None } else { self.far_hit(slot, ray) };
            }
            if let Some(normal) = departure.ties.normal_of(slot) {
                return if ray.direction().dot(normal) < 0.0 { self.far_hit(slot, ray) } else { None };
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
        let difference = self.exact_t(hit, ray) - self.exact_t(other, ray);
        let scale = hit.root.t() + ray.origin().abs().max_element();
        if difference.rounded().abs() <= SAME * scale { Ordering::Equal } else { difference.sign() }
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
        if hit.far || hit.root.is_rounded() || hit.root.is_rough() {
            return self.refined_specially(ray, hit, guards);
        }
        let (origin, direction, t) = (ray.origin(), ray.direction(), hit.root.t());
        ask!(self, hit.slot, shape => shape.refined(origin, direction, t))
    }
}

impl Geometry {
    /// What a hit found whose `t` is not just a few roundings off.
    #[cold]
    fn refined_specially(&self, ray: &Ray, hit: &Hit, guards: &mut Guards) -> Refined {
        let (origin, direction, t) = (ray.origin(), ray.direction(), hit.root.t());
        if hit.far {
            // As exact as the point that the ray starts from.
            return ask!(self, hit.slot, shape => shape.surface_at(origin, direction, t.into(), true));
        }
        if hit.root.is_rounded() {
            let t = self.exact_t(hit, ray);
            return ask!(self, hit.slot, shape => shape.surface_at(origin, direction, t, false));
        }
        guards.rough += 1;
        ask!(self, hit.slot, shape => shape.solved(origin, direction, t))
    }

    /// Is the point inside the shape, as solids go?
    #[must_use]
    pub(in crate::trace) fn contains(&self, slot: Slot, point: DVec3) -> bool {
        ask!(self, slot, shape => shape.contains(point))
    }

    /// How far on a line leaves a shape that it enters at a point of its surface. `None` where it never does.
    #[must_use]
    pub(in crate::trace) fn far_side(&self, slot: Slot, point: DVec3, direction: DVec3) -> Option<f64> {
        ask!(self, slot, shape => shape.far_hit(point, direction)).map(|root| root.t())
    }

    #[inline]
    fn near_hit(&self, slot: Slot, ray: &Ray, guards: &mut Guards) -> Option<Hit> {
        // The ray is read by each kind of shape for itself: copied here, it would go through memory a second time.
        let root = match ask!(self, slot, shape => shape.first_hit(ray)) {
            Verdict::Hit(root) => root,
            Verdict::Miss => return None,
            Verdict::Open => {
                guards.open += 1;
                Root::rounded(self.exact_hit(slot, ray)?)
            }
        };
        // What is infinitely far away is not met.
        (root.t() < f64::INFINITY).then_some(Hit { root, slot, far: false })
    }

    #[cold]
    fn far_hit(&self, slot: Slot, ray: &Ray) -> Option<Hit> {
        let root = ask!(self, slot, shape => shape.far_hit(ray.origin(), ray.direction()))?;
        Some(Hit { root, slot, far: true })
    }

    #[cold]
    fn exact_hit(&self, slot: Slot, ray: &Ray) -> Option<Double> {
        ask!(self, slot, shape => shape.exact_hit(ray.origin(), ray.direction()))
    }

    /// Does the shape stand between the ray's origin and the light's very place? A shape that the light lies
    /// on, as far as its place is known, does not.
    #[cold]
    fn exactly_before(&self, hit: &Hit, ray: &Ray, limit: &Limit) -> bool {
        let (slot, origin) = (hit.slot, ray.origin());
        let way = Double3::difference(limit.place(), origin);
        let met = if hit.far {
            ask!(self, slot, shape => shape.exact_far_hit(origin, way))
        } else {
            ask!(self, slot, shape => shape.exact_hit(origin, way))
        };
        let sizes = origin.abs().max_element() + limit.place().abs().max_element();
        let rounding = ROUNDED * sizes / way.rounded().abs().max_element();
        met.is_some_and(|t| (t - Double::from(1.0)).rounded() < -rounding)
    }

    /// A hit's `t` with a hundred bits.
    fn exact_t(&self, hit: &Hit, ray: &Ray) -> Double {
        let (slot, origin, direction) = (hit.slot, ray.origin(), ray.direction());
        let exact = if hit.far {
            ask!(self, slot, shape => shape.exact_far_hit(origin, direction))
        } else {
            self.exact_hit(slot, ray)
        };
        exact.unwrap_or_else(|| hit.root.t().into())
    }
}
