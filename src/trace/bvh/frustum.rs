//! Frusta, within which rays with a common origin stay, against boxes.
//!
//! Let w be the axis along which one of the rays goes farthest. At depth s along it, s >= 0, a ray of direction d is at u = s d_u /
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
//! Rays that end at the origin instead, and start at a depth D, are directed to it by a rounded difference: they pass it by up to
//! 2^-52 D (1 + S). For those D must be at most [`FARTHEST`], where that is e (1 + S).

use std::sync::atomic::{AtomicBool, Ordering};

use fearless_simd::{f32x8, prelude::*};
use glam::DVec3;

use super::node::{LeafId, Link, Node, WIDTH};
use super::traverse::{Pending, Stack};
use super::{Tree, frame};
use crate::trace::math::{F64s, Vectors, bits8, mask, splat};

/// 2^-20, or 16 times the unit roundoff of `f32`.
const SLACK: f64 = 1.0 / 1_048_576.0;

/// 2^28, in the tree's frame: from farther away no frustum is made of rays that end at its origin.
pub(crate) const FARTHEST: f64 = 268_435_456.0;

/// The axis that depth is measured along, and to which side.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) struct Depth {
    axis: usize,
    pub(super) upwards: bool,
}

/// The smallest and the largest slope of rays along the two axes across the depth.
#[derive(Clone, Copy, Debug)]
pub(crate) struct SlopeRange {
    pub(super) low: [f64; 2],
    pub(super) high: [f64; 2],
}

/// What rays with a common origin and slopes in a range stay within, in the tree's frame.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Frustum {
    pub(super) depth: Depth,
    pub(super) origin: [f32; 3],
    low: [f32; 2],
    high: [f32; 2],
    pub(super) slack: f32,
}

/// The box of a shape in the tree's frame.
#[derive(Clone, Copy, Debug)]
pub(crate) struct LeafBox {
    /// Lower x, y, z, then upper x, y, z.
    pub(super) planes: [f32; 6],
    /// Whether it is a sphere that touches all sides.
    pub(super) round: bool,
}

/// What is asked of every shape that rays in a frustum may meet.
pub(crate) trait FrustumVisitor<S: Simd> {
    /// Visits a shape, with its box. Returns the depth from which on nothing is of interest any more.
    fn visit(&mut self, simd: S, leaf: LeafId, bounds: &LeafBox) -> f32;
}

impl SlopeRange {
    /// Of no ray.
    pub(crate) const NONE: Self = Self { low: [f64::INFINITY; 2], high: [f64::NEG_INFINITY; 2] };

    /// Returns that of half of a packet's rays in some lanes, at least one, along their directions times `sense`, 1 or -1, with depth
    /// along an axis. `None` where one goes the other way, or so steeply that it would make the frustum too wide.
    #[inline(always)]
    pub(crate) fn of<S: Simd>(
        simd: S,
        (directions, lanes, half): (&Vectors, u32, usize),
        (depth, sense): (Depth, f64),
    ) -> Option<Self> {
        const STEEPEST: f64 = 16.0;
        let [w, u, v] = depth.axes();
        let asked = mask(simd, lanes, half);
        // Turned round, a direction has the same slopes.
        let inverse = splat(simd, depth.sign()) / directions.axis(w).load(simd, half);
        let forwards = inverse * sense;
        let ahead = forwards.simd_gt(splat(simd, 0.0)) & forwards.simd_lt(splat(simd, f64::INFINITY));
        let (mut range, mut good) = (Self::NONE, true);
        for (side, across) in [u, v].into_iter().enumerate() {
            let slope = directions.axis(across).load(simd, half) * inverse;
            let low = asked.select(slope, splat(simd, f64::INFINITY)).reduce_min();
            let high = asked.select(slope, splat(simd, f64::NEG_INFINITY)).reduce_max();
            (range.low[side], range.high[side]) = (low, high);
            good &= low >= -STEEPEST && high <= STEEPEST;
        }
        (good && !(asked & !ahead).any_true()).then_some(range)
    }

    /// Makes room for another one.
    #[inline(always)]
    pub(crate) fn include(&mut self, other: &Self) {
        for side in 0..2 {
            self.low[side] = self.low[side].min(other.low[side]);
            self.high[side] = self.high[side].max(other.high[side]);
        }
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

    pub(super) fn sign(self) -> f64 {
        if self.upwards { 1.0 } else { -1.0 }
    }

    /// The axis itself, and those across.
    #[inline(always)]
    pub(super) fn axes(self) -> [usize; 3] {
        [self.axis, (self.axis + 1) % 3, (self.axis + 2) % 3]
    }

    /// Returns where the box's nearer and its farther plane are in [`LeafBox`].
    #[inline(always)]
    pub(super) fn near_and_far(self) -> [usize; 2] {
        if self.upwards { [self.axis, self.axis + 3] } else { [self.axis + 3, self.axis] }
    }
}

impl Tree {
    /// Makes the frustum of the rays from a point that have these slopes. `None` where the point is so far from the shapes that `f32`
    /// would tell too few of them apart.
    #[inline(always)]
    pub(crate) fn frustum(&self, origin: DVec3, depth: Depth, slopes: &SlopeRange) -> Option<Frustum> {
        /// Of the size of all shapes together.
        const COARSEST: f64 = 1.0 / 4096.0;
        let origin = (origin - self.frame.origin()) * self.frame.scale();
        let slack = SLACK * (1.0 + origin.abs().max_element()) * (1.0 + slopes.steepest());
        if slack.is_nan() || slack > COARSEST {
            return None;
        }
        Some(Frustum {
            depth,
            origin: origin.to_array().map(frame::nearest),
            low: slopes.low.map(frame::below),
            high: slopes.high.map(frame::above),
            slack: frame::above(slack),
        })
    }

    /// How long a unit of the scene is in the tree's frame, a power of two.
    pub(crate) fn scale(&self) -> f64 {
        self.frame.scale()
    }

    /// Visits every shape that rays in a frustum may meet, nearer nodes first. Once `cancelled` is true the rest is left out.
    #[inline(always)]
    pub(crate) fn visit_frustum<S: Simd>(
        &self,
        simd: S,
        frustum: &Frustum,
        mut limit: f32,
        stack: &mut Stack,
        cancelled: &AtomicBool,
        visitor: &mut impl FrustumVisitor<S>,
    ) {
        let stack = stack.cleared();
        let Some(mut node) = self.nodes.first() else { return };
        loop {
            let (mut mask, depths) = frustum.meets(simd, node, limit);
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

impl Frustum {
    /// Returns the depth up to which boxes are of interest where a hit is at this depth at the latest.
    #[inline]
    pub(crate) fn depth_limit(&self, latest: f64) -> f32 {
        frame::above(latest + f64::from(self.slack))
    }

    /// Returns which of a node's children rays in the frustum may meet before a depth, as a bit mask, and from which depth on, 0
    /// or more.
    #[inline(always)]
    pub(super) fn meets<S: Simd>(&self, simd: S, node: &Node, limit: f32) -> (u32, f32x8<S>) {
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
        (node.used() & bits8(met), near)
    }
}
