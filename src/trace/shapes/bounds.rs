//! Bounding boxes of shapes.

use glam::DVec3;

/// An axis-aligned box that contains a shape. By default it contains the origin.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Bounds {
    /// Smallest coordinates.
    pub min: DVec3,
    /// Largest coordinates.
    pub max: DVec3,
}

impl Bounds {
    /// All points within `half` of `center`, rounded outwards.
    #[must_use]
    pub fn around(center: DVec3, half: DVec3) -> Self {
        let down = DVec3::from_array((center - half).to_array().map(f64::next_down));
        let up = DVec3::from_array((center + half).to_array().map(f64::next_up));
        Self { min: down, max: up }
    }

    /// The middle.
    #[must_use]
    pub fn center(&self) -> DVec3 {
        0.5 * self.min + 0.5 * self.max
    }

    /// The longest edge.
    #[must_use]
    pub fn extent(&self) -> f64 {
        (self.max - self.min).max_element()
    }
}
