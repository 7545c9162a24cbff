//! Construction of a tree of wide nodes from boxes, and its update.
//!
//! The [Morton curve](morton) divides the shapes into treelets of neighbours, after Pantaleoni and Luebke, "HLBVH: Hierarchical LBVH
//! Construction for Real-Time Ray Tracing of Dynamic Geometry" (2010). Each treelet is built by one thread, in the cache of its core: first
//! a [binary](ploc) tree, then a [wide](mod@collapse) one. A tree over the treelets is built in the same way, and all nodes are
//! joined in one array. [`refit`] updates the boxes of a tree if few shapes have moved.

mod collapse;
mod morton;
mod ploc;
mod refit;

pub(crate) use refit::Refitter;

use rayon::prelude::*;

use self::collapse::collapse;
use self::ploc::Clusters;
use crate::trace::bvh::frame::{Frame, FrameBox};
use crate::trace::bvh::node::{Child, Link, Node, to_u32};
use crate::trace::bvh::{Extent, Tree};

/// Maximum number of shapes in a treelet: enough for trees as good as a single one, and few enough to occupy many threads.
const TREELET_SIZE: usize = 16_384;

/// Number of boxes per node; most trees have at most one node for this many.
const BOXES_A_NODE: usize = 4;

/// Number of treelets per thread that are built before they are joined: few, since their nodes are then in memory twice.
const TREELETS_A_THREAD: usize = 4;

/// Builds trees. The first build frees its scratch memory, since most scenes are built once; further ones keep it for the next.
#[derive(Debug, Default)]
pub(crate) struct Builder {
    boxes: Vec<FrameBox>,
    /// True for spheres. A separate array, so that all of it stays in a cache during the build.
    round: Vec<bool>,
    treelets: Vec<Treelet>,
    has_built: bool,
}

/// The tree of a group of neighbouring shapes.
#[derive(Debug, Default)]
struct Treelet {
    nodes: Vec<Node>,
    bounds: FrameBox,
}

/// Scratch memory of one thread.
#[derive(Debug, Default)]
struct BuildScratch {
    boxes: Vec<FrameBox>,
    order: Vec<u32>,
    keys: Vec<u64>,
    clusters: Clusters,
    leaves: Vec<u32>,
}

impl Clone for Builder {
    /// Returns a builder without scratch memory.
    fn clone(&self) -> Self {
        Self::default()
    }
}

impl Builder {
    /// Builds a tree over `count` shapes, given by their indices. Returns the index of each leaf's shape.
    pub(crate) fn build(
        &mut self,
        count: usize,
        extent: impl Fn(usize) -> Extent + Sync,
        tree: &mut Tree,
    ) -> Vec<u32> {
        let frame = Frame::of(count, |index| extent(index).bounds);
        let Self { boxes, round, treelets, has_built } = self;
        let place = |index| {
            let Extent { bounds, round } = extent(index);
            (frame.bounds(&bounds), round)
        };
        (0..count).into_par_iter().map(place).unzip_into_vecs(boxes, round);
        let mut order: Vec<u32> = (0..to_u32(count)).collect();
        let ends = morton::divide(boxes, &mut order, TREELET_SIZE);
        tree.frame = frame;
        tree.nodes.clear();
        tree.nodes.reserve(count / BOXES_A_NODE);
        // The nodes above the treelets come first: one treelet needs none, several need fewer than there are treelets.
        tree.nodes.resize(if ends.len() > 1 { ends.len() } else { 0 }, Node::empty());
        let (mut roots, mut first_leaf) = (Vec::new(), 0);
        treelets.resize_with(rayon::current_num_threads() * TREELETS_A_THREAD, Treelet::default);
        for group in runs(&mut order, &ends).chunks_mut(treelets.len()) {
            group.par_iter_mut().zip(&mut *treelets).for_each_init(
                BuildScratch::default,
                |scratch, (members, treelet)| {
                    treelet.build(scratch, boxes, round, members);
                },
            );
            for (members, treelet) in group.iter().zip(&*treelets) {
                roots.push((treelet.bounds, tree.nodes.len()));
                tree.append(treelet, first_leaf);
                first_leaf += members.len();
            }
        }
        tree.join(&roots);
        let is_first = !*has_built;
        // A new scene is empty.
        *has_built |= count > 0;
        if is_first {
            (*boxes, *round, *treelets) = Default::default();
        }
        order
    }
}

impl Treelet {
    /// Builds a tree over `members`, and sorts them into the order of its leaves.
    fn build(&mut self, scratch: &mut BuildScratch, all: &[FrameBox], round: &[bool], members: &mut [u32]) {
        let BuildScratch { boxes, order, keys, clusters, leaves } = scratch;
        boxes.clear();
        boxes.extend(members.iter().map(|member| all[*member as usize]));
        order.clear();
        order.extend(0..to_u32(members.len()));
        morton::sort(boxes, order, keys);
        clusters.build(order.iter().map(|place| &boxes[*place as usize]));
        for place in &mut *order {
            *place = members[*place as usize];
        }
        let round = |place: usize| round[order[place] as usize];
        collapse(clusters, round, &mut self.nodes, leaves);
        self.bounds = clusters.get(clusters.root()).bounds();
        for (member, leaf) in members.iter_mut().zip(leaves) {
            *member = order[*leaf as usize];
        }
    }
}

impl Tree {
    /// Adds the nodes of a treelet, whose first leaf gets this index.
    fn append(&mut self, treelet: &Treelet, first_leaf: usize) {
        let first_node = self.nodes.len();
        let moved = |child: Child| match child.read() {
            Link::Node(node) => Child::node(to_u32(first_node + node)),
            Link::Leaf(leaf) => Child::leaf(to_u32(first_leaf + leaf.index())),
        };
        self.nodes.par_extend(treelet.nodes.par_iter().map(|node| node.relinked(moved)));
    }

    /// Joins several treelets under one root, given by the bounds and the index of each treelet's root.
    fn join(&mut self, roots: &[(FrameBox, usize)]) {
        if roots.len() < 2 {
            return;
        }
        let (mut clusters, mut above, mut order) = (Clusters::default(), Vec::new(), Vec::new());
        clusters.build(roots.iter().map(|(bounds, _)| bounds));
        collapse(&clusters, |_| false, &mut above, &mut order);
        let root = |child: Child| match child.read() {
            Link::Node(_) => child,
            Link::Leaf(leaf) => Child::node(to_u32(roots[order[leaf.index()] as usize].1)),
        };
        for (place, node) in self.nodes.iter_mut().zip(&above) {
            *place = node.relinked(root);
        }
    }
}

/// Splits a list into runs with these ends.
fn runs<'a>(mut list: &'a mut [u32], ends: &[usize]) -> Vec<&'a mut [u32]> {
    let mut start = 0;
    let next = |end: &usize| {
        let (run, rest) = std::mem::take(&mut list).split_at_mut(end - start);
        (list, start) = (rest, *end);
        run
    };
    ends.iter().map(next).collect()
}
