//! Robust intersection: every decision and every digit is correct. It uses `f64` if the error bounds suffice, otherwise exact arithmetic.

use std::cmp::Ordering;

use glam::DVec3;

use super::hit::ShapeHit;
use super::intersector::Escalations;
use crate::trace::math::{BoundedT, Compensated, Double, Double3, Exact3};
use crate::trace::rays::{FAR, PreparedRay, RayView, ShadowLimit, ShapeId};
use crate::trace::scene::{Geometry, ShapeRef};
use crate::trace::shapes::{Bounds, ExactHit, Face, Intersection, RefinedHit, Side};

/// 2^-36: a hit closer to a light than this, relative to the light's distance, is compared with the light's exact position. The ray itself
/// misses that position, as its direction is rounded.
pub(crate) const NEAR: f64 = f64::from_bits((1023 - 36) << 52);

/// 2^-44, some units in the last place of a light's position, which is rounded too: a panel flush with a ceiling lies on it.
const ROUNDED: f64 = f64::from_bits((1023 - 44) << 52);

/// 2^-20: rounding never turns a normal to the wrong side by more than this.
const CLEARLY: f64 = f64::from_bits((1023 - 20) << 52);

/// Evaluates an expression with `$shape` bound to the shape with an id, of whatever kind.
macro_rules! ask {
    ($geometry:expr, $id:expr, $shape:ident => $question:expr) => {{
        match $geometry.shape($id) {
            ShapeRef::Sphere($shape) => $question,
            ShapeRef::Plane($shape) => $question,
            ShapeRef::AlignedBox($shape) => $question,
            ShapeRef::SphereImage($shape) => $question,
            ShapeRef::BoxImage($shape) => $question,
            ShapeRef::Rod($shape) => $question,
            ShapeRef::RodImage($shape) => $question,
        }
    }};
}

impl Geometry {
    /// Returns the first hit of the ray with the shape. Excludes the shape that the ray leaves, except for its far side, which the ray can hit
    /// from inside. The same applies to every other shape whose surface coincides with it at the ray's origin, each with its own orientation.
    #[inline]
    pub(super) fn intersect(
        &self,
        id: ShapeId,
        ray: &RayView<'_>,
        escalations: &mut Escalations,
    ) -> Option<ShapeHit> {
        if let Some(exclusion) = ray.exclusion() {
            if id == exclusion.id {
                return if exclusion.outward { None } else { self.exit(id, ray, escalations) };
            }
            if let Some(normal) = ray.left_normal(id) {
                return if ray.direction().dot(normal) < 0.0 {
                    self.exit(id, ray, escalations)
                } else {
                    None
                };
            }
        }
        self.near_hit(id, ray, escalations)
    }

    /// Compares the distances of two hits of a ray.
    #[inline]
    pub(super) fn compare(
        &self,
        ray: &PreparedRay,
        hit: &ShapeHit,
        other: &ShapeHit,
        escalations: &mut Escalations,
    ) -> Ordering {
        if !hit.root.may_equal(&other.root) {
            return hit.root.t().total_cmp(&other.root.t());
        }
        escalations.contested += 1;
        if self.meet_one_plane(hit, other, ray) {
            return Ordering::Equal;
        }
        match (self.exactly(hit.id, hit.far, ray), self.exactly(other.id, other.far, ray)) {
            (Some(one), Some(two)) => one.t.cmp(&two.t),
            _ => hit.root.t().total_cmp(&other.root.t()),
        }
    }

    /// Returns whether the hit is nearer than `limit`.
    #[inline]
    pub(super) fn is_before(
        &self,
        hit: &ShapeHit,
        ray: &PreparedRay,
        limit: &ShadowLimit,
        escalations: &mut Escalations,
    ) -> bool {
        let (nearer, farther) = (limit.t() * (1.0 - NEAR), limit.t() * (1.0 + NEAR));
        if hit.root.latest() < nearer || hit.root.earliest() > farther {
            return hit.root.latest() < nearer;
        }
        escalations.contested += 1;
        self.exactly_before(hit, ray, limit)
    }

    /// Computes the accurate `t`, point and normal of a hit.
    #[inline(always)]
    pub(super) fn refine(
        &self,
        ray: &PreparedRay,
        hit: &ShapeHit,
        escalations: &mut Escalations,
    ) -> RefinedHit {
        let (origin, direction, t) = (ray.origin(), ray.direction(), hit.root.t());
        if t < FAR
            && !hit.root.is_rounded()
            && !hit.root.is_rough()
            && let Some(refined) = ask!(self, hit.id, shape => shape.refine(origin, direction, t, hit.far))
        {
            return refined;
        }
        self.refine_specially(ray, hit, escalations)
    }

    /// Refines a hit whose `t` has more than a few rounding errors, or that is near an edge.
    #[cold]
    fn refine_specially(
        &self,
        ray: &PreparedRay,
        hit: &ShapeHit,
        escalations: &mut Escalations,
    ) -> RefinedHit {
        let mut refined = if hit.root.t() < FAR {
            self.refine_precisely(ray, hit, escalations)
        } else {
            self.refine_far(ray, hit)
        };
        // At very large distances even a double-double `t` is coarser than the shape's size. The point is still clamped to the shape's bounds:
        // the tree relies on this for rays that start there.
        if let Some(Bounds { min, max }) = self.bounds(hit.id) {
            refined.point = refined.point.clamp(min, max);
        }
        refined
    }

    fn refine_precisely(
        &self,
        ray: &PreparedRay,
        hit: &ShapeHit,
        escalations: &mut Escalations,
    ) -> RefinedHit {
        let (origin, direction, t) = (ray.origin(), ray.direction(), hit.root.t());
        if hit.root.is_rough() && !hit.root.is_rounded() {
            escalations.rough += 1;
            if let Some(solved) = ask!(self, hit.id, shape => shape.solve(origin, direction, t)) {
                return solved;
            }
        }
        let Some(meeting) = self.exactly(hit.id, hit.far, ray) else {
            return ask!(self, hit.id, shape => shape.surface_point(origin, direction, t.into(), Face::default()));
        };
        let (t, face) = (meeting.t.rounded(), meeting.face);
        on_side(
            ask!(self, hit.id, shape => shape.surface_point(origin, direction, t, face)),
            meeting.side,
            direction,
        )
    }

    /// Refines a hit at [`FAR`] or beyond, in coordinates scaled down so far that no product overflows. If the point itself overflows, it is
    /// not finite.
    fn refine_far(&self, ray: &PreparedRay, hit: &ShapeHit) -> RefinedHit {
        /// 2^-600
        const SMALLER: f64 = f64::from_bits((1023 - 600) << 52);
        let (origin, direction) = (ray.origin(), ray.direction());
        let (t, face, side) = match self.exactly(hit.id, hit.far, ray) {
            Some(meeting) => (meeting.t.rounded(), meeting.face, meeting.side),
            None => (hit.root.t().into(), Face::default(), Side::Either),
        };
        if let ShapeRef::Plane(plane) = self.shape(hit.id) {
            let near = plane.scaled(SMALLER);
            let smaller = t.rounded() * SMALLER;
            if let Some(RefinedHit { t, point, normal }) =
                near.refine(origin * SMALLER, direction, smaller, false)
            {
                return RefinedHit { t: t.scaled(SMALLER.recip()), point: point / SMALLER, normal };
            }
        }
        let smaller = t.scaled(SMALLER);
        let place = Compensated::along(origin * SMALLER, direction, smaller.rounded());
        let mut point = DVec3::from(place.moved(direction * smaller.rest())) / SMALLER;
        if let Some(Bounds { min, max }) = self.bounds(hit.id) {
            point = point.clamp(min, max);
        }
        // The point is already at the hit.
        let refined = ask!(self, hit.id, shape => shape.surface_point(point, direction, Double::ZERO, face));
        on_side(RefinedHit { t, ..refined }, side, direction)
    }

    /// Returns whether a hit at [`FAR`] or beyond has a finite point at a finite distance.
    #[cold]
    fn is_reached(&self, ray: &PreparedRay, hit: &ShapeHit) -> bool {
        let distance = hit.root.t() * ray.direction().length();
        distance.is_finite() && self.refine(ray, hit, &mut Escalations::default()).point.is_finite()
    }

    /// Returns whether the point is inside the shape, taken as a solid.
    #[must_use]
    pub(crate) fn contains(&self, id: ShapeId, point: DVec3) -> bool {
        ask!(self, id, shape => shape.contains(point))
    }

    /// Returns the `t`, counted from `point`, at which a line leaves a shape that it enters at that point of its surface. `None` if it never
    /// does.
    #[must_use]
    pub(crate) fn far_side(&self, id: ShapeId, point: DVec3, direction: DVec3) -> Option<f64> {
        match ask!(self, id, shape => shape.exit(point, direction)) {
            Intersection::Hit(root) => Some(root.t()),
            Intersection::Miss => None,
            Intersection::Ambiguous => {
                let exit = ask!(self, id, shape => shape.exit_exactly(point, &direction.into()))?;
                Some(exit.t.rounded().rounded())
            }
        }
    }

    #[inline]
    fn near_hit(&self, id: ShapeId, ray: &PreparedRay, escalations: &mut Escalations) -> Option<ShapeHit> {
        // Each kind of shape reads the ray itself: a copy here would go through memory a second time.
        let intersection = ask!(self, id, shape => shape.intersect(ray));
        self.decided(intersection, id, false, ray, escalations)
    }

    #[cold]
    pub(super) fn exit(
        &self,
        id: ShapeId,
        ray: &PreparedRay,
        escalations: &mut Escalations,
    ) -> Option<ShapeHit> {
        let intersection = ask!(self, id, shape => shape.exit(ray.origin(), ray.direction()));
        self.decided(intersection, id, true, ray, escalations)
    }

    #[inline(always)]
    fn decided(
        &self,
        intersection: Intersection,
        id: ShapeId,
        far: bool,
        ray: &PreparedRay,
        escalations: &mut Escalations,
    ) -> Option<ShapeHit> {
        let root = match intersection {
            Intersection::Hit(root) => root,
            Intersection::Miss => return None,
            Intersection::Ambiguous => {
                escalations.ambiguous += 1;
                BoundedT::rounded(self.exactly(id, far, ray)?.t.rounded())
            }
        };
        let hit = ShapeHit { root, id, far };
        (root.t() < FAR || self.is_reached(ray, &hit)).then_some(hit)
    }

    /// Computes a hit without any rounding: the first one or, if `far`, the exit of a ray that starts on the shape and goes inwards.
    #[cold]
    fn exactly(&self, id: ShapeId, far: bool, ray: &PreparedRay) -> Option<ExactHit> {
        self.exactly_met(id, far, ray.origin(), &ray.direction().into())
    }

    fn exactly_met(&self, id: ShapeId, far: bool, origin: DVec3, direction: &Exact3) -> Option<ExactHit> {
        if far {
            return ask!(self, id, shape => shape.exit_exactly(origin, direction));
        }
        let crossing = ask!(self, id, shape => shape.cross_exactly(origin, direction))?;
        crossing.into_iter().find(|meeting| meeting.t.sign().is_ge())
    }

    /// Returns whether both hits lie in the same plane, as on flush faces. They then need not be compared.
    fn meet_one_plane(&self, hit: &ShapeHit, other: &ShapeHit, ray: &PreparedRay) -> bool {
        let facet = |hit: &ShapeHit| {
            let (origin, direction, t) = (ray.origin(), ray.direction(), hit.root.t());
            ask!(self, hit.id, shape => shape.facet(origin, direction, t, hit.far))
        };
        facet(hit).is_some_and(|one| facet(other) == Some(one))
    }

    /// Returns whether the shape lies between the ray's origin and the light's exact position, which the ray misses by the rounding of its
    /// direction. A shape on which the light lies, within the rounding of its position, does not.
    #[cold]
    fn exactly_before(&self, hit: &ShapeHit, ray: &PreparedRay, limit: &ShadowLimit) -> bool {
        let (id, origin) = (hit.id, ray.origin());
        let exact_way = Double3::difference(limit.place(), origin);
        let way = exact_way.rounded();
        let sizes = origin.abs().max_element() + limit.place().abs().max_element();
        let latest = -ROUNDED * sizes / way.abs().max_element();
        // At the hit itself, near 1: at the light's place beyond an entry, the face of the exit would be taken.
        let t = hit.root.t() / limit.t();
        if let Some(refined) = ask!(self, id, shape => shape.refine(origin, way, t, hit.far)) {
            // An error of u in each coordinate of the direction causes an error of that size in t, times 1 over the cosine.
            let error = 16.0 * f64::EPSILON * (1.0 + way.length() / refined.normal.dot(way).abs());
            let beyond = (refined.t - Double::from(1.0)).rounded() - latest;
            if beyond.abs() > error {
                return beyond < 0.0;
            }
        }
        self.exactly_met(id, hit.far, origin, &exact_way.into())
            .is_some_and(|refined| (refined.t.rounded() - Double::from(1.0)).rounded() < latest)
    }
}

/// Replaces a normal that is clearly on the wrong side by the ray's direction, or by its opposite at an entry. From so far away that the shape
/// is smaller than the spacing of representable points, only the side of the normal is known.
fn on_side(refined: RefinedHit, side: Side, direction: DVec3) -> RefinedHit {
    let direction = direction.normalize();
    let wrong = match side {
        Side::Entry => refined.normal.dot(direction) > CLEARLY,
        Side::Exit => refined.normal.dot(direction) < -CLEARLY,
        Side::Either => false,
    };
    let outward = if matches!(side, Side::Entry) { -direction } else { direction };
    if wrong { RefinedHit { normal: outward, ..refined } } else { refined }
}

#[cfg(test)]
mod tests {
    use glam::{DAffine3, DQuat};
    use proptest::prelude::*;

    use super::*;
    use crate::trace::intersect::{CastRay, Scratch};
    use crate::trace::scene::{PreparedScene, PreparedShape, SurfaceMaterial};
    use crate::trace::shapes::{AlignedBox, BoxImage, Rod, RodImage, Sphere, SphereImage};

    fn shape(kind: usize, turn: f64) -> Option<PreparedShape> {
        let rotation = DQuat::from_euler(glam::EulerRot::XYZ, turn, 2.0 * turn, 3.0 * turn);
        let map = DAffine3::from_scale_rotation_translation(DVec3::new(1.0, 2.0, 0.5), rotation, DVec3::ONE);
        Some(match kind {
            0 => PreparedShape::Sphere(Sphere { center: DVec3::ONE, radius: 1.5 }),
            1 => PreparedShape::AlignedBox(AlignedBox { min: DVec3::ZERO, max: DVec3::new(2.0, 1.0, 3.0) }),
            2 => PreparedShape::SphereImage(SphereImage::new(map, 1.0)),
            3 => PreparedShape::BoxImage(BoxImage::new(map, DVec3::ONE)?),
            4 => PreparedShape::Rod(Rod::cylinder(DVec3::ZERO, DVec3::new(2.0, 1.0, 3.0), 1.5)?),
            5 => PreparedShape::Rod(Rod::capsule(DVec3::ZERO, DVec3::new(2.0, 1.0, 3.0), 1.5)?),
            _ => PreparedShape::RodImage(RodImage::cylinder(map, DVec3::ONE, 0.7)?),
        })
    }

    /// Checks that a light just inside the nearer side of a shape is occluded by it, and a light just before it is not.
    #[test]
    fn lights_just_inside_a_shape_are_occluded() {
        let (origin, direction) = (DVec3::new(-9.0, 4.0, -7.0), DVec3::new(1.25, -0.375, 1.0));
        for (kind, turn) in (0..7).flat_map(|kind| (1..=9).map(move |turn| (kind, f64::from(turn) / 10.0))) {
            let mut geometry = Geometry::default();
            geometry.push(shape(kind, turn).unwrap());
            let scene = PreparedScene::new(geometry, vec![SurfaceMaterial::default()]);
            let t = scene.cast(&CastRay::new(origin, direction).unwrap()).unwrap().t.rounded();
            let ray = PreparedRay::new(origin, direction).unwrap();
            for (exponent, side) in (34..=41).flat_map(|exponent| [(exponent, 1.0), (exponent, -1.0)]) {
                let at = t * (1.0 + side * libm::exp2(-f64::from(exponent)));
                let limit = ShadowLimit::new(at, origin + direction * at);
                let occluder = scene.occluder(&ray, &limit, (None, None), &mut Scratch::default());
                assert_eq!(
                    occluder.is_some(),
                    side > 0.0,
                    "kind {kind}, turn {turn}, 2^-{exponent} * {side}"
                );
            }
        }
    }

    proptest! {
        #![proptest_config(ProptestConfig::with_cases(2_000))]

        #[test]
        fn points_lie_on_their_shapes_from_however_far_away(
            kind in 0..7_usize, turn in 0.1..1.0_f64, exponent in 0..100, way in prop::array::uniform3(-1.0..1.0_f64),
            aim in prop::array::uniform3(-0.4..0.4_f64),
        ) {
            let mut geometry = Geometry::default();
            let Some(shape) = shape(kind, turn) else { return Ok(()) };
            let id = geometry.push(shape);
            let bounds = geometry.bounds(id).unwrap();
            let scene = PreparedScene::new(geometry, vec![SurfaceMaterial::default()]);
            let origin = DVec3::from(way) * libm::exp10(f64::from(exponent));
            let target = DVec3::ONE + DVec3::from(aim);
            let Some(surface) = CastRay::new(origin, target - origin).and_then(|ray| scene.cast(&ray)) else {
                return Ok(());
            };
            let on = surface.point.cmpge(bounds.min).all() && surface.point.cmple(bounds.max).all();
            prop_assert!(on, "{} is not within {bounds:?}", surface.point);
        }
    }
}
