//! The rays of a ray tree, in two views along coordinate axes: of `rayreel probe --svg`, and of the preview page.

use std::fmt::{self, Display, Formatter};

use glam::DVec3;

use crate::components::Camera;
use crate::engine::Engine;
use crate::systems::{Preparation, active_camera};
use crate::time::Time;
use crate::trace::{LitSurface, PreparedRay, RayEnd, RayKind, RayTree, ShapeId, TracedRay};

use super::names::{label, ray_name};
use super::view::{PAGE_SIZE, page_frames};
use super::{
    Area, Labels, OrthographicView, OutlinedShape, PagePoint, Svg, TextAnchor, VIEW_STYLE, directions,
    outlined_shapes,
};

/// Style sheet of the rays, in addition to that of the views. Rays differ in width and dashes as well as in colour.
const STYLE: &str = "
.camera { stroke: #3b7dd8; stroke-width: 2.4 }
.reflection { stroke: #d98324; stroke-width: 1.8 }
.refraction { stroke: #2f9e6e; stroke-width: 1.8; stroke-dasharray: 9 3 }
.shadow { stroke: #b08d00; stroke-width: 1; stroke-opacity: 0.7 }
.occluded { stroke: #d64545; stroke-width: 1.2; stroke-dasharray: 3 3 }
.normal { stroke: #8a63d2; stroke-width: 1.4 }
.eye { stroke: #3b7dd8; stroke-width: 1.2 }
.point { fill: #808080 }
.lamp { fill: #b08d00 }
.swatch { stroke: #808080 }
.fade1 { stroke-opacity: 0.6 }
.fade2 { stroke-opacity: 0.35 }
.fade3 { stroke-opacity: 0.15 }
";

/// Maximum number of rays of the tree that are drawn.
const MOST_RAYS: usize = 200;
/// Maximum number of samples of an area light that are drawn at the hit of the first ray. At later hits, only the first sample is drawn.
const MOST_SAMPLES: u32 = 8;

/// The kinds of lines, with their classes and the texts of the legend.
const LEGEND: [(LineKind, &str, &str); 6] = [
    (LineKind::Camera, "camera", "camera ray"),
    (LineKind::Reflection, "reflection", "reflected ray"),
    (LineKind::Refraction, "refraction", "refracted ray"),
    (LineKind::Shadow, "shadow", "shadow ray"),
    (LineKind::Occluded, "occluded", "occluded shadow ray, up to the occluder"),
    (LineKind::Normal, "normal", "normal"),
];

#[derive(Clone, Copy, Debug, PartialEq, Eq)]
enum LineKind {
    Camera,
    Reflection,
    Refraction,
    Shadow,
    Occluded,
    Normal,
}

impl LineKind {
    /// Returns true for the rays of the tree, which bring light to the eye.
    fn is_of_tree(self) -> bool {
        matches!(self, Self::Camera | Self::Reflection | Self::Refraction)
    }
}

/// A ray of a tree, or the shadow rays from its end to a light.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct RayKey {
    /// Index of the ray in the tree.
    pub ray: usize,
    /// Index of the light, for shadow rays.
    pub light: Option<usize>,
}

impl Display for RayKey {
    fn fmt(&self, formatter: &mut Formatter<'_>) -> fmt::Result {
        write!(formatter, "{}", self.ray)?;
        self.light.map_or(Ok(()), |light| write!(formatter, "-{light}"))
    }
}

/// A line from a point to another one.
struct DrawnLine {
    key: RayKey,
    kind: LineKind,
    /// True for a ray without an end, which fades out at the frame.
    is_endless: bool,
    name: String,
    from: DVec3,
    to: DVec3,
}

/// A named point.
struct Mark {
    class: &'static str,
    name: String,
    at: DVec3,
}

/// The contents of a drawing.
pub struct RayDrawing {
    shapes: Vec<OutlinedShape>,
    lines: Vec<DrawnLine>,
    marks: Vec<Mark>,
    /// The corners of the screen as seen from the start of the first ray, if that is a camera ray.
    screen: Option<[DVec3; 4]>,
    /// The camera's u, v and n, and its `up`.
    axes: [DVec3; 3],
    up: DVec3,
    /// The points that the views show.
    seen: Vec<DVec3>,
    omitted: usize,
}

impl RayDrawing {
    /// Collects the rays of a tree at a moment. `is_pixel` is true if the first ray starts at the camera.
    pub fn new(engine: &Engine, prepared: &Preparation, tree: &RayTree, time: Time, is_pixel: bool) -> Self {
        let camera = active_camera(engine.world(), time);
        let up = camera
            .and_then(|active| engine.world().get::<&Camera>(active.entity).ok().map(|camera| camera.up));
        let mut depths: Vec<usize> = Vec::with_capacity(tree.rays.len());
        for traced in &tree.rays {
            depths.push(traced.parent.map_or(0, |parent| depths[parent] + 1));
        }
        let drawn = || tree.rays.iter().take(MOST_RAYS);
        let seen: Vec<DVec3> = drawn().flat_map(ends).collect();
        let mut drawing = Self {
            shapes: outlined_shapes(engine),
            lines: Vec::new(),
            marks: Vec::new(),
            screen: is_pixel.then(|| screen(prepared)),
            axes: prepared.camera().axes(),
            up: up.unwrap_or(DVec3::Y),
            omitted: tree.rays.len().saturating_sub(MOST_RAYS),
            seen,
        };
        let reach = drawing.reach();
        for (ray, (traced, depth)) in drawn().zip(depths).enumerate() {
            let kind = match traced.kind {
                RayKind::Camera => LineKind::Camera,
                RayKind::Reflection => LineKind::Reflection,
                RayKind::Refraction => LineKind::Refraction,
            };
            let name = match ray_name(traced.kind, depth) {
                name if kind == LineKind::Reflection && is_total(tree, traced) => format!("total {name}"),
                name if is_pixel || depth > 0 => name,
                _ => "ray".to_owned(),
            };
            let (from, direction) = (traced.ray.origin(), traced.ray.direction().normalize_or_zero());
            let (to, is_endless) = match &traced.end {
                RayEnd::Surface(lit) => (lit.surface.point, false),
                RayEnd::Background(_) | RayEnd::BeyondDepth(_) => (from + 0.35 * reach * direction, true),
            };
            drawing.seen.push(to);
            let key = RayKey { ray, light: None };
            drawing.lines.push(DrawnLine { key, kind, is_endless, name, from, to });
            if let RayEnd::Surface(lit) = &traced.end {
                let samples = if depth == 0 { MOST_SAMPLES } else { 1 };
                drawing.add_surface(engine, prepared, key, lit, samples, reach);
            }
        }
        drawing
    }

    /// Returns the largest extent of the points along an axis, or 10 if they all coincide.
    fn reach(&self) -> f64 {
        let least = self.seen.iter().fold(DVec3::INFINITY, |least, point| least.min(*point));
        let most = self.seen.iter().fold(DVec3::NEG_INFINITY, |most, point| most.max(*point));
        let reach = (most - least).max_element();
        if reach > 0.0 && reach.is_finite() { reach } else { 10.0 }
    }

    /// Adds the normal of a surface, its name, and its shadow rays.
    fn add_surface(
        &mut self,
        engine: &Engine,
        prepared: &Preparation,
        key: RayKey,
        lit: &LitSurface,
        samples: u32,
        reach: f64,
    ) {
        let (world, point) = (engine.world(), lit.surface.point);
        let name = label(world, prepared.entity(lit.surface.hit.id));
        self.marks.push(Mark { class: "point", name, at: point });
        let to = point + 0.08 * reach * lit.surface.facing_normal();
        let (kind, is_endless) = (LineKind::Normal, false);
        self.lines.push(DrawnLine { key, kind, is_endless, name: String::new(), from: point, to });
        for sample in lit.samples.iter().filter(|sample| sample.sample < samples) {
            let direction = sample.terms.to_light.normalize_or_zero();
            let name = label(world, prepared.lights()[sample.light]);
            // Lights that are far away would make everything else small; their rays leave the frame.
            let is_near = sample.terms.distance() < 2.0 * reach;
            let distance = if is_near { sample.terms.distance() } else { 4.0 * reach };
            let (kind, to) = match sample.occluder {
                Some(slot) => {
                    let ray = PreparedRay::new(point, direction);
                    let occluded = ray.and_then(|ray| occlusion(prepared, slot, &ray, distance));
                    let occluded = point + occluded.unwrap_or(distance) * direction;
                    self.seen.push(occluded);
                    (LineKind::Occluded, occluded)
                }
                None => (LineKind::Shadow, point + distance * direction),
            };
            let at = point + distance * direction;
            if is_near {
                self.seen.push(at);
                self.marks.push(Mark { class: "lamp", name: name.clone(), at });
            }
            let is_first = sample.sample == 0;
            let name = if is_first { format!("to {name}") } else { String::new() };
            let (key, is_endless) =
                (RayKey { light: Some(sample.light), ..key }, !is_near && kind == LineKind::Shadow);
            self.lines.push(DrawnLine { key, kind, is_endless, name, from: point, to });
        }
    }

    /// Draws two square views, with a title, a text and the colour of the rays.
    pub fn draw(&self, title: &str, text: &str, [red, green, blue]: [u8; 3]) -> String {
        /// Width of the title.
        const WIDTH: f64 = 910.0;
        /// Font size of short titles, and the mean width of bold characters relative to their font size.
        const TITLE: [f64; 2] = [15.0, 0.52];
        let size = TITLE[0].min(WIDTH / (TITLE[1] * title.chars().count() as f64));
        let colors =
            format!(".swatch {{ fill: rgb({red}, {green}, {blue}) }}\n.title {{ font-size: {size:.1}px }}\n");
        let mut svg = Svg::standalone([1000.0, 580.0], title, &[VIEW_STYLE, STYLE, &colors].concat());
        svg.filled("swatch", Area { left: 20.0, top: 14.0, width: 34.0, height: 34.0 }, "");
        svg.text("title", [66.0, 28.0], TextAnchor::Start, title);
        let omitted = match self.omitted {
            0 => String::new(),
            count => format!(", without {count} more rays"),
        };
        svg.text("", [66.0, 46.0], TextAnchor::Start, &format!("{text}{omitted}"));
        let frames = [
            Area { left: 56.0, top: 84.0, width: 420.0, height: 420.0 },
            Area { left: 546.0, top: 84.0, width: 420.0, height: 420.0 },
        ];
        self.draw_views(&mut svg, frames);
        self.legend(&mut svg, [frames[0].left, frames[0].bottom() + 50.0]);
        svg.finish()
    }

    /// Draws two square views, one above the other, for a page with its own style sheet.
    pub fn draw_for_page(&self, name: &str) -> String {
        let mut svg = Svg::new(PAGE_SIZE, name);
        self.draw_views(&mut svg, page_frames());
        svg.finish()
    }

    /// Returns notes about the rays that are not drawn.
    pub fn omitted(&self, tree: &RayTree) -> Vec<String> {
        let surfaces = tree.rays.iter().take(MOST_RAYS).filter_map(TracedRay::surface);
        let undrawn = |depth: usize, lit: &LitSurface| {
            let most = if depth == 0 { MOST_SAMPLES } else { 1 };
            lit.samples.iter().any(|sample| sample.sample >= most)
        };
        let mut notes = Vec::new();
        if self.omitted > 0 {
            notes.push(format!("{} more rays are not drawn.", self.omitted));
        }
        if surfaces.enumerate().any(|(depth, lit)| undrawn(depth, lit)) {
            notes.push(format!(
                "{MOST_SAMPLES} shadow rays to each area light are drawn at the first hit, and one at later hits."
            ));
        }
        notes
    }

    fn draw_views(&self, svg: &mut Svg, frames: [Area; 2]) {
        let seen = self.seen.iter().copied();
        let path =
            self.lines.iter().filter(|line| line.kind.is_of_tree()).flat_map(|line| [line.from, line.to]);
        for view in OrthographicView::pair(seen, path, &self.shapes, Some(self.axes), self.up, frames) {
            view.begin(svg, &self.shapes);
            self.draw_lines(svg, &view);
            view.end(svg);
            self.draw_labels(svg, &view);
        }
    }

    fn draw_lines(&self, svg: &mut Svg, view: &OrthographicView) {
        // Thin lines last, so that they stay visible on thick ones.
        for (kind, class, _) in LEGEND {
            for line in self.lines.iter().filter(|line| line.kind == kind) {
                let ends = [view.project(line.from), view.project(line.to)];
                let faded = if line.is_endless { view.frame.clip(ends) } else { None };
                let Some([from, to]) = faded else {
                    svg.ray_lines(class, &[ends.to_vec()], line.key);
                    continue;
                };
                let at =
                    |share: f64| [from[0] + share * (to[0] - from[0]), from[1] + share * (to[1] - from[1])];
                svg.ray_lines(class, &[vec![from, at(0.55)]], line.key);
                for (fade, start) in [(1, 0.55), (2, 0.7), (3, 0.85)] {
                    let class = format!("{class} fade{fade}");
                    svg.ray_lines(&class, &[vec![at(start), at(start + 0.15)]], line.key);
                }
            }
        }
        for line in self.lines.iter().filter(|line| line.kind != LineKind::Normal) {
            let class =
                LEGEND.iter().find(|(kind, ..)| *kind == line.kind).map_or("", |(_, class, _)| *class);
            svg.ray_lines(class, &arrow(view.project(line.from), view.project(line.to)), line.key);
        }
        if let (Some(corners), Some(first)) = (&self.screen, self.lines.first()) {
            let eye = view.project(first.from);
            let corners = corners.map(|corner| {
                let [right, up] = view.across(corner);
                [eye[0] + right, eye[1] - up]
            });
            let edges = corners.map(|corner| vec![eye, corner]);
            svg.lines("eye", &edges);
            let [a, b, c, d] = corners;
            svg.lines("eye", &[vec![a, b, c, d, a]]);
        }
        for mark in &self.marks {
            svg.dot(
                mark.class,
                view.project(mark.at),
                if mark.class == "lamp" { 3.6 } else { 2.4 },
                &mark.name,
            );
        }
    }

    /// Labels rays and marks, unless there is no room for the text.
    fn draw_labels(&self, svg: &mut Svg, view: &OrthographicView) {
        /// Distances of texts from their points that are tried.
        const DISTANCES: [f64; 3] = [5.0, 12.0, 22.0];
        /// Lines that appear shorter have no label.
        const SHORTEST: f64 = 14.0;
        let mut labels = Labels::within(view.frame);
        let clipped = |line: &DrawnLine| view.frame.clip([view.project(line.from), view.project(line.to)]);
        for inside in self.lines.iter().filter_map(clipped) {
            labels.avoid(&inside);
        }
        let mut written = Vec::new();
        let marks = self.marks.iter().map(|mark| (mark.name.clone(), view.project(mark.at)));
        let lines = self.lines.iter().filter_map(|line| {
            let [from, to] = clipped(line)?;
            let middle = [0.5 * (from[0] + to[0]), 0.5 * (from[1] + to[1])];
            let length = libm::hypot(to[0] - from[0], to[1] - from[1]);
            (length >= SHORTEST).then(|| (line.name.clone(), middle))
        });
        for (text, at) in marks.chain(lines) {
            if text.is_empty() || written.contains(&text) {
                continue;
            }
            if let Some(place) = labels.place(at, &text, &directions(), DISTANCES) {
                Labels::write(svg, "", place, &text);
                written.push(text);
            }
        }
    }

    /// Draws the legend of the lines that occur.
    fn legend(&self, svg: &mut Svg, [mut x, y]: PagePoint) {
        for (kind, class, text) in
            LEGEND.iter().filter(|(kind, ..)| self.lines.iter().any(|line| line.kind == *kind))
        {
            let text = if *kind == LineKind::Camera && self.screen.is_none() { &"ray" } else { text };
            svg.line(class, [x, y - 4.0], [x + 30.0, y - 4.0]);
            svg.text("", [x + 36.0, y], TextAnchor::Start, text);
            x += 60.0 + 5.3 * text.len() as f64;
        }
    }
}

/// Returns true if a ray comes from a surface with total internal reflection.
fn is_total(tree: &RayTree, traced: &TracedRay) -> bool {
    let parent = traced.parent.map(|parent| &tree.rays[parent].end);
    let Some(RayEnd::Surface(lit)) = parent else { return false };
    lit.terms.secondary.refraction.is_some_and(|refraction| refraction.is_total())
}

/// Returns the finite ends of a ray.
fn ends(traced: &TracedRay) -> impl Iterator<Item = DVec3> {
    let end = match &traced.end {
        RayEnd::Surface(lit) => Some(lit.surface.point),
        RayEnd::Background(_) | RayEnd::BeyondDepth(_) => None,
    };
    std::iter::once(traced.ray.origin()).chain(end)
}

/// Returns the corners of the camera's screen, as vectors of a fixed length in pixels from the start of the ray: in front of an eye, or
/// around the start of a parallel ray.
fn screen(prepared: &Preparation) -> [DVec3; 4] {
    const LENGTH: f64 = 22.0;
    let camera = prepared.camera();
    if camera.is_orthographic() {
        let [right, up, _] = camera.axes().map(|axis| 0.5 * LENGTH * axis);
        return [up - right, up + right, right - up, -right - up];
    }
    let (columns, rows) = camera.resolution();
    let (right, bottom) = (columns.saturating_sub(1), rows.saturating_sub(1));
    [(0, 0), (right, 0), (right, bottom), (0, bottom)]
        .map(|(i, j)| LENGTH * camera.towards(i, j).normalize_or_zero())
}

/// Returns the distance at which a shape occludes a shadow ray: its first root that is not the start of the ray itself.
fn occlusion(prepared: &Preparation, slot: ShapeId, ray: &PreparedRay, distance: f64) -> Option<f64> {
    /// Part of the distance that is invisible in a drawing.
    const NOTHING: f64 = 1e-9;
    let roots = prepared.scene().geometry().equation(slot, ray).roots();
    roots.into_iter().find(|root| *root > NOTHING * distance && *root < distance)
}

/// Returns the two strokes of an arrowhead in the middle of a line, or nothing if the line appears short.
fn arrow(from: PagePoint, to: PagePoint) -> Vec<Vec<PagePoint>> {
    const SIZE: f64 = 6.0;
    let [x, y] = [to[0] - from[0], to[1] - from[1]];
    let length = libm::hypot(x, y);
    if length < 4.0 * SIZE {
        return Vec::new();
    }
    let (along, tip) = ([x / length, y / length], [from[0] + 0.6 * x, from[1] + 0.6 * y]);
    let stroke = |side: f64| {
        let back = [along[0] + 0.5 * side * along[1], along[1] - 0.5 * side * along[0]];
        [tip[0] - SIZE * back[0], tip[1] - SIZE * back[1]]
    };
    vec![vec![stroke(1.0), tip, stroke(-1.0)]]
}
