//! Boxes along the world's axes.

use std::cmp::Ordering;

use glam::DVec3;

use super::Verdict;
use super::sphere::U;
use crate::trace::exact::{Compensated3, Double, Double3, compare_quotients};
use crate::trace::{Bounds, Ray, Refined, Root};

/// An axis-aligned box in world space.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct AlignedBox {
    /// Smallest coordinates.
    pub min: DVec3,
    /// Largest coordinates, greater than `min` in each.
    pub max: DVec3,
}

/// Below this a direction's reciprocal might not be finite.
const SLOWEST: f64 = 1e-300;

/// A face, met at `height / speed`.
#[derive(Clone, Copy)]
struct Meeting {
    height: Double,
    speed: Double,
    face: Face,
}

/// One of a box's six faces.
#[derive(Clone, Copy)]
pub(super) struct Face {
    pub(super) axis: usize,
    pub(super) upper: bool,
}

impl Meeting {
    fn new(height: Double, speed: Double, face: Face) -> Self {
        // Up by a power of two where both are small, so that no product of them underflows.
        let largest = height.rounded().abs().max(speed.rounded().abs());
        let scale = libm::ldexp(1.0, -libm::ilogb(largest).clamp(-1000, 0));
        Self { height: height.scaled(scale), speed: speed.scaled(scale), face }
    }

    /// Which of two comes first: exactly, for speeds that are plain `f64`.
    fn compare(&self, other: &Self) -> Ordering {
        if self.speed.rest() == 0.0 && other.speed.rest() == 0.0 {
            return compare_quotients(self.height, self.speed.rounded(), other.height, other.speed.rounded());
        }
        let sign = (self.height * other.speed - other.height * self.speed).sign();
        if self.speed.sign() == other.speed.sign() { sign } else { sign.reverse() }
    }
}

/// Where a ray enters and leaves the slabs whose planes are `low` and `high` ahead of its origin; `None` if it misses the box.
fn exact_crossing(low: Double3, high: Double3, direction: Double3) -> Option<(Meeting, Meeting)> {
    let axes = [(low.x, high.x, direction.x), (low.y, high.y, direction.y), (low.z, high.z, direction.z)];
    let mut crossing: Option<(Meeting, Meeting)> = None;
    for (axis, (low, high, speed)) in axes.into_iter().enumerate() {
        if speed.sign().is_eq() {
            if low.sign().is_gt() || high.sign().is_lt() {
                return None;
            }
            continue;
        }
        let upwards = speed.sign().is_gt();
        let (near, far) = if upwards { (low, high) } else { (high, low) };
        let near = Meeting::new(near, speed, Face { axis, upper: !upwards });
        let far = Meeting::new(far, speed, Face { axis, upper: upwards });
        crossing = Some(crossing.map_or((near, far), |(entry, exit)| {
            let later = if near.compare(&entry).is_gt() { near } else { entry };
            let earlier = if far.compare(&exit).is_lt() { far } else { exit };
            (later, earlier)
        }));
    }
    crossing.filter(|(entry, exit)| entry.compare(exit).is_le())
}

/// The first `t >= 0` of an [`exact_crossing`], and the face that is met there.
pub(super) fn exact_first_crossing(
    low: Double3,
    high: Double3,
    direction: Double3,
) -> Option<(Double, Face)> {
    let (entry, exit) = exact_crossing(low, high, direction)?;
    [entry, exit]
        .into_iter()
        .map(|meeting| (meeting.height / meeting.speed, meeting.face))
        .find(|(t, _)| t.sign().is_ge())
}

/// The nearest of the planes ahead, where an [`exact_crossing`] ends.
pub(super) fn exact_exit(low: Double3, high: Double3, direction: Double3) -> Option<Double> {
    let axes = [(low.x, high.x, direction.x), (low.y, high.y, direction.y), (low.z, high.z, direction.z)];
    let planes = axes.into_iter().enumerate().filter_map(|(axis, (low, high, speed))| match speed.sign() {
        Ordering::Less => Some(Meeting::new(low, speed, Face { axis, upper: false })),
        Ordering::Equal => None,
        Ordering::Greater => Some(Meeting::new(high, speed, Face { axis, upper: true })),
    });
    let nearest = planes.min_by(Meeting::compare)?;
    Some(nearest.height / nearest.speed)
}

/// A face's outward normal.
#[inline]
pub(super) fn outward(face: Face) -> DVec3 {
    let mut normal = DVec3::ZERO;
    normal[face.axis] = if face.upper { 1.0 } else { -1.0 };
    normal
}

impl AlignedBox {
    /// The smallest `t >= 0` on the box.
    #[must_use]
    #[inline]
    pub fn first_hit(&self, ray: &Ray) -> Verdict {
        let (origin, direction) = (ray.origin(), ray.direction());
        // A difference times a reciprocal is rounded three times; its sign is right.
        let (entry, exit) = if direction.abs().min_element() > SLOWEST {
            let inverse = direction.recip();
            let (at_min, at_max) = ((self.min - origin) * inverse, (self.max - origin) * inverse);
            (at_min.min(at_max).max_element(), at_min.max(at_max).min_element())
        } else {
            self.crossing(origin, direction)
        };
        let close = 8.0 * U * entry.abs().max(exit.abs());
        if exit < 0.0 || entry > exit + close {
            return Verdict::Miss;
        }
        if entry > exit - close {
            return Verdict::Open;
        }
        // Adding zero makes a negative zero positive.
        let t = if entry >= 0.0 { entry } else { exit } + 0.0;
        Verdict::Hit(Root::within(t, 4.0 * U * t))
    }

    /// As [`AlignedBox::first_hit`], for arguments that are `roughness` times worse than rounded once.
    #[inline]
    pub(super) fn first_crossing(&self, origin: DVec3, direction: DVec3, roughness: f64) -> Verdict {
        let met = Self::roughly_met(origin, direction, roughness, self.max);
        let (mut entry, mut exit) = (Root::within(f64::NEG_INFINITY, 0.0), Root::within(f64::INFINITY, 0.0));
        for axis in 0..3 {
            let (Some(at_min), Some(at_max)) = (met(axis, self.min[axis]), met(axis, self.max[axis])) else {
                // Almost along the slab.
                return Verdict::Open;
            };
            let (near, far) = if direction[axis] > 0.0 { (at_min, at_max) } else { (at_max, at_min) };
            entry = entry.later(near);
            exit = exit.earlier(far);
        }
        if entry.earliest() > exit.latest() || exit.latest() < 0.0 {
            Verdict::Miss
        } else if entry.latest() >= exit.earliest() {
            Verdict::Open
        } else if entry.earliest() > 0.0 {
            Verdict::Hit(entry)
        } else if entry.latest() < 0.0 && exit.earliest() > 0.0 {
            Verdict::Hit(exit)
        } else {
            Verdict::Open
        }
    }

    /// Where the plane of a face is met, for arguments that are `roughness` times worse than rounded once; `None` for a ray
    /// that is almost parallel to it.
    #[inline]
    pub(super) fn roughly_met(
        origin: DVec3,
        direction: DVec3,
        roughness: f64,
        largest: DVec3,
    ) -> impl Fn(usize, f64) -> Option<Root> {
        let u = U * roughness;
        let place_error = 2.0 * u * (origin.abs().max_element() + largest.max_element());
        let way_error = 2.0 * u * direction.abs().max_element();
        move |axis, plane| {
            let (o, d) = (origin[axis], direction[axis]);
            let inverse = d.recip();
            let t = (plane - o) * inverse;
            let error = (place_error + t.abs() * way_error) * inverse.abs() + 8.0 * U * t.abs();
            (d.abs() > 1024.0 * way_error).then_some(Root::within(t, error))
        }
    }

    /// As [`AlignedBox::first_hit`], with a hundred bits throughout.
    #[must_use]
    pub fn exact_hit(&self, origin: DVec3, direction: impl Into<Double3>) -> Option<Double> {
        Some(self.exact_meeting(origin, direction)?.0)
    }

    /// [`AlignedBox::exact_hit`], with the face.
    fn exact_meeting(&self, origin: DVec3, direction: impl Into<Double3>) -> Option<(Double, Face)> {
        let (low, high) = (Double3::difference(self.min, origin), Double3::difference(self.max, origin));
        exact_first_crossing(low, high, direction.into())
    }

    /// The meeting near an inexact `t`.
    #[must_use]
    #[inline(always)]
    pub fn refined(&self, origin: DVec3, direction: DVec3, t: f64) -> Refined {
        /// Quotients of smaller numbers might lose digits.
        const TINY: f64 = 1e-140;
        let clear = self.only_face(origin, direction, t);
        let clear = clear.filter(|face| direction[face.axis].abs() > TINY);
        match clear {
            Some(face) => {
                let t = Double::difference(self.plane(face), origin[face.axis]) / direction[face.axis].into();
                self.met(origin, direction, t, face)
            }
            None => self.surface_at(origin, direction, t.into(), false),
        }
    }

    /// The same near a `t` of which few bits are certain.
    #[must_use]
    pub fn solved(&self, origin: DVec3, direction: DVec3, t: f64) -> Refined {
        self.surface_at(origin, direction, t.into(), false)
    }

    /// The only face whose plane the ray is on at `t`, as far as can be told of a `t` that was rounded a few times.
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

    /// The face that the ray certainly meets at `t`, given where it meets the planes of faces.
    #[inline]
    pub(super) fn clear_face(
        &self,
        direction: DVec3,
        t: f64,
        met: impl Fn(usize, f64) -> Option<Root>,
    ) -> Option<Face> {
        let never = |t: f64| (Root::within(t, 0.0), Face { axis: 0, upper: false });
        let (mut nears, mut fars) = ([never(f64::NEG_INFINITY); 3], [never(f64::INFINITY); 3]);
        for axis in 0..3 {
            if direction[axis] != 0.0 {
                let upwards = direction[axis] > 0.0;
                let (lower, upper) = (Face { axis, upper: false }, Face { axis, upper: true });
                let at_min = (met(axis, self.min[axis])?, lower);
                let at_max = (met(axis, self.max[axis])?, upper);
                (nears[axis], fars[axis]) = if upwards { (at_min, at_max) } else { (at_max, at_min) };
            }
        }
        let later = |a: &(Root, Face), b: &(Root, Face)| a.0.t().total_cmp(&b.0.t());
        let entry = nears.into_iter().max_by(later)?;
        let (candidates, chosen) =
            if t <= entry.0.latest() { (nears, entry) } else { (fars, fars.into_iter().min_by(later)?) };
        let rivals = candidates.iter().filter(|(root, _)| root.may_equal(&chosen.0)).count();
        (rivals == 1).then_some(chosen.1)
    }

    /// Where the ray enters and leaves the three slabs (Kay and Kajiya, "Ray Tracing Complex Scenes", 1986), closed ones: a
    /// ray in a face touches it. A direction component of zero is an interval test.
    fn crossing(&self, origin: DVec3, direction: DVec3) -> (f64, f64) {
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

    /// Where a ray that starts on the box and goes inwards comes out: only faces ahead count. From an edge it may come out
    /// at once, by the other face.
    #[must_use]
    pub fn far_hit(&self, origin: DVec3, direction: DVec3) -> Option<Root> {
        let t = self.exit(origin, direction).0.max(0.0);
        t.is_finite().then_some(Root::within(t, 16.0 * U * t))
    }

    /// As [`AlignedBox::far_hit`], with a hundred bits.
    #[must_use]
    pub fn exact_far_hit(&self, origin: DVec3, direction: impl Into<Double3>) -> Option<Double> {
        let (low, high) = (Double3::difference(self.min, origin), Double3::difference(self.max, origin));
        exact_exit(low, high, direction.into())
    }

    /// The nearest face ahead.
    pub(super) fn exit(&self, origin: DVec3, direction: DVec3) -> (f64, Face) {
        let mut nearest = (f64::INFINITY, Face { axis: 0, upper: false });
        for axis in 0..3 {
            let d = direction[axis];
            if d != 0.0 {
                let face = Face { axis, upper: d > 0.0 };
                let t = (self.plane(face) - origin[axis]) / d;
                if t < nearest.0 {
                    nearest = (t, face);
                }
            }
        }
        nearest
    }

    /// The meeting at `t`. `far` says that `t` is from [`AlignedBox::far_hit`].
    #[must_use]
    pub fn surface_at(&self, origin: DVec3, direction: DVec3, t: Double, far: bool) -> Refined {
        let exact = if far { None } else { self.exact_meeting(origin, direction) };
        let (t, face) = exact.unwrap_or_else(|| (t, self.exit(origin, direction).1));
        self.met(origin, direction, t, face)
    }

    /// The meeting at `t` with a face: the point has the face's own coordinate.
    #[inline(always)]
    fn met(&self, origin: DVec3, direction: DVec3, t: Double, face: Face) -> Refined {
        let place = Compensated3::along(origin, direction, t.rounded()).moved(direction * t.rest());
        let mut point = place.clamp(self.min, self.max);
        point[face.axis] = self.plane(face);
        Refined { t, point, normal: outward(face) }
    }

    /// A face's coordinate.
    #[inline]
    pub(super) fn plane(&self, face: Face) -> f64 {
        if face.upper { self.max[face.axis] } else { self.min[face.axis] }
    }

    /// Is the point within, not on the surface?
    #[must_use]
    pub fn contains(&self, point: DVec3) -> bool {
        point.cmpgt(self.min).all() && point.cmplt(self.max).all()
    }

    /// A box around it.
    #[must_use]
    pub fn bounds(&self) -> Bounds {
        Bounds { min: self.min, max: self.max }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn first(origin: DVec3, direction: DVec3) -> Option<f64> {
        UNIT.first_hit(&Ray::new(origin, direction)?).decided(direction, || UNIT.exact_hit(origin, direction))
    }

    fn far(origin: DVec3, direction: DVec3) -> Option<f64> {
        UNIT.far_hit(origin, direction).map(|root| root.t())
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
        let Refined { point, normal, .. } = UNIT.refined(origin, direction, t);
        assert_eq!((point.z, normal), (-1.0, DVec3::NEG_Z));
        let t = first(DVec3::ZERO, DVec3::new(0.2, -1.0, 0.0)).unwrap();
        let Refined { point, normal, .. } = UNIT.refined(DVec3::ZERO, DVec3::new(0.2, -1.0, 0.0), t);
        assert_eq!(
            (point, normal),
            (DVec3::new(0.2, -1.0, 0.0), DVec3::NEG_Y),
            "outward also when seen from inside"
        );
    }

    #[test]
    fn a_ray_into_the_box_comes_out_once() {
        assert_eq!(far(DVec3::new(0.0, 0.0, -1.0), DVec3::Z), Some(2.0));
        // From an edge it comes out at once, by the other face.
        let (origin, direction) = (DVec3::new(0.0, 1.0, -1.0), DVec3::new(0.0, 1.0, 1.0));
        assert_eq!(far(origin, direction), Some(0.0));
        let Refined { point, normal, .. } = UNIT.surface_at(origin, direction, Double::ZERO, true);
        assert_eq!((point, normal), (origin, DVec3::Y));
    }
}
