//! Refinement of hits of spheres, planes and axis-aligned boxes in world space.

use fearless_simd::prelude::*;

use super::points::{Points, RefineInput};
use super::shapes::Shapes;
use crate::trace::math::{Compensated, Double, F64s3, moderate, moderate3, quick_two_sum, splat, times};
use crate::trace::shapes::{RefinedStep, U, stepped, stepped_to_plane, unit};

/// Refines hits of spheres: `Sphere::refine`.
#[inline(always)]
pub(super) fn spheres<S: Simd>(
    simd: S,
    inexact: &RefineInput<S>,
    shapes: &impl Shapes,
    half: usize,
) -> Points<S> {
    let RefineInput { origin, direction, t } = *inexact;
    let sphere = (shapes.places(simd, half), shapes.radii(simd, half));
    let RefinedStep { t, from_shape, point, outwards } = stepped(sphere, (origin, direction), t);
    let (normal, is_one) = unit(outwards);
    let found = shapes.moderate(simd, half) & moderate3(simd, from_shape) & is_one;
    Points { t: t.high, rest: t.low, point, normal, found }
}

/// Refines hits of planes: `Plane::refine`.
#[inline(always)]
pub(super) fn planes<S: Simd>(
    simd: S,
    inexact: &RefineInput<S>,
    shapes: &impl Shapes,
    half: usize,
) -> Points<S> {
    let RefineInput { origin, direction, t } = *inexact;
    let plane = (shapes.places(simd, half), shapes.others(simd, half));
    let RefinedStep { t, from_shape, point, .. } = stepped_to_plane(plane, (origin, direction), t);
    let found = shapes.moderate(simd, half) & moderate3(simd, from_shape);
    Points { t: t.high, rest: t.low, point, normal: shapes.units(simd, half), found }
}

/// Refines hits of boxes: `AlignedBox::refine`.
#[inline(always)]
pub(super) fn boxes<S: Simd>(
    simd: S,
    inexact: &RefineInput<S>,
    shapes: &impl Shapes,
    half: usize,
) -> Points<S> {
    /// Minimum speed: quotients of smaller numbers can lose digits.
    const TINY: f64 = 1e-140;
    let RefineInput { origin, direction, t } = *inexact;
    let (min, max) = (shapes.places(simd, half), shapes.others(simd, half));
    // Finds the only face whose plane contains the ray's point at `t`.
    let none = t.simd_lt(t);
    let (mut lower, mut upper) = ([none; 3], [none; 3]);
    let (mut once, mut twice) = (none, none);
    for axis in 0..3 {
        let way = direction[axis] * t;
        for (near, planes) in [(&mut lower, min), (&mut upper, max)] {
            let to_plane = planes[axis] - origin[axis];
            let size = to_plane.abs() + way.abs();
            near[axis] = (to_plane - way).abs().simd_le(size * (16.0 * U));
            twice |= once & near[axis];
            once |= near[axis];
        }
    }
    let at = [lower[0] | upper[0], lower[1] | upper[1], lower[2] | upper[2]];
    let is_upper = upper[0] | upper[1] | upper[2];
    let pick = |[x, y, z]: F64s3<S>| at[0].select(x, at[1].select(y, z));
    let face = is_upper.select(pick(max), pick(min));
    let (from, speed) = (pick(origin), pick(direction));
    let found = once & !twice & speed.abs().simd_gt(splat(simd, TINY));
    // Divides the distance to the face by the speed, in double-double.
    let ahead = Double::difference(face, from);
    let first = ahead.high / speed;
    let found = found & moderate(simd, first);
    let zero = splat(simd, 0.0);
    let left = ahead - Double { high: speed, low: zero } * first;
    let (t, rest) = quick_two_sum(first, left.high / speed);
    let place = Compensated::along(origin, direction, t).moved(times(direction, rest));
    // `place` is computed from this `t` instead of the approximate one.
    let found = found & moderate(simd, t);
    let one = splat(simd, 1.0);
    let sign = is_upper.select(one, -one);
    let (mut point, mut normal) = (place, place);
    for axis in 0..3 {
        let clamped = place[axis].simd_gt(min[axis]).select(place[axis], min[axis]);
        let clamped = clamped.simd_lt(max[axis]).select(clamped, max[axis]);
        point[axis] = at[axis].select(face, clamped);
        normal[axis] = at[axis].select(sign, zero);
    }
    Points { t, rest, point, normal, found }
}
