//! Intersection of a packet with a shape of any kind, by the shapes' own formulas. Long, rarely executed ones are wrapped in `simd.vectorize`,
//! which makes them separate functions for each SIMD level unless the compiler inlines them.

use fearless_simd::prelude::*;

use super::reciprocals::Reciprocals;
use crate::trace::bvh::LeafId;
use crate::trace::math::{BoundedT, F64s, half_of, mask};
use crate::trace::rays::{RayPacket, Rays, ShapeId};
use crate::trace::scene::{PreparedScene, ShapeRef};
use crate::trace::shapes::Intersections;

/// The intersection of half a packet with a shape.
pub(super) type PacketIntersection<S> = Intersections<F64s<S>>;

/// A packet's rays, with their reciprocals.
pub(super) struct PacketIntersector<'a> {
    pub(super) rays: &'a RayPacket,
    pub(super) reciprocals: &'a mut Reciprocals,
}

/// A shape and its id.
#[derive(Clone, Copy)]
pub(super) struct ShapeQuery<'a> {
    pub(super) id: ShapeId,
    pub(super) shape: ShapeRef<'a>,
}

/// The intersection of half a packet with a shape. `far` is a bit mask of the lanes that hit the far side of a shape which their rays leave
/// inwards.
pub(super) struct PacketHit<S: Simd> {
    pub(super) intersection: PacketIntersection<S>,
    pub(super) far: u32,
}

impl<'a> ShapeQuery<'a> {
    /// Looks up a shape by its id.
    #[inline(always)]
    pub(super) fn by_id(scene: &'a PreparedScene, id: ShapeId) -> Self {
        Self { id, shape: scene.geometry.shape(id) }
    }

    /// Looks up a shape of the tree.
    #[inline(always)]
    pub(super) fn leaf(scene: &'a PreparedScene, leaf: LeafId) -> Self {
        let (id, shape) = scene.leaves.get(leaf, &scene.geometry);
        Self { id, shape }
    }
}

impl PacketIntersector<'_> {
    /// Intersects the rays in some lanes of a half with a shape, like `Geometry::intersect` for rays that leave at most one shape. `None` if
    /// all of them certainly miss it.
    #[inline(always)]
    pub(super) fn intersect<S: Simd>(
        &mut self,
        simd: S,
        shape: ShapeQuery<'_>,
        half: usize,
        asked: u32,
    ) -> Option<PacketHit<S>> {
        let departing = self.rays.departing & asked;
        // Rays do not hit the shape that they leave, except for its far side if they leave it inwards.
        let leaving = if departing == 0 { 0 } else { self.rays.left.lanes_of(simd, shape.id) & departing };
        let near = asked & !leaving;
        let mut intersection = None;
        if half_of(near, half) != 0
            && let Some(mut found) = self.near(simd, shape.shape, half)
        {
            let near = mask(simd, near, half);
            found.hit &= near;
            found.undecided &= near;
            intersection = Some(found);
        }
        let inward = leaving & !self.rays.outward;
        let exit = if half_of(inward, half) == 0 {
            None
        } else {
            exit(simd, &self.rays.load(simd, half), shape.shape)
        };
        let Some(exit) = exit else {
            let intersection = intersection?;
            return Some(PacketHit { intersection, far: 0 });
        };
        let lanes = mask(simd, inward, half);
        let (hit, undecided) = (exit.hit & lanes, exit.undecided & lanes);
        let intersection = match intersection {
            None => PacketIntersection { hit, undecided, ..exit },
            Some(near) => PacketIntersection {
                root: BoundedT::pick(lanes, exit.root, near.root),
                hit: hit | near.hit,
                undecided: undecided | near.undecided,
            },
        };
        Some(PacketHit { intersection, far: inward })
    }

    /// Intersects half of the rays with a shape that they do not leave.
    #[inline(always)]
    fn near<S: Simd>(&mut self, simd: S, shape: ShapeRef<'_>, half: usize) -> Option<PacketIntersection<S>> {
        let rays = self.rays.load(simd, half);
        match shape {
            ShapeRef::Sphere(sphere) => {
                let inverse_square = self.reciprocals.of_squares(simd, self.rays, half);
                sphere.intersections(&rays, inverse_square)
            }
            ShapeRef::Plane(plane) => Some(plane.intersections(&rays)),
            ShapeRef::AlignedBox(shape) => {
                let (inverse, slow) = self.reciprocals.of_directions(simd, self.rays, half);
                let mut intersection = shape.intersections(rays.origin, inverse);
                // Reciprocals of slow rays may not be finite.
                let slow = mask(simd, slow, half);
                intersection.hit &= !slow;
                intersection.undecided |= slow;
                Some(intersection)
            }
            ShapeRef::SphereImage(image) => simd.vectorize(
                #[inline(always)]
                || image.intersections(&rays),
            ),
            ShapeRef::BoxImage(image) => Some(simd.vectorize(
                #[inline(always)]
                || image.intersections(&rays),
            )),
        }
    }
}

/// Finds the exits of half of a packet's rays from a shape that they leave inwards. `None` if the shape has no exit.
#[inline(always)]
pub(super) fn exit<S: Simd>(
    simd: S,
    rays: &Rays<F64s<S>>,
    shape: ShapeRef<'_>,
) -> Option<PacketIntersection<S>> {
    match shape {
        ShapeRef::Sphere(sphere) => Some(sphere.exits(rays)),
        ShapeRef::Plane(_) => None,
        ShapeRef::AlignedBox(shape) => Some(shape.exits(rays)),
        ShapeRef::SphereImage(image) => Some(simd.vectorize(
            #[inline(always)]
            || image.exits(rays),
        )),
        ShapeRef::BoxImage(image) => Some(simd.vectorize(
            #[inline(always)]
            || image.exits(rays),
        )),
    }
}
