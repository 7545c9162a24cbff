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

use std::sync::atomic::{AtomicBool, Ordering};

use fearless_simd::{f32x8, f32x16, prelude::*};
use glam::DVec3;

use super::node::{Link, Node, WIDTH};
use super::traverse::{Pending, Stack};
use super::{Tree, frame};
use crate::trace::math::{F64s, Vectors, mask, splat};
use crate::trace::rays::ShapeId;

/// 2^-20, or 16 times the unit roundoff of `f32`.
const SLACK: f64 = 1.0 / 1_048_576.0;

/// How many bundles there are within a bundle.
pub(crate) const PARTS: usize = 16;

/// The smallest and the largest slope along the two axes across the depth.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) struct Slopes {
    pub(crate) low: [f64; 2],
    pub(crate) high: [f64; 2],
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
    part_low: [[f32; PARTS]; 2],
    part_high: [[f32; PARTS]; 2],
}

/// By part: the depth up to which shapes are of interest, in the tree's frame.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Limits(pub(crate) [f32; PARTS]);

/// A box in the tree's frame: lower x, y, z, then upper x, y, z.
pub(crate) type Planes = [f32; 6];

/// What is asked of every shape that rays of a shaft may meet.
pub(crate) trait ShaftVisitor<S: Simd> {
    /// Visits a shape, with its box. Returns the depth from which on nothing is of interest any more.
    fn visit(&mut self, simd: S, id: ShapeId, bounds: &Planes) -> f32;
}

impl Slopes {
    /// Of no ray.
    pub(crate) const NONE: Self = Self { low: [f64::INFINITY; 2], high: [f64::NEG_INFINITY; 2] };

    /// Those of both.
    pub(crate) fn union(&self, other: &Self) -> Self {
        let both = |one: [f64; 2], two: [f64; 2], pick: fn(f64, f64) -> f64| {
            [pick(one[0], two[0]), pick(one[1], two[1])]
        };
        Self { low: both(self.low, other.low, f64::min), high: both(self.high, other.high, f64::max) }
    }

    fn steepest(&self) -> f64 {
        self.low.iter().chain(&self.high).fold(0.0, |steepest, slope| slope.abs().max(steepest))
    }
}

impl Depth {
    /// Measures depth along the axis in which a direction goes farthest.
    pub(crate) fn along(direction: DVec3) -> Self {
        let axis = direction.abs().max_position();
        Self { axis, upwards: direction[axis] > 0.0 }
    }

    /// Returns the slopes of rays in some lanes, at least one, along their directions times `sense`, 1 or -1. `None` where one goes
    /// the other way, or so steeply that it would make the shaft too wide.
    #[inline(always)]
    pub(crate) fn slopes_of<S: Simd>(
        self,
        simd: S,
        directions: &Vectors,
        lanes: u32,
        sense: f64,
    ) -> Option<Slopes> {
        const STEEPEST: f64 = 16.0;
        let [w, u, v] = self.axes();
        let mut lows = [splat(simd, f64::INFINITY); 2];
        let mut highs = [splat(simd, f64::NEG_INFINITY); 2];
        for half in 0..2 {
            let asked = mask(simd, lanes, half);
            let inverse = splat(simd, self.sign() * sense) / directions.axis(w).load(simd, half);
            let mut good = inverse.simd_gt(splat(simd, 0.0));
            for (side, across) in [u, v].into_iter().enumerate() {
                let slope = directions.axis(across).load(simd, half) * sense * inverse;
                good &= slope.abs().simd_le(splat(simd, STEEPEST));
                lows[side] = (asked & slope.simd_lt(lows[side])).select(slope, lows[side]);
                highs[side] = (asked & slope.simd_gt(highs[side])).select(slope, highs[side]);
            }
            if (asked & !good).any_true() {
                return None;
            }
        }
        // Not by `map`: what is passed to it is compiled without the vector instructions.
        let low = [lows[0].reduce_min(), lows[1].reduce_min()];
        let high = [highs[0].reduce_max(), highs[1].reduce_max()];
        Some(Slopes { low, high })
    }

    /// Returns the greatest depth that rays in some lanes reach by their `t`, along their directions times `sense`, 1 or -1; minus
    /// infinity of no lane.
    #[inline(always)]
    pub(crate) fn farthest<S: Simd>(
        self,
        simd: S,
        (directions, lanes, sense): (&Vectors, u32, f64),
        t: impl Fn(usize) -> F64s<S>,
    ) -> f64 {
        let nowhere = splat(simd, f64::NEG_INFINITY);
        let mut farthest = nowhere;
        for half in 0..2 {
            let speed = directions.axis(self.axis).load(simd, half) * (self.sign() * sense);
            let depth = mask(simd, lanes, half).select(t(half) * speed, nowhere);
            farthest = depth.simd_gt(farthest).select(depth, farthest);
        }
        farthest.reduce_max()
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
    /// Makes a shaft of the rays from a point that have these slopes, part by part. `None` where the point is so far from the
    /// shapes that `f32` would tell too few of them apart.
    pub(crate) fn shaft(&self, origin: DVec3, depth: Depth, parts: &[Slopes; PARTS]) -> Option<Shaft> {
        /// Of the size of all shapes together.
        const COARSEST: f64 = 1.0 / 4096.0;
        let all = parts.iter().fold(Slopes::NONE, |all, part| all.union(part));
        let origin = (origin - self.frame.origin()) * self.frame.scale();
        let slack = SLACK * (1.0 + origin.abs().max_element()) * (1.0 + all.steepest());
        if slack.is_nan() || slack > COARSEST {
            return None;
        }
        let (below, above) = (frame::below, frame::above);
        let mut shaft = Shaft {
            depth,
            origin: origin.to_array().map(frame::nearest),
            low: all.low.map(below),
            high: all.high.map(above),
            slack: above(slack),
            part_low: [[0.0; PARTS]; 2],
            part_high: [[0.0; PARTS]; 2],
        };
        for (index, part) in parts.iter().enumerate() {
            for side in 0..2 {
                shaft.part_low[side][index] = below(part.low[side]);
                shaft.part_high[side][index] = above(part.high[side]);
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
                    Link::Leaf(id) if depths[child] <= limit => {
                        limit = visitor.visit(simd, id, &node.bounds(child));
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

    /// Returns which parts' rays may meet a box before their own depths, as a bit mask.
    #[inline(always)]
    pub(crate) fn parts<S: Simd>(&self, simd: S, bounds: &Planes, limits: &Limits) -> u32 {
        let splat = f32x16::splat;
        let [w, u, v] = self.depth.axes();
        let [near, far] = self.depth.near_and_far();
        let (near, far) = (bounds[near] - self.origin[w], bounds[far] - self.origin[w]);
        let (near, far) = if self.depth.upwards { (near, far) } else { (-near, -far) };
        let near = near.max(0.0);
        let limits = f32x16::load_array_ref(simd, &limits.0);
        let mut met = splat(simd, near).simd_le(limits);
        for (side, across) in [u, v].into_iter().enumerate() {
            let (lower, upper) =
                (bounds[across] - self.origin[across], bounds[across + 3] - self.origin[across]);
            let low = f32x16::load_array_ref(simd, &self.part_low[side]);
            let high = f32x16::load_array_ref(simd, &self.part_high[side]);
            let (near, far) = (splat(simd, near), splat(simd, far));
            met &= splat(simd, lower - self.slack).simd_le((high * near).max(high * far))
                & splat(simd, upper + self.slack).simd_ge((low * near).min(low * far));
        }
        mask_bits(met.to_bitmask())
    }
}

impl Limits {
    /// Of parts where nothing is of interest.
    pub(crate) const NONE: Self = Self([f32::NEG_INFINITY; PARTS]);

    /// Returns the depth up to which shapes are of interest to any part.
    #[inline(always)]
    pub(crate) fn farthest<S: Simd>(&self, simd: S) -> f32 {
        f32x16::load_array_ref(simd, &self.0).reduce_max()
    }
}

/// Lanes as bits of a `u32`.
#[inline(always)]
#[expect(clippy::cast_possible_truncation, reason = "no more than 16 lanes")]
fn mask_bits(mask: u64) -> u32 {
    mask as u32
}
