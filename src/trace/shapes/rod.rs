//! Rods: cylinders and capsules.

use glam::DVec3;

use super::bounds::Bounds;
use super::end_planes::EndPlanes;
use super::exact_rod::{ExactRod, START};
use super::intersection::{
    ExactCrossing, ExactHit, Face, Facet, Intersection, Intersections, Refined, RefinedHit,
};
use super::rod_core::{OwnPlace, OwnRays, OwnStep, RodCore};
use super::slabs::ExactSlab;
use super::sphere::U;
use crate::trace::math::{Compensated, Double, Double3, Exact3, Real, moderate3, spread, subtract, times};
use crate::trace::rays::{PreparedRay, Rays};

/// A rod, rigidly moved and uniformly scaled.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Rod {
    start: DVec3,
    stop: DVec3,
    core: RodCore,
}

impl Rod {
    /// Creates a cylinder, from the centre of one end to that of the other. `None` if rounding leaves it no interior.
    #[must_use]
    pub fn cylinder(from: DVec3, to: DVec3, radius: f64) -> Option<Self> {
        let row = Double3::difference(to, from);
        Self::exact_cylinder([from.into(), to.into()], row, radius)
    }

    /// Creates a cylinder from double-double values. `row` is the normal of its ends, of any length. Each plane is rounded once.
    #[must_use]
    pub(crate) fn exact_cylinder(ends: [Double3; 2], row: Double3, radius: f64) -> Option<Self> {
        Self::new(ends.map(Double3::rounded), radius, Some(EndPlanes::new(row, ends)?))
    }

    /// Creates a capsule, from the centre of the sphere at one end to that of the other. `None` if the two are equal.
    #[must_use]
    pub fn capsule(from: DVec3, to: DVec3, radius: f64) -> Option<Self> {
        Self::new([from, to], radius, None)
    }

    fn new([start, stop]: [DVec3; 2], radius: f64, planes: Option<EndPlanes>) -> Option<Self> {
        let core = RodCore::new(Double3::difference(stop, start), radius, planes)?;
        Some(Self { start, stop, core })
    }

    /// Returns the ends of the axis.
    #[must_use]
    pub fn ends(&self) -> [DVec3; 2] {
        [self.start, self.stop]
    }

    /// Returns the radius.
    #[must_use]
    pub fn radius(&self) -> f64 {
        self.core.radius
    }

    /// Returns whether the ends are round, as those of a capsule.
    #[must_use]
    pub fn is_round(&self) -> bool {
        self.core.planes.is_none()
    }

    /// Returns the normal of a cylinder's ends, of any length, and its products with points of both.
    #[must_use]
    pub fn slab(&self) -> Option<(DVec3, [f64; 2])> {
        self.core.planes.map(|planes| planes.slab())
    }

    #[inline(always)]
    fn own<R: Real>(&self, rays: &Rays<R>) -> OwnRays<R> {
        let like = rays.origin[0];
        OwnRays {
            origin: subtract(rays.origin, spread(like, self.start)),
            to_stop: subtract(spread(like, self.stop), rays.origin),
            direction: rays.direction,
            u: U,
        }
    }

    pub(super) fn exact(&self, origin: DVec3, direction: Exact3) -> ExactRod {
        let start = Exact3::from(self.start);
        ExactRod {
            origin: &Exact3::from(origin) - &start,
            direction,
            stop: &Exact3::from(self.stop) - &start,
            factor: 1.0.into(),
            radius: self.core.radius,
        }
    }

    pub(super) fn exact_slab(&self, origin: DVec3, direction: &Exact3) -> Option<ExactSlab> {
        self.core.planes.map(|planes| planes.exact(origin, direction))
    }

    /// Returns the smallest `t >= 0` on the rod.
    #[must_use]
    #[inline]
    pub(crate) fn intersect(&self, ray: &PreparedRay) -> Intersection {
        self.intersections(&ray.into()).into()
    }

    /// Intersects rays with the rod. `None` if all rays certainly miss.
    #[inline(always)]
    pub(crate) fn intersections<R: Real>(&self, rays: &Rays<R>) -> Option<Intersections<R>> {
        self.core.intersections(rays, &self.own(rays))
    }

    /// Finds the exits of rays that start on the rod and go inwards.
    #[inline(always)]
    pub(crate) fn exits<R: Real>(&self, rays: &Rays<R>) -> Intersections<R> {
        self.core.exits(rays, &self.own(rays))
    }

    /// Returns the exact entry and exit of the ray's line.
    pub(crate) fn cross_exactly(&self, origin: DVec3, direction: &Exact3) -> Option<ExactCrossing> {
        self.exact(origin, direction.clone()).cross(self.exact_slab(origin, direction))
    }

    /// Returns the exact exit of a ray that starts on the rod and goes inwards.
    pub(crate) fn exit_exactly(&self, origin: DVec3, direction: &Exact3) -> Option<ExactHit> {
        self.exact(origin, direction.clone()).exit(self.exact_slab(origin, direction))
    }

    /// Returns the hit near an approximate `t`: [`Rod::refined`]. Returns `None` near edges, where the face is uncertain.
    #[must_use]
    pub(crate) fn refine(&self, origin: DVec3, direction: DVec3, t: f64, far: bool) -> Option<RefinedHit> {
        self.refined(&Rays::new(origin, direction), t, far).into()
    }

    /// Refines a `t` near the rod by one Newton step towards the face. Rays in `far` come from inside. Not found near edges, and where one
    /// step does not suffice.
    #[inline(always)]
    pub(crate) fn refined<R: Real>(&self, rays: &Rays<R>, t: R, far: R::Mask) -> Refined<R> {
        let own = self.own(rays);
        let face = self.core.face(rays, &own, t, far);
        let place = Compensated::along(rays.origin, rays.direction, t);
        let from_start = place.minus(spread(t, self.start));
        let from_stop = place.minus(spread(t, self.stop));
        let own_place = OwnPlace { from_start, from_stop };
        let OwnStep { step, normal, found } = self.core.step(&own_place, rays.direction, t, (&face, U));
        let curved = Refined {
            t: Double::sum(t, step),
            point: place.moved(times(rays.direction, step)),
            normal,
            found: found & face.certain & moderate3(place.rounded()),
        };
        match &self.core.planes {
            Some(planes) => planes.refined(place, rays, t, (&face, curved)),
            None => curved,
        }
    }

    /// Always returns `None`: a `t` with few certain bits is solved exactly.
    pub(crate) fn solve(&self, _origin: DVec3, _direction: DVec3, _t: f64) -> Option<RefinedHit> {
        None
    }

    /// Returns the exit of a ray that starts on the rod and goes inwards.
    #[must_use]
    pub(crate) fn exit(&self, origin: DVec3, direction: DVec3) -> Intersection {
        self.exits(&Rays::new(origin, direction)).into()
    }

    /// Returns the hit at `t` on a face.
    pub(crate) fn surface_point(&self, origin: DVec3, direction: DVec3, t: Double, face: Face) -> RefinedHit {
        let place = Compensated::along(origin, direction, t.rounded());
        let way = direction * t.rest();
        let normal = match &self.core.planes {
            Some(planes) if face.axis == START.axis => planes.normal(face.upper),
            _ => {
                let (from_start, from_stop) = (place.minus(self.start), place.minus(self.stop));
                self.core.normal(&OwnPlace { from_start, from_stop }, way, face)
            }
        };
        RefinedHit { t, point: place.moved(way).into(), normal }
    }

    /// Returns the plane of the flat end that is certainly hit at `t`.
    pub(crate) fn facet(&self, origin: DVec3, direction: DVec3, t: f64, far: bool) -> Option<Facet> {
        let planes = self.core.planes?;
        let rays = Rays::new(origin, direction);
        let face = self.core.face(&rays, &self.own(&rays), t, far).face()?;
        (face.axis == START.axis).then(|| planes.facet(face.upper))
    }

    /// Returns whether the point is strictly inside.
    #[must_use]
    pub fn contains(&self, point: DVec3) -> bool {
        let own = (point - self.start, 2.0 * U);
        self.core.contains(point, own, || self.exact(point, Exact3::from(DVec3::ZERO)))
    }

    /// Returns the bounding box.
    #[must_use]
    pub fn bounds(&self) -> Bounds {
        let (least, most) = (self.start.min(self.stop), self.start.max(self.stop));
        let radius = self.core.radius;
        let across = |axis: usize| {
            let (next, last) = ((axis + 1) % 3, (axis + 2) % 3);
            libm::hypot(self.core.axis[0][next], self.core.axis[0][last]) / self.core.length
        };
        let reach = match self.core.planes {
            Some(_) => DVec3::new(across(0), across(1), across(2)) * radius,
            None => DVec3::splat(radius),
        };
        // A few units in the last place of the planes and of the side.
        let size = least.abs().max(most.abs()).max_element() + radius;
        let reach = reach + DVec3::splat(size * (8.0 * f64::EPSILON));
        Bounds { min: Bounds::around(least, reach).min, max: Bounds::around(most, reach).max }
    }
}
