//! From boxes to a tree of wide nodes.

use obvhs::aabb::Aabb;
use obvhs::bvh2::Bvh2;
use obvhs::ploc::{PlocBuilder, PlocSearchDistance, SortPrecision};
use rayon::prelude::*;

use super::frame::{Frame, FrameBox};
use super::node::{Child, Node, WIDTH};
use super::{Slot, Tree};
use crate::trace::Bounds;

impl Tree {
    /// A tree over these shapes.
    pub(in crate::trace) fn build(slots: &[Slot], bounds: &[Bounds]) -> Self {
        let frame = Frame::of(bounds);
        let boxes: Vec<Aabb> = bounds
            .par_iter()
            .map(|bounds| {
                let FrameBox { min, max } = frame.bounds(bounds);
                Aabb::new(min.into(), max.into())
            })
            .collect();
        let indices = (0..u32::try_from(boxes.len()).unwrap_or(u32::MAX)).collect();
        // Agglomerative clustering along a Morton curve (Meister and Bittner, "Parallel Locally-Ordered Clustering",
        // 2018) with the smallest search distance: the cheapest tree to build traces as fast as the dearest once its
        // lower levels are collapsed into leaves.
        let binary = PlocBuilder::with_capacity(boxes.len()).build(
            PlocSearchDistance::Minimum,
            &boxes,
            indices,
            SortPrecision::U64,
            0,
        );
        Collapse::new(&binary, slots).run(frame)
    }
}

/// Pulls grandchildren up into wide nodes, and small subtrees together into leaves.
struct Collapse<'a> {
    binary: &'a Bvh2,
    /// The shapes' slots, in the order of the boxes.
    given: &'a [Slot],
    /// How many shapes lie under each binary node.
    counts: Vec<u32>,
    nodes: Vec<Node>,
    slots: Vec<Slot>,
}

impl<'a> Collapse<'a> {
    fn new(binary: &'a Bvh2, given: &'a [Slot]) -> Self {
        let mut collapse =
            Self { binary, given, counts: vec![0; binary.nodes.len()], nodes: Vec::new(), slots: Vec::new() };
        collapse.count();
        collapse
    }

    /// Counts shapes from the leaves up, without recursion: a tree over coincident shapes may be deep.
    fn count(&mut self) {
        if self.binary.nodes.is_empty() {
            return;
        }
        let mut order = vec![0];
        let mut next = 0;
        while let Some(&index) = order.get(next) {
            next += 1;
            let node = &self.binary.nodes[index];
            if !node.is_leaf() {
                let first = node.first_index as usize;
                order.extend([first, first + 1]);
            }
        }
        for &index in order.iter().rev() {
            let node = &self.binary.nodes[index];
            let first = node.first_index as usize;
            self.counts[index] =
                if node.is_leaf() { node.prim_count } else { self.counts[first] + self.counts[first + 1] };
        }
    }

    fn run(mut self, frame: Frame) -> Tree {
        if !self.binary.nodes.is_empty() {
            self.nodes.push(Node::empty());
            let mut pending = vec![(0, 0)];
            while let Some((binary_index, wide_index)) = pending.pop() {
                self.fill(binary_index, wide_index, &mut pending);
            }
        }
        Tree { frame, nodes: self.nodes, slots: self.slots }
    }

    fn is_small(&self, index: usize) -> bool {
        self.counts[index] as usize <= Child::LARGEST_LEAF
    }

    /// Fills one wide node with the descendants of a binary one, opening the largest boxes first.
    fn fill(&mut self, binary_index: usize, wide_index: usize, pending: &mut Vec<(usize, usize)>) {
        let mut members = [0; WIDTH];
        members[0] = binary_index;
        let mut length = 1;
        let half_area = |index: usize| self.binary.nodes[index].aabb().half_area();
        while length < WIDTH {
            let open = (0..length)
                .filter(|member| !self.is_small(members[*member]))
                .max_by(|left, right| half_area(members[*left]).total_cmp(&half_area(members[*right])));
            let Some(open) = open else { break };
            let first = self.binary.nodes[members[open]].first_index as usize;
            members[open] = first;
            members[length] = first + 1;
            length += 1;
        }
        for (place, &member) in members[..length].iter().enumerate() {
            let bounds = self.binary.nodes[member].aabb();
            let bounds = FrameBox { min: bounds.min.to_array(), max: bounds.max.to_array() };
            let child = if self.is_small(member) {
                self.leaf(member)
            } else {
                let next = self.nodes.len();
                self.nodes.push(Node::empty());
                pending.push((member, next));
                Child::node(u32::try_from(next).unwrap_or(u32::MAX))
            };
            self.nodes[wide_index].set(place, &bounds, child);
        }
    }

    /// Gathers the slots under a small binary subtree, in document order.
    fn leaf(&mut self, index: usize) -> Child {
        let first = self.slots.len();
        let mut open = vec![index];
        while let Some(index) = open.pop() {
            let node = &self.binary.nodes[index];
            let start = node.first_index as usize;
            if node.is_leaf() {
                let members = &self.binary.primitive_indices[start..start + node.prim_count as usize];
                self.slots.extend(members.iter().map(|member| self.given[*member as usize]));
            } else {
                open.extend([start, start + 1]);
            }
        }
        self.slots[first..].sort_unstable();
        Child::leaf(u32::try_from(first).unwrap_or(u32::MAX), self.counts[index])
    }
}
