//! Charts of a value over time.

use super::axis::Steps;
use super::sample::Rates;
use super::svg::{Anchor, DrawingArea, PagePoint, Svg};

pub(super) fn draw(svg: &mut Svg, rates: &Rates, frame: DrawingArea, title: &str) {
    let (from, to) = rates.span;
    let seconds = if to > from { to - from } else { 1.0 };
    let most = rates.range().1;
    let steps = Steps::over(most, 3.0);
    let top = if most > 0.0 { (most / steps.size() - 1e-9).ceil().max(1.0) * steps.size() } else { 1.0 };
    let place = |(second, rate): &(f64, f64)| -> PagePoint {
        [frame.left + (second - from) / seconds * frame.width, frame.bottom() - rate / top * frame.height]
    };

    svg.text("note", [frame.left, frame.top - 8.0], Anchor::Start, title);
    for (value, text) in steps.within(0.0, top) {
        let [_, y] = place(&(from, value));
        svg.line("grid", [frame.left, y], [frame.right(), y]);
        svg.text("note", [frame.left - 6.0, y + 4.0], Anchor::End, &text);
    }
    for (second, text) in Steps::over(seconds, 12.0).within(from, from + seconds) {
        let [x, _] = place(&(second, 0.0));
        svg.line("frame", [x, frame.bottom()], [x, frame.bottom() + 4.0]);
        svg.text("note", [x, frame.bottom() + 16.0], Anchor::Middle, &format!("{text} s"));
    }
    svg.line("frame", [frame.left, frame.top], [frame.left, frame.bottom()]);
    svg.line("frame", [frame.left, frame.bottom()], [frame.right(), frame.bottom()]);
    let shots: Vec<Vec<PagePoint>> = rates.shots.iter().map(|shot| thinned(shot.iter().map(place))).collect();
    svg.lines("value", &shots);
}

/// Drops points that are very close to the previously kept point, except for the last point.
pub(super) fn thinned(places: impl Iterator<Item = PagePoint>) -> Vec<PagePoint> {
    const APART: f64 = 0.4;
    let mut kept: Vec<PagePoint> = Vec::new();
    let mut left_out = None;
    for place in places {
        let near = |last: &PagePoint| (place[0] - last[0]).abs().max((place[1] - last[1]).abs()) < APART;
        if kept.last().is_some_and(near) {
            left_out = Some(place);
        } else {
            kept.push(place);
            left_out = None;
        }
    }
    kept.extend(left_out);
    kept
}
