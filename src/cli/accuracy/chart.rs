//! Charts of errors on logarithmic axes, in the colours of the page.

use std::fmt::Write;

use super::labels::{Area, place};

/// A mark on a chart.
#[derive(Clone, Debug)]
pub(super) struct ChartMark {
    pub(super) x: f64,
    pub(super) y: f64,
    /// Lowest and highest value of `x`, if it is uncertain.
    pub(super) reach: Option<(f64, f64)>,
    pub(super) form: Form,
    /// Text of the tooltip.
    pub(super) title: String,
    /// Text of the label near the mark.
    pub(super) label: Option<String>,
}

/// The form of a mark.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) enum Form {
    Disc,
    Ring,
    Star,
}

/// Marks of one colour.
#[derive(Clone, Debug)]
pub(super) struct Series {
    pub(super) name: String,
    pub(super) marks: Vec<ChartMark>,
    /// True if a line joins the marks.
    pub(super) joined: bool,
}

/// A chart of several series.
#[derive(Clone, Debug)]
pub(super) struct Chart<'a> {
    pub(super) title: &'a str,
    pub(super) x: &'a str,
    pub(super) y: &'a str,
    pub(super) series: Vec<Series>,
    /// Dashed polylines.
    pub(super) lines: Vec<Vec<(f64, f64)>>,
    /// A point on a dotted line that falls as n^-1/2.
    pub(super) guide: Option<(f64, f64)>,
    /// Uncertainty of the reference; smaller errors cannot be measured.
    pub(super) floor: Option<f64>,
    pub(super) layout: Layout,
}

/// Size of a chart, which determines the positions of its axes.
#[derive(Clone, Copy, Debug)]
pub(super) struct Layout {
    width: f64,
    height: f64,
}

impl Layout {
    /// A chart as wide as the page.
    pub(super) const WIDE: Self = Self { width: 720.0, height: 400.0 };
    /// A chart about half as wide as the page.
    pub(super) const NARROW: Self = Self { width: 420.0, height: 270.0 };
    const LEFT: f64 = 62.0;
    const TOP: f64 = 16.0;

    fn right(self) -> f64 {
        self.width - 16.0
    }

    fn bottom(self) -> f64 {
        self.height - 46.0
    }
}

/// A logarithmic axis, between two base-10 logarithms.
#[derive(Clone, Copy, Debug)]
struct Axis {
    from: f64,
    to: f64,
}

impl Axis {
    /// Returns an axis that covers all finite values above 0, with a margin.
    fn over(values: impl Iterator<Item = f64>) -> Self {
        let positive = values.filter(|value| *value > 0.0 && value.is_finite()).map(libm::log10);
        let (from, to) = positive
            .fold((f64::INFINITY, f64::NEG_INFINITY), |(from, to), value| (from.min(value), to.max(value)));
        if from > to {
            return Self { from: 0.0, to: 1.0 };
        }
        let room = (0.06 * (to - from)).max(0.1);
        Self { from: from - room, to: to + room }
    }

    /// Returns the position of a value along the axis, where 0 and 1 are the ends. It is clamped just outside of them.
    fn share(self, value: f64) -> f64 {
        ((libm::log10(value) - self.from) / (self.to - self.from)).clamp(-0.02, 1.02)
    }

    /// Returns the ticks at 1, 2 and 5 times powers of ten, with their labels. Labels are empty where there is no room.
    fn ticks(self) -> Vec<(f64, String)> {
        /// Length of an axis, in decades, below which 2 and 5 are labelled as well.
        const SHORT: f64 = 2.2;
        let mut ticks = Vec::new();
        let mut power = self.from.floor();
        while power <= self.to {
            for digit in [1.0, 2.0, 5.0] {
                let value = digit * libm::exp10(power);
                let is_labelled = digit == 1.0 || self.to - self.from < SHORT;
                if (self.from..=self.to).contains(&libm::log10(value)) {
                    ticks.push((value, if is_labelled { short(value) } else { String::new() }));
                }
            }
            power += 1.0;
        }
        ticks
    }
}

/// Formats a number in a few characters.
fn short(value: f64) -> String {
    if (1e-3..1e5).contains(&value) {
        let decimals = (-libm::log10(value) - 1e-9).ceil().max(0.0);
        #[expect(clippy::cast_possible_truncation, clippy::cast_sign_loss, reason = "0 to 3")]
        let decimals = decimals as usize;
        format!("{value:.decimals$}")
    } else {
        format!("{value:.0e}")
    }
}

/// The layout and the axes of a chart.
struct Plot {
    layout: Layout,
    x: Axis,
    y: Axis,
}

impl Plot {
    /// Returns the position of a value and an error on the chart; x points right and y points down.
    fn place(&self, (value, error): (f64, f64)) -> (f64, f64) {
        let Self { layout, x, y } = self;
        let across = Layout::LEFT + x.share(value) * (layout.right() - Layout::LEFT);
        (across, layout.bottom() - y.share(error) * (layout.bottom() - Layout::TOP))
    }

    fn polyline(&self, svg: &mut String, class: &str, places: impl Iterator<Item = (f64, f64)>) {
        let points = places.map(|place| self.place(place)).map(|(x, y)| format!("{x:.1},{y:.1}"));
        let points: Vec<String> = points.collect();
        let _ = writeln!(svg, "<polyline class=\"{class}\" points=\"{}\"/>", points.join(" "));
    }

    /// Returns small areas along a line, which labels must not cover.
    fn along(&self, line: &[(f64, f64)]) -> Vec<Area> {
        const BETWEEN: f64 = 5.0;
        let pieces = line.windows(2).flat_map(|ends| {
            let [(x, y), (to_x, to_y)] = [self.place(ends[0]), self.place(ends[1])];
            let steps = (libm::hypot(to_x - x, to_y - y) / BETWEEN).ceil().max(1.0);
            #[expect(clippy::cast_possible_truncation, clippy::cast_sign_loss, reason = "a drawing is small")]
            let count = steps as u32;
            (0..=count).map(move |step| {
                let part = f64::from(step) / steps;
                Area::around((x + part * (to_x - x), y + part * (to_y - y)), 1.0)
            })
        });
        pieces.collect()
    }

    fn axes(&self, svg: &mut String, across: &str, up: &str) {
        let (left, top) = (Layout::LEFT, Layout::TOP);
        let (right, bottom) = (self.layout.right(), self.layout.bottom());
        for (value, label) in self.x.ticks() {
            let at = left + self.x.share(value) * (right - left);
            let _ = writeln!(svg, "<path class=\"grid\" d=\"M{at:.1} {top}V{bottom}\"/>");
            text(svg, (at, bottom + 16.0), "middle", &label);
        }
        for (value, label) in self.y.ticks() {
            let at = bottom - self.y.share(value) * (bottom - top);
            let _ = writeln!(svg, "<path class=\"grid\" d=\"M{left} {at:.1}H{right}\"/>");
            text(svg, (left - 6.0, at + 4.0), "end", &label);
        }
        let _ = writeln!(svg, "<path class=\"axis\" d=\"M{left} {top}V{bottom}H{right}\"/>");
        text(svg, (f64::midpoint(left, right), self.layout.height - 8.0), "middle", across);
        let _ = writeln!(
            svg,
            "<text transform=\"translate(12 {}) rotate(-90)\" text-anchor=\"middle\">{}</text>",
            f64::midpoint(top, bottom),
            escaped(up)
        );
    }

    /// Shades the area of errors below the floor.
    fn floor(&self, svg: &mut String, floor: f64) {
        let (left, (_, top)) = (Layout::LEFT, self.place((1.0, floor)));
        let (width, height) = (self.layout.right() - left, (self.layout.bottom() - top).max(0.0));
        let _ = writeln!(
            svg,
            "<rect class=\"floor\" x=\"{left}\" y=\"{top:.1}\" width=\"{width:.1}\" height=\"{height:.1}\">\
             <title>less than the reference knows</title></rect>"
        );
    }

    fn mark(&self, svg: &mut String, mark: &ChartMark) {
        let (across, down) = self.place((mark.x, mark.y));
        if let Some((low, high)) = mark.reach {
            let ((low, _), (high, _)) = (self.place((low, mark.y)), self.place((high, mark.y)));
            let _ = writeln!(svg, "<path d=\"M{low:.1} {down:.1}H{high:.1}\"/>");
        }
        let title = escaped(&mark.title);
        let _ = match mark.form {
            Form::Star => writeln!(
                svg,
                "<path class=\"star\" d=\"{}\"><title>{title}</title></path>",
                star((across, down))
            ),
            form => writeln!(
                svg,
                "<circle{} cx=\"{across:.1}\" cy=\"{down:.1}\" r=\"4\"><title>{title}</title></circle>",
                if form == Form::Ring { " class=\"ring\"" } else { "" }
            ),
        };
    }

    /// Returns the ends of the line through a point that falls as n^-1/2, clipped to the chart.
    fn guide(&self, (x, y): (f64, f64)) -> Option<[(f64, f64); 2]> {
        let (x, y) = (libm::log10(x), libm::log10(y));
        let first = self.x.from.max(x + 2.0 * (y - self.y.to));
        let last = self.x.to.min(x + 2.0 * (y - self.y.from));
        let at = |across: f64| (libm::exp10(across), libm::exp10(y - 0.5 * (across - x)));
        (first < last).then(|| [at(first), at(last)])
    }

    /// Draws labels near their points, and leader lines to distant labels.
    fn labels(&self, svg: &mut String, labels: &[((f64, f64), &str)], obstacles: &[Area]) {
        /// Maximum distance of a label without a leader line.
        const NEAR: f64 = 12.0;
        /// Descent of letters below the baseline.
        const BELOW: f64 = 3.0;
        let within = Area {
            left: Layout::LEFT,
            top: Layout::TOP,
            right: self.layout.right(),
            bottom: self.layout.bottom(),
        };
        for ((at, label), area) in labels.iter().zip(place(labels, obstacles, within)) {
            let Some(area) = area else { continue };
            let nearest = area.nearest(*at);
            if libm::hypot(nearest.0 - at.0, nearest.1 - at.1) > NEAR {
                let ((x, y), (to_x, to_y)) = (*at, nearest);
                let _ = writeln!(svg, "<path class=\"leader\" d=\"M{x:.1} {y:.1}L{to_x:.1} {to_y:.1}\"/>");
            }
            text(svg, (area.left, area.bottom - BELOW), "start", label);
        }
    }
}

/// Returns the SVG path of a star with five points.
fn star((x, y): (f64, f64)) -> String {
    let corner = |corner: u8| {
        let radius = if corner.is_multiple_of(2) { 7.0 } else { 3.0 };
        let angle = std::f64::consts::PI * f64::from(corner) / 5.0;
        format!("{:.1} {:.1}", x + radius * libm::sin(angle), y - radius * libm::cos(angle))
    };
    format!("M{}Z", (0..10).map(corner).collect::<Vec<_>>().join("L"))
}

fn text(svg: &mut String, (x, y): (f64, f64), anchor: &str, text: &str) {
    if !text.is_empty() {
        let text = escaped(text);
        let _ = writeln!(svg, "<text x=\"{x:.1}\" y=\"{y:.1}\" text-anchor=\"{anchor}\">{text}</text>");
    }
}

impl Chart<'_> {
    /// Returns the chart as SVG, followed by its legend. Colours are given as CSS classes.
    pub(super) fn svg(&self) -> String {
        let marks = || self.series.iter().flat_map(|series| &series.marks);
        let reaches = marks().flat_map(|mark| mark.reach.map_or([mark.x; 2], |(low, high)| [low, high]));
        let x = Axis::over(reaches);
        let y = Axis::over(marks().map(|mark| mark.y).chain(self.floor));
        let plot = Plot { layout: self.layout, x, y };
        let Layout { width, height } = self.layout;
        let mut svg = format!(
            "<svg class=\"chart\" viewBox=\"0 0 {width} {height}\" role=\"img\" aria-label=\"{}\">\n",
            escaped(self.title)
        );
        plot.axes(&mut svg, self.x, self.y);
        if let Some(floor) = self.floor.filter(|floor| *floor > 0.0) {
            plot.floor(&mut svg, floor);
        }
        let guide = self.guide.and_then(|through| plot.guide(through));
        let mut lines: Vec<(&str, Vec<(f64, f64)>)> =
            guide.iter().map(|ends| ("guide", ends.to_vec())).collect();
        lines.extend(self.lines.iter().map(|line| ("law", line.clone())));
        for (class, line) in &lines {
            plot.polyline(&mut svg, class, line.iter().copied());
        }
        for (index, series) in self.series.iter().enumerate() {
            let _ = writeln!(svg, "<g class=\"{}\">", color(index));
            if series.joined {
                plot.polyline(&mut svg, "way", series.marks.iter().map(|mark| (mark.x, mark.y)));
            }
            let others = series.marks.iter().filter(|mark| mark.form != Form::Star);
            others.for_each(|mark| plot.mark(&mut svg, mark));
            svg += "</g>\n";
        }
        // Stars are drawn above all other marks.
        for (index, series) in self.series.iter().enumerate() {
            let _ = writeln!(svg, "<g class=\"{}\">", color(index));
            let stars = series.marks.iter().filter(|mark| mark.form == Form::Star);
            stars.for_each(|mark| plot.mark(&mut svg, mark));
            svg += "</g>\n";
        }
        let places: Vec<(f64, f64)> = marks().map(|mark| plot.place((mark.x, mark.y))).collect();
        let ways = self.series.iter().filter(|series| series.joined);
        let ways = ways.map(|series| series.marks.iter().map(|mark| (mark.x, mark.y)).collect());
        let bars =
            marks().filter_map(|mark| mark.reach.map(|(low, high)| vec![(low, mark.y), (high, mark.y)]));
        let on_lines = lines.into_iter().map(|(_, line)| line).chain(ways).chain(bars);
        let on_lines = on_lines.flat_map(|line| plot.along(&line));
        let obstacles: Vec<Area> =
            places.iter().map(|place| Area::around(*place, 5.0)).chain(on_lines).collect();
        let labelled = marks().zip(&places).filter_map(|(mark, at)| Some((*at, mark.label.as_deref()?)));
        // The label of the guide is near its end, where marks are few.
        let near_end = |first: f64, last: f64| first * libm::pow(last / first, 0.9);
        let at =
            guide.map(|[(x, y), (last_x, last_y)]| plot.place((near_end(x, last_x), near_end(y, last_y))));
        let guide = at.map(|at| (at, "n^-1/2"));
        let labels: Vec<((f64, f64), &str)> = labelled.chain(guide).collect();
        plot.labels(&mut svg, &labels, &obstacles);
        svg += "</svg>\n";
        self.legend(&mut svg);
        svg
    }

    fn legend(&self, page: &mut String) {
        let named: Vec<(usize, &Series)> =
            self.series.iter().enumerate().filter(|(_, series)| !series.name.is_empty()).collect();
        if named.is_empty() {
            return;
        }
        *page += "<p class=\"legend\">";
        for (index, series) in named {
            let _ = write!(page, "<span class=\"{}\">● {}</span> ", color(index), escaped(&series.name));
        }
        *page += "</p>\n";
    }
}

/// Returns the CSS class of a series' colour. There are nine colours.
fn color(index: usize) -> String {
    format!("s{}", index % 9)
}

/// Escapes a text for HTML.
pub(super) fn escaped(text: &str) -> String {
    text.replace('&', "&amp;").replace('<', "&lt;").replace('>', "&gt;").replace('"', "&quot;")
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn ticks_are_round() {
        let labels = |from: f64, to: f64| {
            let axis = Axis::over([from, to].into_iter());
            axis.ticks()
                .into_iter()
                .map(|(_, label)| label)
                .filter(|label| !label.is_empty())
                .collect::<Vec<_>>()
        };
        assert_eq!(labels(0.02, 0.9), ["0.02", "0.05", "0.1", "0.2", "0.5", "1"]);
        assert_eq!(labels(1.0, 1000.0), ["1", "10", "100", "1000"]);
        assert_eq!(labels(0.0, 0.0), ["1", "2", "5", "10"]);
    }

    #[test]
    fn texts_are_escaped() {
        let (form, title) = (Form::Disc, "<b>\"&".to_owned());
        let mark = ChartMark { x: 1.0, y: 1.0, reach: None, form, title, label: None };
        let series = Series { name: "<i>".to_owned(), marks: vec![mark], joined: true };
        let chart = Chart {
            title: "<",
            x: "<x>",
            y: "y",
            series: vec![series],
            lines: Vec::new(),
            guide: None,
            floor: None,
            layout: Layout::WIDE,
        };
        let svg = chart.svg();
        assert!(svg.contains("&lt;b&gt;&quot;&amp;") && svg.contains("&lt;x&gt;") && !svg.contains("<i>"));
    }
}
