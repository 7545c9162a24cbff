//! Affine images of boxes: rotated, sheared or both.

use glam::{DAffine3, DVec3};

use super::affine_map::{bounds_of_image, condition, exact_inverse};
use super::bounds::Bounds;
use super::intersection::{
    ExactCrossing, ExactHit, Face, Facet, Intersection, Intersections, Refined, RefinedHit,
};
use super::slabs::{ExactSlab, Height, SlabRoots, cross_exactly, exit_exactly, pivot};
use super::sphere::{U, newton_step};
use crate::trace::math::{
    Compensated, Double, Double3, Exact, Exact3, Real, absolute, dot, moderate3, negative, offset_height,
    pick3, spread, subtract, times,
};
use crate::trace::rays::{PreparedRay, Rays};

/// A box under an affine map.
///
/// It is the intersection of three slabs low <= row.p <= high, which these numbers define exactly. A row depends only on the direction of
/// its planes and is scaled so that its largest component is 1. Faces that are flush in the scene are therefore coplanar to the last bit,
/// both between boxes that are rotated together and between a rotated box and an axis-aligned one that it stands on, whose rows are the
/// axes themselves.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct BoxImage {
    rows: [DVec3; 3],
    low: DVec3,
    high: DVec3,
    /// The rows, normalized.
    normals: [DVec3; 3],
    /// A point near the centre of the box. Coordinates relative to it have the most digits in `f64`.
    center: DVec3,
    /// `low` and `high` relative to `center`.
    near_low: DVec3,
    near_high: DVec3,
    /// Error bound of both.
    near_error: DVec3,
    /// Bound of the growth of rounding errors under the inverse map.
    condition: f64,
    forward: DAffine3,
    half: DVec3,
}

impl BoxImage {
    /// Creates the image of an origin-centred box with these half-extents. Returns `None` if rounding leaves it no interior: for a singular
    /// map, or for a box too small for its distance from the origin.
    #[must_use]
    pub fn new(forward: DAffine3, half: DVec3) -> Option<Self> {
        let columns = [forward.matrix3.x_axis, forward.matrix3.y_axis, forward.matrix3.z_axis];
        Self::exact(columns.map(Double3::from), forward.translation.into(), half.into())
    }

    /// Creates the image from double-double values. Each slab is rounded once.
    #[must_use]
    pub(crate) fn exact(columns: [Double3; 3], translation: Double3, half: Double3) -> Option<Self> {
        let [a, b, c] = columns.map(Double3::rounded);
        let forward = DAffine3::from_cols(a, b, c, translation.rounded());
        let mut image = Self {
            rows: [DVec3::ZERO; 3],
            low: DVec3::ZERO,
            high: DVec3::ZERO,
            normals: [DVec3::ZERO; 3],
            center: translation.rounded(),
            near_low: DVec3::ZERO,
            near_high: DVec3::ZERO,
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
            image.near_low[axis] = offset_height(image.low[axis], image.rows[axis], image.center).rounded();
            image.near_high[axis] = offset_height(image.high[axis], image.rows[axis], image.center).rounded();
        }
        image.near_error = image.near_low.abs().max(image.near_high.abs()) * (2.0 * U);
        let sound = image.low.cmplt(image.high).all() && image.low.is_finite() && image.high.is_finite();
        sound.then_some(image)
    }

    /// Returns the map, rounded.
    #[must_use]
    pub fn forward(&self) -> &DAffine3 {
        &self.forward
    }

    /// Returns the half-extents before the map, rounded.
    #[must_use]
    pub fn half(&self) -> DVec3 {
        self.half
    }

    /// Returns the slabs: their rows, each with its lower and upper offset.
    #[must_use]
    pub fn slabs(&self) -> [(DVec3, [f64; 2]); 3] {
        std::array::from_fn(|axis| (self.rows[axis], [self.low[axis], self.high[axis]]))
    }

    /// Intersects rays with the slabs, by their heights above the planes through `center` that are parallel to them. The difference, the
    /// three products and their sum have an error of less than 5 u, the slabs relative to `center` of u.
    #[inline(always)]
    fn roots<R: Real>(&self, rays: &Rays<R>) -> SlabRoots<R> {
        let from_center = subtract(rays.origin, spread(rays.origin[0], self.center));
        let rays = Rays { origin: from_center, direction: rays.direction };
        let (sizes, speeds) = (absolute(rays.origin), absolute(rays.direction));
        // Three calls, because before a loop the array would be filled with zeros.
        let heights = [
            self.height(0, &rays, sizes, speeds),
            self.height(1, &rays, sizes, speeds),
            self.height(2, &rays, sizes, speeds),
        ];
        SlabRoots::new(&heights, self.near_low.into(), self.near_high.into())
    }

    /// Returns the heights of rays above the middle of a slab, with `sizes` and `speeds`, the magnitudes of their coordinates.
    #[inline(always)]
    fn height<R: Real>(&self, axis: usize, rays: &Rays<R>, sizes: [R; 3], speeds: [R; 3]) -> Height<R> {
        let like = rays.origin[0];
        let (row, size) = (spread(like, self.rows[axis]), spread(like, self.rows[axis].abs()));
        Height {
            origin: dot(row, rays.origin),
            speed: dot(row, rays.direction),
            origin_error: dot(size, sizes) * (8.0 * U) + self.near_error[axis],
            speed_error: dot(size, speeds) * (8.0 * U),
        }
    }

    /// Returns the smallest `t >= 0` on the box.
    #[must_use]
    #[inline]
    pub(crate) fn intersect(&self, ray: &PreparedRay) -> Intersection {
        self.intersections(&ray.into()).into()
    }

    /// Intersects rays with the box.
    #[inline(always)]
    pub(crate) fn intersections<R: Real>(&self, rays: &Rays<R>) -> Intersections<R> {
        self.roots(rays).first()
    }

    /// Finds the exits of rays that start on the box and go inwards.
    #[inline(always)]
    pub(crate) fn exits<R: Real>(&self, rays: &Rays<R>) -> Intersections<R> {
        self.roots(rays).last()
    }

    /// Returns the exact entry and exit of the ray's line.
    pub(crate) fn cross_exactly(&self, origin: DVec3, direction: &Exact3) -> Option<ExactCrossing> {
        cross_exactly(&self.exact_slabs(origin, direction))
    }

    /// Returns the exact exit of a ray that starts on the box and goes inwards.
    pub(crate) fn exit_exactly(&self, origin: DVec3, direction: &Exact3) -> Option<ExactHit> {
        exit_exactly(&self.exact_slabs(origin, direction))
    }

    pub(super) fn exact_slabs(&self, origin: DVec3, direction: &Exact3) -> [ExactSlab; 3] {
        let origin = Exact3::from(origin);
        std::array::from_fn(|axis| {
            let row = Exact3::from(self.rows[axis]);
            let (at, speed) = (row.dot(&origin), row.dot(direction));
            let ahead = |offset: f64| &Exact::from(offset) - &at;
            ExactSlab { low: ahead(self.low[axis]), high: ahead(self.high[axis]), speed }
        })
    }

    /// Returns the hit near an approximate `t`: [`BoxImage::refined`]. Returns `None` near edges, where the face is uncertain.
    #[must_use]
    pub(crate) fn refine(&self, origin: DVec3, direction: DVec3, t: f64, far: bool) -> Option<RefinedHit> {
        self.refined(&Rays::new(origin, direction), t, far).into()
    }

    /// Refines a `t` near the box by one Newton step towards the face. Rays in `far` come from inside. Not found near edges.
    #[inline(always)]
    pub(crate) fn refined<R: Real>(&self, rays: &Rays<R>, t: R, far: R::Mask) -> Refined<R> {
        let face = self.roots(rays).faces(t, far);
        let (row, normal) = (face.vector_of_axis(t, &self.rows), face.vector_of_axis(t, &self.normals));
        let (low, high) = (face.of_axis(spread(t, self.low)), face.of_axis(spread(t, self.high)));
        let place = Compensated::along(rays.origin, rays.direction, t);
        let height = place.dot(row) - Double { high: R::pick(face.upper, high, low), low: t.of(0.0) };
        let step = newton_step(height.rounded(), dot(row, rays.direction));
        Refined {
            t: Double::sum(t, step),
            point: place.moved(times(rays.direction, step)),
            normal: pick3(face.upper, normal, negative(normal)),
            found: face.certain & moderate3(place.rounded()) & moderate3(row),
        }
    }

    /// Always returns `None`: a `t` with few certain bits is solved exactly.
    pub(crate) fn solve(&self, _origin: DVec3, _direction: DVec3, _t: f64) -> Option<RefinedHit> {
        None
    }

    /// Returns the hit at `t` on a face.
    pub(crate) fn surface_point(&self, origin: DVec3, direction: DVec3, t: Double, face: Face) -> RefinedHit {
        let place = Compensated::along(origin, direction, t.rounded());
        RefinedHit { t, point: place.moved(direction * t.rest()).into(), normal: self.normal(face) }
    }

    fn normal(&self, face: Face) -> DVec3 {
        if face.upper { self.normals[face.axis] } else { -self.normals[face.axis] }
    }

    /// Returns the exit of a ray that starts on the box and goes inwards.
    #[must_use]
    pub(crate) fn exit(&self, origin: DVec3, direction: DVec3) -> Intersection {
        self.exits(&Rays::new(origin, direction)).into()
    }

    /// Returns the plane of the face that is certainly hit at `t`.
    pub(crate) fn facet(&self, origin: DVec3, direction: DVec3, t: f64, far: bool) -> Option<Facet> {
        let face = self.roots(&Rays::new(origin, direction)).faces(t, far).face()?;
        let offset = if face.upper { self.high[face.axis] } else { self.low[face.axis] };
        Some(Facet { row: self.rows[face.axis], offset })
    }

    /// Returns whether the point is strictly inside.
    #[must_use]
    pub fn contains(&self, point: DVec3) -> bool {
        (0..3).all(|axis| {
            let height = |offset: f64| offset_height(offset, self.rows[axis], point).sign();
            height(self.low[axis]).is_lt() && height(self.high[axis]).is_gt()
        })
    }

    /// Returns the bounding box, or `None` if the map is too ill-conditioned for a reliable one.
    #[must_use]
    pub fn bounds(&self) -> Option<Bounds> {
        bounds_of_image(&self.forward, self.half, self.condition)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_mirrored_box_keeps_its_normals_outward() {
        let map = DAffine3::from_scale(DVec3::new(-1.0, 1.0, 1.0));
        let mirrored = BoxImage::new(map, DVec3::ONE).unwrap();
        let origin = DVec3::new(-4.0, 0.2, 0.1);
        let ray = PreparedRay::new(origin, DVec3::X).unwrap();
        let exact = || mirrored.cross_exactly(origin, &DVec3::X.into());
        let t = mirrored.intersect(&ray).decided(DVec3::X, exact).unwrap();
        let RefinedHit { point, normal, .. } = mirrored.refine(origin, DVec3::X, t, false).unwrap();
        assert_eq!((t, point, normal), (3.0, DVec3::new(-1.0, 0.2, 0.1), DVec3::NEG_X));
    }
}
