//! The outline and the inverse depth of a shape on the screen, as functions of the position in a tile.
//!
//! The camera ray through position (x, y), in pixels from the middle of a tile, has the direction d = d0 + x du + y dv, not normalised. Its
//! inverse depth is u = 1/t. All shapes are convex. Each is visible where a few functions are all positive:
//!
//! - a sphere of radius r, with the vector L from the eye to its centre: r² d·d - (L x d)², a quarter of the discriminant without its
//!   cancellation, and L·d;
//! - a box: n·d for the normal n of the plane through the eye and each silhouette edge, between a face that faces the eye and one that does
//!   not;
//! - a plane: its inverse depth, which is linear;
//! - a rod: those of the box around it. It covers pixels fully where its side does, which looks along the axis as a sphere does, between its
//!   ends.
//!
//! Bounds of a quadratic function over a pixel's square follow from its value, its gradient and its second derivatives in the middle.
//! Inverse depth is linear on every flat face. On a sphere it is, up to a constant factor, a linear function plus or minus the square root
//! of the first function above. Images of spheres, boxes and rods are mapped back to these, which preserves t.

use std::f64::consts::TAU;

use glam::{DMat3, DVec2, DVec3};

use crate::trace::scene::ShapeRef;
use crate::trace::shapes::{AlignedBox, Bounds, Sphere};
use crate::trace::stages::TILE;

/// Half the side of a tile in pixels, with a margin.
const HALF_TILE: f64 = TILE as f64 / 2.0 + 1e-6;

/// The camera rays of a tile.
#[derive(Clone, Copy, Debug)]
pub(super) struct TileRays {
    pub(super) eye: DVec3,
    /// Direction through the middle of the tile.
    pub(super) middle: DVec3,
    /// Change of the direction per column and per row.
    pub(super) steps: [DVec3; 2],
}

/// A quadratic function of the position p = (x, y): constant + linear·p + xx x² + xy x y + yy y².
#[derive(Clone, Copy, Debug, Default)]
pub(super) struct Quadratic {
    constant: f64,
    linear: DVec2,
    /// Coefficients of x², x y and y².
    quadratic: [f64; 3],
}

/// The inverse depth of a shape.
#[derive(Clone, Debug)]
enum InverseDepth {
    /// (b + sqrt(q)) / c seen from outside, (b - sqrt(q)) / c from inside.
    Sphere { b: Quadratic, q: Quadratic, c: f64 },
    /// Minimum over the faces of a convex solid that face the eye, which is outside.
    Nearest(Vec<Quadratic>),
    /// Maximum over all faces of a convex solid around the eye.
    Farthest(Vec<Quadratic>),
    /// That of a rod: known where its side is visible, and bounded by the box around it elsewhere.
    Rod(Box<RodDepth>),
}

/// The side of a rod, and the box around the rod.
#[derive(Clone, Debug)]
struct RodDepth {
    /// The infinite cylinder, which looks along its axis as a sphere does; `None` if the eye is within it.
    side: Option<Outline>,
    /// The faces of the box that face the eye.
    faces: InverseDepth,
    /// The component of the rays along the axis, the eye's distance from the start along it, and the length of the axis.
    rise: Quadratic,
    start: f64,
    length: f64,
}

/// A shape as seen through a tile.
#[derive(Clone, Debug)]
pub(super) struct Outline {
    /// Functions that are all positive inside the outline.
    inside: Vec<Quadratic>,
    depth: InverseDepth,
    /// Projected area in pixels, or the least projected width times one pixel if that is smaller.
    pub(super) area: f64,
}

/// Squares of a tile, in pixels from its middle. Loops run over the squares, so that compilers vectorize them.
#[derive(Clone, Copy, Debug)]
pub(super) struct Squares<const N: usize> {
    /// Coordinates of their centres.
    pub(super) x: [f64; N],
    pub(super) y: [f64; N],
    /// Half their side.
    pub(super) half: f64,
}

/// Coverage of squares by a shape. Masks have one bit per square.
#[derive(Clone, Copy, Debug)]
pub(super) struct Covers<const N: usize> {
    /// Squares that may show the shape.
    pub(super) seen: u32,
    /// Squares that the shape covers fully.
    pub(super) whole: u32,
    /// Squares in which a single face is visible.
    pub(super) one_face: u32,
    /// Lower and upper bounds of inverse depth over each square.
    pub(super) depth: [[f64; N]; 2],
}

impl Quadratic {
    fn linear(of: impl Fn(DVec3) -> f64, rays: &TileRays) -> Self {
        let [right, down] = rays.steps;
        Self { constant: of(rays.middle), linear: DVec2::new(of(right), of(down)), quadratic: [0.0; 3] }
    }

    /// Returns lower and upper bounds over each square.
    #[inline(always)]
    fn bounds<const N: usize>(&self, Squares { x, y, half }: &Squares<N>) -> [[f64; N]; 2] {
        /// Upper bound of the rounding error of a sum of a dozen terms, relative to the largest term.
        const ROUNDING: f64 = 1e-13;
        let Self { constant, linear: DVec2 { x: right, y: down }, quadratic: [xx, xy, yy] } = *self;
        let reach = HALF_TILE + half;
        let bend = xx.abs() + xy.abs() + yy.abs();
        let size = constant.abs() + reach * (right.abs() + down.abs()) + reach * reach * bend;
        let (mut least, mut greatest) = ([0.0; N], [0.0; N]);
        if bend == 0.0 {
            let around = (right.abs() + down.abs()) * half + size * ROUNDING;
            for lane in 0..N {
                let value = constant + x[lane] * right + y[lane] * down;
                (least[lane], greatest[lane]) = (value - around, value + around);
            }
            return [least, greatest];
        }
        // A concave function lies below its tangents.
        let is_concave = xx <= 0.0 && yy <= 0.0 && 4.0 * xx * yy >= xy * xy;
        let below = bend * half * half;
        let above = if is_concave { 0.0 } else { below };
        for lane in 0..N {
            let (x, y) = (x[lane], y[lane]);
            let value = constant + x * right + y * down + (xx * x * x + xy * x * y + yy * y * y);
            let slope = (right + 2.0 * xx * x + xy * y).abs() + (down + xy * x + 2.0 * yy * y).abs();
            let around = slope * half + size * ROUNDING;
            (least[lane], greatest[lane]) = (value - around - below, value + around + above);
        }
        [least, greatest]
    }
}

impl<const N: usize> Covers<N> {
    /// Mask of all squares.
    const ALL: u32 = if N < 32 { (1 << N) - 1 } else { u32::MAX };
}

impl<const N: usize> Squares<N> {
    /// Returns the squares extended by `by` to all sides.
    pub(super) fn widened(&self, by: f64) -> Self {
        Self { half: self.half + by, ..*self }
    }
}

/// Returns the indices of the numbers that satisfy a condition, as a bit mask.
#[inline(always)]
fn which<const N: usize>(numbers: &[f64; N], holds: impl Fn(f64) -> bool) -> u32 {
    (0..N).fold(0, |mask, lane| mask | u32::from(holds(numbers[lane])) << lane)
}

#[inline(always)]
fn lesser(one: f64, other: f64) -> f64 {
    if other < one { other } else { one }
}

#[inline(always)]
fn greater(one: f64, other: f64) -> f64 {
    if other > one { other } else { one }
}

impl Outline {
    /// Computes the outline of a shape. Returns `None` if no ray of the tile can hit it, and `Err` if the outline is unknown: the eye is on
    /// the surface, or numbers are too large.
    pub(super) fn of(shape: ShapeRef<'_>, rays: &TileRays) -> Result<Option<Self>, UnknownOutline> {
        let found = match shape {
            ShapeRef::Plane(plane) => {
                let (normal, height) = (plane.normal(), plane.normal().dot(rays.eye - plane.point()));
                if height == 0.0 {
                    return Ok(None);
                }
                let depth = Quadratic::linear(|direction| -normal.dot(direction) / height, rays);
                Some(Self {
                    inside: vec![depth],
                    depth: InverseDepth::Nearest(vec![depth]),
                    area: f64::INFINITY,
                })
            }
            ShapeRef::Sphere(Sphere { center, radius }) => Self::of_sphere(&rays.seen_from(*center), *radius),
            ShapeRef::AlignedBox(AlignedBox { min, max }) => {
                Self::of_box(&rays.seen_from(min.midpoint(*max)), (*max - *min) / 2.0)
            }
            ShapeRef::SphereImage(image) => {
                let (center, back) = image.back();
                Self::of_sphere(&rays.seen_from(center).mapped(back), image.radius())
            }
            ShapeRef::BoxImage(image) => {
                let forward = image.forward();
                let back = forward.matrix3.inverse();
                Self::of_box(&rays.seen_from(forward.translation).mapped(&back), image.half())
            }
            ShapeRef::Rod(rod) => {
                let [start, stop] = rod.ends();
                Self::of_rod(&rays.seen_from(start), stop - start, rod.radius(), rod.is_round())
            }
            ShapeRef::RodImage(image) => {
                let (start, back) = image.back();
                let own = rays.seen_from(start).mapped(back);
                Self::of_rod(&own, image.stop(), image.radius(), image.is_round())
            }
        };
        match found {
            Some(outline) if !outline.is_finite() => Err(UnknownOutline),
            Some(outline) => Ok(Some(outline)),
            None => Err(UnknownOutline),
        }
    }

    fn is_finite(&self) -> bool {
        let finite = |function: &Quadratic| {
            function.constant.is_finite()
                && function.linear.is_finite()
                && function.quadratic.iter().all(|term| term.is_finite())
        };
        let depths = match &self.depth {
            InverseDepth::Sphere { b, q, c } => c.is_finite() && finite(b) && finite(q),
            InverseDepth::Nearest(faces) | InverseDepth::Farthest(faces) => faces.iter().all(finite),
            InverseDepth::Rod(rod) => finite(&rod.rise) && rod.side.as_ref().is_none_or(Self::is_finite),
        };
        depths && self.inside.iter().all(finite)
    }

    /// Computes the outline of a sphere around the origin; `None` if the eye is on its surface.
    fn of_sphere(rays: &TileRays, radius: f64) -> Option<Self> {
        let (to_center, square) = (-rays.eye, radius * radius);
        let [x, y, z] = [rays.middle, rays.steps[0], rays.steps[1]];
        let crossed = [x, y, z].map(|direction| to_center.cross(direction));
        let product =
            |i: usize, j: usize| square * [x, y, z][i].dot([x, y, z][j]) - crossed[i].dot(crossed[j]);
        let q = Quadratic {
            constant: product(0, 0),
            linear: DVec2::new(2.0 * product(0, 1), 2.0 * product(0, 2)),
            quadratic: [product(1, 1), 2.0 * product(1, 2), product(2, 2)],
        };
        let b = Quadratic::linear(|direction| to_center.dot(direction), rays);
        let c = to_center.length_squared() - square;
        /// Minimum of |c| / radius² for an eye off the surface.
        const NEAR: f64 = 1e-9;
        if c.abs() < NEAR * square {
            return None;
        }
        let inside = if c > 0.0 { vec![q, b] } else { Vec::new() };
        let area = if c > 0.0 { q.area() } else { f64::INFINITY };
        Some(Self { inside, depth: InverseDepth::Sphere { b, q, c }, area })
    }

    /// Computes the outline of an axis-aligned box around the origin; `None` if the eye is on its surface.
    fn of_box(rays: &TileRays, half: DVec3) -> Option<Self> {
        let eye = rays.eye;
        // Signed distance of the eye from the plane of a face, positive outside.
        let outside = |axis: usize, side: f64| side * eye[axis] - half[axis];
        let sides = [-1.0, 1.0];
        let all = (0..3).flat_map(|axis| sides.map(|side| (axis, side)));
        let face = |(axis, side): (usize, f64)| {
            let height = outside(axis, side);
            Quadratic::linear(move |direction| -side * direction[axis] / height, rays)
        };
        if all.clone().all(|(axis, side)| outside(axis, side) < 0.0) {
            let depth = InverseDepth::Farthest(all.map(face).collect());
            return Some(Self { inside: Vec::new(), depth, area: f64::INFINITY });
        }
        let facing = |axis: usize, side: f64| outside(axis, side) > 0.0;
        let faces: Vec<Quadratic> = all.filter(|(axis, side)| facing(*axis, *side)).map(face).collect();
        if faces.is_empty() {
            return None;
        }
        let mut inside = Vec::with_capacity(6);
        for along in 0..3 {
            let (first, second) = ((along + 1) % 3, (along + 2) % 3);
            for (one, other) in sides.into_iter().flat_map(|one| sides.map(|other| (one, other))) {
                // The edge is on the silhouette only if exactly one of its faces faces the eye.
                if facing(first, one) == facing(second, other) {
                    continue;
                }
                let mut end = DVec3::ZERO;
                (end[first], end[second], end[along]) =
                    (one * half[first], other * half[second], half[along]);
                let start = end - eye - DVec3::AXES[along] * (2.0 * half[along]);
                let normal = start.cross(end - eye);
                // The centre of the box is on the positive side.
                let normal = normal * (-eye).dot(normal).signum();
                inside.push(Quadratic::linear(|direction| normal.dot(direction), rays));
            }
        }
        let area = rays.projected_area(half);
        Some(Self { inside, depth: InverseDepth::Nearest(faces), area })
    }

    /// Computes the outline of a rod from the origin to `stop`; `None` if the eye is within the box around it.
    fn of_rod(rays: &TileRays, stop: DVec3, radius: f64, is_round: bool) -> Option<Self> {
        /// The box is larger than the rod by more than the rounding of its position.
        const LARGER: f64 = 1.0 + 1e-9;
        let length = stop.length();
        let (one, other) = stop.try_normalize()?.any_orthonormal_pair();
        let own = rays.mapped(&DMat3::from_cols(one, stop / length, other).transpose());
        let beyond = if is_round { radius } else { 0.0 };
        let half = DVec3::new(radius, 0.5 * length + beyond, radius) * LARGER;
        let around = Self::of_box(&own.seen_from(DVec3::Y * (0.5 * length)), half)?;
        if matches!(around.depth, InverseDepth::Farthest(_)) {
            return None;
        }
        let across = DVec3::new(1.0, 0.0, 1.0);
        let flat = TileRays {
            eye: own.eye * across,
            middle: own.middle * across,
            steps: own.steps.map(|step| step * across),
        };
        let side = Self::of_sphere(&flat, radius).filter(|side| !side.inside.is_empty());
        let rise = Quadratic::linear(|direction| direction.y, &own);
        let rod = RodDepth { side, faces: around.depth, rise, start: own.eye.y, length };
        Some(Self { depth: InverseDepth::Rod(Box::new(rod)), ..around })
    }

    /// Computes the shape's coverage of squares.
    #[inline(always)]
    pub(super) fn covers<const N: usize>(&self, squares: &Squares<N>) -> Covers<N> {
        let (mut seen, mut whole) = (Covers::<N>::ALL, Covers::<N>::ALL);
        for function in &self.inside {
            let [least, greatest] = function.bounds(squares);
            seen &= !which(&greatest, |most| most <= 0.0);
            whole &= which(&least, |least| least > 0.0);
            if seen == 0 {
                break;
            }
        }
        let (depth, one_face) = self.depth.bounds(squares);
        if matches!(self.depth, InverseDepth::Rod(_)) {
            // The box around a rod may be visible beside it.
            whole &= one_face;
        }
        Covers { seen: seen & !which(&depth[1], |most| most <= 0.0), whole, one_face, depth }
    }

    /// Returns the points at which the rays through some positions hit the shape.
    #[inline(always)]
    pub(super) fn points<const N: usize>(&self, rays: &TileRays, places: [DVec2; N]) -> [DVec3; N] {
        let squares = Squares { x: places.map(|place| place.x), y: places.map(|place| place.y), half: 0.0 };
        let ([depth, _], _) = self.depth.bounds(&squares);
        std::array::from_fn(|index| {
            let DVec2 { x, y } = places[index];
            rays.eye + (rays.middle + rays.steps[0] * x + rays.steps[1] * y) / depth[index]
        })
    }
}

impl InverseDepth {
    /// Returns lower and upper bounds over squares, and the squares in which a single face is visible.
    #[inline(always)]
    fn bounds<const N: usize>(&self, squares: &Squares<N>) -> ([[f64; N]; 2], u32) {
        match self {
            Self::Sphere { b, q, c } => {
                let (mut b, mut q) = (b.bounds(squares), q.bounds(squares));
                for root in q.as_flattened_mut() {
                    *root = greater(0.0, *root).sqrt();
                }
                if *c <= 0.0 {
                    // The far side is visible from inside.
                    q = q.map(|roots| roots.map(|root| -root));
                    b.swap(0, 1);
                }
                let bound = |side: usize| std::array::from_fn(|lane| (b[side][lane] + q[side][lane]) / c);
                ([bound(0), bound(1)], Covers::<N>::ALL)
            }
            Self::Nearest(faces) => {
                let (mut least, mut most) = ([f64::INFINITY; N], [f64::INFINITY; N]);
                let mut others = [f64::INFINITY; N];
                // The face with the least upper bound is nearest. `others` bounds all other faces from below.
                for [low, high] in faces.iter().map(|face| face.bounds(squares)) {
                    for lane in 0..N {
                        let (before, is_nearest) = (least[lane], high[lane] < most[lane]);
                        others[lane] = lesser(others[lane], if is_nearest { before } else { low[lane] });
                        let is_beyond = is_nearest && before < low[lane];
                        others[lane] = if is_beyond { f64::NEG_INFINITY } else { others[lane] };
                        most[lane] = if is_nearest { high[lane] } else { most[lane] };
                        least[lane] = lesser(before, low[lane]);
                    }
                }
                let one_face = where_less(&most, &others);
                ([least, most], one_face)
            }
            Self::Farthest(faces) => {
                let (mut least, mut most) = ([f64::NEG_INFINITY; N], [f64::NEG_INFINITY; N]);
                let mut others = [f64::NEG_INFINITY; N];
                // The face with the greatest lower bound is visible. `others` bounds all other faces from above.
                for [low, high] in faces.iter().map(|face| face.bounds(squares)) {
                    for lane in 0..N {
                        let other = if low[lane] > least[lane] { most[lane] } else { high[lane] };
                        others[lane] = greater(others[lane], other);
                        least[lane] = greater(least[lane], low[lane]);
                        most[lane] = greater(most[lane], high[lane]);
                    }
                }
                let one_face = where_less(&others, &least);
                ([least, most], one_face)
            }
            Self::Rod(rod) => rod.bounds(squares),
        }
    }
}

impl RodDepth {
    /// Returns bounds of the inverse depth over squares, and the squares in which only the side is visible. Elsewhere, the lower bound is 0.
    #[inline(never)]
    fn bounds<const N: usize>(&self, squares: &Squares<N>) -> ([[f64; N]; 2], u32) {
        let ([_, mut most], _) = self.faces.bounds(squares);
        let (mut least, mut at_side) = ([0.0; N], 0);
        let Some(side) = &self.side else { return ([least, most], 0) };
        let (side, [low, high]) = (side.covers(squares), self.rise.bounds(squares));
        let beyond = self.length - self.start;
        for lane in 0..N {
            // The height of a hit over the start, and that of the stop over it, both over t.
            let [near, far] = [side.depth[0][lane], side.depth[1][lane]];
            let from_start = lesser(near * self.start, far * self.start) + low[lane];
            let from_stop = lesser(near * beyond, far * beyond) - high[lane];
            let least_height = far * self.length * 1e-9;
            if side.whole >> lane & 1 == 1 && from_start > least_height && from_stop > least_height {
                at_side |= 1 << lane;
                (least[lane], most[lane]) = (near, far);
            }
        }
        ([least, most], at_side)
    }
}

/// Returns the indices at which numbers are less than others, as a bit mask.
#[inline(always)]
pub(super) fn where_less<const N: usize>(numbers: &[f64; N], others: &[f64; N]) -> u32 {
    (0..N).fold(0, |mask, lane| mask | u32::from(numbers[lane] < others[lane]) << lane)
}

/// Error for a shape with an unknown outline.
#[derive(Clone, Copy, Debug)]
pub(super) struct UnknownOutline;

impl Quadratic {
    /// Returns the area of the ellipse in which the function is positive; infinite if it is not an ellipse.
    fn area(&self) -> f64 {
        let [xx, xy, yy] = self.quadratic;
        let determinant = 4.0 * xx * yy - xy * xy;
        if !(xx < 0.0 && determinant > 0.0) {
            return f64::INFINITY;
        }
        let DVec2 { x, y } = self.linear;
        let middle = DVec2::new(xy * y - 2.0 * yy * x, xy * x - 2.0 * xx * y) / determinant;
        let top = self.constant + 0.5 * self.linear.dot(middle);
        TAU * top.max(0.0) / determinant.sqrt()
    }
}

impl TileRays {
    /// Returns whether a ray of the tile may hit a box: `false` only if a plane through the eye, parallel to a coordinate axis, separates
    /// the box from all rays. The tree's frusta, which are rounded outwards, accept every box that this test accepts.
    pub(super) fn may_meet(&self, bounds: &Bounds) -> bool {
        let axis = self.middle.abs().max_position();
        let (sign, reach) = (self.middle[axis].signum(), HALF_TILE);
        let corners = [(-1.0, -1.0), (-1.0, 1.0), (1.0, -1.0), (1.0, 1.0)]
            .map(|(x, y)| self.middle + self.steps[0] * (x * reach) + self.steps[1] * (y * reach));
        if corners.iter().any(|corner| corner[axis] * sign <= 0.0) {
            return true;
        }
        let (min, max) = (bounds.min - self.eye, bounds.max - self.eye);
        let (near, far) = if sign > 0.0 { (min[axis], max[axis]) } else { (-max[axis], -min[axis]) };
        if far < 0.0 {
            return false;
        }
        let near = near.max(0.0);
        [(axis + 1) % 3, (axis + 2) % 3].into_iter().all(|across| {
            let slopes = corners.map(|corner| corner[across] / (corner[axis] * sign));
            let low = slopes.into_iter().fold(f64::INFINITY, f64::min);
            let high = slopes.into_iter().fold(f64::NEG_INFINITY, f64::max);
            min[across] <= (high * near).max(high * far) && max[across] >= (low * near).min(low * far)
        })
    }

    /// Returns the same rays with the origin moved to `point`.
    fn seen_from(&self, point: DVec3) -> Self {
        Self { eye: self.eye - point, ..*self }
    }

    fn mapped(&self, map: &DMat3) -> Self {
        Self { eye: *map * self.eye, middle: *map * self.middle, steps: self.steps.map(|step| *map * step) }
    }

    /// Returns the projected area of a box around the origin, or its least projected width times one pixel if that is smaller. Both are
    /// measured at the part of a long box nearest to the middle of the tile.
    fn projected_area(&self, half: DVec3) -> f64 {
        let to_screen = DMat3::from_cols(self.middle, self.steps[0], self.steps[1]).inverse();
        // The point on the box's longest axis nearest to the ray through the middle of the tile.
        let longest = half.max_position();
        let (axis, ray) = (DVec3::AXES[longest], self.middle);
        let (across, along) = (axis.dot(ray), ray.dot(ray));
        let apart = along - across * across;
        let nearest = if apart > 1e-12 * along {
            (along * axis.dot(self.eye) - across * ray.dot(self.eye)) / apart
        } else {
            0.0
        };
        let point = axis * nearest.clamp(-half[longest], half[longest]) - self.eye;
        let [depth, x, y] = (to_screen * point).to_array();
        if !(depth > 0.0 && x.is_finite() && y.is_finite()) {
            return f64::INFINITY;
        }
        let edges = [0, 1, 2].map(|side| {
            let [deeper, right, down] = (to_screen * (DVec3::AXES[side] * half[side])).to_array();
            DVec2::new(right - x / depth * deeper, down - y / depth * deeper) / depth
        });
        let crossed = |one: usize, other: usize| edges[one].perp_dot(edges[other]).abs();
        let area = 4.0 * (crossed(0, 1) + crossed(1, 2) + crossed(2, 0));
        let width = |side: usize| {
            let length = edges[side].length();
            let across = crossed(side, (side + 1) % 3) + crossed(side, (side + 2) % 3);
            if length > 0.0 { 2.0 * across / length } else { f64::INFINITY }
        };
        area.min(width(0)).min(width(1)).min(width(2))
    }
}
