//! Frusta of rays with a common origin, tested against boxes.
//!
//! Let w be the dominant axis of one of the rays. At depth s >= 0 along w, a ray of direction d is at u = s d_u / |d_w| and
//! v = s d_v / |d_w| across it, relative to the origin. All rays therefore stay between the smallest and the largest of these slopes. They
//! can hit a box only if it has a point with low s <= u <= high s, and likewise for v, at some depth s within the box.
//!
//! # Rounding errors
//!
//! Everything is computed in `f32`, with a unit roundoff e of 2^-24, in the tree's frame, where boxes lie within -1..=1. Let E be the
//! largest coordinate of the origin, and S the largest slope. Compared with exact arithmetic,
//!
//! - the origin is off by at most e E,
//! - a difference of a box's plane and the origin by e (1 + E) more, and so is a depth,
//! - a product of depth and slope by 3 e (1 + E) S, slopes being rounded outwards,
//! - the last sum by e (1 + E)(1 + S).
//!
//! The total is less than 6 e (1 + E)(1 + S). Boxes are accepted if they are missed by at most 16 e (1 + E)(1 + S). The remainder covers
//! shapes whose own rounding accepts rays that miss them (see [`Frame::ray`](frame::Frame::ray)), and the rounding of directions.
//!
//! Rays that end at the origin instead, and start at a depth D, have a rounded difference as their direction: they miss the origin by up to
//! 2^-52 D (1 + S). For these rays D must be at most [`FARTHEST`], at which this error is e (1 + S).

use std::sync::atomic::{AtomicBool, Ordering};

use fearless_simd::{f32x8, prelude::*};
use glam::DVec3;

use super::depth::Depth;
use super::slopes::SlopeRange;
use super::{Stack, StackEntry};
use crate::trace::bvh::node::{LeafId, Link, Node, WIDTH};
use crate::trace::bvh::{Tree, frame};
use crate::trace::math::bits8;

/// 2^-20, or 16 times the unit roundoff of `f32`.
pub(super) const SLACK: f64 = 1.0 / 1_048_576.0;

/// Maximum depth, in the tree's frame, at which rays that end at the origin of a frustum may start: 2^28.
pub(crate) const FARTHEST: f64 = 268_435_456.0;

/// A frustum, which bounds rays with a common origin and slopes in a range, in the tree's frame.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Frustum {
    pub(super) depth: Depth,
    pub(super) origin: [f32; 3],
    pub(super) low: [f32; 2],
    pub(super) high: [f32; 2],
    pub(super) slack: f32,
}

/// The box of a shape in the tree's frame.
#[derive(Clone, Copy, Debug)]
pub(crate) struct LeafBox {
    /// Lower x, y, z, then upper x, y, z.
    pub(super) planes: [f32; 6],
    /// True if the shape is a sphere that touches all sides of the box.
    pub(super) round: bool,
}

/// Callback for every shape that rays in a frustum may hit.
pub(crate) trait FrustumVisitor<S: Simd> {
    /// Visits a shape and its box. Returns the depth beyond which shapes are no longer of interest.
    fn visit(&mut self, simd: S, leaf: LeafId, bounds: &LeafBox) -> f32;
}

impl Tree {
    /// Creates the frustum of the rays from a point with these slopes. `None` if the point is so far from the shapes that `f32` would
    /// separate too few of them.
    #[inline(always)]
    pub(crate) fn frustum(&self, origin: DVec3, depth: Depth, slopes: &SlopeRange) -> Option<Frustum> {
        /// Maximum slack, relative to the size of all shapes together.
        const COARSEST: f64 = 1.0 / 4096.0;
        let origin = (origin - self.frame.origin()) * self.frame.scale();
        let slack = SLACK * (1.0 + origin.abs().max_element()) * (1.0 + f64::from(slopes.steepest()));
        if slack.is_nan() || slack > COARSEST {
            return None;
        }
        Some(Frustum {
            depth,
            origin: origin.to_array().map(frame::nearest),
            low: slopes.low,
            high: slopes.high,
            slack: frame::above(slack),
        })
    }

    /// Returns the length of a scene unit in the tree's frame, a power of two.
    pub(crate) fn scale(&self) -> f64 {
        self.frame.scale()
    }

    /// Visits every shape that rays in a frustum may hit, nearer nodes first. Stops once `cancelled` is true.
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
            let (mut mask, depths) = frustum.intersect(simd, node, limit);
            let depths = *depths.as_array();
            let base = stack.len();
            while mask != 0 {
                let child = mask.trailing_zeros() as usize % WIDTH;
                mask &= mask - 1;
                match node.children[child].read() {
                    Link::Node(_) => stack.push(StackEntry::new(node.children[child], depths[child])),
                    Link::Leaf(_) if cancelled.load(Ordering::Relaxed) => return,
                    Link::Leaf(leaf) if depths[child] <= limit => {
                        let bounds = LeafBox { planes: node.bounds(child), round: node.is_round(child) };
                        limit = visitor.visit(simd, leaf, &bounds);
                    }
                    Link::Leaf(_) => {}
                }
            }
            super::farther_first(&mut stack[base..]);
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
    /// Returns the depth up to which boxes are of interest if a hit is at depth `latest` or nearer.
    #[inline]
    pub(crate) fn depth_limit(&self, latest: f64) -> f32 {
        frame::above(latest + f64::from(self.slack))
    }

    /// Returns a bit mask of the node's children that rays in the frustum may hit up to a depth, and the depths at which they begin, 0 or
    /// more.
    #[inline(always)]
    pub(super) fn intersect<S: Simd>(&self, simd: S, node: &Node, limit: f32) -> (u32, f32x8<S>) {
        let splat = f32x8::splat;
        let [w, u, v] = self.depth.axes();
        let [near, far] = self.depth.near_and_far();
        let slack = splat(simd, self.slack);
        let origin = splat(simd, self.origin[w]);
        let (near, far) = (node.plane(simd, near), node.plane(simd, far));
        let (near, far) =
            if self.depth.upwards { (near - origin, far - origin) } else { (origin - near, origin - far) };
        let near = near.max(splat(simd, 0.0));
        let mut hit = far.simd_ge(-slack) & near.simd_le(splat(simd, limit));
        for (side, across) in [u, v].into_iter().enumerate() {
            let origin = splat(simd, self.origin[across]);
            let (lower, upper) = (node.plane(simd, across) - origin, node.plane(simd, across + 3) - origin);
            let (low, high) = (splat(simd, self.low[side]), splat(simd, self.high[side]));
            hit &= lower.simd_le((high * near).max(high * far) + slack)
                & upper.simd_ge((low * near).min(low * far) - slack);
        }
        (node.used() & bits8(hit), near)
    }
}
