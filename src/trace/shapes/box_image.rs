//! Affine images of boxes: turned, sheared or both.

use glam::{DAffine3, DVec3};

use super::aligned_box::{AlignedBox, LocalRay, Slab, cross_exactly, exit_exactly};
use super::bounds::Bounds;
use super::intersection::{ExactCrossing, ExactHit, Face, Facet, Intersection, RefinedHit};
use super::sphere::{U, newton_step};
use super::sphere_image::{bounds_of_image, condition, exact_inverse};
use crate::trace::math::{Compensated, Double, Double3, Exact, Exact3, offset_height};
use crate::trace::rays::Ray;

/// A box under an affine map.
///
/// It is what three slabs have in common, each between two parallel planes, low <= row.p <= high, and exactly what these numbers
/// say. A row depends on the direction of its planes alone: its largest component is 1. So faces that were written flush are in
/// one plane to the last bit, of boxes turned together as of a turned box that stands on one along the axes, whose rows are
/// the axes themselves.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct BoxImage {
    rows: [DVec3; 3],
    low: DVec3,
    high: DVec3,
    /// The rows, of length 1.
    normals: [DVec3; 3],
    /// Near the middle: from here `f64` has the most digits.
    center: DVec3,
    /// The slabs as seen from there.
    near: AlignedBox,
    /// How far those are off.
    near_error: DVec3,
    /// How many times a rounding error can grow on the way back through the map.
    condition: f64,
    forward: DAffine3,
    half: DVec3,
}

impl BoxImage {
    /// The image of an origin-centred box with these half edge lengths. `None` where it has no inside by rounding: for a map that
    /// cannot be inverted, or a box too small for where it is.
    #[must_use]
    pub fn new(forward: DAffine3, half: DVec3) -> Option<Self> {
        let columns = [forward.matrix3.x_axis, forward.matrix3.y_axis, forward.matrix3.z_axis];
        Self::exact(columns.map(Double3::from), forward.translation.into(), half.into())
    }

    /// The same with more digits: slabs are rounded once.
    #[must_use]
    pub fn exact(columns: [Double3; 3], translation: Double3, half: Double3) -> Option<Self> {
        let [a, b, c] = columns.map(Double3::rounded);
        let forward = DAffine3::from_cols(a, b, c, translation.rounded());
        let mut image = Self {
            rows: [DVec3::ZERO; 3],
            low: DVec3::ZERO,
            high: DVec3::ZERO,
            normals: [DVec3::ZERO; 3],
            center: translation.rounded(),
            near: AlignedBox { min: DVec3::ZERO, max: DVec3::ZERO },
            near_error: DVec3::ZERO,
            condition: condition(forward.matrix3),
            forward,
            half: half.rounded(),
        };
        for (axis, (row, half)) in exact_inverse(columns).into_iter().zip(half.to_array()).enumerate() {
            let pivot = pivot(row);
            let row = row.over(pivot);
            let (middle, reach) = (row.dot(translation), half / pivot.abs());
            image.rows[axis] = row.rounded();
            (image.low[axis], image.high[axis]) = ((middle - reach).rounded(), (middle + reach).rounded());
            image.normals[axis] = image.rows[axis] / image.rows[axis].length();
            image.near.min[axis] = offset_height(image.low[axis], image.rows[axis], image.center).rounded();
            image.near.max[axis] = offset_height(image.high[axis], image.rows[axis], image.center).rounded();
        }
        image.near_error = image.near.min.abs().max(image.near.max.abs()) * (2.0 * U);
        let sound = image.low.cmplt(image.high).all() && image.low.is_finite() && image.high.is_finite();
        sound.then_some(image)
    }

    /// The map, rounded.
    #[must_use]
    pub fn forward(&self) -> &DAffine3 {
        &self.forward
    }

    /// Half the box's edge lengths before it is mapped, rounded.
    #[must_use]
    pub fn half(&self) -> DVec3 {
        self.half
    }

    /// The slabs: the rows, and what they are between.
    #[must_use]
    pub fn slabs(&self) -> [(DVec3, [f64; 2]); 3] {
        std::array::from_fn(|axis| (self.rows[axis], [self.low[axis], self.high[axis]]))
    }

    /// From where on rays are taken into account, near the middle.
    pub(crate) fn center(&self) -> DVec3 {
        self.center
    }

    /// The slabs as seen from there.
    pub(crate) fn near(&self) -> &AlignedBox {
        &self.near
    }

    /// How far those are off.
    pub(crate) fn near_error(&self) -> DVec3 {
        self.near_error
    }

    /// The slabs' rows, of length 1.
    pub(crate) fn normals(&self) -> &[DVec3; 3] {
        &self.normals
    }

    /// The ray by its heights above the planes through the center that are parallel to the slabs. A difference, three products and
    /// their sum are rounded by less than 5 u, the slabs as seen from the center by u.
    #[inline]
    fn seen(&self, origin: DVec3, direction: DVec3) -> LocalRay {
        let from_center = origin - self.center;
        let across = |vector: DVec3| DVec3::from_array(self.rows.map(|row| row.dot(vector)));
        let sizes = |vector: DVec3| {
            let vector = vector.abs();
            DVec3::from_array(self.rows.map(|row| row.abs().dot(vector)))
        };
        LocalRay {
            origin: across(from_center),
            direction: across(direction),
            origin_error: sizes(from_center) * (8.0 * U) + self.near_error,
            direction_error: sizes(direction) * (8.0 * U),
        }
    }

    /// The smallest `t >= 0` on the box.
    #[must_use]
    #[inline]
    pub fn intersect(&self, ray: &Ray) -> Intersection {
        self.near.first_crossing(&self.seen(ray.origin(), ray.direction()))
    }

    /// Where the ray's line is in the box, decided exactly.
    pub(crate) fn cross_exactly(&self, origin: DVec3, direction: &Exact3) -> Option<ExactCrossing> {
        cross_exactly(&self.exact_slabs(origin, direction))
    }

    /// Where a ray that starts on the box and goes inwards comes out, decided exactly.
    pub(crate) fn exit_exactly(&self, origin: DVec3, direction: &Exact3) -> Option<ExactHit> {
        exit_exactly(&self.exact_slabs(origin, direction))
    }

    fn exact_slabs(&self, origin: DVec3, direction: &Exact3) -> [Slab; 3] {
        let origin = Exact3::from(origin);
        std::array::from_fn(|axis| {
            let row = Exact3::from(self.rows[axis]);
            let (at, speed) = (row.dot(&origin), row.dot(direction));
            let ahead = |offset: f64| &Exact::from(offset) - &at;
            Slab { low: ahead(self.low[axis]), high: ahead(self.high[axis]), speed }
        })
    }

    /// The meeting near an inexact `t`, by a Newton step towards the face. `far` says that the ray comes from inside. `None` near
    /// edges, where more than one face might be met.
    #[must_use]
    pub(crate) fn refine(&self, origin: DVec3, direction: DVec3, t: f64, far: bool) -> Option<RefinedHit> {
        let face = self.near.clear_face(&self.seen(origin, direction), t, far)?;
        let place = Compensated::along(origin, direction, t);
        let row = self.rows[face.axis];
        let offset = if face.upper { self.high[face.axis] } else { self.low[face.axis] };
        let beyond = (place.dot(row) - offset.into()).rounded();
        let step = newton_step(beyond, row.dot(direction));
        let point = place.moved(direction * step).into();
        Some(RefinedHit { t: Double::sum(t, step), point, normal: self.normal(face) })
    }

    /// Every `t` of which few bits are certain is solved exactly.
    pub(crate) fn solve(&self, _origin: DVec3, _direction: DVec3, _t: f64) -> Option<RefinedHit> {
        None
    }

    /// The meeting at `t` on a face.
    pub(crate) fn surface_point(&self, origin: DVec3, direction: DVec3, t: Double, face: Face) -> RefinedHit {
        let place = Compensated::along(origin, direction, t.rounded());
        RefinedHit { t, point: place.moved(direction * t.rest()).into(), normal: self.normal(face) }
    }

    fn normal(&self, face: Face) -> DVec3 {
        if face.upper { self.normals[face.axis] } else { -self.normals[face.axis] }
    }

    /// Where a ray that starts on the box and goes inwards comes out.
    #[must_use]
    pub fn exit(&self, origin: DVec3, direction: DVec3) -> Intersection {
        self.near.rough_exit(&self.seen(origin, direction))
    }

    /// The plane of the face that is certainly met there.
    pub(crate) fn facet(&self, origin: DVec3, direction: DVec3, t: f64, far: bool) -> Option<Facet> {
        let face = self.near.clear_face(&self.seen(origin, direction), t, far)?;
        let offset = if face.upper { self.high[face.axis] } else { self.low[face.axis] };
        Some(Facet { row: self.rows[face.axis], offset })
    }

    /// Returns whether the point is within, not on the surface.
    #[must_use]
    pub fn contains(&self, point: DVec3) -> bool {
        (0..3).all(|axis| {
            let height = |offset: f64| offset_height(offset, self.rows[axis], point).sign();
            height(self.low[axis]).is_lt() && height(self.high[axis]).is_gt()
        })
    }

    /// A box around it, unless its own numbers are too rough to say where it ends.
    #[must_use]
    pub fn bounds(&self) -> Option<Bounds> {
        bounds_of_image(&self.forward, self.half, self.condition)
    }
}

/// The largest component: of several that are equal as far as forty bits tell, the first.
fn pivot(row: Double3) -> Double {
    /// 1 - 2^-40
    const NEARLY: f64 = 1.0 - 1.0 / 1_099_511_627_776.0;
    let parts = row.to_array();
    let largest = row.rounded().abs().max_element();
    parts.into_iter().find(|part| part.rounded().abs() >= largest * NEARLY).unwrap_or(parts[0])
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_mirrored_box_keeps_its_normals_outward() {
        let map = DAffine3::from_scale(DVec3::new(-1.0, 1.0, 1.0));
        let mirrored = BoxImage::new(map, DVec3::ONE).unwrap();
        let origin = DVec3::new(-4.0, 0.2, 0.1);
        let ray = Ray::new(origin, DVec3::X).unwrap();
        let exact = || mirrored.cross_exactly(origin, &DVec3::X.into());
        let t = mirrored.intersect(&ray).decided(DVec3::X, exact).unwrap();
        let RefinedHit { point, normal, .. } = mirrored.refine(origin, DVec3::X, t, false).unwrap();
        assert_eq!((t, point, normal), (3.0, DVec3::new(-1.0, 0.2, 0.1), DVec3::NEG_X));
    }
}
