//! Values of any kind, and their notations.

use glam::{DQuat, DVec3};

use crate::color::Rgb;

/// The value of a track at a moment.
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
    /// Yes or no.
    Flag(bool),
}

/// The kinds of values.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
pub enum ValueKind {
    /// [`Value::Number`].
    Number,
    /// [`Value::Vector`].
    Vector,
    /// [`Value::Rotation`].
    Rotation,
    /// [`Value::Color`].
    Color,
    /// [`Value::Flag`].
    Flag,
}

impl Value {
    /// Returns the kind of this value.
    #[must_use]
    pub const fn kind(self) -> ValueKind {
        match self {
            Self::Number(_) => ValueKind::Number,
            Self::Vector(_) => ValueKind::Vector,
            Self::Rotation(_) => ValueKind::Rotation,
            Self::Color(_) => ValueKind::Color,
            Self::Flag(_) => ValueKind::Flag,
        }
    }
}

/// The notation of an animated value in scene files and scripts.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Notation {
    /// A number.
    Number,
    /// A number of degrees; radians internally.
    Degrees,
    /// `[x, y, z]`.
    Vector,
    /// `[x, y, z]`, or one factor for all three.
    Scale,
    /// `[x, y, z]`, Euler angles in degrees as in `Euler`, or a quaternion `[x, y, z, w]`.
    Rotation,
    /// `[r, g, b]`, 0 or more; 1 is full.
    Light,
    /// `[r, g, b]` from 0 to 255, or `"#rrggbb"`.
    Color,
    /// `true` or `false`.
    Flag,
}

impl Notation {
    /// Returns the kind of the values written in this notation.
    #[must_use]
    pub const fn kind(self) -> ValueKind {
        match self {
            Self::Number | Self::Degrees => ValueKind::Number,
            Self::Vector | Self::Scale => ValueKind::Vector,
            Self::Rotation => ValueKind::Rotation,
            Self::Light | Self::Color => ValueKind::Color,
            Self::Flag => ValueKind::Flag,
        }
    }
}
