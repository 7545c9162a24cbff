//! Refitting: updates the boxes from the leaves that moved up to the root, and leaves the rest of the tree unchanged.
//!
//! A tree that was built for other positions traces ever more slowly. By the surface area heuristic, the cost of a tree is proportional to
//! the surface areas of its boxes (Goldsmith and Salmon, "Automatic Creation of Object Hierarchies for Ray Tracing", 1987): once they have
//! grown too much, the tree must be rebuilt.

use crate::trace::bvh::Tree;
use crate::trace::bvh::frame::FrameBox;
use crate::trace::bvh::node::{LeafId, Link, Node, WIDTH, to_u32};
use crate::trace::shapes::Bounds;

/// Refits one tree. Stores the links from its leaves up to its root, and its cost.
#[derive(Clone, Debug)]
pub(crate) struct Refitter {
    /// By node. The root's entry is unused.
    node_parents: Vec<ParentLink>,
    /// By leaf.
    leaf_parents: Vec<ParentLink>,
    /// Bit set of the nodes with children that have moved.
    dirty: Vec<u64>,
    /// The cost of the tree when it was built.
    built_cost: f64,
    cost: f64,
}

/// The parent of a node or leaf, and its index among the parent's children.
#[derive(Clone, Copy, Debug, Default)]
struct ParentLink(u32);

impl ParentLink {
    fn new(node: usize, child: usize) -> Self {
        Self(to_u32(node * WIDTH + child))
    }

    fn node(self) -> usize {
        self.0 as usize / WIDTH
    }

    fn child(self) -> usize {
        self.0 as usize % WIDTH
    }
}

impl Refitter {
    /// Creates the links of a tree that was just built over this many shapes.
    pub(crate) fn new(tree: &Tree, leaves: usize) -> Self {
        let mut refitter = Self {
            node_parents: vec![ParentLink::default(); tree.nodes.len()],
            leaf_parents: vec![ParentLink::default(); leaves],
            dirty: vec![0; tree.nodes.len().div_ceil(64)],
            built_cost: 0.0,
            cost: 0.0,
        };
        for (index, node) in tree.nodes.iter().enumerate() {
            for child in node.places() {
                refitter.built_cost += f64::from(node.child_box(child).half_area());
                let parent = ParentLink::new(index, child);
                match node.children[child].read() {
                    Link::Node(child) => refitter.node_parents[child] = parent,
                    Link::Leaf(leaf) => refitter.leaf_parents[leaf.index()] = parent,
                }
            }
        }
        refitter.cost = refitter.built_cost;
        refitter
    }

    /// Moves leaves to the current bounds of their shapes. Returns whether the tree may be kept; if not, because a shape has left the frame
    /// or because the tree's cost has grown too much, it must be rebuilt.
    #[must_use]
    pub(crate) fn refit(
        &mut self,
        tree: &mut Tree,
        moved: impl IntoIterator<Item = (LeafId, Bounds)>,
    ) -> bool {
        const MOST_GROWTH: f64 = 1.25;
        for (leaf, bounds) in moved {
            let bounds = tree.frame.bounds(&bounds);
            if !bounds.is_inside() {
                return false;
            }
            self.refit_child(tree, self.leaf_parents[leaf.index()], &bounds);
        }
        self.refit_nodes(tree);
        self.cost <= self.built_cost * MOST_GROWTH
    }

    /// Refits the boxes around nodes, children before their parents, which have lower indices.
    fn refit_nodes(&mut self, tree: &mut Tree) {
        for word in (0..self.dirty.len()).rev() {
            while self.dirty[word] != 0 {
                let bit = self.dirty[word].ilog2();
                self.dirty[word] ^= 1 << bit;
                let node = word * 64 + bit as usize;
                if node == 0 {
                    return;
                }
                let (bounds, parent) = (tree.nodes[node].around(), self.node_parents[node]);
                if tree.nodes[parent.node()].child_box(parent.child()) != bounds {
                    self.refit_child(tree, parent, &bounds);
                }
            }
        }
    }

    fn refit_child(&mut self, tree: &mut Tree, parent: ParentLink, bounds: &FrameBox) {
        let node: &mut Node = &mut tree.nodes[parent.node()];
        let before = node.child_box(parent.child()).half_area();
        node.set_box(parent.child(), bounds);
        self.cost += f64::from(bounds.half_area()) - f64::from(before);
        self.dirty[parent.node() / 64] |= 1 << (parent.node() % 64);
    }

    /// Returns the current cost of the tree: half the surface area of all boxes, in units of its frame.
    #[cfg(test)]
    pub(crate) fn cost(&self) -> f64 {
        self.cost
    }
}
