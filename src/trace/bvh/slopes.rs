//! Slopes of the rays of many packets, and how deep those go, part by part: what a [shaft](super::shaft) is made of.
//!
//! A part is half a packet. What is known of every lane is kept until it is known of all packets: eight of them are reduced together,
//! pairs of lanes to one, until each part has one lane.

use fearless_simd::{f32x16, prelude::*};
use glam::DVec3;

use super::depth::Depth;
use crate::trace::math::{F64s, LANES, Numbers, Vectors, bits, bits16, mask16, splat};

/// How many packets a bundle has.
pub(crate) const PACKETS: usize = 16;

/// How many bundles there are within a bundle: one of each half of a packet.
pub(crate) const PARTS: usize = PACKETS * 2;

/// How many vectors the numbers of all parts are.
pub(super) const GROUPS: usize = PARTS / LANES;

/// A number of every part, as many at a time as a vector has lanes.
pub(super) type PartNumbers = [[f32; LANES]; GROUPS];

/// A number of every ray.
type RayNumbers = [[f32; LANES]; PACKETS];

/// More than any number that counts: the least of none.
const NONE: f32 = f32::MAX;

/// The smallest and the largest slope of rays along the two axes across the depth.
#[derive(Clone, Copy, Debug)]
pub(crate) struct SlopeRange {
    pub(super) low: [f32; 2],
    pub(super) high: [f32; 2],
}

/// Those of each part's rays. Of a part without rays the smallest is larger than the largest.
#[derive(Clone, Debug)]
pub(crate) struct Slopes {
    pub(super) low: [PartNumbers; 2],
    pub(super) high: [PartNumbers; 2],
}

/// The smallest and the greatest depths at which each part's rays end, in the tree's frame. Of a part without rays the smallest is
/// larger than the greatest, which is nowhere.
#[derive(Clone, Debug)]
pub(crate) struct Ends {
    pub(super) nearest: PartNumbers,
    pub(super) farthest: PartNumbers,
}

/// Within which boxes the points of each part are, as seen from a place: how deep, and where along the two axes across. Of a part without
/// points the lower ends are above the upper ones.
#[derive(Clone, Debug)]
pub(super) struct Places {
    pub(super) low: [PartNumbers; 3],
    pub(super) high: [PartNumbers; 3],
}

/// Steeper rays would make a frustum too wide.
pub(super) const STEEPEST: f32 = 16.0;

impl SlopeRange {
    /// Returns that of a packet's rays in some lanes, at least one, along their directions times `sense`, 1 or -1, with depth along
    /// an axis. `None` where one goes the other way, or so steeply that it would make the frustum too wide.
    #[inline(always)]
    pub(crate) fn of<S: Simd>(
        simd: S,
        (directions, lanes): (&Vectors, u32),
        toward: (Depth, f64),
    ) -> Option<Self> {
        let (slopes, ahead) = slopes_of(simd, directions, toward);
        let (asked, none) = (mask16(simd, lanes), f32x16::splat(simd, NONE));
        let (mut range, mut good) = (Self { low: [0.0; 2], high: [0.0; 2] }, lanes & !ahead == 0);
        for (side, slope) in slopes.into_iter().enumerate() {
            let low = asked.select(slope - wider(slope), none).reduce_min();
            let high = asked.select(slope + wider(slope), -none).reduce_max();
            (range.low[side], range.high[side]) = (low, high);
            good &= low >= -STEEPEST && high <= STEEPEST;
        }
        good.then_some(range)
    }

    pub(super) fn steepest(&self) -> f32 {
        self.low.iter().chain(&self.high).fold(0.0, |steepest, slope| slope.abs().max(steepest))
    }
}

impl Slopes {
    /// Finds those of packets' rays in some lanes, along their directions times `sense`, 1 or -1, with depth along an axis. `None` where
    /// one goes the other way, or so steeply that it would make a frustum too wide.
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
            let asked = mask16(simd, lanes);
            for (side, slope) in slopes.into_iter().enumerate() {
                asked.select(slope, none).store_array(&mut least[side][packet]);
                asked.select(-slope, none).store_array(&mut greatest[side][packet]);
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

    /// Returns the range of all parts.
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
    /// Finds those of packets' rays in some lanes, by their `t`, along their directions times `sense`, 1 or -1. `scale` is the length of
    /// a unit of the scene.
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
            let (along, asked) = (directions.axis(depth.axes()[0]), mask16(simd, lanes));
            let first = ts.load(simd, 0) * (along.load(simd, 0) * ahead);
            let second = ts.load(simd, 1) * (along.load(simd, 1) * ahead);
            let depths = first.narrow(second);
            asked.select(depths, none).store_array(&mut least[packet]);
            asked.select(-depths, none).store_array(&mut greatest[packet]);
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

    /// Returns the greatest depth of all.
    pub(crate) fn deepest(&self) -> f32 {
        self.farthest.as_flattened().iter().fold(f32::NEG_INFINITY, |deepest, depth| depth.max(deepest))
    }
}

impl Places {
    /// Finds those of packets' points in some lanes, in the tree's frame, in which a unit of the scene is so long. `None` where one is
    /// nowhere.
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
            let asked = mask16(simd, lanes);
            for (side, axis) in depth.axes().into_iter().enumerate() {
                let unit = if side == 0 { depth.sign() * scale } else { scale };
                let (points, from) = (points.axis(axis), from[axis]);
                let first = (points.load(simd, 0) - from) * unit;
                let second = (points.load(simd, 1) - from) * unit;
                let places = first.narrow(second);
                nowhere |= lanes & !bits16(places.abs().simd_lt(none));
                asked.select(places, none).store_array(&mut least[side][packet]);
                asked.select(-places, none).store_array(&mut greatest[side][packet]);
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

    /// Returns how deep the deepest of them is.
    #[inline(always)]
    pub(super) fn deepest<S: Simd>(&self, simd: S) -> f32 {
        greatest(simd, &self.high[0])
    }

    /// Returns the slopes of rays to all of them. `None` where one is not farther away than twice so far, or rays would be too steep.
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

/// Returns the least number of any part.
#[inline(always)]
fn least<S: Simd>(simd: S, [first, second]: &PartNumbers) -> f32 {
    f32x16::load_array_ref(simd, first).min(f32x16::load_array_ref(simd, second)).reduce_min()
}

/// Returns the greatest number of any part.
#[inline(always)]
fn greatest<S: Simd>(simd: S, [first, second]: &PartNumbers) -> f32 {
    f32x16::load_array_ref(simd, first).max(f32x16::load_array_ref(simd, second)).reduce_max()
}

/// Returns the slopes of a packet's rays along the two axes across the depth, rounded, and the lanes of those that go ahead.
#[inline(always)]
fn slopes_of<S: Simd>(simd: S, directions: &Vectors, (depth, sense): (Depth, f64)) -> ([f32x16<S>; 2], u32) {
    let [w, u, v] = depth.axes();
    let (along, sign) = (directions.axis(w), splat(simd, depth.sign()));
    // Turned round, a direction has the same slopes.
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

/// Returns the least number of each part of eight packets.
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

/// Returns the lesser numbers of neighbouring lanes, those of the first vector before those of the second.
#[inline(always)]
fn least_of_pairs<S: Simd>(first: f32x16<S>, second: f32x16<S>) -> f32x16<S> {
    first.unzip_low(second).min(first.unzip_high(second))
}

/// More than rounding to `f32` takes away.
#[inline(always)]
pub(super) fn wider<S: Simd>(number: f32x16<S>) -> f32x16<S> {
    /// Two units in the last place.
    const WIDER: f32 = f32::EPSILON;
    number.abs() * WIDER + f32::MIN_POSITIVE
}
