//! Bar chart of the cost and the worth of every effect, side by side.

use rayreel::drawing::{Area, Svg, TextAnchor};

/// The cost and the worth of an effect.
pub(super) struct Bar {
    pub(super) name: String,
    /// Fraction of the time that the effect takes.
    pub(super) share: f64,
    /// Deviation of `share` between measurements.
    pub(super) deviation: f64,
    pub(super) share_text: String,
    /// RMS error without the effect, in 8-bit levels.
    pub(super) error: f64,
    pub(super) error_text: String,
}

const WIDTH: f64 = 720.0;
const TOP: f64 = 30.0;
const ROW: f64 = 26.0;
/// Right edge of the names.
const NAMES: f64 = 118.0;
/// Left edges of the bars of both halves.
const STARTS: [f64; 2] = [126.0, 440.0];
/// Length of the longest bar of each half, without its label.
const LONGEST: f64 = 200.0;

/// Draws the bars as SVG, from the most expensive effect to the cheapest. Colours are given as CSS classes.
pub(super) fn svg(bars: &mut [Bar]) -> String {
    bars.sort_by(|one, other| other.share.total_cmp(&one.share));
    let height = TOP + ROW * bars.len() as f64 + 6.0;
    let most = |number: fn(&Bar) -> f64| bars.iter().map(number).fold(f64::MIN_POSITIVE, f64::max);
    let longest = [most(|bar| bar.share + bar.deviation), most(|bar| bar.error)];
    let mut svg = Svg::new([WIDTH, height], "Price and worth of effects");
    for (start, head) in STARTS.into_iter().zip(["price: share of the time", "worth: rms error without it"]) {
        svg.text("", [start, 16.0], TextAnchor::Start, head);
        svg.line("axis", [start, TOP - 4.0], [start, height - 4.0]);
    }
    for (index, bar) in bars.iter().enumerate() {
        let middle = TOP + ROW * (index as f64 + 0.5);
        svg.text("", [NAMES, middle + 4.0], TextAnchor::End, &bar.name);
        let halves = [(bar.share, bar.deviation, &bar.share_text), (bar.error, 0.0, &bar.error_text)];
        for (half, (value, deviation, words)) in halves.into_iter().enumerate() {
            let (start, scale) = (STARTS[half], LONGEST / longest[half]);
            let end = start + scale * value.max(0.0);
            let filled = Area { left: start, top: middle - 7.0, width: end - start, height: 14.0 };
            svg.filled(&format!("bar s{half}"), filled, "");
            let last = (end + scale * deviation).max(start);
            if deviation > 0.0 {
                let first = (end - scale * deviation).max(start);
                svg.line("whisker", [first, middle], [last, middle]);
            }
            svg.text("", [last + 6.0, middle + 4.0], TextAnchor::Start, words);
        }
    }
    svg.finish()
}
