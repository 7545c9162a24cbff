//! Ellipsoids: affine images of spheres.
//!
//! Rays are transformed into the sphere's own space, which leaves `t` unchanged.

use glam::{DAffine3, DMat3, DVec3};

use super::affine_map::{AffineMap, bounds_of_image};
use super::bounds::Bounds;
use super::intersection::{
    ExactCrossing, ExactHit, Face, Facet, Intersection, Intersections, Refined, RefinedHit,
};
use super::sphere::{Sphere, U, far_root, first_root, last_root, roots, sphere_step};
use crate::trace::math::{
    Compensated, Double, Exact, Exact3, Real, dot, moderate, moderate3, negative, square_difference, times,
};
use crate::trace::rays::{PreparedRay, Rays};

/// A sphere under an affine map: an ellipsoid.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct SphereImage {
    map: AffineMap,
    sphere: Sphere,
}

impl SphereImage {
    /// Creates the image of an origin-centred sphere. The map must be invertible.
    #[must_use]
    pub fn new(forward: DAffine3, radius: f64) -> Self {
        Self { map: AffineMap::new(forward), sphere: Sphere { center: DVec3::ZERO, radius } }
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

    /// Returns the relative error of rays in the sphere's own space, in units of the unit roundoff.
    fn roughness(&self) -> f64 {
        self.map.roughness()
    }

    /// Returns the radius of the sphere before the map.
    #[must_use]
    pub fn radius(&self) -> f64 {
        self.sphere.radius
    }

    /// Returns the smallest `t >= 0` on the ellipsoid.
    #[must_use]
    #[inline]
    pub(crate) fn intersect(&self, ray: &PreparedRay) -> Intersection {
        self.intersections(&ray.into()).into()
    }

    /// Intersects rays with the ellipsoid. `None` if all rays certainly miss.
    #[inline(always)]
    pub(crate) fn intersections<R: Real>(&self, rays: &Rays<R>) -> Option<Intersections<R>> {
        let Rays { origin, direction } = self.map.back(rays);
        let inverse_square = origin[0].of(1.0) / dot(direction, direction);
        first_root(negative(origin), direction, inverse_square, self.sphere.radius, U * self.roughness())
    }

    /// Finds the exits of rays that start on the ellipsoid and go inwards.
    #[inline(always)]
    pub(crate) fn exits<R: Real>(&self, rays: &Rays<R>) -> Intersections<R> {
        let Rays { origin, direction } = self.map.back(rays);
        far_root(negative(origin), direction, self.sphere.radius, U * self.roughness())
    }

    /// Returns the exact entry and exit of the ray's line.
    pub(crate) fn cross_exactly(&self, origin: DVec3, direction: &Exact3) -> Option<ExactCrossing> {
        let (own, way, determinant) = self.exactly_back(origin, direction);
        roots(&own, &way, &(&determinant * &self.sphere.radius.into()))
    }

    /// Returns the exact exit of a ray that starts on the ellipsoid and goes inwards.
    pub(crate) fn exit_exactly(&self, origin: DVec3, direction: &Exact3) -> Option<ExactHit> {
        let (own, way, determinant) = self.exactly_back(origin, direction);
        Some(last_root(&own, &way, &(&determinant * &self.sphere.radius.into())))
    }

    /// Returns the vector from the origin to the centre and the direction in the sphere's own space, both multiplied by the determinant of
    /// the map; and the determinant.
    pub(super) fn exactly_back(&self, origin: DVec3, direction: &Exact3) -> (Exact3, Exact3, Exact) {
        self.map.exactly_back(origin, direction)
    }

    /// Returns the hit near an approximate `t`: [`SphereImage::refined`].
    #[must_use]
    pub(crate) fn refine(&self, origin: DVec3, direction: DVec3, t: f64, _far: bool) -> Option<RefinedHit> {
        Some(self.stepped(origin, direction, t))
    }

    fn stepped(&self, origin: DVec3, direction: DVec3, t: f64) -> RefinedHit {
        self.refined(&Rays::new(origin, direction), t).into()
    }

    /// Refines a `t` near the ellipsoid by one Newton step in the sphere's own space.
    #[inline(always)]
    pub(crate) fn refined<R: Real>(&self, rays: &Rays<R>, t: R) -> Refined<R> {
        let place = Compensated::along(rays.origin, rays.direction, t);
        let (own, found) = self.map.compensated_back(place);
        let (way, radius) = (self.map.vectors_back(rays.direction), t.of(self.sphere.radius));
        let step = sphere_step(own, way, radius);
        Refined {
            t: Double::sum(t, step),
            point: place.moved(times(rays.direction, step)),
            normal: self.map.normal(own.moved(times(way, step))),
            found: found & moderate3(own.rounded()) & moderate(radius),
        }
    }

    /// Returns the hit near a `t` with few certain bits, as [`Sphere::solve`].
    #[must_use]
    pub(crate) fn solve(&self, origin: DVec3, direction: DVec3, t: f64) -> Option<RefinedHit> {
        let better = self.stepped(origin, direction, t).t.rounded();
        let good = self.stepped(origin, direction, better).t.rounded();
        Some(self.stepped(origin, direction, good))
    }

    /// Returns the exit of a ray that starts on the ellipsoid and goes inwards.
    #[must_use]
    pub(crate) fn exit(&self, origin: DVec3, direction: DVec3) -> Intersection {
        self.exits(&Rays::new(origin, direction)).into()
    }

    /// Returns the hit at `t`.
    #[must_use]
    pub(crate) fn surface_point(
        &self,
        origin: DVec3,
        direction: DVec3,
        t: Double,
        _face: Face,
    ) -> RefinedHit {
        let place = Compensated::along(origin, direction, t.rounded());
        let own = self.map.compensated_back(place).0.moved(self.map.vector_back(direction) * t.rest());
        let normal = self.map.normal(own).into();
        RefinedHit { t, point: place.moved(direction * t.rest()).into(), normal }
    }

    /// Always returns `None`: an ellipsoid has no flat face.
    pub(crate) fn facet(&self, _origin: DVec3, _direction: DVec3, _t: f64, _far: bool) -> Option<Facet> {
        None
    }

    /// Returns whether the point is strictly inside.
    #[must_use]
    pub fn contains(&self, point: DVec3) -> bool {
        square_difference(self.map.exact_point_back(point), self.sphere.radius).sign().is_lt()
    }

    /// Returns the bounding box, or `None` if the map is too ill-conditioned for a reliable one.
    #[must_use]
    pub fn bounds(&self) -> Option<Bounds> {
        bounds_of_image(self.map.forward(), DVec3::splat(self.sphere.radius), self.map.condition())
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use glam::DQuat;

    #[test]
    fn an_ellipsoid_is_hit_where_its_equation_says() {
        let map = DAffine3::from_scale_rotation_translation(
            DVec3::new(3.0, 1.0, 0.5),
            DQuat::IDENTITY,
            DVec3::new(0.0, 0.0, 5.0),
        );
        let ellipsoid = SphereImage::new(map, 1.0);
        let first = |origin, direction: DVec3| {
            let exact = || ellipsoid.cross_exactly(origin, &direction.into());
            ellipsoid.intersect(&PreparedRay::new(origin, direction)?).decided(direction, exact)
        };
        assert_eq!(first(DVec3::ZERO, DVec3::Z), Some(4.5));
        let (origin, direction) = (DVec3::new(2.0, 0.0, 0.0), DVec3::Z);
        let t = first(origin, direction).unwrap();
        let RefinedHit { point, normal, .. } = ellipsoid.stepped(origin, direction, t);
        // The ellipse is x^2/9 + z^2/0.25 = 1, its gradient (2x/9, 0, 2z/0.25).
        assert!((4.0 / 9.0 + (point.z - 5.0) * (point.z - 5.0) / 0.25 - 1.0).abs() < 1e-14);
        let gradient = DVec3::new(2.0 * point.x / 9.0, 0.0, 2.0 * (point.z - 5.0) / 0.25).normalize();
        assert!((normal - gradient).length() < 1e-14);
    }
}
