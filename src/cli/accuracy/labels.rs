//! Placement of labels in charts, so that they cover neither each other nor the marks.

/// A rectangle; x points right and y points down.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) struct Area {
    pub(super) left: f64,
    pub(super) top: f64,
    pub(super) right: f64,
    pub(super) bottom: f64,
}

impl Area {
    /// Returns the square around a point, with sides of twice `radius`.
    pub(super) fn around((x, y): (f64, f64), radius: f64) -> Self {
        Self { left: x - radius, top: y - radius, right: x + radius, bottom: y + radius }
    }

    fn overlaps(&self, other: &Self) -> bool {
        self.left < other.right
            && other.left < self.right
            && self.top < other.bottom
            && other.top < self.bottom
    }

    fn contains(&self, other: &Self) -> bool {
        self.left <= other.left
            && self.top <= other.top
            && self.right >= other.right
            && self.bottom >= other.bottom
    }

    /// Returns the point of the area that is nearest to the given point.
    pub(super) fn nearest(&self, (x, y): (f64, f64)) -> (f64, f64) {
        (x.clamp(self.left, self.right), y.clamp(self.top, self.bottom))
    }
}

/// Width of a character in the font of charts.
const CHARACTER: f64 = 6.6;
/// Height of a line in the font of charts.
const LINE: f64 = 13.0;
/// Space on both sides of a label.
const MARGIN: f64 = 3.0;

/// Places labels within an area. Each label is put as near to its point as the obstacles and the labels before it allow; the first
/// direction tried is to the upper right. Labels without room get `None`.
pub(super) fn place(labels: &[((f64, f64), &str)], obstacles: &[Area], within: Area) -> Vec<Option<Area>> {
    /// Number of directions tried.
    const DIRECTIONS: u16 = 16;
    /// Minimum distance from a mark.
    const NEAREST: f64 = 7.0;
    /// Step between the distances tried.
    const STEP: f64 = 6.0;
    /// Number of distances tried.
    const DISTANCES: u16 = 30;
    let mut taken = obstacles.to_vec();
    let candidates = |(x, y): (f64, f64), text: &str| {
        let (half_width, half_height) = (MARGIN + 0.5 * CHARACTER * text.chars().count() as f64, 0.5 * LINE);
        (0..DISTANCES).flat_map(move |distance| {
            let distance = NEAREST + STEP * f64::from(distance);
            (0..DIRECTIONS).map(move |direction| {
                let angle = std::f64::consts::TAU * (f64::from(direction) / f64::from(DIRECTIONS) + 0.125);
                let (up, right) = (libm::sin(angle), libm::cos(angle));
                let (x, y) = (x + right * (distance + half_width), y - up * (distance + half_height));
                Area {
                    left: x - half_width,
                    top: y - half_height,
                    right: x + half_width,
                    bottom: y + half_height,
                }
            })
        })
    };
    let mut placed = Vec::with_capacity(labels.len());
    for (at, text) in labels {
        let is_free = |area: &Area| within.contains(area) && !taken.iter().any(|other| other.overlaps(area));
        let found = candidates(*at, text).find(is_free);
        taken.extend(found);
        placed.push(found);
    }
    placed
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Places labels at clustered marks, as made by settings with nearly the same time and error.
    #[test]
    fn labels_cover_neither_each_other_nor_marks() {
        let within = Area { left: 0.0, top: 0.0, right: 640.0, bottom: 340.0 };
        let mut state = 7_u32;
        let mut random = move |most: f64| {
            state = state.wrapping_mul(1_664_525).wrapping_add(1_013_904_223);
            f64::from(state >> 8) / 16_777_216.0 * most
        };
        for _ in 0..50 {
            let clusters: Vec<(f64, f64)> = (0..4).map(|_| (random(640.0), random(340.0))).collect();
            let marks: Vec<(f64, f64)> = (0..28)
                .map(|mark| (clusters[mark % 4].0 + random(20.0), clusters[mark % 4].1 + random(20.0)))
                .collect();
            let labels: Vec<((f64, f64), &str)> =
                marks.iter().map(|mark| (*mark, "max error 0.25")).collect();
            let obstacles: Vec<Area> = marks.iter().map(|mark| Area::around(*mark, 4.0)).collect();
            let placed = place(&labels, &obstacles, within);
            assert_eq!(placed, place(&labels, &obstacles, within));
            let placed: Vec<Area> =
                placed.into_iter().map(|area| area.expect("there is room for all")).collect();
            for (index, area) in placed.iter().enumerate() {
                assert!(within.contains(area));
                assert!(
                    !obstacles.iter().chain(&placed[..index]).any(|other| other.overlaps(area)),
                    "{area:?}"
                );
            }
        }
    }

    #[test]
    fn labels_without_room_are_left_out() {
        let within = Area { left: 0.0, top: 0.0, right: 30.0, bottom: 30.0 };
        assert_eq!(place(&[((5.0, 5.0), "longer than the area")], &[], within), [None]);
    }
}
