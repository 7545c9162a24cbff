//! Texts next to points, clear of each other and of the main lines.

use super::svg::{Anchor, DrawingArea, PagePoint, Svg};

/// The occupied parts of a frame.
pub(super) struct Labels {
    within: DrawingArea,
    /// Points on the lines that texts must not cover.
    lines: Vec<PagePoint>,
    /// The frames of the placed texts.
    taken: Vec<DrawingArea>,
    /// The labelled points.
    places: Vec<PagePoint>,
}

/// Height of a text in pixels.
const HEIGHT: f64 = 12.0;
/// Width of a character in pixels.
const CHARACTER: f64 = 6.4;

impl Labels {
    pub(super) fn within(frame: DrawingArea) -> Self {
        Self { within: frame, lines: Vec::new(), taken: Vec::new(), places: Vec::new() }
    }

    /// Keeps texts off a line.
    pub(super) fn keep_off(&mut self, line: &[PagePoint]) {
        const STEP: f64 = 3.0;
        for pair in line.windows(2) {
            let [x, y] = [pair[1][0] - pair[0][0], pair[1][1] - pair[0][1]];
            let count = (libm::hypot(x, y) / STEP).clamp(1.0, 1000.0).ceil();
            let shares = (0..).map(f64::from).take_while(|index| *index <= count).map(|index| index / count);
            self.lines.extend(shares.map(|share| [pair[0][0] + share * x, pair[0][1] + share * y]));
        }
    }

    /// Writes a text next to a point, preferably perpendicular to the path's `heading`. Returns `false` without writing if there is no room or
    /// if the point already has a text.
    pub(super) fn add(
        &mut self,
        svg: &mut Svg,
        class: &str,
        place: PagePoint,
        heading: Option<PagePoint>,
        text: &str,
    ) -> bool {
        /// Distance in pixels within which two points count as the same.
        const SAME: f64 = 6.0;
        let same = |[x, y]: &PagePoint| (place[0] - x).abs().max((place[1] - y).abs()) < SAME;
        if self.places.iter().any(same) {
            return false;
        }
        let width = CHARACTER * text.chars().count() as f64;
        let near = sides(heading).into_iter().map(|side| around(place, side, width, 7.0));
        let far = sides(heading).into_iter().map(|side| around(place, side, width, 18.0));
        let Some(room) = near.chain(far).find(|frame| self.is_free(frame)) else { return false };
        svg.text(class, [room.middle()[0], room.bottom() - 3.0], Anchor::Middle, text);
        self.taken.push(room);
        self.places.push(place);
        true
    }

    fn is_free(&self, frame: &DrawingArea) -> bool {
        self.within.holds(frame)
            && !self.taken.iter().any(|taken| taken.overlaps(frame))
            && !self.lines.iter().any(|place| frame.contains(*place))
    }
}

/// Returns the directions to try: perpendicular to the path, and then all around.
fn sides(heading: Option<PagePoint>) -> Vec<PagePoint> {
    const DIAGONAL: f64 = std::f64::consts::FRAC_1_SQRT_2;
    let [right, down] = heading.unwrap_or([0.0, 1.0]);
    let mut sides = vec![[down, -right], [-down, right]];
    sides.extend([[1.0, 0.0], [-1.0, 0.0], [0.0, 1.0], [0.0, -1.0]]);
    sides.extend(
        [[1.0, 1.0], [1.0, -1.0], [-1.0, 1.0], [-1.0, -1.0]].map(|side| side.map(|part| part * DIAGONAL)),
    );
    sides
}

/// Returns the frame of a text of the given width, at a distance from a point in the given direction.
fn around([x, y]: PagePoint, [right, down]: PagePoint, width: f64, distance: f64) -> DrawingArea {
    let middle = [x + right * (distance + 0.5 * width), y + down * (distance + 0.5 * HEIGHT)];
    DrawingArea { left: middle[0] - 0.5 * width, top: middle[1] - 0.5 * HEIGHT, width, height: HEIGHT }
}
