//! Slabs: a box is the intersection of three of them.
//!
//! ```text
//! for each slab:
//!     entry, exit = the t at which the ray hits its two planes, in the order of the ray, with error bounds
//! the ray is inside the box from the latest entry to the earliest exit, if the former comes first
//! ```
//!
//! 1. A ray whose speed across a slab is not at least 1024 times its own error bound hits its planes at an uncertain `t`: it is undecided,
//!    unless its speed is exactly zero. It then stays inside or outside the slab: the slab's interval is the whole line, or nothing. If the
//!    speed is so small that its reciprocal and its error bound are not numbers of full precision, it hits the planes at infinite `t`.
//! 2. If two entries overlap, either may be the later one. The larger of their error bounds covers both.
//! 3. The face that a ray enters through is certain if no other entry overlaps the latest one.

use glam::DVec3;

use super::intersection::{ExactCrossing, ExactHit, Face, Intersections, Side};
use super::sphere::U;
use crate::trace::math::{BoundedT, Double, Double3, Exact, ExactRoot, Real, Truth, pick3, spread};

/// Magnitude below which the reciprocal of a speed, or of a direction component, might not be finite.
pub(crate) const SLOWEST: f64 = 1e-300;

/// The heights of ray origins across a slab, their rates of change with `t`, and error bounds of both.
#[derive(Clone, Copy)]
pub(super) struct Height<R> {
    pub(super) origin: R,
    pub(super) speed: R,
    pub(super) origin_error: R,
    pub(super) speed_error: R,
}

/// The `t` at which rays enter and leave each slab of a box.
pub(super) struct SlabRoots<R: Real> {
    entries: [BoundedT<R>; 3],
    exits: [BoundedT<R>; 3],
    /// Rays that run towards larger heights, by axis.
    upwards: [R::Mask; 3],
    /// Rays that are parallel to a slab and outside of it, before any slab is undecided.
    outside: R::Mask,
    /// Rays that are nearly parallel to a slab, or on one of its planes.
    undecided: R::Mask,
}

/// The face that each ray hits.
#[derive(Clone, Copy)]
pub(super) struct FaceMasks<R: Real> {
    /// The axis of the face, as in [`Face`](super::intersection::Face).
    pub(super) at: [R::Mask; 3],
    /// Upper faces.
    pub(super) upper: R::Mask,
    /// Rays whose face is certain. The others have any number of axes.
    pub(super) certain: R::Mask,
}

impl<R: Real> Height<R> {
    /// Returns the `t` at which rays reach the planes at two heights.
    #[inline(always)]
    pub(super) fn reach(&self, low: f64, high: f64) -> (BoundedT<R>, BoundedT<R>) {
        let inverse = self.speed.of(1.0) / self.speed;
        (self.meet(inverse, low), self.meet(inverse, high))
    }

    #[inline(always)]
    fn meet(&self, inverse: R, plane: f64) -> BoundedT<R> {
        let t = (inverse.of(plane) - self.origin) * inverse;
        let error =
            (self.origin_error + t.abs() * self.speed_error) * inverse.abs() * 1.01 + t.abs() * (8.0 * U);
        BoundedT::within(t, error)
    }

    /// Returns whether the speed is certain enough for the planes to be hit at certain `t`.
    #[inline(always)]
    pub(super) fn is_certain(&self) -> R::Mask {
        self.speed.abs().greater(self.speed_error * 1024.0)
    }

    /// Returns whether the speed is certain, and its reciprocal finite. Larger sums are not changed by adding such a small number.
    #[inline(always)]
    pub(super) fn is_fast(&self) -> R::Mask {
        self.speed.abs().greater(self.speed_error * 1024.0 + SLOWEST)
    }
}

impl<R: Real> SlabRoots<R> {
    /// Intersects rays with three slabs, given by their lower and upper heights.
    #[inline(always)]
    pub(super) fn new(heights: &[Height<R>; 3], low: [f64; 3], high: [f64; 3]) -> Self {
        let zero = heights[0].origin.of(0.0);
        let (nothing, never) = (BoundedT::within(zero, zero), zero.less(zero));
        let mut all = Self {
            entries: [nothing; 3],
            exits: [nothing; 3],
            upwards: [never; 3],
            outside: never,
            undecided: never,
        };
        let mut fast = !never;
        for axis in 0..3 {
            let (at_low, at_high) = heights[axis].reach(low[axis], high[axis]);
            let upwards = heights[axis].speed.greater(zero);
            all.entries[axis] = BoundedT::pick(upwards, at_low, at_high);
            all.exits[axis] = BoundedT::pick(upwards, at_high, at_low);
            all.upwards[axis] = upwards;
            fast = fast & heights[axis].is_fast();
        }
        if (!fast).any() {
            all.decide_slow(heights, low, high);
        }
        all
    }

    /// Decides the slabs that rays are parallel to, or nearly so. See trick 1.
    #[inline(always)]
    fn decide_slow(&mut self, heights: &[Height<R>; 3], low: [f64; 3], high: [f64; 3]) {
        for axis in 0..3 {
            let Height { origin, origin_error, speed_error, .. } = heights[axis];
            let (zero, low, high) = (origin.of(0.0), origin.of(low[axis]), origin.of(high[axis]));
            let certain = heights[axis].is_certain();
            // An error bound of 0 means that all terms are zero, so that the speed is exactly zero.
            let parallel = !certain & !speed_error.greater(zero);
            let (lowest, highest) = (origin - origin_error, origin + origin_error);
            let inside = parallel & lowest.greater(low) & highest.less(high);
            let outside = parallel & (highest.less(low) | lowest.greater(high));
            let (first, last) = (zero.of(f64::NEG_INFINITY), zero.of(f64::INFINITY));
            let (entry, exit) = (or_exact(self.entries[axis]), or_exact(self.exits[axis]));
            self.entries[axis] = BoundedT::pick(certain, entry, BoundedT::within(first, zero));
            self.exits[axis] = BoundedT::pick(certain, exit, BoundedT::within(last, zero));
            self.outside = self.outside | (outside & !self.undecided);
            self.undecided = self.undecided | !(certain | inside | outside);
        }
    }

    #[inline(always)]
    fn exit(&self) -> BoundedT<R> {
        let [x, y, z] = self.exits;
        x.earlier(y).earlier(z)
    }

    /// Returns the first hits of the box at `t >= 0`.
    #[inline(always)]
    pub(super) fn first(&self) -> Intersections<R> {
        let [x, y, z] = self.entries;
        Intersections::first([x.later(y).later(z), self.exit()], self.outside, self.undecided)
    }

    /// Returns the exits of rays that start on the box and go inwards. Only planes ahead count: a slab beside which a rounded origin lies
    /// does not matter.
    #[inline(always)]
    pub(super) fn last(&self) -> Intersections<R> {
        let exit = self.exit();
        let hit = exit.earliest().greater(exit.t().of(0.0)) & !self.undecided;
        Intersections { root: exit, hit, undecided: !hit }
    }

    /// Returns the faces that rays hit at `t`, or through which they exit if they are `inside`.
    #[inline(always)]
    pub(super) fn faces(&self, t: R, inside: R::Mask) -> FaceMasks<R> {
        let ([x, y, z], [far_x, far_y, far_z]) = (self.entries, self.exits);
        let entry = or_later(or_later(x, y), z);
        let enters = !inside & t.less_or_equal(entry.latest());
        let chosen = BoundedT::pick(enters, entry, or_earlier(or_earlier(far_x, far_y), far_z));
        let mut at = self.upwards;
        for (axis, at) in at.iter_mut().enumerate() {
            *at = BoundedT::pick(enters, self.entries[axis], self.exits[axis]).may_equal(&chosen);
        }
        let rivals = (at[0] & at[1]) | (at[1] & at[2]) | (at[2] & at[0]);
        let upwards = (at[0] & self.upwards[0]) | (at[1] & self.upwards[1]) | (at[2] & self.upwards[2]);
        let upper = (enters & !upwards) | (!enters & upwards);
        FaceMasks { at, upper, certain: (at[0] | at[1] | at[2]) & !rivals & !self.undecided }
    }
}

impl<R: Real> FaceMasks<R> {
    /// Selects the number of the face's axis.
    #[inline(always)]
    pub(super) fn of_axis(&self, [x, y, z]: [R; 3]) -> R {
        R::pick(self.at[0], x, R::pick(self.at[1], y, z))
    }

    /// Selects the vector of the face's axis.
    #[inline(always)]
    pub(super) fn vector_of_axis(&self, like: R, [x, y, z]: &[DVec3; 3]) -> [R; 3] {
        pick3(self.at[0], spread(like, *x), pick3(self.at[1], spread(like, *y), spread(like, *z)))
    }
}

impl FaceMasks<f64> {
    /// Returns the masks of a certain face.
    #[inline(always)]
    pub(super) fn of(face: Face) -> Self {
        Self { at: [face.axis == 0, face.axis == 1, face.axis == 2], upper: face.upper, certain: true }
    }

    /// Returns the face, if it is certain.
    #[inline(always)]
    pub(super) fn face(&self) -> Option<Face> {
        let axis = self.at.iter().position(|at| *at)?;
        self.certain.then_some(Face { axis, upper: self.upper })
    }
}

/// Returns the root with an error bound of 0 where it is not a number: the product of an infinite `t` and an error that underflows.
#[inline(always)]
pub(super) fn or_exact<R: Real>(root: BoundedT<R>) -> BoundedT<R> {
    let (error, zero) = (root.error(), root.error().of(0.0));
    BoundedT::within(root.t(), R::pick(error.greater(zero), error, zero))
}

/// Returns the root with the larger `t`, with its own error bound.
#[inline(always)]
fn or_later<R: Real>(one: BoundedT<R>, other: BoundedT<R>) -> BoundedT<R> {
    BoundedT::pick(other.t().less(one.t()), one, other)
}

/// Returns the root with the smaller `t`, with its own error bound.
#[inline(always)]
fn or_earlier<R: Real>(one: BoundedT<R>, other: BoundedT<R>) -> BoundedT<R> {
    BoundedT::pick(other.t().less(one.t()), other, one)
}

/// One of a box's three slabs relative to a ray. `low` and `high` are the heights of its planes above the ray's origin; `speed` is the
/// direction's component across the slab. The planes are hit at t = low / speed and t = high / speed.
pub(super) struct ExactSlab {
    pub(super) low: Exact,
    pub(super) high: Exact,
    pub(super) speed: Exact,
}

impl ExactSlab {
    /// Returns the entry and the exit of the ray.
    pub(super) fn meetings(&self, axis: usize) -> [ExactHit; 2] {
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
pub(super) fn cross_exactly(slabs: &[ExactSlab; 3]) -> Option<ExactCrossing> {
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
pub(super) fn exit_exactly(slabs: &[ExactSlab; 3]) -> Option<ExactHit> {
    let moving = slabs.iter().enumerate().filter(|(_, slab)| slab.speed.sign().is_ne());
    let exits = moving.map(|(axis, slab)| {
        let [_, exit] = slab.meetings(axis);
        exit
    });
    exits.min_by(|one, other| one.t.cmp(&other.t)).map(ExactHit::ahead)
}

/// Returns the component of largest magnitude. Components within a relative 2^-40 of it count as equal, and the first of them is returned.
pub(super) fn pivot(row: Double3) -> Double {
    /// 1 - 2^-40
    const NEARLY: f64 = 1.0 - 1.0 / 1_099_511_627_776.0;
    let parts = row.to_array();
    let largest = row.rounded().abs().max_element();
    parts.into_iter().find(|part| part.rounded().abs() >= largest * NEARLY).unwrap_or(parts[0])
}
