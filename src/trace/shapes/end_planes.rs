//! The two parallel planes in which a cylinder ends.

use glam::DVec3;

use super::intersection::{Facet, Refined};
use super::slabs::{ExactSlab, FaceMasks, Height, or_exact, pivot};
use super::sphere::{U, newton_step};
use crate::trace::math::{
    BoundedT, Compensated, Double, Double3, Exact, Exact3, Real, Truth, absolute, dot, moderate3, negative,
    offset_height, pick3, spread, subtract, times,
};
use crate::trace::rays::Rays;

/// A slab low <= row.p <= high. It is rounded as the slabs of a [`BoxImage`](super::BoxImage), so that flat ends are coplanar to the last
/// bit with the faces of boxes that are rotated with them and flush in the scene.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) struct EndPlanes {
    row: DVec3,
    low: f64,
    high: f64,
    /// The row, normalized.
    normal: DVec3,
    /// A point at one end. Coordinates relative to it have the most digits in `f64`.
    center: DVec3,
    /// `low` and `high` relative to `center`, with a bound of the errors of both.
    near: [f64; 2],
    near_error: f64,
}

/// The `t` at which lines enter and leave the slab.
pub(super) struct SlabCrossing<R: Real> {
    pub(super) entry: BoundedT<R>,
    pub(super) exit: BoundedT<R>,
    /// Lines that run towards larger heights.
    pub(super) upwards: R::Mask,
    /// Lines that are parallel to the planes, and certainly outside.
    pub(super) outside: R::Mask,
    /// Lines that are nearly parallel to the planes.
    pub(super) undecided: R::Mask,
}

impl EndPlanes {
    /// Creates the planes with a normal of any length through two points. `None` if rounding leaves nothing between them.
    pub(super) fn new(row: Double3, ends: [Double3; 2]) -> Option<Self> {
        let row = row.over(pivot(row));
        let [one, other] = ends.map(|end| row.dot(end).rounded());
        let (low, high) = (one.min(other), one.max(other));
        let (row, center) = (row.rounded(), ends[0].rounded());
        let near = [low, high].map(|offset| offset_height(offset, row, center).rounded());
        let near_error = near[0].abs().max(near[1].abs()) * (2.0 * U);
        let sound = low < high && low.is_finite() && high.is_finite() && row.is_finite();
        sound.then(|| Self { row, low, high, normal: row / row.length(), center, near, near_error })
    }

    /// Returns the row, with the lower and the upper offset.
    pub(super) fn slab(&self) -> (DVec3, [f64; 2]) {
        (self.row, [self.low, self.high])
    }

    pub(super) fn normal(&self, upper: bool) -> DVec3 {
        if upper { self.normal } else { -self.normal }
    }

    pub(super) fn facet(&self, upper: bool) -> Facet {
        Facet { row: self.row, offset: if upper { self.high } else { self.low } }
    }

    /// Returns whether a point is strictly between the planes.
    pub(super) fn contains(&self, point: DVec3) -> bool {
        let height = |offset: f64| offset_height(offset, self.row, point).sign();
        height(self.low).is_lt() && height(self.high).is_gt()
    }

    /// Finds where lines enter and leave.
    #[inline(always)]
    pub(super) fn roots<R: Real>(&self, rays: &Rays<R>) -> SlabCrossing<R> {
        let like = rays.origin[0];
        let from_center = subtract(rays.origin, spread(like, self.center));
        let (row, size) = (spread(like, self.row), spread(like, self.row.abs()));
        let height = Height {
            origin: dot(row, from_center),
            speed: dot(row, rays.direction),
            origin_error: dot(size, absolute(from_center)) * (8.0 * U) + self.near_error,
            speed_error: dot(size, absolute(rays.direction)) * (8.0 * U),
        };
        let [low, high] = self.near;
        let (at_low, at_high) = height.reach(low, high);
        let zero = like.of(0.0);
        let upwards = height.speed.greater(zero);
        let never = like.less(like);
        let mut crossing = SlabCrossing {
            entry: BoundedT::pick(upwards, at_low, at_high),
            exit: BoundedT::pick(upwards, at_high, at_low),
            upwards,
            outside: never,
            undecided: never,
        };
        if (!height.is_fast()).any() {
            let certain = height.is_certain();
            // An error bound of 0 means that the speed is exactly zero.
            let parallel = !certain & !height.speed_error.greater(zero);
            let (lowest, highest) =
                (height.origin - height.origin_error, height.origin + height.origin_error);
            let inside = parallel & lowest.greater(like.of(low)) & highest.less(like.of(high));
            let (first, last) = (like.of(f64::NEG_INFINITY), like.of(f64::INFINITY));
            crossing.outside = parallel & (highest.less(like.of(low)) | lowest.greater(like.of(high)));
            crossing.entry = BoundedT::pick(certain, or_exact(crossing.entry), BoundedT::within(first, zero));
            crossing.exit = BoundedT::pick(certain, or_exact(crossing.exit), BoundedT::within(last, zero));
            crossing.undecided = !(certain | inside | crossing.outside);
        }
        crossing
    }

    /// Refines the hits on the planes by one Newton step; `curved` has those on the side.
    #[inline(always)]
    pub(super) fn refined<R: Real>(
        &self,
        place: Compensated<R>,
        rays: &Rays<R>,
        t: R,
        (face, curved): (&FaceMasks<R>, Refined<R>),
    ) -> Refined<R> {
        let (row, normal) = (spread(t, self.row), spread(t, self.normal));
        let offset = R::pick(face.upper, t.of(self.high), t.of(self.low));
        let height = place.dot(row) - Double { high: offset, low: t.of(0.0) };
        let step = newton_step(height.rounded(), dot(row, rays.direction));
        let flat = Refined {
            t: Double::sum(t, step),
            point: place.moved(times(rays.direction, step)),
            normal: pick3(face.upper, normal, negative(normal)),
            found: face.certain & moderate3(place.rounded()) & moderate3(row),
        };
        let side = face.at[0];
        Refined {
            t: Double {
                high: R::pick(side, curved.t.high, flat.t.high),
                low: R::pick(side, curved.t.low, flat.t.low),
            },
            point: pick3(side, curved.point, flat.point),
            normal: pick3(side, curved.normal, flat.normal),
            found: (side & curved.found) | (!side & flat.found),
        }
    }

    /// Returns the slab relative to a line, without rounding.
    pub(super) fn exact(&self, origin: DVec3, direction: &Exact3) -> ExactSlab {
        let row = Exact3::from(self.row);
        let at = row.dot(&origin.into());
        let ahead = |offset: f64| &Exact::from(offset) - &at;
        ExactSlab { low: ahead(self.low), high: ahead(self.high), speed: row.dot(direction) }
    }
}
