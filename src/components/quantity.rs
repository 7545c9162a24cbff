//! The quantities of properties, with their notations and ranges.

use super::range::RangeError;
use super::range::ValidRange::{self, Any, Between, NotNegative, Positive};
use super::table::table;
use super::{Refractive, Specular};
use crate::animation::Notation;

table! {
    /// The physical quantity of a number or vector: its notation, and the valid range of each component.
    #[derive(Clone, Copy, Debug, PartialEq, Eq)]
    pub(crate) enum Quantity: (Notation, ValidRange) {
        /// Coordinates in scene units.
        Point => (Notation::Vector, Any),
        /// A coordinate along one axis, in scene units.
        Coordinate => (Notation::Number, Any),
        /// A vector of any nonzero length.
        Direction => (Notation::Vector, Any),
        /// A rotation in space.
        Rotation => (Notation::Rotation, Any),
        /// An angle of rotation in radians, over any number of turns.
        Turn => (Notation::Degrees, Any),
        /// Nonzero factors along the axes.
        Factors => (Notation::Scale, Any),
        /// A length in scene units, greater than 0.
        Length => (Notation::Number, Positive),
        /// The edge lengths of a box.
        Edges => (Notation::Vector, Positive),
        /// A reflection or transmission coefficient.
        Coefficient => (Notation::Number, Between(0.0, 1.0)),
        /// The exponent of highlights.
        Shininess => (Notation::Number, Between(0.0, Specular::LARGEST_SHININESS as f64)),
        /// The speed of light outside divided by the speed of light inside.
        RefractiveIndex => (Notation::Number, Between(Refractive::SMALLEST_IOR, Refractive::LARGEST_IOR)),
        /// Absorption per scene unit of length and colour channel.
        Absorption => (Notation::Light, NotNegative),
        /// Light per colour channel; 1 is full intensity.
        Light => (Notation::Light, NotNegative),
        /// The colour of a surface or a background.
        Color => (Notation::Color, NotNegative),
        /// The full angle of a spot light's cone in radians.
        SpotAngle => (Notation::Degrees, ValidRange::SpotAngle),
        /// The diameter or the extent of a light in the sky in radians.
        AngularSize => (Notation::Degrees, ValidRange::SpotAngle),
        /// The fading fraction of a spot light's cone.
        Softness => (Notation::Number, Between(0.0, 1.0)),
        /// The fraction of a surface that stripes cover.
        StripeRatio => (Notation::Number, Between(0.0, 1.0)),
        /// The width of the joints between bricks.
        Mortar => (Notation::Number, NotNegative),
        /// A factor of contrast.
        Contrast => (Notation::Number, NotNegative),
        /// The falloff coefficients c0, c1, c2; c0 is greater than 0.
        Falloff => (Notation::Vector, NotNegative),
        /// The field of view in radians, less than pi.
        FieldOfView => (Notation::Degrees, ValidRange::FieldOfView),
        /// The diameter of a lens in scene units.
        Aperture => (Notation::Number, NotNegative),
        /// The density of fog, per scene unit of length.
        Density => (Notation::Number, NotNegative),
        /// A choice between yes and no.
        Flag => (Notation::Flag, Any),
    }
}

impl Quantity {
    /// Returns the notation in scene files and scripts.
    pub(crate) const fn notation(self) -> Notation {
        self.row().1.0
    }

    /// Returns the range of each component.
    pub(crate) const fn range(self) -> ValidRange {
        self.row().1.1
    }

    /// Checks a component in the units of the world: angles are in radians.
    pub(crate) fn check(self, value: f64) -> Result<(), RangeError> {
        let is_angle = matches!(self.notation(), Notation::Degrees);
        let checked = self.range().check(if is_angle { value.to_degrees() } else { value });
        checked.map_err(|error| error.range.violated_by(value))
    }
}
