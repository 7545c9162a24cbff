//! Slopes and end depths of the rays of many packets, by part: the data of a [shaft](super::beam::Shaft).
//!
//! A part is half a packet. Values are kept per lane until they are known for all packets. Eight packets are then reduced together, pairs
//! of lanes to one, until each part has one lane.

use fearless_simd::{f32x16, prelude::*};
use glam::DVec3;

use super::depth::Depth;
use crate::trace::math::{F64s, LANES, Numbers, Vectors, bits, bits16, mask16, splat};
use crate::trace::shapes::CompactBounds;

/// Number of packets in a bundle.
pub(crate) const PACKETS: usize = 16;

/// Number of parts in a bundle: one per half packet.
pub(crate) const PARTS: usize = PACKETS * 2;

/// Number of vectors that hold one number per part.
pub(super) const GROUPS: usize = PARTS / LANES;

/// One number per part, a vector of lanes at a time.
pub(super) type PartNumbers = [[f32; LANES]; GROUPS];

/// One number per ray.
type RayNumbers = [[f32; LANES]; PACKETS];

/// Larger than every valid number: the minimum of an empty set.
const NONE: f32 = f32::MAX;

/// The smallest and the largest slope of rays along the two axes across the depth.
#[derive(Clone, Copy, Debug)]
pub(crate) struct SlopeRange {
    pub(super) low: [f32; 2],
    pub(super) high: [f32; 2],
}

/// The slope range of each part's rays. For a part without rays, `low` exceeds `high`.
#[derive(Clone, Debug)]
pub(crate) struct Slopes {
    pub(super) low: [PartNumbers; 2],
    pub(super) high: [PartNumbers; 2],
}

/// The smallest and the greatest depth at which each part's rays end, in the tree's frame. For a part without rays, `nearest` exceeds
/// `farthest`: its range is empty.
#[derive(Clone, Debug)]
pub(crate) struct Ends {
    pub(super) nearest: PartNumbers,
    pub(super) farthest: PartNumbers,
}

/// The bounding boxes of each part's points relative to a viewpoint: the depth, and the coordinates along the two axes across it. For a
/// part without points, `low` exceeds `high`.
#[derive(Clone, Debug)]
pub(super) struct Places {
    pub(super) low: [PartNumbers; 3],
    pub(super) high: [PartNumbers; 3],
}

/// Maximum slope; steeper rays would make a frustum too wide.
pub(super) const STEEPEST: f32 = 16.0;

impl SlopeRange {
    /// Returns the slope range of a packet's rays in some lanes, at least one, along their directions times a sense of 1 or -1. `None` if a
    /// ray runs against the depth axis, or so steeply that the frustum would be too wide.
    #[inline(always)]
    pub(crate) fn of<S: Simd>(
        simd: S,
        (directions, lanes): (&Vectors, u32),
        toward: (Depth, f64),
    ) -> Option<Self> {
        let (slopes, ahead) = slopes_of(simd, directions, toward);
        let (active, none) = (mask16(simd, lanes), f32x16::splat(simd, NONE));
        let (mut range, mut good) = (Self { low: [0.0; 2], high: [0.0; 2] }, lanes & !ahead == 0);
        for (side, slope) in slopes.into_iter().enumerate() {
            let low = active.select(slope - wider(slope), none).reduce_min();
            let high = active.select(slope + wider(slope), -none).reduce_max();
            (range.low[side], range.high[side]) = (low, high);
            good &= low >= -STEEPEST && high <= STEEPEST;
        }
        good.then_some(range)
    }

    /// Returns a box around the directions of all rays with these slopes, with a component of 1 or -1 along the depth axis.
    pub(crate) fn directions(&self, depth: Depth) -> CompactBounds {
        let [along, u, v] = depth.axes();
        let mut bounds = CompactBounds::EMPTY;
        let ahead = if depth.sign() > 0.0 { 1.0 } else { -1.0 };
        (bounds.min[along], bounds.max[along]) = (ahead, ahead);
        for (side, axis) in [u, v].into_iter().enumerate() {
            (bounds.min[axis], bounds.max[axis]) = (self.low[side], self.high[side]);
        }
        bounds
    }

    pub(super) fn steepest(&self) -> f32 {
        self.low.iter().chain(&self.high).fold(0.0, |steepest, slope| slope.abs().max(steepest))
    }
}

impl Slopes {
    /// Computes the slope ranges of packets' rays in some lanes, along their directions times a sense of 1 or -1. `None` if a ray runs
    /// against the depth axis, or so steeply that a frustum would be too wide.
    #[inline(always)]
    pub(crate) fn of<'a, S: Simd>(
        simd: S,
        toward: (Depth, f64),
        packets: impl Iterator<Item = (&'a Vectors, u32)>,
    ) -> Option<Self> {
        let none = f32x16::splat(simd, NONE);
        let [mut least, mut greatest] = [[[[NONE; LANES]; PACKETS]; 2]; 2];
        let mut behind = 0;
        for (packet, (directions, lanes)) in packets.take(PACKETS).enumerate() {
            let (slopes, ahead) = slopes_of(simd, directions, toward);
            behind |= lanes & !ahead;
            let active = mask16(simd, lanes);
            for (side, slope) in slopes.into_iter().enumerate() {
                active.select(slope, none).store_array(&mut least[side][packet]);
                active.select(-slope, none).store_array(&mut greatest[side][packet]);
            }
        }
        let mut slopes = Self { low: [[[0.0; LANES]; GROUPS]; 2], high: [[[0.0; LANES]; GROUPS]; 2] };
        let (steepest, mut good) = (f32x16::splat(simd, STEEPEST), behind == 0);
        for side in 0..2 {
            for group in 0..GROUPS {
                let low = least_of_parts(simd, &least[side], group);
                let high = -least_of_parts(simd, &greatest[side], group);
                let (low, high) = (low - wider(low), high + wider(high));
                let empty = low.simd_gt(high);
                good &= (empty | (low.simd_ge(-steepest) & high.simd_le(steepest))).all_true();
                low.store_array(&mut slopes.low[side][group]);
                high.store_array(&mut slopes.high[side][group]);
            }
        }
        good.then_some(slopes)
    }

    /// Returns the union of the slope ranges of all parts.
    #[inline(always)]
    pub(super) fn range<S: Simd>(&self, simd: S) -> SlopeRange {
        let mut range = SlopeRange { low: [0.0; 2], high: [0.0; 2] };
        for side in 0..2 {
            let [low, other_low] = &self.low[side];
            let [high, other_high] = &self.high[side];
            let load = |numbers: &[f32; LANES]| f32x16::load_array_ref(simd, numbers);
            range.low[side] = load(low).min(load(other_low)).reduce_min();
            range.high[side] = load(high).max(load(other_high)).reduce_max();
        }
        range
    }
}

impl Ends {
    /// Computes the depths at which packets' rays in some lanes end, from their `t`, along their directions times `sense`, 1 or -1. `scale`
    /// is the length of a scene unit in the tree's frame.
    #[inline(always)]
    pub(crate) fn of<'a, S: Simd>(
        simd: S,
        (depth, sense): (Depth, f64),
        scale: f64,
        packets: impl Iterator<Item = (&'a Vectors, &'a Numbers, u32)>,
    ) -> Self {
        let none = f32x16::splat(simd, NONE);
        let [mut least, mut greatest] = [[[NONE; LANES]; PACKETS]; 2];
        let ahead = splat(simd, depth.sign() * sense * scale);
        for (packet, (directions, ts, lanes)) in packets.take(PACKETS).enumerate() {
            let (along, active) = (directions.axis(depth.axes()[0]), mask16(simd, lanes));
            let first = ts.load(simd, 0) * (along.load(simd, 0) * ahead);
            let second = ts.load(simd, 1) * (along.load(simd, 1) * ahead);
            let depths = first.narrow(second);
            active.select(depths, none).store_array(&mut least[packet]);
            active.select(-depths, none).store_array(&mut greatest[packet]);
        }
        let mut ends = Self { nearest: [[0.0; LANES]; GROUPS], farthest: [[0.0; LANES]; GROUPS] };
        for group in 0..GROUPS {
            let nearest = least_of_parts(simd, &least, group);
            let farthest = -least_of_parts(simd, &greatest, group);
            (nearest - wider(nearest)).store_array(&mut ends.nearest[group]);
            (farthest + wider(farthest)).store_array(&mut ends.farthest[group]);
        }
        ends
    }

    /// Returns the greatest depth of all parts.
    pub(crate) fn deepest(&self) -> f32 {
        self.farthest.as_flattened().iter().fold(f32::NEG_INFINITY, |deepest, depth| depth.max(deepest))
    }
}

impl Places {
    /// Computes the bounding boxes, in the tree's frame, of packets' points in some lanes as seen from `from`. `scale` is the length of a
    /// scene unit in that frame. `None` if a coordinate is outside the range of `f32`.
    #[inline(always)]
    pub(super) fn of<'a, S: Simd>(
        simd: S,
        (from, scale): (DVec3, f64),
        depth: Depth,
        packets: impl Iterator<Item = (&'a Vectors, u32)>,
    ) -> Option<Self> {
        let mut nowhere = 0;
        let none = f32x16::splat(simd, NONE);
        let [mut least, mut greatest] = [[[[NONE; LANES]; PACKETS]; 3]; 2];
        for (packet, (points, lanes)) in packets.take(PACKETS).enumerate() {
            let active = mask16(simd, lanes);
            for (side, axis) in depth.axes().into_iter().enumerate() {
                let unit = if side == 0 { depth.sign() * scale } else { scale };
                let (points, from) = (points.axis(axis), from[axis]);
                let first = (points.load(simd, 0) - from) * unit;
                let second = (points.load(simd, 1) - from) * unit;
                let places = first.narrow(second);
                nowhere |= lanes & !bits16(places.abs().simd_lt(none));
                active.select(places, none).store_array(&mut least[side][packet]);
                active.select(-places, none).store_array(&mut greatest[side][packet]);
            }
        }
        let mut places = Self { low: [[[0.0; LANES]; GROUPS]; 3], high: [[[0.0; LANES]; GROUPS]; 3] };
        for side in 0..3 {
            for group in 0..GROUPS {
                let low = least_of_parts(simd, &least[side], group);
                let high = -least_of_parts(simd, &greatest[side], group);
                (low - wider(low)).store_array(&mut places.low[side][group]);
                (high + wider(high)).store_array(&mut places.high[side][group]);
            }
        }
        (nowhere == 0).then_some(places)
    }

    /// Returns the depth of the deepest point.
    #[inline(always)]
    pub(super) fn deepest<S: Simd>(&self, simd: S) -> f32 {
        greatest(simd, &self.high[0])
    }

    /// Returns the slope range of rays to all points. `None` unless every point is deeper than twice `near` and no ray is too steep.
    #[inline(always)]
    pub(super) fn slopes<S: Simd>(&self, simd: S, near: f32) -> Option<SlopeRange> {
        let (nearest, farthest) = (least(simd, &self.low[0]), self.deepest(simd));
        let mut range = SlopeRange { low: [0.0; 2], high: [0.0; 2] };
        let steeper = |rise: f32| {
            let slope = rise / if rise > 0.0 { nearest } else { farthest };
            slope + 2.0 * slope.abs() * f32::EPSILON
        };
        for side in 0..2 {
            range.low[side] = -steeper(-least(simd, &self.low[side + 1]));
            range.high[side] = steeper(greatest(simd, &self.high[side + 1]));
        }
        (nearest > 2.0 * near && range.steepest() <= STEEPEST).then_some(range)
    }
}

/// Returns the minimum over all parts.
#[inline(always)]
fn least<S: Simd>(simd: S, [first, second]: &PartNumbers) -> f32 {
    f32x16::load_array_ref(simd, first).min(f32x16::load_array_ref(simd, second)).reduce_min()
}

/// Returns the maximum over all parts.
#[inline(always)]
fn greatest<S: Simd>(simd: S, [first, second]: &PartNumbers) -> f32 {
    f32x16::load_array_ref(simd, first).max(f32x16::load_array_ref(simd, second)).reduce_max()
}

/// Returns the slopes of a packet's rays along the two axes across the depth, rounded, and the lanes whose rays run forwards.
#[inline(always)]
fn slopes_of<S: Simd>(simd: S, directions: &Vectors, (depth, sense): (Depth, f64)) -> ([f32x16<S>; 2], u32) {
    let [w, u, v] = depth.axes();
    let (along, sign) = (directions.axis(w), splat(simd, depth.sign()));
    // The opposite direction has the same slopes.
    let inverses = [sign / along.load(simd, 0), sign / along.load(simd, 1)];
    let mut ahead = 0;
    for (half, inverse) in inverses.into_iter().enumerate() {
        let forwards = inverse * sense;
        let finite = forwards.simd_lt(splat(simd, f64::INFINITY));
        ahead |= bits(forwards.simd_gt(splat(simd, 0.0)) & finite, half);
    }
    let (u, v) = (directions.axis(u), directions.axis(v));
    ([times(simd, u, inverses), times(simd, v, inverses)], ahead)
}

#[inline(always)]
fn times<S: Simd>(simd: S, numbers: &Numbers, [first, second]: [F64s<S>; 2]) -> f32x16<S> {
    (numbers.load(simd, 0) * first).narrow(numbers.load(simd, 1) * second)
}

/// Returns the minimum of each part of eight packets.
#[inline(always)]
fn least_of_parts<S: Simd>(simd: S, rows: &RayNumbers, group: usize) -> f32x16<S> {
    const ROWS: usize = PACKETS / GROUPS;
    let mut least = [f32x16::splat(simd, 0.0); ROWS];
    for (least, row) in least.iter_mut().zip(&rows[group % GROUPS * ROWS..][..ROWS]) {
        *least = f32x16::load_array_ref(simd, row);
    }
    let [a, b, c, d, e, f, g, h] = least;
    let quarters = [least_of_pairs(a, b), least_of_pairs(c, d), least_of_pairs(e, f), least_of_pairs(g, h)];
    let [ab, cd, ef, gh] = quarters;
    least_of_pairs(least_of_pairs(ab, cd), least_of_pairs(ef, gh))
}

/// Returns the minima of adjacent lanes, first those in `first`, then those in `second`.
#[inline(always)]
fn least_of_pairs<S: Simd>(first: f32x16<S>, second: f32x16<S>) -> f32x16<S> {
    first.unzip_low(second).min(first.unzip_high(second))
}

/// Returns a margin that exceeds the error of rounding to `f32`.
#[inline(always)]
pub(super) fn wider<S: Simd>(number: f32x16<S>) -> f32x16<S> {
    /// Twice the unit roundoff.
    const WIDER: f32 = f32::EPSILON;
    number.abs() * WIDER + f32::MIN_POSITIVE
}
