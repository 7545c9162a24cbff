//! Views of the path from above and from the side.

use std::ops::Deref;

use glam::DVec3;

use super::chart::thinned;
use rayreel::drawing::{
    Area, CameraPath, CameraSample, Labels, OrthographicView, PagePoint, Svg, TextAnchor, directions,
};

/// Draws the path from above and from the side, at the same scale.
pub(super) fn draw(svg: &mut Svg, path: &CameraPath, [left, right]: [Area; 2]) {
    let seen = path.samples.iter().flat_map(|sample| [Some(sample.eye), sample.target]).flatten();
    let axes = path.samples.first().map(|sample| sample.axes);
    let views = OrthographicView::pair(seen, std::iter::empty(), &path.shapes, axes, DVec3::Y, [left, right]);
    let views = views.map(PathView);
    let stride = views.iter().map(|view| view.tick_stride(path)).min().unwrap_or(1);
    for view in &views {
        view.draw(svg, path, stride);
    }
    legend(svg, [left.left, left.bottom() + 46.0], stride, path);
}

/// A view in which a path is drawn.
struct PathView(OrthographicView);

impl Deref for PathView {
    type Target = OrthographicView;

    fn deref(&self) -> &OrthographicView {
        &self.0
    }
}

impl PathView {
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
        self.begin(svg, &path.shapes);
        for shot in path.shots() {
            self.shot(svg, shot, stride);
        }
        self.end(svg);
        self.labels(svg, path);
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
        svg.text("", [x + 28.0, y], TextAnchor::Start, text);
        x += 60.0 + 6.0 * text.len() as f64;
    }
}
