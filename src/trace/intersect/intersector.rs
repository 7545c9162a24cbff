//! Intersection of rays with a shape of any kind: of single rays, robustly or by naive formulas, and of packets.
//!
//! Formulas of packets that are long and rarely executed have functions of their own, which are never inlined. The body of `simd.vectorize` in
//! such a function is compiled once for each SIMD level; elsewhere it would be compiled again for each module that calls it.

use std::cmp::Ordering;
use std::ops::AddAssign;

use fearless_simd::prelude::*;

use super::hit::ShapeHit;
use super::naive::Naive;
use super::reciprocals::Reciprocals;
use crate::trace::bvh::LeafId;
use crate::trace::math::{BoundedT, F64s, half_of, mask};
use crate::trace::rays::{PreparedRay, RayPacket, RayView, Rays, ShadowLimit, ShapeId};
use crate::trace::scene::{Geometry, PreparedScene, ShapeRef};
use crate::trace::shapes::{Intersections, RefinedHit};

/// Counts cases in which `f64` did not suffice. The picture is correct however large these numbers are.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct Escalations {
    /// Hits left undecided by the error bounds of `f64`, decided exactly.
    pub ambiguous: u64,
    /// Comparisons of two hits, or of a hit and the light, decided exactly.
    pub contested: u64,
    /// Points whose distance had too few certain bits for a single Newton step to make it accurate.
    pub rough: u64,
    /// Pixels whose sum overflowed and was clamped to a finite value.
    pub overflowed: u64,
}

impl Escalations {
    /// Returns the number of decisions and points that needed more than `f64`, of all kinds.
    #[must_use]
    pub fn total(&self) -> u64 {
        self.ambiguous + self.contested + self.rough
    }
}

impl AddAssign for Escalations {
    fn add_assign(&mut self, other: Self) {
        self.ambiguous += other.ambiguous;
        self.contested += other.contested;
        self.rough += other.rough;
        self.overflowed += other.overflowed;
    }
}

/// Intersects rays with shapes, and counts escalations.
#[derive(Clone, Debug, Default)]
pub(crate) struct Intersector<'a> {
    /// The shapes of a scene in a naive number type, which replace those of its geometry.
    naive: Option<&'a Naive>,
    pub(crate) escalations: Escalations,
}

impl<'a> Intersector<'a> {
    /// Creates an intersector: robust, unless there are naive shapes.
    pub(crate) fn new(naive: Option<&'a Naive>) -> Self {
        Self { naive, escalations: Escalations::default() }
    }

    /// Returns the first hit of the ray with the shape.
    #[inline(always)]
    pub(crate) fn intersect(
        &mut self,
        geometry: &Geometry,
        id: ShapeId,
        ray: &RayView<'_>,
    ) -> Option<ShapeHit> {
        match self.naive {
            None => geometry.intersect(id, ray, &mut self.escalations),
            Some(naive) => naive.intersect(id, ray),
        }
    }

    /// Returns the exit of the ray from the shape, if that is a box or a rod. The ray must hit it. `None` with naive shapes, which have no
    /// exact hits.
    pub(super) fn solid_exit(
        &mut self,
        geometry: &Geometry,
        id: ShapeId,
        ray: &PreparedRay,
    ) -> Option<ShapeHit> {
        let is_round =
            matches!(geometry.shape(id), ShapeRef::Sphere(_) | ShapeRef::SphereImage(_) | ShapeRef::Plane(_));
        (!is_round && self.naive.is_none()).then(|| geometry.exit(id, ray, &mut self.escalations))?
    }

    /// Compares the distances of two hits of a ray.
    #[inline(always)]
    pub(crate) fn compare(
        &mut self,
        geometry: &Geometry,
        ray: &PreparedRay,
        hit: &ShapeHit,
        other: &ShapeHit,
    ) -> Ordering {
        match self.naive {
            None => geometry.compare(ray, hit, other, &mut self.escalations),
            Some(_) => hit.root.t().total_cmp(&other.root.t()),
        }
    }

    /// Returns whether the hit is nearer than `limit`.
    #[inline(always)]
    pub(crate) fn is_before(
        &mut self,
        geometry: &Geometry,
        hit: &ShapeHit,
        ray: &PreparedRay,
        limit: &ShadowLimit,
    ) -> bool {
        match self.naive {
            None => geometry.is_before(hit, ray, limit, &mut self.escalations),
            Some(_) => hit.root.t() < limit.t(),
        }
    }

    /// Returns whether the shape occludes the ray before `limit`.
    #[inline]
    pub(crate) fn occludes(
        &mut self,
        geometry: &Geometry,
        id: ShapeId,
        ray: &RayView<'_>,
        limit: &ShadowLimit,
    ) -> bool {
        self.intersect(geometry, id, ray).is_some_and(|hit| self.is_before(geometry, &hit, ray, limit))
    }

    /// Computes the accurate `t`, point and normal of a hit.
    #[inline(always)]
    pub(crate) fn refine(&mut self, geometry: &Geometry, ray: &PreparedRay, hit: &ShapeHit) -> RefinedHit {
        match self.naive {
            None => geometry.refine(ray, hit, &mut self.escalations),
            Some(naive) => naive.refine(ray, hit),
        }
    }

    /// Returns the number of times that the ray crosses the shape's surface before `limit`, if a fast count is certain.
    #[inline]
    pub(crate) fn certain_crossings(
        &self,
        geometry: &Geometry,
        id: ShapeId,
        ray: &RayView<'_>,
        limit: &ShadowLimit,
    ) -> Option<u32> {
        if self.naive.is_some() { None } else { geometry.certain_crossings(id, ray, limit) }
    }
}

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
        active: u32,
    ) -> Option<PacketHit<S>> {
        let departing = self.rays.departing & active;
        // Rays do not hit the shape that they leave, except for its far side if they leave it inwards.
        let leaving = if departing == 0 { 0 } else { self.rays.left.lanes_of(simd, shape.id) & departing };
        let near = active & !leaving;
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
            _ => near_image(simd, &rays, shape),
        }
    }
}

/// Intersects half of a packet's rays with a rod or with an image of a shape, which they do not leave.
#[inline(never)]
fn near_image<S: Simd>(simd: S, rays: &Rays<F64s<S>>, shape: ShapeRef<'_>) -> Option<PacketIntersection<S>> {
    simd.vectorize(
        #[inline(always)]
        || match shape {
            ShapeRef::SphereImage(image) => image.intersections(rays),
            ShapeRef::BoxImage(image) => Some(image.intersections(rays)),
            ShapeRef::Rod(rod) => rod.intersections(rays),
            ShapeRef::RodImage(image) => image.intersections(rays),
            ShapeRef::Sphere(_) | ShapeRef::Plane(_) | ShapeRef::AlignedBox(_) => None,
        },
    )
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
        _ => exit_of_image(simd, rays, shape),
    }
}

/// Finds the exits of half of a packet's rays from a rod or from an image of a shape, which they leave inwards.
#[inline(never)]
fn exit_of_image<S: Simd>(
    simd: S,
    rays: &Rays<F64s<S>>,
    shape: ShapeRef<'_>,
) -> Option<PacketIntersection<S>> {
    simd.vectorize(
        #[inline(always)]
        || match shape {
            ShapeRef::SphereImage(image) => Some(image.exits(rays)),
            ShapeRef::BoxImage(image) => Some(image.exits(rays)),
            ShapeRef::Rod(rod) => Some(rod.exits(rays)),
            ShapeRef::RodImage(image) => Some(image.exits(rays)),
            ShapeRef::Sphere(_) | ShapeRef::Plane(_) | ShapeRef::AlignedBox(_) => None,
        },
    )
}
