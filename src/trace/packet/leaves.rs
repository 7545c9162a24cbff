//! Intersection of half a packet with one shape: the scalar code's operations in the same order, so that every `t` and every error bound has
//! the same bits. Long, rarely executed code is wrapped in `simd.vectorize`, which makes it a separate function for each SIMD level unless the
//! compiler inlines it.

use fearless_simd::prelude::*;
use glam::DMat3;

use crate::trace::math::{F64s, F64s3, add, dot, splat, splat3, subtract, times};
use crate::trace::rays::RayPacket;
use crate::trace::shapes::{
    AlignedBox, Plane, Sphere, SphereImage, U, Verdict, far_root, first_root, only_root,
};

/// Half of a packet's rays.
#[derive(Clone, Copy)]
pub(super) struct HalfRays<S: Simd> {
    pub(super) origin: F64s3<S>,
    pub(super) direction: F64s3<S>,
}

/// The intersection of half a packet with a shape.
pub(super) type PacketIntersection<S> = Verdict<F64s<S>>;

impl<S: Simd> HalfRays<S> {
    #[inline(always)]
    pub(super) fn load(simd: S, packet: &RayPacket, half: usize) -> Self {
        Self { origin: packet.origins.load(simd, half), direction: packet.directions.load(simd, half) }
    }
}

/// Intersects rays with a sphere: [`Sphere::intersect`]. `None` if all rays certainly miss it. `inverse_square` is 1 / direction.direction.
#[inline(always)]
pub(super) fn sphere<S: Simd>(
    simd: S,
    rays: &HalfRays<S>,
    inverse_square: F64s<S>,
    sphere: &Sphere,
) -> Option<PacketIntersection<S>> {
    let to_center = subtract(splat3(simd, sphere.center), rays.origin);
    first_root(to_center, (rays.direction, inverse_square), sphere.radius, U)
}

/// Intersects rays with an ellipsoid: [`SphereImage::intersect`]. `None` if all rays certainly miss it.
#[inline(always)]
pub(super) fn sphere_image<S: Simd>(
    simd: S,
    rays: &HalfRays<S>,
    image: &SphereImage,
) -> Option<PacketIntersection<S>> {
    simd.vectorize(
        #[inline(always)]
        || {
            let (to_center, direction) = taken_back(simd, rays, image);
            let inverse_square = splat(simd, 1.0) / dot(direction, direction);
            first_root(to_center, (direction, inverse_square), image.radius(), U * image.roughness())
        },
    )
}

/// Transforms rays to the space of an ellipsoid's sphere. Returns the vectors from their origins to the centre, and their directions.
#[inline(always)]
fn taken_back<S: Simd>(simd: S, rays: &HalfRays<S>, image: &SphereImage) -> (F64s3<S>, F64s3<S>) {
    let (translation, inverse) = image.back();
    let [x, y, z] = image_of(simd, inverse, subtract(rays.origin, splat3(simd, translation)));
    ([-x, -y, -z], image_of(simd, inverse, rays.direction))
}

/// Multiplies a matrix by vectors.
#[inline(always)]
pub(super) fn image_of<S: Simd>(simd: S, matrix: &DMat3, [x, y, z]: F64s3<S>) -> F64s3<S> {
    let DMat3 { x_axis, y_axis, z_axis } = *matrix;
    let sum = add(times(splat3(simd, x_axis), x), times(splat3(simd, y_axis), y));
    add(sum, times(splat3(simd, z_axis), z))
}

/// Finds the exits of rays from a sphere that they leave inwards: [`Sphere::exit`].
#[inline(always)]
pub(super) fn sphere_exit<S: Simd>(simd: S, rays: &HalfRays<S>, sphere: &Sphere) -> PacketIntersection<S> {
    let to_center = subtract(splat3(simd, sphere.center), rays.origin);
    far_root(to_center, rays.direction, sphere.radius, U)
}

/// Finds the exits of rays from an ellipsoid that they leave inwards: [`SphereImage::exit`].
#[inline(always)]
pub(super) fn sphere_image_exit<S: Simd>(
    simd: S,
    rays: &HalfRays<S>,
    image: &SphereImage,
) -> PacketIntersection<S> {
    simd.vectorize(
        #[inline(always)]
        || {
            let (to_center, direction) = taken_back(simd, rays, image);
            far_root(to_center, direction, image.radius(), U * image.roughness())
        },
    )
}

/// Intersects rays with a box: [`AlignedBox::intersect`], for rays whose reciprocals are finite.
#[inline(always)]
pub(super) fn aligned_box<S: Simd>(
    simd: S,
    origin: F64s3<S>,
    inverse: F64s3<S>,
    shape: &AlignedBox,
) -> PacketIntersection<S> {
    let zero = splat(simd, 0.0);
    let mut entry = splat(simd, f64::NEG_INFINITY);
    let mut exit = splat(simd, f64::INFINITY);
    for axis in 0..3 {
        let at_min = (splat(simd, shape.min[axis]) - origin[axis]) * inverse[axis];
        let at_max = (splat(simd, shape.max[axis]) - origin[axis]) * inverse[axis];
        entry = at_min.min(at_max).max(entry);
        exit = at_min.max(at_max).min(exit);
    }
    let close = entry.abs().max(exit.abs()) * (8.0 * U);
    let maybe = !(exit.simd_lt(zero) | entry.simd_gt(exit + close));
    let open = maybe & entry.simd_gt(exit - close);
    // Adding zero makes a negative zero positive.
    let t = entry.simd_ge(zero).select(entry, exit) + zero;
    PacketIntersection { t, error: t * (4.0 * U), hit: maybe & !open, open }
}

/// Finds the exits of rays from a box that they leave inwards: [`AlignedBox::exit`].
#[inline(always)]
pub(super) fn box_exit<S: Simd>(simd: S, rays: &HalfRays<S>, shape: &AlignedBox) -> PacketIntersection<S> {
    let zero = splat(simd, 0.0);
    let (min, max) = (splat3(simd, shape.min), splat3(simd, shape.max));
    let mut nearest = splat(simd, f64::INFINITY);
    for axis in 0..3 {
        let speed = rays.direction[axis];
        let face = speed.simd_gt(zero).select(max[axis], min[axis]);
        let t = (face - rays.origin[axis]) / speed;
        nearest = (!speed.simd_eq(zero) & t.simd_lt(nearest)).select(t, nearest);
    }
    // The scalar code determines the sign of a zero.
    let open = nearest.simd_eq(zero);
    let t = nearest.simd_gt(zero).select(nearest, zero);
    PacketIntersection { t, error: t * (4.0 * U), hit: !open, open }
}

/// Intersects rays with a plane: [`Plane::intersect`].
#[inline(always)]
pub(super) fn plane<S: Simd>(simd: S, rays: &HalfRays<S>, plane: &Plane) -> PacketIntersection<S> {
    let plane = (splat3(simd, plane.point()), splat3(simd, plane.normal()));
    only_root(plane, (rays.origin, rays.direction))
}
