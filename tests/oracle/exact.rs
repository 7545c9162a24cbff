//! The oracle: what a line meets, by arithmetic whose sums and products are exact and whose quotients and roots have 400
//! bits.
//!
//! A map is not inverted but multiplied through by its determinant, so that every verdict is the sign of a polynomial in
//! the numbers that the shape and the ray were given by.

use std::cmp::Ordering;

use dashu_float::FBig;
use glam::{DAffine3, DVec3};

use rayreel::trace::PreparedShape;
use rayreel::trace::shapes::{AlignedBox, BoxImage, Plane, Sphere, SphereImage};

pub(crate) type Exact = FBig;
pub(crate) type Exact3 = [Exact; 3];

/// An `f64` to be reckoned with exactly.
pub(crate) fn exact(value: f64) -> Exact {
    Exact::try_from(value).unwrap().with_precision(0).value()
}

pub(crate) fn rounded(value: &Exact) -> f64 {
    value.to_f64().value()
}

/// The quotient, with 400 bits.
pub(crate) fn quotient(dividend: &Exact, divisor: &Exact) -> Exact {
    let long = |value: &Exact| value.clone().with_precision(400).value();
    long(dividend) / long(divisor)
}

/// The square root, with 400 bits.
pub(crate) fn root(value: &Exact) -> Exact {
    value.clone().with_precision(400).value().sqrt()
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

/// The point at `t`.
pub(crate) fn along(origin: &Exact3, direction: &Exact3, t: &Exact) -> Exact3 {
    std::array::from_fn(|axis| &origin[axis] + &direction[axis] * t)
}

pub(crate) fn length(vector: &Exact3) -> Exact {
    root(&dot(vector, vector))
}

/// |part / whole|, rounded; 0 of nothing.
fn share(part: &Exact, whole: &Exact) -> f64 {
    let short = |value: &Exact| value.clone().with_precision(64).value();
    if *part == Exact::ZERO { 0.0 } else { rounded(&(short(part) / short(whole))).abs() }
}

/// A shape, by the numbers that say what it is.
#[derive(Clone, Copy, Debug)]
pub(crate) enum Shape {
    Ball { center: DVec3, radius: f64 },
    Plane { point: DVec3, normal: DVec3 },
    Aligned { min: DVec3, max: DVec3 },
    Ellipsoid { forward: DAffine3, radius: f64 },
    Turned { forward: DAffine3, half: DVec3 },
}

/// Where a ray's line meets a shape.
#[derive(Debug)]
pub(crate) struct Answer {
    /// Where the line enters and where it leaves.
    pub(crate) line: Option<(Exact, Exact)>,
    /// By what share of the whole another verdict was missed.
    pub(crate) margin: f64,
    /// How steeply the line meets the surface, as a square: 1 is straight on.
    pub(crate) steepness: f64,
}

impl Answer {
    /// Certain to miss.
    const MISS: Self = Self { line: None, margin: 1.0, steepness: 1.0 };

    /// The first that is not behind the origin.
    pub(crate) fn first(&self) -> Option<&Exact> {
        let (near, far) = self.line.as_ref()?;
        [near, far].into_iter().find(|t| **t >= Exact::ZERO)
    }

    /// Does the ray start outside?
    pub(crate) fn is_from_outside(&self) -> bool {
        self.line.as_ref().is_some_and(|(near, _)| *near >= Exact::ZERO)
    }
}

/// The way back into a shape's own space, times the determinant of the way there, which is made positive.
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

    /// The sums' terms without their signs: what rounding errors are a share of.
    fn sizes(&self, vector: &Exact3) -> Exact3 {
        let vector = vector.each_ref().map(magnitude);
        std::array::from_fn(|axis| dot(&self.rows[axis].each_ref().map(magnitude), &vector))
    }
}

impl Shape {
    pub(crate) fn prepared(&self) -> PreparedShape {
        match *self {
            Self::Ball { center, radius } => PreparedShape::Sphere(Sphere { center, radius }),
            Self::Plane { point, normal } => PreparedShape::Plane(Plane { point, normal }),
            Self::Aligned { min, max } => PreparedShape::AlignedBox(AlignedBox { min, max }),
            Self::Ellipsoid { forward, radius } => {
                PreparedShape::SphereImage(SphereImage::new(forward, radius))
            }
            Self::Turned { forward, half } => PreparedShape::BoxImage(BoxImage::new(forward, half)),
        }
    }

    /// For all but planes and aligned boxes, which have no own space.
    pub(crate) fn back(&self) -> Option<Back> {
        match self {
            Self::Ball { center, .. } => Some(Back::new(&DAffine3::from_translation(*center))),
            Self::Ellipsoid { forward, .. } | Self::Turned { forward, .. } => Some(Back::new(forward)),
            Self::Plane { .. } | Self::Aligned { .. } => None,
        }
    }

    /// What exact arithmetic says of a ray.
    pub(crate) fn met_by(&self, origin: DVec3, direction: DVec3) -> Answer {
        self.met_from(&vector(origin), &vector(direction))
    }

    /// The same from a point that need not be one of `f64`s.
    pub(crate) fn met_from(&self, origin: &Exact3, direction: &Exact3) -> Answer {
        match self {
            Self::Ball { center, radius } => {
                ball(&difference(origin, &vector(*center)), direction, &exact(*radius))
            }
            Self::Plane { point, normal } => plane(&vector(*point), &vector(*normal), origin, direction),
            Self::Aligned { min, max } => {
                let (low, high) = (difference(&vector(*min), origin), difference(&vector(*max), origin));
                // Along the axes every verdict is decided exactly: any margin will do.
                Answer { margin: 1.0, ..slabs(&low, &high, direction, None) }
            }
            Self::Ellipsoid { forward, radius } => {
                let back = Back::new(forward);
                let (own, way) = (back.point(origin), back.direction(direction));
                let radius = exact(*radius) * &back.determinant;
                let answer = ball(&own, &way, &radius);
                // Other than from a centre of plain numbers, the distance to it is rounded.
                let squared = &radius * &radius;
                let height = dot(&own, &own) - &squared;
                let margin = share(&height, &(&height + &squared + &squared));
                Answer { margin: answer.margin.min(margin), ..answer }
            }
            Self::Turned { forward, half } => {
                let back = Back::new(forward);
                let (own, way) = (back.point(origin), back.direction(direction));
                let half = vector(*half).map(|half| half * &back.determinant);
                let low = std::array::from_fn(|axis| -&half[axis] - &own[axis]);
                let high = difference(&half, &own);
                let reach = back.sizes(&difference(origin, &back.translation));
                let places = std::array::from_fn(|axis| &reach[axis] + &half[axis]);
                slabs(&low, &high, &way, Some((&places, &back.sizes(direction))))
            }
        }
    }
}

/// A sphere around the zero point. On which side of it the origin is, is decided exactly: only tangency is a question.
fn ball(origin: &Exact3, direction: &Exact3, radius: &Exact) -> Answer {
    let (a, b) = (dot(direction, direction), -dot(origin, direction));
    let squared = radius * radius;
    let c = dot(origin, origin) - &squared;
    let discriminant = &b * &b - &a * &c;
    let margin = share(&discriminant, &(&b * &b + &a * &squared));
    if discriminant < Exact::ZERO {
        return Answer { line: None, margin, steepness: 1.0 };
    }
    let steepness = share(&discriminant, &(&a * &squared));
    let root = root(&discriminant);
    let sum = if b < Exact::ZERO { &b - &root } else { &b + &root };
    if sum == Exact::ZERO {
        return Answer { line: Some((Exact::ZERO, Exact::ZERO)), margin, steepness };
    }
    let (one, other) = (quotient(&c, &sum), quotient(&sum, &a));
    let line = if one < other { (one, other) } else { (other, one) };
    Answer { line: Some(line), margin, steepness }
}

/// A plane. Every verdict is decided exactly.
fn plane(point: &Exact3, normal: &Exact3, origin: &Exact3, direction: &Exact3) -> Answer {
    let (height, speed) = (dot(&difference(point, origin), normal), dot(direction, normal));
    if speed == Exact::ZERO {
        return Answer::MISS;
    }
    let t = quotient(&height, &speed);
    Answer { line: Some((t.clone(), t)), margin: 1.0, steepness: 1.0 }
}

/// A plane of a slab, ahead by `height` of an origin that comes closer with `speed`.
#[derive(Clone, Copy)]
struct Meeting<'a> {
    height: &'a Exact,
    speed: &'a Exact,
    axis: usize,
}

impl Meeting<'_> {
    fn compare(&self, other: &Self) -> Ordering {
        let order = (self.height * other.speed).cmp(&(other.height * self.speed));
        let same = (*self.speed < Exact::ZERO) == (*other.speed < Exact::ZERO);
        if same { order } else { order.reverse() }
    }
}

/// Three slabs. `sizes` are those of heights and speeds, where they were rounded.
fn slabs(low: &Exact3, high: &Exact3, speeds: &Exact3, sizes: Option<(&Exact3, &Exact3)>) -> Answer {
    let height_share =
        |height: &Exact, axis: usize| sizes.map_or(1.0, |(places, _)| share(height, &places[axis]));
    let order_share = |near: &Meeting<'_>, far: &Meeting<'_>| {
        sizes.map_or(1.0, |(places, ways)| {
            let whole = &places[near.axis] * &ways[far.axis] + &places[far.axis] * &ways[near.axis];
            share(&(near.height * far.speed - far.height * near.speed), &whole)
        })
    };
    let (mut nears, mut fars) = (Vec::new(), Vec::new());
    // The least share by which all hold that must hold for a hit, and the greatest by which one fails.
    let (mut holds, mut fails): (f64, Option<f64>) = (1.0, None);
    let mut require = |holding: bool, margin: f64| {
        if holding {
            holds = holds.min(margin);
        } else {
            fails = Some(fails.unwrap_or(0.0).max(margin));
        }
    };
    for axis in 0..3 {
        let (low, high, speed) = (&low[axis], &high[axis], &speeds[axis]);
        if *speed == Exact::ZERO {
            require(*low <= Exact::ZERO, height_share(low, axis));
            require(*high >= Exact::ZERO, height_share(high, axis));
            continue;
        }
        let (near, far) = if *speed > Exact::ZERO { (low, high) } else { (high, low) };
        nears.push(Meeting { height: near, speed, axis });
        fars.push(Meeting { height: far, speed, axis });
    }
    for near in &nears {
        for far in fars.iter().filter(|far| far.axis != near.axis) {
            require(near.compare(far).is_le(), order_share(near, far));
        }
    }
    if let Some(margin) = fails {
        return Answer { margin, ..Answer::MISS };
    }
    let entry = nears.into_iter().max_by(Meeting::compare).unwrap();
    let exit = fars.into_iter().min_by(Meeting::compare).unwrap();
    let (near, far) = (quotient(entry.height, entry.speed), quotient(exit.height, exit.speed));
    let (entry_share, exit_share) =
        (height_share(entry.height, entry.axis), height_share(exit.height, exit.axis));
    let margin = if near >= Exact::ZERO {
        holds.min(entry_share)
    } else if far >= Exact::ZERO {
        holds.min(entry_share).min(exit_share)
    } else {
        exit_share
    };
    let steepness = if entry.compare(&exit).is_eq() { 0.0 } else { 1.0 };
    Answer { line: Some((near, far)), margin, steepness }
}
