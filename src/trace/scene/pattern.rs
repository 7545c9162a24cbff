//! Patterns: the fraction of a second colour at each point of a surface.
//!
//! A pattern is a function of the point in the shape's local space, so that it moves, turns and stretches with the shape. Spheres are cut
//! out of a solid pattern. On planes and on the faces of boxes, the coordinate across the surface is the same at all points, but its computed
//! value varies with rounding; a border between two cells that lies in the surface would show as speckles. Therefore:
//!
//! - Checkers and bricks ignore the coordinate across the surface. They are two-dimensional on planes and faces.
//! - Stripes and gradients use the exact coordinate of a face, and on planes a direction without the component across the plane. If the
//!   border of a stripe lies in the surface, the surface has the colour of the inside: of the inside of a box, or of the side of a plane
//!   that is opposite to its normal.
//! - Noise is continuous.

use glam::{DAffine3, DMat3, DVec3};

use super::pattern_function::{
    BORDER_OFFSET, BrickPart, PatternFunction, SMALL_PART, SMOOTH, bond, fraction, in_joint, in_stripe,
    noise_blend, row_axis, unit,
};
use super::plane_axes::axes_across;
use crate::trace::shapes::inverse;

/// A pattern on a surface, in the shape's local space.
#[derive(Clone, Debug, PartialEq)]
pub struct PatternLayout {
    forward: DMat3,
    inverse: DMat3,
    translation: DVec3,
    surface: PatternedSurface,
    function: PatternFunction,
    /// The direction of the function, without its component across a plane.
    along: DVec3,
}

/// The surface of a pattern.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum PatternedSurface {
    /// A sphere around the origin.
    Sphere,
    /// A plane through the origin, with its unit normal.
    Plane {
        /// The unit normal.
        normal: DVec3,
        /// The axes of two-dimensional patterns.
        axes: [DVec3; 2],
        /// The coordinate axes to which they belong.
        columns: [usize; 2],
    },
    /// A cylinder, with flat ends, or a capsule.
    Rod {
        /// The ends of the axis.
        ends: [DVec3; 2],
        /// The radius.
        radius: f64,
        /// True for a cylinder.
        is_flat: bool,
    },
    /// A box around the origin, with its half-extents. Two-dimensional patterns start at the lower corner of each face.
    Box(DVec3),
}

/// The coordinate axis across a surface. [`SOLID`] if there is none.
type Across = usize;
const SOLID: Across = 3;

impl PatternedSurface {
    /// Creates the surface of a plane through the origin. A normal without a direction is replaced by the y axis.
    #[must_use]
    pub fn plane(normal: DVec3) -> Self {
        let axes = axes_across(normal);
        let normal = unit(normal).unwrap_or(DVec3::Y);
        let across = normal.abs().max_position();
        let [first, second] = [(across + 1) % 3, (across + 2) % 3];
        let is_along = |columns: [usize; 2]| (axes[0][columns[0]] * axes[1][columns[1]]).abs();
        let columns = if is_along([first, second]) >= is_along([second, first]) {
            [first, second]
        } else {
            [second, first]
        };
        Self::Plane { normal, axes, columns }
    }
}

impl PatternLayout {
    /// Creates the pattern of a surface that `map` takes to its place in the world. Returns `None` if a size is not greater
    /// than 0, a direction is zero or not finite, or an offset, a mortar or a contrast is not finite.
    #[must_use]
    pub fn new(map: DAffine3, surface: PatternedSurface, function: PatternFunction) -> Option<Self> {
        let function = function.prepared()?;
        let direction = function.direction();
        let along = match surface {
            PatternedSurface::Plane { normal, .. } => without(direction, normal),
            PatternedSurface::Sphere | PatternedSurface::Rod { .. } | PatternedSurface::Box(_) => direction,
        };
        let (forward, translation) = (map.matrix3, map.translation);
        Some(Self { forward, inverse: inverse(forward), translation, surface, function, along })
    }

    /// Returns a code that differs between functions, for fingerprints.
    pub(super) fn code(&self) -> u32 {
        self.function.code()
    }

    /// Passes the numbers that define the pattern to `each`.
    pub(super) fn numbers(&self, mut each: impl FnMut(f64)) {
        let Self { forward, inverse: _, translation, surface, function, along: _ } = self;
        let mut all = |vector: DVec3| vector.to_array().into_iter().for_each(&mut each);
        [forward.x_axis, forward.y_axis, forward.z_axis, *translation].into_iter().for_each(&mut all);
        match surface {
            PatternedSurface::Sphere => {}
            PatternedSurface::Rod { ends: [from, to], radius, is_flat } => {
                [*from, *to, DVec3::new(*radius, f64::from(u8::from(*is_flat)), 0.0)]
                    .into_iter()
                    .for_each(&mut all);
            }
            PatternedSurface::Plane { axes, .. } => axes.iter().copied().for_each(&mut all),
            PatternedSurface::Box(half) => all(*half),
        }
        function.numbers(each);
    }

    /// Returns the fraction of the second colour at a point of the surface with this normal.
    pub(crate) fn second_fraction(&self, point: DVec3, normal: DVec3) -> f32 {
        let own = self.to_local(point);
        let across = match &self.surface {
            PatternedSurface::Sphere | PatternedSurface::Rod { .. } => SOLID,
            PatternedSurface::Plane { normal, .. } => normal.abs().max_position(),
            PatternedSurface::Box(_) => {
                // A face's normal is mapped back by the transpose, up to its length.
                let across = (self.forward.transpose() * normal).abs();
                if across.x >= across.y && across.x >= across.z {
                    0
                } else if across.y >= across.z {
                    1
                } else {
                    2
                }
            }
        };
        let is_second = match self.function {
            PatternFunction::Checker { size } => {
                let cells = (self.cells(own, across) / size).floor();
                axes(across).map(|axis| cells[axis]).sum::<f64>().rem_euclid(2.0) == 1.0
            }
            PatternFunction::Stripes { size, ratio, offset, .. } => {
                in_stripe(self.stripes(own, across, size, offset), ratio)
            }
            PatternFunction::Bricks { size, mortar } => {
                let (places, row) = (self.cells(own, across) / size, row_axis(across));
                let shift = bond(places[row].floor());
                let is_joint = |axis: usize| {
                    let place = places[axis] + if axis == row { 0.0 } else { shift };
                    in_joint(place, 0.5 * mortar / size[axis])
                };
                axes(across).any(is_joint)
            }
            PatternFunction::Gradient { size, offset, .. } => {
                return fraction(self.gradient(own, across, size, offset));
            }
            PatternFunction::Noise { size, octaves, contrast } => {
                return fraction(noise_blend(own / size, octaves, contrast));
            }
        };
        f32::from(u8::from(is_second))
    }

    /// Returns the width of the pattern's narrowest part, relative to the area between some points: those of the corners and of the middle of a
    /// small quadrangle in an image of the surface. On planes and boxes, it is flat. The width is 0 if it is not known, and infinite for
    /// blends. `None` if the surface looks smooth: no border of the pattern lies between the points, and blends change by at most [`SMOOTH`].
    ///
    /// A wrong `None` would hide a border from the search for features, so that a pixel could be finished after samples on one side of it.
    /// Too small a width costs samples.
    pub(crate) fn part_width(&self, points: [DVec3; 5]) -> Option<f64> {
        let Some(patch) = self.patch(points) else { return Some(0.0) };
        let across = patch.across;
        let (is_smooth, width) = match self.function {
            PatternFunction::Checker { size } => {
                let place = |axis| move |own| self.cells(own, across)[axis] / size;
                let spans = axes(across).map(|axis| patch.bounds(place(axis), 1.0 / size));
                spans.fold((true, f64::INFINITY), |(is_smooth, width), [least, most]| {
                    (is_smooth && least.floor() == most.floor(), width.min(1.0 / (most - least)))
                })
            }
            PatternFunction::Stripes { size, ratio, offset, .. } => {
                let [least, most] = patch.bounds(|own| self.stripes(own, across, size, offset), 1.0 / size);
                let is_smooth =
                    least.floor() == most.floor() && in_stripe(least, ratio) == in_stripe(most, ratio);
                (is_smooth, ratio.min(1.0 - ratio) / (most - least))
            }
            PatternFunction::Bricks { size, mortar } => {
                let span = |axis: usize, shift: f64| {
                    let place = |own| self.cells(own, across)[axis] / size[axis] + shift;
                    patch.bounds(place, 1.0 / size[axis])
                };
                let part = |axis, shift| BrickPart::of(span(axis, shift), 0.5 * mortar / size[axis]);
                let row = row_axis(across);
                let is_smooth = if let BrickPart::Brick(number) = part(row, 0.0) {
                    let parts =
                        || axes(across).filter(|axis| *axis != row).map(|axis| part(axis, bond(number)));
                    parts().any(|part| part == BrickPart::Joint)
                        || parts().all(|part| part != BrickPart::Several)
                } else {
                    part(row, 0.0) == BrickPart::Joint
                };
                let widths = axes(across).map(|axis| {
                    let [least, most] = span(axis, 0.0);
                    mortar.min(size[axis] - mortar) / size[axis] / (most - least)
                });
                (is_smooth, widths.fold(f64::INFINITY, f64::min))
            }
            PatternFunction::Gradient { size, offset, .. } => {
                let [least, most] = patch.bounds(|own| self.gradient(own, across, size, offset), 1.0 / size);
                (fraction(most) - fraction(least) <= SMOOTH, f64::INFINITY)
            }
            PatternFunction::Noise { size, octaves, contrast } => {
                let smallest = size / (f64::from(1_u32 << (octaves - 1)) * contrast.max(1.0));
                if patch.ball().1 > SMALL_PART * smallest {
                    return Some(0.0);
                }
                let mut range = [f64::INFINITY, f64::NEG_INFINITY];
                let is_smooth = patch.points.into_iter().all(|own| {
                    let value = f64::from(fraction(noise_blend(own / size, octaves, contrast)));
                    range = [range[0].min(value), range[1].max(value)];
                    range[1] - range[0] <= SMOOTH.into()
                });
                (is_smooth, f64::INFINITY)
            }
        };
        (!is_smooth).then_some(width)
    }

    /// Returns the part of the surface between some points. `None` if it is not known.
    fn patch(&self, points: [DVec3; 5]) -> Option<Patch> {
        let points = points.map(|point| self.to_local(point));
        let across = match &self.surface {
            PatternedSurface::Sphere | PatternedSurface::Rod { .. } => SOLID,
            PatternedSurface::Plane { normal, .. } => normal.abs().max_position(),
            PatternedSurface::Box(_) => {
                let least = points.into_iter().fold(DVec3::INFINITY, DVec3::min);
                (points.into_iter().fold(DVec3::NEG_INFINITY, DVec3::max) - least).min_position()
            }
        };
        let patch = Patch { points, across };
        // Large parts of a curved surface can reach beyond the ball.
        let is_small = || {
            let size = patch.ball().1;
            match self.surface {
                PatternedSurface::Rod { radius, .. } => size <= 0.5 * radius,
                _ => points.iter().all(|point| size <= 0.5 * point.length()),
            }
        };
        let is_known = points.iter().all(|point| point.is_finite()) && (across != SOLID || is_small());
        is_known.then_some(patch)
    }

    /// Returns a point of the world in the shape's local space. Points of a cylinder's flat ends are moved inside by a trifle, so that an end
    /// that lies in a border of the pattern has the colour of the inside.
    fn to_local(&self, point: DVec3) -> DVec3 {
        const INSIDE: f64 = 1e-9;
        let own = self.inverse * (point - self.translation);
        let PatternedSurface::Rod { ends: [from, to], is_flat: true, .. } = self.surface else { return own };
        let axis = to - from;
        let along = (own - from).dot(axis) / axis.length_squared();
        own + axis * (along.clamp(INSIDE, 1.0 - INSIDE) - along)
    }

    /// Returns the coordinates of cells. The one across the surface has no meaning.
    fn cells(&self, own: DVec3, across: Across) -> DVec3 {
        match &self.surface {
            PatternedSurface::Sphere | PatternedSurface::Rod { .. } => own,
            PatternedSurface::Plane { axes, columns, .. } => {
                let mut cells = DVec3::ZERO;
                columns.iter().zip(axes).for_each(|(column, axis)| cells[*column] = own.dot(*axis));
                cells
            }
            PatternedSurface::Box(half) => {
                let mut cells = own + *half;
                cells[across] = 0.0;
                cells
            }
        }
    }

    /// Returns the coordinate across stripes, in units of their size. Borders in the surface are outside.
    fn stripes(&self, own: DVec3, across: Across, size: f64, offset: f64) -> f64 {
        let (along, inwards) = self.along(own, across);
        (along - offset) / size + inwards * BORDER_OFFSET
    }

    /// Returns the value of a gradient: 0 at its start and 1 at its end.
    fn gradient(&self, own: DVec3, across: Across, size: f64, offset: f64) -> f64 {
        (self.along(own, across).0 - offset) / size + 0.5
    }

    /// Returns the coordinate along the direction of the function, and the component of the direction towards the inside of a flat surface.
    fn along(&self, own: DVec3, across: Across) -> (f64, f64) {
        match &self.surface {
            PatternedSurface::Sphere | PatternedSurface::Rod { .. } => (self.along.dot(own), 0.0),
            PatternedSurface::Plane { normal, .. } => {
                (self.along.dot(own), -self.function.direction().dot(*normal))
            }
            PatternedSurface::Box(half) => {
                let (mut own, side) = (own, own[across].signum());
                own[across] = half[across] * side;
                (self.along.dot(own), -self.along[across] * side)
            }
        }
    }
}

/// Returns the coordinate axes of a pattern.
fn axes(across: Across) -> impl Iterator<Item = usize> {
    (0..3).filter(move |axis| *axis != across)
}

/// A small part of a surface in the shape's local space: the corners of a quadrangle in an image of it, and the middle.
struct Patch {
    points: [DVec3; 5],
    across: Across,
}

impl Patch {
    /// Returns bounds of a linear function whose gradient has the length `slope`.
    fn bounds(&self, value: impl Fn(DVec3) -> f64, slope: f64) -> [f64; 2] {
        if self.across == SOLID {
            let (middle, radius) = self.ball();
            let (middle, reach) = (value(middle), radius * slope);
            return [middle - reach, middle + reach];
        }
        bounds_of(self.points.map(value))
    }

    /// Returns the centre and the radius of a ball around the part, for a part of a sphere that is small.
    ///
    /// The border consists of arcs of circles through neighbouring corners, each less than half a circle. By Thales' theorem, an arc is inside
    /// the ball whose diameter is its chord. So the border is inside a ball around the mean of the points, and with it the smaller of the two
    /// parts into which the border divides the sphere. The middle shows which part it is.
    fn ball(&self) -> (DVec3, f64) {
        let mean = self.points.iter().sum::<DVec3>() / 5.0;
        let farthest = self.points.iter().map(|point| point.distance(mean)).fold(0.0, f64::max);
        // A chord is at most twice as long as the distance of its farther end from the mean.
        (mean, 2.0 * farthest)
    }
}

fn bounds_of(values: [f64; 5]) -> [f64; 2] {
    [values.into_iter().fold(f64::INFINITY, f64::min), values.into_iter().fold(f64::NEG_INFINITY, f64::max)]
}

/// Returns the part of a unit vector that is perpendicular to a unit normal. Components that are 0 but for rounding are 0.
fn without(direction: DVec3, normal: DVec3) -> DVec3 {
    const NONE: f64 = 16.0 * f64::EPSILON;
    let rest = direction - normal * normal.dot(direction);
    DVec3::select(rest.abs().cmple(DVec3::splat(NONE)), DVec3::ZERO, rest)
}

#[cfg(test)]
mod tests {
    use glam::DQuat;
    use proptest::prelude::*;

    use super::*;
    use crate::trace::math::uniform;

    fn vector() -> impl Strategy<Value = DVec3> {
        (-1.0..1.0, -1.0..1.0, -1.0..1.0).prop_map(DVec3::from)
    }

    fn function() -> impl Strategy<Value = PatternFunction> {
        let size = || prop_oneof![Just(0.5), 0.05..2.0];
        let direction = || prop_oneof![Just(DVec3::X), Just(DVec3::Y), vector()];
        prop_oneof![
            size().prop_map(|size| PatternFunction::Checker { size }),
            (size(), 0.0..1.0, direction(), -1.0..1.0).prop_map(|(size, ratio, direction, offset)| {
                PatternFunction::Stripes { size, ratio, direction, offset }
            }),
            ((size(), size(), size()), 0.0..0.3)
                .prop_map(|(size, mortar)| PatternFunction::Bricks { size: size.into(), mortar }),
            (size(), direction(), -1.0..1.0)
                .prop_map(|(size, direction, offset)| PatternFunction::Gradient { size, direction, offset }),
            (size(), 1..5u32, 0.0..4.0).prop_map(|(size, octaves, contrast)| PatternFunction::Noise {
                size,
                octaves,
                contrast
            }),
        ]
    }

    /// A pixel's view of a surface of the given kind: the point and the normal at a place in the pixel, from -1 to 1 in both directions, in
    /// the shape's own space.
    #[derive(Clone, Copy, Debug)]
    struct PixelView {
        surface: usize,
        middle: DVec3,
        steps: [DVec3; 2],
        normal: DVec3,
    }

    const HALF: DVec3 = DVec3::new(0.75, 0.5, 1.0);

    impl PixelView {
        fn surface(&self) -> PatternedSurface {
            match self.surface {
                0 => PatternedSurface::Sphere,
                1 => PatternedSurface::plane(self.normal),
                _ => PatternedSurface::Box(HALF),
            }
        }

        /// Returns the point that a ray from `middle` hits on the unit sphere, or the point on the plane or face.
        fn at(&self, x: f64, y: f64) -> Option<(DVec3, DVec3)> {
            let [right, down] = self.steps;
            match self.surface {
                0 => {
                    let eye = self.middle * 3.0;
                    let towards = self.normal - eye + right * x + down * y;
                    let (a, b) = (towards.length_squared(), eye.dot(towards));
                    let rest = b * b - a * (eye.length_squared() - 1.0);
                    let root = if eye.length() > 1.0 { -rest.sqrt() } else { rest.sqrt() };
                    let point = eye + towards * ((root - b) / a);
                    (rest > 0.0 && (root - b) > 0.0).then_some((point, point))
                }
                1 => {
                    let normal = unit(self.normal)?;
                    let point = self.middle * 4.0 + right * x + down * y;
                    Some((point - normal * normal.dot(point), normal))
                }
                _ => {
                    let across = self.normal.abs().max_position();
                    let mut point = self.middle * HALF + right * x + down * y;
                    point[across] = HALF[across] * self.normal[across].signum();
                    Some((point, DVec3::AXES[across]))
                }
            }
        }
    }

    fn view() -> impl Strategy<Value = PixelView> {
        let normal = prop_oneof![Just(DVec3::Y), vector()];
        (0..3usize, vector(), (vector(), vector(), -4..0), normal).prop_map(
            |(surface, middle, (right, down, size), normal)| {
                let steps = [right, down].map(|step| step * libm::exp10(f64::from(size)));
                PixelView { surface, middle, steps, normal }
            },
        )
    }

    const CORNERS: [(f64, f64); 5] = [(-1.0, -1.0), (1.0, -1.0), (-1.0, 1.0), (1.0, 1.0), (0.0, 0.0)];

    /// Returns the least and the greatest fraction in a pixel, and whether the pattern holds. `None` if the pixel shows the surface's edge.
    fn seen(view: &PixelView, function: PatternFunction) -> Option<([f32; 2], bool)> {
        let rotation = DQuat::from_rotation_x(0.7) * DQuat::from_rotation_y(1.1);
        let map = DAffine3::from_scale_rotation_translation(DVec3::new(1.5, 0.5, -1.0), rotation, HALF);
        let layout = PatternLayout::new(map, view.surface(), function)?;
        let mut values = [f32::INFINITY, f32::NEG_INFINITY];
        for index in 0..60 {
            let [x, y] = [1, 2].map(|axis| 2.0 * uniform(axis, index) - 1.0);
            let (point, normal) = view.at(x, y)?;
            let normal = map.matrix3.inverse().transpose() * normal;
            let value = layout.second_fraction(map.transform_point3(point), normal);
            values = [values[0].min(value), values[1].max(value)];
        }
        let mut corners = [DVec3::ZERO; 5];
        for (corner, (x, y)) in corners.iter_mut().zip(CORNERS) {
            *corner = map.transform_point3(view.at(x, y)?.0);
        }
        Some((values, layout.part_width(corners).is_none()))
    }

    proptest! {
        #![proptest_config(ProptestConfig::with_cases(20_000))]

        #[test]
        fn patterns_that_hold_look_smooth(view in view(), function in function()) {
            let Some(([least, most], holds)) = seen(&view, function) else { return Ok(()) };
            prop_assert!((0.0..=1.0).contains(&least) && (0.0..=1.0).contains(&most));
            // The corners and the middle show noise but for its curvature.
            prop_assert!(!holds || most - least <= 2.0 * SMOOTH, "{least} to {most}");
        }
    }

    #[test]
    fn the_narrowest_part_is_measured_at_borders() {
        let checker = PatternFunction::Checker { size: 1.0 };
        let stripes = PatternFunction::Stripes { size: 1.0, ratio: 0.1, direction: DVec3::X, offset: 0.0 };
        let bricks = PatternFunction::Bricks { size: DVec3::ONE, mortar: 0.1 };
        let gradient = PatternFunction::Gradient { size: 1.0, direction: DVec3::X, offset: 0.0 };
        let noise = PatternFunction::Noise { size: 1.0, octaves: 1, contrast: 1.0 };
        for (function, (middle, width), expected) in [
            (checker, (0.5, 0.25), None),
            (checker, (0.0, 0.25), Some(4.0)),
            (stripes, (0.5, 0.025), None),
            (stripes, (0.9, 0.025), Some(4.0)),
            (bricks, (0.5, 0.025), None),
            (bricks, (0.05, 0.025), Some(4.0)),
            (gradient, (0.0, 0.01), None),
            (gradient, (0.0, 0.5), Some(f64::INFINITY)),
            (noise, (0.3, 0.08), Some(f64::INFINITY)),
            (noise, (0.3, 0.2), Some(0.0)),
        ] {
            let surface = PatternedSurface::plane(DVec3::Y);
            let layout = PatternLayout::new(DAffine3::IDENTITY, surface, function).unwrap();
            let corner =
                |(x, z): (f64, f64)| DVec3::new(middle + 0.5 * width * x, 0.0, 0.5 + 0.5 * width * z);
            let found = layout.part_width(CORNERS.map(corner));
            let is_close = match (found, expected) {
                (Some(found), Some(expected)) => found == expected || (found - expected).abs() < 1e-9,
                _ => found == expected,
            };
            assert!(is_close, "{function:?} at {middle}, {width} wide: {found:?}");
        }
    }

    /// Checks that most small pixels hold: otherwise they would all take several samples.
    #[test]
    fn patterns_hold_in_most_small_pixels() {
        for surface in 0..3 {
            for function in [
                PatternFunction::Checker { size: 0.5 },
                PatternFunction::Stripes { size: 0.5, ratio: 0.3, direction: DVec3::ONE, offset: 0.1 },
                PatternFunction::Bricks { size: DVec3::new(0.5, 0.25, 0.25), mortar: 0.05 },
                PatternFunction::Gradient { size: 1.0, direction: DVec3::ONE, offset: 0.0 },
                PatternFunction::Noise { size: 1.0, octaves: 3, contrast: 1.0 },
            ] {
                let (mut all, mut held) = (0, 0);
                for index in 0..400 {
                    let random = |key: u64| 2.0 * uniform(key, index) - 1.0;
                    let vector = |key| DVec3::new(random(key), random(key + 1), random(key + 2));
                    let steps = [vector(3) * 1e-3, vector(6) * 1e-3];
                    let view = PixelView { surface, middle: vector(0), steps, normal: vector(9) };
                    if let Some((_, holds)) = seen(&view, function) {
                        (all, held) = (all + 1, held + usize::from(holds));
                    }
                }
                assert!(all > 150 && held * 10 > all * 8, "{surface} {function:?}: {held} of {all}");
            }
        }
    }
}
