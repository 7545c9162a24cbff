//! From boxes to a tree of wide nodes.
//!
//! The [Morton curve](super::morton) divides shapes into treelets of neighbours, after Pantaleoni and Luebke, "HLBVH: Hierarchical
//! LBVH Construction for Real-Time Ray Tracing of Dynamic Geometry" (2010). Each becomes a tree, on a thread of its own and in that
//! core's cache: a [binary](super::ploc) one, then a [wide](super::collapse) one. A tree over the treelets is built in the same way,
//! and all are put together in one array.

use rayon::prelude::*;

use super::collapse::collapse;
use super::frame::{Frame, FrameBox};
use super::index::to_u32;
use super::morton;
use super::node::{Child, Link, Node};
use super::ploc::Clusters;
use super::{Extent, Tree};

/// How many shapes a treelet has at most: enough for trees that are as good as a single one, few enough for many threads.
const TREELET_SIZE: usize = 16_384;

/// Builds trees. It keeps the memory that this takes for the next time.
#[derive(Debug, Default)]
pub(crate) struct Builder {
    boxes: Vec<FrameBox>,
    /// Which shapes are spheres: apart, so that all of it is in a cache while trees are built.
    round: Vec<bool>,
    /// By leaf: the index of its shape.
    order: Vec<u32>,
    treelets: Vec<Treelet>,
}

/// Some neighbouring shapes.
#[derive(Debug, Default)]
struct Treelet {
    /// A tree over them.
    nodes: Vec<Node>,
    /// Around them.
    bounds: FrameBox,
    /// Its place among all shapes.
    first_leaf: usize,
    /// Its root's place among all nodes.
    first_node: usize,
}

/// What a thread needs to build a tree.
#[derive(Debug, Default)]
struct Scratch {
    boxes: Vec<FrameBox>,
    order: Vec<u32>,
    keys: Vec<u64>,
    clusters: Clusters,
    leaves: Vec<u32>,
}

impl Clone for Builder {
    /// Another one, which has no memory yet.
    fn clone(&self) -> Self {
        Self::default()
    }
}

impl Builder {
    /// Makes a tree over so many shapes, given by their indices. Returns the index of each leaf's shape.
    pub(crate) fn build(
        &mut self,
        count: usize,
        extent: impl Fn(usize) -> Extent + Sync,
        tree: &mut Tree,
    ) -> &[u32] {
        let frame = Frame::of(count, |index| extent(index).bounds);
        let Self { boxes, round, order, treelets } = self;
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
            Scratch::default,
            |scratch, ((first_leaf, members), treelet)| {
                treelet.first_leaf = first_leaf;
                treelet.build(scratch, boxes, round, members);
            },
        );
        tree.frame = frame;
        assemble(treelets, &mut tree.nodes);
        order
    }
}

impl Treelet {
    /// Makes a tree over some shapes, and puts them into the order of its leaves.
    fn build(&mut self, scratch: &mut Scratch, all: &[FrameBox], round: &[bool], members: &mut [u32]) {
        let Scratch { boxes, order, keys, clusters, leaves } = scratch;
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

    /// Returns a node of its tree as a node of the whole.
    fn node(&self, index: usize) -> Node {
        self.nodes[index].relinked(|child| match child.read() {
            Link::Node(node) => Child::node(to_u32(self.first_node + node)),
            Link::Leaf(leaf) => Child::leaf(to_u32(self.first_leaf + leaf.index())),
        })
    }
}

/// Divides a list into runs that end there. Returns with each run where it starts.
fn runs<'a>(mut list: &'a mut [u32], ends: &[usize]) -> Vec<(usize, &'a mut [u32])> {
    let mut start = 0;
    let next = |end: &usize| {
        let (run, rest) = std::mem::take(&mut list).split_at_mut(end - start);
        list = rest;
        (std::mem::replace(&mut start, *end), run)
    };
    ends.iter().map(next).collect()
}

/// Puts the trees of all treelets under one root: above them come those nodes that have treelets below them.
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
