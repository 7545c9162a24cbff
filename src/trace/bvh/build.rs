//! From boxes to a tree of wide nodes.

use glam::Vec3A;
use obvhs::aabb::Aabb;
use obvhs::bvh2::Bvh2;
use obvhs::ploc::{PlocBuilder, PlocSearchDistance, SortPrecision};
use rayon::prelude::*;

use super::frame::{Frame, FrameBox};
use super::node::{Child, Node, WIDTH};
use super::{Extent, Tree};

impl Tree {
    /// Builds a tree over these shapes. Returns with it the index of each leaf's shape.
    pub(crate) fn build(extents: &[Extent]) -> (Self, Vec<u32>) {
        let frame = Frame::of(extents);
        let boxes: Vec<FrameBox> = extents.par_iter().map(|extent| frame.bounds(&extent.bounds)).collect();
        let uneven: Vec<Aabb> =
            boxes.par_iter().enumerate().map(|(index, bounds)| uneven(bounds, index)).collect();
        let indices = (0..u32::try_from(boxes.len()).unwrap_or(u32::MAX)).collect();
        // Agglomerative clustering along a Morton curve (Meister and Bittner, "Parallel Locally-Ordered Clustering",
        // 2018) with the smallest search distance: the cheapest tree to build traces as fast as the dearest once its
        // lower levels are collapsed into leaves.
        let binary = PlocBuilder::with_capacity(boxes.len()).build(
            PlocSearchDistance::Minimum,
            &uneven,
            indices,
            SortPrecision::U64,
            0,
        );
        Collapse::new(&binary, extents, &boxes).run(frame)
    }
}

/// A box a little larger, for the clustering alone, by an amount that differs from box to box. Where all neighbours are
/// equally near, as in a regular row or a crowd of coincident shapes, the clustering would merge a single pair in each pass.
#[expect(clippy::cast_precision_loss, reason = "24 bits of a hash")]
fn uneven(bounds: &FrameBox, index: usize) -> Aabb {
    const OF_EXTENT: f32 = 1e-3;
    const AT_LEAST: f32 = 1e-12;
    // The multiplier of Knuth's multiplicative hashing, The Art of Computer Programming 3, section 6.4, for 64 bits.
    let hash = (index as u64).wrapping_mul(0x9e37_79b9_7f4a_7c15) >> 40;
    let share = hash as f32 / (1 << 24) as f32;
    let (min, max) = (Vec3A::from(bounds.min), Vec3A::from(bounds.max));
    let growth = ((max - min) * OF_EXTENT + AT_LEAST) * share;
    Aabb::new(min - growth, max + growth)
}

/// Pulls grandchildren up into wide nodes. A subtree of no more shapes than a node has children becomes a node of shapes: their
/// boxes are asked all at once before any of them is.
struct Collapse<'a> {
    binary: &'a Bvh2,
    extents: &'a [Extent],
    boxes: &'a [FrameBox],
    /// How many shapes lie under each binary node.
    counts: Vec<u32>,
    /// The box around them.
    bounds: Vec<FrameBox>,
    nodes: Vec<Node>,
    /// By leaf: the index of its shape.
    leaves: Vec<u32>,
}

impl<'a> Collapse<'a> {
    fn new(binary: &'a Bvh2, extents: &'a [Extent], boxes: &'a [FrameBox]) -> Self {
        let mut collapse = Self {
            binary,
            extents,
            boxes,
            counts: vec![0; binary.nodes.len()],
            bounds: vec![FrameBox::EMPTY; binary.nodes.len()],
            nodes: Vec::new(),
            leaves: Vec::with_capacity(boxes.len()),
        };
        collapse.measure();
        collapse
    }

    /// Counts and bounds shapes from the leaves up, without recursion: a tree over coincident shapes may be deep.
    fn measure(&mut self) {
        let mut order = Vec::with_capacity(self.binary.nodes.len());
        order.extend((!self.binary.nodes.is_empty()).then_some(0));
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
            if node.is_leaf() {
                let members = &self.binary.primitive_indices[first..first + node.prim_count as usize];
                self.counts[index] = node.prim_count;
                let boxes = members.iter().map(|member| self.boxes[*member as usize]);
                self.bounds[index] = boxes.fold(FrameBox::EMPTY, |all, bounds| all.union(&bounds));
            } else {
                self.counts[index] = self.counts[first] + self.counts[first + 1];
                self.bounds[index] = self.bounds[first].union(&self.bounds[first + 1]);
            }
        }
    }

    fn run(mut self, frame: Frame) -> (Tree, Vec<u32>) {
        if !self.binary.nodes.is_empty() {
            self.nodes.push(Node::empty());
            let mut pending = vec![(0, 0)];
            while let Some((binary_index, wide_index)) = pending.pop() {
                self.fill(binary_index, wide_index, &mut pending);
            }
        }
        (Tree { frame, nodes: self.nodes }, self.leaves)
    }

    fn is_small(&self, index: usize) -> bool {
        self.counts[index] as usize <= WIDTH
    }

    /// Fills one wide node with the descendants of a binary one, opening the largest boxes first; all of them if they are few.
    fn fill(&mut self, binary_index: usize, wide_index: usize, pending: &mut Vec<(usize, usize)>) {
        let mut members = [0; WIDTH];
        members[0] = binary_index;
        let mut length = 1;
        let few = self.is_small(binary_index);
        let opens = |index: usize| if few { self.counts[index] > 1 } else { !self.is_small(index) };
        let half_area = |index: usize| self.bounds[index].half_area();
        while length < WIDTH {
            let open = (0..length)
                .filter(|member| opens(members[*member]))
                .max_by(|left, right| half_area(members[*left]).total_cmp(&half_area(members[*right])));
            let Some(open) = open else { break };
            let first = self.binary.nodes[members[open]].first_index as usize;
            members[open] = first;
            members[length] = first + 1;
            length += 1;
        }
        for (place, &member) in members[..length].iter().enumerate() {
            let (child, round) = if self.counts[member] == 1 {
                let first = self.binary.nodes[member].first_index as usize;
                let shape = self.binary.primitive_indices[first];
                self.leaves.push(shape);
                (Child::leaf(to_u32(self.leaves.len() - 1)), self.extents[shape as usize].round)
            } else {
                let next = self.nodes.len();
                self.nodes.push(Node::empty());
                pending.push((member, next));
                (Child::node(to_u32(next)), false)
            };
            self.nodes[wide_index].set(place, &self.bounds[member], child, round);
        }
    }
}

fn to_u32(index: usize) -> u32 {
    u32::try_from(index).unwrap_or(u32::MAX)
}

#[cfg(test)]
mod tests {
    use glam::DVec3;

    use super::super::node::Link;
    use super::*;
    use crate::trace::shapes::Bounds;

    /// The indices of a tree's shapes in order, and how many nodes lie above its deepest leaf.
    fn walk((tree, leaves): &(Tree, Vec<u32>)) -> (Vec<u32>, usize) {
        let mut found = Vec::new();
        let mut deepest = 0;
        let mut open = vec![(0, 1)];
        while let Some((index, depth)) = open.pop() {
            deepest = deepest.max(depth);
            for link in tree.nodes[index].links() {
                match link {
                    Link::Node(index) => open.push((index, depth + 1)),
                    Link::Leaf(leaf) => found.push(leaves[leaf.index()]),
                }
            }
        }
        found.sort_unstable();
        (found, deepest)
    }

    #[test]
    fn heaps_rows_and_grids_make_shallow_trees_that_hold_every_shape_once() {
        let count = 5000;
        let places: [fn(u32) -> DVec3; 4] = [
            |_| DVec3::ZERO,
            |index| DVec3::X * f64::from(index),
            |index| DVec3::new(f64::from(index % 17), f64::from(index / 17 % 17), f64::from(index / 289)),
            |index| DVec3::Y * f64::from(index) * 1e-12,
        ];
        for place in places {
            for half in [0.0, 1e-60, 0.4] {
                let around = |index: u32| Bounds::around(place(index), DVec3::splat(half));
                let extents: Vec<Extent> =
                    (0..count).map(|index| Extent { bounds: around(index), round: false }).collect();
                let (found, depth) = walk(&Tree::build(&extents));
                assert_eq!(found, (0..count).collect::<Vec<u32>>());
                assert!(depth <= 14, "{depth} nodes deep");
            }
        }
    }
}
