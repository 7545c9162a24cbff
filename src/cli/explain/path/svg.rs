//! A minimal SVG writer for the drawing.

use std::fmt::Write;

/// A point on the drawing: pixels to the right and down.
pub(super) type PagePoint = [f64; 2];

/// A rectangle on the drawing.
#[derive(Clone, Copy, Debug)]
pub(super) struct DrawingArea {
    pub(super) left: f64,
    pub(super) top: f64,
    pub(super) width: f64,
    pub(super) height: f64,
}

impl DrawingArea {
    pub(super) fn right(&self) -> f64 {
        self.left + self.width
    }

    pub(super) fn bottom(&self) -> f64 {
        self.top + self.height
    }

    pub(super) fn middle(&self) -> PagePoint {
        [self.left + 0.5 * self.width, self.top + 0.5 * self.height]
    }

    pub(super) fn overlaps(&self, other: &Self) -> bool {
        self.left < other.right()
            && other.left < self.right()
            && self.top < other.bottom()
            && other.top < self.bottom()
    }

    pub(super) fn contains(&self, [x, y]: PagePoint) -> bool {
        (self.left..self.right()).contains(&x) && (self.top..self.bottom()).contains(&y)
    }

    pub(super) fn holds(&self, other: &Self) -> bool {
        self.left <= other.left
            && other.right() <= self.right()
            && self.top <= other.top
            && other.bottom() <= self.bottom()
    }
}

/// The alignment of a text relative to its point.
#[derive(Clone, Copy, Debug)]
pub(super) enum Anchor {
    Start,
    Middle,
    End,
}

/// A drawing under construction.
pub(super) struct Svg {
    text: String,
    clips: usize,
}

/// Style sheet with mid-tones, which are visible on light and on dark backgrounds.
const STYLE: &str = "
text { font: 11px sans-serif; fill: #808080 }
.title { font-size: 15px; font-weight: bold }
.moment { fill: #3b7dd8 }
.shot { fill: #3b7dd8; font-weight: bold }
path, polyline, ellipse { fill: none; stroke-linejoin: round; stroke-linecap: round }
.frame { stroke: #808080; stroke-width: 1 }
.grid { stroke: #808080; stroke-width: 1; stroke-opacity: 0.22 }
.thing { stroke: #808080; stroke-width: 1; stroke-opacity: 0.55 }
.target { stroke: #d98324; stroke-width: 1.2; stroke-opacity: 0.7 }
.target-dot { fill: #d98324; fill-opacity: 0.8 }
.view { stroke: #2f9e6e; stroke-width: 1.2; stroke-opacity: 0.85 }
.eye { stroke: #3b7dd8; stroke-width: 1.6 }
.ticks { stroke: #3b7dd8; stroke-width: 1 }
.eye-dot { fill: #3b7dd8 }
.value { stroke: #3b7dd8; stroke-width: 1.4 }
";

impl Svg {
    pub(super) fn new((width, height): (f64, f64), title: &str) -> Self {
        let mut svg = Self { text: String::new(), clips: 0 };
        svg.write(format_args!(
            "<svg xmlns=\"http://www.w3.org/2000/svg\" viewBox=\"0 0 {width} {height}\" width=\"{width}\" height=\"{height}\">"
        ));
        svg.write(format_args!("<title>{}</title>", escaped(title)));
        svg.write(format_args!("<style>{STYLE}</style>"));
        svg
    }

    pub(super) fn finish(mut self) -> String {
        self.write(format_args!("</svg>"));
        self.text
    }

    /// Draws one polyline for each list of points.
    pub(super) fn lines(&mut self, class: &str, lines: &[Vec<PagePoint>]) {
        let mut path = String::new();
        for line in lines {
            for (index, place) in line.iter().enumerate() {
                let command = if index == 0 { 'M' } else { 'L' };
                path.push(command);
                path.push_str(&pair(*place));
            }
        }
        if !path.is_empty() {
            self.write(format_args!("<path class=\"{class}\" d=\"{path}\"/>"));
        }
    }

    pub(super) fn line(&mut self, class: &str, from: PagePoint, to: PagePoint) {
        self.lines(class, &[vec![from, to]]);
    }

    /// Draws an ellipse that is rotated by `degrees`.
    pub(super) fn ellipse(&mut self, class: &str, at: PagePoint, radii: PagePoint, degrees: f64) {
        let [x, y] = at.map(coordinate);
        let [rx, ry] = radii.map(coordinate);
        let turned = if rx == ry {
            String::new()
        } else {
            format!(" transform=\"rotate({} {x} {y})\"", coordinate(degrees))
        };
        self.write(format_args!(
            "<ellipse class=\"{class}\" cx=\"{x}\" cy=\"{y}\" rx=\"{rx}\" ry=\"{ry}\"{turned}/>"
        ));
    }

    pub(super) fn dot(&mut self, class: &str, [x, y]: PagePoint, radius: f64) {
        let [x, y] = [x, y].map(coordinate);
        self.write(format_args!("<circle class=\"{class}\" cx=\"{x}\" cy=\"{y}\" r=\"{radius}\"/>"));
    }

    pub(super) fn text(&mut self, class: &str, [x, y]: PagePoint, anchor: Anchor, text: &str) {
        let anchor = match anchor {
            Anchor::Start => "start",
            Anchor::Middle => "middle",
            Anchor::End => "end",
        };
        let [x, y] = [x, y].map(coordinate);
        let text = escaped(text);
        self.write(format_args!(
            "<text class=\"{class}\" x=\"{x}\" y=\"{y}\" text-anchor=\"{anchor}\">{text}</text>"
        ));
    }

    pub(super) fn rectangle(&mut self, class: &str, frame: DrawingArea) {
        let DrawingArea { left, top, .. } = frame;
        let (right, bottom) = (frame.right(), frame.bottom());
        self.lines(class, &[vec![[left, top], [right, top], [right, bottom], [left, bottom], [left, top]]]);
    }

    /// Clips everything drawn until [`Svg::unclip`] to a frame.
    pub(super) fn clip(&mut self, frame: DrawingArea) {
        self.clips += 1;
        let (index, DrawingArea { left, top, width, height }) = (self.clips, frame);
        self.write(format_args!(
            "<clipPath id=\"frame{index}\"><rect x=\"{left}\" y=\"{top}\" width=\"{width}\" height=\"{height}\"/></clipPath>"
        ));
        self.write(format_args!("<g clip-path=\"url(#frame{index})\">"));
    }

    pub(super) fn unclip(&mut self) {
        self.write(format_args!("</g>"));
    }

    fn write(&mut self, element: std::fmt::Arguments<'_>) {
        // Writing to a string cannot fail.
        let _ = writeln!(self.text, "{element}");
    }
}

fn pair([x, y]: PagePoint) -> String {
    format!("{} {} ", coordinate(x), coordinate(y))
}

/// Rounds to a hundredth of a pixel and clamps distant points. Returns 0 for values that are not finite.
fn coordinate(value: f64) -> f64 {
    const FAR: f64 = 1e5;
    if value.is_finite() { (value.clamp(-FAR, FAR) * 100.0).round() / 100.0 } else { 0.0 }
}

fn escaped(text: &str) -> String {
    let visible = |character: char| if character.is_control() { ' ' } else { character };
    let text: String = text.chars().map(visible).collect();
    text.replace('&', "&amp;").replace('<', "&lt;").replace('>', "&gt;").replace('"', "&quot;")
}
