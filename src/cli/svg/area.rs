//! Points and rectangles on a drawing.

/// A point on a drawing: pixels to the right and down.
pub(crate) type PagePoint = [f64; 2];

/// A rectangle on a drawing.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) struct Area {
    pub(crate) left: f64,
    pub(crate) top: f64,
    pub(crate) width: f64,
    pub(crate) height: f64,
}

impl Area {
    /// Returns the rectangle around a point with these half sides.
    pub(crate) fn around([x, y]: PagePoint, [across, down]: PagePoint) -> Self {
        Self { left: x - across, top: y - down, width: 2.0 * across, height: 2.0 * down }
    }

    pub(crate) fn right(&self) -> f64 {
        self.left + self.width
    }

    pub(crate) fn bottom(&self) -> f64 {
        self.top + self.height
    }

    pub(crate) fn middle(&self) -> PagePoint {
        [self.left + 0.5 * self.width, self.top + 0.5 * self.height]
    }

    pub(crate) fn overlaps(&self, other: &Self) -> bool {
        self.left < other.right()
            && other.left < self.right()
            && self.top < other.bottom()
            && other.top < self.bottom()
    }

    pub(crate) fn holds(&self, other: &Self) -> bool {
        self.left <= other.left
            && other.right() <= self.right()
            && self.top <= other.top
            && other.bottom() <= self.bottom()
    }

    /// Returns the point of the rectangle that is nearest to the given point.
    pub(crate) fn nearest(&self, [x, y]: PagePoint) -> PagePoint {
        [x.clamp(self.left, self.right()), y.clamp(self.top, self.bottom())]
    }
}
