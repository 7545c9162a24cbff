//! A value of any kind.

use glam::{DQuat, DVec3};

use crate::color::Rgb;

/// What a track says about a moment.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Value {
    /// A number.
    Number(f64),
    /// A point, a direction, or three numbers.
    Vector(DVec3),
    /// A unit quaternion.
    Rotation(DQuat),
    /// Linear light.
    Color(Rgb),
}

/// The kinds of values.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
pub enum Kind {
    /// [`Value::Number`].
    Number,
    /// [`Value::Vector`].
    Vector,
    /// [`Value::Rotation`].
    Rotation,
    /// [`Value::Color`].
    Color,
}

impl Value {
    /// Which kind it is.
    #[must_use]
    pub const fn kind(self) -> Kind {
        match self {
            Self::Number(_) => Kind::Number,
            Self::Vector(_) => Kind::Vector,
            Self::Rotation(_) => Kind::Rotation,
            Self::Color(_) => Kind::Color,
        }
    }
}
