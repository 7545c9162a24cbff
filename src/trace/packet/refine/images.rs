//! Refinement of hits of spheres and boxes under affine maps.

use fearless_simd::prelude::*;
use glam::DVec3;

use super::points::{Points, RefineInput};
use crate::trace::math::{
    Compensated, Double, F64s3, Mask, dot, moderate, moderate3, select3, splat, splat3, times, two_sum,
};
use crate::trace::packet::leaves::{HalfRays, image_of};
use crate::trace::packet::slabs::{FaceLanes, SlabRoots};
use crate::trace::scene::ShapeRef;
use crate::trace::shapes::{BoxImage, SphereImage, newton_step, sphere_step, unit};

/// Refines hits of an image; `None` for other shapes. `far` is true in lanes whose rays come from inside.
#[inline(always)]
pub(super) fn refine<S: Simd>(
    simd: S,
    inexact: &RefineInput<S>,
    shape: ShapeRef<'_>,
    far: Mask<S>,
) -> Option<Points<S>> {
    match shape {
        ShapeRef::SphereImage(image) => Some(sphere_image(simd, inexact, image)),
        ShapeRef::BoxImage(image) => Some(box_image(simd, inexact, image, far)),
        ShapeRef::Sphere(_) | ShapeRef::Plane(_) | ShapeRef::AlignedBox(_) => None,
    }
}

/// Refines hits of an ellipsoid: `SphereImage::refine`.
#[inline(always)]
fn sphere_image<S: Simd>(simd: S, inexact: &RefineInput<S>, image: &SphereImage) -> Points<S> {
    let RefineInput { origin, direction, t } = *inexact;
    let (translation, inverse) = image.back();
    let place = Compensated::along(origin, direction, t);
    let from_translation = place.minus(splat3(simd, translation));
    let mut found = moderate3(simd, from_translation.rounded());
    let zero = splat(simd, 0.0);
    let mut own = [Double { high: zero, low: zero }; 3];
    for (own, row) in own.iter_mut().zip(image.exact_inverse()) {
        let (high, low) = (splat3(simd, row.rounded()), splat3(simd, row.rest()));
        found &= moderate3(simd, high);
        *own = from_translation.dot_exact(high, low);
    }
    let own = Compensated::from(own);
    found &= moderate3(simd, own.rounded()) & moderate(simd, splat(simd, image.radius()));
    let way = image_of(simd, inverse, direction);
    let step = sphere_step(own, way, splat(simd, image.radius()));
    let (normal, is_one) = unit(image_of(simd, &inverse.transpose(), own.moved(times(way, step))));
    found &= is_one;
    let (t, rest) = two_sum(t, step);
    Points { t, rest, point: place.moved(times(direction, step)), normal, found }
}

/// Refines hits of a transformed box: `BoxImage::refine`. `far` is true in lanes whose rays come from inside.
#[inline(always)]
fn box_image<S: Simd>(simd: S, inexact: &RefineInput<S>, image: &BoxImage, far: Mask<S>) -> Points<S> {
    let RefineInput { origin, direction, t } = *inexact;
    let FaceLanes { at, upper, certain } =
        SlabRoots::new(simd, &HalfRays { origin, direction }, image).faces(t, far);
    let [x, y, z] = image.slabs();
    let row = of_axis(simd, at, [x.0, y.0, z.0]);
    let [low, high, _] = of_axis(simd, at, [x.1, y.1, z.1].map(|[low, high]| DVec3::new(low, high, 0.0)));
    let normal = of_axis(simd, at, *image.normals());
    let offset = upper.select(high, low);
    let place = Compensated::along(origin, direction, t);
    let found = certain & moderate3(simd, place.rounded()) & moderate3(simd, row);
    let height = place.dot(row) - Double { high: offset, low: splat(simd, 0.0) };
    let step = newton_step(height.high, dot(row, direction));
    let (t, rest) = two_sum(t, step);
    let [x, y, z] = normal;
    let normal: F64s3<S> = select3(upper, normal, [-x, -y, -z]);
    Points { t, rest, point: place.moved(times(direction, step)), normal, found }
}

/// Selects, in each lane, the value of the axis whose mask is true.
#[inline(always)]
fn of_axis<S: Simd>(simd: S, at: [Mask<S>; 3], [x, y, z]: [DVec3; 3]) -> F64s3<S> {
    select3(at[0], splat3(simd, x), select3(at[1], splat3(simd, y), splat3(simd, z)))
}
