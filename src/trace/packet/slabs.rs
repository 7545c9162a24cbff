//! Intersection of half a packet with rotated and sheared boxes: three slabs, in whose coordinates rays are known within error bounds.

use fearless_simd::prelude::*;

use super::leaves::{HalfRays, PacketIntersection};
use crate::trace::math::{F64s, F64s3, Mask, dot, splat, splat3, subtract};
use crate::trace::shapes::{AlignedBox, BoxImage, U};

/// A `t` in each lane, and its error bound: [`BoundedT`](crate::trace::math::BoundedT).
#[derive(Clone, Copy)]
struct RootLanes<S: Simd> {
    t: F64s<S>,
    error: F64s<S>,
}

impl<S: Simd> RootLanes<S> {
    #[inline(always)]
    fn latest(&self) -> F64s<S> {
        self.t + self.error
    }

    #[inline(always)]
    fn earliest(&self) -> F64s<S> {
        self.t - self.error
    }

    #[inline(always)]
    fn select(mask: Mask<S>, one: Self, other: Self) -> Self {
        Self { t: mask.select(one.t, other.t), error: mask.select(one.error, other.error) }
    }

    /// Returns the larger `t`. Its error bound is the larger of both unless the roots certainly differ.
    #[inline(always)]
    fn later(self, other: Self) -> Self {
        let (first, second) = self.ordered(other);
        let apart = second.earliest().simd_gt(first.latest());
        let larger = second.error.simd_gt(first.error) | apart;
        Self { t: second.t, error: larger.select(second.error, first.error) }
    }

    /// Returns the smaller `t`. Its error bound is the larger of both unless the roots certainly differ.
    #[inline(always)]
    fn earlier(self, other: Self) -> Self {
        let (first, second) = self.ordered(other);
        let apart = second.earliest().simd_gt(first.latest());
        let larger = first.error.simd_gt(second.error) | apart;
        Self { t: first.t, error: larger.select(first.error, second.error) }
    }

    /// Returns both roots, the one with the smaller `t` first.
    #[inline(always)]
    fn ordered(self, other: Self) -> (Self, Self) {
        let ordered = self.t.simd_lt(other.t);
        (Self::select(ordered, self, other), Self::select(ordered, other, self))
    }

    /// Returns the root with the larger `t`, with its own error bound.
    #[inline(always)]
    fn or_later(self, other: Self) -> Self {
        Self::select(self.t.simd_lt(other.t), other, self)
    }

    /// Returns the root with the smaller `t`, with its own error bound.
    #[inline(always)]
    fn or_earlier(self, other: Self) -> Self {
        Self::select(other.t.simd_lt(self.t), other, self)
    }

    #[inline(always)]
    fn may_equal(&self, other: &Self) -> Mask<S> {
        self.earliest().simd_le(other.latest()) & other.earliest().simd_le(self.latest())
    }
}

/// The `t` at which rays enter and leave each slab of a box.
pub(super) struct SlabRoots<S: Simd> {
    nears: [RootLanes<S>; 3],
    fars: [RootLanes<S>; 3],
    /// Lanes whose rays run towards larger coordinates, by axis.
    upwards: [Mask<S>; 3],
    /// Lanes whose rays are parallel to a slab, or nearly so.
    open: Mask<S>,
}

/// The face that each ray hits, if it is certain.
pub(super) struct FaceLanes<S: Simd> {
    /// The axis that the face is perpendicular to.
    pub(super) at: [Mask<S>; 3],
    pub(super) upper: Mask<S>,
    pub(super) certain: Mask<S>,
}

/// The heights of ray origins along an axis, their rates of change with `t`, and error bounds of both.
struct Height<S: Simd> {
    o: F64s<S>,
    d: F64s<S>,
    o_error: F64s<S>,
    d_error: F64s<S>,
}

impl<S: Simd> Height<S> {
    /// Returns the `t` at which rays reach the heights of two planes.
    #[inline(always)]
    fn reach(&self, simd: S, [low, high]: [f64; 2]) -> (RootLanes<S>, RootLanes<S>) {
        let inverse = splat(simd, 1.0) / self.d;
        (self.meet(inverse, splat(simd, low)), self.meet(inverse, splat(simd, high)))
    }

    #[inline(always)]
    fn meet(&self, inverse: F64s<S>, plane: F64s<S>) -> RootLanes<S> {
        let t = (plane - self.o) * inverse;
        let error = (self.o_error + t.abs() * self.d_error) * inverse.abs() * 1.01 + t.abs() * (8.0 * U);
        RootLanes { t, error }
    }
}

#[inline(always)]
fn absolute<S: Simd>([x, y, z]: F64s3<S>) -> F64s3<S> {
    [x.abs(), y.abs(), z.abs()]
}

impl<S: Simd> SlabRoots<S> {
    /// Intersects rays with the slabs of a box.
    #[inline(always)]
    pub(super) fn new(simd: S, rays: &HalfRays<S>, image: &BoxImage) -> Self {
        let from_center = subtract(rays.origin, splat3(simd, image.center()));
        let zero = splat(simd, 0.0);
        let nothing = RootLanes { t: zero, error: zero };
        let none = zero.simd_lt(zero);
        let mut all = Self { nears: [nothing; 3], fars: [nothing; 3], upwards: [none; 3], open: none };
        let AlignedBox { min, max } = image.near();
        let (sizes, speeds) = (absolute(from_center), absolute(rays.direction));
        for (axis, (row, _)) in image.slabs().into_iter().enumerate() {
            let (exact, size) = (splat3(simd, row), splat3(simd, row.abs()));
            let (o, d) = (dot(exact, from_center), dot(exact, rays.direction));
            let o_error = dot(size, sizes) * (8.0 * U) + image.near_error()[axis];
            let d_error = dot(size, speeds) * (8.0 * U);
            let height = Height { o, d, o_error, d_error };
            let (at_min, at_max) = height.reach(simd, [min[axis], max[axis]]);
            let upwards = d.simd_gt(zero);
            all.nears[axis] = RootLanes::select(upwards, at_min, at_max);
            all.fars[axis] = RootLanes::select(upwards, at_max, at_min);
            all.upwards[axis] = upwards;
            all.open |= !d.abs().simd_gt(d_error * 1024.0);
        }
        all
    }

    #[inline(always)]
    fn entry(&self) -> RootLanes<S> {
        let [x, y, z] = self.nears;
        x.later(y).later(z)
    }

    #[inline(always)]
    fn exit(&self) -> RootLanes<S> {
        let [x, y, z] = self.fars;
        x.earlier(y).earlier(z)
    }

    /// Returns the first hits of the box: [`AlignedBox::first_crossing`].
    #[inline(always)]
    fn first(&self, simd: S) -> PacketIntersection<S> {
        let (entry, exit) = (self.entry(), self.exit());
        let zero = splat(simd, 0.0);
        let missed = entry.earliest().simd_gt(exit.latest()) | exit.latest().simd_lt(zero);
        let through = entry.latest().simd_lt(exit.earliest()) & !missed;
        let enters = through & entry.earliest().simd_gt(zero);
        let leaves = through & entry.latest().simd_lt(zero) & exit.earliest().simd_gt(zero);
        let RootLanes { t, error } = RootLanes::select(enters, entry, exit);
        let hit = (enters | leaves) & !self.open;
        PacketIntersection { t, error, hit, open: self.open | !(missed | hit) }
    }

    /// Returns the exits of rays that leave the box inwards: `AlignedBox::rough_exit`.
    #[inline(always)]
    fn last(&self, simd: S) -> PacketIntersection<S> {
        let exit = self.exit();
        let hit = exit.earliest().simd_gt(splat(simd, 0.0)) & !self.open;
        PacketIntersection { t: exit.t, error: exit.error, hit, open: !hit }
    }

    /// Returns the faces that rays hit at `t`, or through which they exit in the lanes `inside`: `AlignedBox::clear_face`.
    #[inline(always)]
    pub(super) fn faces(&self, t: F64s<S>, inside: Mask<S>) -> FaceLanes<S> {
        let ([x, y, z], [far_x, far_y, far_z]) = (self.nears, self.fars);
        let (entry, exit) = (x.or_later(y).or_later(z), far_x.or_earlier(far_y).or_earlier(far_z));
        let enters = !inside & t.simd_le(entry.latest());
        let chosen = RootLanes::select(enters, entry, exit);
        let mut at = self.upwards;
        for ((at, near), far) in at.iter_mut().zip(self.nears).zip(self.fars) {
            *at = RootLanes::select(enters, near, far).may_equal(&chosen);
        }
        let rivals = (at[0] & at[1]) | (at[1] & at[2]) | (at[2] & at[0]);
        let upwards = (at[0] & self.upwards[0]) | (at[1] & self.upwards[1]) | (at[2] & self.upwards[2]);
        let upper = (enters & !upwards) | (!enters & upwards);
        FaceLanes { at, upper, certain: (at[0] | at[1] | at[2]) & !rivals & !self.open }
    }
}

/// Intersects rays with a box: [`BoxImage::intersect`].
#[inline(always)]
pub(super) fn box_image<S: Simd>(simd: S, rays: &HalfRays<S>, image: &BoxImage) -> PacketIntersection<S> {
    simd.vectorize(
        #[inline(always)]
        || SlabRoots::new(simd, rays, image).first(simd),
    )
}

/// Finds the exits of rays from a box that they leave inwards: [`BoxImage::exit`].
#[inline(always)]
pub(super) fn box_image_exit<S: Simd>(
    simd: S,
    rays: &HalfRays<S>,
    image: &BoxImage,
) -> PacketIntersection<S> {
    simd.vectorize(
        #[inline(always)]
        || SlabRoots::new(simd, rays, image).last(simd),
    )
}
