//! Placement of texts next to points, so that they cover neither each other nor marks and lines.

use super::{Area, PagePoint, Svg, TextAnchor};

/// Width of a character of 12 pixels.
const CHARACTER: f64 = 6.6;
/// Height of a line.
const LINE: f64 = 13.0;
/// Space on both sides of a text.
const MARGIN: f64 = 3.0;
/// Descent of letters below the baseline.
const BELOW: f64 = 3.0;

/// The texts and obstacles in an area.
pub struct Labels {
    within: Area,
    taken: Vec<Area>,
}

impl Labels {
    pub fn within(within: Area) -> Self {
        Self { within, taken: Vec::new() }
    }

    /// Keeps texts off a mark with this radius.
    pub fn avoid_mark(&mut self, at: PagePoint, radius: f64) {
        self.taken.push(Area::around(at, [radius; 2]));
    }

    /// Keeps texts off a line.
    pub fn avoid(&mut self, line: &[PagePoint]) {
        const STEP: f64 = 4.0;
        for pair in line.windows(2) {
            let [x, y] = [pair[1][0] - pair[0][0], pair[1][1] - pair[0][1]];
            let count = (libm::hypot(x, y) / STEP).clamp(1.0, 1000.0).ceil();
            let shares = (0..).map(f64::from).take_while(|index| *index <= count).map(|index| index / count);
            for share in shares {
                self.avoid_mark([pair[0][0] + share * x, pair[0][1] + share * y], 1.0);
            }
        }
    }

    /// Reserves the first free place for a text, in these directions from a point and at these distances from it, nearest first.
    pub fn place(
        &mut self,
        at: PagePoint,
        text: &str,
        directions: &[PagePoint],
        distances: impl IntoIterator<Item = f64>,
    ) -> Option<Area> {
        let half = [MARGIN + 0.5 * CHARACTER * text.chars().count() as f64, 0.5 * LINE];
        let candidate = |distance: f64, direction: &PagePoint| {
            let center = |axis: usize| at[axis] + direction[axis] * (distance + half[axis]);
            Area::around([center(0), center(1)], half)
        };
        let mut candidates = distances
            .into_iter()
            .flat_map(|distance| directions.iter().map(move |direction| candidate(distance, direction)));
        let is_free =
            |area: &Area| self.within.holds(area) && !self.taken.iter().any(|other| other.overlaps(area));
        let found = candidates.find(is_free);
        self.taken.extend(found);
        found
    }

    /// Writes a text into its [place](Self::place).
    pub fn write(svg: &mut Svg, class: &str, place: Area, text: &str) {
        svg.text(class, [place.middle()[0], place.bottom() - BELOW], TextAnchor::Middle, text);
    }
}

/// Returns directions all around, from the upper right.
pub fn directions() -> [PagePoint; 16] {
    std::array::from_fn(|index| {
        let angle = std::f64::consts::TAU * (index as f64 / 16.0 + 0.125);
        [libm::cos(angle), -libm::sin(angle)]
    })
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Places labels at clustered marks, as made by settings with nearly the same time and error.
    #[test]
    fn labels_do_not_overlap_labels_or_marks() {
        let within = Area { left: 0.0, top: 0.0, width: 640.0, height: 340.0 };
        let mut state = 7_u32;
        let mut random = move |most: f64| {
            state = state.wrapping_mul(1_664_525).wrapping_add(1_013_904_223);
            f64::from(state >> 8) / 16_777_216.0 * most
        };
        for _ in 0..50 {
            let clusters: Vec<PagePoint> = (0..4).map(|_| [random(640.0), random(340.0)]).collect();
            let marks: Vec<PagePoint> = (0..28)
                .map(|mark| [clusters[mark % 4][0] + random(20.0), clusters[mark % 4][1] + random(20.0)])
                .collect();
            let obstacles: Vec<Area> = marks.iter().map(|mark| Area::around(*mark, [4.0; 2])).collect();
            let placed = || {
                let mut labels = Labels { within, taken: obstacles.clone() };
                let distances = || (0..30).map(|step| 7.0 + 6.0 * f64::from(step));
                let placed = marks.iter().map(|mark| {
                    let place = labels.place(*mark, "max error 0.25", &directions(), distances());
                    place.expect("there is room for all")
                });
                placed.collect::<Vec<Area>>()
            };
            let areas = placed();
            assert_eq!(areas, placed());
            for (index, area) in areas.iter().enumerate() {
                assert!(within.holds(area));
                assert!(
                    !obstacles.iter().chain(&areas[..index]).any(|other| other.overlaps(area)),
                    "{area:?}"
                );
            }
        }
    }

    #[test]
    fn labels_without_room_are_omitted() {
        let mut labels = Labels::within(Area { left: 0.0, top: 0.0, width: 30.0, height: 30.0 });
        assert_eq!(labels.place([5.0, 5.0], "longer than the area", &directions(), [7.0]), None);
    }
}
