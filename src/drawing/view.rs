//! Views of a scene from above, from the side and from the front.

use glam::{DMat3, DVec3};

use super::shapes::OutlinedShape;
use super::{Area, Axis, PagePoint, Plot, Svg, TextAnchor};

/// Style sheet of views, with mid-tones, which are visible on light and on dark backgrounds.
pub const VIEW_STYLE: &str = "
text { font: 11px sans-serif; fill: #808080 }
.title { font-size: 15px; font-weight: bold }
path, ellipse { fill: none; stroke-linejoin: round; stroke-linecap: round }
.axis { stroke: #808080; stroke-width: 1 }
.grid { stroke: #808080; stroke-width: 1; stroke-opacity: 0.22 }
.thing { stroke: #808080; stroke-width: 1; stroke-opacity: 0.55 }";

/// An orthographic view along a coordinate axis.
pub struct OrthographicView {
    name: String,
    /// The indices of the coordinates to the right, upwards, and along the line of sight.
    axes: [usize; 3],
    pub frame: Area,
    /// World point at the centre of the frame.
    center: DVec3,
    /// Pixels per scene unit.
    scale: f64,
}

impl OrthographicView {
    /// Creates two views, at the same scale, that show points and the outlines near them: from above and from the side, unless a path has a
    /// greater extent from the front than in one of these. `axes` are a camera's u, v and n, by which a right-handed space is told from a
    /// left-handed one. The coordinate axis nearest to `up` is the vertical one.
    pub fn pair(
        points: impl Iterator<Item = DVec3>,
        path: impl Iterator<Item = DVec3>,
        shapes: &[OutlinedShape],
        axes: Option<[DVec3; 3]>,
        up: DVec3,
        frames: [Area; 2],
    ) -> [Self; 2] {
        /// Width of the margin at each side, as a fraction of the frame.
        const MARGIN: f64 = 0.08;
        let (least, most) = bounds(points, shapes);
        let size = (most - least).max_element();
        let scale = (1.0 - 2.0 * MARGIN) * frames[0].width / if size > 0.0 { size } else { 10.0 };
        let center = 0.5 * least + 0.5 * most;
        let up = (1..3).fold(0, |most, axis| if up[axis].abs() >= up[most].abs() { axis } else { most });
        // The cross product of the next axis and the one after it is the vertical one.
        let (next, last) = ((up + 1) % 3, (up + 2) % 3);
        let above = match axes.is_some_and(|[right, up, ahead]| right.cross(up).dot(ahead) < 0.0) {
            false => ("from above", [last, next, up]),
            true => ("from above", [next, last, up]),
        };
        let side = ("from the side", [next.max(last), up, next.min(last)]);
        let front = ("from the front", [next.min(last), up, next.max(last)]);
        let (least, most) = bounds(path, &[]);
        let extent = |(_, [right, up, _]): (&str, [usize; 3])| (most - least)[right] * (most - least)[up];
        let views = [above, side, front];
        // Of equal ones, the later view is left out.
        let smallest = [2, 1, 0].into_iter().min_by(|a, b| extent(views[*a]).total_cmp(&extent(views[*b])));
        let pair = match smallest {
            Some(0) => [side, front],
            Some(1) => [above, front],
            _ => [above, side],
        };
        let [left, right] = frames;
        let view = |(side, axes): (&str, [usize; 3]), frame| {
            let [right, up] = [axes[0], axes[1]].map(|axis| ["x", "y", "z"][axis]);
            let name = format!("{side}: {right} to the right, {up} upwards");
            Self { name, axes, frame, center, scale }
        };
        [view(pair[0], left), view(pair[1], right)]
    }

    /// Draws the grid and the outlines. Everything drawn until [`Self::end`] is clipped to the frame.
    pub fn begin(&self, svg: &mut Svg, shapes: &[OutlinedShape]) {
        self.grid(svg);
        svg.clip(self.frame);
        for shape in shapes {
            self.outline(svg, shape);
        }
    }

    pub fn end(&self, svg: &mut Svg) {
        svg.end_group();
        svg.outline("axis", self.frame);
    }

    /// Projects a point of the world onto the page.
    pub fn project(&self, point: DVec3) -> PagePoint {
        let [right, up] = self.across(point - self.center);
        let [x, y] = self.frame.middle();
        [x + right * self.scale, y - up * self.scale]
    }

    /// Returns the components of a vector to the right and upwards.
    pub fn across(&self, vector: DVec3) -> [f64; 2] {
        [vector[self.axes[0]], vector[self.axes[1]]]
    }

    fn grid(&self, svg: &mut Svg) {
        let half = 0.5 * self.frame.width / self.scale;
        let [x, y] = self.across(self.center).map(|middle| Axis::linear((middle - half, middle + half), 7.0));
        let Area { left, top, width, height } = self.frame;
        let [zero_x, zero_y] = self.project(DVec3::ZERO);
        // The position of the origin and the scale allow a page to find the place of every point.
        let view = format!(
            "{left} {top} {width} {height} {} {} {zero_x} {zero_y} {}",
            self.axes[0], self.axes[1], self.scale
        );
        svg.grid(&view, |svg| Plot { area: self.frame, x, y }.draw(svg));
        svg.text("", [self.frame.left, self.frame.top - 8.0], TextAnchor::Start, &self.name);
    }

    /// Draws an outline, unless it is outside the frame or so large that it would appear as a line.
    fn outline(&self, svg: &mut Svg, shape: &OutlinedShape) {
        if let Some((middle, radius)) = shape.extent() {
            let reach = radius * self.scale;
            let around = Area::around(self.project(middle), [reach; 2]);
            if !self.frame.overlaps(&around) || reach > 20.0 * self.frame.width {
                return;
            }
        }
        match shape {
            OutlinedShape::Ball { center, image } => self.ellipse(svg, *center, *image),
            OutlinedShape::Rod { ends, halves: [one, other], ball } => {
                let image = ball.unwrap_or(DMat3::from_cols(*one, *other, DVec3::ZERO));
                ends.iter().for_each(|end| self.ellipse(svg, *end, image));
                // The two lines of the side that are farthest from the axis: the tangents of both ellipses.
                let [along, upwards] = self.across(ends[1] - ends[0]);
                let away = |vector: DVec3| {
                    let [x, y] = self.across(vector);
                    x * upwards - y * along
                };
                let (first, second) = (away(*one), away(*other));
                let size = libm::hypot(first, second);
                if size > 0.0 {
                    let half = (*one * first + *other * second) / size;
                    let edge = |half: DVec3| ends.map(|end| self.project(end + half)).to_vec();
                    svg.lines("thing", &[edge(half), edge(-half)]);
                }
            }
            OutlinedShape::Box(corners) => {
                let edges = (0..8_usize).flat_map(|corner| [1, 2, 4].map(|bit| (corner, corner | bit)));
                let edges = edges.filter(|(one, other)| one != other);
                let edge = |(one, other): (usize, usize)| {
                    vec![self.project(corners[one]), self.project(corners[other])]
                };
                svg.lines("thing", &edges.map(edge).collect::<Vec<_>>());
            }
            OutlinedShape::Plane { point, normal } => self.plane(svg, *point, *normal),
        }
    }

    /// Draws the image of the unit ball under a linear map, around a centre.
    fn ellipse(&self, svg: &mut Svg, center: DVec3, image: DMat3) {
        let [a, b] = [self.axes[0], self.axes[1]].map(|axis| image.row(axis) * self.scale);
        // The projection of the unit ball is an ellipse. Its radii are the square roots of the eigenvalues of (a b)^T (a b).
        let (mean, half) = (0.5 * (a.dot(a) + b.dot(b)), 0.5 * (a.dot(a) - b.dot(b)));
        let apart = libm::hypot(half, a.dot(b));
        let radii = [mean + apart, (mean - apart).max(0.0)].map(f64::sqrt);
        let degrees = (0.5 * libm::atan2(a.dot(b), half)).to_degrees();
        svg.ellipse("thing", self.project(center), radii, -degrees);
    }

    /// Draws a plane as a line, if it is seen edge-on.
    fn plane(&self, svg: &mut Svg, point: DVec3, normal: DVec3) {
        if normal[self.axes[2]].abs() > 1e-6 {
            return;
        }
        let [right, up] = self.across(normal);
        let ([x, y], middle) = (self.project(point), self.frame.middle());
        // The y axis of the page points down.
        let away = (middle[0] - x) * right - (middle[1] - y) * up;
        let foot = [middle[0] - away * right, middle[1] + away * up];
        let reach = 2.0 * self.frame.width;
        let end = |sign: f64| [foot[0] + sign * reach * up, foot[1] + sign * reach * right];
        svg.line("thing", end(-1.0), end(1.0));
    }
}

/// Draws the outlines in two square views, one above the other, that show these points, for a page with its own style sheet.
pub fn draw_map(
    name: &str,
    points: impl Iterator<Item = DVec3>,
    shapes: &[OutlinedShape],
    axes: [DVec3; 3],
    up: DVec3,
) -> String {
    let mut svg = Svg::new(PAGE_SIZE, name);
    for view in OrthographicView::pair(points, std::iter::empty(), shapes, Some(axes), up, page_frames()) {
        view.begin(&mut svg, shapes);
        view.end(&mut svg);
    }
    svg.finish()
}

/// Size of a drawing for a page.
pub(super) const PAGE_SIZE: PagePoint = [300.0, 596.0];

/// Returns the frames of two views, one above the other, in a drawing for a page.
pub(super) fn page_frames() -> [Area; 2] {
    [16.0, 316.0].map(|top| Area { left: 34.0, top, width: 260.0, height: 260.0 })
}

/// Returns the bounds of points, and of the outlines near them.
fn bounds(points: impl Iterator<Item = DVec3>, shapes: &[OutlinedShape]) -> (DVec3, DVec3) {
    let (mut least, mut most) = (DVec3::INFINITY, DVec3::NEG_INFINITY);
    for point in points {
        (least, most) = (least.min(point), most.max(point));
    }
    if !least.is_finite() {
        return (DVec3::ZERO, DVec3::ZERO);
    }
    let reach = (most - least).max_element();
    let (near_least, near_most) = (least - 0.5 * reach, most + 0.5 * reach);
    for (middle, radius) in shapes.iter().filter_map(OutlinedShape::extent) {
        let (low, high) = (middle - radius, middle + radius);
        if reach == 0.0 || low.cmpge(near_least).all() && high.cmple(near_most).all() {
            (least, most) = (least.min(low), most.max(high));
        }
    }
    (least, most)
}
