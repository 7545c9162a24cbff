//! Bottom-up construction of a binary tree over boxes.
//!
//! After Meister and Bittner, "Parallel Locally-Ordered Clustering for Bounding Volume Hierarchy Construction" (2018), with the smallest
//! search radius: in each pass, two neighbours on a space-filling curve merge if each is nearer to the other than to its other neighbour,
//! until one cluster is left. This tree is the cheapest to build, and traces as fast as the most expensive one once its lower levels are
//! collapsed into leaves.

use glam::Vec3A;

use crate::trace::bvh::frame::FrameBox;
use crate::trace::bvh::node::to_u32;

/// A binary tree over boxes. The boxes are the first clusters, and the root is the last.
#[derive(Debug, Default)]
pub(super) struct Clusters {
    clusters: Vec<Cluster>,
    /// Number of clusters that are boxes.
    boxes: usize,
    /// Clusters without a parent so far, along the curve.
    roots: Vec<(Aabb, u32)>,
    /// Distances between adjacent roots: half the surface area of the box around both, at the index of the second; infinity at both ends.
    distances: Vec<f32>,
}

/// A box, or a pair of clusters.
#[derive(Clone, Copy, Debug)]
pub(super) struct Cluster {
    bounds: Aabb,
    /// Number of boxes in the cluster.
    pub(super) count: u32,
    parts: [u32; 2],
}

/// A [`FrameBox`] in registers.
#[derive(Clone, Copy, Debug)]
struct Aabb {
    min: Vec3A,
    max: Vec3A,
}

impl Cluster {
    /// Returns the bounds of the cluster.
    pub(super) fn bounds(&self) -> FrameBox {
        FrameBox { min: self.bounds.min.to_array(), max: self.bounds.max.to_array() }
    }

    /// Returns half the surface area of its bounds.
    pub(super) fn half_area(&self) -> f32 {
        self.bounds.half_area()
    }
}

impl Clusters {
    /// Builds a tree over these boxes, at least one, given in the order of the curve.
    pub(super) fn build<'a>(&mut self, boxes: impl Iterator<Item = &'a FrameBox>) {
        let Self { clusters, roots, .. } = self;
        clusters.clear();
        clusters.extend(boxes.map(|bounds| Cluster { bounds: Aabb::of(bounds), count: 1, parts: [0; 2] }));
        roots.clear();
        roots.extend((0..).zip(&*clusters).map(|(index, cluster)| (cluster.bounds, index)));
        self.boxes = clusters.len();
        while self.roots.len() > 1 {
            self.measure();
            self.merge();
        }
    }

    /// Returns the index of the root.
    pub(super) fn root(&self) -> usize {
        self.clusters.len() - 1
    }

    /// Returns the cluster with this index.
    pub(super) fn get(&self, index: usize) -> &Cluster {
        &self.clusters[index]
    }

    /// Returns the two parts of a cluster; `None` if it is a box.
    pub(super) fn parts(&self, index: usize) -> Option<[usize; 2]> {
        (index >= self.boxes).then(|| self.clusters[index].parts.map(|part| part as usize))
    }

    fn measure(&mut self) {
        /// Number of roots per pair that should merge in a pass.
        const FEW: usize = 16;
        let Self { roots, distances, .. } = self;
        distances.clear();
        distances.push(f32::INFINITY);
        distances.extend(roots.windows(2).map(|pair| pair[0].0.union(&pair[1].0).half_area()));
        distances.push(f32::INFINITY);
        let pairs = (1..roots.len()).filter(|place| merge(distances, *place)).count();
        if pairs * FEW < roots.len() {
            // If distances decrease along the curve, as for nested shapes, one pair would merge per pass. With equal distances, all roots
            // pair off.
            distances.fill(0.0);
        }
    }

    fn merge(&mut self) {
        let Self { clusters, roots, distances, .. } = self;
        let (mut kept, mut next) = (0, 0);
        while next < roots.len() {
            let (bounds, first) = roots[next];
            next += 1;
            roots[kept] = if next < roots.len() && merge(distances, next) {
                let (other, second) = roots[next];
                next += 1;
                let bounds = bounds.union(&other);
                let count = clusters[first as usize].count + clusters[second as usize].count;
                clusters.push(Cluster { bounds, count, parts: [first, second] });
                (bounds, to_u32(clusters.len() - 1))
            } else {
                (bounds, first)
            };
            kept += 1;
        }
        roots.truncate(kept);
    }
}

/// Returns whether the root at `place` and its predecessor are nearest to each other. Roots at equal distances, as in a row, pair off.
#[inline(always)]
fn merge(distances: &[f32], place: usize) -> bool {
    let [before, between, after] = [distances[place - 1], distances[place], distances[place + 1]];
    let odd = place % 2 == 1;
    (between < before || odd && between == before) && (between < after || odd && between == after)
}

impl Aabb {
    #[inline(always)]
    fn of(bounds: &FrameBox) -> Self {
        Self { min: bounds.min.into(), max: bounds.max.into() }
    }

    #[inline(always)]
    fn union(&self, other: &Self) -> Self {
        Self { min: self.min.min(other.min), max: self.max.max(other.max) }
    }

    #[inline(always)]
    fn half_area(&self) -> f32 {
        let edges = self.max - self.min;
        edges.dot(Vec3A::new(edges.y, edges.z, edges.x))
    }
}
