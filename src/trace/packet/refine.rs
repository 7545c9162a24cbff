//! Refinement of sixteen hits at once: the operations of the shapes' `refine`, in their order.

use fearless_simd::prelude::*;
use glam::DVec3;

use crate::trace::math::{
    CompensatedLanes, F64s, F64s3, Mask, Numbers, Vectors, bits, dot_lanes as dot, half_of, lanes, mask,
    moderate, moderate3, quick_two_sum, select3, splat, splat3, times, two_product, two_sum,
};
use crate::trace::query::{HitPacket, SurfacePacket};
use crate::trace::rays::{RayPacket, ShapeId, ShapeIds};
use crate::trace::scene::{Geometry, Kind, Location, PreparedScene};
use crate::trace::shapes::{AlignedBox, Sphere, U};

/// What a shape is made of.
#[derive(Clone, Copy)]
struct Shape {
    kind: Kind,
    /// A sphere's centre, a plane's point, or the lower corner of a box.
    place: DVec3,
    /// A plane's normal, or the upper corner of a box.
    other: DVec3,
    /// A plane's unit normal.
    unit: DVec3,
    radius: f64,
}

/// Shapes in lanes.
trait Shapes {
    /// Lanes that have a shape of a kind.
    fn lanes_of(&self, kind: Kind) -> u32;
    fn places<S: Simd>(&self, simd: S, half: usize) -> F64s3<S>;
    fn others<S: Simd>(&self, simd: S, half: usize) -> F64s3<S>;
    fn units<S: Simd>(&self, simd: S, half: usize) -> F64s3<S>;
    fn radii<S: Simd>(&self, simd: S, half: usize) -> F64s<S>;
    /// Says where radii and normals are [`moderate`].
    fn moderate<S: Simd>(&self, simd: S, half: usize) -> Mask<S>;
}

/// The same shape in some lanes.
struct OneShape {
    shape: Shape,
    lanes: u32,
    moderate: bool,
}

/// A shape of its own in each lane.
struct ManyShapes {
    places: Vectors,
    others: Vectors,
    units: Vectors,
    radii: Numbers,
    spheres: u32,
    planes: u32,
    boxes: u32,
}

/// Finds the surface points that hits in some lanes stand for, where one step from a `t` that is nearly right leads there. Returns
/// the lanes of the others, which `PreparedScene::surface` finds one by one.
#[inline(always)]
pub(crate) fn refine<S: Simd>(
    simd: S,
    scene: &PreparedScene,
    rays: &RayPacket,
    hits: &HitPacket,
    asked: u32,
    surfaces: &mut SurfacePacket,
) -> u32 {
    let mut special = asked & hits.tied;
    if scene.equal_shapes.any() {
        let grouped =
            |lane: &usize| hits.ids.get(*lane).is_none_or(|id| scene.equal_shapes.group(id).is_some());
        special |= lanes(asked).filter(grouped).fold(0, |mask, lane| mask | 1 << lane);
    }
    let usual = asked & !special;
    let found = match hits.ids.common(simd, usual) {
        _ if usual == 0 => 0,
        Some(id) => match Shape::of(scene.geometry(), id) {
            Some(shape) => {
                let shape = OneShape::new(simd, shape, usual);
                refine_lanes(simd, (rays, hits), &shape, usual, surfaces)
            }
            None => 0,
        },
        None => {
            let shapes = ManyShapes::gather(scene.geometry(), &hits.ids, usual);
            refine_lanes(simd, (rays, hits), &shapes, usual, surfaces)
        }
    };
    surfaces.lanes |= found;
    surfaces.first_equals = hits.ids;
    asked & !found
}

/// Returns the lanes in which that was right.
#[inline(always)]
fn refine_lanes<S: Simd>(
    simd: S,
    packet: (&RayPacket, &HitPacket),
    shapes: &impl Shapes,
    asked: u32,
    surfaces: &mut SurfacePacket,
) -> u32 {
    let known =
        shapes.lanes_of(Kind::Sphere) | shapes.lanes_of(Kind::Plane) | shapes.lanes_of(Kind::AlignedBox);
    let mut found = asked & known;
    for half in 0..2 {
        if half_of(found, half) != 0 {
            found &= !refine_half(simd, packet, shapes, (half, found), surfaces);
        }
    }
    found
}

impl Shape {
    /// `None` for images.
    #[inline(always)]
    fn of(geometry: &Geometry, id: ShapeId) -> Option<Self> {
        let Location { kind, index } = geometry.locations[id.index()];
        let index = index as usize;
        let none = Self { kind, place: DVec3::ZERO, other: DVec3::ONE, unit: DVec3::Y, radius: 1.0 };
        match kind {
            Kind::Sphere => {
                let Sphere { center, radius } = geometry.spheres[index];
                Some(Self { place: center, radius, ..none })
            }
            Kind::Plane => {
                let plane = &geometry.planes[index];
                let (place, other, unit) = (plane.point(), plane.normal(), plane.unit_normal());
                Some(Self { place, other, unit, ..none })
            }
            Kind::AlignedBox => {
                let AlignedBox { min, max } = geometry.boxes[index];
                Some(Self { place: min, other: max, ..none })
            }
            Kind::SphereImage | Kind::BoxImage => None,
        }
    }
}

impl OneShape {
    #[inline(always)]
    fn new<S: Simd>(simd: S, shape: Shape, lanes: u32) -> Self {
        let numbers = moderate3(simd, splat3(simd, shape.other)) & moderate(simd, splat(simd, shape.radius));
        Self { shape, lanes, moderate: numbers.all_true() }
    }
}

impl Shapes for OneShape {
    #[inline(always)]
    fn moderate<S: Simd>(&self, simd: S, _half: usize) -> Mask<S> {
        Mask::<S>::from_bitmask(simd, if self.moderate { 0xff } else { 0 })
    }

    #[inline(always)]
    fn lanes_of(&self, kind: Kind) -> u32 {
        if self.shape.kind == kind { self.lanes } else { 0 }
    }

    #[inline(always)]
    fn places<S: Simd>(&self, simd: S, _half: usize) -> F64s3<S> {
        splat3(simd, self.shape.place)
    }

    #[inline(always)]
    fn others<S: Simd>(&self, simd: S, _half: usize) -> F64s3<S> {
        splat3(simd, self.shape.other)
    }

    #[inline(always)]
    fn units<S: Simd>(&self, simd: S, _half: usize) -> F64s3<S> {
        splat3(simd, self.shape.unit)
    }

    #[inline(always)]
    fn radii<S: Simd>(&self, simd: S, _half: usize) -> F64s<S> {
        splat(simd, self.shape.radius)
    }
}

impl ManyShapes {
    #[inline(always)]
    fn gather(geometry: &Geometry, ids: &ShapeIds, asked: u32) -> Self {
        let mut all = Self {
            places: Vectors::splat(DVec3::ZERO),
            others: Vectors::splat(DVec3::ONE),
            units: Vectors::splat(DVec3::Y),
            radii: Numbers::splat(1.0),
            spheres: 0,
            planes: 0,
            boxes: 0,
        };
        for lane in lanes(asked) {
            let Some(Shape { kind, place, other, unit, radius }) =
                ids.get(lane).and_then(|id| Shape::of(geometry, id))
            else {
                continue;
            };
            all.places.set(lane, place);
            let bit = 1 << lane;
            match kind {
                Kind::Sphere => {
                    all.radii.set(lane, radius);
                    all.spheres |= bit;
                }
                Kind::Plane => {
                    all.others.set(lane, other);
                    all.units.set(lane, unit);
                    all.planes |= bit;
                }
                Kind::AlignedBox => {
                    all.others.set(lane, other);
                    all.boxes |= bit;
                }
                Kind::SphereImage | Kind::BoxImage => {}
            }
        }
        all
    }
}

impl Shapes for ManyShapes {
    #[inline(always)]
    fn moderate<S: Simd>(&self, simd: S, half: usize) -> Mask<S> {
        moderate(simd, self.radii.load(simd, half)) & moderate3(simd, self.others.load(simd, half))
    }

    #[inline(always)]
    fn lanes_of(&self, kind: Kind) -> u32 {
        match kind {
            Kind::Sphere => self.spheres,
            Kind::Plane => self.planes,
            Kind::AlignedBox => self.boxes,
            Kind::SphereImage | Kind::BoxImage => 0,
        }
    }

    #[inline(always)]
    fn places<S: Simd>(&self, simd: S, half: usize) -> F64s3<S> {
        self.places.load(simd, half)
    }

    #[inline(always)]
    fn others<S: Simd>(&self, simd: S, half: usize) -> F64s3<S> {
        self.others.load(simd, half)
    }

    #[inline(always)]
    fn units<S: Simd>(&self, simd: S, half: usize) -> F64s3<S> {
        self.units.load(simd, half)
    }

    #[inline(always)]
    fn radii<S: Simd>(&self, simd: S, half: usize) -> F64s<S> {
        self.radii.load(simd, half)
    }
}

/// Points of half of the lanes.
#[derive(Clone, Copy)]
struct Points<S: Simd> {
    /// The parameter, rounded, and what that leaves over.
    t: F64s<S>,
    rest: F64s<S>,
    point: F64s3<S>,
    normal: F64s3<S>,
    /// Where that is right.
    found: Mask<S>,
}

/// A ray each, and the inexact `t` of its hit.
#[derive(Clone, Copy)]
struct Inexact<S: Simd> {
    origin: F64s3<S>,
    direction: F64s3<S>,
    t: F64s<S>,
}

/// Returns the lanes of half of a packet that have to be refined one by one.
#[inline(always)]
fn refine_half<S: Simd>(
    simd: S,
    (rays, hits): (&RayPacket, &HitPacket),
    shapes: &impl Shapes,
    (half, asked): (usize, u32),
    surfaces: &mut SurfacePacket,
) -> u32 {
    let (t, error) = (hits.ts.load(simd, half), hits.errors.load(simd, half));
    let rounded = error.simd_le(t * f64::EPSILON);
    let rough = error.simd_gt(t * (1.0 / 268_435_456.0));
    let direction = rays.directions.load(simd, half);
    let inexact = Inexact { origin: rays.origins.load(simd, half), direction, t };
    let moderate = moderate(simd, t) & moderate3(simd, direction);
    let mut points: Option<Points<S>> = None;
    if half_of(shapes.lanes_of(Kind::Sphere) & asked, half) != 0 {
        points = Some(spheres(simd, &inexact, shapes, half));
    }
    if half_of(shapes.lanes_of(Kind::Plane) & asked, half) != 0 {
        let these = mask(simd, shapes.lanes_of(Kind::Plane), half);
        points = Some(Points::select(these, planes(simd, &inexact, shapes, half), points));
    }
    if half_of(shapes.lanes_of(Kind::AlignedBox) & asked, half) != 0 {
        let these = mask(simd, shapes.lanes_of(Kind::AlignedBox), half);
        points = Some(Points::select(these, boxes(simd, &inexact, shapes, half), points));
    }
    let Some(points) = points else { return 0 };
    let special = bits(rounded | rough | !(moderate & points.found), half) & asked;
    let outside = dot(direction, points.normal).simd_le(splat(simd, 0.0));
    surfaces.from_outside |= bits(outside, half) & asked & !special & !hits.far;
    surfaces.points.store(half, points.point);
    surfaces.normals.store(half, points.normal);
    surfaces.ts.store(half, points.t);
    surfaces.rests.store(half, points.rest);
    special
}

impl<S: Simd> Points<S> {
    /// These where the mask is true, else others.
    #[inline(always)]
    fn select(mask: Mask<S>, these: Self, others: Option<Self>) -> Self {
        let Some(others) = others else { return these };
        Self {
            t: mask.select(these.t, others.t),
            rest: mask.select(these.rest, others.rest),
            point: select3(mask, these.point, others.point),
            normal: select3(mask, these.normal, others.normal),
            found: (mask & these.found) | (!mask & others.found),
        }
    }
}

/// `newton_step`.
#[inline(always)]
fn newton_step<S: Simd>(simd: S, residual: F64s<S>, slope: F64s<S>) -> F64s<S> {
    let step = -residual / slope;
    step.abs().simd_lt(splat(simd, f64::INFINITY)).select(step, splat(simd, 0.0))
}

/// `Sphere::refine`.
#[inline(always)]
fn spheres<S: Simd>(simd: S, inexact: &Inexact<S>, shapes: &impl Shapes, half: usize) -> Points<S> {
    let Inexact { origin, direction, t } = *inexact;
    let place = CompensatedLanes::along(origin, direction, t);
    let from_center = place.minus(shapes.places(simd, half));
    let radius = shapes.radii(simd, half);
    let moderate = shapes.moderate(simd, half) & moderate3(simd, from_center.rounded());
    let slope = dot(from_center.rounded(), direction) * 2.0;
    let step = newton_step(simd, from_center.beyond(radius), slope);
    let way = times(direction, step);
    let outwards = from_center.moved(way);
    let reciprocal = splat(simd, 1.0) / dot(outwards, outwards).sqrt();
    let zero = splat(simd, 0.0);
    let found = moderate & reciprocal.simd_lt(splat(simd, f64::INFINITY)) & reciprocal.simd_gt(zero);
    let (t, rest) = two_sum(t, step);
    Points { t, rest, point: place.moved(way), normal: times(outwards, reciprocal), found }
}

/// `Plane::refine`.
#[inline(always)]
fn planes<S: Simd>(simd: S, inexact: &Inexact<S>, shapes: &impl Shapes, half: usize) -> Points<S> {
    let Inexact { origin, direction, t } = *inexact;
    let normal = shapes.others(simd, half);
    let place = CompensatedLanes::along(origin, direction, t);
    let from_point = place.minus(shapes.places(simd, half));
    let found = shapes.moderate(simd, half) & moderate3(simd, from_point.rounded());
    let height = from_point.dot(normal);
    let step = newton_step(simd, height, dot(direction, normal));
    let (t, rest) = two_sum(t, step);
    let point = place.moved(times(direction, step));
    Points { t, rest, point, normal: shapes.units(simd, half), found }
}

/// `AlignedBox::refine`.
#[inline(always)]
fn boxes<S: Simd>(simd: S, inexact: &Inexact<S>, shapes: &impl Shapes, half: usize) -> Points<S> {
    /// Quotients of smaller numbers might lose digits.
    const TINY: f64 = 1e-140;
    let Inexact { origin, direction, t } = *inexact;
    let (min, max) = (shapes.places(simd, half), shapes.others(simd, half));
    // The only face whose plane the ray is on at `t`.
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
    // The difference over the speed, in double-double.
    let (high, low) = two_sum(face, -from);
    let first = high / speed;
    let found = found & moderate(simd, first);
    let (product, error) = two_product(speed, first);
    let (product, product_rest) = quick_two_sum(product, error + splat(simd, 0.0) * first);
    let left = difference((high, low), (product, product_rest));
    let (t, rest) = quick_two_sum(first, left / speed);
    let place = CompensatedLanes::along(origin, direction, t).moved(times(direction, rest));
    // The step is along the parameter that the division found.
    let found = found & moderate(simd, t);
    let (zero, one) = (splat(simd, 0.0), splat(simd, 1.0));
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

/// The rounded difference of two double-doubles.
#[inline(always)]
fn difference<S: Simd>(a: (F64s<S>, F64s<S>), b: (F64s<S>, F64s<S>)) -> F64s<S> {
    let (high, error) = two_sum(a.0, -b.0);
    let (low, low_error) = two_sum(a.1, -b.1);
    let (high, error) = quick_two_sum(high, error + low);
    quick_two_sum(high, error + low_error).0
}
