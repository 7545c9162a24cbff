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

    /// Returns the smallest box around this one and another one.
    pub(crate) fn union(self, other: Self) -> Self {
        Self { min: self.min.min(other.min), max: self.max.max(other.max) }
    }

    /// Returns the largest magnitude of a coordinate.
    pub(crate) fn largest(&self) -> f64 {
        self.min.abs().max(self.max.abs()).max_element()
    }
}

/// A bounding box in `f32`, rounded outwards, for boxes of which many are stored.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) struct CompactBounds {
    pub(crate) min: [f32; 3],
    pub(crate) max: [f32; 3],
}

impl CompactBounds {
    /// The empty box.
    pub(crate) const EMPTY: Self = Self { min: [f32::INFINITY; 3], max: [f32::NEG_INFINITY; 3] };

    /// Creates the box between coordinates that have relative errors of at most 2^-22. Sides outside the range of `f32` become infinite.
    #[inline]
    pub(crate) fn between(min: [f32; 3], max: [f32; 3]) -> Self {
        Self { min: min.map(below), max: max.map(|side| -below(-side)) }
    }

    /// Creates a box around another one.
    pub(crate) fn around(Bounds { min, max }: Bounds) -> Self {
        Self::between(min.as_vec3().to_array(), max.as_vec3().to_array())
    }

    #[inline]
    pub(crate) fn is_empty(&self) -> bool {
        self.min[0] > self.max[0]
    }

    /// Extends the box to contain another one.
    #[inline]
    pub(crate) fn join(&mut self, other: &Self) {
        for axis in 0..3 {
            self.min[axis] = self.min[axis].min(other.min[axis]);
            self.max[axis] = self.max[axis].max(other.max[axis]);
        }
    }

    /// Returns the largest magnitude of a coordinate.
    #[inline]
    pub(crate) fn largest(&self) -> f64 {
        self.min.iter().chain(&self.max).fold(0.0_f32, |largest, side| largest.max(side.abs())).into()
    }
}

/// Returns a number that is lower by more than 2^-22 of it; minus infinity for a number that is not finite.
#[inline]
fn below(number: f32) -> f32 {
    let lower = number - number.abs() * (4.0 * f32::EPSILON) - f32::MIN_POSITIVE;
    if lower > f32::NEG_INFINITY { lower } else { f32::NEG_INFINITY }
}
