//! Points and rectangles on a drawing.

/// A point on a drawing: pixels to the right and down.
pub type PagePoint = [f64; 2];

/// A rectangle on a drawing.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Area {
    pub left: f64,
    pub top: f64,
    pub width: f64,
    pub height: f64,
}

impl Area {
    /// Returns the rectangle around a point with these half sides.
    pub fn around([x, y]: PagePoint, [across, down]: PagePoint) -> Self {
        Self { left: x - across, top: y - down, width: 2.0 * across, height: 2.0 * down }
    }

    pub fn right(&self) -> f64 {
        self.left + self.width
    }

    pub fn bottom(&self) -> f64 {
        self.top + self.height
    }

    pub fn middle(&self) -> PagePoint {
        [self.left + 0.5 * self.width, self.top + 0.5 * self.height]
    }

    pub fn overlaps(&self, other: &Self) -> bool {
        self.left < other.right()
            && other.left < self.right()
            && self.top < other.bottom()
            && other.top < self.bottom()
    }

    pub fn holds(&self, other: &Self) -> bool {
        self.left <= other.left
            && other.right() <= self.right()
            && self.top <= other.top
            && other.bottom() <= self.bottom()
    }

    /// Returns the part of a line that is inside the rectangle, by the algorithm of Liang and Barsky. `None` if that is a point or nothing.
    pub fn clip(&self, [from, to]: [PagePoint; 2]) -> Option<[PagePoint; 2]> {
        let across = [to[0] - from[0], to[1] - from[1]];
        let (low, high) = ([self.left, self.top], [self.right(), self.bottom()]);
        let (mut enters, mut leaves) = (0.0_f64, 1.0_f64);
        for axis in 0..2 {
            let ends = [low[axis] - from[axis], high[axis] - from[axis]];
            if across[axis] == 0.0 {
                if ends[0] > 0.0 || ends[1] < 0.0 {
                    return None;
                }
                continue;
            }
            let [one, other] = ends.map(|end| end / across[axis]);
            (enters, leaves) = (enters.max(one.min(other)), leaves.min(one.max(other)));
        }
        let at = |share: f64| [from[0] + share * across[0], from[1] + share * across[1]];
        (enters < leaves).then(|| [at(enters), at(leaves)])
    }

    /// Returns the point of the rectangle that is nearest to the given point.
    pub fn nearest(&self, [x, y]: PagePoint) -> PagePoint {
        [x.clamp(self.left, self.right()), y.clamp(self.top, self.bottom())]
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn lines_are_clipped_at_the_edges() {
        let area = Area { left: 10.0, top: 20.0, width: 40.0, height: 20.0 };
        for (line, inside) in [
            ([[15.0, 25.0], [45.0, 35.0]], Some([[15.0, 25.0], [45.0, 35.0]])),
            ([[0.0, 10.0], [60.0, 40.0]], Some([[20.0, 20.0], [50.0, 35.0]])),
            ([[60.0, 30.0], [20.0, 30.0]], Some([[50.0, 30.0], [20.0, 30.0]])),
            ([[30.0, 0.0], [30.0, 100.0]], Some([[30.0, 20.0], [30.0, 40.0]])),
            ([[0.0, 30.0], [30.0, 0.0]], None),
            ([[5.0, 25.0], [5.0, 35.0]], None),
            ([[30.0, 45.0], [30.0, 60.0]], None),
        ] {
            assert_eq!(area.clip(line), inside, "{line:?}");
        }
    }
}
