//! Axis-aligned boxes.

use glam::DVec3;

use super::bounds::Bounds;
use super::intersection::{
    ExactCrossing, ExactHit, Face, Facet, Intersection, Intersections, Refined, RefinedHit,
};
use super::slabs::{ExactSlab, FaceMasks, SLOWEST, cross_exactly, exit_exactly};
use super::sphere::U;
use crate::trace::math::{BoundedT, Compensated, Double, Exact, Exact3, Real, moderate, spread, times};
use crate::trace::rays::{PreparedRay, Rays};

/// An axis-aligned box in world space.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct AlignedBox {
    /// Smallest coordinates.
    pub min: DVec3,
    /// Largest coordinates, each greater than that in `min`.
    pub max: DVec3,
}

/// Refines a `t` near a box: the height of the face over the speed, in double-double. Not found near edges, where the face is uncertain.
#[inline(always)]
pub(crate) fn refine_box<R: Real>(min: [R; 3], max: [R; 3], rays: &Rays<R>, t: R) -> Refined<R> {
    /// Magnitude below which quotients might lose digits.
    const TINY: f64 = 1e-140;
    let face = only_face(min, max, rays, t);
    let (speed, zero) = (face.of_axis(rays.direction), t.of(0.0));
    let plane = R::pick(face.upper, face.of_axis(max), face.of_axis(min));
    let height = Double::difference(plane, face.of_axis(rays.origin));
    let t = height / Double { high: speed, low: zero };
    let found = face.certain & speed.abs().greater(t.high.of(TINY)) & moderate(t.high);
    Refined { found, ..on_face(min, max, rays, t, &face) }
}

/// Returns the face that is hit at `t`. It is certain if its plane is the only one within the error of a `t` that was rounded a few times.
#[inline(always)]
fn only_face<R: Real>(min: [R; 3], max: [R; 3], rays: &Rays<R>, t: R) -> FaceMasks<R> {
    let never = t.less(t);
    let (mut at, mut upper, mut once, mut twice) = ([never; 3], never, never, never);
    for axis in 0..3 {
        let way = rays.direction[axis] * t;
        for (planes, is_upper) in [(min, false), (max, true)] {
            let to_plane = planes[axis] - rays.origin[axis];
            let size = to_plane.abs() + way.abs();
            let near = (to_plane - way).abs().less_or_equal(size * (16.0 * U));
            at[axis] = at[axis] | near;
            if is_upper {
                upper = upper | near;
            }
            twice = twice | (once & near);
            once = once | near;
        }
    }
    FaceMasks { at, upper, certain: once & !twice }
}

/// Returns the hit at `t` on a face. The point's coordinate along the face's axis is exactly the coordinate of the face.
#[inline(always)]
fn on_face<R: Real>(
    min: [R; 3],
    max: [R; 3],
    rays: &Rays<R>,
    t: Double<R>,
    face: &FaceMasks<R>,
) -> Refined<R> {
    let place = Compensated::along(rays.origin, rays.direction, t.high).moved(times(rays.direction, t.low));
    let (zero, one) = (t.high.of(0.0), t.high.of(1.0));
    let sign = R::pick(face.upper, one, -one);
    let (mut point, mut normal) = (place, place);
    for axis in 0..3 {
        // Not `min` and `max`, which may return either of two zeros.
        let above = R::pick(place[axis].greater(min[axis]), place[axis], min[axis]);
        let within = R::pick(above.less(max[axis]), above, max[axis]);
        let plane = R::pick(face.upper, max[axis], min[axis]);
        point[axis] = R::pick(face.at[axis], plane, within);
        normal[axis] = R::pick(face.at[axis], sign, zero);
    }
    Refined { t, point, normal, found: face.certain }
}

impl AlignedBox {
    /// Returns the smallest `t >= 0` on the box.
    #[must_use]
    #[inline]
    pub(crate) fn intersect(&self, ray: &PreparedRay) -> Intersection {
        let (origin, direction) = (ray.origin(), ray.direction());
        if direction.abs().min_element() > SLOWEST {
            return self.intersections(origin.into(), direction.recip().into()).into();
        }
        let (entry, exit) = self.slow_crossing(origin, direction);
        between(entry, exit).into()
    }

    /// Intersects rays with the box, by the reciprocals of their directions, which must be finite (Kay and Kajiya, "Ray Tracing Complex
    /// Scenes", 1986). A difference times a reciprocal is rounded three times; its sign is exact.
    #[inline(always)]
    pub(crate) fn intersections<R: Real>(&self, origin: [R; 3], inverse: [R; 3]) -> Intersections<R> {
        let (min, max) = (spread(origin[0], self.min), spread(origin[0], self.max));
        let (mut entry, mut exit) = (origin[0].of(f64::NEG_INFINITY), origin[0].of(f64::INFINITY));
        for axis in 0..3 {
            let at_min = (min[axis] - origin[axis]) * inverse[axis];
            let at_max = (max[axis] - origin[axis]) * inverse[axis];
            entry = at_min.min(at_max).max(entry);
            exit = at_min.max(at_max).min(exit);
        }
        between(entry, exit)
    }

    /// Finds the exits of rays that start on the box and go inwards. Only faces ahead are considered.
    #[inline(always)]
    pub(crate) fn exits<R: Real>(&self, rays: &Rays<R>) -> Intersections<R> {
        let (min, max) = (spread(rays.origin[0], self.min), spread(rays.origin[0], self.max));
        let (zero, mut nearest) = (rays.origin[0].of(0.0), rays.origin[0].of(f64::INFINITY));
        for axis in 0..3 {
            let speed = rays.direction[axis];
            let face = R::pick(speed.greater(zero), max[axis], min[axis]);
            let t = (face - rays.origin[axis]) / speed;
            nearest = R::pick(speed.abs().greater(zero) & t.less(nearest), t, nearest);
        }
        let t = R::pick(nearest.greater(zero), nearest, zero);
        let never = zero.less(zero);
        Intersections { root: BoundedT::within(t, t * (4.0 * U)), hit: !never, undecided: never }
    }

    /// Returns the exact entry and exit of the ray's line.
    pub(crate) fn cross_exactly(&self, origin: DVec3, direction: &Exact3) -> Option<ExactCrossing> {
        cross_exactly(&self.exact_slabs(origin, direction))
    }

    /// Returns the exact exit of a ray that starts on the box and goes inwards. A ray from an edge may exit at once through the other face.
    pub(crate) fn exit_exactly(&self, origin: DVec3, direction: &Exact3) -> Option<ExactHit> {
        exit_exactly(&self.exact_slabs(origin, direction))
    }

    pub(super) fn exact_slabs(&self, origin: DVec3, direction: &Exact3) -> [ExactSlab; 3] {
        let ahead = |place: f64, origin: f64| &Exact::from(place) - &Exact::from(origin);
        std::array::from_fn(|axis| ExactSlab {
            low: ahead(self.min[axis], origin[axis]),
            high: ahead(self.max[axis], origin[axis]),
            speed: direction.0[axis].clone(),
        })
    }

    /// Returns the hit near an approximate `t`: [`refine_box`]. Returns `None` near edges, where the face is uncertain.
    #[must_use]
    #[inline(always)]
    pub(crate) fn refine(&self, origin: DVec3, direction: DVec3, t: f64, _far: bool) -> Option<RefinedHit> {
        refine_box(self.min.into(), self.max.into(), &Rays::new(origin, direction), t).into()
    }

    /// Always returns `None`: a `t` with few certain bits is solved exactly.
    pub(crate) fn solve(&self, _origin: DVec3, _direction: DVec3, _t: f64) -> Option<RefinedHit> {
        None
    }

    /// Returns the entry and the exit of the three closed slabs, for a direction of any components. A ray in a face touches the box. A
    /// direction component of zero becomes an interval test.
    fn slow_crossing(&self, origin: DVec3, direction: DVec3) -> (f64, f64) {
        let (mut entry, mut exit) = (f64::NEG_INFINITY, f64::INFINITY);
        for axis in 0..3 {
            let (o, d) = (origin[axis], direction[axis]);
            if d == 0.0 {
                if o < self.min[axis] || o > self.max[axis] {
                    entry = f64::INFINITY;
                }
                continue;
            }
            let (at_min, at_max) = ((self.min[axis] - o) / d, (self.max[axis] - o) / d);
            let (near, far) = if d > 0.0 { (at_min, at_max) } else { (at_max, at_min) };
            entry = entry.max(near);
            exit = exit.min(far);
        }
        (entry, exit)
    }

    /// Returns the exit of a ray that starts on the box and goes inwards. Only faces ahead are considered.
    #[must_use]
    pub(crate) fn exit(&self, origin: DVec3, direction: DVec3) -> Intersection {
        self.exits(&Rays::new(origin, direction)).into()
    }

    /// Returns the hit at `t` on a face. The point's coordinate along the face's axis is exactly the coordinate of the face.
    pub(crate) fn surface_point(&self, origin: DVec3, direction: DVec3, t: Double, face: Face) -> RefinedHit {
        let rays = Rays::new(origin, direction);
        on_face(self.min.into(), self.max.into(), &rays, t, &FaceMasks::of(face)).into()
    }

    /// Returns the plane of the only face that can be hit at `t`.
    pub(crate) fn facet(&self, origin: DVec3, direction: DVec3, t: f64, _far: bool) -> Option<Facet> {
        let rays = Rays::new(origin, direction);
        let Face { axis, upper } = only_face(self.min.into(), self.max.into(), &rays, t).face()?;
        Some(Facet { row: DVec3::AXES[axis], offset: if upper { self.max[axis] } else { self.min[axis] } })
    }

    /// Returns whether the point is strictly inside.
    #[must_use]
    pub fn contains(&self, point: DVec3) -> bool {
        point.cmpgt(self.min).all() && point.cmplt(self.max).all()
    }

    /// Returns the bounding box.
    #[must_use]
    pub fn bounds(&self) -> Bounds {
        Bounds { min: self.min, max: self.max }
    }
}

/// Returns the first hits at `t >= 0` of rays that are inside a box between two `t`.
#[inline(always)]
fn between<R: Real>(entry: R, exit: R) -> Intersections<R> {
    let zero = entry.of(0.0);
    let close = entry.abs().max(exit.abs()) * (8.0 * U);
    let maybe = !(exit.less(zero) | entry.greater(exit + close));
    let undecided = maybe & entry.greater(exit - close);
    // Adding zero turns a negative zero into a positive one.
    let t = R::pick(zero.less_or_equal(entry), entry, exit) + zero;
    Intersections { root: BoundedT::within(t, t * (4.0 * U)), hit: maybe & !undecided, undecided }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn first(origin: DVec3, direction: DVec3) -> Option<f64> {
        UNIT.intersect(&PreparedRay::new(origin, direction)?)
            .decided(direction, || UNIT.cross_exactly(origin, &direction.into()))
    }

    fn far(origin: DVec3, direction: DVec3) -> Option<f64> {
        UNIT.exit(origin, direction).decided(DVec3::X, || None)
    }

    const UNIT: AlignedBox = AlignedBox { min: DVec3::NEG_ONE, max: DVec3::ONE };

    #[test]
    fn from_outside_inside_and_behind() {
        assert_eq!(first(DVec3::new(0.0, 0.0, -3.0), DVec3::Z), Some(2.0));
        assert_eq!(first(DVec3::ZERO, DVec3::new(1.0, 0.5, 0.0)), Some(1.0));
        assert_eq!(first(DVec3::new(0.0, 0.0, 3.0), DVec3::Z), None);
        assert_eq!(first(DVec3::new(1.5, 0.0, -3.0), DVec3::Z), None);
    }

    #[test]
    fn faces_edges_and_corners_are_part_of_it() {
        assert_eq!(first(DVec3::new(1.0, 0.0, -3.0), DVec3::Z), Some(2.0), "along a face");
        assert_eq!(first(DVec3::new(1.0, -1.0, -3.0), DVec3::Z), Some(2.0), "along an edge");
        assert_eq!(first(DVec3::new(3.0, 1.0, 1.0), DVec3::NEG_X), Some(2.0), "along another");
        assert_eq!(first(DVec3::new(2.0, 0.0, 1.0), DVec3::new(-1.0, 1.0, 0.0)), Some(1.0), "a corner");
        assert_eq!(first(DVec3::new(1.0, 0.0, 0.0), DVec3::X), Some(0.0), "the origin on it");
        assert_eq!(first(DVec3::new(0.0, 0.0, -3.0), DVec3::new(-0.0, -0.0, 1.0)), Some(2.0), "signed zeros");
    }

    #[test]
    fn hits_are_put_onto_their_face() {
        let (origin, direction) = (DVec3::new(0.3, 0.1, -3.7), DVec3::new(0.05, 0.13, 1.0));
        let t = first(origin, direction).unwrap();
        let RefinedHit { point, normal, .. } = UNIT.refine(origin, direction, t, false).unwrap();
        assert_eq!((point.z, normal), (-1.0, DVec3::NEG_Z));
        let t = first(DVec3::ZERO, DVec3::new(0.2, -1.0, 0.0)).unwrap();
        let RefinedHit { point, normal, .. } =
            UNIT.refine(DVec3::ZERO, DVec3::new(0.2, -1.0, 0.0), t, false).unwrap();
        assert_eq!(
            (point, normal),
            (DVec3::new(0.2, -1.0, 0.0), DVec3::NEG_Y),
            "outward also when seen from inside"
        );
    }

    #[test]
    fn a_ray_into_the_box_comes_out_once() {
        assert_eq!(far(DVec3::new(0.0, 0.0, -1.0), DVec3::Z), Some(2.0));
        // From an edge, the ray exits at once through the other face.
        let (origin, direction) = (DVec3::new(0.0, 1.0, -1.0), DVec3::new(0.0, 1.0, 1.0));
        assert_eq!(far(origin, direction), Some(0.0));
        let face = UNIT.exit_exactly(origin, &direction.into()).unwrap().face;
        let RefinedHit { point, normal, .. } = UNIT.surface_point(origin, direction, Double::ZERO, face);
        assert_eq!((point, normal), (origin, DVec3::Y));
    }
}
