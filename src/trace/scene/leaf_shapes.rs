//! The shapes of the tree in leaf order: the shapes of a node are adjacent.

use rayon::prelude::*;

use super::geometry::{Geometry, ShapeRef};
use crate::trace::bvh::LeafId;
use crate::trace::rays::ShapeId;
use crate::trace::shapes::{AlignedBox, Sphere};

/// The shape of each leaf.
#[derive(Clone, Debug, Default)]
pub(crate) struct LeafShapes(Vec<LeafShape>);

/// A shape and its id, in one cache line.
#[derive(Clone, Copy, Debug)]
#[repr(align(64))]
struct LeafShape {
    id: ShapeId,
    copy: ShapeCopy,
}

/// A copy of a shape, if it is small.
#[derive(Clone, Copy, Debug)]
enum ShapeCopy {
    Sphere(Sphere),
    AlignedBox(AlignedBox),
    Elsewhere,
}

const _: () = assert!(size_of::<LeafShape>() == 64);

impl LeafShape {
    fn new(geometry: &Geometry, id: ShapeId) -> Self {
        let copy = match geometry.shape(id) {
            ShapeRef::Sphere(sphere) => ShapeCopy::Sphere(*sphere),
            ShapeRef::AlignedBox(shape) => ShapeCopy::AlignedBox(*shape),
            _ => ShapeCopy::Elsewhere,
        };
        Self { id, copy }
    }
}

impl LeafShapes {
    /// Replaces all copies by copies of these shapes, given in leaf order.
    pub(super) fn fill(&mut self, geometry: &Geometry, ids: impl IndexedParallelIterator<Item = ShapeId>) {
        ids.map(|id| LeafShape::new(geometry, id)).collect_into_vec(&mut self.0);
    }

    /// Copies the shape of a leaf again after it has changed.
    pub(super) fn refresh(&mut self, leaf: LeafId, geometry: &Geometry) {
        let shape = &mut self.0[leaf.index()];
        *shape = LeafShape::new(geometry, shape.id);
    }

    /// Returns the ids of the shapes of all leaves, in leaf order.
    pub(crate) fn ids(&self) -> impl ExactSizeIterator<Item = ShapeId> {
        self.0.iter().map(|shape| shape.id)
    }

    /// Returns the id of a leaf's shape.
    #[inline(always)]
    pub(crate) fn id(&self, leaf: LeafId) -> ShapeId {
        self.0[leaf.index()].id
    }

    /// Returns the id of a leaf's shape, and the shape.
    #[inline(always)]
    pub(crate) fn get<'a>(&'a self, leaf: LeafId, geometry: &'a Geometry) -> (ShapeId, ShapeRef<'a>) {
        let LeafShape { id, copy } = &self.0[leaf.index()];
        let shape = match copy {
            ShapeCopy::Sphere(sphere) => ShapeRef::Sphere(sphere),
            ShapeCopy::AlignedBox(shape) => ShapeRef::AlignedBox(shape),
            ShapeCopy::Elsewhere => geometry.shape(*id),
        };
        (*id, shape)
    }
}
