//! From the root to the leaves.

use std::sync::atomic::{AtomicBool, Ordering};

use super::node::{Link, Node};
use super::{Slot, Tree};
use crate::trace::Ray;

/// Nodes and leaves still to be visited, kept between rays so that none allocates.
#[derive(Clone, Debug, Default)]
pub(in crate::trace) struct Stack(Vec<Pending>);

#[derive(Clone, Copy, Debug)]
struct Pending {
    child: super::node::Child,
    entry: f32,
}

impl Tree {
    /// Visits every shape that the ray may meet before a limit, nearer boxes first. `visit` answers with the `t` from
    /// which on it is no longer interested. Once `cancelled` is true the rest is left out.
    #[inline]
    pub(in crate::trace) fn visit_nearest(
        &self,
        ray: &Ray,
        mut limit: f64,
        stack: &mut Stack,
        cancelled: &AtomicBool,
        mut visit: impl FnMut(Slot) -> f64,
    ) {
        if self.nodes.is_empty() {
            return;
        }
        let frame_ray = self.frame.ray(ray);
        let mut frame_limit = self.frame.limit(limit);
        let stack = &mut stack.0;
        stack.clear();
        let mut node = &self.nodes[0];
        loop {
            let (mut mask, entries) = node.entries(&frame_ray, frame_limit);
            let base = stack.len();
            while mask != 0 {
                let index = mask.trailing_zeros() as usize;
                mask &= mask - 1;
                let pending = Pending { child: node.children[index], entry: entries[index] };
                // Farther ones below, nearer ones on top.
                let place =
                    base + stack[base..].iter().take_while(|other| other.entry > pending.entry).count();
                stack.insert(place, pending);
            }
            loop {
                let Some(Pending { child, entry }) = stack.pop() else {
                    return;
                };
                if entry > frame_limit * Node::LENGTHEN {
                    continue;
                }
                match child.read() {
                    Link::Node(index) => {
                        node = &self.nodes[index];
                        break;
                    }
                    Link::Leaf { first, count } => {
                        if cancelled.load(Ordering::Relaxed) {
                            return;
                        }
                        for slot in &self.slots[first..first + count] {
                            let wanted = visit(*slot);
                            if wanted < limit {
                                limit = wanted;
                                frame_limit = self.frame.limit(limit);
                            }
                        }
                    }
                }
            }
        }
    }

    /// A shape that the ray may meet before the limit and for which `found` holds, if there is any. Once `cancelled` is true the
    /// rest is left out.
    #[inline]
    pub(in crate::trace) fn find_any(
        &self,
        ray: &Ray,
        limit: f64,
        stack: &mut Stack,
        cancelled: &AtomicBool,
        mut found: impl FnMut(Slot) -> bool,
    ) -> Option<Slot> {
        if self.nodes.is_empty() {
            return None;
        }
        let frame_ray = self.frame.ray(ray);
        let frame_limit = self.frame.limit(limit);
        let stack = &mut stack.0;
        stack.clear();
        let mut node = &self.nodes[0];
        loop {
            let (mut mask, _) = node.entries(&frame_ray, frame_limit);
            while mask != 0 {
                let child = node.children[mask.trailing_zeros() as usize];
                mask &= mask - 1;
                stack.push(Pending { child, entry: 0.0 });
            }
            loop {
                let Pending { child, .. } = stack.pop()?;
                match child.read() {
                    Link::Node(index) => {
                        node = &self.nodes[index];
                        break;
                    }
                    Link::Leaf { first, count } => {
                        if cancelled.load(Ordering::Relaxed) {
                            return None;
                        }
                        let slots = &self.slots[first..first + count];
                        if let Some(slot) = slots.iter().find(|slot| found(**slot)) {
                            return Some(*slot);
                        }
                    }
                }
            }
        }
    }
}
