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

/// Builds trees. The first build frees its scratch memory, since most scenes are built once; further ones keep it for the next.
#[derive(Debug, Default)]
pub(crate) struct Builder {
    boxes: Vec<FrameBox>,
    /// True for spheres. A separate array, so that all of it stays in a cache during the build.
    round: Vec<bool>,
    /// Index of the shape of each leaf.
    order: Vec<u32>,
    treelets: Vec<Treelet>,
    has_built: bool,
}

/// A group of neighbouring shapes.
#[derive(Debug, Default)]
struct Treelet {
    /// The nodes of its tree.
    nodes: Vec<Node>,
    /// The bounds of its shapes.
    bounds: FrameBox,
    /// Index of its first leaf among all leaves.
    first_leaf: usize,
    /// Index of its root among all nodes.
    first_node: usize,
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
    ) -> &[u32] {
        let frame = Frame::of(count, |index| extent(index).bounds);
        let Self { boxes, round, order, treelets, has_built } = self;
        let place = |index| {
            let Extent { bounds, round } = extent(index);
            (frame.bounds(&bounds), round)
        };
        (0..count).into_par_iter().map(place).unzip_into_vecs(boxes, round);
        order.clear();
        order.extend(0..to_u32(count));
        let ends = morton::divide(boxes, order, TREELET_SIZE);
        treelets.resize_with(ends.len(), Treelet::default);
        runs(order, &ends).into_par_iter().zip(&mut *treelets).for_each_init(
            BuildScratch::default,
            |scratch, ((first_leaf, members), treelet)| {
                treelet.first_leaf = first_leaf;
                treelet.build(scratch, boxes, round, members);
            },
        );
        tree.frame = frame;
        assemble(treelets, &mut tree.nodes);
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

    /// Returns a node of the treelet with its children renumbered for the whole tree.
    fn node(&self, index: usize) -> Node {
        self.nodes[index].relinked(|child| match child.read() {
            Link::Node(node) => Child::node(to_u32(self.first_node + node)),
            Link::Leaf(leaf) => Child::leaf(to_u32(self.first_leaf + leaf.index())),
        })
    }
}

/// Splits a list into runs with these ends. Returns each run with its start.
fn runs<'a>(mut list: &'a mut [u32], ends: &[usize]) -> Vec<(usize, &'a mut [u32])> {
    let mut start = 0;
    let next = |end: &usize| {
        let (run, rest) = std::mem::take(&mut list).split_at_mut(end - start);
        list = rest;
        (std::mem::replace(&mut start, *end), run)
    };
    ends.iter().map(next).collect()
}

/// Joins the trees of all treelets under one root. The nodes above the treelets come first.
fn assemble(treelets: &mut [Treelet], nodes: &mut Vec<Node>) {
    let (mut above, mut order) = (Vec::new(), Vec::new());
    if treelets.len() > 1 {
        let mut clusters = Clusters::default();
        clusters.build(treelets.iter().map(|treelet| &treelet.bounds));
        collapse(&clusters, |_| false, &mut above, &mut order);
    }
    let mut count = above.len();
    for treelet in &mut *treelets {
        treelet.first_node = count;
        count += treelet.nodes.len();
    }
    let treelet = |place: usize| &treelets[order[place] as usize];
    let upper = |node: &Node| {
        node.relinked(|child| match child.read() {
            Link::Node(_) => child,
            Link::Leaf(leaf) => Child::node(to_u32(treelet(leaf.index()).first_node)),
        })
    };
    let lower = |index: usize| {
        let next = treelets.partition_point(|treelet| treelet.first_node <= index);
        let treelet = &treelets[next - 1];
        treelet.node(index - treelet.first_node)
    };
    (0..count)
        .into_par_iter()
        .map(|index| above.get(index).map_or_else(|| lower(index), upper))
        .collect_into_vec(nodes);
}
