//! Affine images of rods: stretched or sheared.
//!
//! Rays are transformed into the rod's own space, which leaves `t` unchanged. The flat ends of a cylinder are planes in world space.

use glam::{DAffine3, DMat3, DVec3};

use super::affine_map::{AffineMap, bounds_of_image};
use super::bounds::Bounds;
use super::end_planes::EndPlanes;
use super::exact_rod::{ExactRod, START};
use super::intersection::{
    ExactCrossing, ExactHit, Face, Facet, Intersection, Intersections, Refined, RefinedHit,
};
use super::rod_core::{OwnPlace, OwnRays, OwnStep, RodCore};
use super::slabs::ExactSlab;
use super::sphere::U;
use crate::trace::math::{
    Compensated, Double, Double3, Exact, Exact3, Real, moderate3, spread, subtract, times,
};
use crate::trace::rays::{PreparedRay, Rays};

/// A rod under an affine map, which takes the start of its axis from the origin to its place in the world.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct RodImage {
    map: AffineMap,
    core: RodCore,
}

impl RodImage {
    /// Creates the image of a cylinder from the origin to `stop`. `None` if rounding leaves it no interior. The map must be invertible.
    #[must_use]
    pub fn cylinder(forward: DAffine3, stop: DVec3, radius: f64) -> Option<Self> {
        let map = AffineMap::new(forward);
        let start = Double3::from(forward.translation);
        let end = start + Double3::from(forward.transform_vector3(stop));
        let row = map.row(stop.into());
        Some(Self { core: RodCore::new(stop.into(), radius, Some(EndPlanes::new(row, [start, end])?))?, map })
    }

    /// Creates the image of a capsule from the origin to `stop`. `None` if `stop` is the origin. The map must be invertible.
    #[must_use]
    pub fn capsule(forward: DAffine3, stop: DVec3, radius: f64) -> Option<Self> {
        Some(Self { core: RodCore::new(stop.into(), radius, None)?, map: AffineMap::new(forward) })
    }

    /// Creates the image of a cylinder whose ends are planes with the normal `row` through two points.
    #[must_use]
    pub(crate) fn exact_cylinder(
        forward: DAffine3,
        stop: DVec3,
        radius: f64,
        (row, ends): (Double3, [Double3; 2]),
    ) -> Option<Self> {
        let core = RodCore::new(stop.into(), radius, Some(EndPlanes::new(row, ends)?))?;
        Some(Self { map: AffineMap::new(forward), core })
    }

    /// Returns the map.
    #[must_use]
    pub fn forward(&self) -> &DAffine3 {
        self.map.forward()
    }

    /// Returns the inverse map as the translation, which is subtracted first, and the inverse of the linear part.
    pub(crate) fn back(&self) -> (DVec3, &DMat3) {
        self.map.inverse()
    }

    /// Returns the stop of the axis before the map.
    #[must_use]
    pub fn stop(&self) -> DVec3 {
        self.core.stop
    }

    /// Returns the radius before the map.
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
        let Rays { origin, direction } = self.map.back(rays);
        let to_stop = subtract(spread(origin[0], self.core.stop), origin);
        OwnRays { origin, to_stop, direction, u: self.u() }
    }

    /// Returns a bound of the relative error of rays in the rod's own space.
    fn u(&self) -> f64 {
        U * self.map.roughness()
    }

    /// Returns points relative to both ends of the axis, before the map.
    #[inline(always)]
    fn own_place<R: Real>(&self, from_start: Compensated<R>) -> OwnPlace<R> {
        let like = from_start.rounded()[0];
        OwnPlace { from_start, from_stop: from_start.minus(spread(like, self.core.stop)) }
    }

    pub(super) fn exact(&self, origin: DVec3, direction: &Exact3) -> ExactRod {
        let (to_start, way, determinant) = self.map.exactly_back(origin, direction);
        let zero = Exact3([Exact::ZERO, Exact::ZERO, Exact::ZERO]);
        let origin = &zero - &to_start;
        let stop = Exact3::from(self.core.stop);
        let radius = self.core.radius;
        if determinant.sign().is_lt() {
            let [origin, direction] = [&zero - &origin, &zero - &way];
            return ExactRod { origin, direction, stop, factor: -&determinant, radius };
        }
        ExactRod { origin, direction: way, stop, factor: determinant, radius }
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
        self.exact(origin, direction).cross(self.exact_slab(origin, direction))
    }

    /// Returns the exact exit of a ray that starts on the rod and goes inwards.
    pub(crate) fn exit_exactly(&self, origin: DVec3, direction: &Exact3) -> Option<ExactHit> {
        self.exact(origin, direction).exit(self.exact_slab(origin, direction))
    }

    /// Returns the hit near an approximate `t`: [`RodImage::refined`]. Returns `None` near edges, where the face is uncertain.
    #[must_use]
    pub(crate) fn refine(&self, origin: DVec3, direction: DVec3, t: f64, far: bool) -> Option<RefinedHit> {
        self.refined(&Rays::new(origin, direction), t, far).into()
    }

    /// Refines a `t` near the rod by one Newton step towards the face, in the rod's own space. Rays in `far` come from inside. Not found
    /// near edges, and where one step does not suffice.
    #[inline(always)]
    pub(crate) fn refined<R: Real>(&self, rays: &Rays<R>, t: R, far: R::Mask) -> Refined<R> {
        let own = self.own(rays);
        let face = self.core.face(rays, &own, t, far);
        let place = Compensated::along(rays.origin, rays.direction, t);
        let (from_start, moderate) = self.map.compensated_back(place);
        let OwnStep { step, normal, found } =
            self.core.step(&self.own_place(from_start), own.direction, t, (&face, self.u()));
        let curved = Refined {
            t: Double::sum(t, step),
            point: place.moved(times(rays.direction, step)),
            normal: self.map.normal(normal),
            found: found & face.certain & moderate & moderate3(place.rounded()),
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
                let own = self.own_place(self.map.compensated_back(place).0);
                let normal = self.core.normal(&own, self.map.vector_back(way), face);
                self.map.normal(normal.into()).into()
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
        let own = self.map.vector_back(point - self.forward().translation);
        self.core.contains(point, (own, self.u()), || self.exact(point, &DVec3::ZERO.into()))
    }

    /// Returns the bounding box, or `None` if the map is too ill-conditioned for a reliable one.
    #[must_use]
    pub fn bounds(&self) -> Option<Bounds> {
        let (stop, forward) = (self.core.stop, *self.forward());
        let middle = DAffine3 { translation: forward.transform_point3(0.5 * stop), ..forward };
        bounds_of_image(&middle, 0.5 * stop.abs() + self.core.radius, self.map.condition())
    }
}
