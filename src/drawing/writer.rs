//! A minimal SVG writer.

use std::fmt::{Display, Write};

use super::{Area, PagePoint};

/// The alignment of a text relative to its point.
#[derive(Clone, Copy, Debug)]
pub enum TextAnchor {
    Start,
    Middle,
    End,
}

/// A drawing under construction.
pub struct Svg {
    text: String,
    clips: usize,
    is_of_page: bool,
}

impl Svg {
    /// Begins a drawing that is part of a page, whose style sheet has the class `chart`.
    pub fn new(size: PagePoint, name: &str) -> Self {
        let svg = Self::open(size, &format!("class=\"chart\" role=\"img\" aria-label=\"{}\"", escaped(name)));
        Self { is_of_page: true, ..svg }
    }

    /// Begins a drawing in a file of its own.
    pub fn standalone(size @ [width, height]: PagePoint, name: &str, style: &str) -> Self {
        let size_in_pixels = format!("width=\"{width}\" height=\"{height}\"");
        let mut svg = Self::open(size, &format!("xmlns=\"http://www.w3.org/2000/svg\" {size_in_pixels}"));
        svg.write(format_args!("<title>{}</title>\n<style>{style}</style>", escaped(name)));
        svg
    }

    fn open([width, height]: PagePoint, attributes: &str) -> Self {
        let mut svg = Self { text: String::new(), clips: 0, is_of_page: false };
        svg.write(format_args!("<svg {attributes} viewBox=\"0 0 {width} {height}\">"));
        svg
    }

    pub fn finish(mut self) -> String {
        self.write(format_args!("</svg>"));
        self.text
    }

    /// Draws one polyline for each list of points. It is closed if its last point equals its first.
    pub fn lines(&mut self, class: &str, lines: &[Vec<PagePoint>]) {
        self.titled_lines(class, lines, "");
    }

    /// Draws lines with a tooltip.
    pub fn titled_lines(&mut self, class: &str, lines: &[Vec<PagePoint>], title: &str) {
        if !lines.is_empty() {
            self.shape(format_args!("path class=\"{class}\" d=\"{}\"", path(lines)), title);
        }
    }

    /// Draws lines of a ray, by which a page finds them.
    pub fn ray_lines(&mut self, class: &str, lines: &[Vec<PagePoint>], ray: impl Display) {
        if !lines.is_empty() {
            self.write(format_args!("<path class=\"{class}\" d=\"{}\" data-ray=\"{ray}\"/>", path(lines)));
        }
    }

    pub fn line(&mut self, class: &str, from: PagePoint, to: PagePoint) {
        self.lines(class, &[vec![from, to]]);
    }

    /// Draws an ellipse that is rotated by `degrees`.
    pub fn ellipse(&mut self, class: &str, at: PagePoint, radii: PagePoint, degrees: f64) {
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

    /// Draws a disc, with a tooltip unless `title` is empty.
    pub fn dot(&mut self, class: &str, at: PagePoint, radius: f64, title: &str) {
        let [x, y] = at.map(coordinate);
        self.shape(format_args!("circle class=\"{class}\" cx=\"{x}\" cy=\"{y}\" r=\"{radius}\""), title);
    }

    /// Draws a filled rectangle, with a tooltip unless `title` is empty.
    pub fn filled(&mut self, class: &str, area: Area, title: &str) {
        let [x, y, width, height] = [area.left, area.top, area.width, area.height].map(coordinate);
        self.shape(
            format_args!("rect class=\"{class}\" x=\"{x}\" y=\"{y}\" width=\"{width}\" height=\"{height}\""),
            title,
        );
    }

    /// Draws the outline of a rectangle.
    pub fn outline(&mut self, class: &str, area: Area) {
        let Area { left, top, .. } = area;
        let (right, bottom) = (area.right(), area.bottom());
        self.lines(class, &[vec![[left, top], [right, top], [right, bottom], [left, bottom], [left, top]]]);
    }

    pub fn text(&mut self, class: &str, at: PagePoint, anchor: TextAnchor, text: &str) {
        let [x, y] = at.map(coordinate);
        let class = if class.is_empty() { String::new() } else { format!("class=\"{class}\" ") };
        self.write_text(format_args!("{class}x=\"{x}\" y=\"{y}\""), anchor, text);
    }

    /// Writes a text upwards, centred at a point.
    pub fn upward_text(&mut self, at: PagePoint, text: &str) {
        let [x, y] = at.map(coordinate);
        self.write_text(
            format_args!("transform=\"translate({x} {y}) rotate(-90)\""),
            TextAnchor::Middle,
            text,
        );
    }

    fn write_text(&mut self, place: std::fmt::Arguments<'_>, anchor: TextAnchor, text: &str) {
        let anchor = match anchor {
            TextAnchor::Start => "start",
            TextAnchor::Middle => "middle",
            TextAnchor::End => "end",
        };
        if !text.is_empty() {
            self.write(format_args!("<text {place} text-anchor=\"{anchor}\">{}</text>", escaped(text)));
        }
    }

    /// Puts everything drawn until [`Svg::end_group`] into a class.
    pub fn group(&mut self, class: &str) {
        self.write(format_args!("<g class=\"{class}\">"));
    }

    /// Draws the grid of a view. A page, which draws another grid in a part that it magnifies, gets the numbers of the view.
    pub fn grid(&mut self, view: &str, draw: impl FnOnce(&mut Self)) {
        if self.is_of_page {
            self.write(format_args!("<g class=\"plane\" data-view=\"{view}\">"));
        }
        draw(self);
        if self.is_of_page {
            self.end_group();
        }
    }

    /// Clips everything drawn until [`Svg::end_group`] to a rectangle.
    pub fn clip(&mut self, area: Area) {
        self.clips += 1;
        let index = self.clips;
        self.write(format_args!("<clipPath id=\"frame{index}\">"));
        self.filled("clip", area, "");
        self.write(format_args!("</clipPath>\n<g clip-path=\"url(#frame{index})\">"));
    }

    pub fn end_group(&mut self) {
        self.write(format_args!("</g>"));
    }

    /// Writes an element, with a tooltip unless `title` is empty.
    fn shape(&mut self, element: std::fmt::Arguments<'_>, title: &str) {
        match title {
            "" => self.write(format_args!("<{element}/>")),
            _ => {
                let element = element.to_string();
                let name = element.split(' ').next().unwrap_or_default();
                self.write(format_args!("<{element}><title>{}</title></{name}>", escaped(title)));
            }
        }
    }

    fn write(&mut self, element: std::fmt::Arguments<'_>) {
        // Writing to a string cannot fail.
        let _ = writeln!(self.text, "{element}");
    }
}

/// Returns the path of lines.
fn path(lines: &[Vec<PagePoint>]) -> String {
    let mut path = String::new();
    for line in lines {
        let is_closed = line.len() > 3 && line.first() == line.last();
        for (index, place) in line[..line.len() - usize::from(is_closed)].iter().enumerate() {
            path.push(if index == 0 { 'M' } else { 'L' });
            let [x, y] = place.map(coordinate);
            let _ = write!(path, "{x} {y} ");
        }
        path.push_str(if is_closed { "Z" } else { "" });
    }
    path
}

/// Rounds to a hundredth of a pixel and clamps distant points. Returns 0 for values that are not finite.
fn coordinate(value: f64) -> f64 {
    const FAR: f64 = 1e5;
    if value.is_finite() { (value.clamp(-FAR, FAR) * 100.0).round() / 100.0 } else { 0.0 }
}

/// Escapes a text for SVG and HTML. Control characters become spaces.
pub fn escaped(text: &str) -> String {
    let visible = |character: char| if character.is_control() { ' ' } else { character };
    let text: String = text.chars().map(visible).collect();
    text.replace('&', "&amp;").replace('<', "&lt;").replace('>', "&gt;").replace('"', "&quot;")
}
