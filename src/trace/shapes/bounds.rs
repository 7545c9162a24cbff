//! Bounding boxes of shapes.

use glam::DVec3;

/// An axis-aligned bounding box. The default contains only the origin.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Bounds {
    /// Smallest coordinates.
    pub min: DVec3,
    /// Largest coordinates.
    pub max: DVec3,
}

impl Bounds {
    /// Returns the box of half-extent `half` around `center`, rounded outwards by at most two units in the last place and 2^-1022.
    #[must_use]
    #[inline]
    pub fn around(center: DVec3, half: DVec3) -> Self {
        // At least a unit in the last place. Unlike a step to the next number, it takes no branch.
        let step = |side: DVec3| side.abs() * f64::EPSILON + f64::MIN_POSITIVE;
        let (low, high) = (center - half, center + half);
        Self { min: low - step(low), max: high + step(high) }
    }

    /// Returns the centre.
    #[must_use]
    pub fn center(&self) -> DVec3 {
        0.5 * self.min + 0.5 * self.max
    }

    /// Returns the length of the longest edge.
    #[must_use]
    pub fn extent(&self) -> f64 {
        (self.max - self.min).max_element()
    }
}
