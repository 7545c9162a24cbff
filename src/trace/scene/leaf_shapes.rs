//! The shapes of the tree in leaf order: the shapes of a node are adjacent.

use rayon::prelude::*;

use super::geometry::{Geometry, ShapeKind, ShapeLocation, ShapeRef};
use crate::trace::bvh::LeafId;
use crate::trace::rays::ShapeId;
use crate::trace::shapes::{AlignedBox, Sphere};

/// The shape of each leaf, with copies of small shapes.
#[derive(Clone, Debug, Default)]
pub(crate) struct LeafShapes {
    leaves: Vec<LeafShape>,
    spheres: Vec<SphereCopy>,
    boxes: Vec<AlignedBox>,
}

/// The id of a shape, and its location: among the copies, or in the geometry if shapes of its kind are not copied.
#[derive(Clone, Copy, Debug)]
struct LeafShape {
    id: ShapeId,
    location: ShapeLocation,
}

/// A sphere, in a single cache line.
#[derive(Clone, Copy, Debug)]
#[repr(align(32))]
struct SphereCopy(Sphere);

impl LeafShapes {
    /// Replaces all leaves by leaves of these shapes.
    pub(super) fn fill(&mut self, geometry: &Geometry, ids: impl IndexedParallelIterator<Item = ShapeId>) {
        let Self { leaves, spheres, boxes } = self;
        ids.map(|id| LeafShape { id, location: geometry.locations[id.index()] }).collect_into_vec(leaves);
        let (mut of_spheres, mut of_boxes) = (Vec::new(), Vec::new());
        for LeafShape { location, .. } in leaves {
            let copied = match location.kind() {
                ShapeKind::Sphere => &mut of_spheres,
                ShapeKind::AlignedBox => &mut of_boxes,
                _ => continue,
            };
            copied.push(*location);
            *location = ShapeLocation::new(location.kind(), copied.len() - 1);
        }
        let sphere = |location: &ShapeLocation| SphereCopy(geometry.spheres[location.index()]);
        of_spheres.par_iter().map(sphere).collect_into_vec(spheres);
        of_boxes.par_iter().map(|location| geometry.boxes[location.index()]).collect_into_vec(boxes);
    }

    /// Copies the shape of a leaf again after it has changed.
    pub(super) fn refresh(&mut self, leaf: LeafId, geometry: &Geometry) {
        let LeafShape { id, location } = self.leaves[leaf.index()];
        match geometry.shape(id) {
            ShapeRef::Sphere(sphere) => self.spheres[location.index()] = SphereCopy(*sphere),
            ShapeRef::AlignedBox(shape) => self.boxes[location.index()] = *shape,
            _ => {}
        }
    }

    /// Returns the ids of the shapes of all leaves, in leaf order.
    pub(crate) fn ids(&self) -> impl ExactSizeIterator<Item = ShapeId> {
        self.leaves.iter().map(|leaf| leaf.id)
    }

    /// Returns the id of a leaf's shape.
    #[inline(always)]
    pub(crate) fn id(&self, leaf: LeafId) -> ShapeId {
        self.leaves[leaf.index()].id
    }

    /// Returns the id of a leaf's shape, and the shape.
    #[inline(always)]
    pub(crate) fn get<'a>(&'a self, leaf: LeafId, geometry: &'a Geometry) -> (ShapeId, ShapeRef<'a>) {
        let LeafShape { id, location } = self.leaves[leaf.index()];
        let shape = match location.kind() {
            ShapeKind::Sphere => ShapeRef::Sphere(&self.spheres[location.index()].0),
            ShapeKind::AlignedBox => ShapeRef::AlignedBox(&self.boxes[location.index()]),
            _ => geometry.shape_at(location),
        };
        (id, shape)
    }
}
