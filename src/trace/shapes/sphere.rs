//! Spheres.

use glam::DVec3;

use super::bounds::Bounds;
use super::intersection::{
    ExactCrossing, ExactHit, Face, Facet, Intersection, Intersections, Refined, RefinedHit, Side,
};
use crate::trace::math::{
    BoundedT, Compensated, Double, Double3, Exact, Exact3, ExactRoot, Real, Truth, dot, moderate3, pick3,
    spread, square_difference, subtract, times,
};
use crate::trace::rays::{PreparedRay, Rays};

/// A sphere in world space.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Sphere {
    /// The centre.
    pub center: DVec3,
    /// The radius, greater than 0.
    pub radius: f64,
}

/// Unit roundoff of `f64`: half a unit in the last place of 1.
pub(crate) const U: f64 = f64::EPSILON / 2.0;

/// Returns the first `t >= 0` at which `t direction` is `radius` away from `to_center`.
///
/// The naive quadratic formula loses all digits of its discriminant for distant and for huge spheres. Here the discriminant comes from the
/// ray's distance to the centre, and the root that would cancel comes from the other root (Haines, Günther, Akenine-Möller, "Precision
/// Improvements for Ray/Sphere Intersection", Ray Tracing Gems, 2019, chapter 7). `inverse_square` is 1 / direction.direction. `u` bounds
/// the relative error of the arguments. Returns `None` if all rays certainly miss.
#[inline(always)]
pub(crate) fn first_root<R: Real>(
    to_center: [R; 3],
    direction: [R; 3],
    inverse_square: R,
    radius: f64,
    u: f64,
) -> Option<Intersections<R>> {
    let b = dot(to_center, direction);
    let (squared_radius, zero) = (b.of(radius * radius), b.of(0.0));
    let projection = b * inverse_square;
    let nearest = subtract(to_center, times(direction, projection));
    let q = squared_radius - dot(nearest, nearest);
    // Twice the largest error observed.
    let q_error = (b * projection + squared_radius) * (32.0 * u);
    let maybe = !q.less(-q_error);
    if !maybe.any() {
        return None;
    }
    let squared_distance = dot(to_center, to_center);
    let root = (dot(direction, direction) * q).sqrt();
    let s = b + root.copysign(b);
    // Bounds all errors of both roots: the errors of b, of q under the root, of c, and of the rounding of the roots, since (L^2 + r^2)/root
    // is at least |L|/|d| and at least half of |t|.
    let error = (squared_distance + squared_radius) * (64.0 * u) / root;
    let clear = q.greater(q_error * 1024.0);
    let one = (squared_distance - squared_radius) / s;
    // The origin is outside and the sphere ahead: the other root is farther.
    let ahead = clear & s.greater(zero) & one.greater(error);
    if ahead.settled() {
        return Some(Intersections { root: BoundedT::within(one, error), hit: ahead, undecided: !ahead });
    }
    let other = s * inverse_square;
    let ordered = one.less(other);
    let (near, far) = (R::pick(ordered, one, other), R::pick(ordered, other, one));
    let near_ahead = clear & (near - error).greater(zero);
    let near_behind = clear & (near + error).less(zero);
    let far_ahead = near_behind & (far - error).greater(zero);
    let far_behind = near_behind & (far + error).less(zero);
    let t = R::pick(ahead, one, R::pick(near_ahead, near, far));
    let hit = maybe & (ahead | near_ahead | far_ahead);
    Some(Intersections { root: BoundedT::within(t, error), hit, undecided: maybe & !hit & !far_behind })
}

/// Returns the exact crossing of a line through the origin with the sphere of this `radius` around `to_center`.
pub(crate) fn roots(to_center: &Exact3, direction: &Exact3, radius: &Exact) -> Option<ExactCrossing> {
    let (a, b) = (direction.dot(direction), to_center.dot(direction));
    let c = &to_center.dot(to_center) - &(radius * radius);
    let [near, far] = ExactRoot::of_quadratic(&a, &b, &c)?;
    Some([ExactHit::new(near, Side::Entry), ExactHit::new(far, Side::Exit)])
}

/// Returns the exact exit of a line that starts on the sphere and goes inwards. If rounding of the origin makes the line miss the sphere,
/// returns the point of the line closest to the centre.
pub(crate) fn last_root(to_center: &Exact3, direction: &Exact3, radius: &Exact) -> ExactHit {
    let far = roots(to_center, direction, radius).map(|[_, far]| far);
    let nearest = || {
        let (a, b) = (direction.dot(direction), to_center.dot(direction));
        ExactHit::new(ExactRoot::quotient(&b, &a), Side::Exit)
    };
    far.unwrap_or_else(nearest).ahead()
}

/// Returns the farther root of a ray that starts on the sphere and goes inwards, computed as in [`first_root`].
#[inline(always)]
pub(crate) fn far_root<R: Real>(
    to_center: [R; 3],
    direction: [R; 3],
    radius: f64,
    u: f64,
) -> Intersections<R> {
    let (a, b) = (dot(direction, direction), dot(to_center, direction));
    let squared_radius = b.of(radius * radius);
    let projection = b / a;
    let nearest = subtract(to_center, times(direction, projection));
    let q = squared_radius - dot(nearest, nearest);
    let q_error = (b * projection + squared_radius) * (32.0 * u);
    let root = (a * q).sqrt();
    let t = (b + root) / a;
    let error = (dot(to_center, to_center) + squared_radius) * (64.0 * u) / root;
    let hit = q.greater(q_error * 1024.0) & b.greater(b.of(0.0)) & t.greater(error);
    Intersections { root: BoundedT::within(t, error), hit, undecided: !hit }
}

/// Returns a Newton step, or 0 where the slope is too small for a finite step, as on a grazing ray.
#[inline(always)]
pub(crate) fn newton_step<R: Real>(residual: R, slope: R) -> R {
    let step = -residual / slope;
    step.abs().if_less(step.of(f64::INFINITY), step, step.of(0.0))
}

/// Returns the Newton step in `t` from a point near an origin-centred sphere to the sphere. The residual is computed in twice the working
/// precision.
#[inline(always)]
pub(crate) fn sphere_step<R: Real>(place: Compensated<R>, direction: [R; 3], radius: R) -> R {
    newton_step(place.beyond(radius), dot(place.rounded(), direction) * 2.0)
}

/// Returns the unit vector, or Y for a vector whose length is zero, infinite or not a number.
#[inline(always)]
pub(crate) fn unit<R: Real>(vector: [R; 3]) -> [R; 3] {
    let square = dot(vector, vector);
    let reciprocal = square.of(1.0) / square.sqrt();
    let is_one = reciprocal.less(square.of(f64::INFINITY)) & reciprocal.greater(square.of(0.0));
    pick3(is_one, times(vector, reciprocal), spread(square, DVec3::Y))
}

/// Refines a `t` near a sphere by one Newton step for |from_center|^2 = radius^2. The residual is computed in twice the working precision.
#[inline(always)]
pub(crate) fn refine_sphere<R: Real>(center: [R; 3], radius: R, rays: &Rays<R>, t: R) -> Refined<R> {
    let place = Compensated::along(rays.origin, rays.direction, t);
    let from_center = place.minus(center);
    let step = sphere_step(from_center, rays.direction, radius);
    let way = times(rays.direction, step);
    Refined {
        t: Double::sum(t, step),
        point: place.moved(way),
        normal: unit(from_center.moved(way)),
        found: moderate3(from_center.rounded()),
    }
}

impl Sphere {
    /// Returns the smallest `t >= 0` on the sphere.
    #[must_use]
    #[inline]
    pub(crate) fn intersect(&self, ray: &PreparedRay) -> Intersection {
        self.intersections(&ray.into(), ray.inverse_square()).into()
    }

    /// Intersects rays with the sphere. `inverse_square` is 1 / direction.direction. `None` if all rays certainly miss.
    #[inline(always)]
    pub(crate) fn intersections<R: Real>(
        &self,
        rays: &Rays<R>,
        inverse_square: R,
    ) -> Option<Intersections<R>> {
        first_root(self.center_relative_to(rays), rays.direction, inverse_square, self.radius, U)
    }

    /// Finds the exits of rays that start on the sphere and go inwards. Grazing rays exit at once.
    #[inline(always)]
    pub(crate) fn exits<R: Real>(&self, rays: &Rays<R>) -> Intersections<R> {
        far_root(self.center_relative_to(rays), rays.direction, self.radius, U)
    }

    #[inline(always)]
    fn center_relative_to<R: Real>(&self, rays: &Rays<R>) -> [R; 3] {
        subtract(spread(rays.origin[0], self.center), rays.origin)
    }

    /// Returns the exact entry and exit of the ray's line.
    pub(crate) fn cross_exactly(&self, origin: DVec3, direction: &Exact3) -> Option<ExactCrossing> {
        roots(&(&Exact3::from(self.center) - &origin.into()), direction, &self.radius.into())
    }

    /// Returns the exact exit of a ray that starts on the sphere and goes inwards.
    pub(crate) fn exit_exactly(&self, origin: DVec3, direction: &Exact3) -> Option<ExactHit> {
        Some(last_root(&(&Exact3::from(self.center) - &origin.into()), direction, &self.radius.into()))
    }

    /// Returns the hit near an approximate `t`: [`refine_sphere`].
    #[must_use]
    #[inline(always)]
    pub(crate) fn refine(&self, origin: DVec3, direction: DVec3, t: f64, _far: bool) -> Option<RefinedHit> {
        Some(self.stepped(origin, direction, t))
    }

    #[inline(always)]
    fn stepped(&self, origin: DVec3, direction: DVec3, t: f64) -> RefinedHit {
        refine_sphere(self.center.into(), self.radius, &Rays::new(origin, direction), t).into()
    }

    /// Returns the hit near a `t` with few certain bits. If [`Sphere::intersect`] reports a hit, its error is at most 1/256 of half the
    /// chord, so that three Newton steps reduce the error to less than 2^-60 of it.
    #[must_use]
    pub(crate) fn solve(&self, origin: DVec3, direction: DVec3, t: f64) -> Option<RefinedHit> {
        let better = self.stepped(origin, direction, t).t.rounded();
        let good = self.stepped(origin, direction, better).t.rounded();
        Some(self.stepped(origin, direction, good))
    }

    /// Returns the exit of a ray that starts on the sphere and goes inwards. A grazing ray exits at once.
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
        let (from_center, way) = (place.minus(self.center), direction * t.rest());
        RefinedHit { t, point: place.moved(way).into(), normal: unit(from_center.moved(way)).into() }
    }

    /// Always returns `None`: a sphere has no flat face.
    pub(crate) fn facet(&self, _origin: DVec3, _direction: DVec3, _t: f64, _far: bool) -> Option<Facet> {
        None
    }

    /// Returns whether the point is strictly inside.
    #[must_use]
    pub fn contains(&self, point: DVec3) -> bool {
        square_difference(Double3::difference(point, self.center), self.radius).sign().is_lt()
    }

    /// Returns the bounding box.
    #[must_use]
    #[inline]
    pub fn bounds(&self) -> Bounds {
        Bounds::around(self.center, DVec3::splat(self.radius))
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn first(sphere: &Sphere, origin: DVec3, direction: DVec3) -> Option<f64> {
        sphere
            .intersect(&PreparedRay::new(origin, direction)?)
            .decided(direction, || sphere.cross_exactly(origin, &direction.into()))
    }

    #[test]
    fn the_worked_example() {
        let sphere = Sphere { center: DVec3::new(3.0, 3.0, 1.0), radius: 2.0 };
        let (origin, direction) = (DVec3::new(0.0, -2.0, 0.0), DVec3::new(1.0, 2.0, 1.0) / 6.0_f64.sqrt());
        let t = first(&sphere, origin, direction).unwrap();
        assert!((t - 4.42).abs() < 0.005, "{t}");
        let point = sphere.stepped(origin, direction, t).point;
        // The source truncates to 1.80 where rounding gives 1.81.
        assert!((point - DVec3::new(1.81, 1.61, 1.81)).abs().max_element() < 0.005, "{point}");
    }

    #[test]
    fn the_discriminant_is_not_its_root() {
        // B^2 - 4C with B = -28/sqrt 6, C = 31: 784/6 - 124 = 6.67, and t = (28/sqrt 6 -+ sqrt 6.67)/2.
        let discriminant: f64 = 784.0 / 6.0 - 124.0;
        assert!((discriminant - 6.67).abs() < 0.005);
        let near = (28.0 / 6.0_f64.sqrt() - discriminant.sqrt()) / 2.0;
        let sphere = Sphere { center: DVec3::new(3.0, 3.0, 1.0), radius: 2.0 };
        let direction = DVec3::new(1.0, 2.0, 1.0) / 6.0_f64.sqrt();
        let found = first(&sphere, DVec3::new(0.0, -2.0, 0.0), direction).unwrap();
        assert!((found - near).abs() < 1e-14);
    }

    #[test]
    fn the_nearer_root_counts_only_ahead_and_from_inside_the_farther_does() {
        let sphere = Sphere { center: DVec3::ZERO, radius: 2.0 };
        let first = |origin, direction| first(&sphere, origin, direction);
        assert_eq!(first(DVec3::new(0.0, 0.0, -5.0), DVec3::Z), Some(3.0));
        assert_eq!(first(DVec3::new(0.0, 0.0, 1.0), DVec3::Z), Some(1.0));
        assert_eq!(first(DVec3::ZERO, DVec3::Z), Some(2.0));
        assert_eq!(first(DVec3::new(0.0, 0.0, 5.0), DVec3::Z), None);
        assert_eq!(first(DVec3::new(0.0, 2.0, -5.0), DVec3::Z), Some(5.0), "grazing is touching");
        assert_eq!(first(DVec3::new(0.0, 0.0, -2.0), DVec3::Z), Some(0.0), "an origin on the surface");
    }

    #[test]
    fn a_ground_sphere_of_a_thousand_million_is_level() {
        let ground = Sphere { center: DVec3::new(0.0, -1e9, 0.0), radius: 1e9 };
        let t = first(&ground, DVec3::new(0.0, 2.0, 0.0), DVec3::new(4.0, -3.0, 0.0)).unwrap();
        assert!((t - 3.333_333_339_259_259 / 5.0).abs() < 1e-6, "{t}");
    }
}
