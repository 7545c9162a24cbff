//! The functions of patterns.

use glam::DVec3;

use super::noise::fractal;
use crate::color::to_f32;
use crate::trace::math::scaled;

/// The function of a pattern.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum PatternFunction {
    /// Squares with this side; cubes in spheres.
    Checker {
        /// The side, greater than 0.
        size: f64,
    },
    /// Stripes of both colours.
    Stripes {
        /// The distance between stripes of the same colour, greater than 0.
        size: f64,
        /// The fraction of the second colour, 0..=1.
        ratio: f64,
        /// The direction across the stripes, not zero.
        direction: DVec3,
        /// The coordinate along the direction at which a stripe of the first colour starts.
        offset: f64,
    },
    /// Bricks of the first colour with joints of the second one.
    Bricks {
        /// The distances between bricks along the axes, greater than 0.
        size: DVec3,
        /// The width of the joints, 0 or more.
        mortar: f64,
    },
    /// A blend from the first to the second colour.
    Gradient {
        /// The length of the blend, greater than 0.
        size: f64,
        /// The direction from the first to the second colour, not zero.
        direction: DVec3,
        /// The coordinate of the middle along the direction.
        offset: f64,
    },
    /// A blend of both colours by fractal noise.
    Noise {
        /// The side of the largest cells, greater than 0.
        size: f64,
        /// The number of octaves, 1 to 16.
        octaves: u32,
        /// A factor of the distance from an even blend, 0 or more.
        contrast: f64,
    },
}

/// The distance by which borders in a surface are moved outwards, relative to the size of the pattern: greater than the rounding error of
/// coordinates up to some thousand sizes, and invisible.
pub(super) const BORDER_OFFSET: f64 = 1.0 / (1_u64 << 40) as f64;

/// The largest change of a blend within a pixel that looks smooth, as the shading of a ball of a hundred pixels does. A single sample of a
/// black and white blend is then off by one 8-bit level, as the root of the mean square.
pub(super) const SMOOTH: f32 = 1.0 / 64.0;

/// The part of the smallest cells of noise in which it is nearly linear, so that some points show how it changes between them.
pub(super) const SMALL_PART: f64 = 1.0 / 8.0;

/// The change of the blend per unit of noise. The standard deviation of the blend is then 0.20 to 0.23, and up to one point in forty is beyond
/// the two colours.
const BLEND: f64 = 0.6;

impl PatternFunction {
    /// Returns the function with its direction as a unit vector. `None` if a number has no use.
    pub(super) fn prepared(self) -> Option<Self> {
        let is_positive = |number: f64| number > 0.0;
        Some(match self {
            Self::Checker { size } if is_positive(size) => self,
            Self::Stripes { size, ratio, direction, offset } if is_positive(size) && offset.is_finite() => {
                let ratio = if ratio > 0.0 { ratio.min(1.0) } else { 0.0 };
                Self::Stripes { size, ratio, direction: unit(direction)?, offset }
            }
            Self::Bricks { size, mortar } if size.cmpgt(DVec3::ZERO).all() && mortar.is_finite() => {
                Self::Bricks { size, mortar: mortar.max(0.0) }
            }
            Self::Gradient { size, direction, offset } if is_positive(size) && offset.is_finite() => {
                Self::Gradient { size, direction: unit(direction)?, offset }
            }
            Self::Noise { size, octaves, contrast } if is_positive(size) && contrast.is_finite() => {
                Self::Noise { size, octaves: octaves.clamp(1, 16), contrast: contrast.max(0.0) }
            }
            _ => return None,
        })
    }

    /// Returns a code that differs between functions, for fingerprints. The second lowest bit is free.
    pub(super) fn code(&self) -> u32 {
        match self {
            Self::Checker { .. } => 1,
            Self::Stripes { .. } => 5,
            Self::Bricks { .. } => 9,
            Self::Gradient { .. } => 13,
            Self::Noise { .. } => 17,
        }
    }

    /// Passes all numbers to `each`.
    pub(super) fn numbers(&self, each: impl FnMut(f64)) {
        match *self {
            Self::Checker { size } => [size].into_iter().for_each(each),
            Self::Stripes { size, ratio, direction: DVec3 { x, y, z }, offset } => {
                [x, y, z, size, ratio, offset].into_iter().for_each(each);
            }
            Self::Bricks { size: DVec3 { x, y, z }, mortar } => [x, y, z, mortar].into_iter().for_each(each),
            Self::Gradient { size, direction: DVec3 { x, y, z }, offset } => {
                [x, y, z, size, offset].into_iter().for_each(each);
            }
            Self::Noise { size, octaves, contrast } => {
                [size, octaves.into(), contrast].into_iter().for_each(each);
            }
        }
    }

    /// Returns its direction, zero if it has none.
    pub(super) fn direction(&self) -> DVec3 {
        match self {
            Self::Checker { .. } | Self::Bricks { .. } | Self::Noise { .. } => DVec3::ZERO,
            Self::Stripes { direction, .. } | Self::Gradient { direction, .. } => *direction,
        }
    }
}

/// Returns the unit vector in a direction; `None` if it has none.
pub(super) fn unit(direction: DVec3) -> Option<DVec3> {
    scaled(direction).map(|(direction, _)| direction / direction.dot(direction).sqrt())
}

/// Returns a number as a fraction: 0 below 0 and for NaN, 1 above 1.
pub(super) fn fraction(number: f64) -> f32 {
    if number > 0.0 { to_f32(number.min(1.0)) } else { 0.0 }
}

/// Returns whether a coordinate in units of the size of stripes is in a stripe of the second colour.
pub(super) fn in_stripe(place: f64, ratio: f64) -> bool {
    place >= place.floor() + (1.0 - ratio)
}

/// Returns the axis along which rows of bricks follow each other: y, but z on a surface across y.
pub(super) fn row_axis(across: usize) -> usize {
    if across == 1 { 2 } else { 1 }
}

/// Returns by how much of their length the bricks of a row are shifted: half of it in every second row (running bond).
pub(super) fn bond(row: f64) -> f64 {
    if row.rem_euclid(2.0) == 1.0 { 0.5 } else { 0.0 }
}

/// Returns whether a coordinate in units of the size of bricks is in a joint. Joints are around integers, up to `half` to both sides.
pub(super) fn in_joint(place: f64, half: f64) -> bool {
    let within = place - place.floor();
    within < half || within > 1.0 - half
}

/// A range of coordinates in units of the size of bricks.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) enum BrickPart {
    /// It is inside a joint.
    Joint,
    /// It is inside the brick with this number.
    Brick(f64),
    /// It can contain a border.
    Several,
}

impl BrickPart {
    pub(super) fn of([least, most]: [f64; 2], half: f64) -> Self {
        // The middle of a joint is an integer, and half a brick away from it is the middle of a brick.
        let [first, last] = [least + half, most + half].map(f64::floor);
        if first != last {
            Self::Several
        } else if least >= first - half && most <= first + half {
            Self::Joint
        } else if !in_joint(least, half) && !in_joint(most, half) {
            Self::Brick(first)
        } else {
            Self::Several
        }
    }
}

/// Returns the blend of fractal noise, not clamped.
pub(super) fn noise_blend(place: DVec3, octaves: u32, contrast: f64) -> f64 {
    0.5 + contrast * BLEND * fractal(place, octaves)
}
