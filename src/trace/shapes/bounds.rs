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
    /// Returns the box of half-extent `half` around `center`, rounded outwards.
    #[must_use]
    pub fn around(center: DVec3, half: DVec3) -> Self {
        let down = DVec3::from_array((center - half).to_array().map(f64::next_down));
        let up = DVec3::from_array((center + half).to_array().map(f64::next_up));
        Self { min: down, max: up }
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
