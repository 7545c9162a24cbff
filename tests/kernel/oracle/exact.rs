//! The oracle: intersections by arithmetic with exact sums and products, and with quotients and roots of 1200 bits: more than
//! the ratio of the greatest distances to the smallest differences between them.
//!
//! A transform is not inverted but multiplied through by its determinant, so that every verdict is the sign of a polynomial in the numbers
//! that define the shape and the ray. Rotated boxes use the slabs of the kernel. The agreement of these slabs with the transform is checked
//! separately, by [`Shape::slab_errors`].

use std::cmp::Ordering;

use dashu_float::FBig;
use glam::{DAffine3, DVec3};

use rayreel::trace::PreparedShape;
use rayreel::trace::shapes::{AlignedBox, BoxImage, Plane, Rod, RodImage, Sphere, SphereImage};

pub(crate) type Exact = FBig;
pub(crate) type Exact3 = [Exact; 3];

/// Converts an `f64` for exact arithmetic.
pub(crate) fn exact(value: f64) -> Exact {
    Exact::try_from(value).unwrap().with_precision(0).value()
}

pub(crate) fn rounded(value: &Exact) -> f64 {
    value.to_f64().value()
}

/// Number of bits of quotients and roots.
const BITS: usize = 1200;

/// Returns the quotient, rounded.
pub(crate) fn quotient(dividend: &Exact, divisor: &Exact) -> Exact {
    let long = |value: &Exact| value.clone().with_precision(BITS).value();
    long(dividend) / long(divisor)
}

/// Returns the square root, rounded.
pub(crate) fn root(value: &Exact) -> Exact {
    value.clone().with_precision(BITS).value().sqrt()
}

pub(crate) fn magnitude(value: &Exact) -> Exact {
    if *value < Exact::ZERO { -value } else { value.clone() }
}

pub(crate) fn dot(a: &Exact3, b: &Exact3) -> Exact {
    &a[0] * &b[0] + &a[1] * &b[1] + &a[2] * &b[2]
}

pub(crate) fn vector(value: DVec3) -> Exact3 {
    value.to_array().map(exact)
}

pub(crate) fn difference(a: &Exact3, b: &Exact3) -> Exact3 {
    std::array::from_fn(|axis| &a[axis] - &b[axis])
}

fn cross(a: &Exact3, b: &Exact3) -> Exact3 {
    std::array::from_fn(|axis| {
        let (next, last) = ((axis + 1) % 3, (axis + 2) % 3);
        &a[next] * &b[last] - &a[last] * &b[next]
    })
}

/// Returns the point at `t`.
pub(crate) fn along(origin: &Exact3, direction: &Exact3, t: &Exact) -> Exact3 {
    std::array::from_fn(|axis| &origin[axis] + &direction[axis] * t)
}

pub(crate) fn length(vector: &Exact3) -> Exact {
    root(&dot(vector, vector))
}

/// A shape by its defining numbers.
#[derive(Clone, Copy, Debug)]
pub(crate) enum Shape {
    Ball { center: DVec3, radius: f64 },
    Plane { point: DVec3, normal: DVec3 },
    Aligned { min: DVec3, max: DVec3 },
    Ellipsoid { forward: DAffine3, radius: f64 },
    Turned { forward: DAffine3, half: DVec3 },
    Rod { ends: [DVec3; 2], radius: f64, is_round: bool },
    RodImage { forward: DAffine3, stop: DVec3, radius: f64, is_round: bool },
}

/// The intersections of a ray's line with a shape.
#[derive(Debug)]
pub(crate) struct Answer {
    /// The `t` at which the line enters and leaves.
    pub(crate) line: Option<(Exact, Exact)>,
    /// Set if the line enters and leaves at the same point.
    pub(crate) touches: bool,
}

impl Answer {
    const MISS: Self = Self { line: None, touches: false };

    /// Returns the first intersection that is not behind the origin.
    pub(crate) fn first(&self) -> Option<&Exact> {
        let (near, far) = self.line.as_ref()?;
        [near, far].into_iter().find(|t| **t >= Exact::ZERO)
    }

    /// Returns true if the ray starts outside.
    pub(crate) fn is_from_outside(&self) -> bool {
        self.line.as_ref().is_some_and(|(near, _)| *near >= Exact::ZERO)
    }
}

/// The transform back to the local space of a shape, times the determinant of the forward transform, which is made positive.
pub(crate) struct Back {
    pub(crate) rows: [Exact3; 3],
    pub(crate) determinant: Exact,
    pub(crate) translation: Exact3,
}

impl Back {
    fn new(forward: &DAffine3) -> Self {
        let [a, b, c] = [forward.matrix3.x_axis, forward.matrix3.y_axis, forward.matrix3.z_axis].map(vector);
        let rows = [cross(&b, &c), cross(&c, &a), cross(&a, &b)];
        let determinant = dot(&a, &rows[0]);
        let translation = vector(forward.translation);
        if determinant < Exact::ZERO {
            Self { rows: rows.map(|row| row.map(|part| -part)), determinant: -determinant, translation }
        } else {
            Self { rows, determinant, translation }
        }
    }

    pub(crate) fn direction(&self, direction: &Exact3) -> Exact3 {
        std::array::from_fn(|axis| dot(&self.rows[axis], direction))
    }

    pub(crate) fn point(&self, point: &Exact3) -> Exact3 {
        self.direction(&difference(point, &self.translation))
    }
}

impl Shape {
    pub(crate) fn prepared(&self) -> PreparedShape {
        match *self {
            Self::Ball { center, radius } => PreparedShape::Sphere(Sphere { center, radius }),
            Self::Plane { point, normal } => PreparedShape::Plane(Plane::new(point, normal).unwrap()),
            Self::Aligned { min, max } => PreparedShape::AlignedBox(AlignedBox { min, max }),
            Self::Ellipsoid { forward, radius } => {
                PreparedShape::SphereImage(SphereImage::new(forward, radius))
            }
            Self::Turned { forward, half } => PreparedShape::BoxImage(BoxImage::new(forward, half).unwrap()),
            Self::Rod { ends: [from, to], radius, is_round: false } => {
                PreparedShape::Rod(Rod::cylinder(from, to, radius).unwrap())
            }
            Self::Rod { ends: [from, to], radius, is_round: true } => {
                PreparedShape::Rod(Rod::capsule(from, to, radius).unwrap())
            }
            Self::RodImage { forward, stop, radius, is_round: false } => {
                PreparedShape::RodImage(RodImage::cylinder(forward, stop, radius).unwrap())
            }
            Self::RodImage { forward, stop, radius, is_round: true } => {
                PreparedShape::RodImage(RodImage::capsule(forward, stop, radius).unwrap())
            }
        }
    }

    /// Returns the errors of a rotated box's slabs against its transform, in units in the last place of their terms.
    pub(crate) fn slab_errors(&self) -> Vec<f64> {
        let Self::Turned { forward, half } = self else { return Vec::new() };
        let Back { rows, determinant, translation } = Back::new(forward);
        let image = BoxImage::new(*forward, *half).unwrap();
        let mut errors = Vec::new();
        for (axis, (row, offsets)) in image.slabs().into_iter().enumerate() {
            let largest = row.abs().to_array().into_iter().position(|part| part == 1.0).unwrap();
            let pivot = magnitude(&rows[axis][largest]);
            let sign = if rows[axis][largest] < Exact::ZERO { -1.0 } else { 1.0 } * row[largest];
            for (part, found) in rows[axis].iter().zip(row.to_array()) {
                errors.push(share(&(part * exact(sign) - exact(found) * &pivot), &pivot));
            }
            let middle = dot(&rows[axis], &translation) * exact(sign);
            let reach = exact(half[axis]) * &determinant;
            let size =
                dot(&rows[axis].each_ref().map(magnitude), &translation.each_ref().map(magnitude)) + &reach;
            for (found, expected) in offsets.into_iter().zip([&middle - &reach, &middle + &reach]) {
                errors.push(share(&(exact(found) * &pivot - expected), &size));
            }
        }
        errors
    }

    /// Returns the exact intersections of a ray.
    pub(crate) fn met_by(&self, origin: DVec3, direction: DVec3) -> Answer {
        self.met_from(&vector(origin), &vector(direction))
    }

    /// Returns the exact intersections of a ray from a point that need not consist of `f64`s.
    pub(crate) fn met_from(&self, origin: &Exact3, direction: &Exact3) -> Answer {
        match self {
            Self::Ball { center, radius } => {
                ball(&difference(origin, &vector(*center)), direction, &exact(*radius))
            }
            Self::Plane { point, normal } => plane(&vector(*point), &vector(*normal), origin, direction),
            Self::Aligned { min, max } => {
                let (low, high) = (difference(&vector(*min), origin), difference(&vector(*max), origin));
                slabs(&low, &high, direction)
            }
            Self::Ellipsoid { forward, radius } => {
                let back = Back::new(forward);
                ball(&back.point(origin), &back.direction(direction), &(exact(*radius) * &back.determinant))
            }
            Self::Turned { forward, half } => {
                let sides = BoxImage::new(*forward, *half).unwrap().slabs();
                let row = |axis: usize| vector(sides[axis].0);
                let ahead = |axis: usize, side: usize| exact(sides[axis].1[side]) - dot(&row(axis), origin);
                let low = std::array::from_fn(|axis| ahead(axis, 0));
                let high = std::array::from_fn(|axis| ahead(axis, 1));
                slabs(&low, &high, &std::array::from_fn(|axis| dot(&row(axis), direction)))
            }
            Self::Rod { ends: [from, to], radius, is_round } => {
                let start = vector(*from);
                let stop = difference(&vector(*to), &start);
                let slab = Rod::cylinder(*from, *to, *radius).and_then(|rod| rod.slab());
                let slab = slab.filter(|_| !is_round).map(|slab| Slab::new(slab, origin, direction));
                rod(&difference(origin, &start), direction, [&stop, &stop], &exact(*radius), slab.as_ref())
            }
            Self::RodImage { forward, stop, radius, is_round } => {
                let back = Back::new(forward);
                let slab = RodImage::cylinder(*forward, *stop, *radius).and_then(|image| image.slab());
                let slab = slab.filter(|_| !is_round).map(|slab| Slab::new(slab, origin, direction));
                let (axis, radius) = (vector(*stop), exact(*radius) * &back.determinant);
                let stop = axis.each_ref().map(|part| part * &back.determinant);
                rod(&back.point(origin), &back.direction(direction), [&axis, &stop], &radius, slab.as_ref())
            }
        }
    }
}

/// The planes of a cylinder's ends, at two distances from an origin that moves across them with `speed`.
struct Slab {
    low: Exact,
    high: Exact,
    speed: Exact,
}

impl Slab {
    fn new((row, offsets): (DVec3, [f64; 2]), origin: &Exact3, direction: &Exact3) -> Self {
        let row = vector(row);
        let at = dot(&row, origin);
        let [low, high] = offsets.map(|offset| exact(offset) - &at);
        Self { low, high, speed: dot(&row, direction) }
    }

    /// Returns the part of the line within the slab; `None` for the whole line, and an empty part for nothing.
    fn part(&self) -> Option<Option<(Exact, Exact)>> {
        if self.speed == Exact::ZERO {
            let outside = self.low > Exact::ZERO || self.high < Exact::ZERO;
            return if outside { Some(None) } else { None };
        }
        let (one, other) = (quotient(&self.low, &self.speed), quotient(&self.high, &self.speed));
        Some(Some(if self.speed > Exact::ZERO { (one, other) } else { (other, one) }))
    }
}

/// Returns true if one number is greater than another by more than the rounding of quotients and roots.
fn exceeds(one: &Exact, other: &Exact) -> bool {
    let size = magnitude(one) + magnitude(other);
    one - other > exact(libm::ldexp(1.0, -1050)) * size
}

/// Intersects a rod with the given slab, or with spheres at its ends. `axis` and `stop` are the axis itself and the axis in the scale of the
/// other vectors.
fn rod(
    origin: &Exact3,
    direction: &Exact3,
    [axis, stop]: [&Exact3; 2],
    radius: &Exact,
    slab: Option<&Slab>,
) -> Answer {
    let (across, turned) = (cross(origin, axis), cross(direction, axis));
    let (a, b) = (dot(&turned, &turned), -dot(&across, &turned));
    let c = dot(&across, &across) - radius * radius * dot(axis, axis);
    let side = if a == Exact::ZERO {
        if c > Exact::ZERO { Some(None) } else { None }
    } else {
        Some(solve(&a, &b, &c).map(|(near, far, _)| (near, far)))
    };
    let along = dot(origin, axis);
    let ends = Slab { low: -&along, high: dot(stop, axis) - &along, speed: dot(direction, axis) };
    let tube = match (side, slab.unwrap_or(&ends).part()) {
        (Some(None), _) | (_, Some(None)) => None,
        (Some(Some(side)), None) => Some(side),
        (None, Some(Some(ends))) => Some(ends),
        (Some(Some((near, far))), Some(Some((low, high)))) => {
            let entry = if low > near { low } else { near };
            let exit = if high < far { high } else { far };
            (!exceeds(&entry, &exit)).then_some((entry, exit))
        }
        (None, None) => unreachable!(),
    };
    let mut parts = vec![tube];
    if slab.is_none() {
        parts.extend(
            [origin.clone(), difference(origin, stop)].map(|from| ball(&from, direction, radius).line),
        );
    }
    let line = parts.into_iter().flatten().reduce(|(near, far), (first, last)| {
        (if first < near { first } else { near }, if last > far { last } else { far })
    });
    // A line within the side of a capsule touches it from the one end to the other.
    let is_within = a == Exact::ZERO && c == Exact::ZERO && slab.is_none();
    let touches = is_within || line.as_ref().is_some_and(|(near, far)| !exceeds(far, near));
    Answer { line, touches }
}

/// Returns the roots of a t^2 - 2 b t + c = 0 in ascending order, and true if they are equal.
fn solve(a: &Exact, b: &Exact, c: &Exact) -> Option<(Exact, Exact, bool)> {
    let discriminant = b * b - a * c;
    if discriminant < Exact::ZERO {
        return None;
    }
    let touches = discriminant == Exact::ZERO;
    let root = root(&discriminant);
    let sum = if *b < Exact::ZERO { b - &root } else { b + &root };
    if sum == Exact::ZERO {
        return Some((Exact::ZERO, Exact::ZERO, touches));
    }
    let (one, other) = (quotient(c, &sum), quotient(&sum, a));
    Some(if one < other { (one, other, touches) } else { (other, one, touches) })
}

/// Returns |part / whole| in units in the last place of 1.
fn share(part: &Exact, whole: &Exact) -> f64 {
    let short = |value: &Exact| value.clone().with_precision(64).value();
    if *part == Exact::ZERO { 0.0 } else { rounded(&(short(part) / short(whole))).abs() / f64::EPSILON }
}

/// Intersects a sphere around the zero point.
fn ball(origin: &Exact3, direction: &Exact3, radius: &Exact) -> Answer {
    let (a, b) = (dot(direction, direction), -dot(origin, direction));
    let c = dot(origin, origin) - radius * radius;
    match solve(&a, &b, &c) {
        None => Answer::MISS,
        Some((near, far, touches)) => Answer { line: Some((near, far)), touches },
    }
}

fn plane(point: &Exact3, normal: &Exact3, origin: &Exact3, direction: &Exact3) -> Answer {
    let (height, speed) = (dot(&difference(point, origin), normal), dot(direction, normal));
    if speed == Exact::ZERO {
        return Answer::MISS;
    }
    let t = quotient(&height, &speed);
    Answer { line: Some((t.clone(), t)), touches: false }
}

/// A plane of a slab, at a distance of `height` from an origin that approaches it with `speed`.
#[derive(Clone, Copy)]
struct Meeting<'a> {
    height: &'a Exact,
    speed: &'a Exact,
}

impl Meeting<'_> {
    fn compare(&self, other: &Self) -> Ordering {
        let order = (self.height * other.speed).cmp(&(other.height * self.speed));
        let same = (*self.speed < Exact::ZERO) == (*other.speed < Exact::ZERO);
        if same { order } else { order.reverse() }
    }
}

/// Intersects three slabs.
fn slabs(low: &Exact3, high: &Exact3, speeds: &Exact3) -> Answer {
    let (mut nears, mut fars) = (Vec::new(), Vec::new());
    for axis in 0..3 {
        let (low, high, speed) = (&low[axis], &high[axis], &speeds[axis]);
        if *speed == Exact::ZERO {
            if *low > Exact::ZERO || *high < Exact::ZERO {
                return Answer::MISS;
            }
            continue;
        }
        let (near, far) = if *speed > Exact::ZERO { (low, high) } else { (high, low) };
        nears.push(Meeting { height: near, speed });
        fars.push(Meeting { height: far, speed });
    }
    let entry = nears.into_iter().max_by(Meeting::compare).unwrap();
    let exit = fars.into_iter().min_by(Meeting::compare).unwrap();
    if entry.compare(&exit).is_gt() {
        return Answer::MISS;
    }
    let (near, far) = (quotient(entry.height, entry.speed), quotient(exit.height, exit.speed));
    Answer { line: Some((near, far)), touches: entry.compare(&exit).is_eq() }
}
