//! The quantities of properties: how they are written, and their ranges.

use std::f64::consts::PI;
use std::ops::RangeInclusive;

use super::table::table;
use super::{Refractive, Specular};
use crate::animation::Notation;
use crate::animation::limits::SMALLEST;

/// A range from the first to the second, both included.
type Range = (f64, f64);

const ANY: Range = (f64::NEG_INFINITY, f64::INFINITY);
const NOT_NEGATIVE: Range = (0.0, f64::INFINITY);
/// Greater than 0, as small as the file format allows.
const SIZE: Range = (SMALLEST, f64::INFINITY);
const SHARE: Range = (0.0, 1.0);

table! {
    /// What a number or three numbers measure: their notation, and the range to which each of them is clamped.
    #[derive(Clone, Copy, Debug, PartialEq, Eq)]
    pub(crate) enum Quantity: (Notation, Range) {
        /// Coordinates, scene units.
        Point => (Notation::Vector, ANY),
        /// Any vector but zero, whatever its length.
        Direction => (Notation::Vector, ANY),
        /// A rotation in space.
        Rotation => (Notation::Rotation, ANY),
        /// An angle of rotation, over any number of turns, radians.
        Turn => (Notation::Degrees, ANY),
        /// Factors along the axes, none of them 0.
        Factors => (Notation::Scale, ANY),
        /// Scene units, greater than 0.
        Length => (Notation::Number, SIZE),
        /// The edges of a box, each a length.
        Edges => (Notation::Vector, SIZE),
        /// A share of light.
        Coefficient => (Notation::Number, SHARE),
        /// The exponent of highlights.
        Shininess => (Notation::Number, (0.0, Specular::LARGEST_SHININESS as f64)),
        /// The ratio of the speed of light outside to that inside.
        RefractiveIndex => (Notation::Number, (Refractive::SMALLEST_IOR, Refractive::LARGEST_IOR)),
        /// Per scene unit of length and colour channel.
        Absorption => (Notation::Light, NOT_NEGATIVE),
        /// Light per colour channel, 1 being full.
        Light => (Notation::Light, NOT_NEGATIVE),
        /// The colour of a surface or a background.
        Color => (Notation::Color, NOT_NEGATIVE),
        /// From rim to rim of a spot light, radians.
        SpotAngle => (Notation::Degrees, (SMALLEST, PI)),
        /// The share of a spot light that fades.
        Softness => (Notation::Number, SHARE),
        /// Coefficients c0, c1, c2, of which c0 is greater than 0.
        Falloff => (Notation::Vector, NOT_NEGATIVE),
        /// The angle of a view, radians: less than half a turn.
        FieldOfView => (Notation::Degrees, (SMALLEST, PI.next_down())),
        /// The diameter of a lens, scene units.
        Aperture => (Notation::Number, NOT_NEGATIVE),
        /// The density of fog, per scene unit of length.
        Density => (Notation::Number, NOT_NEGATIVE),
    }
}

impl Quantity {
    /// Returns how it is written in scene files and scripts.
    pub(crate) const fn notation(self) -> Notation {
        self.row().1.0
    }

    /// Returns the range of each of its numbers; smaller and larger ones are clamped to its ends. Angles are in radians.
    pub(crate) const fn range(self) -> RangeInclusive<f64> {
        let (smallest, largest) = self.row().1.1;
        smallest..=largest
    }
}
