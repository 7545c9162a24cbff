//! Traversal from the root to the shapes: in this file with one ray.
//!
//! - [`packet`]: traversal with sixteen rays.
//! - [`frustum`]: traversal with all rays from one point whose slopes lie in a range, eight boxes at once. [`beam`] finds the parts of a
//!   bundle, between a point or a box and points, that may hit a shape before their [`limits`], and [`cover`] the parts whose rays all hit it.
//!   [`slopes`] and [`depth`] compute the data that they share.

mod beam;
mod cover;
mod depth;
mod frustum;
mod limits;
mod packet;
mod slopes;

pub(crate) use beam::{Beam, Shaft};
pub(crate) use depth::Depth;
pub(crate) use frustum::{FARTHEST, Frustum, FrustumVisitor, LeafBox};
pub(crate) use limits::Limits;
pub(crate) use packet::{FramePacket, PacketStack, PacketVisitor};
pub(crate) use slopes::{Ends, PACKETS, PARTS, SlopeRange, Slopes};

use std::sync::atomic::{AtomicBool, Ordering};

use crate::trace::bvh::Tree;
use crate::trace::bvh::node::{Child, LeafId, Link, Node};
use crate::trace::rays::PreparedRay;

/// Traversal stack. Reused between rays to avoid allocations.
#[derive(Clone, Debug, Default)]
pub(crate) struct Stack(Vec<StackEntry>);

/// An entry of the traversal stack: the bits of the distance at which the ray may enter a child, an `f32` that is not negative, and below
/// them the child. Entries sort by distance.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord)]
pub(super) struct StackEntry(u64);

impl StackEntry {
    #[inline]
    pub(super) fn new(child: Child, entry: f32) -> Self {
        Self(u64::from(entry.to_bits()) << 32 | u64::from(child.word()))
    }

    #[inline]
    #[expect(clippy::cast_possible_truncation, reason = "the lower half")]
    pub(super) fn child(self) -> Child {
        Child::from_word(self.0 as u32)
    }

    #[inline]
    pub(super) fn entry(self) -> f32 {
        f32::from_bits((self.0 >> 32) as u32)
    }
}

impl Stack {
    /// Clears the stack and returns it.
    pub(super) fn cleared(&mut self) -> &mut Vec<StackEntry> {
        self.0.clear();
        &mut self.0
    }
}

impl Tree {
    /// Visits every shape that the ray may hit before a limit, nearer boxes first. `visit` returns the `t` beyond which hits are no longer
    /// of interest. Stops once `cancelled` is true.
    #[inline]
    pub(crate) fn visit_nearest(
        &self,
        ray: &PreparedRay,
        mut limit: f64,
        stack: &mut Stack,
        cancelled: &AtomicBool,
        mut visit: impl FnMut(LeafId) -> f64,
    ) {
        if self.nodes.is_empty() {
            return;
        }
        let frame_ray = self.frame.ray(ray);
        let mut frame_limit = self.frame.limit(limit);
        let stack = stack.cleared();
        let mut node = &self.nodes[0];
        loop {
            let (mut mask, entries) = node.entries(&frame_ray, frame_limit);
            let base = stack.len();
            while mask != 0 {
                let index = mask.trailing_zeros() as usize;
                mask &= mask - 1;
                stack.push(StackEntry::new(node.children[index], entries[index]));
            }
            farther_first(&mut stack[base..]);
            loop {
                let Some(next) = stack.pop() else {
                    return;
                };
                if next.entry() > frame_limit * Node::LENGTHEN {
                    continue;
                }
                match next.child().read() {
                    Link::Node(index) => {
                        node = &self.nodes[index];
                        break;
                    }
                    Link::Leaf(leaf) => {
                        if cancelled.load(Ordering::Relaxed) {
                            return;
                        }
                        let wanted = visit(leaf);
                        if wanted < limit {
                            limit = wanted;
                            frame_limit = self.frame.limit(limit);
                        }
                    }
                }
            }
        }
    }

    /// Returns a shape that the ray may hit before the limit and for which `found` holds, if there is one. Returns `None` once `cancelled`
    /// is true.
    #[inline]
    pub(crate) fn find_any(
        &self,
        ray: &PreparedRay,
        limit: f64,
        stack: &mut Stack,
        cancelled: &AtomicBool,
        mut found: impl FnMut(LeafId) -> bool,
    ) -> Option<LeafId> {
        if self.nodes.is_empty() {
            return None;
        }
        let frame_ray = self.frame.ray(ray);
        let frame_limit = self.frame.limit(limit);
        let stack = stack.cleared();
        let mut node = &self.nodes[0];
        loop {
            let (mut mask, _) = node.entries(&frame_ray, frame_limit);
            while mask != 0 {
                let child = node.children[mask.trailing_zeros() as usize];
                mask &= mask - 1;
                match child.read() {
                    Link::Node(_) => stack.push(StackEntry::new(child, 0.0)),
                    Link::Leaf(_) if cancelled.load(Ordering::Relaxed) => return None,
                    Link::Leaf(leaf) if found(leaf) => return Some(leaf),
                    Link::Leaf(_) => {}
                }
            }
            let Link::Node(index) = stack.pop()?.child().read() else {
                return None;
            };
            node = &self.nodes[index];
        }
    }
}

/// Sorts a few entries by insertion: farther ones below, nearer ones on top.
#[inline]
pub(super) fn farther_first(pushed: &mut [StackEntry]) {
    for from in 1..pushed.len() {
        let mut place = from;
        while place > 0 && pushed[place - 1] < pushed[place] {
            pushed.swap(place - 1, place);
            place -= 1;
        }
    }
}
