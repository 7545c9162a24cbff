//! Axis-aligned boxes.

use glam::DVec3;

use super::bounds::Bounds;
use super::intersection::{ExactCrossing, ExactHit, Face, Facet, Intersection, RefinedHit, Side};
use super::sphere::U;
use crate::trace::math::{BoundedT, Compensated, Double, Exact, Exact3, ExactRoot};
use crate::trace::rays::PreparedRay;

/// An axis-aligned box in world space.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct AlignedBox {
    /// Smallest coordinates.
    pub min: DVec3,
    /// Largest coordinates, each greater than that in `min`.
    pub max: DVec3,
}

/// Magnitude below which a direction component's reciprocal might not be finite.
pub(crate) const SLOWEST: f64 = 1e-300;

/// A ray transformed into another space, with an error bound for each coordinate.
pub(crate) struct LocalRay {
    pub(crate) origin: DVec3,
    pub(crate) direction: DVec3,
    pub(crate) origin_error: DVec3,
    pub(crate) direction_error: DVec3,
}

/// Result of intersecting an inexact ray with a slab in `f64`.
enum Along {
    /// The ray enters at the first `t` and leaves at the second.
    Through(BoundedT, BoundedT),
    /// The ray is parallel to the slab, and inside it.
    Inside,
    /// The ray is parallel to the slab, and outside it.
    Outside,
    /// The rounding errors are too large to decide.
    Open,
}

impl LocalRay {
    #[inline]
    fn slab(&self, axis: usize, min: f64, max: f64) -> Along {
        let (o, d) = (self.origin[axis], self.direction[axis]);
        let (o_error, d_error) = (self.origin_error[axis], self.direction_error[axis]);
        if d.abs() > 1024.0 * d_error {
            let inverse = d.recip();
            let meet = |plane: f64| {
                let t = (plane - o) * inverse;
                BoundedT::within(t, (o_error + t.abs() * d_error) * inverse.abs() * 1.01 + 8.0 * U * t.abs())
            };
            let (at_min, at_max) = (meet(min), meet(max));
            return if d > 0.0 { Along::Through(at_min, at_max) } else { Along::Through(at_max, at_min) };
        }
        // An error bound of 0 means that all terms are zero, so that the component is exactly zero.
        if d_error > 0.0 {
            Along::Open
        } else if o - o_error > min && o + o_error < max {
            Along::Inside
        } else if o + o_error < min || o - o_error > max {
            Along::Outside
        } else {
            Along::Open
        }
    }
}

/// One of a box's three slabs relative to a ray. `low` and `high` are the heights of its planes above the ray's origin; `speed` is the
/// direction's component across the slab. The planes are hit at t = low / speed and t = high / speed.
pub(crate) struct Slab {
    pub(crate) low: Exact,
    pub(crate) high: Exact,
    pub(crate) speed: Exact,
}

impl Slab {
    /// Returns the entry and the exit of the ray.
    fn meetings(&self, axis: usize) -> [ExactHit; 2] {
        let upwards = self.speed.sign().is_gt();
        let (near, far) = if upwards { (&self.low, &self.high) } else { (&self.high, &self.low) };
        let meeting = |height: &Exact, upper: bool, side: Side| ExactHit {
            t: ExactRoot::quotient(height, &self.speed),
            face: Face { axis, upper },
            side,
        };
        [meeting(near, !upwards, Side::Entry), meeting(far, upwards, Side::Exit)]
    }
}

/// Returns the entry and the exit of a line through the intersection of three closed slabs. A line in a face touches the box.
pub(crate) fn cross_exactly(slabs: &[Slab; 3]) -> Option<ExactCrossing> {
    let mut crossing: Option<ExactCrossing> = None;
    for (axis, slab) in slabs.iter().enumerate() {
        if slab.speed.sign().is_eq() {
            if slab.low.sign().is_gt() || slab.high.sign().is_lt() {
                return None;
            }
            continue;
        }
        let [near, far] = slab.meetings(axis);
        crossing = Some(match crossing {
            None => [near, far],
            Some([entry, exit]) => {
                let later = if near.t > entry.t { near } else { entry };
                let earlier = if far.t < exit.t { far } else { exit };
                [later, earlier]
            }
        });
    }
    crossing.filter(|[entry, exit]| entry.t <= exit.t)
}

/// Returns the exit of a line that starts inside, or goes inwards from the surface: the nearest of the planes ahead.
pub(crate) fn exit_exactly(slabs: &[Slab; 3]) -> Option<ExactHit> {
    let moving = slabs.iter().enumerate().filter(|(_, slab)| slab.speed.sign().is_ne());
    let exits = moving.map(|(axis, slab)| {
        let [_, exit] = slab.meetings(axis);
        exit
    });
    exits.min_by(|one, other| one.t.cmp(&other.t)).map(ExactHit::ahead)
}

/// Returns a face's outward normal.
#[inline]
pub(crate) fn outward(face: Face) -> DVec3 {
    let mut normal = DVec3::ZERO;
    normal[face.axis] = if face.upper { 1.0 } else { -1.0 };
    normal
}

impl AlignedBox {
    /// Returns the smallest `t >= 0` on the box.
    #[must_use]
    #[inline]
    pub fn intersect(&self, ray: &PreparedRay) -> Intersection {
        let (origin, direction) = (ray.origin(), ray.direction());
        // A difference times a reciprocal is rounded three times; its sign is exact.
        let (entry, exit) = if direction.abs().min_element() > SLOWEST {
            let inverse = direction.recip();
            let (at_min, at_max) = ((self.min - origin) * inverse, (self.max - origin) * inverse);
            (at_min.min(at_max).max_element(), at_min.max(at_max).min_element())
        } else {
            self.slow_crossing(origin, direction)
        };
        let close = 8.0 * U * entry.abs().max(exit.abs());
        if exit < 0.0 || entry > exit + close {
            return Intersection::Miss;
        }
        if entry > exit - close {
            return Intersection::Ambiguous;
        }
        // Adding zero turns a negative zero into a positive one.
        let t = if entry >= 0.0 { entry } else { exit } + 0.0;
        Intersection::ShapeHit(BoundedT::within(t, 4.0 * U * t))
    }

    /// Returns the result of [`AlignedBox::intersect`] for a ray with error bounds.
    #[inline]
    pub(crate) fn first_crossing(&self, ray: &LocalRay) -> Intersection {
        let (mut entry, mut exit) =
            (BoundedT::within(f64::NEG_INFINITY, 0.0), BoundedT::within(f64::INFINITY, 0.0));
        for axis in 0..3 {
            match ray.slab(axis, self.min[axis], self.max[axis]) {
                Along::Through(near, far) => {
                    entry = entry.later(near);
                    exit = exit.earlier(far);
                }
                Along::Inside => {}
                Along::Outside => return Intersection::Miss,
                Along::Open => return Intersection::Ambiguous,
            }
        }
        if entry.earliest() > exit.latest() || exit.latest() < 0.0 {
            Intersection::Miss
        } else if entry.latest() >= exit.earliest() {
            Intersection::Ambiguous
        } else if entry.earliest() > 0.0 {
            Intersection::ShapeHit(entry)
        } else if entry.latest() < 0.0 && exit.earliest() > 0.0 {
            Intersection::ShapeHit(exit)
        } else {
            Intersection::Ambiguous
        }
    }

    /// Returns the exact entry and exit of the ray's line.
    pub(crate) fn cross_exactly(&self, origin: DVec3, direction: &Exact3) -> Option<ExactCrossing> {
        cross_exactly(&self.exact_slabs(origin, direction))
    }

    /// Returns the exact exit of a ray that starts on the box and goes inwards. A ray from an edge may exit at once through the other face.
    pub(crate) fn exit_exactly(&self, origin: DVec3, direction: &Exact3) -> Option<ExactHit> {
        exit_exactly(&self.exact_slabs(origin, direction))
    }

    fn exact_slabs(&self, origin: DVec3, direction: &Exact3) -> [Slab; 3] {
        let ahead = |place: f64, origin: f64| &Exact::from(place) - &Exact::from(origin);
        std::array::from_fn(|axis| Slab {
            low: ahead(self.min[axis], origin[axis]),
            high: ahead(self.max[axis], origin[axis]),
            speed: direction.0[axis].clone(),
        })
    }

    /// Returns the hit near an approximate `t`. Returns `None` near edges, where the face is uncertain.
    #[must_use]
    #[inline(always)]
    pub(crate) fn refine(&self, origin: DVec3, direction: DVec3, t: f64, _far: bool) -> Option<RefinedHit> {
        /// Magnitude below which quotients might lose digits.
        const TINY: f64 = 1e-140;
        let face = self.only_face(origin, direction, t).filter(|face| direction[face.axis].abs() > TINY)?;
        let t = Double::difference(self.plane(face), origin[face.axis]) / direction[face.axis].into();
        Some(self.surface_point(origin, direction, t, face))
    }

    /// Always returns `None`: a `t` with few certain bits is solved exactly.
    pub(crate) fn solve(&self, _origin: DVec3, _direction: DVec3, _t: f64) -> Option<RefinedHit> {
        None
    }

    /// Returns the face that is hit at `t`, if its plane is the only one within the error of a `t` that was rounded a few times.
    #[inline]
    fn only_face(&self, origin: DVec3, direction: DVec3, t: f64) -> Option<Face> {
        let way = direction * t;
        let near = |planes: DVec3| {
            let to_planes = planes - origin;
            (to_planes - way).abs().cmple((to_planes.abs() + way.abs()) * (16.0 * U)).bitmask()
        };
        let (lower, upper) = (near(self.min), near(self.max));
        let alone = (lower | upper).is_power_of_two() && lower & upper == 0;
        alone.then(|| Face { axis: (lower | upper).trailing_zeros() as usize, upper: upper != 0 })
    }

    /// Returns the face that is certainly hit at `t`, or, for a ray that starts inside, through which it certainly exits.
    #[inline]
    pub(crate) fn clear_face(&self, ray: &LocalRay, t: f64, inside: bool) -> Option<Face> {
        let never = |t: f64| (BoundedT::within(t, 0.0), Face::default());
        let (mut nears, mut fars) = ([never(f64::NEG_INFINITY); 3], [never(f64::INFINITY); 3]);
        for axis in 0..3 {
            match ray.slab(axis, self.min[axis], self.max[axis]) {
                Along::Through(near, far) => {
                    let upwards = ray.direction[axis] > 0.0;
                    nears[axis] = (near, Face { axis, upper: !upwards });
                    fars[axis] = (far, Face { axis, upper: upwards });
                }
                Along::Inside | Along::Outside => {}
                Along::Open => return None,
            }
        }
        let later = |a: &(BoundedT, Face), b: &(BoundedT, Face)| a.0.t().total_cmp(&b.0.t());
        let entry = nears.into_iter().max_by(later)?;
        let enters = !inside && t <= entry.0.latest();
        let (candidates, chosen) =
            if enters { (nears, entry) } else { (fars, fars.into_iter().min_by(later)?) };
        let rivals = candidates.iter().filter(|(root, _)| root.may_equal(&chosen.0)).count();
        (rivals == 1).then_some(chosen.1)
    }

    /// Returns the entry and the exit of the three closed slabs (Kay and Kajiya, "Ray Tracing Complex Scenes", 1986). A ray in a face
    /// touches the box. A direction component of zero becomes an interval test.
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
    pub fn exit(&self, origin: DVec3, direction: DVec3) -> Intersection {
        let mut nearest = f64::INFINITY;
        for axis in 0..3 {
            let d = direction[axis];
            if d != 0.0 {
                let face = if d > 0.0 { self.max[axis] } else { self.min[axis] };
                nearest = nearest.min((face - origin[axis]) / d);
            }
        }
        let t = nearest.max(0.0);
        Intersection::ShapeHit(BoundedT::within(t, 4.0 * U * t))
    }

    /// Returns the result of [`AlignedBox::exit`] for a ray with error bounds.
    pub(crate) fn rough_exit(&self, ray: &LocalRay) -> Intersection {
        let mut exit = BoundedT::within(f64::INFINITY, 0.0);
        for axis in 0..3 {
            match ray.slab(axis, self.min[axis], self.max[axis]) {
                Along::Through(_, far) => exit = exit.earlier(far),
                Along::Inside | Along::Outside => {}
                Along::Open => return Intersection::Ambiguous,
            }
        }
        if exit.earliest() > 0.0 { Intersection::ShapeHit(exit) } else { Intersection::Ambiguous }
    }

    /// Returns the hit at `t` on a face. The point's coordinate along the face's axis is exactly the coordinate of the face.
    #[inline(always)]
    pub(crate) fn surface_point(&self, origin: DVec3, direction: DVec3, t: Double, face: Face) -> RefinedHit {
        let place = Compensated::along(origin, direction, t.rounded()).moved(direction * t.rest());
        let mut point = DVec3::from(place).clamp(self.min, self.max);
        point[face.axis] = self.plane(face);
        RefinedHit { t, point, normal: outward(face) }
    }

    /// Returns a face's coordinate along its axis.
    #[inline]
    pub(crate) fn plane(&self, face: Face) -> f64 {
        if face.upper { self.max[face.axis] } else { self.min[face.axis] }
    }

    /// Returns the plane of the only face that can be hit at `t`.
    pub(crate) fn facet(&self, origin: DVec3, direction: DVec3, t: f64, _far: bool) -> Option<Facet> {
        let face = self.only_face(origin, direction, t)?;
        Some(Facet { row: DVec3::AXES[face.axis], offset: self.plane(face) })
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
