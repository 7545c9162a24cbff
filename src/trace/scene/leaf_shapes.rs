//! The shapes of the tree, in the order of its leaves: those of a node lie side by side.

use rayon::prelude::*;

use super::geometry::{Geometry, ShapeRef};
use crate::trace::bvh::LeafId;
use crate::trace::rays::ShapeId;
use crate::trace::shapes::{AlignedBox, Sphere};

/// A leaf's shape, by leaf.
#[derive(Clone, Debug, Default)]
pub(crate) struct LeafShapes(Vec<LeafShape>);

/// A shape, with its id, in one cache line.
#[derive(Clone, Copy, Debug)]
#[repr(align(64))]
struct LeafShape {
    id: ShapeId,
    copy: ShapeCopy,
}

/// A shape, if it is small.
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
            ShapeRef::Plane(_) | ShapeRef::SphereImage(_) | ShapeRef::BoxImage(_) => ShapeCopy::Elsewhere,
        };
        Self { id, copy }
    }
}

impl LeafShapes {
    /// Copies shapes, given in the order of the leaves, in the place of those before.
    pub(super) fn fill(&mut self, geometry: &Geometry, ids: impl IndexedParallelIterator<Item = ShapeId>) {
        ids.map(|id| LeafShape::new(geometry, id)).collect_into_vec(&mut self.0);
    }

    /// Copies the shape of a leaf again, which has changed.
    pub(super) fn refresh(&mut self, leaf: LeafId, geometry: &Geometry) {
        let shape = &mut self.0[leaf.index()];
        *shape = LeafShape::new(geometry, shape.id);
    }

    /// Returns the shapes of all leaves, in their order.
    pub(crate) fn ids(&self) -> impl ExactSizeIterator<Item = ShapeId> {
        self.0.iter().map(|shape| shape.id)
    }

    /// Returns what the shape of a leaf is called.
    #[inline(always)]
    pub(crate) fn id(&self, leaf: LeafId) -> ShapeId {
        self.0[leaf.index()].id
    }

    /// Returns the shape of a leaf, and what it is called.
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
