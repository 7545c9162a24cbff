//! Views of the path from above and from the side.

use glam::DVec3;

use super::chart::thinned;
use super::sample::{CameraPath, CameraSample};
use super::shapes::OutlinedShape;
use crate::cli::svg::{Anchor, Area, Axis, Labels, PagePoint, Plot, Svg, directions};

/// An orthographic view along a coordinate axis.
struct OrthographicView {
    name: &'static str,
    /// The indices of the coordinates to the right, upwards, and along the line of sight.
    axes: [usize; 3],
    frame: Area,
    /// World point at the centre of the frame.
    center: DVec3,
    /// Pixels per scene unit.
    scale: f64,
}

/// Draws the path from above and from the side, at the same scale.
pub(super) fn draw(svg: &mut Svg, path: &CameraPath, [left, right]: [Area; 2]) {
    /// Width of the margin at each side, as a fraction of the frame.
    const MARGIN: f64 = 0.08;
    let (least, most) = bounds(path);
    let size = (most - least).max_element();
    let scale = (1.0 - 2.0 * MARGIN) * left.width / if size > 0.0 { size } else { 10.0 };
    let center = 0.5 * least + 0.5 * most;
    let view = |name, axes, frame| OrthographicView { name, axes, frame, center, scale };
    let views = [
        match path.is_right_handed() {
            false => view("from above: x to the right, z upwards", [0, 2, 1], left),
            true => view("from above: z to the right, x upwards", [2, 0, 1], left),
        },
        view("from the side: z to the right, y upwards", [2, 1, 0], right),
    ];
    let stride = views.iter().map(|view| view.tick_stride(path)).min().unwrap_or(1);
    for view in &views {
        view.draw(svg, path, stride);
    }
    legend(svg, [left.left, left.bottom() + 46.0], stride, path);
}

/// Returns the bounds of the path, its targets and the outlines near them.
fn bounds(path: &CameraPath) -> (DVec3, DVec3) {
    let seen = path.samples.iter().flat_map(|sample| [Some(sample.eye), sample.target]).flatten();
    let (mut least, mut most) = (DVec3::INFINITY, DVec3::NEG_INFINITY);
    for point in seen {
        (least, most) = (least.min(point), most.max(point));
    }
    if !least.is_finite() {
        return (DVec3::ZERO, DVec3::ZERO);
    }
    let reach = (most - least).max_element();
    let (near_least, near_most) = (least - 0.5 * reach, most + 0.5 * reach);
    for (middle, radius) in path.shapes.iter().filter_map(OutlinedShape::extent) {
        let (low, high) = (middle - radius, middle + radius);
        if reach == 0.0 || low.cmpge(near_least).all() && high.cmple(near_most).all() {
            (least, most) = (least.min(low), most.max(high));
        }
    }
    (least, most)
}

impl OrthographicView {
    /// Projects a point of the world onto the page.
    fn project(&self, point: DVec3) -> PagePoint {
        let [right, up] = self.across(point - self.center);
        let [x, y] = self.frame.middle();
        [x + right * self.scale, y - up * self.scale]
    }

    /// Returns the components of a vector to the right and upwards.
    fn across(&self, vector: DVec3) -> [f64; 2] {
        [vector[self.axes[0]], vector[self.axes[1]]]
    }

    /// Returns the number of frames between ticks. There are at most 240 ticks, at least 4 pixels apart on average.
    fn tick_stride(&self, path: &CameraPath) -> usize {
        const NEAREST: f64 = 4.0;
        const MOST: f64 = 240.0;
        let count = path.samples.len() as f64;
        let steps = path.shots().flat_map(|shot| shot.windows(2));
        let length: f64 = steps.map(|pair| apart(self.project(pair[0].eye), self.project(pair[1].eye))).sum();
        let least = (count / MOST).max(NEAREST * count / length.max(1.0));
        let strides = (0..9).flat_map(|exponent| [1, 2, 5].map(|digit| digit * 10_usize.pow(exponent)));
        strides.into_iter().find(|stride| *stride as f64 >= least).unwrap_or(usize::MAX)
    }

    fn draw(&self, svg: &mut Svg, path: &CameraPath, stride: usize) {
        self.grid(svg);
        svg.clip(self.frame);
        for shape in &path.shapes {
            self.outline(svg, shape);
        }
        for shot in path.shots() {
            self.shot(svg, shot, stride);
        }
        svg.end_group();
        svg.outline("axis", self.frame);
        self.labels(svg, path);
    }

    fn grid(&self, svg: &mut Svg) {
        let half = 0.5 * self.frame.width / self.scale;
        let [x, y] = self.across(self.center).map(|middle| Axis::linear((middle - half, middle + half), 7.0));
        Plot { area: self.frame, x, y }.draw(svg);
        svg.text("", [self.frame.left, self.frame.top - 8.0], Anchor::Start, self.name);
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
            OutlinedShape::Ball { center, image } => {
                let [a, b] = [self.axes[0], self.axes[1]].map(|axis| image.row(axis) * self.scale);
                // The projection of the unit ball is an ellipse. Its radii are the square roots of the eigenvalues of (a b)^T (a b).
                let (mean, half) = (0.5 * (a.dot(a) + b.dot(b)), 0.5 * (a.dot(a) - b.dot(b)));
                let apart = libm::hypot(half, a.dot(b));
                let radii = [mean + apart, (mean - apart).max(0.0)].map(f64::sqrt);
                let degrees = (0.5 * libm::atan2(a.dot(b), half)).to_degrees();
                svg.ellipse("thing", self.project(*center), radii, -degrees);
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

    fn shot(&self, svg: &mut Svg, shot: &[CameraSample], stride: usize) {
        let targets: Vec<Vec<PagePoint>> = shot
            .chunk_by(|one, next| one.target.is_some() == next.target.is_some())
            .map(|run| {
                thinned(run.iter().filter_map(|sample| sample.target).map(|target| self.project(target)))
            })
            .collect();
        svg.lines("target", &targets);
        svg.lines("view", &self.view_lines(shot));
        svg.lines("eye", &[self.polyline(shot)]);
        let ticks: Vec<Vec<PagePoint>> =
            (0..shot.len()).step_by(stride).filter_map(|index| self.tick(shot, index)).collect();
        svg.lines("ticks", &ticks);
    }

    /// Returns a tick perpendicular to the path.
    fn tick(&self, shot: &[CameraSample], index: usize) -> Option<Vec<PagePoint>> {
        const HALF: f64 = 3.0;
        let ([x, y], [right, down]) = (self.project(shot[index].eye), self.heading(shot, index)?);
        Some(vec![[x - HALF * down, y + HALF * right], [x + HALF * down, y - HALF * right]])
    }

    /// Returns the direction of the path in this view, as a unit vector on the page. It is the direction from the previous to the next frame
    /// or, if both are at the same point, from this frame to the next.
    fn heading(&self, shot: &[CameraSample], index: usize) -> Option<PagePoint> {
        let here = &shot[index];
        let [before, after] =
            [index.wrapping_sub(1), index + 1].map(|near| self.project(shot.get(near).unwrap_or(here).eye));
        [(before, after), (self.project(here.eye), after)].into_iter().find_map(|(from, to)| {
            let length = apart(from, to);
            (length > 1e-6).then(|| [(to[0] - from[0]) / length, (to[1] - from[1]) / length])
        })
    }

    fn polyline(&self, shot: &[CameraSample]) -> Vec<PagePoint> {
        thinned(shot.iter().map(|sample| self.project(sample.eye)))
    }

    /// Returns short strokes from the eye in the viewing direction.
    fn view_lines(&self, shot: &[CameraSample]) -> Vec<Vec<PagePoint>> {
        const LENGTH: f64 = 24.0;
        const MOST: usize = 32;
        let stroke = |sample: &CameraSample| {
            let ([x, y], [right, up]) = (self.project(sample.eye), self.across(sample.axes[2]));
            vec![[x, y], [x + LENGTH * right, y - LENGTH * up]]
        };
        shot.iter().step_by(shot.len().div_ceil(MOST).max(1)).map(stroke).collect()
    }

    /// Labels the path with times and, if there are several shots, with the names of the cameras.
    fn labels(&self, svg: &mut Svg, path: &CameraPath) {
        /// Distances of texts from the path that are tried.
        const DISTANCES: [f64; 2] = [7.0, 18.0];
        /// Distance in pixels within which two points count as the same.
        const SAME: f64 = 6.0;
        let (mut labels, mut labelled) = (Labels::within(self.frame), Vec::<PagePoint>::new());
        for shot in path.shots() {
            labels.avoid(&self.polyline(shot));
            self.view_lines(shot).iter().for_each(|line| labels.avoid(line));
        }
        let several = path.shots().nth(1).is_some();
        for shot in path.shots() {
            for index in path.labelled(shot) {
                let eye = self.project(shot[index].eye);
                if labelled.iter().any(|[x, y]| (eye[0] - x).abs().max((eye[1] - y).abs()) < SAME) {
                    continue;
                }
                let text = shot[index].describe(several && index == 0);
                let [right, down] = self.heading(shot, index).unwrap_or([0.0, 1.0]);
                let sides: Vec<PagePoint> =
                    [[down, -right], [-down, right]].into_iter().chain(directions()).collect();
                let Some(place) = labels.place(eye, &text, &sides, DISTANCES) else { continue };
                Labels::write(svg, "moment", place, &text);
                labelled.push(eye);
                svg.dot("eye-dot", eye, 2.6, "");
                if let Some(target) = shot[index].target {
                    svg.dot("target-dot", self.project(target), 2.2, "");
                }
            }
        }
    }
}

fn apart(one: PagePoint, other: PagePoint) -> f64 {
    libm::hypot(other[0] - one[0], other[1] - one[1])
}

/// Draws the legend of the lines.
fn legend(svg: &mut Svg, [mut x, y]: PagePoint, stride: usize, path: &CameraPath) {
    let drawn = if path.spread_over.is_some() { " drawn" } else { "" };
    let eye = match stride {
        _ if path.is_still() => "the eye".to_owned(),
        1 => format!("the eye, with a tick at every frame{drawn}"),
        stride => format!("the eye, with a tick at every {stride} frames{drawn}"),
    };
    let mut entries = vec![("eye", eye.as_str()), ("view", "where it looks")];
    if path.samples.iter().any(|sample| sample.target.is_some()) {
        entries.push(("target", "its target"));
    }
    if !path.shapes.is_empty() {
        entries.push(("thing", "shapes in the first frame"));
    }
    for (class, text) in entries {
        svg.line(class, [x, y - 4.0], [x + 22.0, y - 4.0]);
        svg.text("", [x + 28.0, y], Anchor::Start, text);
        x += 60.0 + 6.0 * text.len() as f64;
    }
}
