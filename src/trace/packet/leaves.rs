//! One shape against half of a packet's rays: the operations of the scalar code, in their order.

use fearless_simd::{f64x8, mask64x8, prelude::*};
use glam::DVec3;

use super::rays::{F64s, Packet, Verdicts, load};
use crate::trace::shapes::{AlignedBox, Bounds, Plane, Sphere, U};

/// Where rays meet a sphere: `first_root` of [`Sphere::intersect`]. `None` where all of them certainly miss it.
#[inline(always)]
pub(super) fn sphere<S: Simd>(
    simd: S,
    origin: DVec3,
    sphere: &Sphere,
    packet: &Packet,
    half: usize,
) -> Option<Verdicts<S>> {
    let splat = f64x8::splat;
    let direction = directions(simd, packet, half);
    let to_center = sphere.center - origin;
    let squared_radius = sphere.radius * sphere.radius;
    let squared_distance = to_center.dot(to_center);
    let [x, y, z] = to_center.to_array().map(|number: f64| f64x8::splat(simd, number));
    let inverse_square = load(simd, &packet.inverse_square[half]);

    let b = dot([x, y, z], direction);
    let projection = b * inverse_square;
    let nearest =
        [x - direction[0] * projection, y - direction[1] * projection, z - direction[2] * projection];
    let q = splat(simd, squared_radius) - dot(nearest, nearest);
    let q_error = splat(simd, 32.0 * U) * (b * projection + splat(simd, squared_radius));
    let maybe = !q.simd_lt(-q_error);
    if !maybe.any_true() {
        return None;
    }
    let zero = splat(simd, 0.0);
    let root = (dot(direction, direction) * q).sqrt();
    let s = b + root.copysign(b);
    let error = splat(simd, 64.0 * U * (squared_distance + squared_radius)) / root;
    let clear = q.simd_gt(splat(simd, 1024.0) * q_error);
    let one = splat(simd, squared_distance - squared_radius) / s;
    let ahead = clear & s.simd_gt(zero) & one.simd_gt(error);
    let other = s * inverse_square;
    let ordered = one.simd_lt(other);
    let (near, far) = (ordered.select(one, other), ordered.select(other, one));
    let near_ahead = clear & (near - error).simd_gt(zero);
    let near_behind = clear & (near + error).simd_lt(zero);
    let far_ahead = near_behind & (far - error).simd_gt(zero);
    let far_behind = near_behind & (far + error).simd_lt(zero);
    let t = ahead.select(one, near_ahead.select(near, far));
    let hit = maybe & (ahead | near_ahead | far_ahead);
    Some(Verdicts { t, error, hit, open: maybe & !hit & !far_behind })
}

/// Where rays meet a box: [`AlignedBox::intersect`], for rays that are not slow.
#[inline(always)]
pub(super) fn aligned_box<S: Simd>(
    simd: S,
    origin: DVec3,
    shape: &AlignedBox,
    packet: &Packet,
    half: usize,
) -> Verdicts<S> {
    let splat = f64x8::splat;
    let zero = splat(simd, 0.0);
    let Slabs { entry, exit, close } = slabs(simd, origin, (shape.min, shape.max), packet, half);
    let maybe = !(exit.simd_lt(zero) | entry.simd_gt(exit + close));
    let open = maybe & entry.simd_gt(exit - close);
    let t = entry.simd_ge(zero).select(entry, exit) + zero;
    Verdicts { t, error: splat(simd, 4.0 * U) * t, hit: maybe & !open, open }
}

/// Which rays, that are not slow, may meet what is within bounds before what they have met so far.
#[inline(always)]
pub(super) fn may_meet<S: Simd>(
    simd: S,
    origin: DVec3,
    bounds: &Bounds,
    packet: &Packet,
    half: usize,
) -> mask64x8<S> {
    let Slabs { entry, exit, close } = slabs(simd, origin, (bounds.min, bounds.max), packet, half);
    let missed = exit.simd_lt(f64x8::splat(simd, 0.0)) | entry.simd_gt(exit + close);
    !missed & !(entry - close).simd_gt(packet.latest(simd, half))
}

/// Where rays enter and leave what a box's three slabs have in common.
struct Slabs<S: Simd> {
    entry: F64s<S>,
    exit: F64s<S>,
    /// More than both may be off by.
    close: F64s<S>,
}

#[inline(always)]
fn slabs<S: Simd>(
    simd: S,
    origin: DVec3,
    (min, max): (DVec3, DVec3),
    packet: &Packet,
    half: usize,
) -> Slabs<S> {
    let splat = f64x8::splat;
    let (to_min, to_max) = (min - origin, max - origin);
    let mut entry = splat(simd, f64::NEG_INFINITY);
    let mut exit = splat(simd, f64::INFINITY);
    for axis in 0..3 {
        let inverse = load(simd, &packet.inverse[axis][half]);
        let at_min = splat(simd, to_min[axis]) * inverse;
        let at_max = splat(simd, to_max[axis]) * inverse;
        let ordered = at_min.simd_lt(at_max);
        let (near, far) = (ordered.select(at_min, at_max), ordered.select(at_max, at_min));
        entry = near.simd_gt(entry).select(near, entry);
        exit = far.simd_lt(exit).select(far, exit);
    }
    let (entry_size, exit_size) = (entry.abs(), exit.abs());
    let size = entry_size.simd_gt(exit_size).select(entry_size, exit_size);
    Slabs { entry, exit, close: splat(simd, 8.0 * U) * size }
}

/// Where rays meet a plane: [`Plane::intersect`].
#[inline(always)]
pub(super) fn plane<S: Simd>(
    simd: S,
    origin: DVec3,
    plane: &Plane,
    packet: &Packet,
    half: usize,
) -> Verdicts<S> {
    let splat = f64x8::splat;
    let direction = directions(simd, packet, half);
    let (to_plane, normal) = (plane.point() - origin, plane.normal());
    let size = normal.abs();
    let height = to_plane.dot(normal);
    let height_error = 6.0 * U * to_plane.abs().dot(size);
    let [x, y, z] = normal.to_array().map(|number: f64| f64x8::splat(simd, number));
    let speed = dot(direction, [x, y, z]);
    let [x, y, z] = size.to_array().map(|number: f64| f64x8::splat(simd, number));
    let speeds = [direction[0].abs(), direction[1].abs(), direction[2].abs()];
    let speed_error = splat(simd, 4.0 * U) * dot(speeds, [x, y, z]);
    let inverse = splat(simd, 1.0) / speed;
    let t = splat(simd, height) * inverse;
    let error =
        (splat(simd, height_error) + t.abs() * speed_error) * inverse.abs() + splat(simd, 4.0 * U) * t.abs();
    let certain = speed.abs().simd_gt(splat(simd, 1024.0) * speed_error);
    let hit = certain & t.simd_gt(error);
    let miss = certain & t.simd_lt(-error);
    Verdicts { t, error, hit, open: !hit & !miss }
}

#[inline(always)]
fn directions<S: Simd>(simd: S, packet: &Packet, half: usize) -> [F64s<S>; 3] {
    let [x, y, z] = &packet.direction;
    [load(simd, &x[half]), load(simd, &y[half]), load(simd, &z[half])]
}

/// In glam's order.
#[inline(always)]
fn dot<S: Simd>(a: [F64s<S>; 3], b: [F64s<S>; 3]) -> F64s<S> {
    a[0] * b[0] + a[1] * b[1] + a[2] * b[2]
}
