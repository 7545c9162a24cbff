//! Charts of a value over time.

use rayreel::drawing::{Area, Axis, PagePoint, Plot, Rates, Svg, TextAnchor};

pub(super) fn draw(svg: &mut Svg, rates: &Rates, area: Area, title: &str) {
    let (from, to) = rates.span;
    let x = Axis::linear((from, to), 12.0).in_unit(" s");
    let plot = Plot { area, x, y: Axis::from_zero(rates.range().1, 3.0) };
    svg.text("", [area.left, area.top - 8.0], TextAnchor::Start, title);
    plot.draw(svg);
    let place = |(second, rate): &(f64, f64)| plot.at([*second, *rate]);
    let shots: Vec<Vec<PagePoint>> = rates.shots.iter().map(|shot| thinned(shot.iter().map(place))).collect();
    svg.lines("value", &shots);
}

/// Drops points that are very close to the previously kept point, except for the last point.
pub(super) fn thinned(places: impl Iterator<Item = PagePoint>) -> Vec<PagePoint> {
    const APART: f64 = 0.4;
    let mut kept: Vec<PagePoint> = Vec::new();
    let mut omitted = None;
    for place in places {
        let near = |last: &PagePoint| (place[0] - last[0]).abs().max((place[1] - last[1]).abs()) < APART;
        if kept.last().is_some_and(near) {
            omitted = Some(place);
        } else {
            kept.push(place);
            omitted = None;
        }
    }
    kept.extend(omitted);
    kept
}
