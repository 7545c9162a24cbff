//! Collapsing of a binary tree into wide nodes.

use super::BOXES_A_NODE;
use super::ploc::Clusters;
use crate::trace::bvh::node::{Child, Node, WIDTH, to_u32};

/// Pulls grandchildren up into wide nodes, the root first and every node before its children. A cluster with at most as many boxes as a
/// node has children becomes a node of boxes, so that all of them are tested at once before any of their shapes.
///
/// Boxes become leaves, and the leaves of a node are consecutive; `leaves` receives the index of each leaf's box. `round` returns whether a
/// box holds a sphere.
pub(super) fn collapse(
    clusters: &Clusters,
    round: impl Fn(usize) -> bool,
    nodes: &mut Vec<Node>,
    leaves: &mut Vec<u32>,
) {
    nodes.clear();
    leaves.clear();
    nodes.reserve(clusters.get(clusters.root()).count as usize / BOXES_A_NODE + 1);
    nodes.push(Node::empty());
    let mut pending = vec![(clusters.root(), 0)];
    while let Some((cluster, node)) = pending.pop() {
        let members = Members::of(clusters, cluster);
        for (place, &member) in members.clusters[..members.count].iter().enumerate() {
            let (child, round) = if clusters.parts(member).is_none() {
                leaves.push(to_u32(member));
                (Child::leaf(to_u32(leaves.len() - 1)), round(member))
            } else {
                pending.push((member, nodes.len()));
                nodes.push(Node::empty());
                (Child::node(to_u32(nodes.len() - 1)), false)
            };
            nodes[node].set(place, &clusters.get(member).bounds(), child, round);
        }
    }
}

/// The clusters that become the children of one wide node.
#[derive(Default)]
struct Members {
    clusters: [usize; WIDTH],
    count: usize,
}

impl Members {
    fn of(clusters: &Clusters, cluster: usize) -> Self {
        let mut members = Self::default();
        if clusters.get(cluster).count as usize <= WIDTH {
            members.open_all(clusters, cluster);
        } else {
            members.open_largest(clusters, cluster);
        }
        members
    }

    /// Adds all boxes of a small cluster.
    fn open_all(&mut self, clusters: &Clusters, cluster: usize) {
        let mut stack = [0; WIDTH];
        stack[0] = cluster;
        let mut height = 1;
        while height > 0 {
            if let Some([first, second]) = clusters.parts(stack[height - 1]) {
                (stack[height - 1], stack[height]) = (second, first);
                height += 1;
            } else {
                height -= 1;
                self.clusters[self.count] = stack[height];
                self.count += 1;
            }
        }
    }

    /// Adds a large cluster, and replaces the largest one by its parts while there is room.
    fn open_largest(&mut self, clusters: &Clusters, cluster: usize) {
        /// Area of clusters that are not opened; below all areas.
        const NEVER: f32 = -1.0;
        let area = |index: usize| {
            let cluster = clusters.get(index);
            if cluster.count as usize > WIDTH { cluster.half_area() } else { NEVER }
        };
        let mut areas = [NEVER; WIDTH];
        (self.clusters[0], areas[0], self.count) = (cluster, area(cluster), 1);
        while self.count < WIDTH {
            let larger = |best: usize, place: usize| if areas[place] > areas[best] { place } else { best };
            let largest = (1..self.count).fold(0, larger);
            let parts = clusters.parts(self.clusters[largest]).filter(|_| areas[largest] > NEVER);
            let Some([first, second]) = parts else { break };
            (self.clusters[largest], areas[largest]) = (first, area(first));
            (self.clusters[self.count], areas[self.count]) = (second, area(second));
            self.count += 1;
        }
    }
}
