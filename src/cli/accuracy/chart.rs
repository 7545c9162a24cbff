//! Charts of errors on logarithmic axes, in the colours of the page.

use rayreel::drawing::{Area, Axis, Labels, PagePoint, Plot, Svg, TextAnchor, directions, escaped};

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
    pub(super) lines: Vec<Vec<[f64; 2]>>,
    /// A point on a dotted line that falls as n^-1/2.
    pub(super) guide: Option<[f64; 2]>,
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

    /// Returns the area between the axes.
    fn area(self) -> Area {
        let (left, top) = (62.0, 16.0);
        Area { left, top, width: self.width - 16.0 - left, height: self.height - 46.0 - top }
    }
}

/// Draws a mark and the range of its values.
fn draw_mark(svg: &mut Svg, plot: &Plot, mark: &ChartMark) {
    let at = plot.at([mark.x, mark.y]);
    if let Some((low, high)) = mark.reach {
        svg.line("reach", plot.at([low, mark.y]), plot.at([high, mark.y]));
    }
    match mark.form {
        Form::Star => svg.titled_lines("star", &[star(at)], &mark.title),
        Form::Ring => svg.dot("ring", at, 4.0, &mark.title),
        Form::Disc => svg.dot("disc", at, 4.0, &mark.title),
    }
}

/// Returns the corners of a star with five points, the first of them again at the end.
fn star([x, y]: PagePoint) -> Vec<PagePoint> {
    let corner = |corner: u8| {
        let radius = if corner.is_multiple_of(2) { 7.0 } else { 3.0 };
        let angle = std::f64::consts::PI * f64::from(corner % 10) / 5.0;
        [x + radius * libm::sin(angle), y - radius * libm::cos(angle)]
    };
    (0..=10).map(corner).collect()
}

/// Returns the ends of the line through a point that falls as n^-1/2, clipped to the plot.
fn guide(plot: &Plot, [x, y]: [f64; 2]) -> Option<[[f64; 2]; 2]> {
    let (x, y) = (libm::log10(x), libm::log10(y));
    let first = plot.x.from.max(x + 2.0 * (y - plot.y.to));
    let last = plot.x.to.min(x + 2.0 * (y - plot.y.from));
    let at = |across: f64| [libm::exp10(across), libm::exp10(y - 0.5 * (across - x))];
    (first < last).then(|| [at(first), at(last)])
}

impl Chart<'_> {
    /// Returns the chart as SVG, followed by its legend. Colours are given as CSS classes.
    pub(super) fn svg(&self) -> String {
        let Layout { width, height } = self.layout;
        let plot = self.plot();
        let mut svg = Svg::new([width, height], self.title);
        plot.draw(&mut svg);
        let [across, up] = plot.area.middle();
        svg.text("", [across, height - 8.0], TextAnchor::Middle, self.x);
        svg.upward_text([12.0, up], self.y);
        if let Some(floor) = self.floor.filter(|floor| *floor > 0.0) {
            let top = plot.at([1.0, floor])[1].min(plot.area.bottom());
            let below = Area { top, height: plot.area.bottom() - top, ..plot.area };
            svg.filled("floor", below, "less than the reference knows");
        }
        let guide = self.guide.and_then(|through| guide(&plot, through));
        let guide_lines = guide.iter().map(|ends| ("guide", ends.to_vec()));
        let lines = guide_lines.chain(self.lines.iter().map(|line| ("law", line.clone())));
        let mut labels = Labels::within(plot.area);
        for (class, line) in lines {
            let line: Vec<PagePoint> = line.into_iter().map(|values| plot.at(values)).collect();
            labels.avoid(&line);
            svg.lines(class, &[line]);
        }
        self.draw_series(&mut svg, &plot, &mut labels);
        self.draw_labels(&mut svg, &plot, &mut labels, guide);
        svg.finish() + self.legend().as_str()
    }

    /// Returns the plot, with logarithmic axes that cover all marks.
    fn plot(&self) -> Plot {
        let reaches = self.marks().flat_map(|mark| mark.reach.map_or([mark.x; 2], |(low, high)| [low, high]));
        Plot {
            area: self.layout.area(),
            x: Axis::logarithmic(reaches),
            y: Axis::logarithmic(self.marks().map(|mark| mark.y).chain(self.floor)),
        }
    }

    fn marks(&self) -> impl Iterator<Item = &ChartMark> {
        self.series.iter().flat_map(|series| &series.marks)
    }

    /// Draws the marks of all series and the lines that join them.
    fn draw_series(&self, svg: &mut Svg, plot: &Plot, labels: &mut Labels) {
        // Stars are drawn above all other marks.
        for stars in [false, true] {
            for (index, series) in self.series.iter().enumerate() {
                svg.group(&color(index));
                if series.joined && !stars {
                    let polyline: Vec<PagePoint> =
                        series.marks.iter().map(|mark| plot.at([mark.x, mark.y])).collect();
                    labels.avoid(&polyline);
                    svg.lines("way", &[polyline]);
                }
                let marks = series.marks.iter().filter(|mark| (mark.form == Form::Star) == stars);
                marks.for_each(|mark| draw_mark(svg, plot, mark));
                svg.end_group();
            }
        }
        for mark in self.marks() {
            labels.avoid_mark(plot.at([mark.x, mark.y]), 5.0);
            if let Some((low, high)) = mark.reach {
                labels.avoid(&[plot.at([low, mark.y]), plot.at([high, mark.y])]);
            }
        }
    }

    /// Draws labels near their points, and leader lines to distant labels.
    fn draw_labels(&self, svg: &mut Svg, plot: &Plot, labels: &mut Labels, guide: Option<[[f64; 2]; 2]>) {
        /// Maximum distance of a label without a leader line.
        const NEAR: f64 = 12.0;
        // The label of the guide is near its end, where marks are few.
        let near_end = |first: f64, last: f64| first * libm::pow(last / first, 0.9);
        let guide = guide.map(|[[x, y], [last_x, last_y]]| [near_end(x, last_x), near_end(y, last_y)]);
        let texts = self.marks().filter_map(|mark| Some(([mark.x, mark.y], mark.label.as_deref()?)));
        for (values, text) in texts.chain(guide.map(|at| (at, "n^-1/2"))) {
            let at = plot.at(values);
            let distances = (0..30).map(|step| 7.0 + 6.0 * f64::from(step));
            let Some(place) = labels.place(at, text, &directions(), distances) else { continue };
            let nearest = place.nearest(at);
            if libm::hypot(nearest[0] - at[0], nearest[1] - at[1]) > NEAR {
                svg.line("leader", at, nearest);
            }
            Labels::write(svg, "", place, text);
        }
    }

    fn legend(&self) -> String {
        let named = self.series.iter().enumerate().filter(|(_, series)| !series.name.is_empty());
        let entry = |(index, series): (usize, &Series)| {
            format!("<span class=\"{}\">● {}</span> ", color(index), escaped(&series.name))
        };
        let entries: String = named.map(entry).collect();
        if entries.is_empty() { entries } else { format!("<p class=\"legend\">{entries}</p>\n") }
    }
}

/// Returns the CSS class of a series' colour. There are nine colours.
fn color(index: usize) -> String {
    format!("s{}", index % 9)
}

#[cfg(test)]
mod tests {
    use super::*;

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
