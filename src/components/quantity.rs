//! The quantities of properties, with their notations and ranges.

use std::f64::consts::PI;
use std::ops::RangeInclusive;

use super::table::table;
use super::{Refractive, Specular};
use crate::animation::Notation;
use crate::animation::limits::SMALLEST;

/// An inclusive range: the smallest and the largest value.
type Range = (f64, f64);

const ANY: Range = (f64::NEG_INFINITY, f64::INFINITY);
const NOT_NEGATIVE: Range = (0.0, f64::INFINITY);
/// Greater than 0; the lower end is the smallest size that the file format allows.
const SIZE: Range = (SMALLEST, f64::INFINITY);
const SHARE: Range = (0.0, 1.0);

table! {
    /// The physical quantity of a number or vector: its notation, and the range to which each component is clamped.
    #[derive(Clone, Copy, Debug, PartialEq, Eq)]
    pub(crate) enum Quantity: (Notation, Range) {
        /// Coordinates in scene units.
        Point => (Notation::Vector, ANY),
        /// A vector of any nonzero length.
        Direction => (Notation::Vector, ANY),
        /// A rotation in space.
        Rotation => (Notation::Rotation, ANY),
        /// An angle of rotation in radians, over any number of turns.
        Turn => (Notation::Degrees, ANY),
        /// Nonzero factors along the axes.
        Factors => (Notation::Scale, ANY),
        /// A length in scene units, greater than 0.
        Length => (Notation::Number, SIZE),
        /// The edge lengths of a box.
        Edges => (Notation::Vector, SIZE),
        /// A reflection or transmission coefficient.
        Coefficient => (Notation::Number, SHARE),
        /// The exponent of highlights.
        Shininess => (Notation::Number, (0.0, Specular::LARGEST_SHININESS as f64)),
        /// The speed of light outside divided by the speed of light inside.
        RefractiveIndex => (Notation::Number, (Refractive::SMALLEST_IOR, Refractive::LARGEST_IOR)),
        /// Absorption per scene unit of length and colour channel.
        Absorption => (Notation::Light, NOT_NEGATIVE),
        /// Light per colour channel; 1 is full intensity.
        Light => (Notation::Light, NOT_NEGATIVE),
        /// The colour of a surface or a background.
        Color => (Notation::Color, NOT_NEGATIVE),
        /// The full angle of a spot light's cone in radians.
        SpotAngle => (Notation::Degrees, (SMALLEST, PI)),
        /// The fading fraction of a spot light's cone.
        Softness => (Notation::Number, SHARE),
        /// The falloff coefficients c0, c1, c2; c0 is greater than 0.
        Falloff => (Notation::Vector, NOT_NEGATIVE),
        /// The field of view in radians, less than pi.
        FieldOfView => (Notation::Degrees, (SMALLEST, PI.next_down())),
        /// The diameter of a lens in scene units.
        Aperture => (Notation::Number, NOT_NEGATIVE),
        /// The density of fog, per scene unit of length.
        Density => (Notation::Number, NOT_NEGATIVE),
    }
}

impl Quantity {
    /// Returns the notation in scene files and scripts.
    pub(crate) const fn notation(self) -> Notation {
        self.row().1.0
    }

    /// Returns the range to which each component is clamped. Angles are in radians.
    pub(crate) const fn range(self) -> RangeInclusive<f64> {
        let (smallest, largest) = self.row().1.1;
        smallest..=largest
    }
}
