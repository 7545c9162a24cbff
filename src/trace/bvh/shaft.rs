//! Bundles of rays with a common origin against boxes.
//!
//! Let w be the axis along which the rays go farthest. At depth s along it, s >= 0, a ray of direction d is at u = s d_u /
//! |d_w| and v = s d_v / |d_w| across it, from the origin. So all rays stay between the smallest and the largest of these
//! slopes, and a box can be met only if it has a point with low s <= u <= high s, and likewise along v, at some depth s that is
//! its own.
//!
//! # What rounding may do
//!
//! Everything is in the tree's frame, in which boxes lie within -1..=1, and is computed in `f32`, with a unit roundoff e of
//! 2^-24. Let E be the largest coordinate of the origin, and S the largest slope. Against exact arithmetic,
//!
//! - the origin is off by at most e E,
//! - a difference of a box's plane and the origin by e (1 + E) more, and so is a depth,
//! - a product of depth and slope by 3 e (1 + E) S, slopes being rounded outwards,
//! - the last sum by e (1 + E)(1 + S).
//!
//! That is less than 6 e (1 + E)(1 + S) in all. Boxes are accepted that are missed by 16 e (1 + E)(1 + S): what is left is for
//! shapes that by their own rounding accept rays which pass them (see [`Frame::ray`](frame::Frame::ray)), and for the rounding
//! of directions.
//!
//! A sphere of radius r is beyond the slope h if for its centre u - h w > r sqrt(1 + h^2). It touches the sides of its box, which are
//! rounded outwards, by less than 3 e: their middle is off from its centre by less than 4 e, and half their distance is at most e
//! less than its radius. That makes less than 5 e (1 + S), the product of radius and root is rounded by less than 3 e (1 + S), and
//! the rest is as with boxes: less than 14 e (1 + E)(1 + S) in all, and of a sphere's own rounding there is next to nothing.

use std::sync::atomic::{AtomicBool, Ordering};

use fearless_simd::{f32x8, f32x16, mask32x16, prelude::*};
use glam::DVec3;

use super::node::{LeafId, Link, Node, WIDTH};
use super::traverse::{Pending, Stack};
use super::{Tree, frame};
use crate::trace::math::{F64s, LANES, Numbers, Vectors, mask, splat};

/// 2^-20, or 16 times the unit roundoff of `f32`.
const SLACK: f64 = 1.0 / 1_048_576.0;

/// How many bundles there are within a bundle.
pub(crate) const PARTS: usize = 32;

/// A number of every part, as many at a time as a vector has lanes.
type PartNumbers = [[f32; LANES]; PARTS / LANES];

/// The smallest and the largest slope of each part's rays along the two axes across the depth.
#[derive(Clone, Debug)]
pub(crate) struct Slopes {
    low: [[Numbers; PARTS / LANES]; 2],
    high: [[Numbers; PARTS / LANES]; 2],
    /// Of all parts.
    lowest: [f64; 2],
    highest: [f64; 2],
}

/// The axis that depth is measured along, and to which side.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) struct Depth {
    axis: usize,
    upwards: bool,
}

/// A bundle of rays with a common origin, and [`PARTS`] bundles that it consists of.
#[derive(Clone, Debug)]
pub(crate) struct Shaft {
    depth: Depth,
    origin: [f32; 3],
    low: [f32; 2],
    high: [f32; 2],
    slack: f32,
    /// Of the parts, likewise.
    part_low: [PartNumbers; 2],
    part_high: [PartNumbers; 2],
    /// sqrt(1 + h^2) of each of those slopes.
    part_low_root: [PartNumbers; 2],
    part_high_root: [PartNumbers; 2],
}

/// By part: the depth up to which shapes are of interest, in the tree's frame.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Limits(PartNumbers);

/// The box of a shape in the tree's frame.
#[derive(Clone, Copy, Debug)]
pub(crate) struct LeafBox {
    /// Lower x, y, z, then upper x, y, z.
    planes: [f32; 6],
    /// Whether it is a sphere that touches all sides.
    round: bool,
}

/// What is asked of every shape that rays of a shaft may meet.
pub(crate) trait ShaftVisitor<S: Simd> {
    /// Visits a shape, with its box. Returns the depth from which on nothing is of interest any more.
    fn visit(&mut self, simd: S, leaf: LeafId, bounds: &LeafBox) -> f32;
}

impl Slopes {
    /// Of no ray.
    pub(crate) const NONE: Self = Self {
        low: [[Numbers::splat(0.0); PARTS / LANES]; 2],
        high: [[Numbers::splat(0.0); PARTS / LANES]; 2],
        lowest: [f64::INFINITY; 2],
        highest: [f64::NEG_INFINITY; 2],
    };

    /// Takes those of a part's rays: of half of a packet in some lanes, at least one, along their directions times `sense`, 1 or -1, with depth
    /// along an axis. `false` where one goes the other way, or so steeply that it would make the shaft too wide.
    #[inline(always)]
    pub(crate) fn set<S: Simd>(
        &mut self,
        simd: S,
        part: usize,
        (directions, lanes, half): (&Vectors, u32, usize),
        (depth, sense): (Depth, f64),
    ) -> bool {
        const STEEPEST: f64 = 16.0;
        let [w, u, v] = depth.axes();
        let asked = mask(simd, lanes, half);
        // Turned round, a direction has the same slopes.
        let inverse = splat(simd, depth.sign()) / directions.axis(w).load(simd, half);
        let forwards = inverse * sense;
        let ahead = forwards.simd_gt(splat(simd, 0.0)) & forwards.simd_lt(splat(simd, f64::INFINITY));
        let (group, lane) = (part / LANES % (PARTS / LANES), part % LANES);
        let mut good = true;
        for (side, across) in [u, v].into_iter().enumerate() {
            let slope = directions.axis(across).load(simd, half) * inverse;
            let low = asked.select(slope, splat(simd, f64::INFINITY)).reduce_min();
            let high = asked.select(slope, splat(simd, f64::NEG_INFINITY)).reduce_max();
            self.low[side][group].set(lane, low);
            self.high[side][group].set(lane, high);
            self.lowest[side] = self.lowest[side].min(low);
            self.highest[side] = self.highest[side].max(high);
            good &= low >= -STEEPEST && high <= STEEPEST;
        }
        good && !(asked & !ahead).any_true()
    }

    fn steepest(&self) -> f64 {
        self.lowest.iter().chain(&self.highest).fold(0.0, |steepest, slope| slope.abs().max(steepest))
    }
}

impl Depth {
    /// Measures depth along the axis in which a direction goes farthest.
    pub(crate) fn along(direction: DVec3) -> Self {
        let axis = direction.abs().max_position();
        Self { axis, upwards: direction[axis] > 0.0 }
    }

    /// Returns the greatest depth that half of a packet's rays in some lanes reach by their `t`, along their directions times `sense`,
    /// 1 or -1; minus infinity of no lane.
    #[inline(always)]
    pub(crate) fn farthest<S: Simd>(
        self,
        simd: S,
        (directions, lanes, half): (&Vectors, u32, usize),
        (t, sense): (F64s<S>, f64),
    ) -> f64 {
        let speed = directions.axis(self.axis).load(simd, half) * (self.sign() * sense);
        mask(simd, lanes, half).select(t * speed, splat(simd, f64::NEG_INFINITY)).reduce_max()
    }

    fn sign(self) -> f64 {
        if self.upwards { 1.0 } else { -1.0 }
    }

    /// The axis itself, and those across.
    #[inline(always)]
    fn axes(self) -> [usize; 3] {
        [self.axis, (self.axis + 1) % 3, (self.axis + 2) % 3]
    }

    /// Returns where the box's nearer and its farther plane are in [`Planes`].
    #[inline(always)]
    fn near_and_far(self) -> [usize; 2] {
        if self.upwards { [self.axis, self.axis + 3] } else { [self.axis + 3, self.axis] }
    }
}

impl Tree {
    /// Makes a shaft of the rays from a point that have these slopes. `None` where the point is so far from the shapes that `f32`
    /// would tell too few of them apart.
    #[inline(always)]
    pub(crate) fn shaft<S: Simd>(
        &self,
        simd: S,
        origin: DVec3,
        depth: Depth,
        slopes: &Slopes,
    ) -> Option<Shaft> {
        /// Of the size of all shapes together.
        const COARSEST: f64 = 1.0 / 4096.0;
        let origin = (origin - self.frame.origin()) * self.frame.scale();
        let slack = SLACK * (1.0 + origin.abs().max_element()) * (1.0 + slopes.steepest());
        if slack.is_nan() || slack > COARSEST {
            return None;
        }
        let mut shaft = Shaft {
            depth,
            origin: origin.to_array().map(frame::nearest),
            low: slopes.lowest.map(frame::below),
            high: slopes.highest.map(frame::above),
            slack: frame::above(slack),
            part_low: [NO_NUMBERS; 2],
            part_high: [NO_NUMBERS; 2],
            part_low_root: [NO_NUMBERS; 2],
            part_high_root: [NO_NUMBERS; 2],
        };
        for side in 0..2 {
            for group in 0..PARTS / LANES {
                let low = slopes.low[side][group].rounded(simd);
                let high = slopes.high[side][group].rounded(simd);
                let (low, high) = (low - widened(low), high + widened(high));
                low.store_array(&mut shaft.part_low[side][group]);
                high.store_array(&mut shaft.part_high[side][group]);
                (low * low + 1.0).sqrt().store_array(&mut shaft.part_low_root[side][group]);
                (high * high + 1.0).sqrt().store_array(&mut shaft.part_high_root[side][group]);
            }
        }
        Some(shaft)
    }

    /// How long a unit of the scene is in the tree's frame, a power of two.
    pub(crate) fn scale(&self) -> f64 {
        self.frame.scale()
    }

    /// Visits every shape that rays of a shaft may meet, nearer nodes first. Once `cancelled` is true the rest is left out.
    #[inline(always)]
    pub(crate) fn visit_shaft<S: Simd>(
        &self,
        simd: S,
        shaft: &Shaft,
        mut limit: f32,
        stack: &mut Stack,
        cancelled: &AtomicBool,
        visitor: &mut impl ShaftVisitor<S>,
    ) {
        let stack = stack.cleared();
        let Some(mut node) = self.nodes.first() else { return };
        loop {
            let (mut mask, depths) = shaft.meets(simd, node, limit);
            let depths = *depths.as_array();
            let base = stack.len();
            while mask != 0 {
                let child = mask.trailing_zeros() as usize % WIDTH;
                mask &= mask - 1;
                match node.children[child].read() {
                    Link::Node(_) => stack.push(Pending::new(node.children[child], depths[child])),
                    Link::Leaf(_) if cancelled.load(Ordering::Relaxed) => return,
                    Link::Leaf(leaf) if depths[child] <= limit => {
                        let bounds = LeafBox { planes: node.bounds(child), round: node.is_round(child) };
                        limit = visitor.visit(simd, leaf, &bounds);
                    }
                    Link::Leaf(_) => {}
                }
            }
            super::traverse::farther_first(&mut stack[base..]);
            loop {
                let Some(next) = stack.pop() else { return };
                if next.entry() <= limit
                    && let Link::Node(index) = next.child().read()
                {
                    node = &self.nodes[index];
                    break;
                }
            }
        }
    }
}

impl Shaft {
    /// Returns the depth up to which boxes are of interest where a hit is at this depth at the latest.
    #[inline]
    pub(crate) fn depth_limit(&self, latest: f64) -> f32 {
        frame::above(latest + f64::from(self.slack))
    }

    /// Returns which of a node's children rays of the shaft may meet before a depth, as a bit mask, and from which depth on, 0
    /// or more.
    #[inline(always)]
    fn meets<S: Simd>(&self, simd: S, node: &Node, limit: f32) -> (u32, f32x8<S>) {
        let splat = f32x8::splat;
        let [w, u, v] = self.depth.axes();
        let [near, far] = self.depth.near_and_far();
        let slack = splat(simd, self.slack);
        let origin = splat(simd, self.origin[w]);
        let (near, far) = (node.plane(simd, near), node.plane(simd, far));
        let (near, far) =
            if self.depth.upwards { (near - origin, far - origin) } else { (origin - near, origin - far) };
        let near = near.max(splat(simd, 0.0));
        let mut met = far.simd_ge(-slack) & near.simd_le(splat(simd, limit));
        for (side, across) in [u, v].into_iter().enumerate() {
            let origin = splat(simd, self.origin[across]);
            let (lower, upper) = (node.plane(simd, across) - origin, node.plane(simd, across + 3) - origin);
            let (low, high) = (splat(simd, self.low[side]), splat(simd, self.high[side]));
            met &= lower.simd_le((high * near).max(high * far) + slack)
                & upper.simd_ge((low * near).min(low * far) - slack);
        }
        (node.used() & mask_bits(met.to_bitmask()), near)
    }

    /// Returns which parts' rays may meet a shape before their own depths, as a bit mask.
    #[inline(always)]
    pub(crate) fn parts<S: Simd>(&self, simd: S, bounds: &LeafBox, limits: &Limits) -> u32 {
        let mut parts = 0;
        for group in 0..PARTS / LANES {
            let met = if bounds.round {
                self.sphere_parts(simd, &bounds.planes, limits, group)
            } else {
                self.box_parts(simd, &bounds.planes, limits, group)
            };
            parts |= mask_bits(met.to_bitmask()) << (group * LANES);
        }
        parts
    }

    #[inline(always)]
    fn box_parts<S: Simd>(&self, simd: S, planes: &[f32; 6], limits: &Limits, group: usize) -> mask32x16<S> {
        let splat = f32x16::splat;
        let [w, u, v] = self.depth.axes();
        let [near, far] = self.depth.near_and_far();
        let (near, far) = (planes[near] - self.origin[w], planes[far] - self.origin[w]);
        let (near, far) = if self.depth.upwards { (near, far) } else { (-near, -far) };
        let near = near.max(0.0);
        let mut met = splat(simd, near).simd_le(f32x16::load_array_ref(simd, &limits.0[group]));
        for (side, across) in [u, v].into_iter().enumerate() {
            let (lower, upper) =
                (planes[across] - self.origin[across], planes[across + 3] - self.origin[across]);
            let low = f32x16::load_array_ref(simd, &self.part_low[side][group]);
            let high = f32x16::load_array_ref(simd, &self.part_high[side][group]);
            let (near, far) = (splat(simd, near), splat(simd, far));
            met &= splat(simd, lower - self.slack).simd_le((high * near).max(high * far))
                & splat(simd, upper + self.slack).simd_ge((low * near).min(low * far));
        }
        met
    }

    #[inline(always)]
    fn sphere_parts<S: Simd>(
        &self,
        simd: S,
        planes: &[f32; 6],
        limits: &Limits,
        group: usize,
    ) -> mask32x16<S> {
        let splat = f32x16::splat;
        let load = |numbers: &PartNumbers| f32x16::load_array_ref(simd, &numbers[group]);
        let [w, u, v] = self.depth.axes();
        let (center, radius) = ball(planes);
        let depth = center[w] - self.origin[w];
        let depth = if self.depth.upwards { depth } else { -depth };
        let mut met = splat(simd, depth - radius - self.slack).simd_le(load(&limits.0));
        let (depth, radius) = (splat(simd, depth), splat(simd, radius));
        for (side, across) in [u, v].into_iter().enumerate() {
            let beside = center[across] - self.origin[across];
            let (lower, upper) = (splat(simd, beside - self.slack), splat(simd, beside + self.slack));
            let high = load(&self.part_high[side]) * depth + load(&self.part_high_root[side]) * radius;
            let low = load(&self.part_low[side]) * depth - load(&self.part_low_root[side]) * radius;
            met &= lower.simd_le(high) & upper.simd_ge(low);
        }
        met
    }
}

impl Limits {
    /// Of parts where nothing is of interest.
    pub(crate) const NONE: Self = Self([[f32::NEG_INFINITY; LANES]; PARTS / LANES]);

    /// Lets shapes be of interest to a part up to this depth.
    #[inline(always)]
    pub(crate) fn set(&mut self, part: usize, depth: f32) {
        self.0[part / LANES % (PARTS / LANES)][part % LANES] = depth;
    }

    /// Returns the depth up to which shapes are of interest to any part.
    #[inline(always)]
    pub(crate) fn farthest<S: Simd>(&self, simd: S) -> f32 {
        let [first, second] = &self.0;
        f32x16::load_array_ref(simd, first).max(f32x16::load_array_ref(simd, second)).reduce_max()
    }
}

/// The centre and the radius of the sphere that touches the sides of a box.
#[inline(always)]
fn ball([x, y, z, upper_x, upper_y, upper_z]: &[f32; 6]) -> ([f32; 3], f32) {
    let middle = |lower: f32, upper: f32| (lower + upper) * 0.5;
    let center = [middle(*x, *upper_x), middle(*y, *upper_y), middle(*z, *upper_z)];
    (center, (upper_x - x).max(upper_y - y).max(upper_z - z) * 0.5)
}

/// More than rounding a slope to `f32` takes away.
#[inline(always)]
fn widened<S: Simd>(slope: f32x16<S>) -> f32x16<S> {
    /// Two units in the last place.
    const WIDER: f32 = f32::EPSILON;
    slope.abs() * WIDER + f32::MIN_POSITIVE
}

/// Of no part.
const NO_NUMBERS: PartNumbers = [[0.0; LANES]; PARTS / LANES];

/// Lanes as bits of a `u32`.
#[inline(always)]
#[expect(clippy::cast_possible_truncation, reason = "no more than 16 lanes")]
fn mask_bits(mask: u64) -> u32 {
    mask as u32
}
